//! Pipeline, bind groups and dispatch of the LOD pass.

use super::{
    super::{
        material::FeatherMaterial,
        vertex_light::{VERTEX_LIGHTS, VertexLights},
    },
    CARD_COUNTERS,
};
use crate::{groom::PlumageCards, shaders::FEATHER_LOD};
use bevy::{
    pbr::{MeshMaterial3d, SkinUniforms},
    prelude::*,
    render::{
        Extract,
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_asset::RenderAssets,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        settings::WgpuFeatures,
        storage::{GpuShaderBuffer, ShaderBuffer},
        sync_world::MainEntity,
        view::{ViewUniform, ViewUniformOffset, ViewUniforms},
    },
};

/// Threads of a workgroup.
const WORKGROUP: u32 = 64;
/// Marks a bird without a skin.
const NO_SKIN: u32 = u32::MAX;

/// One bird, as the pass sees it.
pub struct LodBird {
    entity: MainEntity,
    cards: AssetId<ShaderBuffer>,
    lod: AssetId<ShaderBuffer>,
    feathers: AssetId<ShaderBuffer>,
    count: u32,
    threshold: f32,
    light_budget: f32,
    world_from_local: Mat4,
    bind_group: Option<BindGroup>,
    params_offset: u32,
}

/// All birds of the frame and the buffers they share.
#[derive(Resource)]
pub struct LodBirds {
    birds: Vec<LodBird>,
    /// See [`VertexLights::rows`].
    lights: [Vec4; VERTEX_LIGHTS],
    params: DynamicUniformBuffer<LodParams>,
    counters: Buffer,
}

impl FromWorld for LodBirds {
    fn from_world(world: &mut World) -> Self {
        let counters = world
            .resource::<RenderDevice>()
            .create_buffer(&BufferDescriptor {
                label: Some("feather_card_counters"),
                size: 4 * CARD_COUNTERS.len() as u64,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
        Self {
            birds: Vec::new(),
            lights: default(),
            params: DynamicUniformBuffer::default(),
            counters,
        }
    }
}

/// Parameters of one bird.
#[derive(Clone, Copy, ShaderType)]
struct LodParams {
    world_from_local: Mat4,
    card_count: u32,
    /// First joint matrix, or `u32::MAX` without a skin.
    skin_index: u32,
    threshold: f32,
    light_budget: f32,
    first_light: Vec4,
    second_light: Vec4,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(in crate::render) fn params_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(LodParams, "card/feather_lod.wgsl", "LodParams", {
        world_from_local, card_count, skin_index, threshold, light_budget, first_light, second_light,
    })
}

/// The compute pipeline and its layout.
#[derive(Resource)]
pub struct LodPipeline {
    layout: BindGroupLayoutDescriptor,
    pipeline: CachedComputePipelineId,
}

pub fn init_lod_pipeline(
    mut commands: Commands,
    asset_server: Res<AssetServer>,
    cache: Res<PipelineCache>,
) {
    let layout = BindGroupLayoutDescriptor::new(
        "feather_lod_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                uniform_buffer::<ViewUniform>(true),
                uniform_buffer::<LodParams>(true),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
                storage_buffer_sized(false, None),
                storage_buffer_read_only_sized(false, None),
            ),
        ),
    );
    let pipeline = cache.queue_compute_pipeline(ComputePipelineDescriptor {
        label: Some("feather_lod".into()),
        layout: vec![layout.clone()],
        shader: asset_server.load(FEATHER_LOD),
        entry_point: Some("classify".into()),
        ..default()
    });
    commands.insert_resource(LodPipeline { layout, pipeline });
}

pub fn extract_birds(
    mut birds: ResMut<LodBirds>,
    query: Extract<
        Query<(
            Entity,
            &PlumageCards,
            &MeshMaterial3d<FeatherMaterial>,
            &GlobalTransform,
            &ViewVisibility,
        )>,
    >,
    materials: Extract<Res<Assets<FeatherMaterial>>>,
    lights: Extract<Res<VertexLights>>,
) {
    birds.birds.clear();
    birds.lights = lights.rows();
    for (entity, cards, material, transform, visible) in &query {
        let Some(material) = materials.get(material.id()) else {
            continue;
        };
        if !visible.get() || cards.cards.is_empty() {
            continue;
        }
        birds.birds.push(LodBird {
            entity: entity.into(),
            cards: material.cards.id(),
            lod: material.lod.id(),
            feathers: material.feathers.id(),
            count: cards.cards.len() as u32,
            threshold: material.settings.threshold(),
            light_budget: if lights.are_all() {
                material.light_budget()
            } else {
                0.0
            },
            world_from_local: transform.to_matrix(),
            bind_group: None,
            params_offset: 0,
        });
    }
}

pub fn prepare_lod_bind_groups(
    mut birds: ResMut<LodBirds>,
    pipeline: Option<Res<LodPipeline>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    skins: Option<Res<SkinUniforms>>,
    views: Res<ViewUniforms>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
) {
    let LodBirds {
        birds,
        lights: [first_light, second_light],
        params,
        counters,
    } = birds.as_mut();
    let (Some(pipeline), Some(skins), Some(views)) = (pipeline, skins, views.uniforms.binding())
    else {
        return;
    };
    params.clear();
    for bird in birds.iter_mut() {
        bird.params_offset = params.push(&LodParams {
            world_from_local: bird.world_from_local,
            card_count: bird.count,
            skin_index: skins.skin_index(bird.entity).unwrap_or(NO_SKIN),
            threshold: bird.threshold,
            light_budget: bird.light_budget,
            first_light: *first_light,
            second_light: *second_light,
        });
    }
    params.write_buffer(&device, &queue);
    let Some(params) = params.binding() else {
        return;
    };
    let layout = cache.get_bind_group_layout(&pipeline.layout);
    for bird in birds.iter_mut() {
        let (Some(feathers), Some(cards), Some(lod)) = (
            buffers.get(bird.feathers),
            buffers.get(bird.cards),
            buffers.get(bird.lod),
        ) else {
            continue;
        };
        // The skins' buffer swaps and grows every frame, so this group cannot be kept.
        bird.bind_group = Some(device.create_bind_group(
            "feather_lod_bind_group",
            &layout,
            &BindGroupEntries::sequential((
                views.clone(),
                params.clone(),
                feathers.buffer.as_entire_binding(),
                cards.buffer.as_entire_binding(),
                lod.buffer.as_entire_binding(),
                counters.as_entire_binding(),
                skins.current_buffer.as_entire_binding(),
            )),
        ));
    }
}

/// Classifies the cards of all birds for the current camera. The shadow views run this schedule too, hence the filter.
pub fn feather_lod(
    view: ViewQuery<(&ExtractedCamera, &ViewUniformOffset)>,
    birds: Res<LodBirds>,
    pipeline: Option<Res<LodPipeline>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (_, view_offset) = view.into_inner();
    let Some(pipeline) = pipeline.and_then(|p| cache.get_compute_pipeline(p.pipeline)) else {
        return;
    };
    // Bevy panics over a recorded number on a device that cannot time anything.
    let timed = WgpuFeatures::TIMESTAMP_QUERY | WgpuFeatures::PIPELINE_STATISTICS_QUERY;
    let reads_counters = ctx.render_device().features().intersects(timed);
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = ctx.command_encoder();
    let span = diagnostics.time_span(encoder, "feather_lod");
    encoder.clear_buffer(&birds.counters, 0, None);
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some("feather_lod"),
            timestamp_writes: None,
        });
        pass.set_pipeline(pipeline);
        for bird in &birds.birds {
            let Some(bind_group) = &bird.bind_group else {
                continue;
            };
            pass.set_bind_group(0, bind_group, &[view_offset.offset, bird.params_offset]);
            pass.dispatch_workgroups(bird.count.div_ceil(WORKGROUP), 1, 1);
        }
    }
    span.end(encoder);
    if !reads_counters {
        return;
    }
    for (i, name) in CARD_COUNTERS.iter().enumerate() {
        let at = 4 * i as u64;
        diagnostics.record_u32(
            encoder,
            &birds.counters.slice(at..at + 4),
            format!("feather_cards_{name}"),
        );
    }
}
