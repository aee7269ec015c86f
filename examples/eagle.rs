//! A golden eagle, about 6,480 feathers.
//!
//! `cargo run --example eagle -- --camera back`; `--help` lists all options, F1 the keys. Its model is in the repository alone, not
//! in the package of the registry.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    camera::{Shots, shot},
    posture::Posture,
    scene,
};

const SHOTS: Shots = Shots {
    hero: shot([0.0, 0.19, -0.06], [1.75, 0.55, 1.55], 19.5),
    closeup: shot([0.02, 0.50, 0.05], [0.36, 0.55, 0.40], 22.0),
    macro_: shot([0.05, 0.38, 0.08], [0.08, 0.39, 0.13], 20.0),
    full: shot([0.0, 0.18, -0.1], [2.3, 0.45, 0.35], 24.0),
    back: shot([0.0, 0.18, -0.05], [-0.9, 0.75, -1.9], 24.0),
    head: Some(shot([0.01, 0.487, 0.03], [0.95, 0.545, 1.05], 9.6)),
    far: shot([0.0, 0.2, 0.0], [3.9, 1.1, 5.2], 24.0),
};

fn main() -> AppExit {
    helper::run("eagle", |app| {
        let path = app.world().resource::<Args>().path;
        app.add_plugins(PlumagePlugins.set(FeatherRenderPlugin { path }))
            .insert_resource(SHOTS)
            .add_systems(Startup, setup);
    })
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    commands.spawn((
        scene::bird(&assets, "eagle", 0.0),
        scene::EAGLE_BREAST,
        // It looks towards the camera.
        Posture {
            yaw: 20.0,
            ..default()
        },
        Plumage::new(assets.load("grooms/eagle.groom.ron"))
            .with_seed(args.seed)
            .with_density(args.density.unwrap_or(1.0)),
        args.quality(FeatherTransparency::default()),
        args.condition(),
    ));
    commands.spawn(scene::EAGLE_PERCH);
}
