//! The birds of `assets`, at rest.

use crate::app::Stage;
use bevy::{
    asset::AssetPath,
    gltf::GltfAssetLabel,
    prelude::*,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::prelude::*;

/// The clip that a bird rests in.
#[derive(Component)]
struct Resting(Handle<AnimationClip>);

fn rest(
    ready: On<WorldInstanceReady>,
    birds: Query<&Resting>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let Ok(resting) = birds.get(ready.entity) else {
        return;
    };
    for entity in children.iter_descendants(ready.entity) {
        if let Ok(mut player) = players.get_mut(entity) {
            let (graph, node) = AnimationGraph::from_clip(resting.0.clone());
            let graph = AnimationGraphHandle(graphs.add(graph));
            commands.entity(entity).insert(graph);
            player.play(node).pause();
        }
    }
}

/// A bird at rest in its first clip, seen by the camera from `eye`; its entity. The camera does not draw yet.
pub fn perch(stage: &mut Stage, name: &str, eye: Vec3, target: Vec3) -> Entity {
    stage.app.add_observer(rest);
    let camera = stage.camera;
    let file = format!("birds/{name}.glb");
    let world = stage.app.world_mut();
    world.entity_mut(camera).insert((
        Transform::from_translation(eye).looking_at(target, Vec3::Y),
        Projection::Perspective(PerspectiveProjection {
            fov: 0.45,
            near: 0.01,
            ..default()
        }),
    ));
    let assets = world.resource::<AssetServer>().clone();
    let label = |label: GltfAssetLabel| -> AssetPath<'static> { label.from_asset(file.clone()) };
    let bird = world
        .spawn((
            WorldAssetRoot(assets.load(label(GltfAssetLabel::Scene(0)))),
            Resting(assets.load(label(GltfAssetLabel::Animation(0)))),
            Plumage::new(assets.load(format!("grooms/{name}.groom.ron"))),
            Transform::IDENTITY,
        ))
        .id();
    crate::scene::draw(stage, false);
    stage.settle();
    bird
}

/// Turns the shadow maps of every sun off.
pub fn without_shadows(stage: &mut Stage) {
    let world = stage.app.world_mut();
    let mut suns = world.query::<&mut DirectionalLight>();
    for mut sun in suns.iter_mut(world) {
        sun.shadow_maps_enabled = false;
    }
}
