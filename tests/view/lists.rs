//! Pictures of feathers drawn by lists of their classes are those of whole meshes, which birds with a visibility range get.

use bevy::{camera::visibility::VisibilityRange, core_pipeline::prepass::DepthPrepass, prelude::*};
use bevy_plumage::{CARD_COUNTERS, PlumageCards, prelude::*};
use plumage_tests::{
    app::Stage,
    view::{counts, frames, mean, rms, spawn_patch},
};

type Picture = Vec<[f32; 3]>;

fn set_range(stage: &mut Stage, whole: bool) {
    let world = stage.app.world_mut();
    let mut birds = world.query_filtered::<Entity, With<PlumageCards>>();
    let birds: Vec<Entity> = birds.iter(world).collect();
    for bird in birds {
        let mut bird = world.entity_mut(bird);
        if whole {
            bird.insert(VisibilityRange::abrupt(0.0, 100.0));
        } else {
            bird.remove::<VisibilityRange>();
        }
    }
    frames(stage, 3);
}

/// From a distance, by lists and by whole meshes, and the classes of the cards.
fn pictures(stage: &mut Stage, away: f32) -> ([Picture; 2], [u64; CARD_COUNTERS.len()]) {
    let place = Transform::from_xyz(0.0, 0.0, away).looking_at(Vec3::ZERO, Vec3::Y);
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(place);
    set_range(stage, false);
    let lists = stage.picture();
    let classes = counts(stage);
    set_range(stage, true);
    ([lists, stage.picture()], classes)
}

/// From near to far, so that every class is drawn; two birds, whose vertices lie behind one another; with and without samples and depth
/// first, which turns the order of the triangles round.
#[test]
fn pictures_are_those_of_whole_meshes() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    for x in [-0.03, 0.03] {
        spawn_patch(
            &mut stage,
            60,
            Vec3::new(x, 0.0, 0.0),
            FeatherQuality::default(),
        );
    }
    stage.settle();
    let camera = stage.camera;
    let near = PerspectiveProjection {
        near: 0.01,
        ..default()
    };
    let mut view = stage.app.world_mut().entity_mut(camera);
    view.insert(Projection::Perspective(near));
    let mut seen = [0; CARD_COUNTERS.len()];
    for depth_first in [false, true] {
        let mut view = stage.app.world_mut().entity_mut(camera);
        if depth_first {
            view.insert((DepthPrepass, Msaa::Off));
        } else {
            view.insert(Msaa::Sample4);
        }
        for away in [0.05, 0.1, 0.2, 0.3, 0.6, 1.0] {
            let ([lists, whole], classes) = pictures(&mut stage, away);
            for (seen, count) in seen.iter_mut().zip(classes) {
                *seen += count;
            }
            println!("{away} m, depth first {depth_first}: {classes:?}");
            assert!(mean(&whole) > 0.01, "{away} m: nothing is seen");
            assert_eq!(rms(&lists, &whole), 0.0, "{away} m: {classes:?}");
        }
    }
    // FAR and MEAN under lamps have pipelines of their own.
    let lamp = PointLight {
        intensity: 20_000.0,
        ..default()
    };
    stage
        .app
        .world_mut()
        .spawn((lamp, Transform::from_xyz(0.3, 0.5, 1.0)));
    for away in [0.1, 0.6] {
        let ([lists, whole], classes) = pictures(&mut stage, away);
        assert!(mean(&whole) > 0.01, "{away} m: nothing is seen");
        assert_eq!(rms(&lists, &whole), 0.0, "{away} m, a lamp: {classes:?}");
    }
    for class in ["far", "mean", "mixed", "lit"] {
        let at = CARD_COUNTERS.iter().position(|name| *name == class);
        let count = seen[at.expect("a class")];
        println!("{class}: {count}");
        assert!(count > 0, "no card is {class}");
    }
}
