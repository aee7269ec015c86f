//! Lists of the triangles of each class (docs/book/lod.md#lists): written by the LOD pass for every camera, drawn by
//! [`super::super::listed`].

use super::{super::order, hide::Meshes};
use crate::{groom::CardGeometry, shaders::FEATHER_LISTS};
use bevy::{
    asset::AssetServer,
    ecs::entity::EntityHashMap,
    mesh::VertexAttributeValues,
    platform::collections::HashMap,
    prelude::*,
    render::{
        mesh::RenderMeshBufferInfo,
        render_resource::{
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
            *,
        },
        renderer::{RenderDevice, RenderQueue},
        settings::WgpuFeatures,
        sync_world::{MainEntity, MainEntityHashMap},
    },
};

/// Lists of a bird: RESOLVED, FAR, MEAN, LIT.
const LISTS: u32 = 4;
/// Passes of a camera that draw from them: depth, color.
const PASSES: u32 = 2;
/// Bytes of an indirect draw.
const DRAW_BYTES: u64 = 20;
/// Where in it its last two words are, which are known where it is recorded: base vertex and first instance.
const RECORDED: u64 = 12;
/// Bytes behind the lists for each card: offsets of index buffers are not heeded by every driver's indirect draws.
const HEAD_BYTES: u64 = 8;
/// A card that fades between two classes is in both.
const MOST_LISTS: u64 = 2;
/// Threads of the workgroup that arranges the lists.
const ARRANGING: u32 = 256;
/// Bytes that they share: two sums of four words for each.
const ARRANGING_BYTES: u32 = 32 * ARRANGING;
/// Threads of one that fills them.
const FILLING: u32 = 64;

/// Bytes that the lists of a bird take on the GPU.
pub fn list_bytes(cards: usize, mesh: &Mesh) -> u64 {
    let indices = mesh.indices().map_or(0, |indices| {
        let size = IndexFormat::from(indices).byte_size();
        (indices.len() * size) as u64
    });
    HEAD_BYTES * cards as u64 + MOST_LISTS * indices
}

/// Where the cards are in their mesh.
pub struct Patches {
    /// Four words each: by card its first vertex and their number; by place among the triangles which card is there, and its first index.
    pub words: Vec<u8>,
    /// Whether the latter are known, and in which order they are.
    pub order: Option<CardOrder>,
}

/// In which order cards come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardOrder {
    /// From the highest layer to the lowest: what hides others comes first.
    Falling,
    /// From the lowest layer to the highest: what should be seen comes last.
    Rising,
}

/// Finds the cards in their mesh.
pub fn pack_patches(geometry: &[CardGeometry], mesh: Option<&Mesh>) -> Patches {
    let places = mesh.and_then(|mesh| places(geometry.len(), mesh));
    let place = |at: usize| {
        let places = places.as_deref();
        places.map_or([0; 2], |places| places[at])
    };
    let words = geometry.iter().enumerate().flat_map(|(at, card)| {
        let [number, first] = place(at);
        [card.first_vertex, card.vertex_count, number, first]
    });
    let order = if mesh.and_then(order::rises).unwrap_or(false) {
        CardOrder::Rising
    } else {
        CardOrder::Falling
    };
    Patches {
        words: words.flat_map(u32::to_le_bytes).collect(),
        order: places.is_some().then_some(order),
    }
}

/// Card and first index of each place; none if a card has no triangles, lies in several places, or has an odd number of indices.
fn places(cards: usize, mesh: &Mesh) -> Option<Vec<[u32; 2]>> {
    let Some(VertexAttributeValues::Float32x2(ids)) = mesh.attribute(Mesh::ATTRIBUTE_UV_1) else {
        return None;
    };
    let indices = mesh.indices()?;
    let mut found: Vec<[u32; 2]> = Vec::new();
    for (at, vertex) in indices.iter().enumerate().step_by(3) {
        let card = ids.get(vertex)?[0].round() as u32;
        if found.last().is_none_or(|[last, _]| *last != card) {
            found.push([card, at as u32]);
        }
    }
    let mut seen = vec![false; cards];
    for [card, first] in &found {
        let seen = seen.get_mut(*card as usize)?;
        if *seen || first % 2 > 0 {
            return None;
        }
        *seen = true;
    }
    (found.len() == cards && indices.len() % 2 == 0).then_some(found)
}

/// Parameters of one bird's lists.
#[derive(Clone, Copy, ShaderType)]
struct ListParams {
    card_count: u32,
    index_count: u32,
    first_word: u32,
    short_indices: u32,
    turned: u32,
    backs_last: u32,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(in crate::render) fn list_params_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(ListParams, "card/feather_lists.wgsl", "ListParams", {
        card_count, index_count, first_word, short_indices, turned, backs_last,
    })
}

/// What the lists of one bird are kept in.
struct BirdLists {
    lists: Buffer,
    draws: Buffer,
    mesh: AssetId<Mesh>,
    format: IndexFormat,
    cards: u32,
    indices: u32,
    /// Of falling, then of rising cards.
    params_offsets: [u32; 2],
    /// None where this frame has no lists.
    bind_group: Option<BindGroup>,
}

impl BirdLists {
    /// Bytes of the lists alone.
    fn index_bytes(&self) -> u64 {
        MOST_LISTS * self.format.byte_size() as u64 * u64::from(self.indices)
    }
}

/// A bird whose lists are wanted.
pub struct ListedBird<'a> {
    /// Its card mesh.
    pub entity: MainEntity,
    /// That mesh.
    pub mesh: AssetId<Mesh>,
    /// Number of cards.
    pub cards: u32,
    /// See [`Patches::words`].
    pub patches: &'a Buffer,
    /// See [`Patches::order`].
    pub order: CardOrder,
    /// Classes.
    pub lod: &'a Buffer,
}

/// What draws a part of a bird from its lists.
pub struct ListedDraw<'a> {
    /// Bound as indices.
    pub indices: BufferSlice<'a>,
    /// Their format.
    pub format: IndexFormat,
    /// Mesh whose vertices they are of.
    pub mesh: AssetId<Mesh>,
    /// Indirect draws.
    pub draws: &'a Buffer,
    /// The draw among them.
    pub at: u64,
}

/// The lists of all birds.
#[derive(Resource, Default)]
pub struct CardLists {
    birds: MainEntityHashMap<BirdLists>,
    /// Numbers of the cameras.
    views: EntityHashMap<u32>,
    /// Of each drawn entity: the bird, and which of its lists it draws; none: nothing in this frame.
    parts: MainEntityHashMap<Option<(MainEntity, u32)>>,
    params: DynamicUniformBuffer<ListParams>,
}

/// The pipelines and their layout.
#[derive(Resource)]
pub struct ListPipelines {
    layout: BindGroupLayoutDescriptor,
    arrange: CachedComputePipelineId,
    fill: CachedComputePipelineId,
}

/// Asks for the pipelines where the device can draw lists.
pub fn init_list_pipelines(
    mut commands: Commands,
    server: Res<AssetServer>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
) {
    let limits = device.limits();
    let threads = limits
        .max_compute_invocations_per_workgroup
        .min(limits.max_compute_workgroup_size_x);
    if !device
        .features()
        .contains(WgpuFeatures::INDIRECT_FIRST_INSTANCE)
        || threads < ARRANGING
        || limits.max_compute_workgroup_storage_size < ARRANGING_BYTES
    {
        return;
    }
    let layout = BindGroupLayoutDescriptor::new(
        "feather_lists_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                uniform_buffer::<ListParams>(true),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
                storage_buffer_sized(false, None),
            ),
        ),
    );
    let queue = |entry: &'static str| {
        cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some(format!("feather_{entry}").into()),
            layout: vec![layout.clone()],
            shader: server.load(FEATHER_LISTS),
            entry_point: Some(entry.into()),
            ..default()
        })
    };
    commands.insert_resource(ListPipelines {
        arrange: queue("arrange"),
        fill: queue("fill"),
        layout,
    });
}

fn buffer(device: &RenderDevice, label: &'static str, size: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

impl CardLists {
    /// Forgets what is drawn; it is said anew every frame.
    pub fn clear_parts(&mut self) {
        self.parts.clear();
    }

    /// `part` draws a list of a bird.
    pub fn add_part(&mut self, part: MainEntity, bird: MainEntity, list: u32) {
        self.parts.insert(part, Some((bird, list)));
    }

    /// `part` draws nothing in this frame.
    pub fn add_idle(&mut self, part: MainEntity) {
        self.parts.insert(part, None);
    }

    /// Whether `part` draws nothing in this frame.
    pub fn is_idle(&self, part: MainEntity) -> bool {
        matches!(self.parts.get(&part), Some(None))
    }

    /// Makes room for the lists of `birds` in the passes of `cameras`.
    pub fn prepare<'a>(
        &mut self,
        birds: impl Iterator<Item = ListedBird<'a>>,
        cameras: impl Iterator<Item = Entity>,
        pipelines: &ListPipelines,
        meshes: &Meshes,
        cache: &PipelineCache,
        queue: &RenderQueue,
    ) {
        let device = meshes.device;
        self.views = cameras.zip(0..).collect();
        let draws = u64::from(LISTS * PASSES) * self.views.len() as u64 * DRAW_BYTES;
        let mut old: HashMap<_, _> = self.birds.drain().collect();
        let mut sources = Vec::new();
        self.params.clear();
        for bird in birds {
            let Some(mesh) = meshes.meshes.get(bird.mesh) else {
                continue;
            };
            let RenderMeshBufferInfo::Indexed {
                count,
                index_format: format,
            } = mesh.buffer_info
            else {
                continue;
            };
            let size = format.byte_size() as u64;
            let slice = meshes.allocator.mesh_index_slice(&bird.mesh);
            let Some((source, first_word)) =
                slice.and_then(|slice| meshes.bind(&slice, u64::from(slice.range.start), size))
            else {
                continue;
            };
            let known = old.remove(&bird.entity).filter(|lists| {
                (lists.format, lists.cards, lists.indices) == (format, bird.cards, count)
            });
            let (lists, old_draws) = known.map_or_else(
                || {
                    let bytes =
                        HEAD_BYTES * u64::from(bird.cards) + MOST_LISTS * size * u64::from(count);
                    let bytes = bytes.next_multiple_of(4);
                    (
                        buffer(device, "feather_lists", bytes, BufferUsages::INDEX),
                        None,
                    )
                },
                |known| (known.lists, Some(known.draws)),
            );
            let draws = old_draws
                .filter(|known| known.size() == draws)
                .unwrap_or_else(|| {
                    let usage = BufferUsages::INDIRECT | BufferUsages::COPY_DST;
                    buffer(device, "feather_list_draws", draws.max(DRAW_BYTES), usage)
                });
            let params_offsets = [CardOrder::Falling, CardOrder::Rising].map(|wanted| {
                self.params.push(&ListParams {
                    card_count: bird.cards,
                    index_count: count,
                    first_word,
                    short_indices: u32::from(format == IndexFormat::Uint16),
                    turned: u32::from(wanted != bird.order),
                    backs_last: u32::from(wanted == CardOrder::Falling),
                })
            });
            sources.push((bird.entity, bird.patches, bird.lod, source));
            self.birds.insert(
                bird.entity,
                BirdLists {
                    lists,
                    draws,
                    mesh: bird.mesh,
                    format,
                    cards: bird.cards,
                    indices: count,
                    params_offsets,
                    bind_group: None,
                },
            );
        }
        self.params.write_buffer(device, queue);
        let Some(params) = self.params.binding() else {
            return;
        };
        let layout = cache.get_bind_group_layout(&pipelines.layout);
        for (entity, patches, lod, source) in sources {
            if let Some(bird) = self.birds.get_mut(&entity) {
                bird.bind_group = Some(device.create_bind_group(
                    "feather_lists_bind_group",
                    &layout,
                    &BindGroupEntries::sequential((
                        params.clone(),
                        patches.as_entire_binding(),
                        lod.as_entire_binding(),
                        BindingResource::from(source),
                        bird.lists.as_entire_binding(),
                        bird.draws.as_entire_binding(),
                    )),
                ));
            }
        }
    }

    /// Writes the lists of a bird, whose cards have their classes, in an order.
    pub fn write(
        &self,
        bird: MainEntity,
        order: CardOrder,
        pipelines: &ListPipelines,
        cache: &PipelineCache,
        pass: &mut ComputePass,
    ) {
        let find = |id| cache.get_compute_pipeline(id);
        let Some((lists, group)) = self
            .birds
            .get(&bird)
            .and_then(|lists| Some((lists, lists.bind_group.as_ref()?)))
        else {
            return;
        };
        let (Some(arrange), Some(fill)) = (find(pipelines.arrange), find(pipelines.fill)) else {
            return;
        };
        pass.set_bind_group(0, group, &[lists.params_offsets[order as usize]]);
        pass.set_pipeline(arrange);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(fill);
        pass.dispatch_workgroups(lists.cards.div_ceil(FILLING), 1, 1);
    }

    /// How `part` is drawn in a pass (0: depth, 1: color) of a camera; none if it is not drawn from a list.
    pub fn draw(&self, part: MainEntity, camera: Entity, pass: u32) -> Option<ListedDraw<'_>> {
        let (bird, list) = self.parts.get(&part).copied().flatten()?;
        let bird = self.birds.get(&bird)?;
        bird.bind_group.as_ref()?;
        let view = self.views.get(&camera)?;
        let draw = (view * PASSES + pass) * LISTS + list;
        Some(ListedDraw {
            indices: bird.lists.slice(..bird.index_bytes()),
            format: bird.format,
            mesh: bird.mesh,
            draws: &bird.draws,
            at: DRAW_BYTES * u64::from(draw),
        })
    }
}

impl ListedDraw<'_> {
    /// Writes what is known where the draw is recorded. The queue writes before the frame's passes run, and every pass of every camera has a
    /// draw of its own.
    pub fn record(&self, queue: &RenderQueue, base_vertex: u32, first_instance: u32) {
        let words = [base_vertex, first_instance].map(u32::to_le_bytes);
        queue.write_buffer(self.draws, self.at + RECORDED, words.as_flattened());
    }
}
