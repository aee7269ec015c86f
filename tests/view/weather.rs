//! Wet feathers in a picture.

use bevy::{prelude::*, render::settings::WgpuSettings};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    view::{rms, spawn_patch},
};

fn mean(picture: &[[f32; 3]]) -> f32 {
    picture.iter().flatten().sum::<f32>() / picture.len() as f32
}

#[test]
fn wet_feathers_are_darker_and_dry_again() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), |_| ()) else {
        return;
    };
    let quality = FeatherQuality {
        transparency: FeatherTransparency::Hashed,
        ..default()
    };
    let bird = spawn_patch(&mut stage, 60, Vec3::ZERO, quality);
    stage.settle();
    let dry = stage.picture();
    let wet = Weather {
        wetness: 1.0,
        ..default()
    };
    let mut entity = stage.app.world_mut().entity_mut(bird);
    entity.insert(Weathering::new(wet));
    stage.settle();
    let darker = mean(&stage.picture()) / mean(&dry);
    // Red of 0.8 scatters 0.66 of what it did, the other channels about half; gaps between clumps show the ground.
    assert!((0.3..0.85).contains(&darker), "{darker}");
    stage
        .app
        .world_mut()
        .entity_mut(bird)
        .remove::<Weathering>();
    stage.settle();
    let apart = rms(&dry, &stage.picture());
    assert!(apart < 1e-3, "dried feathers differ by {apart}");
}
