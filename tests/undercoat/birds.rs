//! Down below the feathers of the real birds (test D13 of docs/down.md): at rest it is not drawn, and nobody can tell; ruffled it
//! shows.

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use bevy_plumage::undercoat::UndercoatShell;
use plumage_tests::scene::{Picture, settle};
use plumage_tests::{
    app::Stage,
    birds::{perch, without_shadows},
};

/// Draws the down of every tract whatever lies over it, or by the rule.
fn everywhere(stage: &mut Stage, everywhere: bool) -> (Picture, u32) {
    let usual = UndercoatSettings::default();
    stage
        .app
        .world_mut()
        .resource_mut::<UndercoatSettings>()
        .skip_error = if everywhere { 0.0 } else { usual.skip_error };
    stage.frame();
    settle(stage);
    let picture = stage.picture();
    let mut states = stage.app.world_mut().query::<&UndercoatState>();
    let drawn = states
        .iter(stage.app.world())
        .map(|state| state.drawn)
        .sum();
    (picture, drawn)
}

/// Steps of 8 bits between two pictures as they are shown: the largest, and that of all but a thousandth of the values.
fn steps_apart(a: &Picture, b: &Picture) -> (f32, f32) {
    let shown = |x: f32| Color::linear_rgb(x, x, x).to_srgba().red * 255.0;
    let mut all: Vec<f32> = a
        .iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| (shown(*a) - shown(*b)).abs())
        .collect();
    all.sort_by(f32::total_cmp);
    let rank = all.len() - 1 - all.len() / 1000;
    (all[all.len() - 1], all[rank])
}

fn shells(stage: &mut Stage) -> usize {
    let mut shells = stage.app.world_mut().query::<&UndercoatShell>();
    shells.iter(stage.app.world()).count()
}

/// At rest the rule leaves all down out: no shell, no memory, no draw; and the picture is that with down everywhere.
fn check_rest(stage: &mut Stage, name: &str) {
    let (ruled, drawn) = everywhere(stage, false);
    let grown = shells(stage);
    let (all, everything) = everywhere(stage, true);
    let (largest, usual) = steps_apart(&ruled, &all);
    println!(
        "{name}: {drawn} tracts drawn by the rule, {everything} without it; largest difference {largest:.2}/255, P99.9 {usual:.2}/255"
    );
    assert!(plumage_tests::scene::brightness(&ruled) > 0.01, "{name}");
    assert_eq!((drawn, grown), (0, 0), "{name}");
    assert!(everything >= 5, "{name}: {everything}");
    assert!(largest <= 2.0, "{name}: {largest}");
    assert!(usual <= 1.0, "{name}: {usual}");
}

#[test]
fn a_parrot_at_rest_needs_no_down_and_a_ruffled_one_shows_it() {
    let Some(mut stage) = Stage::sized(96, 96) else {
        return;
    };
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    without_shadows(&mut stage);
    let bird = perch(&mut stage, "parrot", eye, target);
    check_rest(&mut stage, "parrot");

    // Ruffled, with and without its down.
    stage.app.world_mut().entity_mut(bird).insert(Ruffle {
        amount: 1.0,
        ..default()
    });
    // Seen against the lay, up below the feathers that rise.
    let place = Transform::from_xyz(0.6, -0.2, -0.8).looking_at(target, Vec3::Y);
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(place);
    stage.frames(2);
    let (ruffled, drawn) = everywhere(&mut stage, false);
    assert!(drawn >= 5, "{drawn}");
    let mut coats = stage.app.world_mut().query::<&UndercoatShell>();
    let coats: Vec<Entity> = coats
        .iter(stage.app.world())
        .filter_map(|shell| shell.coat)
        .collect();
    for coat in coats {
        stage.app.world_mut().despawn(coat);
    }
    stage.frames(2);
    let bare = stage.picture();
    let paler = ruffled
        .iter()
        .zip(&bare)
        .filter(|(down, skin)| down.iter().sum::<f32>() > skin.iter().sum::<f32>() + 0.03)
        .count();
    println!("parrot, ruffled: {drawn} tracts, {paler} pixels paler than without down");
    assert!(paler > 20, "{paler}");
}

#[test]
fn an_eagle_at_rest_needs_no_down() {
    let Some(mut stage) = Stage::sized(96, 96) else {
        return;
    };
    let (eye, target) = (Vec3::new(1.5, 0.5, 1.6), Vec3::new(0.0, 0.2, 0.0));
    without_shadows(&mut stage);
    perch(&mut stage, "eagle", eye, target);
    check_rest(&mut stage, "eagle");
}
