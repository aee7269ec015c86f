//! Two scarlet-macaw-like parrots on a branch, about 6,250 feathers together (the scene of Chen et al. 2026, Fig. 1).

mod helper;

use bevy::prelude::*;
use helper::{
    Args,
    camera::{Framing, Shots},
    scene,
};

fn main() {
    helper::run("parrot", |app| {
        app.insert_resource(Shots {
            hero: Framing {
                target: Vec3::new(0.0, -0.012, -0.08),
                eye: Vec3::new(1.75, 0.48, 1.75),
                fov: 17.5,
            },
            closeup: Framing {
                target: Vec3::new(-0.16, 0.20, 0.05),
                eye: Vec3::new(-0.07, 0.235, 0.165),
                fov: 24.0,
            },
            macro_: Framing {
                target: Vec3::new(-0.16, 0.20, 0.05),
                eye: Vec3::new(-0.145, 0.206, 0.092),
                fov: 20.0,
            },
            full: Framing {
                target: Vec3::new(0.0, -0.02, -0.12),
                eye: Vec3::new(2.6, 0.3, 0.6),
                fov: 17.0,
            },
            back: Framing {
                target: Vec3::new(0.0, -0.03, -0.1),
                eye: Vec3::new(-0.9, 0.6, -2.3),
                fov: 19.0,
            },
            far: Framing {
                target: Vec3::new(0.0, 0.05, -0.05),
                eye: Vec3::new(3.9, 1.1, 5.2),
                fov: 27.0,
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
    let density = args.density.unwrap_or(0.5);
    let places = [
        (Vec3::new(-0.17, 0.0, 0.0), 0.25),
        (Vec3::new(0.17, 0.0, 0.0), -0.2),
    ];
    for (i, (place, turn)) in places.into_iter().enumerate() {
        scene::spawn_bird(
            &mut commands,
            &assets,
            &args,
            "parrot",
            density,
            args.seed + i as u64,
            1.3 * i as f32,
            Transform::from_translation(place).with_rotation(Quat::from_rotation_y(turn)),
        );
    }
    scene::spawn_perch(
        &mut commands,
        &mut meshes,
        &mut materials,
        0.022,
        1.5,
        Vec3::ZERO,
    );
}
