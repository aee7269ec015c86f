// Shadows between the fibres of a fragment, and what its fibres keep of light from all around.
#define_import_path bevy_plumage::feather_shadow
#import bevy_plumage::{
    feather_bindings::{feather_at, shape_at},
    feather_cover::{Covered, Frame},
    feather_data as data,
    scattering::FibreReach,
    shadow::{
        MirrorPlace, PartEye, VANE_BARBS, VANE_LOWER, VANE_UPPER, VaneEye, VaneLight, VaneRay, barb_eye, barb_light, grating_frequency,
        lower_eye, lower_light, shaft_light, upper_eye, upper_light, vane_caught, vane_eye, vane_light, vane_part, vane_ray,
    },
}

// Frequency of the table of places (MEDULLA_PLACE in src/maths/scattering/medulla.rs).
const PLACE_FREQUENCY: f32 = 1.6;
// Root of 1 - cosine at the last level of kept light.
const KEPT_LAST: f32 = 0.9;

// The vane that a fragment shows most of, and the eye's view of it.
struct Shadowing {
    eye: VaneEye,
    // Share of a barb's silhouette that its barbules leave open to the eye.
    open: f32,
    beside: f32,
    // From the card's frame to the left vane's.
    mirror: vec3<f32>,
    // The barbules that the eye sees through the gaps of the others.
    lower: u32,
    // Square of the frequency of the shadow on lower barbules over that of the table.
    frequency: f32,
    // One over the integral of what the vane catches.
    caught: f32,
}

// The eye in the table of kept light: first row of its level, the azimuths beside it, the weights of both levels.
struct KeptPlace {
    first: u32,
    steps: vec2<u32>,
    weights: vec4<f32>,
}

// along: the fragment's place on the rachis, 0..1.
fn shadowing_of(base: u32, along: f32, covered: Covered, frame: Frame) -> Shadowing {
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right);
    var shape = shape_at(slot);
    shape.vane.hooked = covered.hook;
    var result = Shadowing();
    // Below the vanes nothing lies beside the shaft.
    result.beside = smoothstep(-0.01, 0.01, along - feather_at(base + data::SHAPE).z);
    result.mirror = vec3(select(1.0, -1.0, covered.right), 1.0, 1.0);
    let mirrors = feather_at(base + data::MIRRORS);
    let eye = frame.local_eye * result.mirror;
    result.eye = vane_eye(shape, eye, MirrorPlace(mirrors.x, mirrors.y), MirrorPlace(mirrors.z, mirrors.w));
    result.open = covered.open;
    let frequency = grating_frequency(shape.vane, result.eye.distal_above) / PLACE_FREQUENCY;
    result.frequency = frequency * frequency;
    result.lower = select(2u, 3u, result.eye.distal_above);
    result.caught = feather_at(base + data::CAUGHT).x;
    return result;
}

// Where the eye lies in the table of kept light.
fn kept_place(base: u32, right: bool, frame: Frame) -> KeptPlace {
    let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, right));
    let eye = frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
    // Across and along the barbs.
    let flat = vec2(
        eye.x * angles.y + eye.y * angles.x,
        eye.y * angles.y - eye.x * angles.x,
    );
    let turned = flat * select(1.0, -1.0, flat.x < 0.0);
    let turn = (0.5 * turned.y / max(turned.x + abs(turned.y), 1e-9) + 0.5) * f32(data::KEPT_AZIMUTHS);
    let step = min(u32(turn), data::KEPT_AZIMUTHS - 1u);
    let beside = turn - f32(step);
    let place = min(sqrt(max(1.0 - abs(eye.z), 0.0)) / KEPT_LAST, 1.0) * f32(data::KEPT_LEVELS - 1u);
    let level = min(u32(place), data::KEPT_LEVELS - 2u);
    let fraction = place - f32(level);
    return KeptPlace(
        base + data::KEPT + data::KEPT_AZIMUTHS * level + select(8u * data::KEPT_LEVELS * data::KEPT_AZIMUTHS, 0u, eye.z >= 0.0),
        vec2(step, select(step + 1u, 0u, step + 1u == data::KEPT_AZIMUTHS)),
        vec4((1.0 - fraction) * vec2(1.0 - beside, beside), fraction * vec2(1.0 - beside, beside)),
    );
}

// Shares of R, TT, TRT and the fourth lobe that a part keeps of light from the eye's side (side 0) or from the other (1).
fn kept_light(place: KeptPlace, part: u32, side: u32) -> vec4<f32> {
    let row = vec2(place.first + (2u * part + side) * data::KEPT_LEVELS * data::KEPT_AZIMUTHS) + place.steps;
    let next = row + data::KEPT_AZIMUTHS;
    return place.weights.x * feather_at(row.x) + place.weights.y * feather_at(row.y)
        + place.weights.z * feather_at(next.x) + place.weights.w * feather_at(next.y);
}

// Light from a direction of the card.
fn light_ray(s: Shadowing, direction: vec3<f32>) -> VaneRay {
    return vane_ray(s.eye, direction * s.mirror);
}

// What of a light reaches each of the four parts, as FibreReach has it: their numbers side by side. Only lower barbules have a shadow
// along them; `barb`: of what reaches a place on a barb.
struct Reaches {
    mirror: vec4<f32>,
    even: vec4<f32>,
    place: vec4<f32>,
    along: f32,
    barb: f32,
}

fn reaches_of(s: Shadowing, ray: VaneRay) -> Reaches {
    let shaft = mix(1.0, shaft_light(ray).even, s.beside);
    let shape = s.eye.shape;
    var seen = barb_eye(shape, s.eye.layers);
    seen.open = s.open;
    let barb = barb_light(s.eye, seen, ray);
    let upper = upper_light(s.eye, upper_eye(shape, s.eye.layers), ray);
    let lower = lower_light(s.eye, lower_eye(shape, s.eye.layers), ray);
    let above = s.eye.distal_above;
    return Reaches(
        vec4(shaft, barb.mirror, select(vec2(lower.mirror, upper.mirror), vec2(upper.mirror, lower.mirror), above)),
        vec4(shaft, barb.even, select(vec2(lower.even, upper.even), vec2(upper.even, lower.even), above)),
        vec4(0.0, barb.place, select(vec2(lower.place, upper.place), vec2(upper.place, lower.place), above)),
        lower.along,
        barb.lit,
    );
}

// Of one of the parts; `turn`: cosine of the azimuth between eye and light around its fibres. `near`: the pixel sees a place on a barb,
// and not its whole silhouette.
fn reach_of(r: Reaches, part: u32, lower: u32, turn: f32, near: bool) -> FibreReach {
    return FibreReach(
        select(r.mirror[part], r.barb, near && part == 1u),
        r.even[part],
        select(0.0, r.along, part == lower),
        select(r.place[part], turn, part == 0u),
    );
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

// What of a light reaches one part alone, seen as `seen`; `turn`: cosine of the azimuth between eye and light around its fibres.
fn part_reach(s: Shadowing, seen: PartEye, ray: VaneRay, part: u32, turn: f32) -> FibreReach {
    if (part == 0u) {
        let open = mix(1.0, shaft_light(ray).even, s.beside);
        return FibreReach(open, open, 0.0, turn);
    }
    let light = vane_light(s.eye, seen, ray, vane_kind(s, part));
    return FibreReach(light.mirror, light.even, light.along, light.place);
}
