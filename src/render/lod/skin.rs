//! The skin below the cards of a bird, which hides those on its far side: a grid of its depths, drawn by compute.

use super::hide::{Meshes, NOTHING};
use crate::shaders::FEATHER_SKIN;
use bevy::{
    asset::AssetServer,
    camera::visibility::VisibilityRange,
    mesh::morph::MeshMorphWeights,
    pbr::SkinUniforms,
    prelude::*,
    render::{
        mesh::RenderMeshBufferInfo,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        sync_world::MainEntity,
        view::{RenderVisibleEntities, ViewUniform},
    },
};

/// A skin that is opaque wherever a camera draws it.
#[derive(Clone, Copy, Debug)]
pub struct Skin {
    entity: MainEntity,
    mesh: AssetId<Mesh>,
    one_sided: bool,
    world_from_local: Mat4,
}

/// Meshes that may hide cards: they neither fade nor change their shape but by joints.
pub type SkinQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Mesh3d,
        &'static MeshMaterial3d<StandardMaterial>,
        &'static GlobalTransform,
    ),
    (Without<VisibilityRange>, Without<MeshMorphWeights>),
>;

impl Skin {
    /// The skin that a card mesh hangs on.
    pub fn below(
        cards: Option<&ChildOf>,
        skins: &SkinQuery,
        materials: &Assets<StandardMaterial>,
    ) -> Option<Self> {
        let (entity, mesh, material, transform) = skins.get(cards?.parent()).ok()?;
        let material = materials.get(material.id())?;
        let hides = material.alpha_mode == AlphaMode::Opaque
            && material.specular_transmission == 0.0
            && material.cull_mode != Some(Face::Front);
        hides.then(|| Self {
            entity: entity.into(),
            mesh: mesh.id(),
            one_sided: material.cull_mode == Some(Face::Back),
            world_from_local: transform.to_matrix(),
        })
    }

    /// Whether a camera draws it.
    pub fn is_drawn(&self, visible: &RenderVisibleEntities) -> bool {
        visible.get::<Mesh3d>().is_some_and(|class| {
            let mut drawn = class.entities_cpu_culling.iter();
            drawn.any(|(_, entity)| *entity == self.entity)
        })
    }
}

/// Parameters of one skin.
#[derive(Clone, Copy, ShaderType)]
pub struct SkinParams {
    world_from_local: Mat4,
    skin_index: u32,
    /// Vertices of the mesh.
    pub vertex_count: u32,
    /// Its indices.
    pub index_count: u32,
    first_word: u32,
    stride: u32,
    joints: u32,
    weights: u32,
    first_index: u32,
    short_indices: u32,
    one_sided: u32,
    first_measured: u32,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(in crate::render) fn skin_params_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(SkinParams, "card/feather_skin.wgsl", "SkinParams", {
        world_from_local, skin_index, vertex_count, index_count, first_word, stride, joints, weights, first_index, short_indices,
        one_sided, first_measured,
    })
}

/// The buffers of a skin's mesh, and its parameters.
pub struct SkinBuffers<'a> {
    vertices: BindingResource<'a>,
    indices: BindingResource<'a>,
    /// Parameters.
    pub params: SkinParams,
}

impl<'a> SkinBuffers<'a> {
    /// None where Bevy's buffers cannot be bound. `first_measured`: where its vertices go.
    pub fn find(
        skin: &Skin,
        meshes: &Meshes<'a>,
        joints: &SkinUniforms,
        first_measured: u32,
    ) -> Option<Self> {
        let mesh = meshes.meshes.get(skin.mesh)?;
        let (places, vertices) = meshes.vertices(skin.mesh)?;
        let RenderMeshBufferInfo::Indexed {
            count,
            index_format,
        } = mesh.buffer_info
        else {
            return None;
        };
        if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
            return None;
        }
        let short = index_format == IndexFormat::Uint16;
        let slice = meshes.allocator.mesh_index_slice(&skin.mesh)?;
        let first = u64::from(slice.range.start);
        // Whole words: an odd number of short indices before is counted from the word below.
        let odd = if short { first % 2 } else { 0 };
        let (indices, words) = meshes.bind(&slice, first - odd, index_format.byte_size() as u64)?;
        let first_index = words * if short { 2 } else { 1 } + odd as u32;
        let skinned = places.joints != NOTHING && places.weights != NOTHING;
        Some(Self {
            vertices: vertices.into(),
            indices: indices.into(),
            params: SkinParams {
                world_from_local: skin.world_from_local,
                skin_index: joints
                    .skin_index(skin.entity)
                    .filter(|_| skinned)
                    .unwrap_or(NOTHING),
                vertex_count: mesh.vertex_count,
                index_count: count,
                first_word: places.first_word,
                stride: places.stride,
                joints: places.joints,
                weights: places.weights,
                first_index,
                short_indices: u32::from(short),
                one_sided: u32::from(skin.one_sided),
                first_measured,
            },
        })
    }
}

/// The two pipelines and their layout.
pub struct SkinPipelines {
    layout: BindGroupLayoutDescriptor,
    /// One thread for each vertex.
    pub project: CachedComputePipelineId,
    /// One thread for each triangle.
    pub draw: CachedComputePipelineId,
}

impl SkinPipelines {
    /// Asks for them.
    pub fn new(server: &AssetServer, cache: &PipelineCache) -> Self {
        let layout = BindGroupLayoutDescriptor::new(
            "feather_skin_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::COMPUTE,
                (
                    uniform_buffer::<ViewUniform>(true),
                    uniform_buffer::<SkinParams>(true),
                    storage_buffer_sized(false, None),
                    storage_buffer_read_only_sized(false, None),
                    storage_buffer_read_only_sized(false, None),
                    storage_buffer_read_only_sized(false, None),
                    storage_buffer_sized(false, None),
                ),
            ),
        );
        let queue = |entry: &'static str| {
            cache.queue_compute_pipeline(ComputePipelineDescriptor {
                label: Some(format!("feather_skin_{entry}").into()),
                layout: vec![layout.clone()],
                shader: server.load(FEATHER_SKIN),
                entry_point: Some(entry.into()),
                ..default()
            })
        };
        Self {
            project: queue("project"),
            draw: queue("draw"),
            layout,
        }
    }

    /// Binds a skin.
    pub fn bind(
        &self,
        meshes: &Meshes,
        cache: &PipelineCache,
        skin: SkinBuffers,
        [views, params]: [BindingResource; 2],
        [grid, joints, measured]: [&Buffer; 3],
    ) -> BindGroup {
        meshes.device.create_bind_group(
            "feather_skin_bind_group",
            &cache.get_bind_group_layout(&self.layout),
            &BindGroupEntries::sequential((
                views,
                params,
                grid.as_entire_binding(),
                joints.as_entire_binding(),
                skin.vertices,
                skin.indices,
                measured.as_entire_binding(),
            )),
        )
    }
}
