//! A golden eagle, about 6,350 feathers.

mod helper;

use bevy::prelude::*;
use helper::{
    Args,
    camera::{Framing, Shots},
    scene,
};

fn main() {
    helper::run("eagle", |app| {
        app.insert_resource(Shots {
            hero: Framing {
                target: Vec3::new(0.0, 0.19, -0.06),
                eye: Vec3::new(1.75, 0.55, 1.55),
                fov: 19.5,
            },
            closeup: Framing {
                target: Vec3::new(0.02, 0.50, 0.05),
                eye: Vec3::new(0.36, 0.55, 0.40),
                fov: 22.0,
            },
            macro_: Framing {
                target: Vec3::new(0.05, 0.38, 0.08),
                eye: Vec3::new(0.08, 0.39, 0.13),
                fov: 20.0,
            },
            full: Framing {
                target: Vec3::new(0.0, 0.18, -0.1),
                eye: Vec3::new(2.3, 0.45, 0.35),
                fov: 24.0,
            },
            back: Framing {
                target: Vec3::new(0.0, 0.18, -0.05),
                eye: Vec3::new(-0.9, 0.75, -1.9),
                fov: 24.0,
            },
            far: Framing {
                target: Vec3::new(0.0, 0.2, 0.0),
                eye: Vec3::new(3.9, 1.1, 5.2),
                fov: 24.0,
            },
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
    scene::spawn_bird(
        &mut commands,
        &assets,
        &args,
        "eagle",
        args.density.unwrap_or(1.0),
        args.seed,
        0.0,
        Transform::IDENTITY,
    );
    scene::spawn_perch(
        &mut commands,
        &mut meshes,
        &mut materials,
        0.035,
        1.5,
        Vec3::ZERO,
    );
}
