//! Pictures that the examples accumulate from many frames, and the film that develops them.

#[path = "../../examples/helper/accumulate.rs"]
#[allow(dead_code)]
mod sampling;
#[path = "../../examples/helper/tone.rs"]
mod tone;

use bevy::{
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    prelude::*,
    render::camera::TemporalJitter,
};
use plumage_tests::app::Stage;
use sampling::{Sum, sample, through_lens};

fn picture(stage: &mut Stage, seed: u64, count: u32) -> Vec<Vec3> {
    let camera = stage.camera;
    let place = *stage.app.world().get::<Transform>(camera).unwrap();
    let mut sum = Sum::default();
    for index in 0..count {
        let at = sample(seed, index);
        let moved = through_lens(place, Vec3::ZERO, 1.0e-4 * at.lens);
        let jitter = TemporalJitter { offset: at.pixel };
        stage
            .app
            .world_mut()
            .entity_mut(camera)
            .insert((jitter, moved));
        let frame: Vec<Vec3> = stage.picture().into_iter().map(Vec3::from_array).collect();
        sum.add(&frame);
    }
    stage.app.world_mut().entity_mut(camera).insert(place);
    sum.mean().collect()
}

/// Mean square of the difference.
fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    let squares = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b));
    squares.sum::<f32>() / a.len() as f32
}

#[test]
fn more_frames_make_less_noise_and_a_seed_makes_its_picture_again() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    plumage_tests::feather_card::spawn_filling(&mut stage, "feathers/macaw_contour.feather.ron");
    let truth = picture(&mut stage, 99, 64);
    let error = |stage: &mut Stage, count: u32| {
        let of = |stage: &mut Stage, seed| apart(&picture(stage, seed, count), &truth);
        0.5 * (of(stage, 1) + of(stage, 2))
    };
    let errors = [1, 4, 16].map(|count| error(&mut stage, count));
    println!("mean square error of 1, 4, 16 frames: {errors:?}");
    assert!(errors[1] < 0.4 * errors[0], "{errors:?}");
    assert!(errors[2] < 0.4 * errors[1], "{errors:?}");
    let (first, again) = (picture(&mut stage, 5, 3), picture(&mut stage, 5, 3));
    assert!(first == again, "a seed makes two pictures");
    assert!(first != picture(&mut stage, 6, 3), "two seeds, one picture");
}

#[test]
fn samples_fill_the_pixel_the_lens_and_the_sun_evenly() {
    let all: Vec<_> = (0..256).map(|i| sample(3, i)).collect();
    let mean = |of: &dyn Fn(&sampling::Sample) -> f32| all.iter().map(of).sum::<f32>() / 256.0;
    for (name, found, wanted) in [
        ("pixel x", mean(&|s| s.pixel.x), 0.0),
        ("pixel y", mean(&|s| s.pixel.y), 0.0),
        ("lens", mean(&|s| s.lens.x), 0.0),
        ("sun", mean(&|s| s.sun.y), 0.0),
        // An even disc has the mean square radius 1/2.
        ("lens square", mean(&|s| s.lens.length_squared()), 0.5),
        ("sun square", mean(&|s| s.sun.length_squared()), 0.5),
    ] {
        assert!((found - wanted).abs() < 0.02, "{name}: {found}");
    }
    assert!(all.iter().all(|s| s.pixel.abs().max_element() <= 0.5));
}

#[test]
fn the_processor_develops_like_the_renderer() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let camera = stage.camera;
    let quad = stage
        .app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(1.0, 1.0));
    let material = stage
        .app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            unlit: true,
            ..default()
        });
    stage.app.world_mut().spawn((
        Mesh3d(quad),
        MeshMaterial3d(material.clone()),
        Transform::IDENTITY,
    ));
    for tone in [Tonemapping::KhronosPbrNeutral, Tonemapping::AcesFitted] {
        stage
            .app
            .world_mut()
            .entity_mut(camera)
            .insert((tone, DebandDither::Disabled));
        for color in [
            Vec3::new(0.39, 0.04, 0.017),
            Vec3::new(1.6, 0.3, 0.1),
            Vec3::splat(0.05),
            Vec3::new(0.7, 0.75, 2.5),
        ] {
            stage
                .app
                .world_mut()
                .resource_mut::<Assets<StandardMaterial>>()
                .get_mut(&material)
                .unwrap()
                .base_color = LinearRgba::rgb(color.x, color.y, color.z).into();
            stage.frames(3);
            let shown = stage.picture();
            let middle = shown[shown.len() / 2 + stage.size.0 as usize / 2];
            let wanted = tone::develop(color, tone, 1.0);
            // A step of 8 bits is worth up to 0.009 in linear light.
            assert!(
                Vec3::from_array(middle).distance(wanted) < 0.012,
                "{tone:?} of {color}: {middle:?}, by the processor {wanted}"
            );
        }
    }
}
