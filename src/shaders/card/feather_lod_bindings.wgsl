// What the kernels of the LOD pass share.
#define_import_path bevy_plumage::feather_lod_bindings
#import bevy_render::view::View
#import bevy_plumage::feather_data as data

struct LodParams {
    world_from_local: mat4x4<f32>,
    // Heights of the worn pose.
    worn: vec4<f32>,
    // Of directional lights: unit vectors to them, and their shares of what comes from both; 0: there is none.
    first_light: vec4<f32>,
    second_light: vec4<f32>,
    card_count: u32,
    skin_index: u32,
    // Of the chooser, from the error budget.
    threshold: f32,
    // Largest error that light found at vertices may have, 0: it may not be found there.
    light_budget: f32,
    // Widths of a feather within which the order of the coat decides at most.
    order_window: f32,
    // 1: cards behind others are found.
    hides: u32,
    // Of the card mesh, in words: its first vertex, the size of one, and in it normal, joints, their weights, what it keeps of the poses.
    // NOTHING: it has none.
    first_word: u32,
    stride: u32,
    normal: u32,
    joints: u32,
    weights: u32,
    raised: u32,
}

const NOTHING: u32 = 0xffffffffu;

// Texels of the grid over a bird's place on the screen, along a side.
const GRID: u32 = 256u;
// In `grid`: one counter for each class, four bounds (see `bound_at`, `texels`), then the texels: depth of the nearest skin.
const BOUNDS: u32 = 8u;
const FIRST_TEXEL: u32 = 16u;
// vec4s that are kept of a card: its bounds on the screen, and its nearest depth; in normalized device coordinates. Behind those of all
// cards, one for each vertex of the skin.
const MEASURED: u32 = 2u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> params: LodParams;
@group(0) @binding(2) var<storage, read> feathers: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> cards: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> lod: array<u32>;
@group(0) @binding(5) var<storage, read_write> grid: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read> joints: array<mat4x4<f32>>;
// Of each card: first vertex, number of them, 0: not known; the rest is about another (`feather_lists`).
@group(0) @binding(7) var<storage, read> patches: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> vertices: array<u32>;
@group(0) @binding(9) var<storage, read_write> measured: array<vec4<f32>>;

fn card_count() -> u32 {
    return min(params.card_count, min(arrayLength(&lod) / data::LOD_WORDS, arrayLength(&cards) / data::CARD_LENGTH));
}

fn card_at(index: u32) -> data::Card {
    let at = index * data::CARD_LENGTH;
    return data::card_decode(cards[at], cards[at + 1u], cards[at + 2u], cards[at + 3u], cards[at + 4u]);
}

fn feather_row(index: u32) -> vec4<f32> {
    return feathers[min(index, arrayLength(&feathers) - 1u)];
}

fn joint(index: u32) -> mat4x4<f32> {
    return joints[min(params.skin_index + index, arrayLength(&joints) - 1u)];
}

fn blended(indices: vec4<u32>, weights: vec4<f32>) -> mat4x4<f32> {
    if (params.skin_index == NOTHING) {
        return params.world_from_local;
    }
    return joint(indices.x) * weights.x + joint(indices.y) * weights.y + joint(indices.z) * weights.z + joint(indices.w) * weights.w;
}

// A coordinate of the screen as a number of which larger ones are farther along `sign`.
fn bound_at(coordinate: f32, sign: f32) -> u32 {
    return u32(clamp(0.5 + 0.5 * sign * coordinate, 0.0, 1.0) * 16777215.0);
}

// From the screen to texels: their origin, and how many there are of them; `bounds`: as `bound_at` makes them, of low and high.
fn texels(bounds: vec4<u32>) -> vec4<f32> {
    let place = vec4(-1.0, -1.0, 1.0, 1.0) * (vec4<f32>(bounds) / 16777215.0 * 2.0 - 1.0);
    return vec4(place.xy, f32(GRID) / max(place.zw - place.xy, vec2(1e-6)));
}
