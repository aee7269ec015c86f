// Silhouette of a feather in shadow maps: the mean coverage inside the contour, made holes by a fixed pattern.
#import bevy_plumage::{
    anatomy::{barb_root, canonical_footprint, contour_coverage, vane_start_coverage},
    feather_bindings::{feather_at, feather_base, rachis_at, contour_at},
    feather_data as data,
    feather_io::FeatherPrepassVertex,
    feather_pattern::pattern_threshold,
    masking::mask_vane,
    query_far::mean_coverage,
}
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
struct Output { @builtin(frag_depth) frag_depth: f32 }
#endif

// Share of the light that a feather stops at `uv`.
fn shadow_opacity(in: FeatherPrepassVertex) -> f32 {
    let base = feather_base(data::card_feather(in.card.x));
    let shape = feather_at(base + data::SHAPE);
    let rachis = rachis_at(base, in.uv.y);
    let footprint = canonical_footprint(in.uv, dpdx(in.uv), dpdy(in.uv), rachis.x, rachis.y, shape.x);
    if (abs(footprint.mean.x) < rachis.z) {
        return 1.0;
    }
    let right = footprint.mean.x > 0.0;
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let last = feather_at(slot + 2u);
    let vane = data::vane_unpack(feather_at(slot), feather_at(slot + 1u), last);
    let root = barb_root(footprint.mean, last.w);
    let contour = contour_at(base, shape.z, root);
    let reach = select(contour.xz, contour.yw, right);
    return contour_coverage(footprint.mean, footprint.cov, reach.x, reach.y, last.w)
        * vane_start_coverage(footprint.mean, footprint.cov, shape.z, last.w)
        * dot(mean_coverage(mask_vane(vane, vec3(0.0, 0.0, 1.0))), vec3(1.0));
}

#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
@fragment
fn fragment(in: FeatherPrepassVertex) -> Output {
    if (shadow_opacity(in) < pattern_threshold(in.position.xy, in.card.y)) { discard; }
    return Output(in.unclipped_depth);
}
#else
@fragment
fn fragment(in: FeatherPrepassVertex) {
    if (shadow_opacity(in) < pattern_threshold(in.position.xy, in.card.y)) { discard; }
}
#endif
