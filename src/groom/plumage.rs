//! The plugin, and the systems that groom every entity with a [`Plumage`].

use super::{
    asset::Groom,
    authored::{AuthoredParts, SkinMasks, read_attributes},
    coats::{CoatInput, CoatKey, Coats, SharedCoat},
    component::{
        CardRoots, DownTracts, FeathersOf, NotSkin, Plumage, PlumageCards, PlumageFailed,
        PlumageParts, PlumageReady, PlumageState, PlumageSystems, SkinColors,
    },
    fan::{FanJoints, fan_rows},
    fit::follow_outlines,
    job::GroomJob,
    mask_images::{MaskImages, MaskSource, follow_masks},
    mask_textures::PlumageMasks,
    skin_meshes::{SkinMeshes, SkinTarget},
    worn::{Worn, find_worn},
};
use crate::{
    anatomy::{Feather, covering},
    asset::{AssetLink, RonLoader},
    modified::modified,
};
use bevy::{
    app::{App, Plugin, PostUpdate, Update},
    asset::{AssetApp, AssetEvent, AssetServer, Assets, Handle, LoadState},
    camera::visibility::NoFrustumCulling,
    ecs::{name::Name, prelude::*},
    gltf::extensions::GltfExtensionHandlers,
    image::Image,
    log::error,
    math::Mat4,
    mesh::{
        Mesh, Mesh3d,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    platform::hash::FixedHasher,
    prelude::{Transform, TransformSystems, Visibility},
    transform::components::GlobalTransform,
};
use std::hash::BuildHasher;

/// Loads groom assets and grooms every entity with a [`Plumage`]. One of the `PlumagePlugins`; needs
/// [`AnatomyPlugin`](crate::anatomy::AnatomyPlugin) and Bevy's `MeshPlugin` before it.
#[derive(Clone, Copy, Debug, Default)]
pub struct GroomPlugin;

impl Plugin for GroomPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Groom>()
            .init_asset_loader::<RonLoader<Groom>>()
            .register_asset_reflect::<Groom>()
            .register_type::<Groom>()
            .init_resource::<Coats>()
            .register_type::<Plumage>()
            .register_type::<PlumageState>()
            .register_type::<PlumageReady>()
            .register_type::<PlumageFailed>()
            .register_type::<FeathersOf>()
            .register_type::<PlumageParts>()
            .register_type::<NotSkin>()
            .register_type::<SkinMasks>()
            .register_type::<PlumageMasks>()
            .add_observer(drop_removed)
            .add_observer(regroom_lost)
            .add_systems(
                Update,
                (
                    request,
                    // An app without images has no masks in them.
                    follow_masks.run_if(resource_exists::<Messages<AssetEvent<Image>>>),
                    start,
                    finish,
                    follow_outlines,
                    drop_unused,
                )
                    .chain()
                    .in_set(PlumageSystems::Groom),
            )
            .add_systems(
                PostUpdate,
                (fan_rows, find_worn)
                    .in_set(PlumageSystems::MoveFeathers)
                    .after(TransformSystems::Propagate),
            );
    }

    fn finish(&self, app: &mut App) {
        // An app without glTF has no attributes to read.
        if let Some(handlers) = app.world().get_resource::<GltfExtensionHandlers>() {
            read_attributes(handlers);
        }
    }
}

/// Plumage taken off takes its cards with it.
fn drop_removed(remove: On<Remove, Plumage>, mut commands: Commands) {
    let owner = remove.entity;
    // The whole entity may be on its way out.
    commands.queue(move |world: &mut World| {
        if let Ok(mut entity) = world.get_entity_mut(owner) {
            entity
                .despawn_related::<PlumageParts>()
                .remove::<(GroomJob, MaskImages, PlumageState)>();
        }
    });
}

/// Grooms anew what has lost its cards, which went with the scene they hung on.
fn regroom_lost(
    remove: On<Remove, PlumageParts>,
    mut commands: Commands,
    mut birds: Query<&mut PlumageState, (With<Plumage>, Without<GroomJob>)>,
) {
    if let Ok(mut state) = birds.get_mut(remove.entity) {
        *state = PlumageState::default();
        commands
            .entity(remove.entity)
            .try_insert(GroomJob::default());
    }
}

fn request(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Groom>>,
    mut mesh_events: MessageReader<AssetEvent<Mesh>>,
    mut coats: ResMut<Coats>,
    mut birds: Query<(Entity, Ref<Plumage>, &mut PlumageState)>,
) {
    let (modified, meshes) = (modified(&mut events), modified(&mut mesh_events));
    if !modified.is_empty() || !meshes.is_empty() {
        coats.forget(|key| {
            modified.contains(&key.groom) || key.meshes.iter().any(|id| meshes.contains(id))
        });
    }
    for (entity, plumage, mut state) in &mut birds {
        if plumage.is_changed() || modified.contains(&plumage.groom.id()) {
            state.regroom();
            // Replaces a groom under way.
            commands.entity(entity).insert(GroomJob::default());
        }
    }
}

fn fail(state: &mut PlumageState, commands: &mut Commands, owner: Entity, message: String) {
    error!("plumage of {owner}: {message}");
    state.error = Some(message.clone());
    commands.entity(owner).try_remove::<GroomJob>();
    commands.trigger(PlumageFailed {
        entity: owner,
        error: message,
    });
}

fn start(
    mut commands: Commands,
    server: Res<AssetServer>,
    grooms: Res<Assets<Groom>>,
    feathers: Res<Assets<Feather>>,
    meshes: SkinMeshes,
    parts: AuthoredParts,
    textures: MaskSource,
    mut coats: ResMut<Coats>,
    mut birds: Query<(Entity, &Plumage, &mut PlumageState, &mut GroomJob)>,
) {
    for (owner, plumage, mut state, mut job) in &mut birds {
        if job.waits.as_ref().is_some_and(|(_, key)| coats.knows(key)) {
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
        let own = job
            .masks
            .get_or_insert_with(|| textures.load(owner, plumage, groom));
        if !textures.are_there(own) {
            continue;
        }
        let own = own.clone();
        let Some((target, input)) = meshes.find(owner) else {
            continue;
        };
        let masks = parts.masks(&target.meshes);
        let authored = parts.find(owner, target.mesh);
        // Curves are there to be followed, not to be seen.
        for curve in parts.curves(owner) {
            commands.entity(curve).insert(Visibility::Hidden);
        }
        let key = CoatKey {
            authored: FixedHasher.hash_one(format!("{masks:?} {authored:?} {own:?}")),
            textures: own.iter().map(|(image, _)| image.id()).collect(),
            groom: plumage.groom.id(),
            seed: plumage.seed,
            density: plumage.density.to_bits(),
            meshes: input.meshes,
            maps: input.maps,
            joints: input.joints,
        };
        coats.begin(&key, groom, || CoatInput {
            meshes: meshes.copies(&key.meshes),
            masks,
            textures: textures.copies(&own),
            authored,
            pivots: target.pivots().collect(),
            feathers: {
                let own = job.feathers.iter().flatten();
                own.filter_map(|own| feathers.get(own)).cloned().collect()
            },
        });
        let images = own.into_iter().map(|(image, _)| image).collect();
        commands.entity(owner).insert(MaskImages(images));
        job.waits = Some((target, key));
    }
}

/// The feathers of the groom; paths given in code are relative to the groom's file, or to the asset root for a groom without
/// one. Without a groom: a feather that comes with the crate, no file needed.
fn load_feathers(
    server: &AssetServer,
    plumage: &Plumage,
    groom: Option<&Groom>,
) -> Vec<Handle<Feather>> {
    let Some(groom) = groom else {
        return vec![server.add(covering())];
    };
    let base = server.get_path(plumage.groom.id());
    let load = |link: &AssetLink<Feather>| link.load(server, base.as_ref());
    groom.feathers.iter().map(load).collect()
}

fn finish(
    mut commands: Commands,
    mut coats: ResMut<Coats>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
    entities: Query<Entity>,
    mut birds: Query<(Entity, &Plumage, &mut PlumageState, &GroomJob)>,
) {
    if birds.is_empty() {
        return;
    }
    coats.poll(&mut meshes);
    for (owner, plumage, mut state, job) in &mut birds {
        let Some((target, key)) = &job.waits else {
            continue;
        };
        let coat = match coats.get(key) {
            None => continue,
            Some(Ok(coat)) => coat.clone(),
            Some(Err(message)) => {
                fail(&mut state, &mut commands, owner, message.clone());
                continue;
            }
        };
        // The scene may have been replaced while the worker was busy: then look for its meshes again.
        if !entities.contains(target.mesh) {
            commands.entity(owner).insert(GroomJob::default());
            continue;
        }
        *state = PlumageState {
            ready: true,
            cards: coat.cards.len() as u32,
            triangles: coat.triangles,
            groom_ms: coat.milliseconds,
            crossings: coat.crossings.left as u32,
            error: None,
            warnings: coat.warnings.to_vec(),
        };
        let cards = PlumageCards {
            cards: coat.cards.clone(),
            geometry: coat.geometry.clone(),
            groom: plumage.groom.clone(),
            feathers: job.feathers.clone().unwrap_or_default(),
            weathered: Vec::new(),
            regions: coat.regions.clone(),
        };
        commands.entity(owner).despawn_related::<PlumageParts>();
        let cards = (cards, FeathersOf(owner));
        spawn_cards(&mut commands, &mut poses, cards, target, coat);
        commands.entity(owner).remove::<GroomJob>();
        commands.trigger(PlumageReady { entity: owner });
    }
}

/// Cancels grooms that nobody waits for any more, and lets go of coats whose last bird is gone.
fn drop_unused(
    mut coats: ResMut<Coats>,
    mut removed: RemovedComponents<PlumageCards>,
    jobs: Query<&GroomJob>,
) {
    let removed = removed.read().count() > 0;
    if coats.is_empty() || (!removed && jobs.is_empty()) {
        return;
    }
    coats.drop_unused(|key| {
        let mut waiting = jobs.iter().filter_map(|job| job.waits.as_ref());
        waiting.any(|(_, waits)| waits == key)
    });
}

fn spawn_cards(
    commands: &mut Commands,
    poses: &mut Assets<SkinnedMeshInverseBindposes>,
    cards: (PlumageCards, FeathersOf),
    target: &SkinTarget,
    coat: SharedCoat,
) {
    // Cards stand out from the joints' own bounds, so no bounds are kept.
    let common = (
        cards,
        NoFrustumCulling,
        Transform::IDENTITY,
        Visibility::default(),
        Name::new("Plumage"),
    );
    let roots = CardRoots {
        skin: coat.skin.clone(),
        roots: coat.roots,
    };
    let output = commands.spawn((common, roots, ChildOf(target.mesh))).id();
    if coat.shares.iter().any(|share| *share > 0.0) {
        commands.entity(output).insert(SkinColors {
            meshes: target.meshes.clone(),
            cards: coat.cards.clone(),
            shares: coat.shares,
        });
    }
    if !coat.down.is_empty() {
        commands.entity(output).insert(DownTracts {
            skin: coat.skin,
            tracts: coat.down,
        });
    }
    let Some(mesh) = coat.mesh else {
        return;
    };
    commands.entity(output).insert(Mesh3d(mesh));
    if coat.skinned {
        let mut fans = Vec::with_capacity(coat.fans.len());
        for fan in coat.fans.iter() {
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
                joints: coat.fans,
                entities: fans,
            },
        ));
        if coat.worn.follows() {
            commands.entity(output).insert(Worn::new(coat.worn));
        }
    }
}
