//! The least that grows feathers: a glTF model, a groom, a light and a camera.
//!
//! `cargo run --example minimal`. Leaves with an error code when no feathers grow.

use bevy::{
    core_pipeline::prepass::DepthPrepass, gltf::GltfAssetLabel, prelude::*,
    world_serialization::WorldAssetRoot,
};
use bevy_plumage::prelude::*;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, PlumagePlugins))
        .add_systems(Startup, setup)
        .add_observer(leave)
        .run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    let model = GltfAssetLabel::Scene(0).from_asset("birds/parrot.glb");
    commands.spawn((
        WorldAssetRoot(assets.load(model)),
        Plumage::new(assets.load("grooms/parrot.groom.ron")),
    ));
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(1.0, 2.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        // Less than half the time on a GPU, and feathers in better order.
        DepthPrepass,
        Transform::from_xyz(1.0, 0.4, 1.2).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn leave(_: On<PlumageFailed>, mut exit: MessageWriter<AppExit>) {
    exit.write(AppExit::error());
}
