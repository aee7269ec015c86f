//! A feather and a bird against pictures of reference: what no other test looks for, but everybody would see.

use bevy::prelude::*;
use plumage_tests::{
    app::Stage,
    birds::perch,
    feather_card::{covered_share, spawn_filling},
    golden::{STATISTICAL, check},
    scene::{draw, settle},
};

#[test]
fn a_feather_looks_as_it_did() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    spawn_filling(&mut stage, "feathers/macaw_contour.feather.ron");
    stage.frames(4);
    let picture = stage.picture();
    assert!(
        covered_share(&picture) > 0.15,
        "{}",
        covered_share(&picture)
    );
    check("feather", &picture, stage.size, &STATISTICAL);
}

#[test]
fn a_bird_looks_as_it_did() {
    let Some(mut stage) = Stage::sized(160, 120) else {
        return;
    };
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    perch(&mut stage, "parrot", eye, target);
    settle(&mut stage);
    draw(&mut stage, true);
    stage.frames(4);
    let picture = stage.picture();
    assert!(
        covered_share(&picture) > 0.15,
        "{}",
        covered_share(&picture)
    );
    check("bird", &picture, stage.size, &STATISTICAL);
}
