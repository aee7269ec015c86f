// Coverage of a fragment, the same in the colour pass and the depth prepass.
#define_import_path bevy_plumage::feather_cover
#import bevy_pbr::mesh_view_bindings::view
#import bevy_plumage::{
    anatomy::{barb_root, barbule_factor, canonical_footprint, hooked, vane_start_coverage},
    feather_bindings::{contour_at, feather_at, rachis_at, settings},
    feather_data as data,
    feather_io::FeatherVertex,
    masking::{mask_rachis, mask_vane},
    query::{Footprint, mirrored, reduce, vane_coverage, widened},
    query_split::{
        averages, line_part, line_share, outline_line, outline_node, outline_root, outline_sight, rachis_line, rachis_share,
        split_line,
    },
}
#ifdef PUBLISHED_COVERAGE
#import bevy_plumage::query_published::{PUBLISHED_SWITCH, PublishedMethod, published_vane_coverage}
#endif
#ifdef SUPERSAMPLED_COVERAGE
#import bevy_plumage::query_published::{PUBLISHED_POINTS, PublishedMethod, published_vane_coverage}

// Point queries per footprint.
const SUPERSAMPLES: u32 = 1024u;
#endif

// The card's frame in the world and the eye in it.
struct Frame {
    // Along u, along the rachis, out of the front face.
    across: vec3<f32>,
    along: vec3<f32>,
    normal: vec3<f32>,
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
    frame.across = cross(frame.normal, frame.along) * select(-1.0, 1.0, in.world_tangent.w > 0.0);
    frame.eye = to_eye(in.world_position.xyz);
    frame.local_eye = vec3(dot(frame.eye, frame.across), dot(frame.eye, frame.along), dot(frame.eye, frame.normal));
    return frame;
}

// Coverage of the footprint by rachis, barbs, distal and proximal barbules, the vane that has most of it, the share of their
// width that its barbules show, and the footprint.
struct Covered {
    weights: vec4<f32>,
    right: bool,
    hook: f32,
    footprint: Footprint,
}

// One vane's share of a footprint (over the left vane, or mirrored there) beside the rachis, whose edge is at x = edge; w: the
// share of their width that its barbules show.
fn cover_vane(base: u32, right: bool, footprint: Footprint, edge: f32, frame: Frame, shape: vec4<f32>, level: u32) -> vec4<f32> {
    let rachis = rachis_line(edge);
    let beside = line_share(rachis, footprint);
    if (beside < 1e-3) {
        return vec4(0.0, 0.0, 0.0, 1.0);
    }
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let angles = feather_at(slot);
    let last = feather_at(slot + 2u);
    var vane = data::vane_unpack(angles, feather_at(slot + 1u), last);
    // Angle of the barbs in radians.
    let angle = last.w;
    let root = barb_root(footprint.mean, angle);
    let contour = contour_at(base, shape.z, root);
    let reach = select(contour.xz, contour.yw, right);
    let outline = outline_line(footprint.mean, reach, angle);
    let straight = line_share(outline, footprint);
    // The outline may turn within the footprint.
    let cotangent = cos(angle) / max(sin(angle), 1e-3);
    let sight = outline_sight(footprint, cotangent, (1.0 - shape.z) / f32(data::CONTOUR_SAMPLES - 1u));
    var nodes = vec2(0.0);
    for (var i = 0u; i < sight.count; i++) {
        let there = contour_at(base, shape.z, outline_root(sight, i));
        nodes += outline_node(sight, i, select(there.xz, there.yw, right));
    }
    let inside = nodes.y / max(nodes.x, 1e-9);
    let mean = vec2(min(footprint.mean.x, -1e-6), footprint.mean.y);
    let begun = vane_start_coverage(mean, footprint.covariance, shape.z, angle);
    if (inside * begun < 1e-3) {
        return vec4(0.0, 0.0, 0.0, 1.0);
    }
    // Loose barbules stand on edge: they are narrower, and hide less of each other.
    let hook = barbule_factor(hooked(abs(footprint.mean.x), footprint.mean.y, reach.x, last.y, last.z));
    vane.r_bd *= hook;
    vane.r_bp *= hook;
    // The right vane is the left one mirrored.
    let cell = mask_vane(vane, frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0));
    // Whichever of rachis and outline takes more of the footprint cuts it into parts, the other one scales them. Where the tangent
    // tells too little of the outline, the outline scales the whole.
    let scale = inside / max(straight, 1e-6);
    let is_line = scale <= 2.0 && scale >= 0.5;
    var first = rachis;
    var second = outline;
    if (is_line && straight < beside) {
        first = outline;
        second = rachis;
    }
#ifdef PUBLISHED_COVERAGE
    let resolved = false;
#else
    let resolved = level != data::CARD_MEAN && !averages(reduce(cell, vane, footprint), settings.threshold);
#endif
    let cut = split_line(footprint, first, resolved);
    var covered = vec3(0.0);
    for (var i = 0u; i < cut.parts; i++) {
        let part = line_part(cut, i);
        var mass = part.mass * inside;
        if (is_line) {
            mass = part.mass * scale * line_share(second, part.footprint);
        }
        if (abs(mass) < 5e-4) {
            continue;
        }
#ifdef PUBLISHED_COVERAGE
        // Whatever the LOD pass says of the card: sixteen nodes near, orders 1 and 2 far.
        let method = PublishedMethod(PUBLISHED_SWITCH, 1u, 16u, 1, 2);
        covered += mass * published_vane_coverage(cell, vane, part.footprint, method);
#else ifdef SUPERSAMPLED_COVERAGE
        let method = PublishedMethod(PUBLISHED_POINTS, SUPERSAMPLES, 16u, 1, 2);
        covered += mass * published_vane_coverage(cell, vane, part.footprint, method);
#else
        // What the LOD pass promised of whole footprints does not hold for their parts.
#ifdef ONLY_FAR
        let part_level = level;
#else
        let part_level = select(level, data::CARD_MIXED, cut.parts > 1u);
#endif
        covered += mass * vane_coverage(cell, vane, part.footprint, part_level, settings.threshold);
#endif
    }
    return vec4(max(covered, vec3(0.0)) * begun, hook);
}

fn cover(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, level: u32) -> Covered {
    let rachis = rachis_at(base, in.uv.y);
    let canonical = canonical_footprint(in.uv, dpdx(in.uv), dpdy(in.uv), rachis.x, rachis.y, shape.x);
    let footprint = widened(Footprint(canonical.mean, canonical.cov)).footprint;
    let edges = mask_rachis(rachis.z, frame.local_eye);
    var covered: Covered;
    covered.footprint = footprint;
    covered.right = footprint.mean.x > 0.5 * (edges.x + edges.y);
    // The shaft ends where the card does.
    covered.weights.x = rachis_share(footprint, edges) * smoothstep(1.0, 0.99, in.uv.y);
    let left = cover_vane(base, false, footprint, edges.x, frame, shape, level);
    let right = cover_vane(base, true, mirrored(footprint), -edges.y, frame, shape, level);
    covered.hook = select(left.w, right.w, covered.right);
    covered.weights = vec4(covered.weights.x, left.xyz + right.xyz);
    let total = dot(covered.weights, vec4(1.0));
    covered.weights = max(covered.weights, vec4(0.0)) / max(total, 1.0);
    return covered;
}
