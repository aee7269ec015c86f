// Shadows between the fibres of a fragment.
#define_import_path bevy_plumage::feather_shadow
#import bevy_plumage::{
    feather_bindings::feather_at,
    feather_cover::{Covered, Frame},
    feather_data as data,
    masking::Vane,
    shadow::{VaneSight, vane_shadow, vane_sight},
}

// The vane that a fragment shows most of, and the eye's view of it.
struct Shadowing {
    vane: Vane,
    eye: VaneSight,
    hooked: f32,
    beside: f32,
    // From the card's frame to the left vane's.
    mirror: vec3<f32>,
    front: bool,
}

// along: the fragment's place on the rachis, 0..1.
fn shadowing_of(base: u32, along: f32, covered: Covered, frame: Frame) -> Shadowing {
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right);
    var result: Shadowing;
    result.vane = data::vane_unpack(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u));
    result.hooked = covered.hook;
    // Below the vanes nothing lies beside the shaft.
    result.beside = smoothstep(-0.01, 0.01, along - feather_at(base + data::SHAPE).z);
    result.mirror = vec3(select(1.0, -1.0, covered.right), 1.0, 1.0);
    result.front = frame.local_eye.z >= 0.0;
    result.eye = vane_sight(result.vane, result.hooked, frame.local_eye * result.mirror, result.front);
    return result;
}

// Share of rachis, barbs, distal and proximal barbules that light from a direction of the world reaches.
fn reached(s: Shadowing, frame: Frame, direction: vec3<f32>) -> vec4<f32> {
    let local = vec3(dot(direction, frame.across), dot(direction, frame.along), dot(direction, frame.normal));
    let share = vane_shadow(s.eye, vane_sight(s.vane, s.hooked, local * s.mirror, s.front), s.front);
    return vec4(mix(1.0, share.x, s.beside), share.yzw);
}
