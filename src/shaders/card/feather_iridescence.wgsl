// Barbules with thin layers on a card: their side, its color, what it leaves to the fibre (docs/book/iridescence.md).
#define_import_path bevy_plumage::feather_iridescence
#import bevy_plumage::{
    feather_bindings::feather_at,
    feather_data as data,
    interference::{
        FACET_NODES, Facets, facet_color, facet_evaluate, facet_half_way, facet_node, facet_turn, facet_view, in_gamut, stack_place,
    },
    scattering::FibreShading,
}

// Barbules of either family; rachis and barbs have no layers.
const FIRST_BARBULE: u32 = 2u;
// Painted albedo up to which there is melanin for layers, and from which there is none.
const DARK: vec2<f32> = vec2(0.05, 0.2);

struct Shimmer {
    // Share of the barbule's surface that has layers, 0..1.
    share: f32,
    // Where the texels begin.
    table: u32,
    facets: Facets,
    // Sine and cosine.
    rise: vec2<f32>,
    lean: vec2<f32>,
    // To the eye, in the side's frame.
    eye: vec3<f32>,
    area: f32,
    energy: vec3<f32>,
}

fn stack_color(table: u32, cosine: f32) -> vec3<f32> {
    let place = stack_place(cosine);
    let at = table + place.index;
    return in_gamut(mix(feather_at(at).rgb, feather_at(at + 1u).rgb, place.fraction));
}

// `eye`: in the fibre's frame; `tipward`: the part of the barb's direction across the fibre there; `albedo`: as painted.
fn shimmer_of(base: u32, part: u32, eye: vec3<f32>, tipward: f32, albedo: vec3<f32>) -> Shimmer {
    var s: Shimmer;
    let at = u32(feather_at(base + data::SHEEN).z);
    s.share = 1.0 - smoothstep(DARK.x, DARK.y, max(albedo.x, max(albedo.y, albedo.z)));
    if (at == 0u || part < FIRST_BARBULE || s.share <= 0.0) {
        s.share = 0.0;
        return s;
    }
    let side = feather_at(at);
    let turn = feather_at(at + 1u);
    s.table = at + 2u;
    s.facets = Facets(side.x, side.y, side.z);
    s.rise = turn.xy;
    s.lean = vec2(select(-turn.z, turn.z, tipward >= 0.0), turn.w);
    s.eye = facet_turn(eye, s.rise, s.lean);
    let view = facet_view(s.facets, s.eye);
    for (var node = 0u; node < FACET_NODES; node++) {
        let found = facet_node(s.facets, view, node);
        s.area += found.y;
        s.energy += found.y * facet_color(s.facets, stack_color(s.table, found.x), found.x, found.z);
    }
    s.area = max(s.area, 1e-6);
    s.energy = s.share * clamp(s.energy / s.area, vec3(0.0), vec3(1.0));
    return s;
}

// What the layers reflect does not enter, and where they are the surface has no other reflection.
fn shimmer_let_in(shading: FibreShading, shimmer: Shimmer) -> FibreShading {
    var s = shading;
    s.energy_surface *= 1.0 - shimmer.share;
    let entering = max(vec3(1.0 - s.energy_surface) - shimmer.energy, vec3(0.0)) / max(1.0 - shading.energy_surface, 1e-3);
    s.energy_through *= entering;
    s.energy_inner *= entering;
    s.energy_fourth *= entering;
    return s;
}

// K of the layers for light from `omega_i`, in the fibre's frame.
fn shimmer_lobe(shimmer: Shimmer, omega_i: vec3<f32>) -> vec3<f32> {
    if (shimmer.share <= 0.0) {
        return vec3(0.0);
    }
    let half_way = facet_half_way(shimmer.eye, facet_turn(omega_i, shimmer.rise, shimmer.lean));
    let color = facet_color(shimmer.facets, stack_color(shimmer.table, half_way.w), half_way.w, half_way.z);
    return shimmer.share * facet_evaluate(shimmer.facets, shimmer.area, half_way) * color;
}

// Where the middle of the side mirrors the eye, in the fibre's frame.
fn shimmer_mirror(shimmer: Shimmer) -> vec3<f32> {
    let m = vec3(-shimmer.eye.x, -shimmer.eye.y, shimmer.eye.z);
    // The turn backwards: first the lean, then the rise.
    let up = m.z * shimmer.lean.y - m.y * shimmer.lean.x;
    let across = m.y * shimmer.lean.y + m.z * shimmer.lean.x;
    return vec3(m.x * shimmer.rise.y - up * shimmer.rise.x, across, up * shimmer.rise.y + m.x * shimmer.rise.x);
}

// Perceptual roughness of a prefiltered map as wide as the lobe.
fn shimmer_roughness(facets: Facets) -> f32 {
    return min(sqrt(length(vec2(0.58 * facets.flatness, facets.slope))), 1.0);
}
