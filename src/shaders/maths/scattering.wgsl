// Far-field scattering of one fibre: the twin of src/maths/scattering/{longitudinal,color,table,parameters,shading,
// evaluate,reach,energy}.rs, same names.
//
// Use: `fibre_parameters` and a mixed row once per material and pixel, `fibre_shading` once per pixel and fibre,
// `fibre_evaluate` once per light. The result K is a density in the direction of the light whose integral over the sphere is
// the albedo: multiply it with the radiance of the light, without any cosine.
#define_import_path bevy_plumage::scattering

// vec4s in one row and rows in one table; the layout is documented at FIBRE_ROW_VEC4S in src/maths/scattering/table.rs.
const FIBRE_ROW_LENGTH: u32 = 13u;
const FIBRE_ROW_COUNT: u32 = 16u;
// vec4s in a fibre's parameters.
const FIBRE_PARAMETER_LENGTH: u32 = 7u;

// Aspect from which on a fibre counts as round.
const FIBRE_ROUND: f32 = 0.999;
// Squared sines of the eye's azimuth between which the warp of TRcT fades out.
const FIBRE_EDGE_ON: vec2<f32> = vec2<f32>(0.5, 0.9);
const SCATTERING_PI: f32 = 3.14159265358979;
// 2 (pi / 4)^2.
const FIBRE_TWICE_SILHOUETTE: f32 = 1.23370055013617;

struct FibreParameters {
    longitudinal_roughness: f32,
    azimuthal_roughness: f32,
    tilt: f32,
    aspect: f32,
    eta: f32,
    structural: bool,
    core: f32,
    fresnel: f32,
    color_kt: f32,
    color_t: f32,
    scattering: f32,
    round_trips: f32,
    // Of R, TT, TRT and TRcT: sine and cosine of the longitudinal shift, what `longitudinal_with` needs of the roughness.
    shift_sin: vec4<f32>,
    shift_cos: vec4<f32>,
    inverse: vec4<f32>,
    scale: vec4<f32>,
}

struct FibreColor {
    core: vec3<f32>,
    absorption: vec3<f32>,
}

// Lower row and fraction towards the next one.
struct FibreRowPlace {
    index: u32,
    fraction: f32,
}

struct FibreRow {
    energy: vec4<f32>,
    absorption: vec4<f32>,
    medulla: vec4<f32>,
    core: array<vec4<f32>, 2>,
    surface: array<vec4<f32>, 2>,
    clear: array<vec4<f32>, 2>,
    dense: array<vec4<f32>, 2>,
    inner: array<vec4<f32>, 2>,
}

struct FibreShading {
    // Energy of R (grey), TT, TRT and the fourth lobe (TRcT or medulla).
    energy_surface: f32,
    energy_through: vec3<f32>,
    energy_inner: vec3<f32>,
    energy_fourth: vec3<f32>,
    // Damped series: factors of cos n phi, n = 1..4 and 5..8.
    surface: array<vec4<f32>, 2>,
    clear: array<vec4<f32>, 2>,
    dense: array<vec4<f32>, 2>,
    inner: array<vec4<f32>, 2>,
    core: array<vec4<f32>, 2>,
    dense_share: vec3<f32>,
    // Azimuthal blur of R, TT, TRT and TRcT; terms of the series.
    blur: vec4<f32>,
    harmonics: u32,
    // Sines and cosines of the eye's shifted inclination, and what `longitudinal_with` needs: R, TT, TRT, TRcT.
    eye_sin: vec4<f32>,
    eye_cos: vec4<f32>,
    inverse: vec4<f32>,
    scale: vec4<f32>,
    medulla: vec3<f32>,
    structural: bool,
    aspect: f32,
    surface_aspect: f32,
    // Of TRcT's warp, which fades out where the eye sees a flat fibre edge on.
    core_aspect: f32,
    eta: f32,
    cos_eye: f32,
    azimuth: vec2<f32>,
    back_edge: f32,
    dark_back: f32,
    // More than four terms.
    fine: bool,
    // How much of the medulla's light remembers where it entered, around the fibre and along it (0 until `fibre_along` is asked).
    around: vec3<f32>,
    along: vec3<f32>,
    absorption: vec3<f32>,
}

// K by how its light moves inside the fibre: enters and leaves at the same place (R, TRT, TRcT), or leaves anywhere (TT, medulla);
// the cosine of the azimuth between eye and light.
struct FibreLobes {
    mirror: vec3<f32>,
    even: vec3<f32>,
    turn: f32,
}

// What of a light reaches one fibre among others: see the Rust struct of the same name.
struct FibreReach {
    mirror: f32,
    even: f32,
    along: f32,
    place: f32,
}

struct FibreEnergy {
    specular: f32,
    front: vec3<f32>,
    back: vec3<f32>,
}

// Direction split into inclination and azimuth.
struct FibrePolar {
    sine: f32,
    cosine: f32,
    azimuth: vec2<f32>,
}

// The vec4s of FibreTable::pack_parameters.
fn fibre_parameters(v: array<vec4<f32>, FIBRE_PARAMETER_LENGTH>) -> FibreParameters {
    let a = v[0];
    let b = v[1];
    let c = v[2];
    return FibreParameters(
        clamp(a.x, 0.01, 1.0),
        clamp(a.y, 0.05, 2.0),
        clamp(a.z, -0.5, 0.5),
        clamp(a.w, 0.2, 1.0),
        clamp(b.x, 1.05, 3.0),
        b.y > 0.5,
        clamp(b.z, 0.0, 0.999999),
        clamp(b.w, 0.0, 0.9),
        max(c.x, 0.0),
        max(c.y, 1e-4),
        clamp(c.z, 0.0, 1e3),
        clamp(c.w, 0.0, 0.9),
        v[3],
        v[4],
        v[5],
        v[6],
    );
}

// exp(-x) I_0(x), x >= 0 (Abramowitz and Stegun 9.8.1, 9.8.2).
fn i0e(x: f32) -> f32 {
    return i0e_times_exp(x, 0.0);
}

// exp(-y) times that, with one exponential.
fn i0e_times_exp(x_in: f32, y: f32) -> f32 {
    let x = max(x_in, 0.0);
    let small = min(x / 3.75, 1.0);
    let s = small * small;
    let low = 1.0 + s * (3.5156229 + s * (3.0899424 + s * (1.2067492 + s * (0.2659732 + s * (0.0360768 + s * 0.0045813)))));
    let root = inverseSqrt(max(x, 3.75));
    let r = 3.75 * root * root;
    let high = 0.39894228 + r * (0.01328592 + r * (0.00225319 + r * (-0.00157565 + r * (0.00916281
        + r * (-0.02057706 + r * (0.02635537 + r * (-0.01647633 + r * 0.00392377)))))));
    let near = x < 3.75;
    return select(high * root, low, near) * exp(-y - select(0.0, x, near));
}

// d'Eon's M; eye and light as (sine, cosine) of the inclination. `inverse`: one over the square of the roughness, `scale`: what makes
// the integral 1.
fn longitudinal_with(eye: vec2<f32>, light: vec2<f32>, inverse: f32, scale: f32) -> f32 {
    let d = vec2<f32>(light.x + eye.x, light.y - eye.y);
    return i0e_times_exp(light.y * eye.y * inverse, 0.5 * dot(d, d) * inverse) * scale;
}

// M of the lobes R, TT, TRT and TRcT (0 to 3).
fn fibre_longitudinal(s: FibreShading, light: vec2<f32>, lobe: u32) -> f32 {
    return longitudinal_with(vec2<f32>(s.eye_sin[lobe], s.eye_cos[lobe]), light, s.inverse[lobe], s.scale[lobe]);
}

fn gamma_transmittance(kt: f32, t_in: f32, sigma: vec3<f32>) -> vec3<f32> {
    return exp(-kt * sigma * log_ratio(sigma * max(t_in, 1e-4)));
}

// What is left of a memory that fades with the path like an absorption `rate`, in light that `sigma` leaves.
fn gamma_memory(kt: f32, t_in: f32, sigma: vec3<f32>, rate: f32) -> vec3<f32> {
    let t = max(t_in, 1e-4);
    return exp(-kt / t * log(1.0 + rate * t / (1.0 + sigma * t)));
}

// ln(1 + x)/x for x >= 0, exact to f32 at both ends (ln(1 + x) alone loses its digits near 0).
fn log_ratio(x: vec3<f32>) -> vec3<f32> {
    let small = 1.0 + x * (-0.5 + x * (1.0 / 3.0 + x * (-0.25 + x * (0.2 + x * (-1.0 / 6.0 + x / 7.0)))));
    return select(log(1.0 + x) / max(x, vec3<f32>(0.1)), small, x < vec3<f32>(0.1));
}

// (e^x - 1)/x for x >= 0, likewise.
fn exp_ratio(x: vec3<f32>) -> vec3<f32> {
    let small = 1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x / 120.0)));
    return select((exp(x) - 1.0) / max(x, vec3<f32>(0.1)), small, x < vec3<f32>(0.1));
}

fn fibre_color(p: FibreParameters, albedo: vec3<f32>) -> FibreColor {
    let f = p.fresnel;
    let series = p.round_trips;
    let y = (clamp(albedo, vec3<f32>(f + 0.002), vec3<f32>(0.995)) - f) / (1.0 - f);
    var color = FibreColor(vec3<f32>(1.0), vec3<f32>(0.0));
    if p.structural {
        color.core = clamp(y / (1.0 - series + series * y), vec3<f32>(0.0), vec3<f32>(1.0));
    }
    if p.color_kt > 1e-6 {
        let depth = -log(y) / p.color_kt;
        let grown = depth * exp_ratio(min(depth * p.color_t, vec3<f32>(60.0)));
        color.absorption = clamp(grown, vec3<f32>(0.0), vec3<f32>(1e4));
    }
    return color;
}

fn fibre_row_at(cos_theta: f32) -> FibreRowPlace {
    let last = f32(FIBRE_ROW_COUNT - 1u);
    let x = clamp((cos_theta - 0.02) / 0.98 * last, 0.0, last);
    let i = min(floor(x), last - 1.0);
    return FibreRowPlace(u32(i), x - i);
}

// Unpacks two neighboring rows and mixes them; everything but the energies is weighted by the energy of its lobe.
fn fibre_row_mix(a: array<vec4<f32>, 13>, b: array<vec4<f32>, 13>, fraction: f32) -> FibreRow {
    let upper = b[0] * fraction;
    let sum = a[0] * (1.0 - fraction) + upper;
    let f = select(vec4<f32>(fraction), upper / max(sum, vec4<f32>(1e-9)), sum > vec4<f32>(1e-9));
    var row: FibreRow;
    row.energy = mix(a[0], b[0], fraction);
    row.absorption = mix(a[1], b[1], f.yyzz);
    row.medulla = mix(a[2], b[2], f.w);
    row.core = array<vec4<f32>, 2>(mix(a[3], b[3], f.w), mix(a[4], b[4], f.w));
    row.surface = array<vec4<f32>, 2>(mix(a[5], b[5], f.x), mix(a[6], b[6], f.x));
    row.clear = array<vec4<f32>, 2>(mix(a[7], b[7], f.y), mix(a[8], b[8], f.y));
    row.dense = array<vec4<f32>, 2>(mix(a[9], b[9], f.y), mix(a[10], b[10], f.y));
    row.inner = array<vec4<f32>, 2>(mix(a[11], b[11], f.z), mix(a[12], b[12], f.z));
    return row;
}

fn fibre_unit(a: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let length_squared = dot(a, a);
    return select(otherwise, a * inverseSqrt(max(length_squared, 1e-12)), length_squared > 1e-12);
}

// Frame of a fibre: x along the tangent, z the normal made orthogonal to it, y = z cross x.
fn fibre_local(tangent: vec3<f32>, normal: vec3<f32>, omega: vec3<f32>) -> vec3<f32> {
    let x = fibre_unit(tangent, vec3<f32>(1.0, 0.0, 0.0));
    let spare = select(vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(1.0, 0.0, 0.0), abs(x.x) < 0.7);
    let fallback = fibre_unit(cross(cross(x, spare), x), vec3<f32>(0.0, 0.0, 1.0));
    let z = fibre_unit(normal - x * dot(x, normal), fallback);
    return vec3<f32>(dot(omega, x), dot(omega, cross(z, x)), dot(omega, z));
}

fn fibre_polar(omega: vec3<f32>) -> FibrePolar {
    let across = dot(omega.yz, omega.yz);
    let c = sqrt(across);
    let azimuth = select(vec2<f32>(0.0, 1.0), omega.yz / max(c, 1e-6), across > 1e-12);
    return FibrePolar(clamp(omega.x, -1.0, 1.0), min(c, 1.0), azimuth);
}

// Unpolarised reflectance of a smooth dielectric from outside, eta > 1.
fn fresnel(cos_in: f32, eta: f32) -> f32 {
    let c = clamp(abs(cos_in), 0.0, 1.0);
    let t = sqrt(max(1.0 - (1.0 - c * c) / (eta * eta), 0.0));
    let s = (c - eta * t) / (c + eta * t);
    let p = (eta * c - t) / (eta * c + t);
    return 0.5 * (s * s + p * p);
}

// Fresnel reflectances of an elliptic fibre at the heights h and -h of the silhouette (c = cos asin h), summed.
fn fibre_reflection_pair(h: f32, c: f32, aspect: f32, eta: f32, cos_o: f32, azimuth: vec2<f32>, t: vec2<f32>) -> f32 {
    let upper = vec2<f32>(aspect * (t.x * c + t.y * h), t.y * c - t.x * h);
    let lower = vec2<f32>(aspect * (t.x * c - t.y * h), t.y * c + t.x * h);
    let cos_upper = dot(upper, azimuth) / sqrt(max(dot(upper, upper), 1e-12));
    let cos_lower = dot(lower, azimuth) / sqrt(max(dot(lower, lower), 1e-12));
    return fresnel(cos_o * cos_upper, eta) + fresnel(cos_o * cos_lower, eta);
}

// Energy of R of an elliptic fibre: less than a round one's when seen broadside, more edge on. Gauss-Legendre in asin h.
fn fibre_flat_reflection(aspect: f32, eta: f32, cos_o: f32, azimuth: vec2<f32>) -> f32 {
    let raw = vec2<f32>(aspect * azimuth.x, azimuth.y);
    let t = raw / sqrt(max(dot(raw, raw), 1e-12));
    let sum = 0.0099120276 * fibre_reflection_pair(0.9980552139, 0.0623361060, aspect, eta, cos_o, azimuth, t)
        + 0.1096824713 * fibre_reflection_pair(0.9494253843, 0.3139927382, aspect, eta, cos_o, azimuth, t)
        + 0.3341893961 * fibre_reflection_pair(0.7348899388, 0.6781863888, aspect, eta, cos_o, azimuth, t)
        + 0.5462161049 * fibre_reflection_pair(0.2841679239, 0.9587745256, aspect, eta, cos_o, azimuth, t);
    return min(0.5 * sum, 1.0);
}

fn fibre_stretch(aspect: f32, azimuth: vec2<f32>) -> f32 {
    let square = azimuth * azimuth;
    let a = aspect * aspect;
    return (square.y + a * a * square.x) / (aspect * (square.y + a * square.x));
}

fn fibre_damped(shape: array<vec4<f32>, 2>, blur: f32, harmonics: u32) -> array<vec4<f32>, 2> {
    let n = vec4<f32>(1.0, 2.0, 3.0, 4.0);
    let last = vec4<f32>(f32(harmonics));
    // exp(-n^2 b^2/2): the exponents 1, 4, 9, 16 and 25, 36, 49, 64.
    let one = exp(-0.5 * blur * blur);
    let two = one * one;
    let four = two * two;
    let eight = four * four;
    let sixteen = eight * eight;
    let low = 2.0 * vec4<f32>(one, four, eight * one, sixteen);
    let high = low * sixteen * vec4<f32>(eight, sixteen, sixteen * eight, sixteen * sixteen);
    return array<vec4<f32>, 2>(
        select(vec4<f32>(0.0), shape[0] * low, n <= last),
        select(vec4<f32>(0.0), shape[1] * high, n + 4.0 <= last),
    );
}

// Prepares a fibre for the lights of one pixel. `dark_back`: 1 = the core is a mirror on the outer face (+z) only, 0 = all
// around. `harmonics`: 1..8 terms of the series; 8 near, 3 for the mean level of detail.
fn fibre_shading(
    p: FibreParameters,
    row: FibreRow,
    albedo: vec3<f32>,
    omega_o: vec3<f32>,
    dark_back: f32,
    harmonics_in: u32,
) -> FibreShading {
    let harmonics = clamp(harmonics_in, 1u, 8u);
    let eye = fibre_polar(omega_o);
    let color = fibre_color(p, albedo);
    var s: FibreShading;

    // The lobe of a flat fibre is as narrow as it is flat: what blur would add is taken off the flatness. 1.37: the deviation of
    // a round one's (docs/book/fits/fibre.py).
    let spread = p.azimuthal_roughness / 1.37;
    s.surface_aspect = min(sqrt(p.aspect * p.aspect + spread * spread), 1.0);
    s.energy_surface = row.energy.x;
    var entering = 1.0;
    if p.aspect < FIBRE_ROUND {
        s.energy_surface = fibre_flat_reflection(s.surface_aspect, p.eta, eye.cosine, eye.azimuth);
        entering = (1.0 - s.energy_surface) / max(1.0 - row.energy.x, 1e-6);
    }
    s.energy_through = row.energy.y * entering * gamma_transmittance(row.absorption.x, row.absorption.y, color.absorption);
    s.energy_inner = row.energy.z * entering * gamma_transmittance(row.absorption.z, row.absorption.w, color.absorption);
    let series = row.medulla.x;
    if p.structural {
        s.energy_fourth = row.energy.w * entering * color.core * (1.0 - series) / (1.0 - series * color.core);
    } else {
        s.energy_fourth = row.energy.w * entering * gamma_transmittance(row.medulla.x, row.medulla.y, color.absorption);
    }
    s.absorption = color.absorption;
    s.dense_share = min(2.0 * color.absorption / (2.0 + color.absorption), vec3<f32>(1.3));

    // Too few terms for a narrow lobe would ring: blur it to what they can show.
    let blur = max(p.azimuthal_roughness, 1.6 / f32(harmonics));
    let warped = blur * fibre_stretch(p.aspect, eye.azimuth);
    let narrowed = blur * inverseSqrt(p.aspect);
    s.core_aspect = mix(p.aspect, 1.0, smoothstep(FIBRE_EDGE_ON.x, FIBRE_EDGE_ON.y, eye.azimuth.x * eye.azimuth.x));
    s.blur = vec4<f32>(warped, narrowed, blur, blur * fibre_stretch(s.core_aspect, eye.azimuth));
    s.harmonics = harmonics;
    s.surface = fibre_damped(row.surface, warped, harmonics);
    s.clear = fibre_damped(row.clear, narrowed, harmonics);
    s.dense = fibre_damped(row.dense, narrowed, harmonics);
    s.inner = fibre_damped(row.inner, blur, harmonics);
    s.core = array<vec4<f32>, 2>(vec4<f32>(0.0), vec4<f32>(0.0));
    if p.structural {
        s.core = fibre_damped(row.core, s.blur.w, harmonics);
        s.medulla = vec3<f32>(0.0);
    } else {
        s.around = FIBRE_TWICE_SILHOUETTE * gamma_memory(row.medulla.x, row.medulla.y, color.absorption, row.core[0].y);
        let forward = select(1.0, -1.0, eye.sine < 0.0);
        s.medulla = vec3<f32>(row.medulla.z, row.medulla.w, clamp(4.0 * row.core[0].x, -1.0, 1.0) * forward);
    }

    s.eye_sin = eye.sine * p.shift_cos - eye.cosine * p.shift_sin;
    // Beyond the pole the cosine turns negative: its absolute value is the fold.
    s.eye_cos = abs(eye.cosine * p.shift_cos + eye.sine * p.shift_sin);
    s.inverse = p.inverse;
    s.scale = p.scale;
    s.structural = p.structural;
    s.aspect = p.aspect;
    s.eta = p.eta;
    s.cos_eye = eye.cosine;
    s.azimuth = eye.azimuth;
    s.back_edge = p.azimuthal_roughness;
    s.dark_back = clamp(dark_back, 0.0, 1.0);
    s.fine = harmonics > 4u;
    return s;
}

// cos n phi for n = 1..4 and 5..8.
fn fibre_cosines(c: f32, fine: bool) -> array<vec4<f32>, 2> {
    let two = 2.0 * c * c - 1.0;
    let three = c * (2.0 * two - 1.0);
    let four = 2.0 * two * two - 1.0;
    var out = array<vec4<f32>, 2>(vec4<f32>(c, two, three, four), vec4<f32>(0.0));
    if fine {
        let five = 2.0 * c * four - three;
        let six = 2.0 * c * five - four;
        let seven = 2.0 * c * six - five;
        out[1] = vec4<f32>(five, six, seven, 2.0 * four * four - 1.0);
    }
    return out;
}

// 1 + sum of s_n cos n phi, at least 0: the density of a lobe in phi times 2 pi.
fn azimuthal(series: array<vec4<f32>, 2>, cosines: array<vec4<f32>, 2>) -> f32 {
    return max(1.0 + dot(series[0], cosines[0]) + dot(series[1], cosines[1]), 0.0);
}

// Density of R in phi times 2 pi and its energy for a flat fibre: J F cos(phi'/2)/4 in closed form.
fn fibre_flat_surface(s: FibreShading, middle: vec2<f32>) -> f32 {
    let a = s.surface_aspect;
    let o = s.azimuth;
    let hit = max(middle.x * middle.x + a * a * middle.y * middle.y, 1e-6);
    let seen = a * a * o.x * o.x + o.y * o.y;
    let incidence = dot(middle, o);
    let d = a * incidence / sqrt(max(hit * seen, 1e-12));
    return 0.5 * SCATTERING_PI * a / hit * min(abs(d), 1.0) * fresnel(s.cos_eye * incidence, s.eta);
}

// K = S cos(theta_i), RGB per steradian, for light from omega_i in the fibre's frame.
fn fibre_evaluate(s: FibreShading, omega_i: vec3<f32>) -> vec3<f32> {
    let lobes = fibre_lobes(s, omega_i);
    return lobes.mirror + lobes.even;
}

// K of a fibre among others: `reach` of the light reaches it.
fn fibre_lit(s: FibreShading, lobes: FibreLobes, reach: FibreReach) -> vec3<f32> {
    let share = max(reach.even + reach.along * s.along, vec3<f32>(0.0));
    let around = max(1.0 + s.around * reach.place, vec3<f32>(0.0)) / max(1.0 + s.around * lobes.turn, vec3<f32>(0.1));
    return reach.mirror * lobes.mirror + min(share * around, vec3<f32>(2.0)) * lobes.even;
}

// How much of the medulla's light remembers where along the fibre it entered, for a shadow of which the square of the frequency is
// `frequency` times that of the table.
fn fibre_along(p: FibreParameters, row: FibreRow, absorption: vec3<f32>, frequency: f32) -> vec3<f32> {
    if p.structural {
        return vec3<f32>(0.0);
    }
    let along = gamma_memory(row.medulla.x, row.medulla.y, absorption, row.core[0].z);
    return along / max(along + frequency * (1.0 - along), vec3<f32>(1e-6));
}

// The same by how the light moves inside the fibre.
fn fibre_lobes(s: FibreShading, omega_i: vec3<f32>) -> FibreLobes {
    let polar = fibre_polar(omega_i);
    let light = vec2<f32>(polar.sine, polar.cosine);
    let o = s.azimuth;
    let cos_phi = clamp(dot(o, polar.azimuth), -1.0, 1.0);
    let half_raw = o + polar.azimuth;
    let half_square = dot(half_raw, half_raw);
    let middle = select(vec2<f32>(o.y, -o.x), half_raw * inverseSqrt(max(half_square, 1e-12)), half_square > 1e-12);

    let cosines = fibre_cosines(cos_phi, s.fine);
    var reflect_cosines = cosines;
    var through_cosines = cosines;
    var jacobian = 1.0;
    var reflected = azimuthal(s.surface, cosines);
    var shrink = 1.0;
    if s.aspect < FIBRE_ROUND {
        let a = s.core_aspect;
        let hit = middle.x * middle.x + a * a * middle.y * middle.y;
        let seen = a * a * o.x * o.x + o.y * o.y;
        let d = a * (middle.y * o.y + middle.x * o.x) * inverseSqrt(max(hit * seen, 1e-12));
        reflect_cosines = fibre_cosines(clamp(2.0 * d * d - 1.0, -1.0, 1.0), s.fine);
        jacobian = a / max(hit, 1e-6);
        reflected = fibre_flat_surface(s, middle) / max(s.energy_surface, 1e-6);
        let root = sqrt(s.aspect);
        let bend = fibre_acos(-cos_phi) / root;
        shrink = select(1.0 / root, 0.0, bend > SCATTERING_PI);
        through_cosines = fibre_cosines(-cos(bend), s.fine);
    }

    return fibre_sum(s, light, cos_phi, middle.y, reflected, azimuthal(s.inner, cosines),
        1.0 + dot(s.clear[0], through_cosines[0]) + dot(s.clear[1], through_cosines[1]),
        1.0 + dot(s.dense[0], through_cosines[0]) + dot(s.dense[1], through_cosines[1]),
        shrink, azimuthal(s.core, reflect_cosines) * jacobian);
}

// The lobes' azimuthal densities (times 2 pi) times their longitudinal terms and energies. `light`: sine and cosine of its
// inclination; `half_z`: z of the azimuth half way between eye and light.
fn fibre_sum(
    s: FibreShading,
    light: vec2<f32>,
    cos_phi: f32,
    half_z: f32,
    reflected: f32,
    returned: f32,
    clear: f32,
    dense: f32,
    shrink: f32,
    mirrored: f32,
) -> FibreLobes {
    let norm = 0.5 / SCATTERING_PI;
    let surface = reflected * fibre_longitudinal(s, light, 0u) * norm;
    let inner = returned * fibre_longitudinal(s, light, 2u) * norm;
    let through = max(mix(vec3<f32>(clear), vec3<f32>(dense), s.dense_share), vec3<f32>(0.0)) * shrink
        * fibre_longitudinal(s, light, 1u) * norm;
    let mirror = vec3<f32>(s.energy_surface * surface) + s.energy_inner * inner;
    let even = s.energy_through * through;
    if s.structural {
        let x = clamp((half_z + s.back_edge) / (2.0 * s.back_edge), 0.0, 1.0);
        let lit = x * x * (3.0 - 2.0 * x);
        let fourth = mirrored * mix(1.0, lit, s.dark_back)
            * fibre_longitudinal(s, light, 3u) * norm;
        return FibreLobes(mirror + s.energy_fourth * fourth, even, cos_phi);
    }
    let fourth = medulla_azimuth(s, cos_phi) * norm * light.y * (2.0 / SCATTERING_PI) * max(1.0 + s.medulla.z * light.x, 0.0);
    return FibreLobes(mirror, even + s.energy_fourth * fourth, cos_phi);
}

// Density of the medulla's light in phi times 2 pi.
fn medulla_azimuth(s: FibreShading, cos_phi: f32) -> f32 {
    return max(1.0 + 2.0 * s.medulla.x * cos_phi + 2.0 * s.medulla.y * (2.0 * cos_phi * cos_phi - 1.0), 0.0);
}

// acos to 2e-7 on every driver (the built-in may be off by 1e-3 near its ends).
fn fibre_acos(x: f32) -> f32 {
    let c = clamp(x, -1.0, 1.0);
    let a = abs(c);
    let near = sqrt(1.0 - a) * (1.5707963050 + a * (-0.2145988016 + a * (0.0889789874 + a * (-0.0501743046
        + a * (0.0308918810 + a * (-0.0170881256 + a * (0.0066700901 - a * 0.0012624911)))))));
    return select(near, SCATTERING_PI - near, c < 0.0);
}

// Terms of the series that the chooser's threshold asks for, 3..8.
fn fibre_terms(threshold: f32, azimuthal_roughness: f32) -> u32 {
    let wanted = clamp(6.858 * threshold - 0.282, 1.0, 3.0);
    return u32(clamp(ceil(wanted / max(azimuthal_roughness, 0.05)), 3.0, 8.0));
}

fn fibre_share_front(s: array<vec4<f32>, 2>) -> f32 {
    let odd = s[0].x - s[0].z / 3.0 + s[1].x / 5.0 - s[1].z / 7.0;
    return clamp(0.5 + odd / SCATTERING_PI, 0.0, 1.0);
}

// Share of light that the fibre scatters into all directions.
fn fibre_albedo(s: FibreShading) -> vec3<f32> {
    return s.energy_surface + s.energy_through + s.energy_inner + s.energy_fourth;
}

// Energy by side, for light without a direction (environment maps): specular + front + back = albedo.
fn fibre_energy_split(s: FibreShading) -> FibreEnergy {
    var fourth = 0.5 + s.medulla.x * 2.0 / SCATTERING_PI;
    var lit = 1.0;
    if s.structural {
        fourth = fibre_share_front(s.core);
        lit = mix(1.0, clamp(0.5 + 0.5 * s.azimuth.y, 0.0, 1.0), s.dark_back);
    }
    fourth = clamp(fourth, 0.0, 1.0);
    let inner = fibre_share_front(s.inner);
    let through = clamp(
        mix(vec3<f32>(fibre_share_front(s.clear)), vec3<f32>(fibre_share_front(s.dense)), s.dense_share),
        vec3<f32>(0.0),
        vec3<f32>(1.0),
    );
    let last = s.energy_fourth * lit;
    return FibreEnergy(
        s.energy_surface,
        s.energy_through * through + s.energy_inner * inner + last * fourth,
        s.energy_through * (1.0 - through) + s.energy_inner * (1.0 - inner) + last * (1.0 - fourth),
    );
}
