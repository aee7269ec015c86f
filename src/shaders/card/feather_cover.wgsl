// Coverage of a fragment, the same in the color pass and the depth prepass: query_feather fed from the card's tables.
#define_import_path bevy_plumage::feather_cover
#import bevy_pbr::mesh_view_bindings::view
#import bevy_plumage::{
    anatomy::{barb_cotangent, barb_root, canonical_footprint},
    feather_bindings::{contour_at, contour_between, feather_at, rachis_at, settings, shape_at},
    feather_data as data,
    feather_io::FeatherVertex,
    footprint::{Footprint, mirrored, widened},
    masking::mask_rachis,
    query_feather::{CardVane, Outline, VaneCover, cover_feather, cover_rachis, cover_vane, shows_vane},
    query_split::{outline_node, outline_root, outline_sight},
}

// The card's frame in the world and the eye in it.
struct Frame {
    // Along u, along the rachis, out of the front face.
    across: vec3<f32>,
    along: vec3<f32>,
    normal: vec3<f32>,
    // 1 or -1: `across` is this times `normal` cross `along`.
    hand: f32,
    // To the eye, in the world and in this frame.
    eye: vec3<f32>,
    local_eye: vec3<f32>,
}

fn to_eye(world_position: vec3<f32>) -> vec3<f32> {
    if (view.clip_from_view[3].w == 1.0) {
        return normalize(vec3(view.clip_from_world[0].z, view.clip_from_world[1].z, view.clip_from_world[2].z));
    }
    return normalize(view.world_position - world_position);
}

fn frame_of(in: FeatherVertex) -> Frame {
    var frame: Frame;
    frame.normal = normalize(in.world_normal);
    let tangent = in.world_tangent.xyz - frame.normal * dot(frame.normal, in.world_tangent.xyz);
    frame.along = tangent * inverseSqrt(max(dot(tangent, tangent), 1e-12));
    frame.hand = select(-1.0, 1.0, in.world_tangent.w > 0.0);
    frame.across = cross(frame.normal, frame.along) * frame.hand;
    frame.eye = to_eye(in.world_position.xyz);
    frame.local_eye = vec3(dot(frame.eye, frame.across), dot(frame.eye, frame.along), dot(frame.eye, frame.normal));
    return frame;
}

// Coverage of the footprint by rachis, barbs, distal and proximal barbules, the vane that has most of it, `hook` and `open` of that vane
// (VaneCover), and the footprint.
struct Covered {
    weights: vec4<f32>,
    right: bool,
    hook: f32,
    open: f32,
    footprint: Footprint,
}

// One vane (`right` or left) beside the rachis, whose edge is at x = edge; the footprint is over the left vane or mirrored there.
// `main`: it has most of the footprint, and what the eye sees of it is asked for even where that is nothing.
fn cover_side(
    base: u32,
    right: bool,
    main: bool,
    footprint: Footprint,
    edge: f32,
    frame: Frame,
    shape: vec4<f32>,
    level: u32,
) -> VaneCover {
    // Asked again by cover_vane; here it spares the tables.
    let shows = shows_vane(footprint, edge);
    if (!shows && !main) {
        return VaneCover();
    }
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let rest = feather_at(slot + 2u);
    let card = CardVane(shape_at(slot), rest.y, rest.z);
    let cotangent = barb_cotangent(card.shape.vane.sin_b, card.shape.vane.cos_b);
    let reach = contour_at(base, shape.z, barb_root(footprint.mean, cotangent));
    // The outline may turn within the footprint.
    let last = f32(data::CONTOUR_SAMPLES - 1u);
    let sight = outline_sight(footprint, cotangent, (1.0 - shape.z) / last);
    let rows = last / max(1.0 - shape.z, 1e-3);
    var nodes = vec2(0.0);
    for (var i = 0u; i < select(0u, sight.count, shows); i++) {
        let there = contour_between(base, clamp((outline_root(sight, i) - shape.z) * rows, 0.0, last));
        nodes += outline_node(sight, i, select(there.xz, there.yw, right));
    }
    let outline = Outline(select(reach.xz, reach.yw, right), nodes.y / max(nodes.x, 1e-9));
    // The right vane is the left one mirrored.
    let view = frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
#ifdef ONLY_FAR
    // A pipeline for stripes alone: the LOD pass has asked for a margin that covers parts.
    let parts_level = level;
#else ifdef ONLY_MEAN
    // Means are not cut; without this the pipeline would hold every evaluator.
    let parts_level = level;
#else
    let parts_level = data::CARD_MIXED;
#endif
    return cover_vane(card, shape.z, outline, footprint, edge, view, level, parts_level, settings.threshold);
}

fn cover(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, level: u32) -> Covered {
    let rachis = rachis_at(base, in.uv.y);
    let footprint = widened(canonical_footprint(in.uv, dpdx(in.uv), dpdy(in.uv), rachis.x, rachis.y, shape.x)).footprint;
    let edges = mask_rachis(rachis.z, frame.local_eye);
    let main = footprint.mean.x > 0.5 * (edges.x + edges.y);
    // In a loop, or the shader holds the vane twice; that of which more is asked comes last.
    var other = vec3(0.0);
    var vane = VaneCover();
    for (var i = 0u; i < 2u; i++) {
        let right = main == (i == 1u);
        var side = footprint;
        if (right) { side = mirrored(footprint); }
        other = vane.weights;
        vane = cover_side(base, right, i == 1u, side, select(edges.x, -edges.y, right), frame, shape, level);
    }
    let weights = cover_feather(cover_rachis(footprint, edges, in.uv.y), other, vane.weights);
    return Covered(weights, main, vane.hook, vane.open, footprint);
}
