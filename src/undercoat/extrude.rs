//! The extrusion: once a frame a compute pass skins the nodes of every shell that is drawn and raises their tops.

use super::spawn::UndercoatShell;
use crate::shaders::UNDERCOAT_EXTRUDE;
use bevy::{
    core_pipeline::schedule::camera_driver,
    pbr::SkinUniforms,
    prelude::*,
    render::{
        Extract, GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        diagnostic::RecordDiagnostics,
        render_asset::RenderAssets,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice, RenderGraph, RenderQueue},
        storage::{GpuShaderBuffer, ShaderBuffer},
        sync_world::MainEntity,
    },
};

/// Threads of a workgroup.
const WORKGROUP: u32 = 64;
/// Marks a skin without joints.
const NO_SKIN: u32 = u32::MAX;

pub(super) struct ExtrudePlugin;

impl Plugin for ExtrudePlugin {
    fn build(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .init_gpu_resource::<Shells>()
            .add_systems(RenderStartup, init_pipeline)
            .add_systems(ExtractSchedule, extract_shells)
            .add_systems(
                Render,
                prepare_bind_groups.in_set(RenderSystems::PrepareBindGroups),
            )
            .add_systems(RenderGraph, undercoat_extrude.before(camera_driver));
    }
}

/// One shell as the pass sees it.
struct Shell {
    skin: MainEntity,
    shell: AssetId<ShaderBuffer>,
    rest: AssetId<ShaderBuffer>,
    nodes: u32,
    world_from_local: Mat4,
    bind_group: Option<BindGroup>,
    params_offset: u32,
}

/// The shells of the frame.
#[derive(Resource, Default)]
struct Shells {
    shells: Vec<Shell>,
    params: DynamicUniformBuffer<ExtrudeParams>,
}

#[derive(Clone, Copy, ShaderType)]
struct ExtrudeParams {
    world_from_local: Mat4,
    node_count: u32,
    /// First joint matrix, or `u32::MAX` without a skin.
    skin_index: u32,
    padding_a: u32,
    padding_b: u32,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(super) fn params_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(ExtrudeParams, "undercoat/undercoat_extrude.wgsl", "ExtrudeParams", {
        world_from_local, node_count, skin_index, padding_a, padding_b,
    })
}

#[derive(Resource)]
struct ExtrudePipeline {
    layout: BindGroupLayoutDescriptor,
    pipeline: CachedComputePipelineId,
}

fn init_pipeline(mut commands: Commands, server: Res<AssetServer>, cache: Res<PipelineCache>) {
    let layout = BindGroupLayoutDescriptor::new(
        "undercoat_extrude_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                uniform_buffer::<ExtrudeParams>(true),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
                storage_buffer_read_only_sized(false, None),
            ),
        ),
    );
    let pipeline = cache.queue_compute_pipeline(ComputePipelineDescriptor {
        label: Some("undercoat_extrude".into()),
        layout: vec![layout.clone()],
        shader: server.load(UNDERCOAT_EXTRUDE),
        entry_point: Some("extrude".into()),
        ..default()
    });
    commands.insert_resource(ExtrudePipeline { layout, pipeline });
}

fn extract_shells(
    mut shells: ResMut<Shells>,
    query: Extract<Query<&UndercoatShell>>,
    skins: Extract<Query<&GlobalTransform>>,
    drawn: Extract<Query<&ViewVisibility>>,
) {
    shells.shells.clear();
    for shell in &query {
        let seen = |part: &Option<Entity>| {
            part.is_some_and(|part| drawn.get(part).is_ok_and(|view| view.get()))
        };
        // What is not drawn is not skinned either.
        if !seen(&shell.coat) && !seen(&shell.strands) {
            continue;
        }
        let Ok(transform) = skins.get(shell.skin) else {
            continue;
        };
        shells.shells.push(Shell {
            skin: shell.skin.into(),
            shell: shell.buffer.id(),
            rest: shell.rest.id(),
            nodes: shell.nodes,
            world_from_local: transform.to_matrix(),
            bind_group: None,
            params_offset: 0,
        });
    }
}

fn prepare_bind_groups(
    mut shells: ResMut<Shells>,
    pipeline: Option<Res<ExtrudePipeline>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    skins: Option<Res<SkinUniforms>>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
) {
    let Shells { shells, params } = shells.as_mut();
    let (Some(pipeline), Some(skins)) = (pipeline, skins) else {
        return;
    };
    params.clear();
    for shell in shells.iter_mut() {
        shell.params_offset = params.push(&ExtrudeParams {
            world_from_local: shell.world_from_local,
            node_count: shell.nodes,
            skin_index: skins.skin_index(shell.skin).unwrap_or(NO_SKIN),
            padding_a: 0,
            padding_b: 0,
        });
    }
    params.write_buffer(&device, &queue);
    let Some(params) = params.binding() else {
        return;
    };
    let layout = cache.get_bind_group_layout(&pipeline.layout);
    for shell in shells.iter_mut() {
        let (Some(rest), Some(nodes)) = (buffers.get(shell.rest), buffers.get(shell.shell)) else {
            continue;
        };
        // The skins' buffer swaps and grows every frame, so this group cannot be kept.
        shell.bind_group = Some(device.create_bind_group(
            "undercoat_extrude_bind_group",
            &layout,
            &BindGroupEntries::sequential((
                params.clone(),
                rest.buffer.as_entire_binding(),
                nodes.buffer.as_entire_binding(),
                skins.current_buffer.as_entire_binding(),
            )),
        ));
    }
}

/// Extrudes all shells that a camera may see, once a frame.
fn undercoat_extrude(
    shells: Res<Shells>,
    pipeline: Option<Res<ExtrudePipeline>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let Some(pipeline) = pipeline.and_then(|p| cache.get_compute_pipeline(p.pipeline)) else {
        return;
    };
    if shells.shells.is_empty() {
        return;
    }
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = ctx.command_encoder();
    let span = diagnostics.time_span(encoder, "undercoat_extrude");
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some("undercoat_extrude"),
            timestamp_writes: None,
        });
        pass.set_pipeline(pipeline);
        for shell in &shells.shells {
            let Some(bind_group) = &shell.bind_group else {
                continue;
            };
            pass.set_bind_group(0, bind_group, &[shell.params_offset]);
            pass.dispatch_workgroups(shell.nodes.div_ceil(WORKGROUP), 1, 1);
        }
    }
    span.end(encoder);
}
