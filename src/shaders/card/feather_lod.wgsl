// One thread per card: skin the root, cull, bound the pixel footprint over the card, choose the evaluator.
#import bevy_plumage::{
    feather_data as data,
    feather_lod_bindings as lods,
    feather_measure::measure,
    masking::Vane,
    query::classify_bounds,
    vertex_light::vertex_light_error,
}

// A pixel's Gaussian: half a pixel of standard deviation along each screen axis.
const PIXEL_SIGMA: f32 = 0.5;
// Room beside the reach of a card from its root, over its length. Turns about the root, by wind or ruffle, stay within that reach.
const BENDING: f32 = 0.25;
// A footprint longer than this many times its width counts as this long.
const MAX_ASPECT: f32 = 16.0;
// What the curve of the rachis and a bend of the card may take off a footprint's minor axis.
const LEAST_STRETCH: f32 = 0.85;

fn outside(center: vec3<f32>, radius: f32) -> bool {
    for (var i = 0u; i < 5u; i++) {
        let plane = lods::view.frustum[i];
        if (dot(plane.xyz, center) + plane.w < -radius) {
            return true;
        }
    }
    return false;
}

fn feather_vane(base: u32, slot: u32) -> Vane {
    return data::vane_unpack(
        lods::feather_row(base + slot), lods::feather_row(base + slot + 1u), lods::feather_row(base + slot + 2u),
    );
}

// Cards of about 40 pixels have as many fragments as are worth their vertices: below the first number none is lit there, from the second on
// all of it.
const LIT_PIXELS: vec2<f32> = vec2(39.0, 41.0);
// Over the distance where averages begin to do, less 1: all of a card is lit there.
const LIT_FAR: f32 = 0.02;
// Budgets of light from which on none of a card is lit at its vertices; up to one all of it may be.
const LIT_MOST: f32 = 1.2;

// Least vertices of a card that is lit at them: two columns and rows beside one another, for shaft and downy base.
const LIT_VERTICES: u32 = 9u;

// Of a card that turns by so many degrees between two vertices, with this normal; `mirrors`: 1 for structural fibres.
fn light_error(turn: f32, normal: vec3<f32>, eye: vec3<f32>, mirrors: f32) -> f32 {
    let first = lods::params.first_light;
    let second = lods::params.second_light;
    let lights = abs(vec2(dot(normal, first.xyz), dot(normal, second.xyz)));
    let against = -vec2(dot(eye, first.xyz), dot(eye, second.xyz));
    return vertex_light_error(turn, abs(dot(normal, eye)), lights, against, vec2(first.w, second.w), mirrors);
}

fn base_of(card: data::Card) -> u32 {
    let count = max(u32(lods::feathers[0].x), 1u);
    return data::FEATHERS_BASE + min(data::card_feather(card.feather), count - 1u) * data::FEATHER_STRIDE;
}

// Towards the eye.
fn eye_of(place: vec3<f32>) -> vec3<f32> {
    let is_orthographic = lods::view.clip_from_view[3].w == 1.0;
    return select(normalize(lods::view.world_position - place), lods::view.world_from_view[2].xyz, is_orthographic);
}

// Class of a card of so many vertices, as data::lod_bits. `world_from_local`: at the root.
fn classify_card(card: data::Card, vertex_count: u32, world_from_local: mat4x4<f32>) -> u32 {
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
    let depth = -(lods::view.view_from_world * vec4(center, 1.0)).z;
    let pixel = 2.0 / max(abs(lods::view.clip_from_view[1][1]) * lods::view.viewport.w, 1e-9);
    let is_orthographic = lods::view.clip_from_view[3].w == 1.0;
    let nearest = select(max(depth - radius, 1e-4), 1.0, is_orthographic);
    let farthest = select(max(depth + radius, 1e-4), 1.0, is_orthographic);
    let base = base_of(card);
    // Canonical lengths per metre, along and across: the groom may have made the card wider than the feather's own aspect.
    let aspect = lods::feather_row(base + data::SHAPE).x;
    let along = 1.0 / feather_length;
    let across = aspect * card.length / max(card.width, 1e-9) * along;
    // Off the optical axis a pixel spans less of a surface that faces it.
    let aside = length((lods::view.view_from_world * vec4(center, 1.0)).xy);
    let slant = select(nearest / max(length(vec2(nearest, aside + radius)), 1e-9), 1.0, is_orthographic);
    let minor = PIXEL_SIGMA * pixel * nearest * slant * LEAST_STRETCH * min(along, across);
    let major = PIXEL_SIGMA * pixel * farthest * max(along, across) * MAX_ASPECT;
    let vanes = array(feather_vane(base, data::LEFT_VANE), feather_vane(base, data::RIGHT_VANE));
    let left = classify_bounds(vanes[0], minor, major, lods::params.threshold);
    let right = classify_bounds(vanes[1], minor, major, lods::params.threshold);
    let level = select(data::CARD_MIXED, left, left == right);
    if (level != data::CARD_MEAN || lods::params.light_budget <= 0.0 || vertex_count < LIT_VERTICES) {
        return level;
    }
    let world_normal = normalize((world_from_local * vec4(card.normal, 0.0)).xyz);
    let step = pixel * select(depth, 1.0, is_orthographic);
    let pixels = feather_length * feather_length * card.width / max(card.length * step * step, 1e-12);
    let mirrors = max(lods::feather_row(base + data::PAINT).w, lods::feather_row(base + data::PAINT + 1u).w);
    let error = light_error(data::card_turn(card.tint), world_normal, eye_of(center), mirrors) / lods::params.light_budget;
    let period = max(max(vanes[0].p_b, vanes[0].d_bl), max(vanes[1].p_b, vanes[1].d_bl));
    let mean = minor / period * inverseSqrt(lods::params.threshold);
    let most = min((LIT_MOST - error) / (LIT_MOST - 1.0), (mean - 1.0) / LIT_FAR);
    let share = min((pixels - LIT_PIXELS.x) / (LIT_PIXELS.y - LIT_PIXELS.x), most);
    let lit = u32(clamp(share, 0.0, 1.0) * f32(data::LIT_SHARES) + 0.5);
    return select(data::CARD_MEAN, data::lod_bits(data::CARD_LIT, lit), lit > 0u);
}

@compute @workgroup_size(64)
fn classify(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= lods::card_count()) {
        return;
    }
    let card = lods::card_at(id.x);
    let world_from_local = lods::blended(card.joints, card.weights);
    let vertex_count = lods::patches[min(id.x, arrayLength(&lods::patches) - 1u)].y;
    let level = classify_card(card, vertex_count, world_from_local);
    let eye = eye_of((world_from_local * vec4(card.center, 1.0)).xyz);
    let facing = dot((world_from_local * vec4(card.normal, 0.0)).xyz, eye);
    lods::lod[id.x] = level | select(0u, data::LOD_BACK, facing < 0.0);
    if (lods::params.hides == 0u) {
        atomicAdd(&lods::grid[min(data::lod_class(level), data::CARD_HIDDEN)], 1u);
    } else if (level != data::CARD_CULLED) {
        let stretch = length((world_from_local * vec4(card.along, 0.0)).xyz);
        measure(id.x, card.width * stretch, eye);
    }
}
