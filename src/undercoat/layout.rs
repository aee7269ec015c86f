//! What the shaders have to agree with, for the test that reads both.

use super::{
    component::{UndercoatTier, UndercoatView},
    extrude,
    material::{self, StrandUniform, UndercoatUniform},
    pack::{NODE_VEC4S, PRISM_VEC4S, REST_VEC4S},
};
use crate::{
    maths::undercoat::tier::FAR_SIZE,
    shaders::{ConstantLayout, StructLayout, struct_layout},
};

use bevy::shader::ShaderDefVal;

/// The uniforms of the coat, its strands and its extrusion.
pub fn struct_layouts() -> Vec<StructLayout> {
    vec![
        struct_layout!(UndercoatUniform, "undercoat/undercoat_data.wgsl", "UndercoatUniform", {
            node_count, prism_count, view, tier, eye_steps, light_steps, shell_count, jitter, color, largest_extinction,
            tip_color, mean_depth, skin_color, depth_clip, skin_spread, tip_spread, highlight_strength, highlight_exponent,
            lean, near_px, far_px, own_depth, shown, tinted, bands, column, correction,
        }),
        struct_layout!(StrandUniform, "undercoat/undercoat_strands.wgsl", "StrandUniform", {
            node_count, prism_count, color, radius, tip_color, fade, lean, droop, highlight_strength, highlight_exponent,
            column,
        }),
        extrude::params_layout(),
    ]
}

/// The constants by which shells are packed, and numbers that stand for variants.
pub fn constant_layouts() -> Vec<ConstantLayout> {
    let data = "undercoat/undercoat_data.wgsl";
    let strands = "undercoat/undercoat_strands.wgsl";
    let extrude = "undercoat/undercoat_extrude.wgsl";
    let all = [
        (data, "NODE_VEC4S", NODE_VEC4S),
        (strands, "NODE_VEC4S", NODE_VEC4S),
        (extrude, "NODE_VEC4S", NODE_VEC4S),
        (data, "PRISM_VEC4S", PRISM_VEC4S),
        (strands, "PRISM_VEC4S", PRISM_VEC4S),
        (extrude, "REST_VEC4S", REST_VEC4S),
        ("maths/down_tier.wgsl", "FAR_SIZE", FAR_SIZE as u32),
        (data, "VIEW_PRISM", UndercoatView::Prism as u32),
        (data, "VIEW_CELLS", UndercoatView::Cells as u32),
        (data, "VIEW_HEIGHT", UndercoatView::Height as u32),
        (data, "VIEW_TIER", UndercoatView::Tier as u32),
        (data, "VIEW_OPACITY", UndercoatView::Opacity as u32),
        (data, "VIEW_SKY", UndercoatView::Sky as u32),
        (data, "VIEW_BENT", UndercoatView::Bent as u32),
        (data, "VIEW_NORMAL", UndercoatView::Normal as u32),
        (data, "VIEW_TILE", UndercoatView::Tile as u32),
        (data, "TIER_NEAR", UndercoatTier::Near as u32),
        (data, "TIER_MID", UndercoatTier::Mid as u32),
        (data, "TIER_FAR", UndercoatTier::Far as u32),
    ];
    all.map(|(file, name, value)| ConstantLayout { file, name, value })
        .to_vec()
}

/// Definitions of every coat, then of strands, beside Bevy's own: `samples` is a number above 1.
pub fn fragment_defs(samples: u32) -> [Vec<Vec<ShaderDefVal>>; 2] {
    material::fragment_defs(samples)
}
