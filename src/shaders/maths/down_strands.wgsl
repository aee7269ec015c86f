#define_import_path bevy_plumage::down_strands

// Explicit strands: cubic curves drawn as ribbons. Twin of src/maths/undercoat/strands/curve.rs, where the comments are.

const LEAST_RISE: f32 = 0.1;
const LEAST_COSINE: f32 = 0.02;

// How a strand leaves the skin.
struct StrandShape {
    root: vec3<f32>,
    normal: vec3<f32>,
    lay: vec3<f32>,
    bend: f32,
    length: f32,
    gravity: vec3<f32>,
    sag: f32,
}

// Control points of the curve.
struct StrandCurve {
    points: array<vec3<f32>, 4>,
}

// Half width and coverage of a ribbon.
struct Ribbon {
    half_width: f32,
    coverage: f32,
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let l = length(v);
    return select(other, v / max(l, 1e-6), l > 1e-6);
}

// Turns `d` towards `goal` by `angle`, no further than to the goal.
fn strand_turn(d: vec3<f32>, goal: vec3<f32>, angle: f32) -> vec3<f32> {
    let cosine = clamp(dot(d, goal), -1.0, 1.0);
    let across = goal - cosine * d;
    let sine = length(across);
    if sine < 1e-4 || angle <= 0.0 {
        return d;
    }
    let turned = min(angle, atan2(sine, cosine));
    return cos(turned) * d + (sin(turned) / sine) * across;
}

// Direction of the strand at height `z` (0 to 1).
fn strand_direction(shape: StrandShape, z: f32) -> vec3<f32> {
    let blend = clamp(shape.bend * z, 0.0, 1.0);
    let mixed = (1.0 - blend) * shape.normal + blend * shape.lay;
    let d = strand_turn(unit_or(mixed, shape.normal), shape.gravity, shape.sag * z * z);
    let rise = dot(d, shape.normal);
    if rise >= LEAST_RISE {
        return d;
    }
    let along = unit_or(d - rise * shape.normal, shape.normal);
    return unit_or(sqrt(1.0 - LEAST_RISE * LEAST_RISE) * along + LEAST_RISE * shape.normal, shape.normal);
}

fn strand_velocity(curve: StrandCurve, s: f32) -> vec3<f32> {
    let r = 1.0 - s;
    let p = curve.points;
    return 3.0 * r * r * (p[1] - p[0]) + 6.0 * r * s * (p[2] - p[1]) + 3.0 * s * s * (p[3] - p[2]);
}

fn strand_curve(shape: StrandShape) -> StrandCurve {
    let middle = (2.0 / 3.0) * strand_direction(shape, 2.0 / 3.0);
    let tip = middle + (1.0 / 3.0) * strand_direction(shape, 1.0);
    var curve = StrandCurve(array<vec3<f32>, 4>(vec3(0.0), (1.0 / 3.0) * shape.normal, middle, tip));
    let sum = 0.1184634425 * (length(strand_velocity(curve, 0.0469100770)) + length(strand_velocity(curve, 0.9530899230)))
        + 0.2393143352 * (length(strand_velocity(curve, 0.2307653449)) + length(strand_velocity(curve, 0.7692346551)))
        + 0.2844444444 * length(strand_velocity(curve, 0.5));
    let scale = shape.length / max(sum, 1e-3);
    for (var i = 0u; i < 4u; i++) {
        curve.points[i] = shape.root + scale * curve.points[i];
    }
    return curve;
}

// Point of the curve at `s`.
fn strand_point(curve: StrandCurve, s: f32) -> vec3<f32> {
    let r = 1.0 - s;
    let p = curve.points;
    return r * r * r * p[0] + 3.0 * r * r * s * p[1] + 3.0 * r * s * s * p[2] + s * s * s * p[3];
}

// Unit tangent of the curve at `s`.
fn strand_tangent(curve: StrandCurve, s: f32, fallback: vec3<f32>) -> vec3<f32> {
    return unit_or(strand_velocity(curve, s), fallback);
}

// Segments of a strand of `pixels` on screen that may be `tolerance` pixels off.
fn strand_segments(bend: f32, pixels: f32, tolerance: f32) -> f32 {
    let wanted = 0.42 * abs(bend) * max(pixels, 0.0) / max(tolerance, 1e-3);
    return clamp(ceil(sqrt(wanted)), 2.0, 12.0);
}

// Radius at `s` from the root (0) to the tip (1).
fn strand_radius(root: f32, s: f32) -> f32 {
    return root * pow(clamp(1.0 - s, 0.0, 1.0), 0.7);
}

// Opacity along the strand.
fn strand_alpha(fade: f32, s: f32) -> f32 {
    return exp(-(max(fade, 0.0) * clamp(s, 0.0, 1.0)));
}

// Light that the undercoat above lets through.
fn strand_shadow(column: f32, cosine: f32) -> f32 {
    return select(0.0, exp(-(max(column, 0.0) / max(cosine, LEAST_COSINE))), cosine > 0.0);
}

// Direction across a ribbon that faces the eye.
fn strand_side(tangent: vec3<f32>, view: vec3<f32>, right: vec3<f32>) -> vec3<f32> {
    let side = cross(tangent, view);
    let l = length(side);
    let share = clamp(l / 0.05, 0.0, 1.0);
    if share >= 1.0 {
        return side / l;
    }
    let turned = select(right, -right, dot(side, right) < 0.0);
    return unit_or(share * unit_or(side, turned) + (1.0 - share) * turned, right);
}

// Ribbon of a strand of `radius` where one pixel is `pixel` wide.
fn strand_ribbon(radius: f32, pixel: f32) -> Ribbon {
    let least = 0.5 * max(pixel, 1e-12);
    let r = max(radius, 0.0);
    return Ribbon(max(r, least), min(r / least, 1.0));
}
