// The lobe of barbules with thin layers, and the lookup of their color: the twin of src/maths/scattering/interference/{facet,table}.rs,
// same names. Directions are in the frame of the side that mirrors (`facet_turn`).
#define_import_path bevy_plumage::interference
#import bevy_plumage::math::{error_function, smooth_step}
#import bevy_plumage::scattering::{SCATTERING_PI, fibre_acos, fresnel}

// Texels of a stack's table, even steps in the cosine of incidence.
const STACK_TEXELS: u32 = 64u;
// Nodes of the mean over the facets that an eye sees.
const FACET_NODES: u32 = 8u;
const FACET_BARE: f32 = 1.55;
const FACET_EDGE: f32 = 0.1;
const FACET_BRIGHT: f32 = 0.667;

struct Facets {
    flatness: f32,
    // In radians.
    slope: f32,
    back: f32,
}

struct FacetView {
    turn: vec2<f32>,
    width: f32,
    seen: f32,
    deviation: f32,
}

// Texel below a cosine of incidence, and how far the cosine lies towards the next.
struct StackPlace {
    index: u32,
    fraction: f32,
}

fn stack_place(cosine: f32) -> StackPlace {
    let place = clamp(cosine, 0.0, 1.0) * f32(STACK_TEXELS - 1u);
    let low = min(u32(place), STACK_TEXELS - 2u);
    return StackPlace(low, place - f32(low));
}

// Brings linear sRGB with negative channels into gamut, luminance kept.
fn in_gamut(rgb: vec3<f32>) -> vec3<f32> {
    let y = max(dot(rgb, vec3<f32>(0.2126, 0.7152, 0.0722)), 0.0);
    let least = min(min(rgb.x, rgb.y), min(rgb.z, 0.0));
    return clamp(y + (rgb - y) * (y / max(y - least, 1e-9)), vec3<f32>(0.0), vec3<f32>(1.0));
}

// A direction of a fibre's frame in that of a side that rises and leans, both (sine, cosine).
fn facet_turn(omega: vec3<f32>, rise: vec2<f32>, lean: vec2<f32>) -> vec3<f32> {
    let up = omega.z * rise.y - omega.x * rise.x;
    return vec3<f32>(
        omega.x * rise.y + omega.z * rise.x,
        omega.y * lean.y - up * lean.x,
        up * lean.y + omega.y * lean.x,
    );
}

// Density of the facets' normals per steradian.
fn facet_density(facets: Facets, normal: vec3<f32>) -> f32 {
    let across = max(dot(normal.yz, normal.yz), 1e-12);
    let a2 = facets.flatness * facets.flatness;
    let hit = clamp((normal.y * normal.y + a2 * normal.z * normal.z) / across, a2, 1.0);
    let t = (0.5 * SCATTERING_PI - fibre_acos(normal.x)) / facets.slope;
    let slope = exp(-0.5 * t * t) / (facets.slope * 2.5066282746);
    return 0.5 * a2 / (hit * sqrt(hit)) * slope * inverseSqrt(across);
}

// Mean of the absolute value of a normal variable.
fn mean_absolute(mean: f32, deviation: f32) -> f32 {
    let z = mean / max(deviation, 1e-6) * 0.7071067812;
    return mean * error_function(z) + 0.7978845608 * deviation * exp(-z * z);
}

fn facet_color(facets: Facets, color: vec3<f32>, cosine: f32, side: f32) -> vec3<f32> {
    let share = mix(facets.back, 1.0, smooth_step(-FACET_EDGE, FACET_EDGE, side));
    return mix(vec3<f32>(fresnel(cosine, FACET_BARE)), color, share);
}

fn facet_azimuth(omega: vec3<f32>) -> vec2<f32> {
    let across = length(omega.yz);
    return select(vec2<f32>(0.0, 1.0), omega.yz / max(across, 1e-6), across > 1e-6);
}

fn facet_view(facets: Facets, omega_o: vec3<f32>) -> FacetView {
    let o = facet_azimuth(omega_o) * vec2<f32>(facets.flatness, 1.0);
    let width = max(length(o), 1e-6);
    return FacetView(
        o / width,
        width,
        exp(-0.5 * facets.slope * facets.slope) * width * length(omega_o.yz),
        facets.slope * abs(omega_o.x),
    );
}

// The normal (y, z) of the ellipse at a parametric angle from the one that looks at the eye.
fn facet_normal(facets: Facets, view: FacetView, sine: f32, cosine: f32) -> vec2<f32> {
    return vec2<f32>(
        facets.flatness * (view.turn.x * cosine + view.turn.y * sine),
        view.turn.y * cosine - view.turn.x * sine,
    );
}

// Mean cosine, area in the eye's projection and z of the normal of a node.
fn facet_node(facets: Facets, view: FacetView, node: u32) -> vec3<f32> {
    var nodes = array<vec3<f32>, 4>(
        vec3<f32>(0.2841679239, 0.9587745256, 0.2848511774),
        vec3<f32>(0.7348899388, 0.6781863888, 0.2463846235),
        vec3<f32>(0.9494253843, 0.3139927382, 0.1746576560),
        vec3<f32>(0.9980552139, 0.0623361060, 0.0795047065),
    );
    let n = nodes[node / 2u];
    let normal = facet_normal(facets, view, select(n.x, -n.x, (node & 1u) == 1u), n.y);
    let size = max(length(normal), 1e-6);
    let mean = view.seen * n.y / size;
    let facing = max(mean_absolute(mean, view.deviation), 1e-6);
    let bright = (mean * mean + view.deviation * view.deviation) / facing;
    let cosine = mix(facing, bright, FACET_BRIGHT);
    return vec3<f32>(min(cosine, 1.0), n.z * size * facing, normal.y / size);
}

// Normal of the facets that mirror the light into the eye, and the cosine of incidence on them.
fn facet_half_way(omega_o: vec3<f32>, omega_i: vec3<f32>) -> vec4<f32> {
    let sum = omega_o + omega_i;
    let size = length(sum);
    return vec4<f32>(sum / max(size, 1e-6), 0.5 * size);
}

// K over the color of the facets, given what `facet_half_way` finds and the sum of the nodes' areas.
fn facet_evaluate(facets: Facets, area: f32, half_way: vec4<f32>) -> f32 {
    if half_way.w < 1e-4 {
        return 0.0;
    }
    return facet_density(facets, half_way.xyz) / (4.0 * area);
}

// Density of `facet_sample` at a direction, per steradian.
fn facet_pdf(facets: Facets, view: FacetView, omega_o: vec3<f32>, half_way: vec4<f32>) -> f32 {
    if half_way.w < 1e-4 {
        return 0.0;
    }
    let facing = abs(dot(facet_azimuth(omega_o), facet_azimuth(half_way.xyz)));
    return facet_density(facets, half_way.xyz) * facing / (4.0 * half_way.w * view.width);
}

// Samples a direction of the light; `u`: around, and two along. The fourth number is the density, 0: none.
fn facet_sample(facets: Facets, view: FacetView, omega_o: vec3<f32>, u: vec3<f32>) -> vec4<f32> {
    let sine = clamp(2.0 * u.x - 1.0, -1.0, 1.0);
    let around = facet_normal(facets, view, sine, sqrt(max(1.0 - sine * sine, 0.0)));
    let slope = facets.slope * sqrt(max(-2.0 * log(max(u.y, 1e-7)), 0.0)) * cos(2.0 * SCATTERING_PI * u.z);
    let normal = vec3<f32>(sin(slope), cos(slope) / max(length(around), 1e-6) * around);
    // Where a facet looks away, the one across from it is as likely, and is seen.
    let direction = 2.0 * dot(normal, omega_o) * normal - omega_o;
    let pdf = facet_pdf(facets, view, omega_o, facet_half_way(omega_o, direction));
    return vec4<f32>(direction, select(0.0, pdf, cos(slope) > 0.0 && pdf > 1e-9));
}
