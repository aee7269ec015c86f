// Where the vertices of a card are, in every pass: raised as the pose wants it, bent by wind and ruffle, then carried by the skeleton.
#define_import_path bevy_plumage::feather_place
#import bevy_pbr::{mesh_functions, mesh_view_bindings::view, skinning, view_transformations::position_world_to_clip}
#ifdef ORDER_WINDOW
#import bevy_plumage::feather_eye::is_orthographic
#import bevy_plumage::order::{UNSETTLED_WINDOW, order_reach, raised_window, stirred_window}
#endif
#ifdef WORN_POSES
#import bevy_plumage::order::{raised_heights, raised_held}
#endif
#import bevy_plumage::{
    anatomy::{EDGE_FACING, edge_shift},
    feather_bindings::{cards, feather_at, feather_base, lod, motion, settings},
    feather_data as data,
    feather_eye::to_eye,
    feather_io::{CardVertex, FeatherVertex},
    wind::turned_by,
}

// Cards that have a class.
fn card_lods() -> u32 { return arrayLength(&lod) / data::LOD_WORDS; }

fn motion_at(row: u32) -> vec4<f32> {
    return motion[min(row, arrayLength(&motion) - 1u)];
}

fn card_at(vertex: CardVertex) -> u32 {
    return min(u32(max(vertex.uv_b.x, 0.0) + 0.5), arrayLength(&cards) / data::CARD_LENGTH - 1u);
}

// Half of what marks the edges of cards.
const LEAST_MARK: f32 = 0.125;

// Share of the way from the left edge of a card to the right one; cards without marks fill their rectangle.
fn across_card(vertex: CardVertex) -> f32 {
    let mark = vertex.uv_b.x - floor(vertex.uv_b.x + 0.5);
    return select(vertex.uv.x, select(0.0, 1.0, mark > 0.0), abs(mark) > LEAST_MARK);
}

fn world_from_card(vertex: CardVertex) -> mat4x4<f32> {
#ifdef SKINNED
    return skinning::skin_model(vertex.joint_indices, vertex.joint_weights, vertex.instance_index);
#else
    return mesh_functions::get_world_from_local(vertex.instance_index);
#endif
}

fn previous_world_from_card(vertex: CardVertex) -> mat4x4<f32> {
#ifdef SKINNED
#ifdef HAS_PREVIOUS_SKIN
    return skinning::skin_prev_model(vertex.joint_indices, vertex.joint_weights, vertex.instance_index);
#else
    return skinning::skin_model(vertex.joint_indices, vertex.joint_weights, vertex.instance_index);
#endif
#else
    return mesh_functions::get_previous_world_from_local(vertex.instance_index);
#endif
}

// Where a vertex lies in the pose that the bird wears, in bind pose. `first`: row of the motion table, as below.
fn raised(vertex: CardVertex, first: u32) -> vec3<f32> {
#ifdef WORN_POSES
    let height = dot(raised_heights(vertex.raised), motion_at(first + data::MOTION_WORN));
    return vertex.position + vertex.normal * (height * motion_at(first + data::MOTION_WORN + 1u).x);
#else
    return vertex.position;
#endif
}

// How a card is turned, as rotation vectors in the mesh's own space: as a whole about its root, which is what the muscles of the
// follicle do, and how much further at its tip, which is what the air does.
struct Turn {
    whole: vec3<f32>,
    tip: vec3<f32>,
}

// Share of its rise that stiffer feathers over it leave to a ruffled feather. `first`: row of the motion table.
fn free(vertex: CardVertex, first: u32) -> f32 {
#ifdef WORN_POSES
    return 1.0 - raised_held(vertex.raised, motion_at(first + data::MOTION_WORN));
#else
    return 1.0;
#endif
}

fn is_still(turn: Turn) -> bool {
    return all(turn.whole == vec3(0.0)) && all(turn.tip == vec3(0.0));
}

// Of card `index`. `first`: row of the motion table, 0 now, half its length a frame ago. `free`: share of a ruffled feather's rise that is
// left to it.
fn turn_of(card: data::Card, index: u32, first: u32, free: f32) -> Turn {
    let air = motion_at(first);
    let eddies = motion_at(first + 1u);
    let region = motion_at(first + data::region_row(card.feather, eddies.w));
    // In still air it says nothing.
    let lifted = data::lift_of(lod[min(card_lods() + index, arrayLength(&lod) - 1u)]);
    let blows = air.w + eddies.x > 0.0;
    let lift = select(0.0, select(lifted.y, lifted.x, first == 0u), blows);
    let yaw = region.w * (f32(card.seed & 0xffffu) / 32767.5 - 1.0);
    let raising = cross(card.along, card.normal);
    return Turn((raising * region.x + card.normal * yaw) * free, raising * lift);
}

// The place of a vertex at share `v` of the rachis: in the air the shaft bends as an arc, so its chord turns half as far as its tip.
fn bent(position: vec3<f32>, root: vec3<f32>, turn: Turn, v: f32) -> vec3<f32> {
    if (is_still(turn)) {
        return position;
    }
    return root + turned_by(position - root, turn.whole + turn.tip * (0.5 * v));
}

// Views of point and spot lights look like a camera's in every definition; their view is not where its visibility ranges are
// resolved, or it has no frustum.
fn is_light() -> bool {
#ifdef DIRECTIONAL_SHADOW
    return true;
#else ifdef SAMPLE_COVERAGE
    // No shadow map has several samples.
    return false;
#else ifdef PREPASS_PIPELINE
    return all(view.frustum[0] == vec4(0.0)) || any(view.world_position != view.lod_view_world_position);
#else
    return false;
#endif
}

// Whether this pipeline draws cards of a class, `bits` as the LOD pass wrote them. Shadows of all classes are drawn by one pipeline.
fn is_drawn(bits: u32) -> bool {
    if (is_light()) {
        return true;
    }
#ifdef ONLY_LIT
    return data::lod_lists(bits).w;
#else ifdef ONLY_MEAN
    return data::lod_lists(bits).z;
#else ifdef ONLY_FAR
    return data::lod_lists(bits).y;
#else ifdef ONLY_RESOLVED
    return data::lod_lists(bits).x;
#else
    let level = data::lod_class(bits);
    return level != data::CARD_CULLED && level != data::CARD_HIDDEN;
#endif
}

// How far a vertex moves along its normal: seen edge on, a vane is as thick as its barbs. `width`: of the card, `root`: its normal at the
// root, both in the world; `eye`: towards the eye, which is seen as `facing` along the vertex' own normal.
fn edge_of(placed: FeatherVertex, card: data::Card, width: f32, root: vec3<f32>, eye: vec3<f32>, facing: f32) -> f32 {
    let radius = feather_at(feather_base(data::card_feather(card.feather)) + data::LEFT_VANE + 1u).z;
    let thickness = 2.0 * radius * card.length / max(card.width, 1e-9) * width;
    let hand = select(-1.0, 1.0, placed.world_tangent.w > 0.0);
    let aside = hand * dot(cross(placed.world_normal.xyz, placed.world_tangent.xyz), eye);
    // Of a card that is fitted to its feather this row is about as wide.
    let own = width * min(abs(2.0 * placed.uv.x - 1.0), 1.0);
    return edge_shift(placed.world_normal.w, own, thickness, facing, aside, dot(root, eye) >= 0.0);
}

#ifdef ORDER_WINDOW
// Share of its distance that a place is moved towards the eye at most.
const NEAREST: f32 = 0.05;
// Steps of depth by which the nearest fragment may miss what the prepass has written.
const ROUNDING: f32 = 1e-6;

// Clip position of a place whose depth, alone, is that of the place `reach` nearer to the eye.
fn nearer(position: vec3<f32>, clip: vec4<f32>, eye: vec3<f32>, reach: f32) -> vec4<f32> {
    let moved = position_world_to_clip(position + eye * reach);
    let depth = moved.z / moved.w * clip.w;
    // What lies before the near plane there would be cut off; behind the eye nothing shows.
    let shown = clip.w > 0.0 && moved.w > 0.0 && depth < clip.w;
    return vec4(clip.xy, select(clip.z, depth, shown) * (1.0 + ROUNDING), clip.w);
}
#endif

fn place(vertex: CardVertex) -> FeatherVertex {
    var out: FeatherVertex;
    let index = card_at(vertex);
    let at = index * data::CARD_LENGTH;
    let card = data::card_decode(cards[at], cards[at + 1u], cards[at + 2u], cards[at + 3u], cards[at + 4u]);
    let level = lod[min(index, card_lods() - 1u)];
    out.card = vec4(card.feather, card.tint, card.seed, data::card_bits(level, index));
    out.uv = vertex.uv;
    out.instance_index = vertex.instance_index;
    if (!is_drawn(level)) {
        // All corners on one point outside the view: no pixels.
        out.position = vec4(2.0, 2.0, 0.5, 1.0);
        return out;
    }
    let world_from_local = world_from_card(vertex);
    let turn = turn_of(card, index, 0u, free(vertex, 0u));
    let tangent_turn = turn.whole + turn.tip * vertex.uv.y;
    out.world_position = world_from_local * vec4(bent(raised(vertex, 0u), card.root, turn, vertex.uv.y), 1.0);
    let normal = turned_by(vertex.normal, tangent_turn);
    let tangent = vec4(turned_by(vertex.tangent.xyz, tangent_turn), vertex.tangent.w);
#ifdef SKINNED
    let world_normal = skinning::skin_normals(world_from_local, normal);
#else
    let world_normal = mesh_functions::mesh_normal_local_to_world(normal, vertex.instance_index);
#endif
    out.world_normal = vec4(world_normal, across_card(vertex));
    out.world_tangent = mesh_functions::mesh_tangent_local_to_world(world_from_local, tangent, vertex.instance_index);
    let width = card.width * length((world_from_local * vec4(card.along, 0.0)).xyz);
    var edge = vec4(0.0);
#ifndef DIRECTIONAL_SHADOW
    let eye = to_eye(out.world_position.xyz);
    let unit = normalize(world_normal);
    let facing = dot(unit, eye);
    // Most cards have nothing to ask; shadow maps need no such lines.
    if (abs(facing) < EDGE_FACING && !is_light()) {
        let root = (world_from_local * vec4(card.normal, 0.0)).xyz;
        edge = vec4(unit * edge_of(out, card, width, root, eye, facing), 0.0);
    }
#endif
    out.world_position += edge;
    out.position = position_world_to_clip(out.world_position.xyz);
#ifdef ORDER_WINDOW
    let farthest = select(NEAREST * distance(view.world_position, out.world_position.xyz), width, is_orthographic());
#ifdef WORN_POSES
    let needed = raised_window(vertex.raised, motion_at(data::MOTION_WORN), motion_at(data::MOTION_WORN + 1u).y);
#else
    let needed = UNSETTLED_WINDOW;
#endif
    let window = min(settings.order_window, stirred_window(needed, length(turn.whole + turn.tip)));
    let reach = order_reach(min(window * width, farthest), facing, vertex.uv.y);
    out.position = nearer(out.world_position.xyz, out.position, eye, reach);
#endif
#ifdef VISIBILITY_RANGE_DITHER
    out.visibility_range_dither = mesh_functions::get_visibility_range_dither_level(
        vertex.instance_index, mesh_functions::get_world_from_local(vertex.instance_index)[3]);
#endif
#ifdef PREPASS_PIPELINE
#ifdef MOTION_VECTOR_PREPASS
    let before = previous_world_from_card(vertex);
    let first = arrayLength(&motion) / 2u;
    let turn_before = turn_of(card, index, first, free(vertex, first));
    out.previous_world_position = before * vec4(bent(raised(vertex, first), card.root, turn_before, vertex.uv.y), 1.0) + edge;
#endif
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
#endif
    return out;
}
