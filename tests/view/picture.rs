//! Whole pictures on the GPU: birds appear, stand still, fail politely.

use bevy::{diagnostic::DiagnosticsStore, prelude::*};
use bevy_plumage::groom::Groom;
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage},
    view::patch_groom as groom,
    wait,
};

fn spawn(stage: &mut Stage, groom: Groom, at: Vec3) -> Entity {
    let handle = stage
        .app
        .world_mut()
        .resource_mut::<Assets<Groom>>()
        .add(groom);
    let skin = stage.spawn_skin();
    stage.app.world_mut().entity_mut(skin).insert((
        Plumage::new(handle).with_seed(3),
        Transform::from_translation(at),
    ));
    skin
}

fn counted(stage: &Stage) -> u64 {
    let store = stage.app.world().resource::<DiagnosticsStore>();
    bevy_plumage::CARD_COUNTERS
        .iter()
        .filter_map(|name| {
            let path = format!("render/feather_cards_{name}");
            store.iter().find(|d| d.path().as_str() == path)?.value()
        })
        .sum::<f64>() as u64
}

fn lit_share(picture: &[[f32; 3]]) -> f32 {
    let lit = picture
        .iter()
        .filter(|p| p.iter().sum::<f32>() > 0.02)
        .count();
    lit as f32 / picture.len() as f32
}

#[test]
fn two_birds_at_once_appear_are_counted_and_stand_still() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    spawn(&mut stage, groom(150), Vec3::new(-0.12, 0.0, 0.0));
    spawn(&mut stage, groom(90), Vec3::new(0.12, 0.0, 0.0));
    stage.settle();
    let first = stage.picture();
    let second = stage.picture();
    assert_eq!(first.len(), (SIZE * SIZE) as usize);
    assert!(lit_share(&first) > 0.2, "{}", lit_share(&first));
    assert!(first == second, "a still camera flickers");
    // Red feathers: the tint of the groom arrives.
    let sum = first
        .iter()
        .fold([0.0; 3], |s, p| [s[0] + p[0], s[1] + p[1], s[2] + p[2]]);
    assert!(sum[0] > 1.5 * sum[1] && sum[0] > 1.5 * sum[2], "{sum:?}");
    stage.frames(4);
    assert_eq!(counted(&stage), 240, "every card is classified");
    let memory = stage.app.world().resource::<PlumageMemory>().total();
    assert!(memory > 10_000 && memory < 10_000_000, "{memory}");
}

#[test]
fn zero_feathers_are_ready_and_draw_nothing() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let skin = spawn(&mut stage, groom(0), Vec3::ZERO);
    stage.settle();
    let state = stage.app.world().get::<PlumageState>(skin).unwrap();
    assert!(state.is_ready() && state.error.is_none(), "{state:?}");
    assert_eq!(state.cards, 0);
    assert!(lit_share(&stage.picture()) < 0.01);
}

#[test]
fn a_missing_groom_or_feather_is_an_error_not_a_panic() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let missing = stage
        .app
        .world()
        .resource::<AssetServer>()
        .load("grooms/no_such_bird.groom.ron");
    let bird = stage.spawn_skin();
    stage
        .app
        .world_mut()
        .entity_mut(bird)
        .insert(Plumage::new(missing));
    let mut bare = groom(10);
    bare.feathers = vec!["feathers/no_such_feather.feather.ron".into()];
    let other = spawn(&mut stage, bare, Vec3::ZERO);
    for (entity, name) in [(bird, "no_such_bird"), (other, "no_such_feather")] {
        let error = wait::until("the error", || {
            stage.frame();
            let state = stage.app.world().get::<PlumageState>(entity);
            state.and_then(|state| state.error.clone())
        });
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn point_and_spot_lights_light_feathers_and_darkness_is_dark() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    spawn(&mut stage, groom(150), Vec3::ZERO);
    let camera = stage.camera;
    let world = stage.app.world_mut();
    world
        .entity_mut(camera)
        .remove::<bevy::light::EnvironmentMapLight>();
    world.insert_resource(bevy::light::GlobalAmbientLight {
        brightness: 0.0,
        ..default()
    });
    let mut suns = world.query_filtered::<Entity, With<DirectionalLight>>();
    let suns: Vec<Entity> = suns.iter(world).collect();
    for sun in suns {
        world.entity_mut(sun).despawn();
    }
    stage.settle();
    assert!(lit_share(&stage.picture()) < 0.01, "light from nowhere");
    let place = Transform::from_xyz(0.1, 0.2, 0.5).looking_at(Vec3::ZERO, Vec3::Y);
    let point = PointLight {
        intensity: 60_000.0,
        shadow_maps_enabled: true,
        ..default()
    };
    let lamp = stage.app.world_mut().spawn((point, place)).id();
    stage.frames(3);
    let share = lit_share(&stage.picture());
    assert!(share > 0.1, "point light: {share}");
    stage.app.world_mut().entity_mut(lamp).despawn();
    let spot = SpotLight {
        intensity: 60_000.0,
        shadow_maps_enabled: true,
        ..default()
    };
    stage.app.world_mut().spawn((spot, place));
    stage.frames(3);
    let share = lit_share(&stage.picture());
    assert!(share > 0.1, "spot light: {share}");
}

#[test]
fn a_slow_dolly_does_not_pop() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    spawn(&mut stage, groom(150), Vec3::ZERO);
    stage.settle();
    let mut means = Vec::new();
    for step in 0..24 {
        let distance = 0.35 * 1.06f32.powi(step);
        let camera = stage.camera;
        let mut transform = stage.app.world_mut().get_mut::<Transform>(camera).unwrap();
        transform.translation.z = distance;
        stage.frame();
        let picture = stage.picture();
        // The middle of the picture stays on the coat.
        let half = SIZE / 2;
        let middle = |i: &usize| {
            let (x, y) = (*i as u32 % SIZE, *i as u32 / SIZE);
            x.abs_diff(half) < 6 && y.abs_diff(half) < 6
        };
        let mean = (0..picture.len())
            .filter(middle)
            .map(|i| picture[i][0])
            .sum::<f32>()
            / 121.0;
        means.push(mean);
    }
    // What a step changes, and what it changes beyond the mean of its neighbors: the light changes slowly, a pop is a step.
    let step = |two: &[f32]| (two[1] - two[0]).abs() / two[0];
    let pop = |three: &[f32]| (three[1] - 0.5 * (three[0] + three[2])).abs() / three[1];
    let largest = |of: &mut dyn Iterator<Item = f32>| of.fold(0.0, f32::max);
    let steps = largest(&mut means.windows(2).map(step));
    let pops = largest(&mut means.windows(3).map(pop));
    println!("largest change in a step {steps:.4}, beyond its neighbors {pops:.4}: {means:.3?}");
    assert!(means.iter().all(|mean| *mean > 0.05), "{means:?}");
    assert!(
        steps < 0.08 && pops < 0.037,
        "the mean of the coat jumps: {steps}, {pops}"
    );
}
