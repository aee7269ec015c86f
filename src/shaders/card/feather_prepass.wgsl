// Depth, normal and motion prepass of cameras, and shadow maps. In a prepass the silhouette is that of the color pass; a shadow
// map takes the mean coverage at the light's angle, made holes by a fixed pattern. Both entry points are in one file, because a
// pipeline that Bevy makes without fragment stage gets this one (FeatherMaterial::specialize).
#ifdef MOTION_VECTOR_PREPASS
#import bevy_pbr::mesh_view_bindings::view
#import bevy_pbr::prepass_bindings::previous_view_uniforms
#endif
#import bevy_plumage::{
    anatomy::{
        barb_cotangent, barb_root, barbule_factor, canonical_footprint, card_share, card_size, contour_coverage, hooked, vane_start_coverage,
    },
    feather_bindings::{contour_at, feather_at, feather_base, rachis_at, shape_at},
    feather_cover::{cover, frame_of},
    feather_data as data,
    feather_io::{CardVertex, FeatherVertex, class_of},
    feather_opacity::{is_left_out, leaves_hole, moved_by},
    feather_pattern::{pattern_threshold, threshold_after},
    feather_place::{is_light, place},
    masking::{storeys, vane_stop},
}
#ifdef SAMPLE_COVERAGE
#import bevy_plumage::feather_opacity::sample_bits
#endif

@vertex
fn vertex(vertex: CardVertex) -> FeatherVertex {
    return place(vertex);
}

#ifdef FEATHER_PREPASS_OUTPUT
struct Output {
#ifdef NORMAL_PREPASS
    @location(0) normal: vec4<f32>,
#endif
#ifdef MOTION_VECTOR_PREPASS
    @location(1) motion_vector: vec2<f32>,
#endif
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    @builtin(frag_depth) frag_depth: f32,
#endif
#ifdef SAMPLE_COVERAGE
    @builtin(sample_mask) samples: u32,
#endif
}
#endif

// Share of the light that a feather stops at `uv`.
fn shadow_opacity(in: FeatherVertex, base: u32, shape: vec4<f32>) -> f32 {
    let rachis = rachis_at(base, in.uv.y);
    let dx = dpdx(in.uv);
    let dy = dpdy(in.uv);
    let footprint = canonical_footprint(in.uv, dx, dy, rachis.x, rachis.y, shape.x);
    let place = vec2(in.world_normal.w, in.uv.y);
    let own = card_share(place, card_size(dpdx(place), dpdy(place)));
    if (abs(footprint.mean.x) < rachis.z) {
        return 1.0;
    }
    let right = footprint.mean.x > 0.0;
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let last = feather_at(slot + 2u);
    var vane = shape_at(slot);
    let cotangent = barb_cotangent(vane.vane.sin_b, vane.vane.cos_b);
    let contour = contour_at(base, shape.z, barb_root(footprint.mean, cotangent));
    let reach = select(contour.xz, contour.yw, right);
    // The light sees the vane at its own angle.
    let light = frame_of(in).local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
    vane.vane.hooked = barbule_factor(hooked(abs(footprint.mean.x), footprint.mean.y, reach.x, last.y, last.z));
    // Of the part on the card: the rasterizer leaves out the rest.
    let inside = contour_coverage(footprint, reach.x, reach.y, cotangent) * vane_start_coverage(footprint, shape.z, cotangent);
    return min(inside / own, 1.0) * vane_stop(vane, storeys(vane, light));
}

// Whether the fragment is no part of the silhouette; its samples otherwise.
struct Silhouette {
    hole: bool,
    samples: u32,
}

fn silhouette(in: FeatherVertex) -> Silhouette {
    let base = feather_base(data::card_feather(in.card.x));
    let shape = feather_at(base + data::SHAPE);
    let card = data::card_index(in.card.w);
    let moved = moved_by(card);
    var found: Silhouette;
    if (is_light()) {
        let opacity = shadow_opacity(in, base, shape);
        found.hole = opacity < threshold_after(pattern_threshold(in.position.xy, card), moved.x);
        found.samples = 0xffffffffu;
        return found;
    }
    let covered = cover(in, base, shape, frame_of(in), class_of(in));
    let opacity = dot(covered.weights, vec4(1.0));
    found.hole = leaves_hole(in, opacity, shape.x, moved);
#ifdef ONLY_MEAN
    found.hole = found.hole || is_left_out(in, moved);
#endif
#ifdef SAMPLE_COVERAGE
    found.samples = sample_bits(in, opacity, moved);
#endif
    return found;
}

#ifdef FEATHER_PREPASS_OUTPUT
@fragment
fn fragment(in: FeatherVertex) -> Output {
    let found = silhouette(in);
    if (found.hole) { discard; }
    var out: Output;
#ifdef NORMAL_PREPASS
    let normal = normalize(in.world_normal.xyz);
    let facing = dot(normal, frame_of(in).eye) >= 0.0;
    out.normal = vec4(select(-normal, normal, facing) * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTOR_PREPASS
    let now = view.unjittered_clip_from_world * in.world_position;
    let before = previous_view_uniforms.clip_from_world * in.previous_world_position;
    out.motion_vector = (now.xy / now.w - before.xy / before.w) * vec2(0.5, -0.5);
#endif
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.frag_depth = in.unclipped_depth;
#endif
#ifdef SAMPLE_COVERAGE
    out.samples = found.samples;
#endif
    return out;
}
#else
@fragment
fn fragment(in: FeatherVertex) {
    if (silhouette(in).hole) { discard; }
}
#endif
