// Where a card lies on the screen, by its very vertices.
#define_import_path bevy_plumage::feather_measure
#import bevy_plumage::{feather_lod_bindings as lods, order::{UNSETTLED_WINDOW, raised_heights, raised_widest}}

// Most vertices of a card.
const MOST_VERTICES: u32 = 256u;

fn word(index: u32) -> u32 {
    return lods::vertices[min(lods::params.first_word + index, arrayLength(&lods::vertices) - 1u)];
}

fn vector(index: u32) -> vec3<f32> {
    return vec3(bitcast<f32>(word(index)), bitcast<f32>(word(index + 1u)), bitcast<f32>(word(index + 2u)));
}

// The joints that carry a vertex.
fn matrix_at(at: u32) -> mat4x4<f32> {
    if (lods::params.joints == lods::NOTHING || lods::params.weights == lods::NOTHING) {
        return lods::params.world_from_local;
    }
    let joints = vec2(word(at + lods::params.joints), word(at + lods::params.joints + 1u));
    let weights = at + lods::params.weights;
    return lods::blended(
        vec4(joints.x & 0xffffu, joints.x >> 16u, joints.y & 0xffffu, joints.y >> 16u),
        vec4(vector(weights), bitcast<f32>(word(weights + 3u))),
    );
}

// What a vertex keeps of the poses.
fn raised_at(at: u32) -> vec4<u32> {
    let words = vec2(word(at + lods::params.raised), word(at + lods::params.raised + 1u));
    return vec4(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
}

// How far the order of the coat may bring a vertex forward in any pose, widths of its card.
fn window_at(at: u32) -> f32 {
    if (lods::params.raised == lods::NOTHING) {
        return min(lods::params.order_window, UNSETTLED_WINDOW);
    }
    return min(lods::params.order_window, raised_widest(raised_at(at)));
}

// A vertex in the world, as the pose that is worn has it.
fn place_of(at: u32) -> vec3<f32> {
    var position = vector(at);
    if (lods::params.raised != lods::NOTHING) {
        position += vector(at + lods::params.normal) * dot(raised_heights(raised_at(at)), lods::params.worn);
    }
    return (matrix_at(at) * vec4(position, 1.0)).xyz;
}

// Measures card `index` for `feather_hide`. `width`: of the card, metres; `eye`: towards the eye.
fn measure(index: u32, width: f32, eye: vec3<f32>) {
    let out = index * lods::MEASURED;
    let range = lods::patches[min(index, arrayLength(&lods::patches) - 1u)];
    let clip_from_world = lods::view.clip_from_world;
    var low = vec2(1e9);
    var high = vec2(-1e9);
    // Larger depths are nearer.
    var nearest = 0.0;
    var cut = range.y == 0u || range.y > MOST_VERTICES;
    for (var i = 0u; i < min(range.y, MOST_VERTICES); i++) {
        let vertex = (range.x + i) * lods::params.stride;
        let place = place_of(vertex);
        let clip = clip_from_world * vec4(place, 1.0);
        let forward = clip_from_world * vec4(place + eye * (window_at(vertex) * width), 1.0);
        let at = clip.xy / max(clip.w, 1e-9);
        let depth = forward.z / max(forward.w, 1e-9);
        low = min(low, at);
        high = max(high, at);
        nearest = max(nearest, depth);
        cut = cut || clip.w <= 1e-6 || forward.w <= 1e-6 || depth > 1.0;
    }
    if (cut) {
        // Nearer than everything.
        lods::measured[out] = vec4(-1.0, -1.0, 1.0, 1.0);
        lods::measured[out + 1u] = vec4(2.0);
        return;
    }
    lods::measured[out] = vec4(low, high);
    lods::measured[out + 1u] = vec4(nearest);
    atomicMax(&lods::grid[lods::BOUNDS], lods::bound_at(low.x, -1.0));
    atomicMax(&lods::grid[lods::BOUNDS + 1u], lods::bound_at(low.y, -1.0));
    atomicMax(&lods::grid[lods::BOUNDS + 2u], lods::bound_at(high.x, 1.0));
    atomicMax(&lods::grid[lods::BOUNDS + 3u], lods::bound_at(high.y, 1.0));
}
