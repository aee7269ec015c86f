//! Birds from afar as everybody draws them: against the same without any class that saves work, what an eye sees of it; and against the
//! same from so near a raster that footprints hardly matter.

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
/// percentile of FLIP, of pixels and of all of it).
type View = (&'static str, f32, Difference);
/// So small that few cards are lit at vertices: a hundredth of all FLIP lies in a few pixels.
const SMALL: [View; 2] = [
    ("small", 1.0, most(0.2, 0.001, [0.02, 0.055])),
    ("smaller", 2.5, most(0.2, 0.001, [0.02, 0.05])),
];
const LARGE: [View; 2] = [
    ("hero", 1.0, most(0.3, 0.003, [0.05, 0.085])),
    ("far", 2.5, most(0.15, 0.0005, [0.01, 0.05])),
];

/// Under a second light from behind, as photographers put it: more cards lie along one of them.
const RIMMED: [View; 1] = [("rimmed", 1.0, most(0.4, 0.003, [0.05, 0.085]))];

/// Pixels of the fine raster along the side of one of the coarse one.
const FINER: u32 = 8;
/// Least and largest light of a coarse picture, share of the fine one's.
const LIGHT: [f32; 2] = [0.96, 1.02];
/// Largest mean of FLIP against the fine picture: footprints are Gaussians of a pixel, its pixels are squares.
const FLIP: f32 = 0.03;

const fn most(rmse: f32, flip: f32, [flip_99, flip_worst]: [f32; 2]) -> Difference {
    Difference {
        rmse,
        flip,
        flip_99,
        flip_worst,
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

/// The mean of `FRAMES` as shown, RGB bytes.
fn picture(stage: &mut Stage, bird: Entity, settings: FeatherSettings) -> Vec<u8> {
    averaged(stage, bird, settings, FRAMES, 1)
}

/// The mean of so many frames, a square number, each from another place in the pixel, and of squares of so many pixels: as shown, RGB bytes.
fn averaged(
    stage: &mut Stage,
    bird: Entity,
    settings: FeatherSettings,
    frames: u32,
    square: u32,
) -> Vec<u8> {
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
    let coarse = width / square;
    let mut sum = vec![Vec3::ZERO; (coarse * (height / square)) as usize];
    let side = frames.isqrt();
    for sample in 0..frames {
        let place = UVec2::new(sample % side, sample / side).as_vec2();
        let offset = (place + 0.5) / side as f32 - 0.5;
        let mut entity = stage.app.world_mut().entity_mut(camera);
        entity.insert(TemporalJitter { offset });
        let image = stage.still();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let color = image.get_color_at(x, y).unwrap();
            sum[(y / square * coarse + x / square) as usize] += color.to_linear().to_vec3();
        }
    }
    let shown = |sum: &Vec3| {
        let mean = *sum / (frames * square * square) as f32;
        let color = Color::linear_rgb(mean.x, mean.y, mean.z).to_srgba();
        color
            .to_f32_array_no_alpha()
            .map(|c| (255.0 * c).round() as u8)
    };
    sum.iter().flat_map(shown).collect()
}

/// Writes a picture into `target/test_failures`, for one who wonders.
fn save(name: &str, (width, height): (u32, u32), bytes: Vec<u8>) {
    if let Some(image) = image::RgbImage::from_raw(width, height, bytes) {
        let _ = image.save(plumage_tests::failure(&format!("{name}.png")));
    }
}

/// A light from behind the bird, two thirds as bright as the sun of the stage.
fn light_from_behind(stage: &mut Stage, eye: Vec3) {
    let world = stage.app.world_mut();
    let mut suns = world.query::<&DirectionalLight>();
    let sun = *suns.single(world).unwrap();
    let rim = DirectionalLight {
        illuminance: sun.illuminance * 2.0 / 3.0,
        ..sun
    };
    let toward = Vec3::new(-eye.z, 1.2, 0.3 * eye.x) - eye;
    let place = Transform::from_translation(toward).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((rim, place));
}

/// Holds views of a size to their bounds; the settings change something in `least` of them.
fn looks_exact((width, height): (u32, u32), views: &[View], rim: bool, least: usize) {
    let Some(mut stage) = Stage::sized(width, height) else {
        return;
    };
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    let bird = perch(&mut stage, "parrot", eye, target);
    without_shadows(&mut stage);
    if rim {
        light_from_behind(&mut stage, eye);
    }
    settle(&mut stage);
    draw(&mut stage, true);
    let mut changed = 0;
    for (name, away, most) in views {
        let place = Transform::from_translation(target + *away * (eye - target));
        let camera = stage.camera;
        let place = place.looking_at(target, Vec3::Y);
        stage.app.world_mut().entity_mut(camera).insert(place);
        let truth = picture(&mut stage, bird, exact());
        let shown = picture(&mut stage, bird, default());
        println!(
            "{name}: cards {:?}",
            plumage_tests::view::counts(&mut stage)
        );
        let lines = truth
            .chunks(3)
            .map(|c| [0, 1, 2].map(|i| f32::from(c[i]) / 255.0));
        let covered = covered_share(&lines.collect::<Vec<_>>());
        assert!(covered > 0.02, "{name}: {covered}");
        changed += usize::from(shown != truth);
        let found = difference(&truth, &shown, stage.size);
        println!("{name}: {found:.4?}, feathers on {covered:.3} of the picture");
        for (what, picture) in [("exact", truth), ("shown", shown)] {
            save(&format!("far_{name}_{what}"), stage.size, picture);
        }
        let worst = found.flip_99 <= most.flip_99 && found.flip_worst <= most.flip_worst;
        assert!(
            found.rmse <= most.rmse && found.flip <= most.flip && worst,
            "{name}: {found:?}"
        );
    }
    assert!(changed >= least, "the settings change {changed} views");
}

#[test]
fn a_bird_from_afar_looks_exact() {
    looks_exact((240, 180), &LARGE, false, 2);
}

#[test]
fn a_bird_under_two_lights_looks_exact() {
    looks_exact((240, 180), &RIMMED, true, 1);
}

#[test]
fn a_small_bird_looks_exact() {
    looks_exact((96, 72), &SMALL, false, 1);
}

/// A bird 20 pixels high: what is beside the cards is left out once, not twice.
#[test]
fn a_bird_from_afar_is_as_large_as_from_a_fine_raster() {
    let size = (48, 36);
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    let mut pictures = Vec::new();
    for (finer, frames, settings) in [(FINER, 1, exact()), (1, FRAMES, default())] {
        let Some(mut stage) = Stage::sized(size.0 * finer, size.1 * finer) else {
            return;
        };
        let bird = perch(&mut stage, "parrot", eye, target);
        without_shadows(&mut stage);
        settle(&mut stage);
        draw(&mut stage, true);
        pictures.push(averaged(&mut stage, bird, settings, frames, finer));
    }
    let light = |picture: &[u8]| -> f32 {
        let linear = |c: &u8| Srgba::gamma_function(f32::from(*c) / 255.0);
        picture.iter().map(linear).sum()
    };
    let share = light(&pictures[1]) / light(&pictures[0]);
    let found = difference(&pictures[0], &pictures[1], size);
    println!("light {share:.3} of the fine picture's, {found:.4?}");
    assert!((LIGHT[0]..LIGHT[1]).contains(&share), "{share}");
    assert!(found.flip <= FLIP, "{found:?}");
}
