//! How far the wind lifts every card (docs/book/wind.md), found once a frame before all views, so that no vertex of any pass asks the air.

use crate::shaders::FEATHER_LIFT;
use bevy::{
    asset::AssetServer,
    prelude::*,
    render::{
        globals::GlobalsUniform,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice},
    },
};

use super::pass::{LodBirds, LodParams, WORKGROUP};

/// Bytes of a card in the buffer of classes: its class, and its lift now and in the frame before.
pub const LOD_BYTES: usize = 8;

/// The pipeline and its layout, which has the numbers of `feather_lod_bindings`.
pub struct LiftPipeline {
    layout: BindGroupLayoutDescriptor,
    id: CachedComputePipelineId,
}

/// What the pass reads and writes of one bird.
pub struct LiftBuffers<'a> {
    pub params: BindingResource<'a>,
    pub cards: &'a Buffer,
    pub joints: &'a Buffer,
    pub motion: &'a Buffer,
    pub lod: &'a Buffer,
    pub globals: BindingResource<'a>,
}

impl LiftPipeline {
    /// Asks for the pipeline.
    pub fn new(server: &AssetServer, cache: &PipelineCache) -> Self {
        let layout = BindGroupLayoutDescriptor::new(
            "feather_lift_layout",
            &BindGroupLayoutEntries::with_indices(
                ShaderStages::COMPUTE,
                (
                    (1, uniform_buffer::<LodParams>(true)),
                    (3, storage_buffer_read_only_sized(false, None)),
                    (4, storage_buffer_sized(false, None)),
                    (6, storage_buffer_read_only_sized(false, None)),
                    (10, storage_buffer_read_only_sized(false, None)),
                    (11, uniform_buffer::<GlobalsUniform>(false)),
                ),
            ),
        );
        let id = cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some("feather_lift".into()),
            layout: vec![layout.clone()],
            shader: server.load(FEATHER_LIFT),
            entry_point: Some("lift".into()),
            ..default()
        });
        Self { layout, id }
    }

    /// Binds a bird.
    pub fn bind(
        &self,
        device: &RenderDevice,
        cache: &PipelineCache,
        bird: LiftBuffers,
    ) -> BindGroup {
        device.create_bind_group(
            "feather_lift_bind_group",
            &cache.get_bind_group_layout(&self.layout),
            &BindGroupEntries::with_indices((
                (1, bird.params),
                (3, bird.cards.as_entire_binding()),
                (4, bird.lod.as_entire_binding()),
                (6, bird.joints.as_entire_binding()),
                (10, bird.motion.as_entire_binding()),
                (11, bird.globals),
            )),
        )
    }
}

/// Lifts the cards of all birds that stand in the wind.
pub fn feather_lift(
    birds: Res<LodBirds>,
    pipeline: Option<Res<super::pass::LodPipeline>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let Some(pipeline) = pipeline.and_then(|all| cache.get_compute_pipeline(all.lift.id).cloned())
    else {
        return;
    };
    let mut blown = birds.blown().peekable();
    if blown.peek().is_none() {
        return;
    }
    let mut pass = ctx
        .command_encoder()
        .begin_compute_pass(&ComputePassDescriptor {
            label: Some("feather_lift"),
            timestamp_writes: None,
        });
    pass.set_pipeline(&pipeline);
    for (group, offset, count) in blown {
        pass.set_bind_group(0, group, &[offset]);
        pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
    }
}
