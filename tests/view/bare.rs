//! Bare skin: awkward skins are covered from all sides, without a groom.

use bevy::prelude::*;
use plumage_tests::{
    app::Stage,
    awkward,
    bare::{Bare, PHASES, Subject, count, grown, paint},
};
use std::ops::Range;

/// Largest share of bare skin.
const ALLOWED: f32 = 0.005;
/// Side of a picture, pixels.
const SIDE: u32 = 128;

/// Grows, paints and counts; `pose` moves it to each of `phases`, 0..1.
fn measure(
    name: &str,
    stage: &mut Stage,
    owner: Entity,
    phases: Range<u32>,
    mut pose: impl FnMut(&mut Stage, f32),
) -> Bare {
    let subject = Subject::still(owner);
    grown(stage, owner).unwrap_or_else(|error| panic!("{name}: {error}"));
    paint(stage, owner);
    let mut bare = Bare::default();
    for phase in phases {
        pose(stage, phase as f32 / PHASES as f32);
        stage.frames(2);
        let folder = std::env::var_os("PLUMAGE_BARE").map(|folder| {
            let folder = std::path::Path::new(&folder).join(format!("{name}_{phase}"));
            let _ = std::fs::create_dir_all(&folder);
            folder
        });
        count(stage, &subject, folder.as_ref(), &mut bare);
    }
    println!(
        "{name}: {:.2} % bare, at most {:.2} % in one picture",
        100.0 * bare.share(),
        100.0 * bare.worst
    );
    bare
}

/// Without animation, what turns is the whole.
fn turn(owner: Entity) -> impl FnMut(&mut Stage, f32) {
    move |stage, phase| {
        if let Some(mut place) = stage.app.world_mut().get_mut::<Transform>(owner) {
            place.rotation = Quat::from_rotation_y(0.5 * phase);
        }
    }
}

fn awkward_skins(phases: Range<u32>) {
    let mut shares = Vec::new();
    let Some(mut stage) = Stage::sized(SIDE, SIDE) else {
        return;
    };
    // A mirrored instance of several materials.
    let mirrored = Transform::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let owner = awkward::gull(&mut stage, mirrored);
    shares.push((
        "gull",
        measure("gull", &mut stage, owner, phases.clone(), turn(owner)),
    ));
    let Some(mut stage) = Stage::sized(SIDE, SIDE) else {
        return;
    };
    let owner = awkward::mantle(&mut stage);
    let mantle = measure("mantle", &mut stage, owner, phases.clone(), turn(owner));
    shares.push(("mantle", mantle));
    let Some(mut stage) = Stage::sized(SIDE, SIDE) else {
        return;
    };
    let (owner, joints) = awkward::tiny(&mut stage);
    let bend = |stage: &mut Stage, phase: f32| {
        if let Some(mut joint) = stage.app.world_mut().get_mut::<Transform>(joints[1]) {
            joint.rotation = Quat::from_rotation_x(0.6 * phase);
        }
    };
    shares.push(("tiny", measure("tiny", &mut stage, owner, phases, bend)));
    for (name, bare) in shares {
        assert!(bare.feathered > 10_000, "{name}: {bare:?}");
        assert!(bare.share() <= ALLOWED, "{name}: {bare:?}");
    }
}

/// In the last phase: turned furthest, and bent.
#[test]
fn awkward_skins_are_covered() {
    awkward_skins(PHASES - 1..PHASES);
}

#[test]
#[ignore = "minutes: all phases, for the figures in docs/your_own_mesh.md"]
fn awkward_skins_are_covered_in_all_phases() {
    awkward_skins(0..PHASES);
}
