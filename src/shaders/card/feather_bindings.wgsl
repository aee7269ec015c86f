// The material's bindings and what is read through them.
#define_import_path bevy_plumage::feather_bindings
#import bevy_plumage::anatomy::contour_row
#import bevy_plumage::feather_data as data
#import bevy_plumage::masking::VaneShape

struct FeatherSettings {
    // Of the chooser, from the error budget.
    threshold: f32,
    multiple_scattering: f32,
    shelter: f32,
    dither: u32,
    debug_view: u32,
    // Samples of the environment map, 0: prefiltered maps.
    environment_samples: u32,
    // Widths of a feather within which the order of the coat decides.
    order_window: f32,
    // Number of the pattern of holes and samples.
    pattern: u32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> settings: FeatherSettings;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var<storage, read> feathers: array<vec4<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var<storage, read> cards: array<vec4<u32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var<storage, read> lod: array<u32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var albedo_texture: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var albedo_sampler: sampler;
// Shares of the cards inside the outlines, a layer per feather.
@group(#{MATERIAL_BIND_GROUP}) @binding(7) var outline_texture: texture_2d_array<f32>;
// Wind and ruffle, now and then a frame ago (twin of src/render/wind.rs): (direction, speed), (gusts, eddy size, eddy frequency,
// regions), heights of the worn pose, two lights (direction, 1: there is one), then (lift, compliance, limit, yaw) of each region.
@group(#{MATERIAL_BIND_GROUP}) @binding(6) var<storage, read> motion: array<vec4<f32>>;

// Indices are those of a table that feather_base has found: none lies outside.
fn feather_at(index: u32) -> vec4<f32> {
    return feathers[index];
}

// First vec4 of a feather.
fn feather_base(feather: u32) -> u32 {
    let count = u32(feathers[0].x);
    return data::FEATHERS_BASE + min(feather, max(count, 1u) - 1u) * data::FEATHER_STRIDE;
}

// The vane that begins at `slot`.
fn shape_at(slot: u32) -> VaneShape {
    return data::shape_unpack(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u), feather_at(slot + 3u), feather_at(slot + 4u));
}

// (F, F', r_r, 0) at v, linear between samples.
fn rachis_at(base: u32, v: f32) -> vec4<f32> {
    let x = clamp(v, 0.0, 1.0) * f32(data::RACHIS_SAMPLES - 1u);
    let i = min(u32(x), data::RACHIS_SAMPLES - 2u);
    let at = base + data::HEADER_LENGTH + i;
    return mix(feather_at(at), feather_at(at + 1u), x - f32(i));
}

// (left reach, right reach, their slopes) of the barb rooted at y0; a barb rooted outside the vane reaches nowhere.
fn contour_at(base: u32, start: f32, y0: f32) -> vec4<f32> {
    return contour_between(base, contour_row(y0, start, f32(data::CONTOUR_SAMPLES)));
}

// The same at a place between the rows, 0..CONTOUR_SAMPLES - 1.
fn contour_between(base: u32, row: f32) -> vec4<f32> {
    let i = min(u32(row), data::CONTOUR_SAMPLES - 2u);
    let at = base + data::HEADER_LENGTH + data::RACHIS_SAMPLES + i;
    return mix(feather_at(at), feather_at(at + 1u), row - f32(i));
}

// (aInv, bInv, R) of the sheen at a cosine of the eye: entry and fraction from sheen_place.
fn sheen_at(base: u32, place: vec2<f32>) -> vec3<f32> {
    let at = base + data::HEADER_LENGTH + data::RACHIS_SAMPLES + data::CONTOUR_SAMPLES + min(u32(place.x), data::SHEEN_SAMPLES - 2u);
    return mix(feather_at(at), feather_at(at + 1u), place.y).xyz;
}
