//! Dresses every groomed bird: packs its feathers, uploads its cards, gives it a [`FeatherMaterial`].

use super::{
    cut_out::FeatherPath,
    material::{FeatherMaterial, FeatherSettings, FeatherTransparency},
    pack::{TableCache, albedo_array, pack_cards, pack_feathers, same_paint},
    wind,
};
use crate::{anatomy::Feather, groom::PlumageCards, modified::modified};
use bevy::{
    asset::RenderAssetUsages,
    platform::collections::HashMap,
    prelude::*,
    render::{render_resource::BufferUsages, storage::ShaderBuffer},
};

pub(super) struct WearPlugin;

/// Every bird has its material.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct WearSystems;

impl Plugin for WearPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Wardrobe>()
            .init_resource::<PlumageMemory>()
            .init_resource::<PlumageWork>()
            .add_systems(
                PostUpdate,
                (
                    refresh_feathers,
                    drop_unworn,
                    wear_feathers,
                    apply_quality,
                    wind::move_feathers,
                    measure_memory,
                )
                    .chain()
                    .in_set(WearSystems)
                    .run_if(resource_equals(FeatherPath::Full)),
            );
    }
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
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlumageMemory {
    /// Feathers and fibre tables.
    pub feathers: u64,
    /// Albedo textures.
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

/// What birds of one kind share.
struct Wear {
    feathers: Handle<ShaderBuffer>,
    albedo: Handle<Image>,
    bytes: (u64, u64),
    /// The feathers as they were packed, and their tables.
    packed: Vec<Feather>,
    tables: TableCache,
}

/// How often the plugin has built and uploaded something: what an edit costs, counted.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlumageWork {
    /// Feather buffers uploaded.
    pub feather_buffers: u32,
    /// Albedo textures painted and uploaded.
    pub albedo_textures: u32,
    /// Materials made: cards uploaded, bind groups built.
    pub materials: u32,
}

/// Packed feathers by the list of feather assets worn.
#[derive(Resource, Default)]
struct Wardrobe(HashMap<Vec<AssetId<Feather>>, Wear>);

/// Bytes of one bird's own buffers: cards and LOD, mesh.
#[derive(Component)]
struct WornBytes {
    cards: u64,
    mesh: u64,
}

/// Takes the changes of feathers over: into the buffer in place where only numbers have changed, else by packing anew.
fn refresh_feathers(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Feather>>,
    mut wardrobe: ResMut<Wardrobe>,
    mut work: ResMut<PlumageWork>,
    worn: Query<(Entity, &PlumageCards), With<MeshMaterial3d<FeatherMaterial>>>,
    feathers: Res<Assets<Feather>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
) {
    let modified = modified(&mut events);
    if modified.is_empty() {
        return;
    }
    wardrobe.0.retain(|ids, wear| {
        if !ids.iter().any(|id| modified.contains(id)) {
            return true;
        }
        if refresh_in_place(wear, ids, &feathers, &mut buffers) {
            work.feather_buffers += 1;
            return true;
        }
        for (entity, cards) in &worn {
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
    wear: &mut Wear,
    ids: &[AssetId<Feather>],
    feathers: &Assets<Feather>,
    buffers: &mut Assets<ShaderBuffer>,
) -> bool {
    let Some(now) = ids
        .iter()
        .map(|id| feathers.get(*id))
        .collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    if !now.iter().zip(&wear.packed).all(|(a, b)| same_paint(a, b)) {
        return false;
    }
    let data = pack_feathers(&now, &mut wear.tables);
    if data.len() as u64 != wear.bytes.0 {
        return false;
    }
    let Some(mut buffer) = buffers.get_mut(&wear.feathers) else {
        return false;
    };
    buffer.data = Some(data);
    wear.packed = now.into_iter().cloned().collect();
    true
}

/// Forgets what no bird wears any more.
fn drop_unworn(
    mut removed: RemovedComponents<PlumageCards>,
    worn: Query<&PlumageCards>,
    mut wardrobe: ResMut<Wardrobe>,
) {
    if removed.read().count() > 0 {
        wardrobe
            .0
            .retain(|ids, _| worn.iter().any(|cards| feather_ids(cards) == *ids));
    }
}

fn feather_ids(cards: &PlumageCards) -> Vec<AssetId<Feather>> {
    cards.feathers.iter().map(Handle::id).collect()
}

fn wear_feathers(
    mut commands: Commands,
    server: Res<AssetServer>,
    mut wardrobe: ResMut<Wardrobe>,
    mut work: ResMut<PlumageWork>,
    bare: Query<
        (Entity, &PlumageCards, &Mesh3d),
        Or<(
            Without<MeshMaterial3d<FeatherMaterial>>,
            Changed<PlumageCards>,
        )>,
    >,
    qualities: Query<&FeatherQuality>,
    feathers: Res<Assets<Feather>>,
    meshes: Res<Assets<Mesh>>,
    images: ResMut<Assets<Image>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    let images = images.into_inner();
    for (entity, worn, mesh) in &bare {
        if worn.cards.is_empty() {
            continue;
        }
        let key = feather_ids(worn);
        if !wardrobe.0.contains_key(&key) {
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
            let mut tables = TableCache::default();
            let data = pack_feathers(&assets, &mut tables);
            let albedo = albedo_array(&assets, images);
            let albedo_bytes = albedo.data.as_ref().map_or(0, |data| data.len() as u64);
            work.feather_buffers += 1;
            work.albedo_textures += 1;
            let wear = Wear {
                bytes: (data.len() as u64, albedo_bytes),
                feathers: buffers.add(upload(data, "feathers")),
                albedo: images.add(albedo),
                packed: assets.into_iter().cloned().collect(),
                tables,
            };
            wardrobe.0.insert(key.clone(), wear);
        }
        let Some(wear) = wardrobe.0.get(&key) else {
            continue;
        };
        let cards = pack_cards(&worn.cards);
        let lod = vec![0u8; 4 * worn.cards.len()];
        let bytes = WornBytes {
            cards: (cards.len() + lod.len()) as u64,
            mesh: meshes.get(mesh.id()).map_or(0, mesh_bytes),
        };
        work.materials += 1;
        let quality = qualities.get(worn.owner).copied().unwrap_or_default();
        let material = FeatherMaterial {
            settings: quality.settings,
            transparency: quality.transparency,
            drawn: default(),
            feathers: wear.feathers.clone(),
            cards: buffers.add(upload(cards, "feather_cards")),
            lod: buffers.add(upload(lod, "feather_lod")),
            albedo: wear.albedo.clone(),
            motion: buffers.add(wind::still_motion(worn)),
        };
        commands
            .entity(entity)
            .insert((MeshMaterial3d(materials.add(material)), bytes));
    }
}

fn apply_quality(
    changed: Query<(Entity, &FeatherQuality), Changed<FeatherQuality>>,
    worn: Query<(&PlumageCards, &MeshMaterial3d<FeatherMaterial>)>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    for (owner, quality) in &changed {
        for (_, material) in worn.iter().filter(|(cards, _)| cards.owner == owner) {
            let same = materials.get(material.id()).is_some_and(|m| {
                m.settings == quality.settings && m.transparency == quality.transparency
            });
            if !same && let Some(mut material) = materials.get_mut(material.id()) {
                material.settings = quality.settings;
                material.transparency = quality.transparency;
            }
        }
    }
}

fn measure_memory(
    wardrobe: Res<Wardrobe>,
    worn: Query<&WornBytes>,
    mut memory: ResMut<PlumageMemory>,
) {
    let mut now = PlumageMemory::default();
    for wear in wardrobe.0.values() {
        now.feathers += wear.bytes.0;
        now.textures += wear.bytes.1;
    }
    for bytes in &worn {
        now.cards += bytes.cards;
        now.meshes += bytes.mesh;
    }
    memory.set_if_neq(now);
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let vertices = mesh.count_vertices() as u64 * mesh.get_vertex_size();
    let indices = mesh.indices().map_or(0, |i| i.len() as u64 * 4);
    vertices + indices
}

fn upload(data: Vec<u8>, label: &'static str) -> ShaderBuffer {
    let mut buffer = ShaderBuffer::new(&data, RenderAssetUsages::RENDER_WORLD);
    buffer.buffer_description.label = Some(label);
    buffer.buffer_description.usage =
        BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer
}
