//! What the device must offer, checked once.

use bevy::{
    prelude::*,
    render::{RenderApp, renderer::RenderDevice},
};

/// Storage buffers that one stage of a feather pipeline binds: the view's clusters (3), Bevy's transparency list (3), the mesh
/// (1), and ours (1).
const STORAGE_BUFFERS_PER_STAGE: u32 = 8;

/// Warns, by name, of every limit that is too low for the feather pipelines.
pub fn check(app: &App) {
    let Some(render_app) = app.get_sub_app(RenderApp) else {
        return;
    };
    let Some(device) = render_app.world().get_resource::<RenderDevice>() else {
        return;
    };
    let limits = device.limits();
    if limits.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS_PER_STAGE {
        warn!(
            "bevy_plumage: Limits::max_storage_buffers_per_shader_stage is {}, feathers need {STORAGE_BUFFERS_PER_STAGE}; \
             they may not be drawn",
            limits.max_storage_buffers_per_shader_stage
        );
    }
    if limits.max_compute_invocations_per_workgroup < 64 {
        warn!(
            "bevy_plumage: Limits::max_compute_invocations_per_workgroup is {}, the LOD pass needs 64; every feather decides \
             per pixel",
            limits.max_compute_invocations_per_workgroup
        );
    }
}
