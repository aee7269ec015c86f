#define_import_path bevy_plumage::down_density

// Procedural down. Twin of src/maths/undercoat/density.rs, where the comments are.

struct DownShape {
    clumps: u32,
    fibres: u32,
    jitter: f32,
    valley: f32,
    tip: f32,
    bend: f32,
    lay: vec2<f32>,
    spread: vec2<f32>,
    seed: u32,
}

fn lattice_noise(x: u32, y: u32, seed: u32) -> f32 {
    var state = x * 0x9E3779B1u + y * 0x85EBCA77u + seed * 0xC2B2AE3Du;
    for (var i = 0u; i < 2u; i++) {
        state = state * 747796405u + 2891336453u;
        state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
        state ^= state >> 22u;
    }
    return f32(state >> 8u) / 16777216.0;
}

fn lattice_wrap(x: f32, period: f32) -> u32 {
    return u32(x - period * floor(x / period)) % u32(period);
}

fn value_noise(u: f32, v: f32, points: u32, seed: u32) -> f32 {
    let n = max(points, 1u);
    let scale = f32(n);
    let x = vec2(u, v) * scale;
    let low = floor(x);
    let f = x - low;
    let t = f * f * (3.0 - f - f);
    let i = lattice_wrap(low.x, scale);
    let k = lattice_wrap(low.y, scale);
    let j = (i + 1u) % n;
    let l = (k + 1u) % n;
    let a = mix(lattice_noise(i, k, seed), lattice_noise(j, k, seed), t.x);
    let b = mix(lattice_noise(i, l, seed), lattice_noise(j, l, seed), t.x);
    return mix(a, b, t.y);
}

fn down_density(place: vec3<f32>, shape: DownShape) -> f32 {
    let seed = shape.seed * 8u;
    let shift = shape.jitter * place.z * place.z;
    let a = value_noise(place.x, place.y, 16u, seed);
    let b = value_noise(place.x, place.y, 16u, seed + 1u);
    let p = place.x + shift * (a - 0.5);
    let q = place.y + shift * (b - 0.5);
    let clump = value_noise(place.x, place.y, shape.clumps, seed + 2u);
    let fibre = 0.5 * (value_noise(p, q, shape.fibres, seed + 3u) + value_noise(p, q, 2u * shape.fibres, seed + 4u));
    let height = shape.valley + (1.0 - shape.valley) * clump;
    return fibre * clamp((height - place.z) / max(shape.tip, 0.01), 0.0, 1.0);
}

fn down_tangent(place: vec3<f32>, shape: DownShape) -> vec3<f32> {
    let seed = shape.seed * 8u + 5u;
    let random = vec3(
        value_noise(place.x, place.y, shape.fibres, seed),
        value_noise(place.x, place.y, shape.fibres, seed + 131u),
        value_noise(place.x, place.y, shape.fibres, seed + 262u),
    ) * 2.0 - 1.0;
    let bend = shape.bend * place.z;
    let spread = shape.spread.x + shape.spread.y * place.z;
    let t = vec3(bend * shape.lay, 1.0 - bend) + spread * random;
    let length = length(t);
    return select(vec3(0.0, 0.0, 1.0), t / max(length, 1e-12), length > 1e-9);
}
