//! Twenty equal parrots: the same model, groom, seed and density, so that they can share their coats.
//!
//! `cargo run --example flock -- --camera back`; `--help` lists all options, F1 the keys.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    camera::{Shots, shot},
    scene::{self, Perch},
};

const ROWS: u32 = 4;
const BIRDS_PER_ROW: u32 = 5;
/// Distance between neighbors and between rows, metres.
const SPACING: f32 = 0.45;

const SHOTS: Shots = Shots {
    hero: shot([0.0, -0.1, 0.0], [2.6, 1.9, 4.4], 24.0),
    closeup: shot([0.0, 0.2, 0.7], [0.4, 0.35, 1.4], 24.0),
    macro_: shot([0.0, 0.2, 0.7], [0.1, 0.25, 0.95], 24.0),
    full: shot([0.0, -0.1, 0.0], [5.2, 1.0, 0.6], 24.0),
    back: shot([0.0, -0.1, 0.0], [-2.2, 1.9, -4.6], 24.0),
    head: None,
    far: shot([0.0, 0.0, 0.0], [8.0, 3.0, 12.0], 24.0),
};

fn main() -> AppExit {
    helper::run("flock", |app| {
        let path = app.world().resource::<Args>().path;
        app.add_plugins(PlumagePlugins.set(FeatherRenderPlugin { path }))
            .insert_resource(SHOTS)
            .add_systems(Startup, setup);
    })
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    let middle = |i: u32, count: u32| SPACING * (i as f32 - 0.5 * (count - 1) as f32);
    for row in 0..ROWS {
        let z = middle(row, ROWS);
        commands
            .spawn((Transform::from_xyz(0.0, 0.0, z), Visibility::default()))
            .with_child(Perch(0.022, SPACING * BIRDS_PER_ROW as f32, 0.024));
        for i in 0..BIRDS_PER_ROW {
            commands.spawn((
                scene::bird(&assets, "parrot", 0.7 * (row * BIRDS_PER_ROW + i) as f32),
                Plumage::new(assets.load("grooms/parrot.groom.ron"))
                    .with_seed(args.seed)
                    .with_density(args.density.unwrap_or(0.3)),
                args.quality(FeatherTransparency::default()),
                args.condition(),
                Transform::from_xyz(middle(i, BIRDS_PER_ROW), 0.0, z),
            ));
        }
    }
}
