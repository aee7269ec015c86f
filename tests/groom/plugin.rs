//! The component in an app: cards come, follow the skeleton, are remade on change and go; damage is a message.

use bevy::{
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
};
use bevy_plumage::groom::*;
use plumage_tests::{headless, skins::*, wait};

fn app() -> App {
    headless::grooms(&plumage_tests::asset(""), ())
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
    wait::until(what, || {
        app.update();
        done(app.world_mut()).then_some(())
    });
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
    let first = app.world().get::<PlumageParts>(bird).expect("a card mesh")[0];
    let cards = app
        .world()
        .get::<PlumageCards>(first)
        .expect("cards")
        .clone();
    assert_eq!(cards.cards.len(), 766);
    assert_eq!(
        app.world().get::<FeathersOf>(first),
        Some(&FeathersOf(bird))
    );
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
            || app.world().get::<PlumageParts>(bird).unwrap()[0] != first
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
    let first = app.world().get::<PlumageParts>(bird).map(|parts| parts[0]);
    let plumage = app.world_mut().entity_mut(bird).take::<Plumage>();
    let plumage = plumage.expect("a plumage").with_seed(4);
    app.world_mut().entity_mut(bird).insert(plumage);
    app.update();
    assert!(!state(app.world(), bird).is_ready());
    wait(&mut app, "the other plumage", ready);
    let second = app.world().get::<PlumageParts>(bird).map(|parts| parts[0]);
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

#[test]
fn events_tell_of_plumage_that_is_ready_or_has_failed() {
    #[derive(Resource, Default)]
    struct Told(Vec<(Entity, Option<String>)>);
    let mut app = app();
    app.init_resource::<Told>();
    app.add_observer(
        |ready: On<PlumageReady>, mut told: ResMut<Told>, parts: Query<&PlumageParts>| {
            assert_eq!(parts.get(ready.entity).map(|parts| parts.len()), Ok(1));
            told.0.push((ready.entity, None));
        },
    );
    let (bird, _) = spawn(&mut app, groom());
    let mut broken = groom();
    broken.regions[0].camber = 9.0;
    let (other, _) = spawn(&mut app, broken);
    app.world_mut().entity_mut(other).observe(
        |failed: On<PlumageFailed>, mut told: ResMut<Told>| {
            told.0.push((failed.entity, Some(failed.error.clone())));
        },
    );
    wait(&mut app, "both events", |world| {
        world.resource::<Told>().0.len() == 2
    });
    let mut told = std::mem::take(&mut app.world_mut().resource_mut::<Told>().0);
    told.sort_by_key(|(entity, _)| *entity != bird);
    assert_eq!(told[0], (bird, None));
    let error = told[1].1.as_ref().expect("an error");
    assert!(
        told[1].0 == other && error.contains("regions[0].camber"),
        "{error}"
    );
    // Each once; again when the bird has changed.
    app.update();
    assert!(app.world().resource::<Told>().0.is_empty());
    app.world_mut().get_mut::<Plumage>(bird).unwrap().density = 0.5;
    wait(&mut app, "the event of the change", |world| {
        world.resource::<Told>().0 == [(bird, None)]
    });
}

/// Cards hang on the skin, which need not be below the bird that they were made for; they go with either.
#[test]
fn cards_go_with_their_bird_and_come_again_without_their_skin() {
    let mut app = app();
    let (bird, _) = spawn(&mut app, groom());
    let ready = |world: &mut World| state(world, bird).is_ready();
    wait(&mut app, "the plumage", ready);
    let parts = |world: &World| world.get::<PlumageParts>(bird).map(|parts| parts.to_vec());
    let cards = parts(app.world()).unwrap()[0];
    app.world_mut().entity_mut(cards).despawn();
    assert!(!state(app.world(), bird).is_ready());
    assert_eq!(parts(app.world()), None);
    wait(&mut app, "the plumage again", ready);
    let cards = parts(app.world()).unwrap()[0];
    app.world_mut().entity_mut(cards).remove::<ChildOf>();
    app.world_mut().entity_mut(bird).despawn();
    assert!(
        app.world().get_entity(cards).is_err(),
        "cards without a bird"
    );
    for _ in 0..3 {
        app.update();
    }
}

#[test]
fn equal_birds_share_one_coat() {
    let mut app = app();
    let world = app.world_mut();
    let mut groom = groom();
    groom.feathers = vec!["feathers/contour.feather.ron".into()];
    groom.rows.clear();
    let groom = world.resource_mut::<Assets<Groom>>().add(groom);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(body(true));
    let birds = [3, 3, 4].map(|seed| {
        let plumage = Plumage::new(groom.clone()).with_seed(seed);
        let bird = (Mesh3d(mesh.clone()), Transform::default(), plumage);
        world.spawn(bird).id()
    });
    let all_ready = |world: &mut World| birds.iter().all(|bird| state(world, *bird).is_ready());
    wait(&mut app, "the birds", all_ready);
    let coat = |app: &App, bird: usize| {
        let part = app.world().get::<PlumageParts>(birds[bird]).unwrap()[0];
        let cards = app.world().get::<PlumageCards>(part).unwrap().cards.clone();
        (cards, app.world().get::<Mesh3d>(part).unwrap().0.clone())
    };
    let shared = |app: &App, a: usize, b: usize| {
        let ((cards, mesh), (others, other)) = (coat(app, a), coat(app, b));
        assert_eq!(mesh == other, std::sync::Arc::ptr_eq(&cards, &others));
        mesh == other
    };
    assert!(shared(&app, 0, 1) && !shared(&app, 0, 2));
    let before = coat(&app, 0).0.len();
    // One more, later, gets the coat in its first frame.
    let plumage = Plumage::new(groom.clone()).with_seed(3);
    let late = (Mesh3d(mesh.clone()), Transform::default(), plumage);
    let late = app.world_mut().spawn(late).id();
    app.update();
    app.update();
    assert!(state(app.world(), late).is_ready());
    // A change of the groom is a change for all of them.
    let mut grooms = app.world_mut().resource_mut::<Assets<Groom>>();
    grooms.get_mut(&groom).unwrap().regions.truncate(1);
    app.update();
    app.update();
    wait(&mut app, "the changed birds", all_ready);
    assert!(shared(&app, 0, 1) && !shared(&app, 0, 2));
    assert!(coat(&app, 0).0.len() < before);
    // The last bird takes the coat with it.
    let id = coat(&app, 0).1.id();
    for bird in [birds[0], birds[1], late] {
        assert!(app.world().resource::<Assets<Mesh>>().contains(id));
        app.world_mut().entity_mut(bird).despawn();
        app.update();
    }
    wait(&mut app, "the end of the coat", |world| {
        !world.resource::<Assets<Mesh>>().contains(id)
    });
}

#[test]
fn an_edited_outline_gets_the_card_that_it_needs() {
    use bevy_plumage::anatomy::Feather;
    let mut app = app();
    let (bird, _) = spawn(&mut app, groom());
    wait(&mut app, "the plumage", |world| {
        state(world, bird).is_ready()
    });
    let cards = app.world().get::<PlumageParts>(bird).expect("a card mesh")[0];
    let mesh = app.world().get::<Mesh3d>(cards).expect("a mesh").id();
    let feather = app.world().get::<PlumageCards>(cards).unwrap().feathers[0].clone();
    // Mean distance of the vertices from the middle of their card, widths.
    let wide = |app: &App| {
        let mesh = app.world().resource::<Assets<Mesh>>().get(mesh).unwrap();
        let Some(bevy::mesh::VertexAttributeValues::Float32x2(uvs)) =
            mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("no coordinates")
        };
        uvs.iter().map(|uv| (uv[0] - 0.5).abs()).sum::<f32>() / uvs.len() as f32
    };
    let edit = |app: &mut App, edit: &dyn Fn(&mut Feather)| {
        let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
        let mut feather = feathers.get_mut(&feather).expect("the feather");
        edit(&mut feather);
        drop(feather);
        app.update();
        app.update();
    };
    let fitted = wide(&app);
    edit(&mut app, &|feather| {
        let vane = &mut feather.contour;
        vane.start = 0.0;
        for reach in vane.left.iter_mut().chain(&mut vane.right) {
            *reach = 1.0;
        }
    });
    let whole = wide(&app);
    assert!(whole > 1.15 * fitted, "{whole} after {fitted}");
    edit(&mut app, &|feather| {
        let vane = &mut feather.contour;
        for reach in vane.left.iter_mut().chain(&mut vane.right) {
            *reach = 0.05;
        }
    });
    let narrow = wide(&app);
    assert!(narrow < 0.8 * fitted, "{narrow} after {fitted}");
}
