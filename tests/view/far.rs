//! Birds from afar as everybody draws them, against the same without any class that saves work: what an eye sees of it.

use bevy::{color::ColorToComponents, prelude::*, render::camera::TemporalJitter};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    birds::{perch, without_shadows},
    feather_card::covered_share,
    flip::{Difference, difference},
    scene::{draw, settle},
};

/// Frames of a picture, each from another place in the pixel: with four samples each, 64 samples.
const FRAMES: u32 = 16;
/// A view: name, distance over that of the first, and what the differences may be at most (root mean square of 255; mean and 99th
/// percentile of FLIP).
const VIEWS: [(&str, f32, Difference); 2] = [
    ("hero", 1.0, most(1.0, 0.007, 0.125)),
    ("far", 2.5, most(0.3, 0.001, 0.05)),
];

const fn most(rmse: f32, flip: f32, flip_99: f32) -> Difference {
    Difference {
        rmse,
        flip,
        flip_99,
    }
}

/// All light in fragments, and the finest evaluators.
fn exact() -> FeatherSettings {
    FeatherSettings {
        light_budget: 0.0,
        error_budget: 0.0005,
        ..default()
    }
}

/// The mean of many frames as shown, RGB bytes.
fn picture(stage: &mut Stage, bird: Entity, settings: FeatherSettings) -> Vec<u8> {
    let camera = stage.camera;
    stage
        .app
        .world_mut()
        .entity_mut(bird)
        .insert(FeatherQuality {
            settings,
            ..default()
        });
    stage.frames(4);
    let (width, height) = stage.size;
    let mut sum = vec![Vec3::ZERO; (width * height) as usize];
    let side = FRAMES.isqrt();
    for sample in 0..FRAMES {
        let place = UVec2::new(sample % side, sample / side).as_vec2();
        let offset = (place + 0.5) / side as f32 - 0.5;
        let mut entity = stage.app.world_mut().entity_mut(camera);
        entity.insert(TemporalJitter { offset });
        let image = stage.still();
        for (i, sum) in (0..).zip(&mut sum) {
            let color = image.get_color_at(i % width, i / width).unwrap();
            *sum += color.to_linear().to_vec3();
        }
    }
    let shown = |sum: &Vec3| {
        let mean = *sum / FRAMES as f32;
        let color = Color::linear_rgb(mean.x, mean.y, mean.z).to_srgba();
        color
            .to_f32_array_no_alpha()
            .map(|c| (255.0 * c).round() as u8)
    };
    sum.iter().flat_map(shown).collect()
}

#[test]
fn a_bird_from_afar_looks_exact() {
    let Some(mut stage) = Stage::sized(96, 72) else {
        return;
    };
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    let bird = perch(&mut stage, "parrot", eye, target);
    without_shadows(&mut stage);
    settle(&mut stage);
    draw(&mut stage, true);
    for (name, away, most) in VIEWS {
        let place = Transform::from_translation(target + away * (eye - target));
        let camera = stage.camera;
        let place = place.looking_at(target, Vec3::Y);
        stage.app.world_mut().entity_mut(camera).insert(place);
        let truth = picture(&mut stage, bird, exact());
        let shown = picture(&mut stage, bird, default());
        let lines = truth
            .chunks(3)
            .map(|c| [0, 1, 2].map(|i| f32::from(c[i]) / 255.0));
        let covered = covered_share(&lines.collect::<Vec<_>>());
        assert!(covered > 0.02, "{name}: {covered}");
        assert_ne!(shown, truth, "{name}: the settings change nothing");
        let found = difference(&truth, &shown, stage.size);
        println!("{name}: {found:.4?}, feathers on {covered:.3} of the picture");
        assert!(
            found.rmse <= most.rmse && found.flip <= most.flip && found.flip_99 <= most.flip_99,
            "{name}: {found:?}"
        );
    }
}
