#define_import_path bevy_plumage::down_light

#import bevy_plumage::down_march::{extinction_sine}

// Light on the fibres of a coat. Twin of src/maths/undercoat/light.rs, where the comments are.
//
// No bindings. Towards a directional light the user of the module samples the density at every light_step:
//
//   let way = light_exit(height, mu, curvature);
//   for (var i = 0u; i < 4u; i++) {
//       let step = light_step(i, 4u);
//       depth += density(place + step.x * way * light) * extinction_sine(...) * step.y * way;
//   }
//   let visible = exp(-depth);      // or column_transmittance(column, mu) without a fetch

const TWO_PI: f32 = 6.28318530717959;
const HALF_TURN: f32 = 3.14159265358979;

fn kajiya_kay_norm(spread: f32) -> f32 {
    let e = clamp(spread, 0.0, 1.0);
    let q = sqrt(1.0 - e * e);
    var arc = 1.0 + q * q * (1.0 / 6.0);
    if q >= 1e-2 {
        arc = atan2(q, e) / q;
    }
    return TWO_PI * (e + arc);
}

fn kajiya_kay_diffuse(albedo: vec3<f32>, cosine: f32, spread: f32) -> vec3<f32> {
    return albedo * (extinction_sine(cosine, spread) / kajiya_kay_norm(spread));
}

fn kajiya_kay_specular(albedo: f32, power: f32, eye: f32, light: f32) -> f32 {
    let p = clamp(power, 1.0, 1e4);
    let eye_c = clamp(eye, -1.0, 1.0);
    let light_c = clamp(light, -1.0, 1.0);
    let sin_eye = sqrt(1.0 - eye_c * eye_c);
    let sin_light = sqrt(1.0 - light_c * light_c);
    let mirror = max(sin_eye * sin_light - eye_c * light_c, 0.0);
    let square = sin_light * sin_light;
    let norm = TWO_PI * sqrt(TWO_PI / (p + 0.5)) * ((p + 1.0) * square + light_c * light_c) / (p + 2.0);
    // The power of zero is left to no built-in.
    let lobe = select(exp2(p * log2(max(mirror, 1e-30))), 0.0, mirror <= 0.0);
    return albedo * sin_light * lobe / max(norm, 1e-6);
}

fn cylinder_phase(sine: f32, phi: f32) -> f32 {
    let angle = clamp(abs(phi), 0.0, HALF_TURN);
    return sine * (sin(angle) + (HALF_TURN - angle) * cos(angle)) / (4.0 * HALF_TURN);
}

// x: middle, y: width.
fn light_step(i: u32, count: u32) -> vec2<f32> {
    let n = f32(max(count, 1u));
    let a = f32(i) / n;
    let b = f32(i + 1u) / n;
    return vec2(0.5 * (a * a + b * b), b * b - a * a);
}

fn light_exit(height: f32, cosine: f32, curvature: f32) -> f32 {
    let z = clamp(height, 0.0, 1.0);
    let mu = clamp(cosine, -1.0, 1.0);
    let k = clamp(curvature, 0.0, 1.0);
    let here = 1.0 + z * k;
    let sine = (1.0 - mu * mu) * here * here;
    let shadowed = sine <= 1.0 && mu < 0.0;
    if select(mu <= 0.0, shadowed, k > 0.0) {
        return 64.0;
    }
    let root = sqrt(max((1.0 + k) * (1.0 + k) - sine, 0.0));
    if mu > 0.0 {
        return min((1.0 - z) * (2.0 + (1.0 + z) * k) / max(root + here * mu, 1e-6), 64.0);
    }
    return min((root - here * mu) / k, 64.0);
}

fn sky_visibility(column: f32) -> f32 {
    let c = max(column, 0.0);
    return exp(-c) / (1.0 + 1.0071 * c + 0.488 * sqrt(c));
}

fn sky_irradiance(column: f32) -> f32 {
    let c = max(column, 0.0);
    return exp(-0.8745 * c) / (1.0 + 0.9206 * c);
}

fn aligned_visibility(column: f32) -> f32 {
    let c = max(column, 0.0);
    return 1.0 / (1.0 + 1.8585 * c + 0.7816 * c * c + 0.4527 * sqrt(c));
}

fn column_transmittance(column: f32, mu: f32) -> f32 {
    if mu <= 0.0 {
        return 0.0;
    }
    return exp(-clamp(column, 0.0, 1e4) / clamp(mu, 1e-3, 1.0));
}

fn scattering_h(mu: f32, albedo: vec3<f32>) -> vec3<f32> {
    let x = clamp(mu, 1e-4, 1.0);
    let a = clamp(albedo, vec3(0.0), vec3(1.0));
    let root = sqrt(1.0 - a);
    let r = (1.0 - root) / (1.0 + root);
    return 1.0 / (1.0 - a * x * (r + (0.5 - r * x) * log((1.0 + x) / x)));
}

fn scattering_albedo(albedo: vec3<f32>, skin: vec3<f32>, depth: f32) -> vec3<f32> {
    let dark = 1.0 - clamp(skin, vec3(0.0), vec3(1.0));
    return clamp(albedo, vec3(0.0), vec3(1.0)) * (1.0 - 0.13 * dark * exp(-max(depth, 0.0)));
}

fn multiple_scattering(eye: f32, light: f32, albedo: vec3<f32>) -> vec3<f32> {
    return scattering_h(eye, albedo) * scattering_h(light, albedo);
}

// A linear color of the skin from three bytes that hold its square roots.
fn packed_color(word: u32) -> vec3<f32> {
    let root = unpack4x8unorm(word).rgb;
    return root * root;
}
