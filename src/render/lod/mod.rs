//! The LOD pass: one compute thread per card skins its root, culls it, bounds the pixel footprint over it, and writes which
//! evaluator its fragments use (DESIGN: the range-query switch of the paper, Sec. 5.3, decided once per card).
//!
//! It runs once for every camera, right before that camera draws, so that two cameras share one buffer.

mod pass;

use super::cut_out::FeatherPath;
use bevy::{
    core_pipeline::{Core3d, Core3dSystems},
    prelude::*,
    render::{GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems},
};

/// What the pass may decide for a card, and the names of its counters (diagnostics `render/feather_cards_<name>`): outside the
/// view; every footprint so small that NEAR serves; barbules never resolved, STRIPE; not even barbs, MEAN; each pixel decides.
/// The shaders' classes are the indices; from 1 on they are those of [`crate::query::Lod`].
pub const CARD_COUNTERS: [&str; 5] = ["culled", "near", "far", "mean", "mixed"];

pub(super) struct LodPlugin;

impl Plugin for LodPlugin {
    fn build(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .init_gpu_resource::<pass::LodBirds>()
            .add_systems(
                RenderStartup,
                pass::init_lod_pipeline
                    .run_if(not(resource_exists_and_equals(FeatherPath::CutOut))),
            )
            .add_systems(ExtractSchedule, pass::extract_birds)
            .add_systems(
                Render,
                pass::prepare_lod_bind_groups.in_set(RenderSystems::PrepareBindGroups),
            )
            .add_systems(
                Core3d,
                // The prepass already asks for the classes.
                pass::feather_lod.before(Core3dSystems::Prepass),
            );
    }
}
