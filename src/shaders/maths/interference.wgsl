// The lobe of barbules with thin layers, and the lookup of their color: the twin of
// src/maths/scattering/interference/{facet,seen,table,scale}.rs, same names. Directions are in the frame of the side that mirrors (`facet_turn`).
#define_import_path bevy_plumage::interference
#import bevy_plumage::math::smooth_step
#import bevy_plumage::scattering::{SCATTERING_PI, fibre_acos}

const FACET_EDGE: f32 = 0.1;
// Steps of the table of what an eye sees, in either direction.
const SEEN_STEPS: u32 = 16u;

struct Facets {
    flatness: f32,
    // In radians.
    slope: f32,
    back: f32,
}

struct FacetView {
    // Of the parametric angle of the ellipse where its normal looks at the eye: sine and cosine.
    turn: vec2<f32>,
    width: f32,
}

struct FacetSeen {
    energy: vec3<f32>,
    area: f32,
}

// The first of two neighbours in a list, and how far a place lies towards the second.
struct StackPlace {
    index: u32,
    fraction: f32,
}

struct SeenPlace {
    index: u32,
    fraction: vec2<f32>,
    area: f32,
    outer: f32,
    facing: f32,
}

// A point of a cell of a table between the corners of its simplex. Of these the first is the cell's own.
struct Simplex {
    // Steps from the cell's first corner to the second and to the third; all steps together lead to the fourth.
    second: u32,
    third: u32,
    fourth: u32,
    weights: vec4<f32>,
}

struct ScalePlace {
    index: u32,
    fraction: vec2<f32>,
}

// `place`: so many steps from the first of `count` values.
fn stack_row(place: f32, count: f32) -> StackPlace {
    let at = clamp(place, 0.0, count - 1.0);
    let low = min(floor(at), max(count - 2.0, 0.0));
    return StackPlace(u32(low), at - low);
}

// `place` 0..1 among `count` values in even steps.
fn stack_step(place: f32, count: f32) -> StackPlace {
    return stack_row(place * (count - 1.0), count);
}

// Of the four places around a point of the card the first, row after row of one less than `size`, and how far it lies from it.
fn scale_place(size: vec2<f32>, uv: vec2<f32>) -> ScalePlace {
    let column = stack_step(uv.x, size.x);
    let row = stack_step(uv.y, size.y);
    return ScalePlace(row.index * u32(max(size.x - 1.0, 1.0)) + column.index, vec2<f32>(column.fraction, row.fraction));
}

fn scale_mix(quad: vec4<f32>, fraction: vec2<f32>) -> f32 {
    let rows = mix(quad.xz, quad.yw, fraction.x);
    return mix(rows.x, rows.y, fraction.y);
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
    let per_across = inverseSqrt(max(dot(normal.yz, normal.yz), 1e-12));
    let azimuth = normal.yz * per_across;
    let a2 = facets.flatness * facets.flatness;
    let hit = clamp(azimuth.x * azimuth.x + a2 * azimuth.y * azimuth.y, a2, 1.0);
    let per_slope = 1.0 / facets.slope;
    let t = (0.5 * SCATTERING_PI - fibre_acos(normal.x)) * per_slope;
    let per_hit = inverseSqrt(hit);
    // 1/(2 sqrt(2 pi)).
    return 0.1994711402 * a2 * per_slope * exp(-0.5 * t * t) * (per_hit * per_hit * per_hit) * per_across;
}

// How much of the stack facets have of whose light the share `outer` comes from the outer side.
fn facet_share(facets: Facets, outer: f32) -> f32 {
    return mix(facets.back, 1.0, outer);
}

// The share of a facet whose normal has this z.
fn facet_side(facets: Facets, side: f32) -> f32 {
    return facet_share(facets, smooth_step(-FACET_EDGE, FACET_EDGE, side));
}

// `look`: color of the stack, and the reflectance of bare keratin.
fn facet_color(look: vec4<f32>, share: f32) -> vec3<f32> {
    return mix(vec3<f32>(look.w), look.rgb, share);
}

fn facet_azimuth(omega: vec3<f32>) -> vec2<f32> {
    let square = dot(omega.yz, omega.yz);
    return select(vec2<f32>(0.0, 1.0), omega.yz * inverseSqrt(square), square > 1e-12);
}

fn facet_view(facets: Facets, omega_o: vec3<f32>) -> FacetView {
    let o = facet_azimuth(omega_o) * vec2<f32>(facets.flatness, 1.0);
    let square = max(dot(o, o), 1e-12);
    let per = inverseSqrt(square);
    return FacetView(o * per, square * per);
}

// Area of the facets in the eye's projection, nearly; `constants` of the side (facet_constants in Rust).
fn facet_area(constants: vec2<f32>, width: f32, across: f32, along: f32) -> f32 {
    let seen = width * across;
    return max(sqrt(seen * seen * constants.x + constants.y * along * along), 1e-6);
}

// Place of an eye in the table of what it sees.
fn seen_place(facets: Facets, constants: vec2<f32>, omega_o: vec3<f32>) -> SeenPlace {
    let view = facet_view(facets, omega_o);
    let along = min(abs(omega_o.x), 1.0);
    let across = sqrt(dot(omega_o.yz, omega_o.yz));
    let share = (view.width - facets.flatness) / max(1.0 - facets.flatness, 1e-3);
    let column = stack_step(1.0 - sqrt(clamp(share, 0.0, 1.0)), f32(SEEN_STEPS));
    let level = stack_step(sqrt(fibre_acos(along) * (2.0 / SCATTERING_PI)), f32(SEEN_STEPS));
    return SeenPlace(
        level.index * SEEN_STEPS + column.index,
        vec2<f32>(column.fraction, level.fraction),
        facet_area(constants, view.width, across, along),
        0.5 + 0.5 * view.turn.y,
        min(view.width * across, 1.0),
    );
}

// The simplex of a cell around a point: along the steps in the order of their fractions, the largest first.
fn cell_simplex(fraction: vec3<f32>, steps: vec3<u32>) -> Simplex {
    let high = max(fraction.x, max(fraction.y, fraction.z));
    let low = min(fraction.x, min(fraction.y, fraction.z));
    let middle = fraction.x + fraction.y + fraction.z - high - low;
    let first = select(select(steps.z, steps.y, fraction.y == high), steps.x, fraction.x == high);
    let last = select(select(steps.x, steps.y, fraction.y == low), steps.z, fraction.z == low);
    let all = steps.x + steps.y + steps.z;
    return Simplex(first, all - last, all, vec4<f32>(1.0 - high, high - middle, middle - low, low));
}

// The same of a cell with four corners; the fourth has no weight.
fn cell_triangle(fraction: vec2<f32>, steps: vec2<u32>) -> Simplex {
    let high = max(fraction.x, fraction.y);
    let low = min(fraction.x, fraction.y);
    let all = steps.x + steps.y;
    return Simplex(select(steps.y, steps.x, fraction.x == high), all, all, vec4<f32>(1.0 - high, high - low, low, 0.0));
}

// What an eye sees, of its texel.
fn facet_seen(texel: vec4<f32>, place: SeenPlace) -> FacetSeen {
    return FacetSeen(texel.rgb, texel.w * place.area);
}

// The normal (y, z) of the ellipse at a parametric angle from the one that looks at the eye.
fn facet_normal(facets: Facets, view: FacetView, sine: f32, cosine: f32) -> vec2<f32> {
    return vec2<f32>(
        facets.flatness * (view.turn.x * cosine + view.turn.y * sine),
        view.turn.y * cosine - view.turn.x * sine,
    );
}

// Normal of the facets that mirror the light into the eye, and the cosine of incidence on them; `sum`: of both directions.
fn facet_half_way(sum: vec3<f32>) -> vec4<f32> {
    let square = dot(sum, sum);
    let per = inverseSqrt(max(square, 1e-12));
    return vec4<f32>(sum * per, 0.5 * square * per);
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
    let pdf = facet_pdf(facets, view, omega_o, facet_half_way(omega_o + direction));
    return vec4<f32>(direction, select(0.0, pdf, cos(slope) > 0.0 && pdf > 1e-9));
}
