//! Whole pictures on the GPU: birds appear, stand still, fail politely.

mod common;

use bevy::{diagnostic::DiagnosticsStore, prelude::*};
use bevy_plumage::{
    groom::{Groom, Jitter, Placement, Region, Select, Span, Tint},
    prelude::*,
};
use common::app::{SIZE, Stage};

fn groom(count: u32) -> Groom {
    Groom {
        version: Groom::VERSION,
        name: "test".into(),
        unit: 0.001,
        feathers: vec!["feathers/contour.feather.ron".into()],
        regions: vec![Region {
            name: "all".into(),
            select: Select::All,
            feather: 0,
            count,
            placement: Placement::Scatter,
            length: Span(40.0, 40.0),
            width: Span(24.0, 24.0),
            lift: Span(5.0, 5.0),
            camber: 0.05,
            curl: 0.0,
            stiffness: 0.3,
            layer: 1.0,
            segments: (4, 2),
            tint: Tint([0.8, 0.2, 0.1], [0.8, 0.2, 0.1]),
            jitter: Jitter::default(),
            down: None,
        }],
        guides: Vec::new(),
        rows: Vec::new(),
        paint: Vec::new(),
    }
}

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
    CARD_COUNTERS
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
    for _ in 0..4 {
        stage.frame();
    }
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
    stage.settle();
    for (entity, name) in [(bird, "no_such_bird"), (other, "no_such_feather")] {
        let state = stage.app.world().get::<PlumageState>(entity).unwrap();
        let error = state.error.clone().unwrap_or_default();
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
    for _ in 0..3 {
        stage.frame();
    }
    let share = lit_share(&stage.picture());
    assert!(share > 0.1, "point light: {share}");
    stage.app.world_mut().entity_mut(lamp).despawn();
    let spot = SpotLight {
        intensity: 60_000.0,
        shadow_maps_enabled: true,
        ..default()
    };
    stage.app.world_mut().spawn((spot, place));
    for _ in 0..3 {
        stage.frame();
    }
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
    let mut before: Option<f32> = None;
    let mut largest = 0.0f32;
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
        if let Some(before) = before {
            largest = largest.max((mean - before).abs() / before.max(0.05));
        }
        before = Some(mean);
    }
    assert!(
        largest < 0.2,
        "the mean of the coat jumps by {largest} in a step"
    );
}
