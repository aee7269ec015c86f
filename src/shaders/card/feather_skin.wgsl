// The skin of a bird as a grid of depths: its vertices on the screen, then its triangles (see `feather_hide`).
#import bevy_render::view::View
#import bevy_plumage::feather_lod_bindings::{BOUNDS, FIRST_TEXEL, GRID, NOTHING, texels}

struct SkinParams {
    world_from_local: mat4x4<f32>,
    // Joints of the skin, NOTHING: it has none.
    skin_index: u32,
    vertex_count: u32,
    index_count: u32,
    // Of the mesh, in words: its first vertex, the size of one, and in it joints and their weights.
    first_word: u32,
    stride: u32,
    joints: u32,
    weights: u32,
    // First index; 1: two of them in a word.
    first_index: u32,
    short_indices: u32,
    // 1: triangles that turn their back to the eye are not drawn.
    one_sided: u32,
    // First of the vertices in `measured`.
    first_measured: u32,
}

// Most texels under a triangle.
const MOST_TEXELS: f32 = 4096.0;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> params: SkinParams;
@group(0) @binding(2) var<storage, read_write> grid: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> joints: array<mat4x4<f32>>;
@group(0) @binding(4) var<storage, read> vertices: array<u32>;
@group(0) @binding(5) var<storage, read> indices: array<u32>;
@group(0) @binding(6) var<storage, read_write> measured: array<vec4<f32>>;

fn word(index: u32) -> u32 {
    return vertices[min(params.first_word + index, arrayLength(&vertices) - 1u)];
}

fn number(index: u32) -> f32 {
    return bitcast<f32>(word(index));
}

fn joint(index: u32) -> mat4x4<f32> {
    return joints[min(params.skin_index + index, arrayLength(&joints) - 1u)];
}

fn matrix_at(at: u32) -> mat4x4<f32> {
    if (params.skin_index == NOTHING || params.joints == NOTHING || params.weights == NOTHING) {
        return params.world_from_local;
    }
    let j = vec2(word(at + params.joints), word(at + params.joints + 1u));
    let w = at + params.weights;
    return joint(j.x & 0xffffu) * number(w) + joint(j.x >> 16u) * number(w + 1u) + joint(j.y & 0xffffu) * number(w + 2u)
        + joint(j.y >> 16u) * number(w + 3u);
}

@compute @workgroup_size(64)
fn project(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = params.first_measured + id.x;
    if (id.x >= params.vertex_count || slot >= arrayLength(&measured)) {
        return;
    }
    let at = id.x * params.stride;
    let place = matrix_at(at) * vec4(number(at), number(at + 1u), number(at + 2u), 1.0);
    let clip = view.clip_from_world * vec4(place.xyz, 1.0);
    let shown = clip.w > 1e-6 && clip.z <= clip.w;
    measured[slot] = select(vec4(0.0), vec4(clip.xyz / max(clip.w, 1e-9), 1.0), shown);
}

fn corner(index: u32) -> vec4<f32> {
    let at = params.first_index + index;
    var found = indices[min(at, arrayLength(&indices) - 1u)];
    if (params.short_indices != 0u) {
        found = (indices[min(at / 2u, arrayLength(&indices) - 1u)] >> (16u * (at % 2u))) & 0xffffu;
    }
    let slot = params.first_measured + min(found, max(params.vertex_count, 1u) - 1u);
    return measured[min(slot, arrayLength(&measured) - 1u)];
}

fn turn(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

@compute @workgroup_size(64)
fn draw(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.index_count / 3u) {
        return;
    }
    let a = corner(3u * id.x);
    let b = corner(3u * id.x + 1u);
    let c = corner(3u * id.x + 2u);
    let area = turn(b.xy - a.xy, c.xy - a.xy);
    if (min(min(a.w, b.w), c.w) < 1.0 || area == 0.0 || (area < 0.0 && params.one_sided != 0u)) {
        return;
    }
    let place = texels(vec4(
        atomicLoad(&grid[BOUNDS]), atomicLoad(&grid[BOUNDS + 1u]), atomicLoad(&grid[BOUNDS + 2u]), atomicLoad(&grid[BOUNDS + 3u]),
    ));
    let p = (a.xy - place.xy) * place.zw;
    let q = (b.xy - place.xy) * place.zw;
    let r = (c.xy - place.xy) * place.zw;
    let low = max(floor(min(min(p, q), r) - 0.5), vec2(0.0));
    let high = min(ceil(max(max(p, q), r) + 0.5), vec2(f32(GRID)));
    let size = high - low;
    if (size.x < 1.0 || size.y < 1.0 || size.x * size.y > MOST_TEXELS) {
        return;
    }
    // Nowhere nearer than its farthest corner.
    let depth = bitcast<u32>(clamp(min(min(a.z, b.z), c.z), 0.0, 1.0));
    let side = sign(area);
    let count = vec2<u32>(size);
    for (var y = 0u; y < count.y; y++) {
        for (var x = 0u; x < count.x; x++) {
            let there = vec2<u32>(low) + vec2(x, y);
            let middle = vec2<f32>(there) + 0.5;
            let inside = side * vec3(turn(q - p, middle - p), turn(r - q, middle - q), turn(p - r, middle - r));
            if (all(inside >= vec3(0.0))) {
                atomicMax(&grid[FIRST_TEXEL + there.y * GRID + there.x], depth);
            }
        }
    }
}
