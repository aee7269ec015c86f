//! Gives every groomed bird its [`FeatherMaterial`]: packs its feathers, uploads its cards; and keeps it up to date.

use super::{
    key::{FeatherTransparency, ThinLayers},
    lights::find_lights,
    lod::{CardPatches, GRID_BYTES, LOD_BYTES, MEASURED, list_bytes, pack_patches},
    material::{FeatherMaterial, FeatherSettings},
    pack::{TableCache, albedo_array, outline_array, pack_cards, pack_feathers, same_paint},
    stacks::StackWork,
    wind,
};
use crate::{
    anatomy::Feather,
    groom::{FeathersOf, PlumageCards, PlumageParts, PlumageSystems, find_worn},
    modified::modified,
};
use bevy::{
    asset::{AssetEventSystems, RenderAssetUsages},
    platform::collections::HashMap,
    prelude::*,
    render::{
        render_resource::{BufferUsages, IndexFormat},
        storage::ShaderBuffer,
    },
};

pub(super) struct PreparePlugin;

impl Plugin for PreparePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<FeatherSets>()
            .init_resource::<StackWork>()
            .init_resource::<PlumageMemory>()
            .init_resource::<PlumageWork>();
    }
}

pub(super) fn add_systems(app: &mut App) {
    app.add_systems(
        PostUpdate,
        (
            refresh_feathers,
            drop_unused,
            prepare_materials,
            apply_quality,
            measure_memory,
        )
            .chain()
            .in_set(PlumageSystems::PrepareMaterials)
            // What changes is drawn in this frame.
            .before(AssetEventSystems),
    )
    .add_systems(
        PostUpdate,
        (find_lights, wind::move_feathers)
            .chain()
            .in_set(PlumageSystems::MoveFeathers)
            .after(PlumageSystems::PrepareMaterials)
            .after(TransformSystems::Propagate)
            .after(find_worn),
    );
}

/// Quality of one bird's feathers; put it beside `Plumage`. Without it the defaults hold.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct FeatherQuality {
    /// Error budget, light between feathers, debug view.
    pub settings: FeatherSettings,
    /// Transparency.
    pub transparency: FeatherTransparency,
}

/// Bytes of GPU memory that the plugin holds, by kind.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlumageMemory {
    /// Feathers and fibre tables.
    pub feathers: u64,
    /// Albedo textures and maps of outlines.
    pub textures: u64,
    /// Card records and LOD classes.
    pub cards: u64,
    /// Card meshes: vertices and indices.
    pub meshes: u64,
}

impl PlumageMemory {
    /// All of it.
    pub fn total(&self) -> u64 {
        self.feathers + self.textures + self.cards + self.meshes
    }
}

/// What birds of the same feathers share.
struct FeatherSet {
    feathers: Handle<ShaderBuffer>,
    albedo: Handle<Image>,
    outlines: Handle<Image>,
    bytes: (u64, u64),
    /// See [`FeatherMaterial::plain`].
    plain: bool,
    /// The feathers as they were packed, and their tables.
    packed: Vec<Feather>,
    tables: TableCache,
}

/// Upload counters: how often the plugin has built and uploaded something.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlumageWork {
    /// Feather buffers uploaded.
    pub feather_buffers: u32,
    /// Albedo textures painted and uploaded.
    pub albedo_textures: u32,
    /// Materials made: cards uploaded, bind groups built.
    pub materials: u32,
}

/// Packed feathers by the list of feather assets.
#[derive(Resource, Default)]
struct FeatherSets(HashMap<Vec<AssetId<Feather>>, FeatherSet>);

/// Bytes of one bird's own buffers, cards and LOD; of what is kept while its cards are classified; and of its mesh, which equal birds
/// share.
#[derive(Component)]
struct CardBytes {
    cards: u64,
    measured: u64,
    mesh: (AssetId<Mesh>, u64),
}

/// Takes the changes of feathers over: into the buffer in place where only numbers have changed, else by packing anew.
fn refresh_feathers(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Feather>>,
    mut sets: ResMut<FeatherSets>,
    mut stacks: ResMut<StackWork>,
    mut work: ResMut<PlumageWork>,
    birds: Query<(Entity, &PlumageCards), With<MeshMaterial3d<FeatherMaterial>>>,
    feathers: Res<Assets<Feather>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
) {
    let modified = modified(&mut events);
    if modified.is_empty() {
        return;
    }
    sets.0.retain(|ids, set| {
        if !ids.iter().any(|id| modified.contains(id)) {
            return true;
        }
        if refresh_in_place(set, ids, &feathers, &mut stacks, &mut buffers) {
            work.feather_buffers += 1;
            return true;
        }
        for (entity, cards) in &birds {
            if feather_ids(cards) == *ids {
                commands
                    .entity(entity)
                    .remove::<MeshMaterial3d<FeatherMaterial>>();
            }
        }
        false
    });
}

/// Writes the feathers into the buffer that is there, if its size and the textures stay as they are.
fn refresh_in_place(
    set: &mut FeatherSet,
    ids: &[AssetId<Feather>],
    feathers: &Assets<Feather>,
    stacks: &mut StackWork,
    buffers: &mut Assets<ShaderBuffer>,
) -> bool {
    let Some(now) = ids
        .iter()
        .map(|id| feathers.get(*id))
        .collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    if !now.iter().zip(&set.packed).all(|(a, b)| same_paint(a, b)) {
        return false;
    }
    // Layers that are not computed yet are waited for.
    let Some(tables) = stacks.tables(&now) else {
        return false;
    };
    set.tables.stacks = tables;
    let data = pack_feathers(&now, &mut set.tables);
    // Other pipelines where fibres have become plain, or are so no longer, and where layers come and go.
    let now: Vec<Feather> = now.into_iter().cloned().collect();
    if data.len() as u64 != set.bytes.0
        || set.tables.is_plain() != set.plain
        || thin_layers(&now) != thin_layers(&set.packed)
    {
        return false;
    }
    let Some(mut buffer) = buffers.get_mut(&set.feathers) else {
        return false;
    };
    buffer.data = Some(data);
    set.packed = now;
    true
}

/// Forgets feathers that no bird has any more.
fn drop_unused(
    mut removed: RemovedComponents<PlumageCards>,
    birds: Query<&PlumageCards>,
    changed: Query<(), Changed<PlumageCards>>,
    mut sets: ResMut<FeatherSets>,
) {
    if removed.read().count() > 0 || !changed.is_empty() {
        sets.0
            .retain(|ids, _| birds.iter().any(|cards| feather_ids(cards) == *ids));
    }
}

fn feather_ids(cards: &PlumageCards) -> Vec<AssetId<Feather>> {
    cards.all_feathers().map(Handle::id).collect()
}

/// Makes the material of every card mesh that has none, or whose cards are others now.
fn prepare_materials(
    mut commands: Commands,
    server: Res<AssetServer>,
    (mut sets, mut stacks): (ResMut<FeatherSets>, ResMut<StackWork>),
    mut work: ResMut<PlumageWork>,
    bare: Query<
        (
            Entity,
            &PlumageCards,
            &Mesh3d,
            Option<&FeathersOf>,
            Option<&ChildOf>,
        ),
        Or<(
            Without<MeshMaterial3d<FeatherMaterial>>,
            Changed<PlumageCards>,
        )>,
    >,
    qualities: Query<&FeatherQuality>,
    skins: Query<&Mesh3d>,
    feathers: Res<Assets<Feather>>,
    meshes: Res<Assets<Mesh>>,
    images: ResMut<Assets<Image>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    let images = images.into_inner();
    for (entity, cards, mesh, of, skin) in &bare {
        if cards.cards.is_empty() {
            continue;
        }
        let key = feather_ids(cards);
        if !sets.0.contains_key(&key) {
            let Some(assets) = key
                .iter()
                .map(|id| feathers.get(*id))
                .collect::<Option<Vec<_>>>()
            else {
                continue;
            };
            // A picture that failed to load leaves the painted pattern; the loader has said so.
            let pending = |image: &Handle<Image>| {
                images.get(image).is_none() && !server.load_state(image).is_failed()
            };
            if assets
                .iter()
                .any(|feather| feather.image.as_ref().is_some_and(pending))
            {
                continue;
            }
            let Some(colors) = stacks.tables(&assets) else {
                continue;
            };
            let mut tables = TableCache::with_stacks(colors);
            let data = pack_feathers(&assets, &mut tables);
            let albedo = albedo_array(&assets, images);
            let outlines = outline_array(&assets);
            let texture_bytes = [&albedo, &outlines]
                .map(|image| image.data.as_ref().map_or(0, |data| data.len() as u64))
                .iter()
                .sum();
            work.feather_buffers += 1;
            work.albedo_textures += 1;
            let set = FeatherSet {
                bytes: (data.len() as u64, texture_bytes),
                feathers: buffers.add(upload(data, "feathers")),
                albedo: images.add(albedo),
                outlines: images.add(outlines),
                plain: tables.is_plain(),
                packed: assets.into_iter().cloned().collect(),
                tables,
            };
            sets.0.insert(key.clone(), set);
        }
        let Some(set) = sets.0.get(&key) else {
            continue;
        };
        let records = pack_cards(&cards.cards);
        let lod = vec![0u8; LOD_BYTES * cards.cards.len()];
        let own_mesh = meshes.get(mesh.id());
        let patches = pack_patches(&cards.geometry, own_mesh);
        let lists = own_mesh
            .filter(|_| patches.order.is_some())
            .map_or(0, |mesh| list_bytes(cards.cards.len(), mesh));
        let skin = skin.and_then(|skin| meshes.get(skins.get(skin.parent()).ok()?));
        let measured = skin.map_or(0, |skin| {
            16 * (MEASURED * cards.cards.len() as u64 + skin.count_vertices() as u64)
        });
        let bytes = CardBytes {
            cards: (records.len() + lod.len() + patches.words.len()) as u64 + lists,
            measured,
            mesh: (mesh.id(), own_mesh.map_or(0, mesh_bytes)),
        };
        work.materials += 1;
        let quality = qualities
            .get(FeathersOf::owner(of, entity))
            .copied()
            .unwrap_or_default();
        let material = FeatherMaterial {
            settings: quality.settings,
            transparency: quality.transparency,
            drawn: default(),
            under: default(),
            plain: set.plain,
            layers: thin_layers(&set.packed),
            feathers: set.feathers.clone(),
            cards: buffers.add(upload(records, "feather_cards")),
            lod: buffers.add(upload(lod, "feather_lod")),
            albedo: set.albedo.clone(),
            outlines: set.outlines.clone(),
            motion: buffers.add(wind::still_motion(cards)),
        };
        commands.entity(entity).insert((
            MeshMaterial3d(materials.add(material)),
            CardPatches {
                patches: buffers.add(upload(patches.words, "feather_patches")),
                order: patches.order,
            },
            bytes,
        ));
    }
}

/// Takes a changed quality over into the materials; the defaults where it was taken off.
fn apply_quality(
    changed: Query<(Entity, &FeatherQuality), Changed<FeatherQuality>>,
    mut removed: RemovedComponents<FeatherQuality>,
    qualities: Query<(), With<FeatherQuality>>,
    parts: Query<&PlumageParts>,
    mut handles: Query<&mut MeshMaterial3d<FeatherMaterial>, With<PlumageCards>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    let standard = FeatherQuality::default();
    // Taken off and put on again in one frame is a change.
    let removed = removed.read().filter(|owner| !qualities.contains(*owner));
    let removed = removed.map(|owner| (owner, &standard));
    for (owner, quality) in changed.iter().chain(removed) {
        let parts = parts.get(owner).map_or(&[][..], |parts| parts);
        for entity in parts.iter().chain([&owner]) {
            let Ok(mut handle) = handles.get_mut(*entity) else {
                continue;
            };
            let id = handle.id();
            let same = materials.get(id).is_some_and(|m| {
                m.settings == quality.settings && m.transparency == quality.transparency
            });
            if !same && let Some(mut material) = materials.get_mut(id) {
                material.settings = quality.settings;
                material.transparency = quality.transparency;
                // Those that draw the same cards take it over in this frame.
                handle.set_changed();
            }
        }
    }
}

fn measure_memory(
    sets: Res<FeatherSets>,
    sizes: Query<&CardBytes>,
    changed: Query<(), Changed<CardBytes>>,
    mut removed: RemovedComponents<CardBytes>,
    mut memory: ResMut<PlumageMemory>,
) {
    if removed.read().count() == 0 && changed.is_empty() && !sets.is_changed() {
        return;
    }
    let mut now = PlumageMemory::default();
    for set in sets.0.values() {
        now.feathers += set.bytes.0;
        now.textures += set.bytes.1;
    }
    let mut meshes = HashMap::new();
    for bytes in &sizes {
        now.cards += bytes.cards;
        meshes.extend([bytes.mesh]);
    }
    now.meshes = meshes.values().sum();
    // What all birds with a skin share while their cards are classified.
    let most = sizes.iter().map(|bytes| bytes.measured).max();
    now.cards += most
        .filter(|most| *most > 0)
        .map_or(0, |most| GRID_BYTES + most);
    memory.set_if_neq(now);
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let vertices = mesh.count_vertices() as u64 * mesh.get_vertex_size();
    let indices = mesh.indices().map_or(0, |indices| {
        (indices.len() * IndexFormat::from(indices).byte_size()) as u64
    });
    vertices + indices
}

fn upload(data: Vec<u8>, label: &'static str) -> ShaderBuffer {
    let mut buffer = ShaderBuffer::new(&data, RenderAssetUsages::RENDER_WORLD);
    buffer.buffer_description.label = Some(label);
    buffer.buffer_description.usage =
        BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer
}

/// What the shader has to know for all of them.
fn thin_layers(feathers: &[Feather]) -> ThinLayers {
    let of = |feather: &Feather| match (&feather.iridescence, &feather.iridescence_scale) {
        (None, _) => ThinLayers::None,
        (Some(_), None) => ThinLayers::Even,
        (Some(_), Some(_)) => ThinLayers::Graded,
    };
    feathers.iter().map(of).max().unwrap_or_default()
}
