//! What the shaders have to agree with, for the test that reads both.

use super::{
    lights::VERTEX_LIGHTS,
    lod,
    lod::{CARD_COUNTERS, LOD_BYTES},
    material,
    material::DebugView,
    pack::{CARD_VEC4S, FEATHER_STRIDE, HEADER_LENGTH, MAX_REGIONS, header, stack},
    wind::motion,
};
use crate::{
    anatomy::{CONTOUR_ROWS, RACHIS_ROWS},
    maths::{
        query::{Lod, MAX_MAP_LOOKS},
        scattering::{
            KEPT_AZIMUTHS, KEPT_LEVELS, SHEEN_TABLE_SIZE, SHORT_HEAD_VEC4S, SHORT_ROW_VEC4S,
            SHORT_STEP_VEC4S, SHORT_TABLE_VEC4S, interference::SEEN_STEPS,
        },
    },
    shaders::{ConstantLayout, StructLayout},
};

/// The uniforms of the feather passes.
pub fn struct_layouts() -> Vec<StructLayout> {
    vec![
        material::settings_layout(),
        lod::params_layout(),
        lod::skin_params_layout(),
        lod::list_params_layout(),
    ]
}

/// The constants by which feathers and cards are packed, and numbers that stand for variants.
pub fn constant_layouts() -> Vec<ConstantLayout> {
    let in_file = |file: &'static str, constants: &[(&'static str, usize)]| {
        let constants = constants.iter().map(move |(name, value)| ConstantLayout {
            file,
            name,
            value: *value as u32,
        });
        constants.collect::<Vec<_>>()
    };
    let mut all = in_file(
        "card/feather_data.wgsl",
        &[
            ("FEATHERS_BASE", 1),
            ("HEADER_LENGTH", HEADER_LENGTH),
            ("RACHIS_SAMPLES", RACHIS_ROWS),
            ("CONTOUR_SAMPLES", CONTOUR_ROWS),
            ("SHEEN_SAMPLES", SHEEN_TABLE_SIZE),
            ("FEATHER_STRIDE", FEATHER_STRIDE),
            ("SHAPE", header::SHAPE),
            ("LEFT_VANE", header::LEFT_VANE),
            ("RIGHT_VANE", header::RIGHT_VANE),
            ("SHEEN", header::SHEEN),
            ("FIBRES", header::FIBRES),
            ("PARTS", header::PARTS),
            ("CAUGHT", header::CAUGHT),
            ("MIRRORS", header::MIRRORS),
            ("PAINT", header::PAINT),
            ("STACK_SIDE", stack::SIDE),
            ("STACK_TURN", stack::TURN),
            ("STACK_ROWS", stack::ROWS),
            ("STACK_MAP", stack::MAP),
            ("STACK_SEEN", stack::SEEN),
            ("KEPT_LEVELS", KEPT_LEVELS),
            ("KEPT_AZIMUTHS", KEPT_AZIMUTHS),
            ("CARD_LENGTH", CARD_VEC4S),
            ("MAX_REGIONS", MAX_REGIONS as usize),
            ("CARD_CULLED", 0),
            ("CARD_NEAR", Lod::Near as usize),
            ("CARD_FAR", Lod::Far as usize),
            ("CARD_MEAN", Lod::Mean as usize),
            ("CARD_MIXED", Lod::Mixed as usize),
            ("CARD_LIT", 5),
            ("CARD_HIDDEN", CARD_COUNTERS.len() - 1),
            ("LOD_WORDS", LOD_BYTES / 4),
            ("MOTION_WORN", motion::WORN),
            ("MOTION_LIGHTS", motion::LIGHTS),
            ("MOTION_REGIONS", motion::REGIONS),
        ],
    );
    all.extend(in_file(
        "maths/scattering_short.wgsl",
        &[
            ("SHORT_HEAD_LENGTH", SHORT_HEAD_VEC4S),
            ("SHORT_ROW_LENGTH", SHORT_ROW_VEC4S),
            ("SHORT_STEP_LENGTH", SHORT_STEP_VEC4S),
            ("SHORT_TABLE_LENGTH", SHORT_TABLE_VEC4S),
        ],
    ));
    all.extend(in_file(
        "card/feather_vertex_light.wgsl",
        &[("VERTEX_LIGHTS", VERTEX_LIGHTS)],
    ));
    all.extend(in_file(
        "maths/query_map.wgsl",
        &[("MAX_MAP_LOOKS", MAX_MAP_LOOKS as usize)],
    ));
    all.extend(in_file(
        "maths/interference.wgsl",
        &[("SEEN_STEPS", SEEN_STEPS)],
    ));
    all.extend(in_file(
        "maths/query.wgsl",
        &[
            ("LOD_NEAR", Lod::Near as usize),
            ("LOD_FAR", Lod::Far as usize),
            ("LOD_MEAN", Lod::Mean as usize),
            ("LOD_MIXED", Lod::Mixed as usize),
        ],
    ));
    all.extend(in_file(
        "card/feather_debug.wgsl",
        &[
            ("VIEW_NONE", DebugView::None as usize),
            ("VIEW_COVERAGE", DebugView::Coverage as usize),
            ("VIEW_LOD", DebugView::Lod as usize),
            ("VIEW_CARD", DebugView::Card as usize),
            ("VIEW_LAYER", DebugView::Layer as usize),
            ("VIEW_NORMAL", DebugView::Normal as usize),
            ("VIEW_BARB", DebugView::Barb as usize),
            ("VIEW_LOBE", DebugView::Lobe as usize),
        ],
    ));
    all
}
