//! The card mesh drawn more than once: cards of one LOD class each by a pipeline that knows no other, the opaque interiors of
//! order-independent transparency apart with depth; and what to do with cameras that Bevy would refuse.

use super::{
    material::{DrawnCards, FeatherMaterial, FeatherTransparency},
    wear::WearSystems,
};
use crate::groom::{PlumageCards, PlumageRepeat};
use bevy::{
    camera::visibility::{NoFrustumCulling, RenderLayers, VisibilityRange, VisibilitySystems},
    core_pipeline::oit::OrderIndependentTransparencySettings,
    ecs::query::QueryData,
    light::{NotShadowCaster, NotShadowReceiver},
    mesh::skinning::SkinnedMesh,
    prelude::*,
};

pub(super) struct RepeatPlugin;

impl Plugin for RepeatPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(refuse_on_settings)
            .add_observer(refuse_on_msaa)
            .add_systems(
                PostUpdate,
                (
                    warn_without_camera,
                    keep_repeats
                        .after(WearSystems)
                        .before(VisibilitySystems::VisibilityPropagate)
                        .before(TransformSystems::Propagate),
                ),
            );
    }
}

/// Bevy panics on such a camera.
fn refuse(
    camera: Entity,
    cameras: &Query<(&Msaa, &OrderIndependentTransparencySettings)>,
    commands: &mut Commands,
) {
    if cameras
        .get(camera)
        .is_ok_and(|(msaa, _)| msaa.samples() > 1)
    {
        warn!(
            "bevy_plumage: camera {camera} has OrderIndependentTransparencySettings and MSAA, which Bevy refuses: the settings \
             are taken off it, feathers become alpha to coverage there. Give it Msaa::Off to have order-independent transparency"
        );
        commands
            .entity(camera)
            .try_remove::<OrderIndependentTransparencySettings>();
    }
}

fn refuse_on_settings(
    insert: On<Insert, OrderIndependentTransparencySettings>,
    cameras: Query<(&Msaa, &OrderIndependentTransparencySettings)>,
    mut commands: Commands,
) {
    refuse(insert.entity, &cameras, &mut commands);
}

fn refuse_on_msaa(
    insert: On<Insert, Msaa>,
    cameras: Query<(&Msaa, &OrderIndependentTransparencySettings)>,
    mut commands: Commands,
) {
    refuse(insert.entity, &cameras, &mut commands);
}

fn warn_without_camera(
    mut warned: Local<bool>,
    worn: Query<&MeshMaterial3d<FeatherMaterial>, With<PlumageCards>>,
    materials: Res<Assets<FeatherMaterial>>,
    cameras: Query<Has<OrderIndependentTransparencySettings>, With<Camera3d>>,
) {
    if *warned || cameras.is_empty() || cameras.iter().any(|has| has) {
        return;
    }
    let wanted = worn.iter().any(|material| {
        materials
            .get(material.id())
            .is_some_and(|m| m.transparency == FeatherTransparency::OrderIndependent)
    });
    if wanted {
        *warned = true;
        warn!(
            "bevy_plumage: no camera has OrderIndependentTransparencySettings (with Msaa::Off): feathers that ask for it are \
             drawn as alpha to coverage"
        );
    }
}

/// On the card mesh: what else draws it.
#[derive(Component)]
struct Repeats(Vec<(DrawnCards, Entity)>);

/// What a repeat takes over from the card mesh.
#[derive(QueryData)]
struct Worn {
    entity: Entity,
    mesh: &'static Mesh3d,
    material: &'static MeshMaterial3d<FeatherMaterial>,
    skin: Option<&'static SkinnedMesh>,
    layers: Option<&'static RenderLayers>,
    range: Option<&'static VisibilityRange>,
    unshadowed: Option<&'static NotShadowReceiver>,
    repeats: Option<&'static Repeats>,
}

/// What a repeat has taken over.
#[derive(QueryData)]
struct Repeat {
    mesh: &'static Mesh3d,
    material: &'static MeshMaterial3d<FeatherMaterial>,
    layers: Option<&'static RenderLayers>,
    range: Option<&'static VisibilityRange>,
    unshadowed: Option<&'static NotShadowReceiver>,
}

/// Gives the repeat what its bird has, or takes it away.
fn follow<T: Component>(commands: &mut Commands, repeat: Entity, what: Option<T>) {
    match what {
        Some(what) => commands.entity(repeat).insert(what),
        None => commands.entity(repeat).remove::<T>(),
    };
}

/// What has to be drawn apart from a bird's own mesh.
fn wanted(material: &FeatherMaterial, sorts: bool) -> &'static [DrawnCards] {
    if material.splits() {
        &[DrawnCards::Far, DrawnCards::Mean]
    } else if sorts && material.transparency == FeatherTransparency::OrderIndependent {
        &[DrawnCards::Core]
    } else {
        &[]
    }
}

/// Spawns, refreshes and drops the repeats.
fn keep_repeats(
    mut commands: Commands,
    worn: Query<Worn, With<PlumageCards>>,
    repeats: Query<Repeat, With<PlumageRepeat>>,
    cameras: Query<(), With<OrderIndependentTransparencySettings>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    for bird in &worn {
        let Some(material) = materials.get(bird.material.id()).cloned() else {
            continue;
        };
        let wanted = wanted(&material, !cameras.is_empty());
        let there = bird.repeats.map_or(&[][..], |repeats| &repeats.0);
        let same = there.len() == wanted.len()
            && there
                .iter()
                .zip(wanted)
                .all(|((cards, entity), wanted)| cards == wanted && repeats.contains(*entity));
        if !same {
            for (_, entity) in there {
                commands.entity(*entity).try_despawn();
            }
            let spawned = wanted
                .iter()
                .map(|cards| {
                    let own = materials.add(material.drawing(*cards));
                    (*cards, spawn_repeat(&mut commands, &bird, own))
                })
                .collect();
            commands.entity(bird.entity).insert(Repeats(spawned));
            continue;
        }
        for (cards, entity) in there {
            let Ok(repeat) = repeats.get(*entity) else {
                continue;
            };
            if repeat.mesh.0 != bird.mesh.0 {
                commands.entity(*entity).insert(bird.mesh.clone());
            }
            if repeat.layers != bird.layers {
                follow(&mut commands, *entity, bird.layers.cloned());
            }
            if repeat.range != bird.range {
                follow(&mut commands, *entity, bird.range.cloned());
            }
            if repeat.unshadowed.is_some() != bird.unshadowed.is_some() {
                follow(
                    &mut commands,
                    *entity,
                    bird.unshadowed.map(|_| NotShadowReceiver),
                );
            }
            let stale = materials
                .get(repeat.material.id())
                .is_none_or(|old| !draws_like(old, &material));
            if stale && let Some(mut old) = materials.get_mut(repeat.material.id()) {
                *old = material.drawing(*cards);
            }
        }
    }
}

fn spawn_repeat(
    commands: &mut Commands,
    bird: &WornItem,
    material: Handle<FeatherMaterial>,
) -> Entity {
    let repeat = commands
        .spawn((
            PlumageRepeat,
            bird.mesh.clone(),
            MeshMaterial3d(material),
            NotShadowCaster,
            NoFrustumCulling,
            Transform::IDENTITY,
            Visibility::Inherited,
            Name::new("Plumage repeat"),
            ChildOf(bird.entity),
        ))
        .id();
    follow(commands, repeat, bird.skin.cloned());
    follow(commands, repeat, bird.layers.cloned());
    follow(commands, repeat, bird.range.cloned());
    follow(commands, repeat, bird.unshadowed.map(|_| NotShadowReceiver));
    repeat
}

fn draws_like(repeat: &FeatherMaterial, material: &FeatherMaterial) -> bool {
    repeat.settings == material.settings
        && repeat.transparency == material.transparency
        && repeat.feathers == material.feathers
        && repeat.cards == material.cards
        && repeat.lod == material.lod
        && repeat.albedo == material.albedo
        && repeat.motion == material.motion
}
