//! Pipeline, bind groups and dispatch of the LOD pass.

use super::{
    super::{
        lights::{VERTEX_LIGHTS, WorldLights},
        material::FeatherMaterial,
        wind::Motion,
    },
    CARD_COUNTERS, CardPatches,
    hide::{COUNTER_BYTES, GRID, GRID_BYTES, MEASURED, Meshes, NOTHING, VertexPlaces},
    lift::{LiftBuffers, LiftPipeline},
    lists::{CardLists, CardOrder, ListPipelines, ListedBird},
    skin::{Skin, SkinBuffers, SkinParams, SkinPipelines, SkinQuery},
};
use crate::{
    groom::PlumageCards,
    shaders::{FEATHER_HIDE, FEATHER_LOD},
};
use bevy::{
    core_pipeline::prepass::DepthPrepass,
    pbr::{MeshMaterial3d, SkinUniforms},
    prelude::*,
    render::{
        Extract,
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        globals::GlobalsBuffer,
        mesh::{RenderMesh, allocator::MeshAllocator},
        render_asset::RenderAssets,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        settings::WgpuFeatures,
        storage::{GpuShaderBuffer, ShaderBuffer},
        sync_world::MainEntity,
        view::{
            ExtractedView, RenderVisibleEntities, ViewUniform, ViewUniformOffset, ViewUniforms,
        },
    },
};

/// Threads of a workgroup.
pub const WORKGROUP: u32 = 64;

/// One bird, as the pass sees it.
pub struct LodBird {
    entity: MainEntity,
    cards: AssetId<ShaderBuffer>,
    lod: AssetId<ShaderBuffer>,
    feathers: AssetId<ShaderBuffer>,
    patches: AssetId<ShaderBuffer>,
    /// Order of its triangles, if they are listed class by class.
    listed: Option<CardOrder>,
    mesh: AssetId<Mesh>,
    /// Heights of the worn pose and what may hide cards, where hidden ones are to be found.
    still: Option<(Vec4, Skin)>,
    order_window: f32,
    count: u32,
    threshold: f32,
    light_budget: f32,
    world_from_local: Mat4,
    bind_group: Option<BindGroup>,
    params_offset: u32,
    hider: Option<Hider>,
    /// What the wind needs to know of it, where the air moves.
    blown: Option<AssetId<ShaderBuffer>>,
    lift_group: Option<BindGroup>,
}

/// The skin of a bird, ready to be drawn into its grid.
struct Hider {
    skin: Skin,
    params: SkinParams,
    params_offset: u32,
    bind_group: Option<BindGroup>,
}

/// All birds of the frame and the buffers they share.
#[derive(Resource)]
pub struct LodBirds {
    birds: Vec<LodBird>,
    /// See [`WorldLights::rows`].
    lights: [Vec4; VERTEX_LIGHTS],
    params: DynamicUniformBuffer<LodParams>,
    skin_params: DynamicUniformBuffer<SkinParams>,
    /// Counters of the classes and bounds, then depths of the bird at hand where a skin may hide its cards.
    grid: Buffer,
    /// What is kept of the cards and of the skin of the bird at hand.
    measured: Buffer,
}

/// Room for so many vec4s.
fn measured_buffer(device: &RenderDevice, rows: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("feather_measured"),
        size: 16 * rows.max(1),
        usage: BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

/// Counters, bounds and texels.
fn grid_buffer(device: &RenderDevice, bytes: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("feather_grid"),
        size: bytes,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

impl LodBirds {
    /// Birds in moving air: their bind group, its offset, number of cards.
    pub fn blown(&self) -> impl Iterator<Item = (&BindGroup, u32, u32)> {
        self.birds.iter().filter_map(|bird| {
            let group = bird.lift_group.as_ref()?;
            Some((group, bird.params_offset, bird.count))
        })
    }
}

impl FromWorld for LodBirds {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>();
        let grid = grid_buffer(device, COUNTER_BYTES);
        let measured = measured_buffer(device, 0);
        Self {
            birds: Vec::new(),
            lights: default(),
            params: DynamicUniformBuffer::default(),
            skin_params: DynamicUniformBuffer::default(),
            grid,
            measured,
        }
    }
}

/// Parameters of one bird.
#[derive(Clone, Copy, ShaderType)]
pub struct LodParams {
    world_from_local: Mat4,
    worn: Vec4,
    first_light: Vec4,
    second_light: Vec4,
    card_count: u32,
    /// First joint matrix, or [`NOTHING`] without a skin.
    skin_index: u32,
    threshold: f32,
    light_budget: f32,
    order_window: f32,
    hides: u32,
    /// See [`VertexPlaces`].
    first_word: u32,
    stride: u32,
    normal: u32,
    joints: u32,
    weights: u32,
    raised: u32,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(in crate::render) fn params_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(LodParams, "card/feather_lod_bindings.wgsl", "LodParams", {
        world_from_local, worn, first_light, second_light, card_count, skin_index, threshold, light_budget, order_window, hides,
        first_word, stride, normal, joints, weights, raised,
    })
}

/// The compute pipelines and their layout.
#[derive(Resource)]
pub struct LodPipeline {
    layout: BindGroupLayoutDescriptor,
    classify: CachedComputePipelineId,
    clear: CachedComputePipelineId,
    hide: CachedComputePipelineId,
    skin: SkinPipelines,
    /// Wind.
    pub lift: LiftPipeline,
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
                storage_buffer_read_only_sized(false, None),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
            ),
        ),
    );
    let queue = |shader: &'static str, entry: &'static str| {
        cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some(format!("feather_{entry}").into()),
            layout: vec![layout.clone()],
            shader: asset_server.load(shader),
            entry_point: Some(entry.into()),
            ..default()
        })
    };
    commands.insert_resource(LodPipeline {
        classify: queue(FEATHER_LOD, "classify"),
        clear: queue(FEATHER_HIDE, "clear"),
        hide: queue(FEATHER_HIDE, "hide"),
        skin: SkinPipelines::new(&asset_server, &cache),
        lift: LiftPipeline::new(&asset_server, &cache),
        layout,
    });
}

pub fn extract_birds(
    mut birds: ResMut<LodBirds>,
    query: Extract<
        Query<(
            Entity,
            &PlumageCards,
            &MeshMaterial3d<FeatherMaterial>,
            (&Mesh3d, &CardPatches, Option<&Motion>),
            &GlobalTransform,
            &ViewVisibility,
            Option<&ChildOf>,
        )>,
    >,
    skins: Extract<SkinQuery>,
    skin_materials: Extract<Res<Assets<StandardMaterial>>>,
    materials: Extract<Res<Assets<FeatherMaterial>>>,
    lights: Extract<Res<WorldLights>>,
) {
    birds.birds.clear();
    birds.lights = lights.rows();
    for (entity, cards, material, (mesh, patches, motion), transform, visible, of) in &query {
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
            patches: patches.patches.id(),
            listed: patches.order.filter(|_| material.splits()),
            mesh: mesh.id(),
            still: motion
                .filter(|_| material.settings.cull_hidden)
                .and_then(Motion::still)
                .zip(Skin::below(of, &skins, &skin_materials)),
            order_window: material.settings.order_window.clamp(0.0, 0.5),
            count: cards.cards.len() as u32,
            threshold: material.settings.threshold(),
            light_budget: if lights.are_followed() {
                material.light_budget()
            } else {
                0.0
            },
            world_from_local: transform.to_matrix(),
            bind_group: None,
            params_offset: 0,
            hider: None,
            blown: motion
                .filter(|motion| motion.lifts())
                .map(|_| material.motion.id()),
            lift_group: None,
        });
    }
}

pub fn prepare_lod_bind_groups(
    mut birds: ResMut<LodBirds>,
    pipeline: Option<Res<LodPipeline>>,
    cache: Res<PipelineCache>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    skins: Option<Res<SkinUniforms>>,
    (views, globals): (Res<ViewUniforms>, Res<GlobalsBuffer>),
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    meshes: Res<RenderAssets<RenderMesh>>,
    allocator: Res<MeshAllocator>,
    (mut lists, list_pipelines): (ResMut<CardLists>, Option<Res<ListPipelines>>),
    cameras: Query<Entity, (With<ExtractedCamera>, With<ExtractedView>)>,
) {
    let LodBirds {
        birds,
        lights: [first_light, second_light],
        params,
        skin_params,
        grid,
        measured,
    } = birds.as_mut();
    let (Some(pipeline), Some(skins), Some(views)) = (pipeline, skins, views.uniforms.binding())
    else {
        return;
    };
    let meshes = Meshes {
        meshes: &meshes,
        allocator: &allocator,
        device: &device,
    };
    let find = |bird: &LodBird| {
        let (heights, skin) = bird.still?;
        let first = MEASURED as u32 * bird.count;
        let buffers = SkinBuffers::find(&skin, &meshes, &skins, first)?;
        Some((heights, skin, meshes.vertices(bird.mesh)?, buffers))
    };
    if let Some(pipelines) = list_pipelines {
        let listed = birds.iter().filter_map(|bird| {
            Some(ListedBird {
                order: bird.listed?,
                entity: bird.entity,
                mesh: bird.mesh,
                cards: bird.count,
                patches: &buffers.get(bird.patches)?.buffer,
                lod: &buffers.get(bird.lod)?.buffer,
            })
        });
        lists.prepare(listed, cameras.iter(), &pipelines, &meshes, &cache, &queue);
    }
    params.clear();
    skin_params.clear();
    let mut rows = 0;
    for bird in birds.iter_mut() {
        let found = find(bird);
        let places = found.as_ref().map(|(_, _, (places, _), _)| *places);
        let places = places.unwrap_or(VertexPlaces::NONE);
        let worn = found.as_ref().map(|(heights, ..)| *heights);
        bird.hider = found.map(|(_, skin, _, buffers)| {
            let vertices = u64::from(buffers.params.vertex_count);
            rows = rows.max(MEASURED * u64::from(bird.count) + vertices);
            Hider {
                skin,
                params: buffers.params,
                params_offset: skin_params.push(&buffers.params),
                bind_group: None,
            }
        });
        bird.params_offset = params.push(&LodParams {
            world_from_local: bird.world_from_local,
            worn: worn.unwrap_or_default(),
            first_light: *first_light,
            second_light: *second_light,
            card_count: bird.count,
            skin_index: skins.skin_index(bird.entity).unwrap_or(NOTHING),
            threshold: bird.threshold,
            light_budget: bird.light_budget,
            order_window: bird.order_window,
            hides: u32::from(bird.hider.is_some()),
            first_word: places.first_word,
            stride: places.stride,
            normal: places.normal,
            joints: places.joints,
            weights: places.weights,
            raised: places.raised,
        });
    }
    if measured.size() < 16 * rows {
        *measured = measured_buffer(&device, rows);
    }
    // Texels are there from the first skin on that may hide anything.
    if rows > 0 && grid.size() < GRID_BYTES {
        *grid = grid_buffer(&device, GRID_BYTES);
    }
    params.write_buffer(&device, &queue);
    skin_params.write_buffer(&device, &queue);
    let skin_params = skin_params.binding();
    let Some(params) = params.binding() else {
        return;
    };
    let layout = cache.get_bind_group_layout(&pipeline.layout);
    for bird in birds.iter_mut() {
        let (Some(feathers), Some(cards), Some(lod), Some(patches)) = (
            buffers.get(bird.feathers),
            buffers.get(bird.cards),
            buffers.get(bird.lod),
            buffers.get(bird.patches),
        ) else {
            continue;
        };
        let mut vertices = patches.buffer.as_entire_binding();
        if let (Some((_, _, (_, cards), skin)), Some(hider), Some(skin_params)) =
            (find(bird), &mut bird.hider, &skin_params)
        {
            vertices = cards.into();
            hider.bind_group = Some(pipeline.skin.bind(
                &meshes,
                &cache,
                skin,
                [views.clone(), skin_params.clone()],
                [grid, &skins.current_buffer, measured],
            ));
        }
        if let (Some(motion), Some(globals)) = (
            bird.blown.and_then(|motion| buffers.get(motion)),
            globals.buffer.binding(),
        ) {
            let bound = LiftBuffers {
                params: params.clone(),
                cards: &cards.buffer,
                lod: &lod.buffer,
                joints: &skins.current_buffer,
                motion: &motion.buffer,
                globals,
            };
            bird.lift_group = Some(pipeline.lift.bind(&device, &cache, bound));
        }
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
                grid.as_entire_binding(),
                skins.current_buffer.as_entire_binding(),
                patches.buffer.as_entire_binding(),
                vertices,
                measured.as_entire_binding(),
            )),
        ));
    }
}

/// Classifies the cards of all birds for the current camera. The shadow views run this schedule too, hence the filter.
pub fn feather_lod(
    view: ViewQuery<(
        &ExtractedCamera,
        &ExtractedView,
        &ViewUniformOffset,
        &RenderVisibleEntities,
    )>,
    birds: Res<LodBirds>,
    pipeline: Option<Res<LodPipeline>>,
    lists: Res<CardLists>,
    list_pipelines: Option<Res<ListPipelines>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (_, view, view_offset, visible) = view.into_inner();
    let found = pipeline.and_then(|p| {
        let find = |id| cache.get_compute_pipeline(id);
        let own = [find(p.classify)?, find(p.clear)?, find(p.hide)?];
        Some((own, [find(p.skin.project)?, find(p.skin.draw)?]))
    });
    let Some(([classify, clear, hide], [project, draw])) = found else {
        return;
    };
    // Bevy panics over a recorded number on a device that cannot time anything.
    let timed = WgpuFeatures::TIMESTAMP_QUERY | WgpuFeatures::PIPELINE_STATISTICS_QUERY;
    let reads_counters = ctx.render_device().features().intersects(timed);
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = ctx.command_encoder();
    let span = diagnostics.time_span(encoder, "feather_lod");
    encoder.clear_buffer(&birds.grid, 0, Some(4 * CARD_COUNTERS.len() as u64));
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some("feather_lod"),
            timestamp_writes: None,
        });
        for bird in &birds.birds {
            let Some(bind_group) = &bird.bind_group else {
                continue;
            };
            let offsets = [view_offset.offset, bird.params_offset];
            let mut run = |pipeline, group: &BindGroup, offsets: &[u32], threads: u32| {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, group, offsets);
                pass.dispatch_workgroups(threads.div_ceil(WORKGROUP), 1, 1);
            };
            if bird.hider.is_some() {
                run(clear, bind_group, &offsets, (GRID * GRID) as u32);
            }
            run(classify, bind_group, &offsets, bird.count);
            if let Some(hider) = &bird.hider {
                // A skin that this camera does not see hides nothing; of a mirrored one other faces show.
                if let Some(group) = &hider.bind_group
                    && !view.invert_culling
                    && hider.skin.is_drawn(visible)
                {
                    let offsets = [view_offset.offset, hider.params_offset];
                    run(project, group, &offsets, hider.params.vertex_count);
                    run(draw, group, &offsets, hider.params.index_count / 3);
                }
                run(hide, bind_group, &offsets, bird.count);
            }
            if let Some(pipelines) = &list_pipelines {
                lists.write(
                    bird.entity,
                    CardOrder::Falling,
                    pipelines,
                    &cache,
                    &mut pass,
                );
            }
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
            &birds.grid.slice(at..at + 4),
            format!("feather_cards_{name}"),
        );
    }
}

/// Turns the lists round behind the prepass of depth: it leaves the nearest whatever the order, and is cheapest where what hides others
/// comes first; in color what should be seen comes last (docs/bevy_view.md#layering).
pub fn raise_lists(
    _view: ViewQuery<&ExtractedCamera, With<DepthPrepass>>,
    birds: Res<LodBirds>,
    lists: Res<CardLists>,
    pipelines: Option<Res<ListPipelines>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let Some(pipelines) = pipelines else {
        return;
    };
    let encoder = ctx.command_encoder();
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("feather_lists"),
        timestamp_writes: None,
    });
    for bird in &birds.birds {
        if bird.order_window > 0.0 {
            lists.write(
                bird.entity,
                CardOrder::Rising,
                &pipelines,
                &cache,
                &mut pass,
            );
        }
    }
}
