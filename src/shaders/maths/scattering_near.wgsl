// Near field: the part of a fibre's width that a narrow footprint sees. Twin of src/maths/scattering/near.rs.
#define_import_path bevy_plumage::scattering_near
#import bevy_plumage::scattering::{
    FIBRE_ROUND, FibreColor, FibreLobes, FibreParameters, FibreRow, FibreShading, SCATTERING_PI, fibre_acos, fibre_color, fibre_cosines,
    fibre_polar, fibre_shading, fibre_sum, fresnel, gamma_transmittance,
}
#import bevy_plumage::scattering_azimuth::{fibre_azimuths, fibre_sines}

const NEAR_SEGMENTS: u32 = 20u;
const NEAR_SEGMENT: f32 = 0.16;
const NEAR_LEAST: f32 = 4.0;
const NEAR_REACH: f32 = 2.5;
const NEAR_TERMS: f32 = 2.4;

// A fibre of which the pixel sees a part: the shading with the window's energies and even series, and the odd series.
struct FibreNear {
    shading: FibreShading,
    surface: array<vec4<f32>, 2>,
    clear: array<vec4<f32>, 2>,
    dense: array<vec4<f32>, 2>,
    inner: array<vec4<f32>, 2>,
    core: array<vec4<f32>, 2>,
}

// Energy and the coefficients of cos n phi and sin n phi.
struct NearSums {
    energy: f32,
    even: array<vec4<f32>, 2>,
    odd: array<vec4<f32>, 2>,
}

// One refraction; see `crossing` in src/maths/scattering/lobes.rs.
struct NearCrossing {
    gamma: f32,
    gamma_t: f32,
    offset: f32,
    fresnel: f32,
}

fn near_asin(x: f32) -> f32 {
    return 0.5 * SCATTERING_PI - fibre_acos(x);
}

// (lowest h, highest h, mean, 1 / deviation) of what a Gaussian footprint sees; its mean and deviation in half widths.
fn fibre_window(mean_in: f32, deviation: f32) -> vec4<f32> {
    let d = clamp(deviation, 1e-3, 1e3);
    let m = clamp(mean_in, -1.0 - d, 1.0 + d);
    let reach = NEAR_REACH * d;
    let least = min(reach, 0.02);
    let low = clamp(m - reach, -1.0, 1.0 - least);
    return vec4<f32>(low, clamp(m + reach, low + least, 1.0), m, 1.0 / d);
}

// Largest deviation of a footprint across a fibre, in half widths, for which the near field shows.
fn near_limit(threshold: f32) -> f32 {
    return 4.0 * sqrt(clamp(threshold, 0.01, 1.0));
}

// Grows without bound towards the limit, so that the near field passes into the far field; -1 beyond it.
fn near_deviation(deviation: f32, threshold: f32) -> f32 {
    let limit = near_limit(threshold);
    if !(deviation < limit) {
        return -1.0;
    }
    return deviation / max(1.0 - smoothstep(0.6, 1.0, deviation / limit), 1e-2);
}

fn near_add(sums: ptr<function, NearSums>, amount: f32, phi: f32, half: f32) {
    let angle = vec2<f32>(cos(phi), sin(phi));
    let c = fibre_cosines(angle.x, true);
    let s = fibre_sines(angle);
    let low = vec4<f32>(1.0, 2.0, 3.0, 4.0) * half;
    let high = low + 4.0 * half;
    let steps = fibre_sines(vec2<f32>(cos(half), sin(half)));
    let spread_low = amount * select(vec4<f32>(1.0), steps[0] / max(low, vec4<f32>(1e-3)), low > vec4<f32>(1e-3));
    let spread_high = amount * select(vec4<f32>(1.0), steps[1] / max(high, vec4<f32>(1e-3)), high > vec4<f32>(1e-3));
    (*sums).energy += amount;
    (*sums).even[0] += spread_low * c[0];
    (*sums).even[1] += spread_high * c[1];
    (*sums).odd[0] += spread_low * s[0];
    (*sums).odd[1] += spread_high * s[1];
}

fn near_damped(shape: array<vec4<f32>, 2>, energy: f32, blur: f32, harmonics: u32) -> array<vec4<f32>, 2> {
    let n = vec4<f32>(1.0, 2.0, 3.0, 4.0);
    let m = n + 4.0;
    let square = -0.5 * blur * blur;
    let last = vec4<f32>(f32(harmonics));
    let scale = select(0.0, 2.0 / max(energy, 1e-9), energy > 1e-9);
    return array<vec4<f32>, 2>(
        select(vec4<f32>(0.0), scale * shape[0] * exp(square * n * n), n <= last),
        select(vec4<f32>(0.0), scale * shape[1] * exp(square * m * m), m <= last),
    );
}

// 1 / eta' and the cosine of the inner ray's inclination.
fn near_refraction(eta: f32, cos_eye: f32) -> vec2<f32> {
    let c = clamp(cos_eye, 1e-3, 1.0);
    let sin_square = 1.0 - c * c;
    return vec2<f32>(
        c * inverseSqrt(max(eta * eta - sin_square, 1e-6)),
        sqrt(max(1.0 - sin_square / (eta * eta), 1e-6)),
    );
}

// TT and TRT of a ray beside the core, `depth` its optical depth per crossing.
fn near_beside(f: f32, depth: vec3<f32>) -> array<vec3<f32>, 2> {
    let t = exp(-depth);
    let enter = (1.0 - f) * (1.0 - f);
    return array<vec3<f32>, 2>(enter * t, enter * f * t * t / max(1.0 - f * t, vec3<f32>(1e-6)));
}

// Cosine in the cross-section between the eye and the normal of a flat fibre, where a round one has its normal gamma away.
fn near_flat_normal(s: FibreShading, gamma: f32) -> f32 {
    let a = s.surface_aspect;
    let o = s.azimuth;
    let raw = vec2<f32>(a * o.x, o.y);
    let t = raw * inverseSqrt(max(dot(raw, raw), 1e-12));
    let sine = sin(gamma);
    let cosine = cos(gamma);
    let n = vec2<f32>(a * (t.x * cosine + t.y * sine), t.y * cosine - t.x * sine);
    return dot(n, o) * inverseSqrt(max(dot(n, n), 1e-12));
}

fn fibre_near(
    p: FibreParameters,
    row: FibreRow,
    albedo: vec3<f32>,
    omega_o: vec3<f32>,
    dark_back: f32,
    harmonics: u32,
    window: vec4<f32>,
) -> FibreNear {
    var near: FibreNear;
    near.shading = fibre_shading(p, row, albedo, omega_o, dark_back, harmonics);
    let s = near.shading;
    let color = fibre_color(p, albedo);
    let refraction = near_refraction(p.eta, s.cos_eye);
    let low = clamp(window.x, -1.0, 1.0);
    let start = near_asin(low);
    let end = near_asin(clamp(window.y, low, 1.0));
    let count = u32(clamp(ceil((end - start) / NEAR_SEGMENT), select(1.0, NEAR_LEAST, window.w > 0.0), f32(NEAR_SEGMENTS)));
    let step = (end - start) / f32(count);
    let core = select(0.0, p.core, p.structural);
    let edge = near_asin(clamp(core / max(refraction.x, 1e-6), 0.0, 1.0));
    let flattened = p.aspect < FIBRE_ROUND;

    var surface: NearSums;
    var clear: NearSums;
    var dense: NearSums;
    var inner: NearSums;
    var mirror: NearSums;
    var through = vec3<f32>(0.0);
    var returned = vec3<f32>(0.0);
    var fourth = vec3<f32>(0.0);
    var width = 0.0;
    // Three pieces a segment: beside the core, on it, beside it on the other side.
    for (var k = 0u; k < 3u * count; k++) {
        var a = start + step * f32(k / 3u);
        var b = a + step;
        let side = k % 3u;
        if side == 0u { b = min(b, -edge); }
        if side == 1u { a = max(a, -edge); b = min(b, edge); }
        if side == 2u { a = max(a, edge); }
        if b - a < 1e-6 {
            continue;
        }
        let gamma = 0.5 * (a + b);
        let turn = 0.5 * (b - a);
        let h = sin(gamma);
        let off = (h - window.z) * window.w;
        let weight = 2.0 * cos(gamma) * sin(turn) * max(exp(-0.5 * off * off), 1e-4);
        width += weight;
        let offset = h * refraction.x;
        let gamma_t = near_asin(offset);
        let f = fresnel(s.cos_eye * cos(gamma), p.eta);
        var reflected = f;
        if flattened {
            reflected = fresnel(s.cos_eye * near_flat_normal(s, gamma), p.eta);
        }
        near_add(&surface, reflected * weight, 2.0 * gamma, 2.0 * turn);
        let ends = vec2<f32>(sin(a), sin(b)) * refraction.x;
        let refracted = 0.5 * (near_asin(ends.y) - near_asin(ends.x));
        let enter = (1.0 - f) * (1.0 - f);
        if p.structural && side == 1u {
            let scale = 1.0 / max(p.core, 1e-9);
            let at_a = near_asin(clamp(ends.x * scale, -1.0, 1.0));
            let at_b = near_asin(clamp(ends.y * scale, -1.0, 1.0));
            near_add(
                &mirror,
                enter / max(1.0 - f, 1e-6) * weight,
                2.0 * (gamma - gamma_t) + at_a + at_b,
                abs(2.0 * (turn - refracted) + at_b - at_a),
            );
            fourth += weight * enter * color.core / max(1.0 - f * color.core, vec3<f32>(1e-6));
            continue;
        }
        let path = 2.0 / refraction.y;
        let across = sqrt(max(1.0 - offset * offset, 0.0)) * path;
        let radius = select(p.core, 0.0, p.structural);
        let taken = p.scattering * sqrt(max(radius * radius - offset * offset, 0.0)) * path;
        // Without absorption, at 0.5 and at 2.
        let shapes = near_beside(f, vec3<f32>(0.0, 0.5, 2.0) * across + taken);
        let deflection = 2.0 * (gamma - gamma_t) - SCATTERING_PI;
        let spread = abs(2.0 * (turn - refracted));
        near_add(&clear, shapes[0].x * weight, deflection, spread);
        near_add(&dense, shapes[0].z * weight, deflection, spread);
        near_add(&inner, shapes[1].y * weight, 2.0 * gamma - 4.0 * gamma_t, abs(2.0 * turn - 4.0 * refracted));
        let lit = near_beside(f, color.absorption * across + taken);
        through += weight * lit[0];
        returned += weight * lit[1];
        if !p.structural {
            fourth += weight * max(1.0 - f - shapes[0].x - shapes[1].x, 0.0);
        }
    }
    let inverse = 1.0 / max(width, 1e-9);
    var entering = inverse;
    if flattened {
        entering *= (1.0 - s.energy_surface) / max(1.0 - row.energy.x, 1e-6);
    }
    if !p.structural {
        fourth *= gamma_transmittance(row.medulla.x, row.medulla.y, color.absorption);
    }
    near.shading.energy_surface = surface.energy * inverse;
    near.shading.energy_through = through * entering;
    near.shading.energy_inner = returned * entering;
    near.shading.energy_fourth = fourth * entering;
    near.shading.blur = max(s.blur, vec4<f32>(NEAR_TERMS / f32(s.harmonics)));
    let blur = near.shading.blur;
    near.shading.surface = near_damped(surface.even, surface.energy, blur.x, s.harmonics);
    near.shading.clear = near_damped(clear.even, clear.energy, blur.y, s.harmonics);
    near.shading.dense = near_damped(dense.even, dense.energy, blur.y, s.harmonics);
    near.shading.inner = near_damped(inner.even, inner.energy, blur.z, s.harmonics);
    near.shading.core = near_damped(mirror.even, mirror.energy, blur.w, s.harmonics);
    near.surface = near_damped(surface.odd, surface.energy, blur.x, s.harmonics);
    near.clear = near_damped(clear.odd, clear.energy, blur.y, s.harmonics);
    near.dense = near_damped(dense.odd, dense.energy, blur.y, s.harmonics);
    near.inner = near_damped(inner.odd, inner.energy, blur.z, s.harmonics);
    near.core = near_damped(mirror.odd, mirror.energy, blur.w, s.harmonics);
    return near;
}

fn near_series(even: array<vec4<f32>, 2>, odd: array<vec4<f32>, 2>, angle: vec2<f32>) -> f32 {
    let c = fibre_cosines(angle.x, true);
    let s = fibre_sines(angle);
    return 1.0 + dot(even[0], c[0]) + dot(even[1], c[1]) + dot(odd[0], s[0]) + dot(odd[1], s[1]);
}

// K of the window, RGB per steradian, for light from omega_i in the fibre's frame.
fn fibre_near_evaluate(near: FibreNear, omega_i: vec3<f32>) -> vec3<f32> {
    let lobes = fibre_near_lobes(near, omega_i);
    return lobes.mirror + lobes.even;
}

// The same by how the light moves inside the fibre.
fn fibre_near_lobes(near: FibreNear, omega_i: vec3<f32>) -> FibreLobes {
    let s = near.shading;
    let polar = fibre_polar(omega_i);
    let at = fibre_azimuths(s, polar.azimuth);
    return fibre_sum(
        s,
        vec2<f32>(polar.sine, polar.cosine),
        at.turn.x,
        at.middle.y,
        max(near_series(s.surface, near.surface, at.surface), 0.0) * at.surface_stretch,
        max(near_series(s.inner, near.inner, at.turn), 0.0),
        near_series(s.clear, near.clear, at.through),
        near_series(s.dense, near.dense, at.through),
        at.shrink,
        max(near_series(s.core, near.core, at.core), 0.0) * at.stretch,
    );
}
