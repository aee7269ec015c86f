//! Close to a feather a barb is a round fibre: its highlight lies on the side of the light.

mod common;
#[allow(dead_code)]
#[path = "common/feather.rs"]
mod feather_card;

use bevy::prelude::*;
use common::app::{self, SIZE, Stage};

/// A picture of barbs, each a few pixels wide, lit by one sun in the direction `light`.
fn barbs(stage: &mut Stage, light: Vec3) -> Vec<f32> {
    let world = stage.app.world_mut();
    let mut suns = world.query_filtered::<&mut Transform, With<DirectionalLight>>();
    for mut sun in suns.iter_mut(world) {
        *sun = Transform::from_translation(light).looking_at(Vec3::ZERO, Vec3::X);
    }
    for _ in 0..3 {
        stage.frame();
    }
    stage.picture().iter().map(|p| p[0] + p[1] + p[2]).collect()
}

/// Sum of products of `a`, moved down by `rows`, and `b`, both less their means.
fn correlation(a: &[f32], b: &[f32], rows: i64) -> f32 {
    let mean = |p: &[f32]| p.iter().sum::<f32>() / p.len() as f32;
    let (ma, mb) = (mean(a), mean(b));
    let (size, mut sum) = (i64::from(SIZE), 0.0);
    for y in 8..size - 8 {
        for x in 0..size {
            let (from, to) = ((y - rows) * size + x, y * size + x);
            sum += (a[from as usize] - ma) * (b[to as usize] - mb);
        }
    }
    sum
}

#[test]
fn highlights_of_barbs_lie_towards_the_light() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    feather_card::spawn_filling(&mut stage, "feathers/macaw_blue.feather.ron");
    let camera = stage.camera;
    let world = stage.app.world_mut();
    let mut lights = world.query::<&mut DirectionalLight>();
    for mut light in lights.iter_mut(world) {
        light.shadow_maps_enabled = false;
    }
    world
        .entity_mut(camera)
        .remove::<bevy::light::EnvironmentMapLight>();
    for place in [Vec3::new(0.0, 0.05, 0.0016), Vec3::new(0.0, -0.05, 0.0016)] {
        stage.app.world_mut().entity_mut(camera).insert((
            Transform::from_translation(place),
            Projection::Perspective(PerspectiveProjection {
                near: 1e-4,
                ..default()
            }),
        ));
        let up = barbs(&mut stage, Vec3::new(0.0, 1.0, 1.0));
        let down = barbs(&mut stage, Vec3::new(0.0, -1.0, 1.0));
        let contrast = correlation(&up, &up, 0);
        assert!(contrast > 0.0, "nothing to see");
        let (together, apart) = (correlation(&up, &down, 2), correlation(&up, &down, -2));
        println!("at {place}: {together:.3}, the other way {apart:.3}, contrast {contrast:.3}");
        // Moved down by two rows, what the upper sun lights up falls on what the lower sun does.
        assert!(
            together > apart + 0.02 * contrast,
            "{together} {apart} of {contrast}"
        );
    }
}
