// Coverage of a fragment, the same in the colour pass and the depth prepass.
#define_import_path bevy_plumage::feather_cover
#import bevy_pbr::mesh_view_bindings::view
#import bevy_plumage::{
    anatomy::{barb_root, barbule_factor, canonical_footprint, contour_coverage, hooked, vane_start_coverage},
    feather_bindings::{contour_at, feather_at, rachis_at, settings},
    feather_data as data,
    feather_io::FeatherVertex,
    masking::{mask_rachis, mask_vane},
    query::{Footprint, mirrored, split_rachis, vane_coverage},
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

// Coverage of the footprint by rachis, barbs, distal and proximal barbules, the vane that has most of it, and the footprint.
struct Covered {
    weights: vec4<f32>,
    right: bool,
    footprint: Footprint,
}

fn cover_vane(base: u32, right: bool, footprint: Footprint, frame: Frame, shape: vec4<f32>, level: u32) -> vec3<f32> {
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let angles = feather_at(slot);
    let last = feather_at(slot + 2u);
    var vane = data::vane_unpack(angles, feather_at(slot + 1u), last);
    // The right vane is the left one mirrored.
    let side = select(1.0, -1.0, right);
    var leftward = footprint;
    if (right) { leftward = mirrored(footprint); }
    // Angle of the barbs in radians.
    let angle = last.w;
    let root = barb_root(footprint.mean, angle);
    let contour = contour_at(base, shape.z, root);
    let reach = select(contour.xz, contour.yw, right);
    let inside = contour_coverage(footprint.mean, footprint.covariance, reach.x, reach.y, angle)
        * vane_start_coverage(footprint.mean, footprint.covariance, shape.z, angle);
    if (inside < 1e-3) {
        return vec3(0.0);
    }
    // Loose barbules stand on edge: they are narrower, and hide less of each other.
    let hook = barbule_factor(hooked(abs(footprint.mean.x), footprint.mean.y, reach.x, last.y, last.z));
    vane.r_bd *= hook;
    vane.r_bp *= hook;
    let cell = mask_vane(vane, frame.local_eye * vec3(side, 1.0, 1.0));
#ifdef PUBLISHED_COVERAGE
    // Whatever the LOD pass says of the card: sixteen nodes near, orders 1 and 2 far.
    let covered = published_vane_coverage(cell, vane, leftward, PublishedMethod(PUBLISHED_SWITCH, 1u, 16u, 1, 2));
#else ifdef SUPERSAMPLED_COVERAGE
    let covered = published_vane_coverage(cell, vane, leftward, PublishedMethod(PUBLISHED_POINTS, SUPERSAMPLES, 16u, 1, 2));
#else
    let covered = vane_coverage(cell, vane, leftward, level, settings.threshold);
#endif
    return inside * covered;
}

fn cover(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, level: u32) -> Covered {
    let rachis = rachis_at(base, in.uv.y);
    let canonical = canonical_footprint(in.uv, dpdx(in.uv), dpdy(in.uv), rachis.x, rachis.y, shape.x);
    var covered: Covered;
    covered.footprint = Footprint(canonical.mean, canonical.cov);
    let split = split_rachis(covered.footprint, mask_rachis(rachis.z, frame.local_eye));
    covered.right = split.right_mass > split.left_mass;
    // The shaft ends where the card does.
    covered.weights.x = split.rachis * smoothstep(1.0, 0.99, in.uv.y);
    var vanes = vec3(0.0);
    if (split.left_mass > 1e-3) {
        vanes += split.left_mass * cover_vane(base, false, split.left, frame, shape, level);
    }
    if (split.right_mass > 1e-3) {
        vanes += split.right_mass * cover_vane(base, true, split.right, frame, shape, level);
    }
    covered.weights = vec4(covered.weights.x, vanes);
    let total = dot(covered.weights, vec4(1.0));
    covered.weights = max(covered.weights, vec4(0.0)) / max(total, 1.0);
    return covered;
}
