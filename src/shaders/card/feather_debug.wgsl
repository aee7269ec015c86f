// Colors of the debug views (DebugView in src/render/material.rs), which have pipelines of their own.
#define_import_path bevy_plumage::feather_debug
#import bevy_plumage::{
    anatomy::canonical,
    feather_bindings::{feather_at, rachis_at},
    feather_cover::{Covered, Frame},
    feather_data as data,
    feather_io::{FeatherVertex, class_of},
    feather_pattern::hash,
}

// DebugView as a number; Lobe is shown by feather.wgsl, Overdraw by its blending.
const VIEW_NONE: u32 = 0u;
const VIEW_COVERAGE: u32 = 1u;
const VIEW_LOD: u32 = 2u;
const VIEW_CARD: u32 = 3u;
const VIEW_LAYER: u32 = 4u;
const VIEW_NORMAL: u32 = 5u;
const VIEW_BARB: u32 = 6u;
const VIEW_LOBE: u32 = 7u;

fn hash_color(value: u32) -> vec3<f32> {
    let h = hash(value);
    return vec3(f32(h & 255u), f32((h >> 8u) & 255u), f32((h >> 16u) & 255u)) / 255.0;
}

// Number of the barb under the fragment, counted from the base; the two vanes apart.
fn barb_number(in: FeatherVertex, base: u32, shape: vec4<f32>) -> u32 {
    let at = canonical(in.uv, rachis_at(base, in.uv.y).x, shape.x);
    let right = at.x > 0.0;
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let angles = feather_at(slot);
    // The barbs run from the rachis outwards and towards the tip.
    let across = (-abs(at.x) * angles.y + at.y * angles.x) / max(feather_at(slot + 1u).x, 1e-9);
    return u32(max(across + 4096.5, 0.0)) * 2u + select(0u, 1u, right);
}

fn debug_color(view: u32, in: FeatherVertex, base: u32, shape: vec4<f32>, covered: Covered, frame: Frame) -> vec3<f32> {
    switch view {
        case VIEW_COVERAGE: { return vec3(covered.weights.x + covered.weights.y, covered.weights.z, covered.weights.w); }
        case VIEW_LOD: {
            let level = class_of(in);
            return select(
                vec3(f32(level == data::CARD_NEAR), f32(level == data::CARD_FAR), f32(level == data::CARD_MEAN)),
                vec3(1.0),
                level == data::CARD_MIXED,
            );
        }
        case VIEW_CARD: { return hash_color(data::card_index(in.card.w)); }
        case VIEW_LAYER: { return vec3(data::card_layer(in.card.x)); }
        case VIEW_BARB: { return hash_color(barb_number(in, base, shape)); }
        default: { return frame.normal * 0.5 + 0.5; }
    }
}
