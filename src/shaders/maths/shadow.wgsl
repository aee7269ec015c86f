// Shadows between the fibres of a vane: which share of a fibre that the eye sees is reached by a light. Twin of
// src/maths/query/shadow.rs.
#define_import_path bevy_plumage::shadow
#import bevy_plumage::masking::{
    Storey, Storeys, Vane, VaneShape, barb_hidden, storey_blocks, storeys,
}

const SHADOW_TAU: f32 = 6.28318530717959;
const SHADOW_LEAST_FACING: f32 = 1e-3;
// Fibres of a vane: barbs, and the barbules that the eye meets first and then.
const VANE_BARBS: u32 = 0u;
const VANE_UPPER: u32 = 1u;
const VANE_LOWER: u32 = 2u;

// Where mirror lobes leave a fibre: azimuthal roughness, and places of entry and exit between the normal half way (0) and the
// direction (1).
struct MirrorPlace {
    blur: f32,
    retreat: f32,
}

// The fibres of one part as the eye sees them: see the Rust struct of the same name.
struct PartEye {
    across: vec2<f32>,
    middle: vec2<f32>,
    reach: f32,
    wide: f32,
    gap: vec2<f32>,
    per_gap: f32,
    open: f32,
    shift: f32,
    ripple: f32,
}

// How an eye lies to the storeys of a vane, what the lights of a pixel share: see the Rust struct of the same name; its parts are
// asked for one by one.
struct VaneEye {
    shape: VaneShape,
    distal_above: bool,
    layers: Storeys,
    of_barb: MirrorPlace,
    of_barbule: MirrorPlace,
}

// How a light lies to them.
struct VaneRay {
    along: f32,
    facing: f32,
    beyond: bool,
    up: f32,
    layers: Storeys,
    upper: Storey,
    lower: Storey,
}

// What of a light reaches the fibres of one part: see the Rust struct of the same name.
struct VaneLight {
    mirror: f32,
    lit: f32,
    even: f32,
    along: f32,
    place: f32,
}

// sin(x) / x.
fn sinc_ratio(x: f32) -> f32 {
    return select(sin(x) / x, 1.0 - x * x / 6.0, abs(x) < 1e-3);
}

// How far from the normal half way a mirror core lets light in and out.
fn mirror_retreat(core: f32, eta: f32) -> f32 {
    return (1.0 - core) / (eta * core + 1.0 - core);
}

// Radians per radius of the lower fibres, of the upper barbules' shadow along a lower barbule.
fn grating_frequency(vane: Vane, distal_above: bool) -> f32 {
    let radius = select(vane.r_bd, vane.r_bp, distal_above);
    return SHADOW_TAU * radius * 2.0 * vane.cos_bl * vane.sin_bl / max(vane.d_bl * vane.sin_bl, 1e-9);
}

// Unit vector to a direction in the cross-section of fibres that it meets with `slope`.
fn cross_section(slope: f32, up: f32) -> vec2<f32> {
    return vec2(slope, up) * inverseSqrt(1.0 + slope * slope);
}

// Radii below the ray through the axis from which on neighbors hide a fibre, and the share of its silhouette that they leave.
fn family_reach(wide: f32) -> vec2<f32> {
    let inverse = 1.0 / max(wide, 1e-3);
    return vec2(2.0 * inverse - 1.0, min(inverse, 1.0));
}

// Middle of what a direction meets of a fibre of which it meets the share `own`, for all harmonics of what the medulla remembers.
fn family_middle(direction: vec2<f32>, own: f32, up: f32) -> vec2<f32> {
    let tilt = (1.0 - own) * 1.27323954473516 * up;
    return vec2(direction.x * (0.74 + 0.34 * up), direction.y + tilt * abs(direction.x));
}

// Gap between two barbs at a height above the middle of the vane in lifts, in barb periods.
fn barb_gap(shape: VaneShape, s: Storeys, height: f32) -> vec2<f32> {
    let near = shape.barb * shape.per_barb;
    let far = max((s.silhouette - height * shape.lift * abs(s.slope)) * shape.per_barb, near);
    let above = select(far, near, s.slope > 0.0);
    return vec2(above, max(1.0 - select(near, far, s.slope > 0.0), above));
}

// Share of a barb's silhouette that the barbules beside it leave open.
fn barb_open(shape: VaneShape, s: Storeys) -> f32 {
    let by = barb_hidden(shape, s);
    let long = max(2.0 * s.silhouette, 1e-9);
    return clamp(min(long - by.x - by.y, shape.vane.p_b) / long, 0.0, 1.0);
}

// The upper grating on the axis of the lower barbules: its place there in periods, and the amplitude of its shadow.
fn grating(shape: VaneShape, upper: Storey, lower: Storey) -> vec2<f32> {
    let c = shape.vane.cos_bl;
    let b = shape.vane.sin_bl;
    let cosine = c * c - b * b;
    let radius = lower.family.radius * inverseSqrt(1.0 + lower.slope * lower.slope);
    let middle = 0.785398163397448 * radius * (upper.slope - cosine * lower.slope);
    let breadth = radius * abs(shape.vane.hooked * cosine + lower.slope * upper.slope);
    return vec2(
        (2.0 * shape.lift * upper.slope - middle) * shape.per_barbule,
        0.318309886183791 * sin(SHADOW_TAU * min(0.5 * upper.wide, 0.5)) * sinc_ratio(SHADOW_TAU * breadth * shape.per_barbule),
    );
}

// What of light from a direction the vane catches, per area of the vane.
fn vane_caught(shape: VaneShape, s: Storeys, facing: f32) -> f32 {
    let open = max(1.0 - 2.0 * s.silhouette * shape.per_barb, 0.0)
        * (1.0 - min(s.first.wide, 1.0)) * (1.0 - min(s.second.wide, 1.0));
    return abs(facing) * (1.0 - open);
}

// direction: unit, canonical frame of the left vane.
fn vane_eye(shape: VaneShape, direction: vec3<f32>, of_barb: MirrorPlace, of_barbule: MirrorPlace) -> VaneEye {
    return VaneEye(shape, direction.z >= 0.0, storeys(shape, direction), of_barb, of_barbule);
}

// The fibres of one of VANE_BARBS, VANE_UPPER and VANE_LOWER as the eye sees them: what they share once, or a shader that asks for
// them in a loop holds it three times.
fn vane_part(shape: VaneShape, s: Storeys, kind: u32) -> PartEye {
    let barbs = kind == VANE_BARBS;
    let lower = kind == VANE_LOWER;
    let slope = select(select(s.first.slope, s.second.slope, lower), s.slope, barbs);
    let wide = select(select(s.first.wide, s.second.wide, lower), 2.0 * s.silhouette * shape.per_barb, barbs);
    var part: PartEye;
    part.across = select(cross_section(slope, 1.0), vec2(slope, 1.0) * s.per_root, barbs);
    let reach = family_reach(wide);
    part.reach = reach.x;
    part.wide = max(wide, 1.0);
    if barbs {
        part.open = barb_open(shape, s);
        part.middle = family_middle(part.across, part.open, 1.0);
        return part;
    }
    part.middle = family_middle(part.across, reach.y, 1.0);
    part.gap = barb_gap(shape, s, select(1.5, -0.5, lower));
    part.per_gap = 1.0 / max(part.gap.y - part.gap.x, 1e-6);
    if lower {
        part.open = max(1.0 - s.first.wide, 0.0);
        let at = grating(shape, s.first, s.second);
        part.shift = at.x;
        part.ripple = 2.0 * at.y / max(part.open, 1e-3);
    }
    return part;
}

// The barbs as the eye sees them.
fn barb_eye(shape: VaneShape, s: Storeys) -> PartEye { return vane_part(shape, s, VANE_BARBS); }

// The barbules that the eye meets first.
fn upper_eye(shape: VaneShape, s: Storeys) -> PartEye { return vane_part(shape, s, VANE_UPPER); }

// The barbules that the eye sees through the gaps of the others.
fn lower_eye(shape: VaneShape, s: Storeys) -> PartEye { return vane_part(shape, s, VANE_LOWER); }

// A light, in the same frame.
fn vane_ray(eye: VaneEye, direction: vec3<f32>) -> VaneRay {
    let s = storeys(eye.shape, direction);
    if (direction.z >= 0.0) != eye.distal_above {
        return VaneRay(direction.y, direction.z, true, -1.0, s, s.second, s.first);
    }
    return VaneRay(direction.y, direction.z, false, 1.0, s, s.first, s.second);
}

// The normal half way between eye and light in a cross-section, and cosine and sine of the angle to it.
fn halfway(eye: vec2<f32>, light: vec2<f32>) -> vec4<f32> {
    let sum = eye + light;
    let square = dot(sum, sum);
    return vec4(sum, 0.5 * square, light.x * eye.y - light.y * eye.x) * inverseSqrt(max(square, 1e-12));
}

// How much of the place where a mirror lobe enters and leaves is both seen and lit within its family, and the scale by which a point
// between the normal half way and a direction is on the circle.
fn family_within(eye: PartEye, light: vec2<f32>, reach: f32, up: f32, between: vec4<f32>, mirror: MirrorPlace) -> vec2<f32> {
    let rest = 1.0 - mirror.retreat;
    let scale = inverseSqrt(max(rest * rest + mirror.retreat * (mirror.retreat + 2.0 * rest * between.z), 1e-12));
    // How far down from the ray through the axis the place is, and how far roughness spreads it.
    let side = rest * scale * between.w;
    let spread = max(mirror.blur * (rest * between.z + mirror.retreat) * scale, 1e-3);
    let seen = eye.reach - select(side, -side, eye.across.x < 0.0);
    let lit = reach - up * select(-side, side, light.x < 0.0);
    return vec2(clamp(0.5 + min(seen, lit) / spread, 0.0, 1.0), scale);
}

// Share of light along `s` that reaches a point of a barb between its barbules.
fn barb_reached(shape: VaneShape, s: Storeys, point: vec2<f32>, up: f32) -> f32 {
    let across = select(point.x, -point.x, s.slope < 0.0);
    let foot = shape.barb * (up * point.y + (1.0 - across) / max(abs(s.slope), 1e-4));
    let hooked = shape.vane.hooked;
    return (1.0 - storey_blocks(s.first, (foot - shape.lift) * s.first.family.inverse, hooked))
        * (1.0 - storey_blocks(s.second, (foot + shape.lift) * s.second.family.inverse, hooked));
}

// Share of a gap between barbs that the light sees as well, at a height in lifts.
fn between_barbs(shape: VaneShape, part: PartEye, ray: VaneRay, height: f32) -> f32 {
    let light = barb_gap(shape, ray.layers, height);
    return clamp((min(part.gap.y, light.y) - max(part.gap.x, light.x)) * part.per_gap, 0.0, 1.0);
}

// What of a light reaches the shaft that an eye sees.
fn shaft_light(ray: VaneRay) -> VaneLight {
    let n = max(abs(ray.facing), SHADOW_LEAST_FACING);
    let open = 0.5 + 0.5 * min(n * inverseSqrt(max(1.0 - ray.along * ray.along, n * n)), 1.0);
    return VaneLight(open, open, open, 0.0, 1.0);
}

// The fibres of one of VANE_BARBS, VANE_UPPER and VANE_LOWER.
fn vane_light(eye: VaneEye, part: PartEye, ray: VaneRay, kind: u32) -> VaneLight {
    let shape = eye.shape;
    let barbs = kind == VANE_BARBS;
    let lower = kind == VANE_LOWER;
    let slope = select(select(ray.upper.slope, ray.lower.slope, lower), ray.layers.slope, barbs);
    let wide = select(select(ray.upper.wide, ray.lower.wide, lower), 2.0 * ray.layers.silhouette * shape.per_barb, barbs);
    let mirror = MirrorPlace(
        select(eye.of_barbule.blur, eye.of_barb.blur, barbs),
        select(eye.of_barbule.retreat, eye.of_barb.retreat, barbs),
    );
    let light = select(cross_section(slope, ray.up), vec2(slope, ray.up) * ray.layers.per_root, barbs);
    let reach = family_reach(wide);
    let between = halfway(part.across, light);
    let within = family_within(part, light, reach.x, ray.up, between, mirror);
    let place = dot(part.middle, family_middle(light, reach.y, ray.up));
    if barbs {
        let to_eye = within.y * mix(between.xy, part.across, mirror.retreat);
        let to_light = within.y * mix(between.xy, light, mirror.retreat);
        let seen = barb_reached(shape, eye.layers, to_eye, 1.0);
        var lit = barb_reached(shape, ray.layers, to_light, ray.up);
        var both = lit * seen;
        // Eye and light over the same flank look through the same gaps.
        if !ray.beyond && eye.layers.slope * ray.layers.slope > 0.0 {
            both = min(lit, seen);
            lit = min(lit / max(seen, 1e-4), 1.0);
        }
        return VaneLight(within.x * both / max(part.open, 1e-3), within.x * lit, barb_open(shape, ray.layers), 0.0, place);
    }
    var gap = between_barbs(shape, part, ray, select(1.5, -0.5, lower != ray.beyond));
    var through = 1.0;
    var even = 1.0;
    var along = 0.0;
    if !lower && ray.beyond {
        gap *= max(1.0 - ray.lower.wide, 0.0);
    }
    if lower && !ray.beyond {
        // From the very same place: the overlap of two gaps.
        even = max(1.0 - ray.upper.wide, 0.0);
        let height = 2.0 * shape.lift - ray.lower.family.radius * between.y;
        let turns = height * (ray.upper.slope - eye.layers.first.slope) * shape.per_barbule;
        let shift = abs(turns - floor(turns + 0.5));
        let overlap = clamp(vec2(0.5 * (part.open + even)) - vec2(shift, 1.0 - shift), vec2(0.0), vec2(min(part.open, even)));
        through = min((overlap.x + overlap.y) / max(part.open, 1e-3), 1.0);
        let at = grating(shape, ray.upper, ray.lower);
        along = reach.y * gap * part.ripple * at.y * cos(SHADOW_TAU * (at.x - part.shift));
    }
    let whole = within.x * part.wide * through * gap;
    return VaneLight(whole, whole, reach.y * even * gap, along, place);
}

// The barbs.
fn barb_light(eye: VaneEye, part: PartEye, ray: VaneRay) -> VaneLight { return vane_light(eye, part, ray, VANE_BARBS); }

// The barbules that an eye meets first.
fn upper_light(eye: VaneEye, part: PartEye, ray: VaneRay) -> VaneLight { return vane_light(eye, part, ray, VANE_UPPER); }

// The barbules that an eye sees through the gaps of the others.
fn lower_light(eye: VaneEye, part: PartEye, ray: VaneRay) -> VaneLight { return vane_light(eye, part, ray, VANE_LOWER); }
