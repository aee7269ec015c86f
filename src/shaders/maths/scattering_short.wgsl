// A fibre as cards of the mean level of detail shade it: round, four terms, R, one more lobe and the medulla. Twin of
// src/maths/scattering/mean.rs, where the layout of the tables is.
#define_import_path bevy_plumage::scattering_short
#import bevy_plumage::scattering::{FIBRE_TWICE_SILHOUETTE, FibreLobes, FibreReach, fibre_cosines, fibre_polar, longitudinal_with}

// vec4s before the rows of a table, in a row, and in all.
const SHORT_HEAD_LENGTH: u32 = 4u;
const SHORT_ROW_LENGTH: u32 = 12u;
const SHORT_TABLE_LENGTH: u32 = 196u;

struct ShortShading {
    // Energies of R, of TT or TRcT, and of the medulla, before color.
    energy: vec3<f32>,
    // Terms of R, TT or TRcT, and the dense TT.
    surface: array<vec4<f32>, 2>,
    clear: array<vec4<f32>, 2>,
    thick: array<vec4<f32>, 2>,
    // More than four terms.
    fine: bool,
    // Color of TT or TRcT, and of the medulla's light.
    second: vec3<f32>,
    scattered: vec3<f32>,
    // How far TT goes from the clear to the dense shape.
    dense: vec3<f32>,
    // Medulla: both terms, and the slope in the sine of the light's inclination.
    medulla: vec3<f32>,
    // How much of its light remembers where it entered, around the fibre and along it.
    around: vec3<f32>,
    along: vec3<f32>,
    // Sine and cosine of the eye's inclination, one over the squared roughness, scale: R; TT or TRcT.
    first_eye: vec4<f32>,
    second_eye: vec4<f32>,
    azimuth: vec2<f32>,
    // Half width of the transition to the dark back, and how dark the back is.
    back: vec2<f32>,
    structural: bool,
}

struct ShortEnergies {
    surface: f32,
    second: vec3<f32>,
    scattered: vec3<f32>,
}

// A lobe of a table's head as an eye sees it.
fn short_eye(lobe: vec4<f32>, sine: f32, cosine: f32) -> vec4<f32> {
    return vec4(sine * lobe.y - cosine * lobe.x, abs(cosine * lobe.y + sine * lobe.x), lobe.zw);
}

// `frequency`: of fibre_along, 0 where no shadow lies along the fibre.
fn short_shading(
    head: array<vec4<f32>, 4>,
    row: array<vec4<f32>, 9>,
    albedo: vec3<f32>,
    omega_o: vec3<f32>,
    dark_back: f32,
    frequency: f32,
    fine: bool,
) -> ShortShading {
    let eye = fibre_polar(omega_o);
    var s: ShortShading;
    s.energy = row[0].xyz;
    s.surface = array<vec4<f32>, 2>(row[3], row[4]);
    s.clear = array<vec4<f32>, 2>(row[5], row[6]);
    s.thick = array<vec4<f32>, 2>(row[7], row[8]);
    s.fine = fine;
    s.first_eye = short_eye(head[0], eye.sine, eye.cosine);
    s.second_eye = short_eye(head[1], eye.sine, eye.cosine);
    s.azimuth = eye.azimuth;
    s.back = vec2(head[3].z, clamp(dark_back, 0.0, 1.0));
    s.structural = head[3].x > 0.5;
    let last = row[0].w / max(select(row[0].z, row[0].y, s.structural), 1e-9);
    s.medulla = vec3(row[2].xy, select(last, -last, eye.sine < 0.0));
    let fresnel = head[2].x;
    let y = (clamp(albedo, vec3(fresnel + 0.002), vec3(0.995)) - fresnel) * head[2].y;
    if s.structural {
        // Core and round trips in one fraction.
        s.second = y * (1.0 - last) / (1.0 - head[3].y + (head[3].y - last) * y);
    } else {
        let sigma = min((exp2(min(log2(y) * head[2].z, vec3(86.0))) - 1.0) * head[2].w, vec3(1e4));
        s.dense = min(2.0 * sigma / (2.0 + sigma), vec3(1.3));
        let through = row[1].xy / max(row[0].y, 1e-9);
        let medulla = vec4(row[1].zw, row[2].zw) / max(row[0].z, 1e-9);
        s.second = exp2(-through.y * log2(1.0 + sigma * through.x));
        let paths = 1.0 + sigma * medulla.x;
        let before = log2(paths);
        s.scattered = exp2(-medulla.y * before);
        s.around = FIBRE_TWICE_SILHOUETTE * exp2(medulla.y * (before - log2(paths + medulla.z)));
        if frequency > 0.0 {
            let along = exp2(medulla.y * (before - log2(paths + medulla.w)));
            s.along = along / max(along + frequency * (1.0 - along), vec3(1e-6));
        }
    }
    return s;
}

fn short_energies(s: ShortShading) -> ShortEnergies {
    return ShortEnergies(s.energy.x, s.energy.y * s.second, s.energy.z * s.scattered);
}

fn short_density(energy: f32, terms: array<vec4<f32>, 2>, cosines: array<vec4<f32>, 2>) -> f32 {
    return energy + dot(terms[0], cosines[0]) + dot(terms[1], cosines[1]);
}

fn short_lobes(s: ShortShading, omega_i: vec3<f32>) -> FibreLobes {
    let polar = fibre_polar(omega_i);
    let light = vec2(polar.sine, polar.cosine);
    let turn = clamp(dot(s.azimuth, polar.azimuth), -1.0, 1.0);
    let twice = 2.0 * turn * turn - 1.0;
    let cosines = fibre_cosines(turn, s.fine);
    let surface = max(short_density(s.energy.x, s.surface, cosines), 0.0) * longitudinal_with(s.first_eye.xy, light, s.first_eye.z, s.first_eye.w);
    let clear = short_density(s.energy.y, s.clear, cosines);
    let second = longitudinal_with(s.second_eye.xy, light, s.second_eye.z, s.second_eye.w);
    if s.structural {
        let raw = s.azimuth + polar.azimuth;
        let square = dot(raw, raw);
        let half = select(-s.azimuth.x, raw.y * inverseSqrt(max(square, 1e-12)), square > 1e-12);
        let x = clamp((half + s.back.x) / (2.0 * s.back.x), 0.0, 1.0);
        let lit = x * x * (3.0 - 2.0 * x);
        return FibreLobes(surface + s.second * (max(clear, 0.0) * second * mix(1.0, lit, s.back.y)), vec3(0.0), turn);
    }
    let thick = short_density(s.energy.y, s.thick, cosines);
    let through = max(mix(vec3(clear), vec3(thick), s.dense), vec3(0.0)) * second;
    // 1/pi^2.
    let scattered = max(s.energy.z + s.medulla.x * turn + s.medulla.y * twice, 0.0) * light.y
        * max(1.0 + s.medulla.z * light.x, 0.0) * 0.101321183642338;
    return FibreLobes(vec3(surface), s.second * through + s.scattered * scattered, turn);
}

fn short_lit(s: ShortShading, lobes: FibreLobes, reach: FibreReach) -> vec3<f32> {
    let mirror = reach.mirror * lobes.mirror;
    if s.structural {
        return mirror;
    }
    let share = max(reach.even + reach.along * s.along, vec3(0.0));
    let around = max(1.0 + s.around * reach.place, vec3(0.0)) / max(1.0 + s.around * lobes.turn, vec3(0.1));
    return mirror + min(share * around, vec3(2.0)) * lobes.even;
}
