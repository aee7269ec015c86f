// Light on the fibres of a coat: the lights of the view, the sky as harmonics, and what of both reaches a place in the tile.
#define_import_path bevy_plumage::undercoat_lighting
#import bevy_plumage::down_light::{
    column_transmittance,
    kajiya_kay_diffuse,
    kajiya_kay_specular,
    light_exit,
    light_step,
    multiple_scattering,
    scattering_albedo,
    sky_irradiance,
}
#import bevy_plumage::down_march::{extinction_sine, lean_shift}
#import bevy_plumage::down_transfer::{
    Four,
    TransferBands,
    harmonics_one,
    harmonics_two,
    transfer_decode,
    transfer_rotate,
    transfer_zonal,
}
#import bevy_plumage::feather_lighting as lighting
#import bevy_plumage::undercoat_data as data

// Most lights that a coat takes notice of.
const MOST_LIGHTS: u32 = 8u;
// Curvature of the skin times the coat's height, where light grazes it.
const CURVATURE: f32 = 0.06;

// Lights and surroundings of one fragment.
struct Surroundings {
    count: u32,
    lights: array<lighting::Light, 8>,
    // Harmonics of the radiance, bands 0 to 2.
    sky: array<vec3<f32>, 9>,
}

// Vertices of an icosahedron: means over them are exact for the harmonics up to band 5.
fn spread_direction(i: u32) -> vec3<f32> {
    let a = select(-0.5257311, 0.5257311, (i & 1u) != 0u);
    let b = select(-0.8506508, 0.8506508, (i & 2u) != 0u);
    switch i / 4u {
        case 0u: { return vec3(a, b, 0.0); }
        case 1u: { return vec3(0.0, a, b); }
        default: { return vec3(b, 0.0, a); }
    }
}

fn surroundings_of(f: lighting::Fragment) -> Surroundings {
    var s: Surroundings;
    let lights = lighting::lights_of(f);
    s.count = min(lights.count, MOST_LIGHTS);
    for (var i = 0u; i < s.count; i++) {
        s.lights[i] = lighting::light_at(f, lights, i);
    }
    for (var i = 0u; i < 12u; i++) {
        let d = spread_direction(i);
        let radiance = lighting::environment(f, d, d, 1.0).irradiance;
        // The map holds the radiance blurred by the cosine: 1, 2/3, 1/4 of bands 0, 1, 2. A twelfth of the sphere each.
        let one = harmonics_one(d) * (1.5 * 1.04719755);
        let two = harmonics_two(d);
        let first = two.first * (4.0 * 1.04719755);
        s.sky[0] += radiance * (0.28209479 * 1.04719755);
        s.sky[1] += radiance * one.x;
        s.sky[2] += radiance * one.y;
        s.sky[3] += radiance * one.z;
        s.sky[4] += radiance * first.x;
        s.sky[5] += radiance * first.y;
        s.sky[6] += radiance * first.z;
        s.sky[7] += radiance * first.w;
        s.sky[8] += radiance * (two.last * (4.0 * 1.04719755));
    }
    return s;
}

// One place in the coat.
struct Place {
    // In the tile, height last.
    at: vec3<f32>,
    normal: vec3<f32>,
    tangent: vec3<f32>,
    to_eye: vec3<f32>,
    albedo: vec3<f32>,
    spread: f32,
    // Change of the place in the tile per height of the coat, towards a direction: of u and of v.
    grad_u: vec3<f32>,
    grad_v: vec3<f32>,
    // The same along the lay.
    lean: vec2<f32>,
    // Level of the density that a pixel resolves.
    level: f32,
}

// Where in the upright tile the leaning fibres of a place come from.
fn root_of(p: Place, at: vec3<f32>) -> vec3<f32> {
    return vec3(at.xy - p.lean * lean_shift(at.z, data::coat.lean), at.z);
}

// Share of a light that reaches a place, by a march through the tile.
fn marched_visibility(p: Place, light: vec3<f32>, count: u32) -> f32 {
    let mu = dot(p.normal, light);
    let way = light_exit(p.at.z, mu, CURVATURE);
    if (way >= 64.0) {
        return 0.0;
    }
    let slope = vec3(dot(p.grad_u, light), dot(p.grad_v, light), mu);
    let sine = extinction_sine(dot(p.tangent, light), p.spread);
    var depth = 0.0;
    for (var i = 0u; i < min(count, 16u); i++) {
        let step = light_step(i, count);
        let x = step.x * way;
        // A bent skin falls away below the ray.
        let rise = 0.5 * CURVATURE * x * x * (1.0 - mu * mu);
        let at = root_of(p, p.at + x * slope + vec3(0.0, 0.0, rise));
        depth += data::extinction_at(at, p.level) * (step.y * way);
    }
    return exp(-depth * sine);
}

// The same by the mean column above.
fn column_visibility(p: Place, light: vec3<f32>) -> f32 {
    let mu = dot(p.normal, light);
    let sine = extinction_sine(dot(p.tangent, light), p.spread);
    let way = light_exit(p.at.z, mu, CURVATURE);
    if (way >= 64.0) {
        return 0.0;
    }
    let mean = data::column_above(p.at.z) / max(1.0 - p.at.z, 0.02);
    return exp(-mean * way * sine);
}

// What of the light from all around reaches a place: four numbers, turned into the world.
fn transfer_at(p: Place) -> Four {
    let texel = textureSampleLevel(data::transfer_texture, data::tile_sampler, root_of(p, p.at), 0.0);
    let x = p.grad_u / max(length(p.grad_u), 1e-9);
    let y = p.grad_v / max(length(p.grad_v), 1e-9);
    return transfer_rotate(transfer_decode(texel, TransferBands(data::coat.bands)), mat3x3(x, y, p.normal));
}

// Radiance that an opaque piece of the coat sends to the eye. `near`: share of the light marched, the rest by the mean column.
fn coat_source(p: Place, s: Surroundings, near: f32) -> vec3<f32> {
    let albedo = scattering_albedo(p.albedo, data::coat.skin_color, data::coat.mean_depth);
    let eye_mu = max(dot(p.normal, p.to_eye), 0.0);
    let eye_cosine = dot(p.tangent, p.to_eye);
    var sum = vec3(0.0);
    for (var i = 0u; i < s.count; i++) {
        let light = s.lights[i];
        if (all(light.color <= vec3(0.0))) {
            continue;
        }
        let cosine = dot(p.tangent, light.direction);
        var visible = 0.0;
        // The first light is the key.
        let marched = select(0.0, near, i == 0u && data::coat.light_steps > 0u);
        if (marched > 0.0) {
            visible += marched * marched_visibility(p, light.direction, data::coat.light_steps);
        }
        if (marched < 1.0) {
            let correction = data::column_correction(eye_mu, dot(p.normal, light.direction));
            visible += (1.0 - marched) * correction * column_visibility(p, light.direction);
        }
        if (visible <= 0.0) {
            continue;
        }
        let mu = max(dot(p.normal, light.direction), 0.0);
        let lobe = kajiya_kay_diffuse(p.albedo, cosine, p.spread)
            + kajiya_kay_specular(data::coat.highlight_strength, data::coat.highlight_exponent, eye_cosine, cosine);
        sum += light.color * visible * lobe * multiple_scattering(eye_mu, mu, albedo);
    }
    let sky = transfer_zonal(transfer_at(p), TransferBands(data::coat.bands), s.sky);
    let even = mix(data::sky_correction(eye_mu), 1.0, near);
    return sum + p.albedo * sky * even * multiple_scattering(eye_mu, 0.5, albedo);
}

// Radiance of a skin painted like the feathers over it, as the standard material of birds draws it: dull (roughness 0.85), with
// the reflectance of keratin. For the surroundings the split sum of Karis 2014, for lights GGX.
fn painted_radiance(f: lighting::Fragment, s: Surroundings, albedo: vec3<f32>, normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let facing = max(dot(normal, to_eye), 1e-3);
    let around = lighting::environment(f, normal, reflect(-to_eye, normal), 0.85);
    let r = 0.85 * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    let glancing = min(r.x * r.x, exp2(-9.28 * facing)) * r.x + r.y;
    let split = vec2(-1.04, 1.04) * glancing + r.zw;
    var sum = albedo * around.irradiance + around.radiance * (0.04 * split.x + split.y);
    // Fourth power of the roughness.
    let square = 0.522;
    for (var i = 0u; i < s.count; i++) {
        let light = s.lights[i].direction;
        let mu = dot(normal, light);
        if (mu <= 0.0) {
            continue;
        }
        let half_way = normalize(light + to_eye);
        let d = dot(normal, half_way) * dot(normal, half_way) * (square - 1.0) + 1.0;
        let masked = mu * sqrt(facing * facing * (1.0 - square) + square) + facing * sqrt(mu * mu * (1.0 - square) + square);
        let mirrored = 0.04 + 0.96 * pow(saturate(1.0 - dot(light, half_way)), 5.0);
        let gloss = mirrored * 0.5 / max(masked, 1e-4) * square / (d * d);
        sum += s.lights[i].color * (mu / 3.14159265) * (albedo + gloss);
    }
    return sum;
}

// Radiance of the skin below the whole coat.
fn skin_radiance(f: lighting::Fragment, s: Surroundings, normal: vec3<f32>) -> vec3<f32> {
    let column = data::column_above(0.0);
    var sum = lighting::environment(f, normal, normal, 1.0).irradiance * sky_irradiance(column);
    for (var i = 0u; i < s.count; i++) {
        let mu = dot(normal, s.lights[i].direction);
        sum += s.lights[i].color * (max(mu, 0.0) * column_transmittance(column, mu) / 3.14159265);
    }
    return data::coat.skin_color * sum;
}
