//! A parrot in a wind that turns around it, and now and then ruffles its feathers.
//!
//! `cargo run --example wind -- --wind 6`: speed in m/s; `--help` lists all options, F1 the keys.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    camera::{Shots, shot},
    scene,
};

/// Time in which the wind turns around the bird, seconds.
const TURN: f32 = 20.0;
/// Time between two ruffles, seconds.
const PERIOD: f32 = 8.0;

const SHOTS: Shots = Shots {
    hero: shot([0.0, -0.03, -0.05], [1.3, 0.4, 1.3], 19.0),
    closeup: shot([0.0, 0.20, 0.05], [0.12, 0.26, 0.26], 24.0),
    macro_: shot([0.0, 0.12, 0.06], [0.04, 0.14, 0.16], 20.0),
    full: shot([0.0, -0.03, -0.1], [2.0, 0.2, 0.4], 19.0),
    back: shot([0.0, -0.03, -0.1], [-0.7, 0.5, -1.8], 19.0),
    head: None,
    far: shot([0.0, 0.0, 0.0], [2.6, 0.8, 3.4], 20.0),
};

fn main() -> AppExit {
    helper::run("wind", |app| {
        app.add_plugins(PlumagePlugins)
            .insert_resource(SHOTS)
            .add_systems(Startup, setup)
            .add_systems(Update, (turn_wind, ruffle));
    })
}

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    args: Res<Args>,
    mut wind: ResMut<Wind>,
) {
    if args.wind == 0.0 {
        *wind = Wind::new(Vec3::NEG_Z, 4.0);
    }
    commands.spawn((
        scene::bird(&assets, "parrot", 0.0),
        Plumage::new(assets.load("grooms/parrot.groom.ron"))
            .with_seed(args.seed)
            .with_density(args.density.unwrap_or(0.5)),
        args.quality(FeatherTransparency::default()),
        args.condition(),
    ));
    commands.spawn(scene::PARROT_PERCH);
}

/// Begins with a wind from the front.
fn turn_wind(time: Res<Time>, mut wind: ResMut<Wind>) {
    let angle = std::f32::consts::TAU * time.elapsed_secs() / TURN;
    wind.direction = Quat::from_rotation_y(angle) * Vec3::NEG_Z;
}

/// Raises the feathers for the last second of each period.
fn ruffle(time: Res<Time>, args: Res<Args>, mut birds: Query<&mut Ruffle>) {
    let left = PERIOD - time.elapsed_secs() % PERIOD;
    let raised = (std::f32::consts::PI * left).sin().max(0.0) * f32::from(u8::from(left < 1.0));
    for mut bird in &mut birds {
        let amount = args.ruffle.max(0.3 * raised);
        if bird.amount != amount {
            bird.amount = amount;
        }
    }
}
