//! Close to a feather a barb is a round fibre: its highlight lies on the side of the light.

use bevy::prelude::*;
use plumage_tests::app::{SIZE, Stage};

/// A picture of barbs, each a few pixels wide, lit by one sun in the direction `light`.
fn barbs(stage: &mut Stage, light: Vec3) -> Vec<[f32; 3]> {
    let world = stage.app.world_mut();
    let mut suns = world.query_filtered::<&mut Transform, With<DirectionalLight>>();
    for mut sun in suns.iter_mut(world) {
        *sun = Transform::from_translation(light).looking_at(Vec3::ZERO, Vec3::X);
    }
    stage.frames(3);
    stage.picture()
}

/// Sum of products of `a`, moved down and to the right by `step` pixels, and `b`, both less their means.
fn correlation(a: &[[f32; 3]], b: &[[f32; 3]], step: i64) -> f32 {
    let grey = |p: &[[f32; 3]]| p.iter().map(|p| p[0] + p[1] + p[2]).collect::<Vec<f32>>();
    let (a, b) = (grey(a), grey(b));
    let mean = |p: &[f32]| p.iter().sum::<f32>() / p.len() as f32;
    let (ma, mb) = (mean(&a), mean(&b));
    let (size, mut sum) = (i64::from(SIZE), 0.0);
    for y in 8..size - 8 {
        for x in 8..size - 8 {
            let (from, to) = ((y - step) * size + x - step, y * size + x);
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
    plumage_tests::feather_card::spawn_filling(&mut stage, "feathers/macaw_blue.feather.ron");
    let camera = stage.camera;
    let world = stage.app.world_mut();
    let mut lights = world.query::<&mut DirectionalLight>();
    for mut light in lights.iter_mut(world) {
        light.shadow_maps_enabled = false;
    }
    world
        .entity_mut(camera)
        .remove::<bevy::light::EnvironmentMapLight>();
    // Over the upper vane, whose barbs rise to the right.
    stage.app.world_mut().entity_mut(camera).insert((
        Transform::from_xyz(0.0, 0.05, 0.005),
        Projection::Perspective(PerspectiveProjection {
            near: 1e-3,
            ..default()
        }),
    ));
    let above = barbs(&mut stage, Vec3::new(-0.65, 0.75, 1.0));
    let below = barbs(&mut stage, Vec3::new(0.65, -0.75, 1.0));
    let contrast = correlation(&above, &above, 0);
    // Moved down and to the right, what the sun above lights up falls on what the sun below does.
    let (together, apart) = (
        correlation(&above, &below, 1),
        correlation(&above, &below, -1),
    );
    println!("highlights: {together:.1}, the other way {apart:.1}, contrast {contrast:.1}");
    let good = together > apart + 0.2 * contrast;
    if !good {
        plumage_tests::feather_card::save("barbs_above", stage.size, &above);
        plumage_tests::feather_card::save("barbs_below", stage.size, &below);
    }
    assert!(good, "{together} {apart} of {contrast}");
}
