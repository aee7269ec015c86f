#define_import_path bevy_plumage::down_march

// Marching a ray through the coat. Twin of src/maths/undercoat/march.rs, where the comments are.
//
// No bindings: the user of the module samples the density at every step and hands the values over:
//
//   First find the length, in heights of the coat: walk until the sum of mean_extinction(z, ...) times the way reaches DEPTH_CLIP
//   (flat: from the top down to march_floor(mu, ...)). Then
//   for (var i = 0u; i < u32(ceil(count)) && march.transmittance > OPAQUE; i++) {
//       let step = march_step(i, count, jitter);                         // share of the ray, width
//       let place = origin + step.x * length * direction;
//       let extinction = density(place) * extinction_sine(dot(tangent, direction), spread);
//       let depth = extinction * step.y * length;
//       let lit = (step.x + (march_lit(depth) - jitter) * step.y) * length;       // take the light here
//       march = march_add(march, depth, source, step.x * length);
//   }

const DEPTH_CLIP: f32 = 7.0;
const OPAQUE: f32 = 0.003;

struct March {
    radiance: vec3<f32>,
    transmittance: f32,
    distance: f32,
}

fn march_begin() -> March {
    return March(vec3(0.0), 1.0, 0.0);
}

fn march_add(m: March, depth: f32, source: vec3<f32>, distance: f32) -> March {
    let through = exp(-max(depth, 0.0));
    let weight = m.transmittance * (1.0 - through);
    return March(m.radiance + weight * source, m.transmittance * through, m.distance + weight * distance);
}

fn march_over(m: March, ground: vec3<f32>) -> vec3<f32> {
    return m.radiance + m.transmittance * ground;
}

fn march_mean_distance(m: March) -> f32 {
    return m.distance / max(1.0 - m.transmittance, 1e-6);
}

fn march_length(length: f32, mean: f32, clip: f32) -> f32 {
    return min(max(length, 0.0), max(clip, 0.0) / max(mean, 1e-6));
}

fn mean_extinction(z: f32, depth: f32, power: f32) -> f32 {
    let p = clamp(power, 1.0, 8.0);
    let rest = 1.0 - clamp(z, 0.0, 1.0);
    // The power of zero is left to no built-in.
    var shape = select(0.0, exp2((p - 1.0) * log2(max(rest, 1e-30))), rest > 0.0);
    if p == 1.0 {
        shape = 1.0;
    }
    return max(depth, 0.0) * p * shape;
}

fn march_floor(mu: f32, depth: f32, power: f32, clip: f32) -> f32 {
    let p = clamp(power, 1.0, 8.0);
    let share = clamp(max(clip, 0.0) * max(mu, 0.0) / max(depth, 1e-6), 0.0, 1.0);
    return 1.0 - select(exp2(log2(max(share, 1e-30)) / p), 0.0, share <= 0.0);
}

// x: place, y: width, both as shares of the ray.
fn march_step(i: u32, count: f32, jitter: f32) -> vec2<f32> {
    let n = clamp(count, 1.0, 64.0);
    let first = f32(i);
    let width = clamp(n - first, 0.0, 1.0);
    return vec2(first + jitter * width, width) / n;
}

// Where in a step of that optical depth its light is met, as a share of it from the eye's side.
fn march_lit(depth: f32) -> f32 {
    let d = clamp(depth, 0.0, 8.0);
    return 0.25 + 0.5 / (2.0 + d * (1.0 / 3.0) + d * d * (1.0 / 18.0));
}

// How far a fibre has come along the lay at height z, in heights of the coat.
fn lean_shift(z: f32, bend: f32) -> f32 {
    let b = clamp(bend, 0.0, 0.95);
    let h = clamp(z, 0.0, 1.0);
    let x = b * h;
    if x < 0.05 {
        return h * x * (0.5 + x * (1.0 / 3.0 + x * 0.25));
    }
    return -h - log(1.0 - x) / b;
}

fn march_jitter(noise: f32, frame: u32) -> f32 {
    return fract(noise + f32(frame & 1023u) * 0.618033988749895);
}

fn march_mip(cells: f32, deepest: f32) -> f32 {
    return clamp(log2(max(cells, 1.0)), 0.0, deepest);
}

fn extinction_sine(cosine: f32, spread: f32) -> f32 {
    let c = clamp(cosine * cosine, 0.0, 1.0);
    let e = clamp(spread, 0.0, 1.0);
    return sqrt(1.0 - c + e * e * c);
}
