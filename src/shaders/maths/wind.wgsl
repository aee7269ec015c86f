// Wind and ruffle bend a card about its root (twin of src/maths/wind.rs).
#define_import_path bevy_plumage::wind

struct Breeze {
    // Unit vector the air moves along.
    direction: vec3<f32>,
    // Steady speed, m/s.
    speed: f32,
    // Speed that gusts add, m/s.
    gusts: f32,
    // Size of an eddy, metres.
    eddy: f32,
    // How often an eddy changes, 1/s.
    frequency: f32,
}

// Share of a gust that small eddies make.
const EDDY_SHARE: f32 = 0.3;
// A gust is this many eddies long.
const GUST_CELLS: f32 = 4.0;
// Share of the opening that wind along the lay presses flat.
const PRESSING: f32 = 0.1;
// Largest angle downwards over that upwards: the body is in the way.
const FLATTENING: f32 = 0.25;

// Integer hash (PCG, O'Neill 2014) of a lattice point, in [0, 1).
fn lattice_value(point: vec3<i32>) -> f32 {
    let mixed = bitcast<u32>(point.x) + 1664525u * (bitcast<u32>(point.y) + 1013904223u * bitcast<u32>(point.z));
    let state = mixed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

// Value noise in [0, 1), smooth, one lattice cell per unit.
fn value_noise(p: vec3<f32>) -> f32 {
    let base = floor(p);
    let f = p - base;
    let s = f * f * (3.0 - 2.0 * f);
    let i = vec3<i32>(clamp(base, vec3(-1e9), vec3(1e9)));
    let x00 = mix(lattice_value(i), lattice_value(i + vec3(1, 0, 0)), s.x);
    let x10 = mix(lattice_value(i + vec3(0, 1, 0)), lattice_value(i + vec3(1, 1, 0)), s.x);
    let x01 = mix(lattice_value(i + vec3(0, 0, 1)), lattice_value(i + vec3(1, 0, 1)), s.x);
    let x11 = mix(lattice_value(i + vec3(0, 1, 1)), lattice_value(i + vec3(1, 1, 1)), s.x);
    return mix(mix(x00, x10, s.y), mix(x01, x11, s.y), s.z);
}

// Velocity of the air, m/s. Gusts travel with it.
fn wind_velocity(breeze: Breeze, position: vec3<f32>, time: f32) -> vec3<f32> {
    let carried = position - breeze.direction * ((breeze.speed + 0.5 * breeze.gusts) * time);
    let eddy = carried / max(breeze.eddy, 1e-3);
    let turned = eddy + vec3(0.0, breeze.frequency * time, 0.0);
    let gust = (1.0 - EDDY_SHARE) * value_noise(eddy / GUST_CELLS) + EDDY_SHARE * value_noise(turned);
    return breeze.direction * (breeze.speed + breeze.gusts * gust);
}

// Angle in radians by which the tip of a feather lifts off (below 0: is pressed down). Wind against the lay opens the coat,
// wind along it presses it flat. `compliance` in rad s^2 m^-2.5, `limit` in radians.
fn wind_lift(wind: vec3<f32>, along: vec3<f32>, normal: vec3<f32>, length: f32, compliance: f32, limit: f32) -> f32 {
    let against = dot(along, wind);
    let under = dot(normal, wind);
    let opening = max(-against, 0.0) + max(under, 0.0);
    let pressing = max(against, 0.0) + max(-under, 0.0);
    let drive = compliance * sqrt(max(length, 0.0)) * (opening * opening - PRESSING * pressing * pressing);
    let most = select(limit, FLATTENING * limit, drive < 0.0);
    return most * drive / max(most + abs(drive), 1e-9);
}

// `v` turned about the axis of `turn` by its length in radians (Rodrigues).
fn turned_by(v: vec3<f32>, turn: vec3<f32>) -> vec3<f32> {
    let angle = length(turn);
    if (angle < 1e-7) {
        return v;
    }
    let axis = turn / angle;
    return v * cos(angle) + cross(axis, v) * sin(angle) + axis * (dot(axis, v) * (1.0 - cos(angle)));
}
