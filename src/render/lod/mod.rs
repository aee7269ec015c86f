//! The LOD pass: one compute thread per card skins its root, culls it, bounds the pixel footprint over it, and writes which
//! evaluator its fragments use (the switch of Chen et al. 2026, Sec. 5.3, decided once per card; docs/book/lod.md#classes).
//!
//! It runs once for every camera, right before that camera draws, so that two cameras share one buffer. Once a frame, before all of them
//! and all shadow maps, another one finds how far the wind lifts every card.

mod hide;
mod lift;
mod lists;
mod pass;
mod skin;

#[cfg(feature = "internals")]
pub(super) use {lists::list_params_layout, pass::params_layout, skin::skin_params_layout};

pub(super) use {
    hide::{GRID_BYTES, MEASURED},
    lift::LOD_BYTES,
    lists::{CardLists, CardOrder, ListedDraw, list_bytes, pack_patches},
};

use super::limits::path_is_full;
use bevy::{
    core_pipeline::{Core3d, Core3dSystems},
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        mesh::allocator::MeshAllocatorSettings,
        render_resource::BufferUsages,
        renderer::{RenderGraph, RenderGraphSystems},
        storage::ShaderBuffer,
    },
};

/// Classes of cards, and the names of their counters (diagnostics `render/feather_cards_<name>`):
///
/// 0. `culled`: outside the view.
/// 1. `near`: every pixel resolves barbules; NEAR everywhere.
/// 2. `far`: no pixel resolves barbules; STRIPE everywhere.
/// 3. `mean`: no pixel resolves barbs; MEAN everywhere.
/// 4. `mixed`: each pixel picks its evaluator.
/// 5. `lit`: as `mean`, and the light is found at the vertices.
/// 6. `hidden`: behind the bird's own skin.
///
/// The index is the class in the shaders; 1 to 4 are those of [`crate::maths::query::Lod`].
pub const CARD_COUNTERS: [&str; 7] = ["culled", "near", "far", "mean", "mixed", "lit", "hidden"];

/// Where the cards are in their mesh ([`pack_patches`]).
#[derive(Component)]
pub(super) struct CardPatches {
    pub patches: Handle<ShaderBuffer>,
    /// Their order among the triangles, where these can be listed.
    pub order: Option<CardOrder>,
}

/// Lets compute shaders read the vertices of meshes. Before Bevy makes its buffers.
pub(super) fn share_meshes(app: &mut App) {
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        let mut settings = render_app
            .world_mut()
            .get_resource_or_init::<MeshAllocatorSettings>();
        settings.extra_buffer_usages |= BufferUsages::STORAGE;
    }
}

pub(super) struct LodPlugin;

impl Plugin for LodPlugin {
    fn build(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .init_gpu_resource::<pass::LodBirds>()
            .init_resource::<CardLists>()
            .add_systems(
                RenderStartup,
                (pass::init_lod_pipeline, lists::init_list_pipelines).run_if(path_is_full),
            )
            .add_systems(ExtractSchedule, pass::extract_birds)
            .add_systems(
                Render,
                pass::prepare_lod_bind_groups.in_set(RenderSystems::PrepareBindGroups),
            )
            .add_systems(
                RenderGraph,
                lift::feather_lift
                    .after(RenderGraphSystems::Begin)
                    .before(RenderGraphSystems::Render),
            )
            .add_systems(
                Core3d,
                // The prepass already asks for the classes.
                (
                    pass::feather_lod.before(Core3dSystems::Prepass),
                    pass::raise_lists
                        .after(Core3dSystems::Prepass)
                        .before(Core3dSystems::MainPass),
                ),
            );
    }
}
