// Colours of the debug views (DebugView in src/render/material.rs).
#define_import_path bevy_plumage::feather_debug
#import bevy_plumage::{
    anatomy::canonical,
    feather_bindings::{feather_at, rachis_at},
    feather_cover::{Covered, Frame},
    feather_data as data,
    feather_io::{FeatherVertex, class_of},
    feather_pattern::hash,
}

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
        case 1u: { return vec3(covered.weights.x + covered.weights.y, covered.weights.z, covered.weights.w); }
        case 2u: {
            let level = class_of(in);
            return select(
                vec3(f32(level == data::CARD_NEAR), f32(level == data::CARD_FAR), f32(level == data::CARD_MEAN)),
                vec3(1.0),
                level == data::CARD_MIXED,
            );
        }
        case 3u: { return hash_color(in.card.w >> 3u); }
        case 4u: { return vec3(data::card_layer(in.card.x)); }
        case 6u: { return hash_color(barb_number(in, base, shape)); }
        default: { return frame.normal * 0.5 + 0.5; }
    }
}
