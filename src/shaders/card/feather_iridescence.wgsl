// Barbules with thin layers on a card: their side, its color, what it leaves to the fibre (docs/book/iridescence.md).
#define_import_path bevy_plumage::feather_iridescence
#import bevy_plumage::{
    feather_bindings::feather_at,
    feather_data as data,
    interference::{
        Facets, SEEN_STEPS, StackPlace, cell_simplex, cell_triangle, facet_color, facet_evaluate, facet_half_way, facet_seen, facet_share, facet_side, facet_turn, in_gamut,
        scale_mix, scale_place, seen_place, stack_row, stack_step,
    },
    scattering::FibreShading,
}

// Barbules of either family; rachis and barbs have no layers.
const FIRST_BARBULE: u32 = 2u;
// Painted albedo up to which there is melanin for layers, and from which there is none.
const DARK: vec2<f32> = vec2(0.05, 0.2);
// Perceptual roughness of the prefiltered map that other feathers mirror.
const PLAIN_ROUGHNESS: f32 = 0.6;

// Texels of what an eye sees, for one thickness.
const SEEN_TEXELS: u32 = SEEN_STEPS * SEEN_STEPS;

// FAR and MEAN cards look once into the prefiltered map for a whole vane, others for each family of barbules.
#ifdef ONLY_FAR
const ONE_LOOK: bool = true;
#else ifdef ONLY_MEAN
const ONE_LOOK: bool = true;
#else
const ONE_LOOK: bool = false;
#endif

struct Shimmer {
    // Share of the barbule's surface that has layers, 0..1.
    share: f32,
    // Where the row's texels begin, how many there are, and how far the thickness lies towards the next row.
    table: u32,
    columns: f32,
    row: f32,
    // 1 where there is a next row, 0 where there is only one.
    next: u32,
    facets: Facets,
    // Sine and cosine.
    rise: vec2<f32>,
    lean: vec2<f32>,
    area: f32,
    energy: vec3<f32>,
}

// Color at a cosine of incidence, and what bare keratin reflects.
fn shimmer_look(s: Shimmer, cosine: f32) -> vec4<f32> {
    let place = stack_step(cosine, s.columns);
    let at = s.table + place.index;
#ifdef GRADED_LAYERS
    let cell = cell_triangle(vec2(place.fraction, s.row), vec2(1u, u32(s.columns) * s.next));
    let look = cell.weights.x * feather_at(at) + cell.weights.y * feather_at(at + cell.second) + cell.weights.z * feather_at(at + cell.third);
#else
    let look = mix(feather_at(at), feather_at(at + 1u), place.fraction);
#endif
    return vec4(in_gamut(look.rgb), look.w);
}

// Of the table of what eyes see.
fn shimmer_seen(at: u32, fraction: vec2<f32>, s: Shimmer) -> vec4<f32> {
#ifdef GRADED_LAYERS
    let cell = cell_simplex(vec3(fraction, s.row), vec3(1u, SEEN_STEPS, s.next * SEEN_TEXELS));
#else
    let cell = cell_triangle(fraction, vec2(1u, SEEN_STEPS));
#endif
    var texel = cell.weights.x * feather_at(at) + cell.weights.y * feather_at(at + cell.second) + cell.weights.z * feather_at(at + cell.third);
#ifdef GRADED_LAYERS
    texel += cell.weights.w * feather_at(at + cell.fourth);
#endif
    return texel;
}

// What a side without layers reflects at a cosine of incidence: no matter of thickness.
fn shimmer_bare(s: Shimmer, cosine: f32) -> f32 {
    let place = stack_step(cosine, s.columns);
    return mix(feather_at(s.table + place.index).w, feather_at(s.table + place.index + 1u).w, place.fraction);
}

// The tables' row for the thickness of the layers at a point of the card.
fn shimmer_row(base: u32, uv: vec2<f32>) -> StackPlace {
#ifdef GRADED_LAYERS
    let at = u32(feather_at(base + data::SHEEN).z);
    let rows = feather_at(at + data::STACK_ROWS).z;
    let map = feather_at(at + data::STACK_MAP);
    if (at > 0u && rows > 1.0) {
        let place = scale_place(map.yz, uv);
        return stack_row(scale_mix(feather_at(u32(map.x) + place.index), place.fraction), rows);
    }
#endif
    return StackPlace(0u, 0.0);
}

// `eye`: in the fibre's frame; `tipward`: the part of the barb's direction across the fibre there; `albedo`: as painted; `row`: of the
// tables.
fn shimmer_of(base: u32, part: u32, eye: vec3<f32>, tipward: f32, albedo: vec3<f32>, row: StackPlace) -> Shimmer {
    var s: Shimmer;
    let at = u32(feather_at(base + data::SHEEN).z);
    s.share = 1.0 - smoothstep(DARK.x, DARK.y, max(albedo.x, max(albedo.y, albedo.z)));
    if (at == 0u || part < FIRST_BARBULE || s.share <= 0.0) {
        s.share = 0.0;
        return s;
    }
    let side = feather_at(at + data::STACK_SIDE);
    let turn = feather_at(at + data::STACK_TURN);
    let rows = feather_at(at + data::STACK_ROWS);
    s.columns = side.w;
    s.row = row.fraction;
    s.next = u32(rows.z > 1.0);
    s.table = at + data::STACK_SEEN + u32(rows.z) * SEEN_TEXELS + row.index * u32(s.columns);
    let seen_at = at + data::STACK_SEEN + row.index * SEEN_TEXELS;
    s.facets = Facets(side.x, side.y, side.z);
    s.rise = turn.xy;
    s.lean = vec2(select(-turn.z, turn.z, tipward >= 0.0), turn.w);
    let place = seen_place(s.facets, rows.xy, facet_turn(eye, s.rise, s.lean));
    let texel = shimmer_seen(seen_at + place.index, place.fraction, s);
    let seen = facet_seen(texel, place);
    s.area = seen.area;
    s.energy = seen.energy;
    if (s.facets.back < 1.0) {
        s.energy = facet_color(vec4(s.energy, shimmer_bare(s, place.facing)), facet_share(s.facets, place.outer));
    }
    s.energy = s.share * clamp(s.energy, vec3(0.0), vec3(1.0));
    return s;
}

// What enters below the layers, of what entered without them: `surface` is the reflection that gives way.
fn shimmer_entering(shimmer: Shimmer, surface: f32) -> vec3<f32> {
    let left = 1.0 - surface * (1.0 - shimmer.share);
    return max(vec3(left) - shimmer.energy, vec3(0.0)) / max(1.0 - surface, 1e-3);
}

// What the layers reflect does not enter, and where they are the surface has no other reflection.
fn shimmer_let_in(shading: FibreShading, shimmer: Shimmer) -> FibreShading {
    var s = shading;
    let entering = shimmer_entering(shimmer, shading.energy_surface);
    s.energy_surface *= 1.0 - shimmer.share;
    s.energy_through *= entering;
    s.energy_inner *= entering;
    s.energy_fourth *= entering;
    return s;
}

// K of the layers; `sum`: of the directions to the eye and to the light, in the fibre's frame.
fn shimmer_lobe(shimmer: Shimmer, sum: vec3<f32>) -> vec3<f32> {
    if (shimmer.share <= 0.0) {
        return vec3(0.0);
    }
    let half_way = facet_half_way(facet_turn(sum, shimmer.rise, shimmer.lean));
    let color = facet_color(shimmer_look(shimmer, half_way.w), facet_side(shimmer.facets, half_way.z));
    return shimmer.share * facet_evaluate(shimmer.facets, shimmer.area, half_way) * color;
}

// Perceptual roughness of a prefiltered map as wide as the lobe: half of the light of an ellipse lies within atan(0.58 a) on either
// side.
fn shimmer_roughness(flatness: f32, slope: f32) -> f32 {
    return min(sqrt(sqrt(0.3364 * flatness * flatness + slope * slope)), 1.0);
}

// Where the middle of a family's side mirrors the eye; both in the fibre's frame.
fn shimmer_reflected(shimmer: Shimmer, eye: vec3<f32>) -> vec3<f32> {
    let m = facet_turn(eye, shimmer.rise, shimmer.lean) * vec3(-1.0, -1.0, 1.0);
    // The turn backwards: first the lean, then the rise.
    let up = m.z * shimmer.lean.y - m.y * shimmer.lean.x;
    let across = m.y * shimmer.lean.y + m.z * shimmer.lean.x;
    return vec3(m.x * shimmer.rise.y - up * shimmer.rise.x, across, up * shimmer.rise.y + m.x * shimmer.rise.x);
}

// The mirror of a vane, for the prefiltered map: mean normal of the sides of both families, in the card, and perceptual roughness.
// `barb`: direction of the barbs, `angles`: of data::LEFT_VANE.
fn shimmer_mirror(base: u32, barb: vec2<f32>, angles: vec4<f32>) -> vec4<f32> {
    let at = u32(feather_at(base + data::SHEEN).z);
    if (!ONE_LOOK || at == 0u) {
        return vec4(0.0, 0.0, 1.0, PLAIN_ROUGHNESS);
    }
    let side = feather_at(at + data::STACK_SIDE);
    let turn = feather_at(at + data::STACK_TURN);
    // Both families lean to the tip of the barb and rise along themselves; what they do across it cancels.
    let lean = turn.z * angles.z - turn.x * turn.w * angles.w;
    let up = turn.y * turn.w;
    return vec4(vec3(lean * barb, up) * inverseSqrt(lean * lean + up * up), shimmer_roughness(side.x, side.y));
}
