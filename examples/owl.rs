//! A barn owl, about 6,600 feathers: a facial disc of feathers laid radially round the eyes, and soft fringes all over.
//!
//! `cargo run --example owl -- --camera closeup`; `--help` lists all options, F1 the keys. Its model is in the repository alone, not
//! in the package of the registry.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    camera::{Shots, shot},
    scene,
};

const SHOTS: Shots = Shots {
    hero: shot([0.0, 0.14, -0.01], [0.62, 0.26, 0.92], 20.0),
    closeup: shot([0.0, 0.25, 0.03], [0.13, 0.27, 0.40], 17.0),
    macro_: shot([0.02, 0.26, 0.055], [0.035, 0.262, 0.115], 20.0),
    full: shot([0.0, 0.13, -0.03], [1.2, 0.24, 0.2], 20.0),
    back: shot([0.0, 0.12, -0.02], [-0.45, 0.4, -1.05], 21.5),
    head: Some(shot([0.0, 0.237, 0.02], [0.34, 0.27, 0.95], 10.0)),
    far: shot([0.0, 0.12, 0.0], [2.0, 0.6, 2.6], 24.0),
};

fn main() -> AppExit {
    helper::run("owl", |app| {
        let path = app.world().resource::<Args>().path;
        app.add_plugins(PlumagePlugins.set(FeatherRenderPlugin { path }))
            .insert_resource(SHOTS)
            .add_systems(Startup, setup);
    })
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    commands.spawn((
        scene::bird(&assets, "owl", 0.0),
        scene::OWL_BREAST,
        Plumage::new(assets.load("grooms/owl.groom.ron"))
            .with_seed(args.seed)
            .with_density(args.density.unwrap_or(1.0)),
        args.quality(FeatherTransparency::default()),
        args.condition(),
    ));
    commands.spawn(scene::OWL_PERCH);
}
