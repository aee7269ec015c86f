//! Feathers under an environment map: samples against many samples and against the prefiltered maps.

#[allow(dead_code)]
#[path = "../../examples/helper/sky.rs"]
mod sky;

use bevy::{light::EnvironmentMapLight, prelude::*};
use bevy_plumage::prelude::*;
use plumage_tests::app::Stage;

fn picture_with(stage: &mut Stage, card: Entity, samples: u32) -> Vec<[f32; 3]> {
    let mut quality = stage
        .app
        .world_mut()
        .get_mut::<FeatherQuality>(card)
        .unwrap();
    quality.settings.environment_samples = samples;
    stage.frames(4);
    stage.picture()
}

/// Root mean square difference over the mean of the covered pixels, and the ratio of the means.
fn difference(a: &[[f32; 3]], truth: &[[f32; 3]]) -> (f32, f32) {
    let (mut square, mut sum, mut wanted, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (a, t) in a.iter().zip(truth) {
        if t.iter().sum::<f32>() > 0.03 {
            for c in 0..3 {
                square += (a[c] - t[c]).powi(2);
                sum += a[c];
                wanted += t[c];
                count += 1.0;
            }
        }
    }
    ((square / count).sqrt() / (wanted / count), sum / wanted)
}

#[test]
fn sixteen_samples_come_near_to_many() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let (specular, diffuse) = sky::maps(sky::radiance);
    let world = stage.app.world_mut();
    let mut images = world.resource_mut::<Assets<Image>>();
    let light = EnvironmentMapLight {
        specular_map: images.add(specular),
        diffuse_map: images.add(diffuse),
        intensity: 900.0,
        ..default()
    };
    world.entity_mut(stage.camera).insert(light);
    let mut suns = world.query_filtered::<Entity, With<DirectionalLight>>();
    let suns: Vec<Entity> = suns.iter(world).collect();
    for sun in suns {
        world.entity_mut(sun).despawn();
    }
    let card = plumage_tests::feather_card::spawn_filling(
        &mut stage,
        "feathers/macaw_contour.feather.ron",
    );
    let truth = picture_with(&mut stage, card, 256);
    assert!(plumage_tests::feather_card::covered_share(&truth) > 0.15);
    let sixteen = picture_with(&mut stage, card, 16);
    let (rms, mean) = difference(&sixteen, &truth);
    let (rough, rough_mean) = difference(&picture_with(&mut stage, card, 4), &truth);
    let (smooth, smooth_mean) = difference(&picture_with(&mut stage, card, 0), &truth);
    println!(
        "16 samples: rms {rms:.3}, mean {mean:.3}; 4: {rough:.3}, {rough_mean:.3}; prefiltered: {smooth:.3}, {smooth_mean:.3}"
    );
    let even = [mean, rough_mean, smooth_mean]
        .iter()
        .all(|mean| (mean - 1.0).abs() < 0.008);
    let good = even && rms < 0.15 && rms < rough && rough < 0.72 && smooth < 0.088;
    if !good {
        plumage_tests::feather_card::save("environment_16", stage.size, &sixteen);
        plumage_tests::feather_card::save("environment_256", stage.size, &truth);
        let apart: Vec<[f32; 3]> = sixteen
            .iter()
            .zip(&truth)
            .map(|(a, b)| std::array::from_fn(|c| (a[c] - b[c]).abs()))
            .collect();
        plumage_tests::feather_card::save("environment_difference", stage.size, &apart);
    }
    assert!(good);
    assert!(
        sixteen == picture_with(&mut stage, card, 16),
        "a still camera flickers"
    );
}
