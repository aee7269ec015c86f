//! Extra draws of the card mesh: one per LOD class, an opaque core for order-independent transparency; and what to do with
//! cameras that Bevy would refuse.

use super::{
    key::{DrawnCards, DrawnUnder, FeatherTransparency},
    limits::{ActiveFeatherPath, FeatherPath},
    material::{DebugView, Drawing, FeatherMaterial},
    prepare::FeatherQuality,
};
use crate::groom::{NotSkin, PlumageCards, PlumageSystems};
use bevy::{
    camera::visibility::{NoFrustumCulling, RenderLayers, VisibilityRange, VisibilitySystems},
    core_pipeline::oit::OrderIndependentTransparencySettings,
    ecs::{query::QueryData, system::SystemParam},
    light::{NotShadowCaster, NotShadowReceiver},
    mesh::skinning::SkinnedMesh,
    prelude::*,
};

pub(super) struct ExtraDrawPlugin;

impl Plugin for ExtraDrawPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(refuse_on_settings)
            .add_observer(refuse_on_msaa)
            .add_observer(refuse_on_quality);
    }
}

pub(super) fn add_systems(app: &mut App) {
    app.add_systems(
        PostUpdate,
        (
            warn_without_camera,
            prepare_extra_draws
                .in_set(PlumageSystems::PrepareExtraDraws)
                .after(PlumageSystems::PrepareMaterials)
                .before(VisibilitySystems::VisibilityPropagate)
                .before(TransformSystems::Propagate),
        ),
    );
}

/// Cameras on which Bevy panics, and the feathers that ask for what such a camera cannot do.
#[derive(SystemParam)]
struct RefusedCameras<'w, 's> {
    cameras: Query<'w, 's, (Entity, &'static Msaa), With<OrderIndependentTransparencySettings>>,
    qualities: Query<'w, 's, &'static FeatherQuality>,
    path: Option<Res<'w, ActiveFeatherPath>>,
    commands: Commands<'w, 's>,
}

impl RefusedCameras<'_, '_> {
    /// Mends all such cameras (or this one), if there are feathers for which they were set up. Others are the app's own affair.
    fn refuse(&mut self, camera: Option<Entity>) {
        let falls_back = self
            .path
            .as_ref()
            .is_some_and(|path| path.get() == FeatherPath::Fallback);
        let asks = |quality: &FeatherQuality| {
            quality.transparency == FeatherTransparency::OrderIndependent
        };
        if falls_back || !self.qualities.iter().any(asks) {
            return;
        }
        let refused = self.cameras.iter().filter(|(entity, msaa)| {
            msaa.samples() > 1 && camera.is_none_or(|camera| camera == *entity)
        });
        for (camera, _) in refused {
            warn!(
                "bevy_plumage: camera {camera} has OrderIndependentTransparencySettings and MSAA, which Bevy refuses: the settings \
             are taken off it, feathers become alpha to coverage there. Give it Msaa::Off to have order-independent transparency"
            );
            self.commands
                .entity(camera)
                .try_remove::<OrderIndependentTransparencySettings>();
        }
    }
}

fn refuse_on_settings(
    insert: On<Insert, OrderIndependentTransparencySettings>,
    mut cameras: RefusedCameras,
) {
    cameras.refuse(Some(insert.entity));
}

fn refuse_on_msaa(insert: On<Insert, Msaa>, mut cameras: RefusedCameras) {
    cameras.refuse(Some(insert.entity));
}

fn refuse_on_quality(_: On<Insert, FeatherQuality>, mut cameras: RefusedCameras) {
    cameras.refuse(None);
}

fn warn_without_camera(
    mut warned: Local<bool>,
    changed: Query<(), Or<(Added<Camera3d>, ChangedMaterial)>>,
    birds: Query<&MeshMaterial3d<FeatherMaterial>, With<PlumageCards>>,
    materials: Res<Assets<FeatherMaterial>>,
    cameras: Query<Has<OrderIndependentTransparencySettings>, With<Camera3d>>,
) {
    if *warned || changed.is_empty() || cameras.is_empty() || cameras.iter().any(|has| has) {
        return;
    }
    let wanted = birds.iter().any(|material| {
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

/// Another material, or an edited one.
type ChangedMaterial = Or<(
    Changed<MeshMaterial3d<FeatherMaterial>>,
    AssetChanged<MeshMaterial3d<FeatherMaterial>>,
)>;

/// Changes on a card mesh that its extra draws take over.
type ChangedCards = Or<(
    ChangedMaterial,
    Changed<Mesh3d>,
    Changed<RenderLayers>,
    Changed<VisibilityRange>,
    Changed<NotShadowReceiver>,
)>;

/// What extra draws take over when it goes, and the extra draws themselves.
#[derive(SystemParam)]
struct Removed<'w, 's> {
    layers: RemovedComponents<'w, 's, RenderLayers>,
    ranges: RemovedComponents<'w, 's, VisibilityRange>,
    unshadowed: RemovedComponents<'w, 's, NotShadowReceiver>,
    draws: RemovedComponents<'w, 's, ExtraDraw>,
}

impl Removed<'_, '_> {
    fn any(&mut self) -> bool {
        self.layers.read().count()
            + self.ranges.read().count()
            + self.unshadowed.read().count()
            + self.draws.read().count()
            > 0
    }
}

/// On a child of the card mesh that draws the cards once more.
#[derive(Component)]
pub(super) struct ExtraDraw;

/// On the card mesh: what else draws it.
#[derive(Component)]
struct ExtraDraws(Vec<(Drawing, Entity)>);

/// What an extra draw takes over from the card mesh.
#[derive(QueryData)]
struct CardMesh {
    entity: Entity,
    mesh: &'static Mesh3d,
    material: &'static MeshMaterial3d<FeatherMaterial>,
    skin: Option<&'static SkinnedMesh>,
    layers: Option<&'static RenderLayers>,
    range: Option<&'static VisibilityRange>,
    unshadowed: Option<&'static NotShadowReceiver>,
    draws: Option<&'static ExtraDraws>,
}

/// What an extra draw has taken over.
#[derive(QueryData)]
struct Follower {
    mesh: &'static Mesh3d,
    material: &'static MeshMaterial3d<FeatherMaterial>,
    layers: Option<&'static RenderLayers>,
    range: Option<&'static VisibilityRange>,
    unshadowed: Option<&'static NotShadowReceiver>,
}

/// Gives an extra draw what its card mesh has, or takes it away.
fn follow<T: Component>(commands: &mut Commands, draw: Entity, what: Option<T>) {
    match what {
        Some(what) => commands.entity(draw).insert(what),
        None => commands.entity(draw).remove::<T>(),
    };
}

/// What has to be drawn apart from a bird's own mesh.
fn wanted(material: &FeatherMaterial, sorts: bool) -> &'static [Drawing] {
    use DrawnUnder::{Any, Lamps, Suns};
    // Bevy draws the last of these first: the cheaper the fragments of a class, the sooner
    // (docs/performance.md#what-a-frame-runs).
    const CLASSES: [Drawing; 5] = [
        (DrawnCards::Far, Suns),
        (DrawnCards::Far, Lamps),
        (DrawnCards::Mean, Suns),
        (DrawnCards::Mean, Lamps),
        (DrawnCards::Lit, Suns),
    ];
    if material.settings.debug_view == DebugView::Overdraw && material.splits() {
        // Bevy's own draws count, which do not leave those out that are for other lights.
        &[(DrawnCards::Far, Any), (DrawnCards::Mean, Any)]
    } else if material.light_budget() > 0.0 {
        &CLASSES
    } else if material.splits() {
        &CLASSES[..4]
    } else if sorts && material.transparency == FeatherTransparency::OrderIndependent {
        &[(DrawnCards::Core, Any)]
    } else {
        &[]
    }
}

/// Spawns, refreshes and drops the extra draws.
fn prepare_extra_draws(
    mut commands: Commands,
    mut sorted: Local<bool>,
    mut removed: Removed,
    changed: Query<(), (With<PlumageCards>, ChangedCards)>,
    birds: Query<CardMesh, With<PlumageCards>>,
    followers: Query<Follower, With<ExtraDraw>>,
    cameras: Query<(), With<OrderIndependentTransparencySettings>>,
    mut materials: ResMut<Assets<FeatherMaterial>>,
) {
    let sorts = !cameras.is_empty();
    let all = removed.any() || sorts != *sorted;
    *sorted = sorts;
    if !all && changed.is_empty() {
        return;
    }
    for bird in &birds {
        if !all && !changed.contains(bird.entity) {
            continue;
        }
        let Some(material) = materials.get(bird.material.id()).cloned() else {
            continue;
        };
        let wanted = wanted(&material, sorts);
        let there = bird.draws.map_or(&[][..], |draws| &draws.0);
        let same = there.len() == wanted.len()
            && there
                .iter()
                .zip(wanted)
                .all(|((cards, entity), wanted)| cards == wanted && followers.contains(*entity));
        if !same {
            for (_, entity) in there {
                commands.entity(*entity).try_despawn();
            }
            let spawned = wanted
                .iter()
                .map(|cards| {
                    let own = materials.add(material.drawing(*cards));
                    (*cards, spawn_extra_draw(&mut commands, &bird, own))
                })
                .collect();
            commands.entity(bird.entity).insert(ExtraDraws(spawned));
            continue;
        }
        for (cards, entity) in there {
            let Ok(draw) = followers.get(*entity) else {
                continue;
            };
            if draw.mesh.0 != bird.mesh.0 {
                commands.entity(*entity).insert(bird.mesh.clone());
            }
            if draw.layers != bird.layers {
                follow(&mut commands, *entity, bird.layers.cloned());
            }
            if draw.range != bird.range {
                follow(&mut commands, *entity, bird.range.cloned());
            }
            if draw.unshadowed.is_some() != bird.unshadowed.is_some() {
                follow(
                    &mut commands,
                    *entity,
                    bird.unshadowed.map(|_| NotShadowReceiver),
                );
            }
            let stale = materials
                .get(draw.material.id())
                .is_none_or(|old| !draws_like(old, &material));
            if stale && let Some(mut old) = materials.get_mut(draw.material.id()) {
                *old = material.drawing(*cards);
            }
        }
    }
}

fn spawn_extra_draw(
    commands: &mut Commands,
    bird: &CardMeshItem,
    material: Handle<FeatherMaterial>,
) -> Entity {
    let draw = commands
        .spawn((
            ExtraDraw,
            NotSkin,
            bird.mesh.clone(),
            MeshMaterial3d(material),
            NotShadowCaster,
            NoFrustumCulling,
            Transform::IDENTITY,
            Visibility::Inherited,
            Name::new("Plumage extra draw"),
            ChildOf(bird.entity),
        ))
        .id();
    follow(commands, draw, bird.skin.cloned());
    follow(commands, draw, bird.layers.cloned());
    follow(commands, draw, bird.range.cloned());
    follow(commands, draw, bird.unshadowed.map(|_| NotShadowReceiver));
    draw
}

fn draws_like(draw: &FeatherMaterial, material: &FeatherMaterial) -> bool {
    draw.settings == material.settings
        && draw.transparency == material.transparency
        && draw.feathers == material.feathers
        && draw.cards == material.cards
        && draw.lod == material.lod
        && draw.albedo == material.albedo
        && draw.motion == material.motion
}
