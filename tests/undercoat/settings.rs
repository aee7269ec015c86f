//! Settings of coats at run time: what the materials hold, and what shells show.

use bevy::prelude::*;
use bevy_plumage::{
    prelude::*,
    undercoat::{UndercoatMaterial, UndercoatParts, UndercoatReady},
};
use plumage_tests::{
    app::Stage,
    headless::{app, wait},
    scene::{brightness, difference, down, settle, spawn, torus},
};

/// (steps to the eye, shells) of the only coat.
fn steps(app: &App) -> (u32, u32) {
    let coats = app.world().resource::<Assets<UndercoatMaterial>>();
    let coats: Vec<_> = coats.iter().map(|(_, coat)| coat.uniform).collect();
    assert_eq!(coats.len(), 1);
    (coats[0].eye_steps, coats[0].shell_count)
}

#[test]
fn settings_take_effect_and_without_a_quality_the_resource_holds() {
    let mut app = app(FeatherPath::Full);
    let down = app.world_mut().resource_mut::<Assets<Down>>().add(down());
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(torus());
    let coat = Undercoat::new(down).with_mode(UndercoatMode::Shells);
    let coat = (Mesh3d(mesh), Transform::default(), coat);
    let coat = app.world_mut().spawn(coat).id();
    wait(&mut app, "the coat", |world| {
        !world.resource::<Assets<UndercoatMaterial>>().is_empty()
    });
    assert_eq!(steps(&app), (16, 24));
    let mut settings = app.world_mut().resource_mut::<UndercoatSettings>();
    (settings.eye_steps, settings.shells) = (12, 10);
    app.update();
    assert_eq!(steps(&app), (12, 10));
    let mut own = UndercoatSettings::default();
    (own.eye_steps, own.shells) = (8, 100);
    let quality = UndercoatQuality(own);
    app.world_mut().entity_mut(coat).insert(quality);
    app.update();
    assert_eq!(steps(&app), (8, 32));
    app.world_mut()
        .entity_mut(coat)
        .remove::<UndercoatQuality>();
    app.update();
    assert_eq!(steps(&app), (12, 10));
    // Taken off and put on in one frame.
    let mut entity = app.world_mut().entity_mut(coat);
    entity.insert(quality);
    entity.remove::<UndercoatQuality>();
    entity.insert(quality);
    app.update();
    assert_eq!(steps(&app), (8, 32));
}

#[test]
fn events_tell_of_coats_that_are_ready() {
    #[derive(Resource, Default)]
    struct Ready(u32);
    let mut app = app(FeatherPath::Full);
    app.init_resource::<Ready>();
    let down = app.world_mut().resource_mut::<Assets<Down>>().add(down());
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(torus());
    let coat = (Mesh3d(mesh), Transform::default(), Undercoat::new(down));
    let coat = app.world_mut().spawn(coat).id();
    app.world_mut().entity_mut(coat).observe(
        |of: On<UndercoatReady>, mut ready: ResMut<Ready>, parts: Query<&UndercoatParts>| {
            assert_eq!(parts.get(of.entity).map(|parts| parts.len()), Ok(1));
            ready.0 += 1;
        },
    );
    wait(&mut app, "the coat", |world| {
        world.resource::<Ready>().0 == 1
    });
    // Its shell goes with the scene it hangs on: another one grows.
    let shell = app.world().get::<UndercoatParts>(coat).unwrap()[0];
    app.world_mut().entity_mut(shell).despawn();
    wait(&mut app, "the coat again", |world| {
        world.resource::<Ready>().0 == 2
    });
    let shell = app.world().get::<UndercoatParts>(coat).unwrap()[0];
    app.world_mut().entity_mut(coat).remove::<Undercoat>();
    assert!(
        app.world().get_entity(shell).is_err(),
        "a shell without a coat"
    );
    assert!(app.world().get::<UndercoatState>(coat).is_none());
    for _ in 0..5 {
        app.update();
    }
    assert_eq!(app.world().resource::<Ready>().0, 2);
}

/// Shells set while the coat is drawn look like shells set before it was grown.
#[test]
fn the_number_of_shells_can_be_changed_while_they_are_drawn() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let grow = |stage: &mut Stage, shells: u32| {
        let world = stage.app.world_mut();
        world.resource_mut::<UndercoatSettings>().shells = shells;
        let down = world.resource_mut::<Assets<Down>>().add(down());
        let entity = spawn(stage, torus(), Transform::default());
        let coat = Undercoat::new(down).with_mode(UndercoatMode::Shells);
        stage.app.world_mut().entity_mut(entity).insert(coat);
        settle(stage);
        (entity, stage.picture())
    };
    let (entity, few) = grow(&mut stage, 4);
    assert!(brightness(&few) > 0.01, "{}", brightness(&few));
    stage.app.world_mut().entity_mut(entity).despawn();
    let (_, many) = grow(&mut stage, 32);
    assert!(
        difference(&few, &many) > 0.05,
        "{}",
        difference(&few, &many)
    );
    let mut settings = stage.app.world_mut().resource_mut::<UndercoatSettings>();
    settings.shells = 4;
    for _ in 0..3 {
        stage.frame();
    }
    let set = stage.picture();
    assert!(
        difference(&few, &set) < 1.5 / 255.0,
        "{}",
        difference(&few, &set)
    );
}
