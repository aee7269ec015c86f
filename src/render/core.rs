//! Order-independent transparency: the opaque interiors of a bird's vanes, drawn apart with depth; and what to do with cameras
//! that Bevy would refuse.

use super::material::{FeatherMaterial, FeatherTransparency};
use crate::groom::{PlumageCards, PlumageRepeat};
use bevy::{
    camera::visibility::{NoFrustumCulling, RenderLayers, VisibilityRange},
    core_pipeline::oit::OrderIndependentTransparencySettings,
    ecs::query::QueryData,
    light::NotShadowCaster,
    mesh::skinning::SkinnedMesh,
    prelude::*,
};

pub(super) struct CorePlugin;

impl Plugin for CorePlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(refuse_on_settings)
            .add_observer(refuse_on_msaa)
            .add_systems(PostUpdate, (warn_without_camera, keep_cores));
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

/// On the card mesh: the mesh of its opaque interiors.
#[derive(Component)]
struct CoreMesh(Entity);

/// What a core takes over from the card mesh.
#[derive(QueryData)]
struct Worn {
    entity: Entity,
    mesh: &'static Mesh3d,
    material: &'static MeshMaterial3d<FeatherMaterial>,
    skin: Option<&'static SkinnedMesh>,
    layers: Option<&'static RenderLayers>,
    range: Option<&'static VisibilityRange>,
    core: Option<&'static CoreMesh>,
}

/// Spawns, refreshes and drops the cores.
fn keep_cores(
    mut commands: Commands,
    worn: Query<Worn, With<PlumageCards>>,
    cores: Query<(&Mesh3d, &MeshMaterial3d<FeatherMaterial>), With<PlumageRepeat>>,
    cameras: Query<(), With<OrderIndependentTransparencySettings>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    for bird in &worn {
        let Some(material) = materials.get(bird.material.id()).cloned() else {
            continue;
        };
        let wanted =
            material.transparency == FeatherTransparency::OrderIndependent && !cameras.is_empty();
        let core = bird
            .core
            .and_then(|core| Some((core.0, cores.get(core.0).ok()?)));
        match (wanted, core) {
            (false, None) => {}
            (false, Some((core, _))) => {
                commands.entity(core).try_despawn();
                commands.entity(bird.entity).remove::<CoreMesh>();
            }
            (true, Some((core, (mesh, old)))) => {
                if mesh.0 != bird.mesh.0 {
                    commands.entity(core).insert(bird.mesh.clone());
                }
                let stale = materials
                    .get(old.id())
                    .is_none_or(|old| !draws_like(old, &material));
                if stale && let Some(mut old) = materials.get_mut(old.id()) {
                    *old = core_of(material);
                }
            }
            (true, None) => {
                let mut core = commands.spawn((
                    PlumageRepeat,
                    bird.mesh.clone(),
                    MeshMaterial3d(materials.add(core_of(material))),
                    NotShadowCaster,
                    NoFrustumCulling,
                    Transform::IDENTITY,
                    Visibility::Inherited,
                    Name::new("Plumage core"),
                    ChildOf(bird.entity),
                ));
                if let Some(skin) = bird.skin {
                    core.insert(skin.clone());
                }
                if let Some(layers) = bird.layers {
                    core.insert(layers.clone());
                }
                if let Some(range) = bird.range {
                    core.insert(range.clone());
                }
                let core = core.id();
                commands.entity(bird.entity).insert(CoreMesh(core));
            }
        }
    }
}

fn core_of(material: FeatherMaterial) -> FeatherMaterial {
    FeatherMaterial {
        transparency: FeatherTransparency::Core,
        ..material
    }
}

fn draws_like(core: &FeatherMaterial, material: &FeatherMaterial) -> bool {
    core.settings == material.settings
        && core.feathers == material.feathers
        && core.cards == material.cards
        && core.lod == material.lod
        && core.albedo == material.albedo
        && core.motion == material.motion
}
