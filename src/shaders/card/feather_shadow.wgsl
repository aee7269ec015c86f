// Shadows between the fibres of a fragment, and what its fibres keep of light from all around.
#define_import_path bevy_plumage::feather_shadow
#import bevy_plumage::{
    feather_bindings::feather_at,
    feather_cover::{Covered, Frame},
    feather_data as data,
    scattering::FibreReach,
    shadow::{
        MirrorPlace, PartEye, VANE_BARBS, VANE_LOWER, VANE_UPPER, VaneEye, VaneRay, grating_frequency, shaft_light, vane_caught, vane_eye,
        vane_light, vane_part, vane_ray,
    },
}

// Frequency of the table of places (MEDULLA_PLACE in src/maths/scattering/medulla.rs).
const PLACE_FREQUENCY: f32 = 1.6;
// Root of 1 - cosine at the last level of kept light.
const KEPT_LAST: f32 = 0.9;

// The vane that a fragment shows most of, and the eye's view of it.
struct Shadowing {
    eye: VaneEye,
    beside: f32,
    // From the card's frame to the left vane's.
    mirror: vec3<f32>,
    // The barbules that the eye sees through the gaps of the others.
    lower: u32,
    // Square of the frequency of the shadow on lower barbules over that of the table.
    frequency: f32,
    // One over the integral of what the vane catches.
    caught: f32,
    // The eye in the table of kept light: first row of its level, the azimuths beside it, the weights of both levels.
    kept: u32,
    kept_steps: vec2<u32>,
    kept_weights: vec4<f32>,
}

// along: the fragment's place on the rachis, 0..1.
fn shadowing_of(base: u32, along: f32, covered: Covered, frame: Frame) -> Shadowing {
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right);
    var result: Shadowing;
    var vane = data::vane_unpack(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u));
    vane.hooked = covered.hook;
    // Below the vanes nothing lies beside the shaft.
    result.beside = smoothstep(-0.01, 0.01, along - feather_at(base + data::SHAPE).z);
    result.mirror = vec3(select(1.0, -1.0, covered.right), 1.0, 1.0);
    let eye = frame.local_eye * result.mirror;
    let mirrors = feather_at(base + data::MIRRORS);
    result.eye = vane_eye(vane, eye, MirrorPlace(mirrors.x, mirrors.y), MirrorPlace(mirrors.z, mirrors.w));
    let frequency = grating_frequency(vane, result.eye.distal_above) / PLACE_FREQUENCY;
    result.frequency = frequency * frequency;
    result.lower = select(2u, 3u, result.eye.distal_above);
    result.caught = feather_at(base + data::CAUGHT).x;
    // Across and along the barbs.
    let flat = vec2(
        eye.x * vane.cos_b + eye.y * vane.sin_b,
        eye.y * vane.cos_b - eye.x * vane.sin_b,
    );
    let turned = flat * select(1.0, -1.0, flat.x < 0.0);
    let turn = (0.5 * turned.y / max(turned.x + abs(turned.y), 1e-9) + 0.5) * f32(data::KEPT_AZIMUTHS);
    let step = min(u32(turn), data::KEPT_AZIMUTHS - 1u);
    let beside = turn - f32(step);
    let place = min(sqrt(max(1.0 - abs(eye.z), 0.0)) / KEPT_LAST, 1.0) * f32(data::KEPT_LEVELS - 1u);
    let level = min(u32(place), data::KEPT_LEVELS - 2u);
    let fraction = place - f32(level);
    result.kept_weights = vec4((1.0 - fraction) * vec2(1.0 - beside, beside), fraction * vec2(1.0 - beside, beside));
    result.kept = base + data::KEPT + data::KEPT_AZIMUTHS * level
        + select(8u * data::KEPT_LEVELS * data::KEPT_AZIMUTHS, 0u, result.eye.distal_above);
    result.kept_steps = vec2(step, select(step + 1u, 0u, step + 1u == data::KEPT_AZIMUTHS));
    return result;
}

// Shares of R, TT, TRT and the fourth lobe that a part keeps of light from the eye's side (side 0) or from the other (1).
fn kept_light(s: Shadowing, part: u32, side: u32) -> vec4<f32> {
    let row = vec2(s.kept + (2u * part + side) * data::KEPT_LEVELS * data::KEPT_AZIMUTHS) + s.kept_steps;
    let next = row + data::KEPT_AZIMUTHS;
    return s.kept_weights.x * feather_at(row.x) + s.kept_weights.y * feather_at(row.y)
        + s.kept_weights.z * feather_at(next.x) + s.kept_weights.w * feather_at(next.y);
}

// Light from a direction of the card.
fn light_ray(s: Shadowing, direction: vec3<f32>) -> VaneRay {
    return vane_ray(s.eye, direction * s.mirror);
}

// How much the vane catches of it, per steradian of light from all around.
fn caught_light(s: Shadowing, ray: VaneRay) -> f32 {
    return s.caught * vane_caught(s.eye.shape, ray.layers, ray.facing);
}

fn vane_kind(s: Shadowing, part: u32) -> u32 {
    return select(select(VANE_UPPER, VANE_LOWER, part == s.lower), VANE_BARBS, part == 1u);
}

// A part as the eye sees it.
fn part_eye(s: Shadowing, part: u32) -> PartEye {
    return vane_part(s.eye.shape, s.eye.layers, vane_kind(s, part));
}

// What of a light reaches one part, seen as `seen`; `turn`: cosine of the azimuth between eye and light
// around its fibres. `near`: the pixel sees a place on a barb, and not its whole silhouette.
fn part_reach(s: Shadowing, seen: PartEye, ray: VaneRay, part: u32, turn: f32, near: bool) -> FibreReach {
    if (part == 0u) {
        let open = mix(1.0, shaft_light(ray).even, s.beside);
        return FibreReach(open, open, 0.0, turn);
    }
    let light = vane_light(s.eye, seen, ray, vane_kind(s, part));
    return FibreReach(select(light.mirror, light.lit, near), light.even, light.along, light.place);
}
