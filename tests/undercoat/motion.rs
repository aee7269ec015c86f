//! Coats in motion (tests D11 and D12 of docs/down.md): nothing swims, flickers or pops, and no ray is lost. The whole motions,
//! with their figures and a strip of pictures under `target/down_motion`:
//! `cargo test -p plumage_tests --test undercoat motion -- --ignored --nocapture`.

use bevy::{camera::ScalingMode, prelude::*};
use bevy_plumage::prelude::*;
use bevy_plumage::undercoat::UndercoatQuality;
use plumage_tests::app::Stage;
use plumage_tests::scene::{
    Picture, brightness, difference, dress, grid, settle, spawn, spawn_tube,
};
use std::ops::Range;

/// Frames of the whole motion.
const FRAMES: u32 = 120;

/// The usual steps, and as many as there may be.
fn reference() -> UndercoatSettings {
    UndercoatSettings {
        eye_steps: 64,
        light_steps: 16,
        depth_clip: 16.0,
        ..default()
    }
}

/// The tube bends by 60 degrees and turns by 40 over the whole motion.
fn pose(stage: &mut Stage, upper: Entity, frame: u32) {
    let share = frame as f32 / FRAMES as f32;
    let turn = Quat::from_rotation_z(60.0f32.to_radians() * share)
        * Quat::from_rotation_y(40.0f32.to_radians() * share);
    *stage.app.world_mut().get_mut::<Transform>(upper).unwrap() = Transform::from_rotation(turn);
    stage.frame();
}

fn film(
    stage: &mut Stage,
    coat: Entity,
    upper: Entity,
    frames: Range<u32>,
    settings: UndercoatSettings,
) -> Vec<Picture> {
    stage
        .app
        .world_mut()
        .entity_mut(coat)
        .insert(UndercoatQuality(settings));
    frames
        .map(|frame| {
            pose(stage, upper, frame);
            stage.picture()
        })
        .collect()
}

/// Second differences in time: what moves evenly cancels, what flickers stays. RMS over pixels and frames.
fn flicker(film: &[Picture]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for three in film.windows(3) {
        for ((a, b), c) in three[0].iter().zip(&three[1]).zip(&three[2]) {
            for k in 0..3 {
                sum += f64::from(a[k] - 2.0 * b[k] + c[k]).powi(2);
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Flicker of the usual steps over that of the reference on the bending tube.
fn flicker_ratio(frames: Range<u32>, strip: Option<&str>) -> Option<f64> {
    let mut stage = Stage::new()?;
    let (coat, upper) = spawn_tube(&mut stage);
    dress(&mut stage, coat);
    let usual = film(
        &mut stage,
        coat,
        upper,
        frames.clone(),
        UndercoatSettings::default(),
    );
    let truth = film(&mut stage, coat, upper, frames, reference());
    assert!(brightness(&usual[0]) > 0.005);
    if let Some(name) = strip {
        save_strip(name, &usual, stage.size);
    }
    let (ours, truth) = (flicker(&usual), flicker(&truth));
    println!(
        "bending skin, {} frames: temporal RMS {:.5}, reference {truth:.5}, ratio {:.3}",
        usual.len(),
        ours,
        ours / truth
    );
    assert!(truth > 0.0);
    Some(ours / truth)
}

/// Up to five pictures side by side.
fn save_strip(name: &str, film: &[Picture], (width, height): (u32, u32)) {
    let folder = plumage_tests::root().join("target/down_motion");
    std::fs::create_dir_all(&folder).unwrap();
    let columns = film.len().min(5) as u32;
    let strip = image::RgbImage::from_fn(columns * width, height, |x, y| {
        let last = columns.max(2) as usize - 1;
        let picture = &film[(x / width) as usize * (film.len() - 1) / last];
        let [r, g, b] = picture[(y * width + x % width) as usize];
        let srgb = Color::linear_rgb(r, g, b).to_srgba();
        image::Rgb([srgb.red, srgb.green, srgb.blue].map(|c| (c * 255.0).round() as u8))
    });
    strip.save(folder.join(format!("{name}.png"))).unwrap();
}

#[test]
fn fur_does_not_flicker_on_a_bending_skin() {
    let Some(ratio) = flicker_ratio(80..86, None) else {
        return;
    };
    assert!(ratio <= 1.5, "{ratio}");
}

#[test]
#[ignore = "minutes: the whole motion, for the figures in docs/down.md"]
fn the_whole_bending() {
    let Some(ratio) = flicker_ratio(0..FRAMES, Some("bend")) else {
        return;
    };
    assert!(ratio <= 1.5, "{ratio}");
}

/// A stage whose pixels are `size` metres wide.
fn orthographic(width: u32, size: f32) -> Option<Stage> {
    let mut stage = Stage::sized(width, width)?;
    let camera = stage.camera;
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: width as f32 * size,
            },
            ..OrthographicProjection::default_3d()
        }));
    Some(stage)
}

/// A skin that moves by whole pixels takes its picture along.
#[test]
fn fur_rides_on_the_skin_and_does_not_swim() {
    const PIXEL: f32 = 0.0025;
    let Some(mut stage) = orthographic(96, PIXEL) else {
        return;
    };
    let (coat, upper) = spawn_tube(&mut stage);
    dress(&mut stage, coat);
    let lower = stage
        .app
        .world()
        .get::<bevy::mesh::skinning::SkinnedMesh>(coat)
        .unwrap()
        .joints[0];
    let before = stage.picture();
    let moved = Transform::from_xyz(7.0 * PIXEL, 3.0 * PIXEL, 0.0);
    for joint in [lower, upper] {
        *stage.app.world_mut().get_mut::<Transform>(joint).unwrap() = moved;
    }
    stage.frame();
    let after = stage.picture();
    // Seven to the right, three up.
    let mut sum = 0.0f64;
    let mut seen = 0;
    for y in 3..96 {
        for x in 0..89 {
            let (old, new) = (before[y * 96 + x], after[(y - 3) * 96 + x + 7]);
            seen += usize::from(old[1] > 0.01);
            sum += old
                .iter()
                .zip(new)
                .map(|(a, b)| f64::from(a - b).powi(2))
                .sum::<f64>();
        }
    }
    let rms = (sum / (3.0 * seen as f64)).sqrt();
    println!("moved by whole pixels: {rms:.6} RMS over {seen} pixels");
    // Rounding of 8 bits, and of coverage at the rim.
    assert!(seen > 1000 && rms < 1.0 / 255.0, "{rms} {seen}");
    assert!(difference(&before, &after) > 0.05);
}

/// Pixels of a skin that glows below its coat.
fn holes_in(picture: &Picture) -> usize {
    picture
        .iter()
        .filter(|p| p[0] > 2.0 * p[1] + 0.05 && p[2] > 2.0 * p[1] + 0.05)
        .count()
}

#[test]
fn no_ray_is_lost_on_a_bending_skin() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let (coat, upper) = spawn_tube(&mut stage);
    {
        let world = stage.app.world_mut();
        let handle = world
            .get::<MeshMaterial3d<StandardMaterial>>(coat)
            .unwrap()
            .clone();
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let mut skin = materials.get_mut(&handle).unwrap();
        (skin.unlit, skin.base_color) = (true, Color::srgb(1.0, 0.0, 1.0));
    }
    stage.frames(3);
    let bare = holes_in(&stage.picture());
    assert!(bare > 500, "{bare}");
    dress(&mut stage, coat);
    let mut total = 0;
    for frame in [0, 30, 61, 90, 119] {
        pose(&mut stage, upper, frame);
        let picture = stage.picture();
        let holes = holes_in(&picture);
        println!("frame {frame}: {holes}");
        if holes > 0 {
            save_strip(
                &format!("holes_{frame}"),
                std::slice::from_ref(&picture),
                stage.size,
            );
        }
        total += holes;
    }
    assert_eq!(total, 0);
}

/// Mean of the picture at each thickness on the screen: the limits of the tiers move instead of the camera, so that nothing else does.
fn means(stage: &mut Stage, coat: Entity, pixels: f32, thickness: &[f32]) -> Vec<[f64; 3]> {
    thickness
        .iter()
        .map(|h| {
            let limits = UndercoatSettings::default().tier_px;
            stage
                .app
                .world_mut()
                .entity_mut(coat)
                .insert(UndercoatQuality(UndercoatSettings {
                    tier_px: limits.map(|limit| limit * pixels / h),
                    ..default()
                }));
            stage.frame();
            let picture = stage.picture();
            let mut mean = [0.0; 3];
            for pixel in &picture {
                for (m, v) in mean.iter_mut().zip(pixel) {
                    *m += f64::from(*v) / picture.len() as f64;
                }
            }
            mean
        })
        .collect()
}

/// D11 on the GPU: the mean of a patch over the transitions of a dolly that comes 3 % nearer every frame.
#[test]
fn no_tier_pops_over_a_dolly() {
    const PIXELS: f32 = 8.0;
    let mut worst = 0.0;
    for tilt in [0.0f32, 60.0] {
        let Some(mut stage) = orthographic(48, 0.012 / PIXELS) else {
            return;
        };
        let plane = grid(8, 8, (false, false), |u, v| {
            Vec3::new(0.3 * u - 0.15, 0.3 * v - 0.15, 0.0)
        });
        let turn = Quat::from_rotation_y(tilt.to_radians());
        let coat = spawn(&mut stage, plane, Transform::from_rotation(turn));
        dress(&mut stage, coat);
        for limit in UndercoatSettings::default().tier_px {
            // From one side of the transition to the other.
            let frames: Vec<f32> = (0..30).map(|i| limit * 1.45 * 0.97f32.powi(i)).collect();
            let means = means(&mut stage, coat, PIXELS, &frames);
            let step = means
                .windows(2)
                .flat_map(|pair| pair[0].iter().zip(&pair[1]))
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            println!(
                "tilt {tilt}, {limit} px: step {:.3}/255, {:.2}/255 in all of {:.0}/255",
                255.0 * step,
                255.0 * (means[0][1] - means[29][1]),
                255.0 * means[0][1],
            );
            worst = f64::max(worst, step);
        }
    }
    assert!(worst <= 1.0 / 255.0, "{worst}");
}

/// A coat whose volume changes is grown anew without a frame in which it is gone.
#[test]
fn a_new_coat_takes_over_without_a_gap() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let (coat, _) = spawn_tube(&mut stage);
    dress(&mut stage, coat);
    let full = brightness(&stage.picture());
    stage
        .app
        .world_mut()
        .get_mut::<Undercoat>(coat)
        .unwrap()
        .seed = 77;
    stage.frame();
    assert!(brightness(&stage.picture()) > 0.9 * full);
    settle(&mut stage);
    let ratio = brightness(&stage.picture()) / full;
    assert!((0.95..1.05).contains(&ratio), "{ratio}");
}
