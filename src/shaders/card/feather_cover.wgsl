// Coverage of a fragment, the same in the color pass and the depth prepass: query_feather fed from the card's tables.
#define_import_path bevy_plumage::feather_cover
#import bevy_plumage::{
    anatomy::{CardSight, barb_cotangent, barb_root, canonical_footprint, card_share, card_size, narrowed, on_card, vane_start_coverage},
    feather_bindings::{
        albedo_sampler, contour_at, contour_between, feather_at, outline_texture, rachis_at, settings, shape_at,
    },
    feather_data as data,
    feather_eye::to_eye,
    feather_io::FeatherVertex,
    footprint::{Footprint, mirrored, widened},
    masking::mask_rachis,
    query_feather::{CardVane, LEAST_SHARE, Outline, VaneCover, cover_feather, cover_rachis, cover_vane, mean_stop, mean_vane, rachis_left, shows_vane},
    query_map::{MAP_SIZE, MapSight, map_border, map_decided, map_place, map_sight, map_vanes},
    query_split::{Line, ended_share, line_share, outline_node, outline_root, outline_sight, rachis_line},
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

fn frame_of(in: FeatherVertex) -> Frame {
    var frame: Frame;
    frame.normal = normalize(in.world_normal.xyz);
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

// A lowest barb so low that every footprint is above it.
const BEGUN: f32 = -1e3;

// Share inside the outline of one vane of what of a footprint (over the left vane, or mirrored there) lies on its side of the shaft.
fn outline_share(base: u32, right: bool, footprint: Footprint, cotangent: f32, start: f32) -> f32 {
    // The outline may turn within the footprint.
    let last = f32(data::CONTOUR_SAMPLES - 1u);
    let sight = outline_sight(footprint, cotangent, (1.0 - start) / last);
    let rows = last / max(1.0 - start, 1e-3);
    var nodes = vec2(0.0);
    for (var i = 0u; i < sight.count; i++) {
        let there = contour_between(base, clamp((outline_root(sight, i) - start) * rows, 0.0, last));
        nodes += outline_node(sight, i, select(there.xz, there.yw, right));
    }
    return nodes.y / max(nodes.x, 1e-9);
}

// Share of the fragment inside the outline of both vanes, from its map; -1 where that would show its texels, and for methods for
// comparison, which ask the outline.
fn mapped_share(in: FeatherVertex, sight: MapSight) -> f32 {
#ifdef PUBLISHED_COVERAGE
    return -1.0;
#else ifdef SUPERSAMPLED_COVERAGE
    return -1.0;
#else
    let layer = data::card_feather(in.card.x);
    if (!sight.serves) {
        let around = textureSampleLevel(outline_texture, albedo_sampler, map_place(in.uv), layer, sight.level).r;
        return map_decided(around, sight.level);
    }
    let more = f32(sight.count) - 1.0;
    var place = map_place(in.uv) - sight.step * (0.5 * more);
    let texels = MAP_SIZE * exp2(-sight.level);
    var weight = 1.0;
    var sum = vec2(0.0);
    for (var i = 0u; i < sight.count; i++) {
        let share = textureSampleLevel(outline_texture, albedo_sampler, place, layer, sight.level).r;
        sum += weight * vec2(1.0, map_border(place, texels) * share);
        weight *= (more - f32(i)) / (f32(i) + 1.0);
        place += sight.step;
    }
    return sum.y / sum.x;
#endif
}

// Shares of a footprint left and right of the rachis.
fn beside_rachis(edges: vec2<f32>, footprint: Footprint) -> vec2<f32> {
    return vec2(
        line_share(rachis_line(min(edges.x, edges.y)), footprint),
        line_share(Line(-max(edges.x, edges.y), vec2(1.0, 0.0)), footprint),
    );
}

// The same inside the outlines of both vanes.
fn near_shares(base: u32, shape: vec4<f32>, footprint: Footprint, beside: vec2<f32>) -> vec2<f32> {
    var shares = vec2(0.0);
    for (var i = 0u; i < 2u; i++) {
        let right = i == 1u;
        if (select(beside.x, beside.y, right) < LEAST_SHARE) {
            continue;
        }
        let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, right));
        let cotangent = barb_cotangent(angles.x, angles.y);
        var side = footprint;
        if (right) { side = mirrored(footprint); }
        let inside = outline_share(base, right, side, cotangent, shape.z);
        side.mean.x = min(side.mean.x, -1e-6);
        let share = inside * vane_start_coverage(side, shape.z, cotangent);
        shares = select(vec2(share, shares.y), vec2(shares.x, share), right);
    }
    return beside * shares;
}

// Means are the same everywhere: both vanes differ in what of the fragment they have.
fn cover_means(
    in: FeatherVertex,
    base: u32,
    shape: vec4<f32>,
    frame: Frame,
    mapped: f32,
    footprint: Footprint,
    edges: vec2<f32>,
) -> Covered {
    let beside = beside_rachis(edges, footprint);
    let hidden = clamp(1.0 - beside.x - beside.y, 0.0, 1.0);
    var shares = map_vanes(mapped, hidden, beside);
    if (mapped < 0.0) {
        shares = near_shares(base, shape, footprint, beside);
    }
    let main = footprint.mean.x > 0.5 * (edges.x + edges.y);
    if (shares.x + shares.y + hidden < LEAST_SHARE) {
        return Covered(vec4(0.0), main, 1.0, 1.0, footprint);
    }
    let hides = hidden * rachis_left(footprint, in.uv.y);
    // In a loop, or the shader holds the vane twice; that of which more is asked comes last. Most fragments have nothing of the other one.
    var other = vec3(0.0);
    var vane = VaneCover();
    for (var i = select(0u, 1u, select(shares.y, shares.x, main) < LEAST_SHARE); i < 2u; i++) {
        let right = main == (i == 1u);
        let share = select(shares.x, shares.y, right);
        other = vane.weights;
        vane = VaneCover();
        let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
        let rest = feather_at(slot + 2u);
        let card = CardVane(shape_at(slot), rest.y, rest.z);
        // The right vane is the left one mirrored.
        let mirror = select(1.0, -1.0, right);
        let mean = footprint.mean * vec2(mirror, 1.0);
        let root = barb_root(mean, barb_cotangent(card.shape.vane.sin_b, card.shape.vane.cos_b));
        let reach = contour_at(base, shape.z, root);
        let eye = frame.local_eye * vec3(mirror, 1.0, 1.0);
#ifdef ONLY_LIT
        // The vertices know which fibres the light comes from.
        vane.weights.x = mean_stop(card, mean, select(reach.x, reach.y, right), share, eye);
#else ifdef PREPASS_PIPELINE
        // Depth asks for none.
        vane.weights.x = mean_stop(card, mean, select(reach.x, reach.y, right), share, eye);
#else
        vane = mean_vane(card, mean, select(reach.x, reach.y, right), share, eye);
#endif
    }
    return Covered(cover_feather(hides, other, vane.weights), main, vane.hook, vane.open, footprint);
}

#ifndef ONLY_MEAN
// One vane (`right` or left) beside the rachis, whose edge is at x = edge; the footprint is over the left vane or mirrored there,
// `seen` the same before it was widened: wide ones reach beyond the tip. `main`: it has most of the footprint, and what the eye sees of
// it is asked for even where that is nothing. `mapped`: share of what is beside the rachis inside the outline, or -1.
fn cover_side(
    base: u32,
    right: bool,
    main: bool,
    footprint: Footprint,
    seen: Footprint,
    edge: f32,
    frame: Frame,
    shape: vec4<f32>,
    level: u32,
    mapped: f32,
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
    var inside = max(mapped, 0.0);
    if (shows && mapped < 0.0) {
        inside = ended_share(outline_share(base, right, seen, cotangent, shape.z));
    }
    let outline = Outline(select(reach.xz, reach.yw, right), inside);
    // The right vane is the left one mirrored.
    let view = frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
#ifdef ONLY_FAR
    // A pipeline for stripes alone: the LOD pass has asked for a margin that covers parts.
    let parts_level = level;
#else
    let parts_level = data::CARD_MIXED;
#endif
    // The map knows where the vane begins.
    let start = select(shape.z, BEGUN, mapped >= 0.0);
    return cover_vane(card, start, outline, footprint, edge, view, level, parts_level, settings.threshold);
}

// Cards of stripes or single fibres.
fn cover_parts(
    uv: vec2<f32>,
    base: u32,
    shape: vec4<f32>,
    frame: Frame,
    level: u32,
    seen: Footprint,
    edges: vec2<f32>,
    mapped: f32,
) -> Covered {
    let footprint = widened(seen).footprint;
    var vanes = mapped;
    if (mapped >= 0.0) {
        let beside = beside_rachis(edges, footprint);
        let both = max(beside.x + beside.y, 1e-6);
        // As map_vanes: the rachis hides the rest.
        vanes = clamp((mapped - max(1.0 - both, 0.0)) / both, 0.0, 1.0);
    }
    let main = footprint.mean.x > 0.5 * (edges.x + edges.y);
    // In a loop, or the shader holds the vane twice; that of which more is asked comes last.
    var other = vec3(0.0);
    var vane = VaneCover();
    for (var i = 0u; i < 2u; i++) {
        let right = main == (i == 1u);
        var side = footprint;
        var side_seen = seen;
        if (right) {
            side = mirrored(footprint);
            side_seen = mirrored(seen);
        }
        other = vane.weights;
        vane = cover_side(base, right, i == 1u, side, side_seen, select(edges.x, -edges.y, right), frame, shape, level, vanes);
    }
    let weights = cover_feather(cover_rachis(footprint, edges, uv.y), other, vane.weights);
    return Covered(weights, main, vane.hook, vane.open, footprint);
}

// Whether a pipeline of several classes meets a card of means; methods for comparison know none.
fn is_mean(level: u32) -> bool {
#ifdef ONLY_FAR
    return false;
#else ifdef ONLY_RESOLVED
    return false;
#else ifdef PUBLISHED_COVERAGE
    return false;
#else ifdef SUPERSAMPLED_COVERAGE
    return false;
#else
    return level == data::CARD_MEAN;
#endif
}
#endif

// Of the part of the fragment that lies on the card: the rasterizer leaves out the rest.
fn cover(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, level: u32) -> Covered {
    let rachis = rachis_at(base, in.uv.y);
    let dx = dpdx(in.uv);
    let dy = dpdy(in.uv);
    let place = vec2(in.world_normal.w, in.uv.y);
    let place_dx = dpdx(place);
    let place_dy = dpdy(place);
    let footprint = canonical_footprint(in.uv, dx, dy, rachis.x, rachis.y, shape.x);
    var sight = CardSight(footprint, place, card_size(place_dx, place_dy));
    let edges = mask_rachis(rachis.z, frame.local_eye);
    let mapped = mapped_share(in, map_sight(dx, dy));
    if (mapped < 0.0) {
        // One deviation across, from the screen to the card, and to canonical space.
        let turn = vec2(place_dx.x, place_dy.x) * (0.25 * sight.size.x);
        let way = dx * turn.x + dy * turn.y;
        sight = narrowed(sight, vec2(shape.x * (way.x - rachis.y * way.y), way.y));
    }
    var covered: Covered;
#ifdef ONLY_MEAN
    covered = cover_means(in, base, shape, frame, mapped, sight.footprint, edges);
#else
    if (is_mean(level)) {
        covered = cover_means(in, base, shape, frame, mapped, sight.footprint, edges);
    } else {
        covered = cover_parts(in.uv, base, shape, frame, level, sight.footprint, edges, mapped);
    }
#endif
    covered.weights = on_card(covered.weights, card_share(sight.place, sight.size));
    return covered;
}
