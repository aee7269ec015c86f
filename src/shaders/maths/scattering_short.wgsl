// A fibre as FAR and MEAN cards shade it: round, R, one more lobe and the medulla. Color enters last, one channel at a time, so that few
// numbers are held at once. Twin of src/maths/scattering/short.rs, where the layout of the tables is.
#define_import_path bevy_plumage::scattering_short
#import bevy_plumage::scattering::{FIBRE_TWICE_SILHOUETTE, FibreReach, fibre_cosines}

// vec4s before the steps of a table, in a row, in a step (a row, and how it differs from the next), and in all.
const SHORT_HEAD_LENGTH: u32 = 4u;
const SHORT_ROW_LENGTH: u32 = 12u;
const SHORT_STEP_LENGTH: u32 = 24u;
const SHORT_TABLE_LENGTH: u32 = 364u;

// What eye and fibre share for all lights and colors.
struct ShortShading {
    // Energies of R, of TT or TRcT, and of the medulla, before color.
    energy: vec3<f32>,
    // Terms of R, TT or TRcT, and the dense TT.
    surface: array<vec4<f32>, 2>,
    clear: array<vec4<f32>, 2>,
    thick: array<vec4<f32>, 2>,
    // More than four terms.
    fine: bool,
    // Medulla: both terms, and the slope in the sine of the light's inclination.
    medulla: vec3<f32>,
    // Sine and cosine of the eye's inclination, one over the squared roughness, scale: R; TT or TRcT.
    first_eye: vec4<f32>,
    second_eye: vec4<f32>,
    azimuth: vec2<f32>,
    // Half width of the transition to the dark back, and how dark the back is.
    back: vec2<f32>,
    structural: bool,
    // Color inside a fibre by its albedo: constant and factor; exponent and factor of its absorption.
    absorption: vec4<f32>,
    // Least and largest color inside.
    range: vec2<f32>,
    // t and k of TT, or the shares of round trips of a mirror core head on and here.
    through: vec2<f32>,
    // t and k of the medulla; how fast light forgets its place around and along the fibre, times t.
    inside: vec4<f32>,
}

// One light before color: K of R, of TT or TRcT, of the dense TT and of the medulla; the cosine of the azimuth between eye and light.
struct ShortLobes {
    surface: f32,
    clear: f32,
    thick: f32,
    scattered: f32,
    turn: f32,
}

// One channel.
struct ShortColor {
    // Factors on TT or TRcT, and on the medulla's light.
    second: f32,
    scattered: f32,
    // How far TT goes from the clear to the dense shape.
    dense: f32,
    // How much of the medulla's light remembers where it entered, around the fibre and along it.
    around: f32,
    along: f32,
}

// A direction: sine and cosine of its inclination, azimuth. Moved by a millionth, so that there is an azimuth along the fibre.
struct ShortPolar {
    inclination: vec2<f32>,
    azimuth: vec2<f32>,
}

fn short_polar(omega: vec3<f32>) -> ShortPolar {
    let flat = vec2(omega.y, omega.z + 1e-6);
    let across = dot(flat, flat);
    let per = inverseSqrt(max(across, 1e-20));
    return ShortPolar(vec2(omega.x, across * per), flat * per);
}

// exp(-x) I_0(x), x >= 0, within 4e-6 of itself.
fn short_bessel(x: f32) -> f32 {
    let below = 1.0 + x * (0.342285443 + x * (0.284803712 + x * (0.110501287 + x * (0.0162134503 + x * 0.0122650664))));
    let above = 1.0 + x * (2.34192582 + x * (2.47513668 + x * (1.49792471 + x * (0.66658347 + x * (0.0825281505 + x * 0.0770636847)))));
    return inverseSqrt(above / below);
}

// M of a lobe that an eye sees as short_eye has it; `light`: sine and cosine of the inclination.
fn short_longitudinal(eye: vec4<f32>, light: vec2<f32>) -> f32 {
    let d = vec2(light.x + eye.x, light.y - eye.y);
    return short_bessel(light.y * eye.y * eye.z) * exp(dot(d, d) * (-0.5 * eye.z)) * eye.w;
}

// A lobe of a table's head as an eye sees it.
fn short_eye(lobe: vec4<f32>, sine: f32, cosine: f32) -> vec4<f32> {
    return vec4(sine * lobe.y - cosine * lobe.x, abs(cosine * lobe.y + sine * lobe.x), lobe.zw);
}

fn short_shading(head: array<vec4<f32>, 4>, row: array<vec4<f32>, 9>, omega_o: vec3<f32>, dark_back: f32, fine: bool) -> ShortShading {
    let eye = short_polar(omega_o);
    let sine = eye.inclination.x;
    let cosine = eye.inclination.y;
    var s = ShortShading();
    s.energy = row[0].xyz;
    s.surface = array<vec4<f32>, 2>(row[3], row[4]);
    s.clear = array<vec4<f32>, 2>(row[5], row[6]);
    s.thick = array<vec4<f32>, 2>(row[7], row[8]);
    s.fine = fine;
    s.first_eye = short_eye(head[0], sine, cosine);
    s.second_eye = short_eye(head[1], sine, cosine);
    s.azimuth = eye.azimuth;
    s.back = vec2(head[3].z, clamp(dark_back, 0.0, 1.0));
    s.structural = head[3].x > 0.5;
    s.absorption = head[2];
    s.range = vec2(0.002 * head[2].y, 0.995 * head[2].y + head[2].x);
    let per = 1.0 / max(select(row[0].z, row[0].y, s.structural), 1e-9);
    let last = row[0].w * per;
    s.medulla = vec3(row[2].xy, select(last, -last, sine < 0.0));
    if s.structural {
        s.through = vec2(head[3].y, last);
    } else {
        s.through = row[1].xy / max(row[0].y, 1e-9);
        s.inside = vec4(row[1].zw, row[2].zw) * per;
    }
    return s;
}

// `frequency`: of fibre_along, 0 where no shadow lies along the fibre.
fn short_color(s: ShortShading, albedo: f32, frequency: f32) -> ShortColor {
    let y = clamp(albedo * s.absorption.y + s.absorption.x, s.range.x, s.range.y);
    var color = ShortColor();
    if s.structural {
        // Core and round trips in one fraction.
        color.second = y * (1.0 - s.through.y) / (1.0 - s.through.x + (s.through.x - s.through.y) * y);
        return color;
    }
    let sigma = min((exp2(min(log2(y) * s.absorption.z, 86.0)) - 1.0) * s.absorption.w, 1e4);
    color.dense = min(2.0 * sigma / (2.0 + sigma), 1.3);
    color.second = exp2(-s.through.y * log2(1.0 + sigma * s.through.x));
    let paths = 1.0 + sigma * s.inside.x;
    let before = log2(paths);
    color.scattered = exp2(-s.inside.y * before);
    color.around = FIBRE_TWICE_SILHOUETTE * exp2(s.inside.y * (before - log2(paths + s.inside.z)));
    if frequency > 0.0 {
        let along = exp2(s.inside.y * (before - log2(paths + s.inside.w)));
        color.along = along / max(along + frequency * (1.0 - along), 1e-6);
    }
    return color;
}

// Spread and cone of light that met further fibres, see multiple_scattering: of what a fibre scatters it keeps `kept`, and `strength`
// times the rest meets another one.
fn short_again(scattered: f32, kept: f32, strength: f32, parallel: f32) -> vec2<f32> {
    let all = min(scattered, 1.0);
    let lost = min(strength * max(scattered - kept, 0.0), 0.99 * all);
    let cone = 1.0 / (1.0 - parallel * lost);
    let later = 0.5 * lost + 0.25 * all;
    return vec2(lost * (all - later) / (1.0 - later) - (all - lost) * (cone - 1.0), cone);
}

fn short_density(energy: f32, terms: array<vec4<f32>, 2>, cosines: array<vec4<f32>, 2>) -> f32 {
    return energy + dot(terms[0], cosines[0]) + dot(terms[1], cosines[1]);
}

fn short_lobes(s: ShortShading, omega_i: vec3<f32>) -> ShortLobes {
    let polar = short_polar(omega_i);
    let light = polar.inclination;
    let turn = dot(s.azimuth, polar.azimuth);
    let twice = 2.0 * turn * turn - 1.0;
    let cosines = fibre_cosines(turn, s.fine);
    let surface = max(short_density(s.energy.x, s.surface, cosines), 0.0) * short_longitudinal(s.first_eye, light);
    let clear = short_density(s.energy.y, s.clear, cosines);
    let second = short_longitudinal(s.second_eye, light);
    if s.structural {
        let raw = s.azimuth + polar.azimuth;
        let square = dot(raw, raw);
        let half = select(-s.azimuth.x, raw.y * inverseSqrt(max(square, 1e-12)), square > 1e-12);
        let x = clamp((half + s.back.x) / (2.0 * s.back.x), 0.0, 1.0);
        let lit = x * x * (3.0 - 2.0 * x);
        return ShortLobes(surface, max(clear, 0.0) * second * mix(1.0, lit, s.back.y), 0.0, 0.0, turn);
    }
    // 1/pi^2.
    let scattered = max(s.energy.z + s.medulla.x * turn + s.medulla.y * twice, 0.0) * light.y
        * max(1.0 + s.medulla.z * light.x, 0.0) * 0.101321183642338;
    return ShortLobes(surface, clear * second, short_density(s.energy.y, s.thick, cosines) * second, scattered, turn);
}

// K of one channel, of a fibre among others: `reach` of the light reaches it.
fn short_lit(s: ShortShading, color: ShortColor, lobes: ShortLobes, reach: FibreReach) -> f32 {
    if s.structural {
        return reach.mirror * (lobes.surface + color.second * lobes.clear);
    }
    let share = max(reach.even + reach.along * color.along, 0.0);
    let around = max(1.0 + color.around * reach.place, 0.0) / max(1.0 + color.around * lobes.turn, 0.1);
    let through = max(mix(lobes.clear, lobes.thick, color.dense), 0.0);
    return reach.mirror * lobes.surface + min(share * around, 2.0) * (color.second * through + color.scattered * lobes.scattered);
}
