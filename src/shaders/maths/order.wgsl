// How far behind the nearest feather another one may lie and still be seen, and what a vertex keeps of the poses. Twin of
// src/maths/order.rs.
#define_import_path bevy_plumage::order
#import bevy_plumage::math::smooth_step

// `window`: the widest; `facing`: cosine between the eye and the front face; `along`: share of the length.
fn order_reach(window: f32, facing: f32, along: f32) -> f32 {
    return window * clamp(8.0 * facing, 0.0, 1.0) * smooth_step(0.05, 0.3, along);
}

// Window of meshes that keep none.
const UNSETTLED_WINDOW: f32 = 0.1;
const WINDOW_MOST: f32 = 0.5;
const WINDOW_STEPS: f32 = 7.0;
const STIRRED_WINDOW: f32 = 0.3;
const STIRRED_ANGLE: f32 = 0.1;
const HELD_STEPS: f32 = 3.0;
const RAISED_MOST: f32 = 1023.0;

// Heights in the poses after the first over the first, -1..1. `words`: 16 bits each.
fn raised_heights(words: vec4<u32>) -> vec4<f32> {
    return (vec4<f32>(words & vec4(0x7ffu)) - (RAISED_MOST + 1.0)) / RAISED_MOST;
}

// The window, widths of a feather. `shares`: of the poses after the first; `between`: how far on the way from one to another.
fn raised_window(words: vec4<u32>, shares: vec4<f32>, between: f32) -> f32 {
    let steps = vec4<f32>((words >> vec4(11u)) & vec4(7u)) / WINDOW_STEPS;
    let bits = words.xyz >> vec3(14u);
    let first = f32(dot(bits & vec3(1u), vec3(1u, 2u, 4u))) / WINDOW_STEPS;
    let ways = f32(dot(bits >> vec3(1u), vec3(1u, 2u, 4u))) / WINDOW_STEPS;
    let own = first * first * (1.0 - dot(shares, vec4(1.0))) + dot(steps * steps, shares);
    return WINDOW_MOST * max(own, ways * ways * between);
}

// The widest of all windows of a vertex, widths of a feather.
fn raised_widest(words: vec4<u32>) -> f32 {
    let steps = (words >> vec4(11u)) & vec4(7u);
    let bits = words.xyz >> vec3(14u);
    let others = vec2(dot(bits & vec3(1u), vec3(1u, 2u, 4u)), dot(bits >> vec3(1u), vec3(1u, 2u, 4u)));
    let most = max(max(max(steps.x, steps.y), max(steps.z, steps.w)), max(others.x, others.y));
    let share = f32(most) / WINDOW_STEPS;
    return WINDOW_MOST * share * share;
}

// How far, 0..1, a feather is held down by stiffer ones over it.
fn raised_held(words: vec4<u32>, shares: vec4<f32>) -> f32 {
    return f32(words.w >> 14u) / HELD_STEPS * (1.0 - dot(shares, vec4(1.0)));
}

// The window of a feather that wind and ruffle have turned by `angle`, radians.
fn stirred_window(window: f32, angle: f32) -> f32 {
    return max(window, STIRRED_WINDOW * min(angle / STIRRED_ANGLE, 1.0));
}
