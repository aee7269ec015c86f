// What a coat's material binds, and how shells lie in memory (src/undercoat/pack.rs, src/undercoat/material.rs).
#define_import_path bevy_plumage::undercoat_data
#import bevy_plumage::down_light::packed_color
#import bevy_plumage::down_tier::{FAR_SIZE, far_node}
#import bevy_plumage::down_walk::{PrismCorners, prism_parity}

// Meanings and units: src/undercoat/material.rs.
struct UndercoatUniform {
    node_count: u32,
    prism_count: u32,
    view: u32,
    tier: u32,
    eye_steps: u32,
    light_steps: u32,
    shell_count: u32,
    jitter: u32,
    color: vec3<f32>,
    largest_extinction: f32,
    tip_color: vec3<f32>,
    mean_depth: f32,
    skin_color: vec3<f32>,
    depth_clip: f32,
    skin_spread: f32,
    tip_spread: f32,
    highlight_strength: f32,
    highlight_exponent: f32,
    lean: f32,
    near_px: f32,
    far_px: f32,
    own_depth: u32,
    shown: f32,
    tinted: f32,
    bands: array<vec4<f32>, 8>,
    column: array<vec4<f32>, 8>,
    // Near over middle tier, by the cosines of eye and light, then of the sky by that of the eye.
    correction: array<vec4<f32>, 18>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> coat: UndercoatUniform;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var<storage, read> shell: array<vec4<u32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var density_texture: texture_3d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var tile_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var transfer_texture: texture_3d<f32>;

const NODE_VEC4S: u32 = 3u;
const PRISM_VEC4S: u32 = 4u;
const VIEW_PRISM: u32 = 1u;
const VIEW_CELLS: u32 = 2u;
const VIEW_HEIGHT: u32 = 3u;
const VIEW_TIER: u32 = 4u;
const VIEW_OPACITY: u32 = 5u;
const VIEW_SKY: u32 = 6u;
const VIEW_BENT: u32 = 7u;
const VIEW_NORMAL: u32 = 8u;
const VIEW_TILE: u32 = 9u;
const TIER_NEAR: u32 = 1u;
const TIER_MID: u32 = 2u;
const TIER_FAR: u32 = 3u;

fn bits(index: u32) -> vec4<u32> {
    return shell[min(index, arrayLength(&shell) - 1u)];
}

fn word(index: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(bits(index));
}

struct Node {
    bottom: vec3<f32>,
    height: f32,
    top: vec3<f32>,
    lay: vec3<f32>,
    color: vec3<f32>,
}

fn node_at(index: u32) -> Node {
    let at = NODE_VEC4S * min(index, coat.node_count - 1u);
    let bottom = word(at);
    let lay = bits(at + 2u);
    return Node(
        bottom.xyz,
        bottom.w,
        word(at + 1u).xyz,
        bitcast<vec3<f32>>(lay.xyz),
        packed_color(lay.w),
    );
}

// A prism, its corners relative to `origin`.
struct PrismCell {
    corners: PrismCorners,
    ids: vec3<u32>,
    links: vec3<u32>,
    parity: f32,
    heights: vec3<f32>,
    // u of the three corners, and v.
    u: vec3<f32>,
    v: vec3<f32>,
}

fn prism_at(index: u32, origin: vec3<f32>) -> PrismCell {
    let at = NODE_VEC4S * coat.node_count + PRISM_VEC4S * min(index, coat.prism_count - 1u);
    let ids = bits(at);
    let links = bits(at + 1u);
    let first = word(at + 2u);
    let second = word(at + 3u);
    let last = coat.node_count - 1u;
    let a = NODE_VEC4S * min(ids.x, last);
    let b = NODE_VEC4S * min(ids.y, last);
    let c = NODE_VEC4S * min(ids.z, last);
    let bottom_a = word(a);
    let bottom_b = word(b);
    let bottom_c = word(c);
    var cell: PrismCell;
    cell.corners = PrismCorners(
        bottom_a.xyz - origin,
        bottom_b.xyz - origin,
        bottom_c.xyz - origin,
        word(a + 1u).xyz - origin,
        word(b + 1u).xyz - origin,
        word(c + 1u).xyz - origin,
    );
    cell.ids = ids.xyz;
    cell.links = links.xyz;
    cell.parity = prism_parity(ids.w);
    cell.heights = max(vec3(bottom_a.w, bottom_b.w, bottom_c.w), vec3(1e-7));
    cell.u = vec3(first.x, first.z, second.x);
    cell.v = vec3(first.y, first.w, second.y);
    return cell;
}

// Directions in which u and v rise, per metre along the skin.
struct Gradient {
    u: vec3<f32>,
    v: vec3<f32>,
}

fn tile_gradient(cell: PrismCell) -> Gradient {
    let e = cell.corners.b - cell.corners.a;
    let f = cell.corners.c - cell.corners.a;
    let n = cross(e, f);
    let square = max(dot(n, n), 1e-30);
    let g = cross(f, n) / square;
    let h = cross(n, e) / square;
    return Gradient(
        (cell.u.y - cell.u.x) * g + (cell.u.z - cell.u.x) * h,
        (cell.v.y - cell.v.x) * g + (cell.v.z - cell.v.x) * h,
    );
}

// The frame of the skin at a place of a prism.
struct Frame {
    normal: vec3<f32>,
    lay: vec3<f32>,
    color: vec3<f32>,
}

fn frame_at(cell: PrismCell, weights: vec3<f32>) -> Frame {
    let a = node_at(cell.ids.x);
    let b = node_at(cell.ids.y);
    let c = node_at(cell.ids.z);
    let normal = (a.top - a.bottom) / max(a.height, 1e-7) * weights.x
        + (b.top - b.bottom) / max(b.height, 1e-7) * weights.y
        + (c.top - c.bottom) / max(c.height, 1e-7) * weights.z;
    let lay = a.lay * weights.x + b.lay * weights.y + c.lay * weights.z;
    let unit = normal / max(length(normal), 1e-6);
    let flat = lay - unit * dot(lay, unit);
    var frame: Frame;
    frame.normal = unit;
    frame.lay = select(unit, flat / max(length(flat), 1e-6), length(flat) > 1e-3);
    frame.color = a.color * weights.x + b.color * weights.y + c.color * weights.z;
    return frame;
}

// Extinction of the tile, optical depth per height.
fn extinction_at(place: vec3<f32>, level: f32) -> f32 {
    return coat.largest_extinction * textureSampleLevel(density_texture, tile_sampler, place, level).r;
}

// Cells of the tile along a direction in which the place changes by `slope` tiles.
fn cells_along(slope: vec3<f32>) -> f32 {
    return f32(textureDimensions(density_texture, 0).x) * length(slope);
}

// Mean optical depth above a height.
fn column_above(height: f32) -> f32 {
    let x = clamp(height, 0.0, 1.0) * 31.0;
    let i = min(u32(x), 30u);
    let a = coat.column[i / 4u][i % 4u];
    let b = coat.column[(i + 1u) / 4u][(i + 1u) % 4u];
    return mix(a, b, x - f32(i));
}

fn correction_node(i: u32) -> f32 {
    return coat.correction[i / 4u][i % 4u];
}

// What the sky of the middle tier is multiplied with.
fn sky_correction(eye: f32) -> f32 {
    let x = far_node(eye);
    let i = min(u32(x), FAR_SIZE - 2u);
    let first = FAR_SIZE * FAR_SIZE + i;
    return mix(correction_node(first), correction_node(first + 1u), x - f32(i));
}

// What the light of the middle tier, by the mean column, is multiplied with, that the tiers agree in the mean.
fn column_correction(eye: f32, light: f32) -> f32 {
    let x = vec2(far_node(eye), far_node(light));
    let low = min(floor(x), vec2(f32(FAR_SIZE - 2u)));
    let f = x - low;
    let i = u32(low.x) + FAR_SIZE * u32(low.y);
    return mix(
        mix(correction_node(i), correction_node(i + 1u), f.x),
        mix(correction_node(i + FAR_SIZE), correction_node(i + FAR_SIZE + 1u), f.x),
        f.y,
    );
}

// Mean extinction at a height.
fn mean_extinction(height: f32) -> f32 {
    let low = clamp(height - 0.04, 0.0, 0.92);
    return max(column_above(low) - column_above(low + 0.08), 0.0) * 12.5;
}
