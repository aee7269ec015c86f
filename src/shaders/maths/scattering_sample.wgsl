// Importance sampling of one fibre (Chen et al. 2026, Sec. 6.2.1) from the far-field series. Twin of src/maths/scattering/sample.rs.
#define_import_path bevy_plumage::scattering_sample
#import bevy_plumage::scattering::{
    FIBRE_ROUND, FibreLobes, FibreShading, SCATTERING_PI, azimuthal, fibre_cosines, fibre_lobes, fibre_longitudinal, fibre_polar, medulla_azimuth,
}
#import bevy_plumage::scattering_azimuth::{fibre_azimuths, fibre_sines}

const SAMPLE_STEPS: u32 = 24u;
const LEAST_SIDE: f32 = 0.05;

// A sampled direction of the light, its density per steradian (0: none), K over it, and the width of its lobe in radians.
struct FibreSample {
    direction: vec3<f32>,
    pdf: f32,
    weight: vec3<f32>,
    // K there.
    lobes: FibreLobes,
    width: f32,
}

// What sampling needs of a fibre, once per pixel.
struct FibreSampler {
    // R, TT, TRT, TRcT or medulla.
    chances: vec4<f32>,
    // TT between clear and dense, as far as the luminance goes.
    through: array<vec4<f32>, 2>,
}

fn sample_luminance(c: vec3<f32>) -> f32 {
    return max(dot(c, vec3<f32>(0.2126, 0.7152, 0.0722)), 0.0);
}

fn fibre_sampler(s: FibreShading) -> FibreSampler {
    var light = vec4<f32>(
        s.energy_surface,
        sample_luminance(s.energy_through),
        sample_luminance(s.energy_inner),
        sample_luminance(s.energy_fourth),
    );
    if s.structural {
        light.w *= mix(1.0, clamp(0.5 + 0.5 * s.azimuth.y, LEAST_SIDE, 1.0), s.dark_back);
    }
    let sum = dot(light, vec4<f32>(1.0));
    let share = sample_luminance(s.energy_through * s.dense_share) / max(sample_luminance(s.energy_through), 1e-9);
    return FibreSampler(
        select(vec4<f32>(1.0, 0.0, 0.0, 0.0), light / max(sum, 1e-9), sum > 1e-9),
        array<vec4<f32>, 2>(mix(s.clear[0], s.dense[0], share), mix(s.clear[1], s.dense[1], share)),
    );
}

// The azimuth series of a lobe, in its warped angle.
fn sample_series(s: FibreShading, chooser: FibreSampler, lobe: u32) -> array<vec4<f32>, 2> {
    switch lobe {
        case 0u: { return s.surface; }
        case 1u: { return chooser.through; }
        case 2u: { return s.inner; }
        default: {
            if s.structural { return s.core; }
            return array<vec4<f32>, 2>(vec4<f32>(2.0 * s.medulla.xy, 0.0, 0.0), vec4<f32>(0.0));
        }
    }
}

// Density of `fibre_sample` at a direction, per steradian.
fn fibre_pdf(s: FibreShading, chooser: FibreSampler, omega_i: vec3<f32>) -> f32 {
    let polar = fibre_polar(omega_i);
    let light = vec2<f32>(polar.sine, polar.cosine);
    let at = fibre_azimuths(s, polar.azimuth);
    let turn = fibre_cosines(at.turn.x, true);
    var last: f32;
    if s.structural {
        last = azimuthal(s.core, fibre_cosines(at.core.x, true)) * at.stretch
            * fibre_longitudinal(s, light, 3u);
    } else {
        last = medulla_azimuth(s, at.turn.x) * light.y * (2.0 / SCATTERING_PI) * max(1.0 + s.medulla.z * light.x, 0.0);
    }
    let sum = vec4<f32>(
        azimuthal(s.surface, fibre_cosines(at.surface.x, true)) * at.surface_stretch
            * fibre_longitudinal(s, light, 0u),
        azimuthal(chooser.through, fibre_cosines(at.through.x, true)) * at.shrink
            * fibre_longitudinal(s, light, 1u),
        azimuthal(s.inner, turn) * fibre_longitudinal(s, light, 2u),
        last,
    );
    return dot(sum, chooser.chances) * 0.5 / SCATTERING_PI;
}

// Angle in -pi..pi below which the share `u` of the density (1 + sum of s_n cos n phi)/2 pi lies.
fn fibre_invert_series(series: array<vec4<f32>, 2>, u: f32) -> f32 {
    let n = vec4<f32>(1.0, 0.5, 1.0 / 3.0, 0.25);
    let m = vec4<f32>(0.2, 1.0 / 6.0, 1.0 / 7.0, 0.125);
    var low = -SCATTERING_PI;
    var high = SCATTERING_PI;
    let wanted = (clamp(u, 0.0, 1.0) - 0.5) * 2.0 * SCATTERING_PI;
    var phi = wanted;
    for (var i = 0u; i < SAMPLE_STEPS; i++) {
        let angle = vec2<f32>(cos(phi), sin(phi));
        let c = fibre_cosines(angle.x, true);
        let s = fibre_sines(angle);
        let off = phi + dot(series[0] * n, s[0]) + dot(series[1] * m, s[1]) - wanted;
        let density = 1.0 + dot(series[0], c[0]) + dot(series[1], c[1]);
        if off < 0.0 { low = phi; } else { high = phi; }
        let next = phi - off / max(density, 1e-3);
        let inside = next > low && next < high;
        if inside && abs(next - phi) < 1e-5 {
            return next;
        }
        phi = select(0.5 * (low + high), next, inside);
    }
    return phi;
}

// Azimuth (y, z) of the light of a lobe's warped angle from the eye: the inverse of the warps of flat fibres.
fn sample_unwarp(s: FibreShading, lobe: u32, warped: f32) -> vec2<f32> {
    let o = s.azimuth;
    var phi = warped;
    if s.aspect < FIBRE_ROUND {
        if lobe == 0u || (lobe == 3u && s.structural) {
            let a = select(s.core_aspect, s.surface_aspect, lobe == 0u);
            let sine = sin(0.5 * warped);
            let cosine = cos(0.5 * warped);
            let t = vec2<f32>(a * o.x, o.y);
            let n = vec2<f32>(a * (t.x * cosine + t.y * sine), t.y * cosine - t.x * sine);
            return 2.0 * dot(n, o) / max(dot(n, n), 1e-12) * n - o;
        }
        if lobe == 1u {
            let back = warped - select(SCATTERING_PI, -SCATTERING_PI, warped < 0.0);
            phi = SCATTERING_PI + back * sqrt(s.aspect);
        }
    }
    let c = cos(phi);
    let sine = sin(phi);
    return vec2<f32>(o.x * c + o.y * sine, o.y * c - o.x * sine);
}

// Samples a direction of the light; `u`: lobe, two along the fibre, one around it.
fn fibre_sample(s: FibreShading, chooser: FibreSampler, u_in: vec4<f32>) -> FibreSample {
    let u = clamp(u_in, vec4<f32>(0.0), vec4<f32>(0.99999994));
    var lobe = 0u;
    var below = 0.0;
    loop {
        if lobe >= 3u || u.x < below + chooser.chances[lobe] {
            break;
        }
        below += chooser.chances[lobe];
        lobe += 1u;
    }
    let turn = cos(2.0 * SCATTERING_PI * u.z);
    var sine: f32;
    var width = 0.7;
    if lobe == 3u && !s.structural {
        let x = sqrt(u.y) * turn;
        let rest = (u.x - below) / max(chooser.chances.w, 1e-9);
        sine = select(x, -x, rest > 0.5 * (1.0 + s.medulla.z * x));
    } else {
        width = inverseSqrt(s.inverse[lobe]);
        let v = width * width;
        let y = max(u.y, 1e-9);
        let along = max(1.0 + v * log(y + (1.0 - y) * exp(-2.0 / v)), -1.0);
        sine = -along * s.eye_sin[lobe] + sqrt(max(1.0 - along * along, 0.0)) * turn * s.eye_cos[lobe];
    }
    sine = clamp(sine, -1.0, 1.0);
    let azimuth = sample_unwarp(s, lobe, fibre_invert_series(sample_series(s, chooser, lobe), u.w));
    let direction = vec3<f32>(sine, sqrt(max(1.0 - sine * sine, 0.0)) * azimuth);
    let pdf = fibre_pdf(s, chooser, direction);
    if !(pdf > 1e-9) {
        return FibreSample(direction, 0.0, vec3<f32>(0.0), FibreLobes(vec3<f32>(0.0), vec3<f32>(0.0), 1.0), width);
    }
    let lobes = fibre_lobes(s, direction);
    return FibreSample(direction, pdf, (lobes.mirror + lobes.even) / pdf, lobes, width);
}
