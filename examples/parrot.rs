//! Two scarlet-macaw-like parrots on a branch (the scene of Chen et al. 2026, Fig. 1); with `--scene studio` about as many feathers,
//! 6,460.
//!
//! `cargo run --example parrot -- --camera closeup --time 2.9`; `--help` lists all options, F1 the keys.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    args::Scene,
    camera::{Shots, shot},
    posture::Posture,
    scene,
};

const SHOTS: Shots = Shots {
    hero: shot([0.0, -0.012, -0.08], [1.75, 0.48, 1.75], 17.5),
    closeup: shot([-0.16, 0.20, 0.05], [-0.07, 0.235, 0.165], 24.0),
    macro_: shot([-0.16, 0.20, 0.05], [-0.111, 0.219, 0.113], 20.0),
    full: shot([0.0, -0.03, -0.13], [2.42, 0.3, 1.08], 17.4),
    back: shot([0.0, -0.03, -0.1], [-0.9, 0.6, -2.3], 19.0),
    head: Some(shot([0.182, 0.288, 0.048], [0.967, 0.39, 1.138], 8.6)),
    far: shot([0.0, 0.05, -0.05], [3.9, 1.1, 5.2], 27.0),
};

fn main() -> AppExit {
    helper::run("parrot", |app| {
        let path = app.world().resource::<Args>().path;
        app.add_plugins(PlumagePlugins.set(FeatherRenderPlugin { path }))
            .insert_resource(SHOTS)
            .add_systems(Startup, setup);
    })
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    let groom = assets.load("grooms/parrot.groom.ron");
    // In the studio as many feathers as the paper's scene has.
    let density = match args.scene {
        Some(Scene::Studio) => 0.5,
        _ => 1.0,
    };
    // Position along the branch, metres; turn to the other bird, radians; start of the idle clip, seconds.
    // The second looks over to the first, which looks back over its shoulder.
    let over = Posture {
        yaw: 66.0,
        pitch: 4.0,
        roll: -9.0,
    };
    let birds = [
        (-0.17, 0.25, 0.0, over),
        (0.17, -0.2, 2.1, Posture::default()),
    ];
    for (i, (x, turn, phase, posture)) in birds.into_iter().enumerate() {
        commands.spawn((
            scene::bird(&assets, "parrot", phase),
            scene::PARROT_BREAST,
            posture,
            Plumage::new(groom.clone())
                .with_seed(args.seed + i as u64)
                .with_density(args.density.unwrap_or(density)),
            args.quality(FeatherTransparency::default()),
            args.condition(),
            Transform::from_xyz(x, 0.0, 0.0).with_rotation(Quat::from_rotation_y(turn)),
        ));
    }
    commands.spawn(scene::PARROT_PERCH);
}
