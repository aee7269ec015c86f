//! The component a game adds to a bird, and the systems that feather it.

use super::{
    asset::Groom,
    build::{Bird, Coat, Ground, groom_bird},
    card::{Card, CardGeometry},
    error::GroomError,
    fan::{FanJoints, fan_rows},
    loader::GroomLoader,
    skin::SkinMesh,
};
use crate::{
    anatomy::{Feather, presets},
    modified::modified,
    parameter::Parameter,
};
use bevy::{
    app::{App, Plugin, PostUpdate, Update},
    asset::{AssetApp, AssetEvent, AssetServer, Assets, Handle, LoadState},
    camera::visibility::NoFrustumCulling,
    ecs::{name::Name, prelude::*, system::SystemParam},
    log::{error, info, warn},
    math::Mat4,
    mesh::{
        Mesh, Mesh3d,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    platform::{collections::HashMap, time::Instant},
    prelude::{Transform, TransformSystems, Visibility},
    reflect::{Reflect, std_traits::ReflectDefault},
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
    transform::components::GlobalTransform,
};
use std::sync::Arc;

/// Feathers a bird. Put it on the entity of the bird's mesh, or on any entity above it (the root of a glTF scene): the meshes
/// are looked for on the entity and below it, whenever they come.
///
/// Which meshes are the skin: all skinned meshes with a second set of texture coordinates (`TEXCOORD_1`: tract number and phi);
/// if there are none, the skinned mesh with most vertices; if none is skinned, the mesh with most vertices.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(PlumageState)]
pub struct Plumage {
    /// Where feathers grow; with the default handle, by what the mesh itself offers ([`Groom::fallback`]).
    pub groom: Handle<Groom>,
    /// Seed of everything random: the same seed gives the same bird.
    pub seed: u64,
    /// Number of scattered feathers relative to the groom's own, 0.01..16; their size follows, so that cover stays.
    #[reflect(@Parameter::new("", 0.01, 16.0).logarithmic())]
    pub density: f32,
}

impl Default for Plumage {
    fn default() -> Self {
        Self {
            groom: Handle::default(),
            seed: 0,
            density: 1.0,
        }
    }
}

impl Plumage {
    /// Plumage after a groom, seed 0, density 1.
    pub fn new(groom: Handle<Groom>) -> Self {
        Self {
            groom,
            ..Self::default()
        }
    }

    /// With this seed.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// With this density, 0.01..16.
    pub fn with_density(mut self, density: f32) -> Self {
        self.density = density;
        self
    }
}

/// How far a bird's plumage is.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct PlumageState {
    /// Whether the cards there are belong to the plumage as it now is.
    pub ready: bool,
    /// Number of cards.
    pub cards: u32,
    /// Number of triangles of the cards.
    pub triangles: u32,
    /// Time the groom took on its worker thread, milliseconds.
    pub groom_ms: f32,
    /// Pairs of feathers that still cross, see [`super::Crossings`].
    pub crossings: u32,
    /// Why there are no cards, if that is so.
    pub error: Option<String>,
}

impl PlumageState {
    /// Whether the cards there are belong to the plumage as it now is.
    pub fn is_ready(&self) -> bool {
        self.ready
    }
}

/// On the card mesh of a bird: what the renderer needs beside the mesh.
#[derive(Component, Clone, Debug)]
pub struct PlumageCards {
    /// One record per card; `UV_1.x` of the mesh is the index.
    pub cards: Arc<[Card]>,
    /// Where each card's vertices are.
    pub geometry: Arc<[CardGeometry]>,
    /// The groom they were made by.
    pub groom: Handle<Groom>,
    /// The feathers worn, in the groom's order.
    pub feathers: Vec<Handle<Feather>>,
    /// The entity that has the [`Plumage`].
    pub owner: Entity,
}

/// On the entity with the [`Plumage`]: the card mesh made for it.
#[derive(Component, Clone, Copy, Debug)]
pub struct PlumageOutput(
    /// Entity of the card mesh, a child of the skin's.
    pub Entity,
);

/// On the card mesh of a bird whose groom has down: what the down grows on.
#[derive(Component, Clone, Debug)]
pub struct PlumageGround {
    /// The skin, its joints those of the card mesh.
    pub skin: Arc<SkinMesh>,
    /// Tracts with down.
    pub tracts: Arc<[Ground]>,
}

/// On a mesh that draws a bird's cards once more, below the card mesh: no skin to groom.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct PlumageRepeat;

/// A groom under way.
#[derive(Component, Default)]
struct GroomJob {
    feathers: Option<Vec<Handle<Feather>>>,
    target: Option<Target>,
    task: Option<Task<(Result<(Coat, SkinMesh), GroomError>, f32)>>,
}

/// The skin chosen, and its skeleton.
#[derive(Clone)]
struct Target {
    mesh: Entity,
    joints: Vec<Entity>,
    inverse_bind: Vec<Mat4>,
}

/// Loads grooms and feathers the birds that have a [`Plumage`].
#[derive(Clone, Copy, Debug, Default)]
pub struct GroomPlugin;

/// Order of the groom systems in `Update`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroomSystems;

impl Plugin for GroomPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Groom>()
            .init_asset::<Feather>()
            .init_asset::<Mesh>()
            .init_asset::<SkinnedMeshInverseBindposes>()
            .init_asset_loader::<GroomLoader>()
            .register_type::<Plumage>()
            .register_type::<PlumageState>()
            .add_systems(
                Update,
                (drop_removed, miss_lost, request, start, finish)
                    .chain()
                    .in_set(GroomSystems),
            )
            .add_systems(PostUpdate, fan_rows.after(TransformSystems::Propagate));
    }
}

fn drop_removed(
    mut commands: Commands,
    mut removed: RemovedComponents<Plumage>,
    outputs: Query<&PlumageOutput>,
    worn: Query<(), With<Plumage>>,
) {
    for owner in removed.read() {
        // Taken off and put on again in one frame is a change.
        if worn.contains(owner) {
            continue;
        }
        if let Ok(output) = outputs.get(owner) {
            commands.entity(output.0).try_despawn();
        }
        if let Ok(mut entity) = commands.get_entity(owner) {
            entity.try_remove::<(PlumageOutput, GroomJob, PlumageState)>();
        }
    }
}

/// Feathers anew whose cards went with the scene they hung on.
fn miss_lost(
    mut commands: Commands,
    entities: Query<Entity>,
    mut birds: Query<(Entity, &PlumageOutput, &mut PlumageState), Without<GroomJob>>,
) {
    for (owner, output, mut state) in &mut birds {
        if !entities.contains(output.0) {
            *state = PlumageState::default();
            commands
                .entity(owner)
                .remove::<PlumageOutput>()
                .insert(GroomJob::default());
        }
    }
}

fn request(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Groom>>,
    mut birds: Query<(Entity, Ref<Plumage>, &mut PlumageState)>,
) {
    let modified = modified(&mut events);
    for (entity, plumage, mut state) in &mut birds {
        if plumage.is_changed() || modified.contains(&plumage.groom.id()) {
            state.ready = false;
            state.error = None;
            // Replaces, and so cancels, a groom under way.
            commands.entity(entity).insert(GroomJob::default());
        }
    }
}

/// The meshes below an entity.
#[derive(SystemParam)]
struct Meshes<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    meshes: Query<
        'w,
        's,
        (&'static Mesh3d, Option<&'static SkinnedMesh>),
        (Without<PlumageCards>, Without<PlumageRepeat>),
    >,
    names: Query<'w, 's, &'static Name>,
    assets: Res<'w, Assets<Mesh>>,
    poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
}

/// What the worker thread gets.
struct Input {
    meshes: Vec<Mesh>,
    maps: Vec<Vec<u16>>,
    joints: Vec<String>,
}

impl Meshes<'_, '_> {
    /// The skin, once every mesh below the entity is loaded.
    fn find(&self, owner: Entity) -> Option<(Target, Input)> {
        let mut found = Vec::new();
        for entity in std::iter::once(owner).chain(self.children.iter_descendants(owner)) {
            let Ok((handle, skin)) = self.meshes.get(entity) else {
                continue;
            };
            let mesh = self.assets.get(&handle.0)?;
            let bind = match skin {
                Some(skin) => Some((skin, self.poses.get(&skin.inverse_bindposes)?)),
                None => None,
            };
            found.push((entity, mesh, bind));
        }
        let any_skinned = found.iter().any(|(_, _, bind)| bind.is_some());
        found.retain(|(_, _, bind)| bind.is_some() == any_skinned);
        let has_tracts = |mesh: &Mesh| {
            mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_1)
                .is_ok_and(|values| values.is_some())
        };
        let vertices = |mesh: &Mesh| {
            mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)
                .map_or(0, |values| values.len())
        };
        if any_skinned && found.iter().any(|(_, mesh, _)| has_tracts(mesh)) {
            found.retain(|(_, mesh, _)| has_tracts(mesh));
        } else {
            let largest = found.iter().map(|(_, mesh, _)| vertices(mesh)).max()?;
            let first = found
                .iter()
                .position(|(_, mesh, _)| vertices(mesh) == largest)?;
            found = vec![found.swap_remove(first)];
        }
        let mesh = found.first()?.0;
        let mut target = Target {
            mesh,
            joints: Vec::new(),
            inverse_bind: Vec::new(),
        };
        let mut known: HashMap<Entity, u16> = HashMap::default();
        let mut maps = Vec::new();
        for (_, _, bind) in &found {
            let Some((skin, bind)) = bind else { continue };
            let index = |(number, &joint): (usize, &Entity)| {
                *known.entry(joint).or_insert_with(|| {
                    target.joints.push(joint);
                    target
                        .inverse_bind
                        .push(bind.get(number).copied().unwrap_or(Mat4::IDENTITY));
                    (target.joints.len() - 1) as u16
                })
            };
            maps.push(skin.joints.iter().enumerate().map(index).collect());
        }
        let name = |joint: &Entity| {
            self.names
                .get(*joint)
                .map_or_else(|_| String::new(), |name| name.as_str().to_owned())
        };
        let joints = target.joints.iter().map(name).collect();
        let meshes = found.into_iter().map(|(_, mesh, _)| mesh.clone()).collect();
        Some((
            target,
            Input {
                meshes,
                maps,
                joints,
            },
        ))
    }
}

fn fail(state: &mut PlumageState, commands: &mut Commands, owner: Entity, message: String) {
    error!("plumage of {owner}: {message}");
    state.error = Some(message);
    commands.entity(owner).try_remove::<GroomJob>();
}

fn start(
    mut commands: Commands,
    server: Res<AssetServer>,
    grooms: Res<Assets<Groom>>,
    feathers: Res<Assets<Feather>>,
    meshes: Meshes,
    mut birds: Query<(Entity, &Plumage, &mut PlumageState, &mut GroomJob)>,
) {
    for (owner, plumage, mut state, mut job) in &mut birds {
        if job.task.is_some() {
            continue;
        }
        let groom = grooms.get(&plumage.groom);
        if groom.is_none() && plumage.groom != Handle::default() {
            if let LoadState::Failed(cause) = server.load_state(plumage.groom.id()) {
                fail(&mut state, &mut commands, owner, cause.to_string());
            }
            continue;
        }
        let list = job
            .feathers
            .get_or_insert_with(|| load_feathers(&server, plumage, groom));
        // A file that was damaged later leaves the feather as it was.
        let failed = list
            .iter()
            .filter(|feather| feathers.get(*feather).is_none())
            .find_map(|feather| match server.load_state(feather.id()) {
                LoadState::Failed(cause) => Some(cause.to_string()),
                _ => None,
            });
        if let Some(cause) = failed {
            fail(&mut state, &mut commands, owner, cause);
            continue;
        }
        if list.iter().any(|feather| feathers.get(feather).is_none()) {
            continue;
        }
        let Some((target, input)) = meshes.find(owner) else {
            continue;
        };
        let (groom, seed, density) = (groom.cloned(), plumage.seed, plumage.density);
        job.target = Some(target);
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        job.task = Some(pool.spawn(async move {
            let begun = Instant::now();
            let meshes: Vec<&Mesh> = input.meshes.iter().collect();
            let coat = SkinMesh::from_meshes(&meshes, &input.maps).and_then(|skin| {
                let bird = Bird {
                    skin,
                    joints: input.joints,
                };
                let groom = groom.unwrap_or_else(|| Groom::fallback(&bird.skin, &bird.joints));
                let coat = groom_bird(&bird, &groom, seed, density)?;
                Ok((coat, bird.skin))
            });
            (coat, begun.elapsed().as_secs_f32() * 1.0e3)
        }));
    }
}

/// Feather paths are relative to the groom's file, or to the asset root for a groom made in code. Without a groom: the contour
/// feather that comes with the crate, no file needed.
fn load_feathers(
    server: &AssetServer,
    plumage: &Plumage,
    groom: Option<&Groom>,
) -> Vec<Handle<Feather>> {
    let Some(groom) = groom else {
        let preset = presets::by_name("contour").into_iter();
        return preset.map(|feather| server.add(feather)).collect();
    };
    let base = server.get_path(plumage.groom.id());
    let resolve = |path: &String| match &base {
        Some(base) => base
            .resolve_embed_str(path)
            .map_or_else(|_| server.load(path.clone()), |full| server.load(full)),
        None => server.load(path.clone()),
    };
    groom.feathers.iter().map(resolve).collect()
}

fn finish(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
    entities: Query<Entity>,
    mut birds: Query<(
        Entity,
        &Plumage,
        &mut PlumageState,
        &mut GroomJob,
        Option<&PlumageOutput>,
    )>,
) {
    for (owner, plumage, mut state, mut job, old) in &mut birds {
        let Some((coat, milliseconds)) =
            job.task.as_mut().and_then(|task| block_on(poll_once(task)))
        else {
            continue;
        };
        let (target, feathers) = (job.target.take(), job.feathers.take().unwrap_or_default());
        if let Some(old) = old {
            commands.entity(old.0).try_despawn();
            commands.entity(owner).remove::<PlumageOutput>();
        }
        let (coat, skin) = match coat {
            Ok(grown) => grown,
            Err(cause) => {
                fail(&mut state, &mut commands, owner, cause.to_string());
                continue;
            }
        };
        // The scene may have been replaced while the worker was busy: then look for its meshes again.
        let Some(target) = target.filter(|target| entities.contains(target.mesh)) else {
            commands.entity(owner).insert(GroomJob::default());
            continue;
        };
        coat.warnings.iter().for_each(|warning| warn!("{warning}"));
        *state = PlumageState {
            ready: true,
            cards: coat.cards.len() as u32,
            triangles: coat.mesh.indices().map_or(0, |indices| indices.len() / 3) as u32,
            groom_ms: milliseconds,
            crossings: coat.crossings.left as u32,
            error: None,
        };
        info!(
            "plumage of {owner}: {} cards in {milliseconds:.0} ms, {:?}",
            coat.cards.len(),
            coat.crossings
        );
        let output = spawn_cards(
            &mut commands,
            &mut meshes,
            &mut poses,
            owner,
            plumage,
            target,
            coat,
            skin,
            feathers,
        );
        commands
            .entity(owner)
            .insert(PlumageOutput(output))
            .remove::<GroomJob>();
    }
}

fn spawn_cards(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    poses: &mut Assets<SkinnedMeshInverseBindposes>,
    owner: Entity,
    plumage: &Plumage,
    target: Target,
    coat: Coat,
    skin: SkinMesh,
    feathers: Vec<Handle<Feather>>,
) -> Entity {
    let skinned = coat.mesh.contains_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    let cards = PlumageCards {
        cards: coat.cards.into(),
        geometry: coat.geometry.into(),
        groom: plumage.groom.clone(),
        feathers,
        owner,
    };
    let empty = cards.cards.is_empty();
    // Cards stand out from the joints' own bounds, so no bounds are kept.
    let common = (
        cards,
        NoFrustumCulling,
        Transform::IDENTITY,
        Visibility::default(),
        Name::new("Plumage"),
    );
    let output = commands.spawn((common, ChildOf(target.mesh))).id();
    if !coat.ground.is_empty() {
        commands.entity(output).insert(PlumageGround {
            skin: Arc::new(skin),
            tracts: coat.ground.into(),
        });
    }
    if empty {
        // A mesh without vertices has no place on the GPU.
        return output;
    }
    commands
        .entity(output)
        .insert(Mesh3d(meshes.add(coat.mesh)));
    if skinned {
        let mut fans = Vec::with_capacity(coat.fans.len());
        for fan in &coat.fans {
            fans.push(
                commands
                    .spawn((
                        GlobalTransform::IDENTITY,
                        Name::new(fan.name.clone()),
                        ChildOf(output),
                    ))
                    .id(),
            );
        }
        let bind: Vec<Mat4> = target
            .inverse_bind
            .iter()
            .copied()
            .chain(coat.fans.iter().map(|fan| fan.inverse_bind()))
            .collect();
        let joints = target.joints.iter().chain(&fans).copied().collect();
        commands.entity(output).insert((
            SkinnedMesh {
                inverse_bindposes: poses.add(SkinnedMeshInverseBindposes::from(bind)),
                joints,
            },
            FanJoints {
                joints: coat.fans.into(),
                entities: fans,
            },
        ));
    }
    output
}
