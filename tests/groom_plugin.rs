//! The component in an app: cards come, follow the skeleton, are remade on change and go; damage is a message.

mod groom_common;

use bevy::{
    asset::AssetPlugin,
    mesh::{
        MeshPlugin,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_plumage::{anatomy::AnatomyPlugin, groom::*};
use groom_common::*;
use std::time::{Duration, Instant};

fn app() -> App {
    let mut app = App::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/assets").to_string();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: folder,
            ..default()
        },
        MeshPlugin,
    ));
    app.add_plugins((AnatomyPlugin, GroomPlugin));
    app.finish();
    app.cleanup();
    app
}

/// A bird and its joints.
fn spawn(app: &mut App, groom: Groom) -> (Entity, Vec<Entity>) {
    let mut groom = groom;
    groom.feathers = vec!["feathers/contour.feather.ron".into()];
    let groom = app.world_mut().resource_mut::<Assets<Groom>>().add(groom);
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(body(true));
    let bind = SkinnedMeshInverseBindposes::from(inverse_bind());
    let inverse_bindposes = app
        .world_mut()
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .add(bind);
    let world = app.world_mut();
    let owner = world
        .spawn((
            Transform::default(),
            Visibility::default(),
            Plumage::new(groom).with_seed(3),
        ))
        .id();
    let joints: Vec<Entity> = JOINTS
        .iter()
        .zip(joint_places())
        .map(|(name, place)| {
            world
                .spawn((
                    Name::new(*name),
                    Transform::from_translation(place),
                    ChildOf(owner),
                ))
                .id()
        })
        .collect();
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: joints.clone(),
    };
    world.spawn((Mesh3d(mesh), skin, Transform::default(), ChildOf(owner)));
    (owner, joints)
}

fn wait(app: &mut App, what: &str, mut done: impl FnMut(&mut World) -> bool) {
    let begun = Instant::now();
    while !done(app.world_mut()) {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{what} did not come"
        );
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn state(world: &World, bird: Entity) -> PlumageState {
    world.get::<PlumageState>(bird).cloned().unwrap_or_default()
}

#[test]
fn cards_come_follow_change_and_go() {
    let mut app = app();
    let (bird, joints) = spawn(&mut app, groom());
    wait(&mut app, "the plumage", |world| {
        state(world, bird).is_ready()
    });
    let first = app
        .world()
        .get::<PlumageOutput>(bird)
        .expect("a card mesh")
        .0;
    let cards = app
        .world()
        .get::<PlumageCards>(first)
        .expect("cards")
        .clone();
    assert_eq!(cards.cards.len(), 766);
    assert_eq!(cards.owner, bird);
    let skin = app
        .world()
        .get::<SkinnedMesh>(first)
        .expect("a skin")
        .clone();
    assert_eq!(skin.joints.len(), 4 + 16);
    assert_eq!(skin.joints[..4], joints[..]);
    // At rest each fan joint is at the root of its feather.
    app.update();
    let place = |app: &App, joint: usize| {
        app.world()
            .get::<GlobalTransform>(skin.joints[joint])
            .unwrap()
            .to_isometry()
    };
    let root = cards.cards[750].root;
    assert!(Vec3::from(place(&app, 4).translation).abs_diff_eq(root, 1.0e-5));
    // The whole bird moves by its own transform, the wing by its joint.
    app.world_mut()
        .get_mut::<Transform>(bird)
        .unwrap()
        .translation
        .y = 2.0;
    app.update();
    assert!(Vec3::from(place(&app, 4).translation).abs_diff_eq(root + Vec3::Y * 2.0, 1.0e-5));
    let tip = place(&app, 11);
    app.world_mut()
        .get_mut::<Transform>(joints[2])
        .unwrap()
        .rotate_local_y(0.5);
    app.update();
    assert!(place(&app, 11).rotation.angle_between(tip.rotation) > 0.49);
    // Another density: the old cards stay until the new ones are there.
    app.world_mut().get_mut::<Plumage>(bird).unwrap().density = 0.5;
    app.update();
    assert!(
        !state(app.world(), bird).is_ready()
            || app.world().get::<PlumageOutput>(bird).unwrap().0 != first
    );
    wait(&mut app, "the thinner plumage", |world| {
        state(world, bird).is_ready()
    });
    assert_eq!(state(app.world(), bird).cards, 383);
    app.update();
    assert!(
        app.world().get_entity(first).is_err(),
        "the old cards are gone"
    );
    // A change of the asset does the same.
    let handle = app.world().get::<Plumage>(bird).unwrap().groom.clone();
    app.world_mut()
        .resource_mut::<Assets<Groom>>()
        .get_mut(&handle)
        .unwrap()
        .regions
        .truncate(1);
    wait(&mut app, "the changed plumage", |world| {
        state(world, bird).cards == 208
    });
    // Without the component nothing is left.
    app.world_mut().entity_mut(bird).remove::<Plumage>();
    app.update();
    app.update();
    let mut left = app
        .world_mut()
        .query_filtered::<Entity, Or<(With<PlumageCards>, With<FanJoints>)>>();
    assert_eq!(left.iter(app.world()).count(), 0);
    assert!(app.world().get::<PlumageState>(bird).is_none());
}

#[test]
fn taken_off_and_put_on_in_one_frame() {
    let mut app = app();
    let (bird, _) = spawn(&mut app, groom());
    let ready = |world: &mut World| state(world, bird).is_ready();
    wait(&mut app, "the plumage", ready);
    let first = app
        .world()
        .get::<PlumageOutput>(bird)
        .map(|output| output.0);
    let plumage = app.world_mut().entity_mut(bird).take::<Plumage>();
    let plumage = plumage.expect("a plumage").with_seed(4);
    app.world_mut().entity_mut(bird).insert(plumage);
    app.update();
    assert!(!state(app.world(), bird).is_ready());
    wait(&mut app, "the other plumage", ready);
    let second = app
        .world()
        .get::<PlumageOutput>(bird)
        .map(|output| output.0);
    assert!(second.is_some() && second != first);
    let mut cards = app.world_mut().query::<&PlumageCards>();
    assert_eq!(cards.iter(app.world()).count(), 1);
}

#[test]
fn damage_is_a_message() {
    let mut app = app();
    let mut broken = groom();
    broken.regions[0].camber = 9.0;
    let (bird, _) = spawn(&mut app, broken);
    let missing = app
        .world()
        .resource::<AssetServer>()
        .load("grooms/nowhere.groom.ron");
    let lost = app.world_mut().spawn(Plumage::new(missing)).id();
    wait(&mut app, "the errors", |world| {
        state(world, bird).error.is_some() && state(world, lost).error.is_some()
    });
    assert!(
        state(app.world(), bird)
            .error
            .unwrap()
            .contains("regions[0].camber")
    );
    assert!(
        state(app.world(), lost)
            .error
            .unwrap()
            .contains("nowhere.groom.ron")
    );
    // Mending the asset mends the bird.
    let handle = app.world().get::<Plumage>(bird).unwrap().groom.clone();
    app.world_mut()
        .resource_mut::<Assets<Groom>>()
        .get_mut(&handle)
        .unwrap()
        .regions[0]
        .camber = 0.1;
    wait(&mut app, "the mended plumage", |world| {
        state(world, bird).is_ready()
    });
    assert!(state(app.world(), bird).error.is_none());
}
