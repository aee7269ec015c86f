// One thread per card, once a frame before all views: how far the wind lifts it (docs/book/wind.md).
#import bevy_render::globals::Globals
#import bevy_plumage::{
    feather_data as data,
    feather_lod_bindings as lods,
    wind::{Breeze, wind_lift, wind_velocity},
}

// Rows of the bird (see feather_bindings).
@group(0) @binding(10) var<storage, read> motion: array<vec4<f32>>;
@group(0) @binding(11) var<uniform> globals: Globals;

fn motion_at(row: u32) -> vec4<f32> {
    return motion[min(row, arrayLength(&motion) - 1u)];
}

@compute @workgroup_size(64)
fn lift(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= lods::card_count()) {
        return;
    }
    let card = lods::card_at(id.x);
    let world_from_local = lods::blended(card.joints, card.weights);
    let air = motion_at(0u);
    let eddies = motion_at(1u);
    let region = motion_at(data::region_row(card.feather, eddies.w));
    let breeze = Breeze(air.xyz, air.w, eddies.x, eddies.y, eddies.z);
    let root = (world_from_local * vec4(card.root, 1.0)).xyz;
    let along = (world_from_local * vec4(card.along, 0.0)).xyz;
    let stretch = max(length(along), 1e-9);
    let normal = (world_from_local * vec4(card.normal, 0.0)).xyz;
    let wind = wind_velocity(breeze, root, globals.time);
    let angle = wind_lift(wind, along / stretch, normal / max(length(normal), 1e-9), stretch * card.length, region.y, region.z);
    let at = arrayLength(&lods::lod) / data::LOD_WORDS + id.x;
    lods::lod[at] = data::lift_bits(angle, data::lift_of(lods::lod[at]).x);
}
