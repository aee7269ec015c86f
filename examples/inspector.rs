//! A parrot with every panel of the inspector: `make inspector`. Headless, the panels are drawn into the picture.

mod helper;

use bevy::prelude::*;
use bevy_plumage::inspector::PlumageInspectorPlugin;
use clap::Parser;
use helper::{
    Args,
    camera::{Framing, Shots},
    scene,
};

fn main() {
    helper::run("inspector", |app| {
        let assets = Args::parse().assets;
        let shot = |offset: Vec3| Framing {
            target: Vec3::new(0.0, 0.0, 0.0),
            eye: offset,
            fov: 22.0,
        };
        app.insert_resource(Shots {
            hero: shot(Vec3::new(1.5, 0.4, 1.7)),
            closeup: shot(Vec3::new(0.3, 0.2, 0.5)),
            macro_: shot(Vec3::new(0.1, 0.1, 0.25)),
            full: shot(Vec3::new(2.2, 0.3, 0.6)),
            back: shot(Vec3::new(-0.9, 0.6, -2.0)),
            far: shot(Vec3::new(3.9, 1.1, 5.2)),
        })
        .add_plugins(PlumageInspectorPlugin {
            assets,
        })
        .add_systems(Startup, setup);
    });
}

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    args: Res<Args>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let density = args.density.unwrap_or(1.0);
    let bird = scene::spawn_bird(
        &mut commands,
        &assets,
        &args,
        "parrot",
        density,
        args.seed,
        0.0,
        Transform::IDENTITY,
    );
    commands.entity(bird).insert(Name::new("parrot"));
    scene::spawn_perch(
        &mut commands,
        &mut meshes,
        &mut materials,
        0.022,
        1.5,
        Vec3::ZERO,
    );
}
