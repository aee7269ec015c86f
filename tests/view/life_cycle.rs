//! Birds come, change and go in apps that are not ours.

use bevy::{asset::UntypedAssetId, mesh::MeshPlugin, prelude::*};
use bevy_plumage::groom::{Groom, PlumageCards, PlumageParts, Segments, Tint};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage, compiles},
    headless,
    view::{counts, frames},
    wait,
};

const RED: [f32; 3] = [0.8, 0.1, 0.05];
const BLUE: [f32; 3] = [0.05, 0.1, 0.8];

fn groom(count: u32, color: [f32; 3], feather: &str) -> Groom {
    let mut groom = plumage_tests::view::patch_groom(count);
    groom.feathers = vec![format!("feathers/{feather}.feather.ron").into()];
    groom.regions[0].segments = Segments::new(3, 2);
    groom.regions[0].tint = Tint(color, color);
    groom
}

fn add(stage: &mut Stage, groom: Groom) -> Handle<Groom> {
    let mut grooms = stage.app.world_mut().resource_mut::<Assets<Groom>>();
    grooms.add(groom)
}

fn spawn(stage: &mut Stage, groom: Groom, at: Vec3) -> Entity {
    let groom = add(stage, groom);
    let skin = stage.spawn_skin();
    let bird = (
        Plumage::new(groom).with_seed(3),
        Transform::from_translation(at),
    );
    stage.app.world_mut().entity_mut(skin).insert(bird);
    skin
}

fn state(stage: &Stage, bird: Entity) -> PlumageState {
    stage.app.world().get(bird).cloned().unwrap_or_default()
}

/// Sum of the picture over red, green, blue.
fn sum(picture: &[[f32; 3]]) -> Vec3 {
    picture
        .iter()
        .fold(Vec3::ZERO, |s, p| s + Vec3::from_array(*p))
}

fn lit_share(picture: &[[f32; 3]]) -> f32 {
    let lit = picture.iter().filter(|p| p.iter().sum::<f32>() > 0.02);
    lit.count() as f32 / picture.len() as f32
}

/// Mean difference of two pictures over their mean.
fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let apart = a
        .iter()
        .zip(b)
        .map(|(a, b)| Vec3::from_array(*a).distance(Vec3::from_array(*b)));
    apart.sum::<f32>() / sum(a).length().max(1.0e-6)
}

#[test]
fn ready_comes_before_the_first_frame_that_shows() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(120, RED, "contour"), Vec3::ZERO);
    stage.frame();
    assert!(!state(&stage, bird).is_ready(), "ready without a groom");
    let mut since = 0;
    wait::until("feathers", || {
        let ready = state(&stage, bird).is_ready();
        let has_cards = stage.app.world().get::<PlumageParts>(bird).is_some();
        assert!(ready == has_cards, "ready {ready}, cards {has_cards}");
        // The next frame; reading it back takes a few more, in which nothing moves.
        let compiles = compiles(&stage.app);
        let shows = lit_share(&stage.picture()) > 0.2;
        if shows {
            assert!(state(&stage, bird).is_ready(), "feathers before ready");
            return Some(());
        }
        // Mesh, material and visibility reach the renderer one frame after the other. Shaders load as fast as the machine lets them.
        since += u32::from(ready && !compiles);
        assert!(since < 3, "ready, but nothing shows for {since} pictures");
        None
    });
}

#[test]
fn birds_hide_go_and_come_again() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(120, RED, "contour"), Vec3::ZERO);
    stage.settle();
    let first = stage.picture();
    assert!(lit_share(&first) > 0.2);
    let set = |stage: &mut Stage, visible| {
        stage.app.world_mut().entity_mut(bird).insert(visible);
        stage.frame();
        stage.frame();
    };
    set(&mut stage, Visibility::Hidden);
    assert!(lit_share(&stage.picture()) < 0.01, "hidden feathers show");
    set(&mut stage, Visibility::Inherited);
    assert!(stage.picture() == first, "shown again it looks otherwise");
    // The cards' own mesh entity goes, as with a scene that is replaced: they come again.
    let output = stage.app.world().get::<PlumageParts>(bird).unwrap()[0];
    stage.app.world_mut().entity_mut(output).despawn();
    stage.frame();
    stage.settle();
    assert!(stage.picture() == first, "cards made again look otherwise");
    // The bird loses its plumage, and gets it again.
    let plumage = stage.app.world_mut().entity_mut(bird).take::<Plumage>();
    frames(&mut stage, 2);
    assert!(
        lit_share(&stage.picture()) < 0.01,
        "plumage taken off shows"
    );
    stage
        .app
        .world_mut()
        .entity_mut(bird)
        .insert(plumage.unwrap());
    stage.frame();
    stage.settle();
    assert!(stage.picture() == first, "put on again it looks otherwise");
    stage.app.world_mut().entity_mut(bird).despawn();
    stage.frame();
    stage.frame();
    assert!(lit_share(&stage.picture()) < 0.01, "a ghost");
    let memory = stage.app.world().resource::<PlumageMemory>().total();
    assert_eq!(memory, 0, "bytes left behind");
    let mut cards = stage.app.world_mut().query::<&PlumageCards>();
    assert_eq!(cards.iter(stage.app.world()).count(), 0);
    spawn(&mut stage, groom(120, RED, "contour"), Vec3::ZERO);
    stage.settle();
    assert!(stage.picture() == first, "the same bird looks otherwise");
}

#[test]
fn groom_and_feathers_change_at_run_time() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(120, RED, "contour"), Vec3::ZERO);
    stage.settle();
    let red = sum(&stage.picture());
    assert!(red.x > 2.0 * red.z, "{red}");
    // Another groom on the same bird.
    let blue = add(&mut stage, groom(120, BLUE, "contour"));
    stage
        .app
        .world_mut()
        .get_mut::<Plumage>(bird)
        .unwrap()
        .groom = blue.clone();
    stage.frame();
    stage.settle();
    let now = sum(&stage.picture());
    assert!(now.z > 2.0 * now.x, "{now}");
    // The groom itself is edited: other feathers, many more than any buffer was made for.
    let edit = |stage: &mut Stage, change: &dyn Fn(&mut Groom)| {
        let mut grooms = stage.app.world_mut().resource_mut::<Assets<Groom>>();
        change(&mut grooms.get_mut(&blue).unwrap());
        stage.frame();
        stage.frame();
        stage.settle();
    };
    let before = stage.picture();
    edit(&mut stage, &|groom| {
        groom.feathers = vec!["feathers/down.feather.ron".into()];
    });
    assert_eq!(state(&stage, bird).cards, 120);
    let downy = stage.picture();
    assert!(
        difference(&before, &downy) > 0.05,
        "down looks like contours"
    );
    edit(&mut stage, &|groom| groom.regions[0].count = 2_500);
    assert_eq!(state(&stage, bird).cards, 2_500);
    let many: u64 = counts(&mut stage).iter().sum();
    assert_eq!(many, 2_500, "every card is classified");
    edit(&mut stage, &|groom| groom.regions[0].count = 0);
    assert!(
        lit_share(&stage.picture()) < 0.01,
        "feathers that are not there"
    );
    edit(&mut stage, &|groom| groom.regions[0].count = 120);
    assert!(stage.picture() == downy, "back again it looks otherwise");
    // The feather asset changes under the bird that wears it: the same cards in another dress, without a new groom.
    let cards = stage.app.world().get::<PlumageParts>(bird).unwrap()[0];
    let worn = stage
        .app
        .world()
        .get::<PlumageCards>(cards)
        .unwrap()
        .feathers[0]
        .clone();
    let other = plumage_tests::shipped::feather("primary");
    let mut feathers = stage.app.world_mut().resource_mut::<Assets<Feather>>();
    *feathers.get_mut(&worn).unwrap() = other;
    stage.frames(4);
    assert!(
        difference(&downy, &stage.picture()) > 0.05,
        "the new feather is not worn"
    );
    assert_eq!(
        stage.app.world().get::<PlumageParts>(bird).unwrap()[0],
        cards
    );
}

#[test]
fn two_kinds_of_bird_wear_their_own() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let place = Vec3::new(0.12, 0.0, 0.0);
    let kinds = [
        (groom(120, RED, "contour"), -place),
        (groom(300, BLUE, "down"), place),
    ];
    // Each alone, then both: neither changes the other's half of the picture.
    let alone = kinds.clone().map(|(groom, at)| {
        let bird = spawn(&mut stage, groom, at);
        stage.settle();
        let picture = stage.picture();
        stage.app.world_mut().entity_mut(bird).despawn();
        frames(&mut stage, 2);
        picture
    });
    let half = |picture: &[[f32; 3]], right: bool| {
        let side = |i: &usize| (*i as u32 % SIZE >= SIZE / 2) == right;
        let pixels = (0..picture.len()).filter(side);
        pixels.map(|i| picture[i]).collect::<Vec<_>>()
    };
    let [one, other] = kinds.map(|(groom, at)| spawn(&mut stage, groom, at));
    stage.settle();
    let both = stage.picture();
    for (right, alone) in alone.iter().enumerate() {
        let (wanted, found) = (half(alone, right == 1), half(&both, right == 1));
        let apart = difference(&wanted, &found);
        assert!(lit_share(&wanted) > 0.1, "{}", lit_share(&wanted));
        assert!(apart < 0.05, "beside the other kind {apart} differ");
    }
    assert_ne!(state(&stage, one).cards, state(&stage, other).cards);
    stage.app.world_mut().entity_mut(other).despawn();
    frames(&mut stage, 2);
    let apart = difference(&alone[0], &stage.picture());
    assert!(apart < 0.01, "the other is gone, {apart} differ");
}

/// Frames until the server has refused the file of this asset, and the systems have seen that.
fn refused(app: &mut App, asset: UntypedAssetId) {
    wait::until("the refusal of the damaged file", || {
        app.update();
        let state = app.world().resource::<AssetServer>().load_state(asset);
        state.is_failed().then_some(())
    });
    app.update();
    app.update();
}

/// Folder of assets of its own, gone at the end.
struct Folder(std::path::PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn files_reload_while_the_app_runs() {
    let folder =
        Folder(std::env::temp_dir().join(format!("plumage_reload_{}", std::process::id())));
    std::fs::create_dir_all(folder.0.join("feathers")).unwrap();
    let contour = plumage_tests::shipped::feather("contour");
    contour
        .write(&folder.0.join("feathers/contour.feather.ron"))
        .unwrap();
    let file = folder.0.join("bird.groom.ron");
    let write = |count| {
        let groom = groom(count, RED, "contour");
        std::fs::write(&file, groom.to_ron().unwrap()).unwrap();
    };
    write(40);
    let mut app = headless::grooms(&folder.0, ());
    let groom: Handle<Groom> = app.world().resource::<AssetServer>().load("bird.groom.ron");
    let mesh = Plane3d::new(Vec3::Z, Vec2::splat(0.1)).mesh().build();
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let bird = app
        .world_mut()
        .spawn((
            Mesh3d(mesh),
            Transform::default(),
            Plumage::new(groom.clone()),
        ))
        .id();
    let wait = |app: &mut App, what: &str, done: &dyn Fn(&PlumageState) -> bool| {
        wait::until(what, || {
            app.update();
            app.world()
                .get(bird)
                .filter(|state| done(state))
                .map(|_| ())
        });
    };
    wait(&mut app, "the first groom", &|state| {
        state.is_ready() && state.cards == 40
    });
    write(70);
    app.world()
        .resource::<AssetServer>()
        .reload("bird.groom.ron");
    wait(&mut app, "the groom from the changed file", &|state| {
        state.is_ready() && state.cards == 70
    });
    // A file damaged while it is edited leaves the bird as it is; mended it is taken.
    std::fs::write(&file, "(version: 1, na").unwrap();
    app.world()
        .resource::<AssetServer>()
        .reload("bird.groom.ron");
    refused(&mut app, groom.id().untyped());
    assert_eq!(app.world().get::<PlumageState>(bird).unwrap().cards, 70);
    write(90);
    app.world()
        .resource::<AssetServer>()
        .reload("bird.groom.ron");
    wait(&mut app, "the mended groom", &|state| {
        state.is_ready() && state.cards == 90
    });
    // The feather's file: damaged nothing changes, mended the bird wears what it says.
    let cards = app.world().get::<PlumageParts>(bird).unwrap()[0];
    let worn = app.world().get::<PlumageCards>(cards).unwrap().feathers[0].clone();
    let path = folder.0.join("feathers/contour.feather.ron");
    let aspect = |app: &App| {
        let feathers = app.world().resource::<Assets<Feather>>();
        feathers.get(&worn).map(|feather| feather.aspect)
    };
    let reload = |app: &App| {
        let server = app.world().resource::<AssetServer>();
        server.reload("feathers/contour.feather.ron");
    };
    std::fs::write(&path, "(version: 1, na").unwrap();
    reload(&app);
    refused(&mut app, worn.id().untyped());
    assert_eq!(aspect(&app), Some(contour.aspect));
    let mut wider = contour.clone();
    wider.aspect *= 1.25;
    wider.write(&path).unwrap();
    reload(&app);
    wait::until("the new feather", || {
        app.update();
        (aspect(&app) == Some(wider.aspect)).then_some(())
    });
    // Not at once: a refused file is read twice by the server, so that the mended groom may come twice.
    wait(&mut app, "the bird", &|state| {
        state.is_ready() && state.cards == 90 && state.error.is_none()
    });
}

#[test]
fn an_app_without_a_gpu_grooms_and_does_not_panic() {
    let mut app = headless::app(FeatherPath::Full);
    grooms_by_itself(&mut app);
}

/// A server with neither renderer nor window plugins.
#[test]
fn an_app_of_minimal_plugins_grooms_and_does_not_panic() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        MeshPlugin,
    ))
    .add_plugins(PlumagePlugins);
    app.finish();
    app.cleanup();
    grooms_by_itself(&mut app);
}

/// An unskinned mesh without a groom gets one of its own; so do a mesh of lines its error and a bird without meshes its patience.
fn grooms_by_itself(app: &mut App) {
    let sphere = Sphere::new(0.1).mesh().ico(4).unwrap();
    let lines = Mesh::new(bevy::mesh::PrimitiveTopology::LineList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0, 0.0, 1.0]; 2]);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let (sphere, lines) = (meshes.add(sphere), meshes.add(lines));
    let mut bird = |mesh: Option<Handle<Mesh>>| {
        let mut entity = app.world_mut().spawn((
            Plumage::default(),
            Transform::default(),
            Visibility::default(),
        ));
        if let Some(mesh) = mesh {
            entity.insert(Mesh3d(mesh));
        }
        entity.id()
    };
    let (ball, strange, nothing) = (bird(Some(sphere)), bird(Some(lines)), bird(None));
    let state = |app: &App, bird| {
        app.world()
            .get::<PlumageState>(bird)
            .cloned()
            .unwrap_or_default()
    };
    wait::until("a bird without a groom and an error", || {
        app.update();
        let done = state(app, ball).is_ready() && state(app, strange).error.is_some();
        done.then_some(())
    });
    assert!(state(app, ball).cards > 300);
    let error = state(app, strange).error.unwrap();
    assert!(error.contains("triangles"), "{error}");
    assert!(!state(app, nothing).is_ready() && state(app, nothing).error.is_none());
    for _ in 0..3 {
        app.update();
    }
}
