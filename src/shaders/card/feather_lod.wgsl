// One thread per card: skin the root, cull, bound the pixel footprint over the card, choose the evaluator.
#import bevy_render::view::View
#import bevy_plumage::feather_data as data
#import bevy_plumage::masking::Vane
#import bevy_plumage::query::classify_bounds
#import bevy_plumage::vertex_light::vertex_light_error

struct LodParams {
    world_from_local: mat4x4<f32>,
    card_count: u32,
    skin_index: u32,
    // Of the chooser, from the error budget.
    threshold: f32,
    // Largest error that light found at vertices may have, 0: it may not be found there.
    light_budget: f32,
    first_light: vec4<f32>,
    second_light: vec4<f32>,
}

const NO_SKIN: u32 = 0xffffffffu;
// A pixel's Gaussian: half a pixel of standard deviation along each screen axis.
const PIXEL_SIGMA: f32 = 0.5;
// Room beside the reach of a card from its root, over its length. Turns about the root, by wind or ruffle, stay within that reach.
const BENDING: f32 = 0.25;
// A footprint longer than this many times its width counts as this long.
const MAX_ASPECT: f32 = 16.0;
// What the curve of the rachis and a bend of the card may take off a footprint's minor axis.
const LEAST_STRETCH: f32 = 0.85;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> params: LodParams;
@group(0) @binding(2) var<storage, read> feathers: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> cards: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> lod: array<u32>;
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read> joints: array<mat4x4<f32>>;

fn joint(index: u32) -> mat4x4<f32> {
    return joints[min(params.skin_index + index, arrayLength(&joints) - 1u)];
}

fn world_from_root(card: data::Card) -> mat4x4<f32> {
    if (params.skin_index == NO_SKIN) {
        return params.world_from_local;
    }
    return joint(card.joints.x) * card.weights.x
        + joint(card.joints.y) * card.weights.y
        + joint(card.joints.z) * card.weights.z
        + joint(card.joints.w) * card.weights.w;
}

fn outside(center: vec3<f32>, radius: f32) -> bool {
    for (var i = 0u; i < 5u; i++) {
        let plane = view.frustum[i];
        if (dot(plane.xyz, center) + plane.w < -radius) {
            return true;
        }
    }
    return false;
}

fn feather_vane(base: u32, slot: u32) -> Vane {
    let last = arrayLength(&feathers) - 1u;
    return data::vane_unpack(
        feathers[min(base + slot, last)],
        feathers[min(base + slot + 1u, last)],
        feathers[min(base + slot + 2u, last)],
    );
}

// Cards of fewer pixels have too few fragments to be worth their vertices.
const LEAST_PIXELS: f32 = 40.0;

// The least of the cosines between a card's normal and eye and lights.
fn least_facing(normal: vec3<f32>, eye: vec3<f32>) -> f32 {
    let lights = abs(vec2(dot(normal, params.first_light.xyz), dot(normal, params.second_light.xyz)));
    let there = mix(vec2(1.0), lights, vec2(params.first_light.w, params.second_light.w));
    return min(abs(dot(normal, eye)), min(there.x, there.y));
}

fn classify_card(index: u32) -> u32 {
    let at = index * data::CARD_LENGTH;
    let card = data::card_decode(cards[at], cards[at + 1u], cards[at + 2u], cards[at + 3u], cards[at + 4u]);
    let world_from_local = world_from_root(card);
    let center = (world_from_local * vec4(card.center, 1.0)).xyz;
    // The largest stretch of the matrix bounds the sphere; the stretch along the rachis scales the feather.
    let stretch = max(length(world_from_local[0].xyz), max(length(world_from_local[1].xyz), length(world_from_local[2].xyz)));
    let radius = card.radius * stretch;
    // The tip may ride on other joints than the root, which alone is skinned here: cull by what the feather can reach from it.
    let reach = (1.5 * (distance(card.center, card.root) + card.radius) + BENDING * card.length) * stretch;
    if (outside((world_from_local * vec4(card.root, 1.0)).xyz, reach)) {
        return data::CARD_CULLED;
    }
    let feather_length = max(length((world_from_local * vec4(card.along, 0.0)).xyz) * card.length, 1e-9);
    let depth = -(view.view_from_world * vec4(center, 1.0)).z;
    let pixel = 2.0 / max(abs(view.clip_from_view[1][1]) * view.viewport.w, 1e-9);
    let is_orthographic = view.clip_from_view[3].w == 1.0;
    let nearest = select(max(depth - radius, 1e-4), 1.0, is_orthographic);
    let farthest = select(max(depth + radius, 1e-4), 1.0, is_orthographic);
    let base = data::FEATHERS_BASE
        + min(data::card_feather(card.feather), max(u32(feathers[0].x), 1u) - 1u) * data::FEATHER_STRIDE;
    // Canonical lengths per metre, along and across: the groom may have made the card wider than the feather's own aspect.
    let aspect = feathers[min(base + data::SHAPE, arrayLength(&feathers) - 1u)].x;
    let along = 1.0 / feather_length;
    let across = aspect * card.length / max(card.width, 1e-9) * along;
    // Off the optical axis a pixel spans less of a surface that faces it.
    let aside = length((view.view_from_world * vec4(center, 1.0)).xy);
    let slant = select(nearest / max(length(vec2(nearest, aside + radius)), 1e-9), 1.0, is_orthographic);
    let minor = PIXEL_SIGMA * pixel * nearest * slant * LEAST_STRETCH * min(along, across);
    let major = PIXEL_SIGMA * pixel * farthest * max(along, across) * MAX_ASPECT;
    let left = classify_bounds(feather_vane(base, data::LEFT_VANE), minor, major, params.threshold);
    let right = classify_bounds(feather_vane(base, data::RIGHT_VANE), minor, major, params.threshold);
    let level = select(data::CARD_MIXED, left, left == right);
    if (level != data::CARD_MEAN || params.light_budget <= 0.0) {
        return level;
    }
    let world_normal = normalize((world_from_local * vec4(card.normal, 0.0)).xyz);
    let eye = select(normalize(view.world_position - center), view.world_from_view[2].xyz, is_orthographic);
    let step = pixel * select(depth, 1.0, is_orthographic);
    let pixels = feather_length * feather_length * card.width / max(card.length * step * step, 1e-12);
    let lit = pixels >= LEAST_PIXELS && vertex_light_error(data::card_turn(card.tint), least_facing(world_normal, eye)) <= params.light_budget;
    return select(data::CARD_MEAN, data::CARD_LIT, lit);
}

@compute @workgroup_size(64)
fn classify(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = min(params.card_count, min(arrayLength(&lod), arrayLength(&cards) / data::CARD_LENGTH));
    if (id.x >= count) {
        return;
    }
    let level = classify_card(id.x);
    lod[id.x] = level;
    atomicAdd(&counters[min(level, data::CARD_LIT)], 1u);
}
