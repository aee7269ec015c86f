//! Birds come, change and go in apps that are not ours; what the camera sees of them is drawn, wherever the skeleton has put it.

mod common;

use bevy::{
    app::PluginsState,
    diagnostic::DiagnosticsStore,
    mesh::{MeshPlugin, VertexAttributeValues, skinning::SkinnedMesh},
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_plumage::{
    anatomy::AnatomyPlugin,
    groom::{
        Groom, GroomPlugin, Jitter, Placement, PlumageCards, PlumageOutput, Region, Select, Span,
        Tint,
    },
    prelude::*,
};
use common::app::{SIZE, Stage};
use std::time::{Duration, Instant};

const RED: [f32; 3] = [0.8, 0.1, 0.05];
const BLUE: [f32; 3] = [0.05, 0.1, 0.8];

fn groom(count: u32, color: [f32; 3], feather: &str) -> Groom {
    Groom {
        version: Groom::VERSION,
        name: "test".into(),
        unit: 0.001,
        feathers: vec![format!("feathers/{feather}.feather.ron")],
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
            segments: (3, 2),
            tint: Tint(color, color),
            jitter: Jitter::default(),
            down: None,
        }],
        guides: Vec::new(),
        rows: Vec::new(),
        paint: Vec::new(),
    }
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
    let joint = joint(stage, skin);
    // The skin hangs on its joint.
    *stage.app.world_mut().get_mut(joint).unwrap() = Transform::IDENTITY;
    skin
}

fn joint(stage: &Stage, skin: Entity) -> Entity {
    stage.app.world().get::<SkinnedMesh>(skin).unwrap().joints[0]
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

/// Cards of each class in the last frames, by the names of [`CARD_COUNTERS`].
fn counted(stage: &mut Stage, name: &str) -> u64 {
    for _ in 0..4 {
        stage.frame();
    }
    let path = format!("render/feather_cards_{name}");
    let store = stage.app.world().resource::<DiagnosticsStore>();
    let found = store.iter().find(|d| d.path().as_str() == path);
    found.and_then(|d| d.value()).unwrap_or(0.0) as u64
}

#[test]
fn ready_comes_before_the_first_frame_that_shows() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(120, RED, "contour"), Vec3::ZERO);
    let begun = Instant::now();
    let mut since = 0;
    loop {
        let ready = state(&stage, bird).is_ready();
        // The next frame; reading it back takes a few more, in which nothing moves.
        let shows = lit_share(&stage.picture()) > 0.2;
        if shows {
            assert!(state(&stage, bird).is_ready(), "feathers before ready");
            break;
        }
        // Mesh, material and visibility reach the renderer one frame after the other.
        since += u32::from(ready);
        assert!(since < 3, "ready, but nothing shows for {since} pictures");
        assert!(begun.elapsed() < Duration::from_secs(60));
    }
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
    let output = stage.app.world().get::<PlumageOutput>(bird).unwrap().0;
    stage.app.world_mut().entity_mut(output).despawn();
    stage.frame();
    stage.settle();
    assert!(stage.picture() == first, "cards made again look otherwise");
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
    let many: u64 = CARD_COUNTERS.iter().map(|n| counted(&mut stage, n)).sum();
    assert_eq!(many, 2_500, "every card is classified");
    edit(&mut stage, &|groom| groom.regions[0].count = 0);
    assert!(
        lit_share(&stage.picture()) < 0.01,
        "feathers that are not there"
    );
    edit(&mut stage, &|groom| groom.regions[0].count = 120);
    assert!(stage.picture() == downy, "back again it looks otherwise");
    // The feather asset changes under the bird that wears it: the same cards in another dress, without a new groom.
    let cards = stage.app.world().get::<PlumageOutput>(bird).unwrap().0;
    let worn = stage
        .app
        .world()
        .get::<PlumageCards>(cards)
        .unwrap()
        .feathers[0]
        .clone();
    let other = bevy_plumage::anatomy::presets::by_name("primary").unwrap();
    let mut feathers = stage.app.world_mut().resource_mut::<Assets<Feather>>();
    *feathers.get_mut(&worn).unwrap() = other;
    for _ in 0..4 {
        stage.frame();
    }
    assert!(
        difference(&downy, &stage.picture()) > 0.05,
        "the new feather is not worn"
    );
    assert_eq!(
        stage.app.world().get::<PlumageOutput>(bird).unwrap().0,
        cards
    );
}

#[test]
fn two_kinds_of_bird_wear_their_own() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let left = Vec3::new(-0.12, 0.0, 0.0);
    spawn(&mut stage, groom(120, RED, "contour"), left);
    let one = spawn(&mut stage, groom(300, BLUE, "lesser_covert"), -left);
    stage.settle();
    let halves = |picture: &[[f32; 3]]| {
        let half = |right: bool| {
            let side = |i: &usize| (*i as u32 % SIZE >= SIZE / 2) == right;
            let list: Vec<_> = (0..picture.len())
                .filter(side)
                .map(|i| picture[i])
                .collect();
            sum(&list)
        };
        (half(false), half(true))
    };
    let (a, b) = halves(&stage.picture());
    // Down is pale: it takes less of the tint.
    assert!(a.x > 1.5 * a.z && b.z > 1.1 * b.x, "{a} {b}");
    stage.app.world_mut().entity_mut(one).despawn();
    stage.frame();
    stage.frame();
    let (c, d) = halves(&stage.picture());
    assert!(
        (c - a).length() < 0.05 * a.length() && d.length() < 0.2 * b.length(),
        "{c} {d}"
    );
}

#[test]
fn feathers_follow_the_skeleton_to_the_edge_of_the_picture() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(160, RED, "contour"), Vec3::ZERO);
    stage.settle();
    let home = stage.picture();
    assert_eq!(
        counted(&mut stage, "culled"),
        0,
        "all of it is in the picture"
    );
    // Far from the bind pose: the joint alone goes, the camera follows. The entities of skin and cards stay behind.
    let joint = joint(&stage, bird);
    let camera = stage.camera;
    let far = Vec3::new(40.0, -25.0, 30.0);
    let shift = |stage: &mut Stage, entity: Entity, by: Vec3| {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(entity).unwrap();
        transform.translation += by;
    };
    shift(&mut stage, joint, far);
    shift(&mut stage, camera, far);
    for _ in 0..3 {
        stage.frame();
    }
    let apart = difference(&home, &stage.picture());
    assert!(apart < 0.1, "far from home the picture differs by {apart}");
    assert_eq!(counted(&mut stage, "culled"), 0);
    // Sideways, step by step: what is inside the picture is drawn, what is outside is culled.
    let mut culled = Vec::new();
    for _ in 0..5 {
        shift(&mut stage, camera, Vec3::X * 0.09);
        for _ in 0..2 {
            stage.frame();
        }
        culled.push(counted(&mut stage, "culled"));
        let picture = stage.picture();
        // The column at the edge nearest to the bird shows feathers as long as any is left.
        let edge: Vec<_> = (0..picture.len())
            .filter(|i| *i as u32 % SIZE < 4)
            .map(|i| picture[i])
            .collect();
        let visible = *culled.last().unwrap() < 120;
        assert!(
            !visible || culled.len() < 3 || lit_share(&edge) > 0.2,
            "feathers vanish at the edge: {culled:?}"
        );
    }
    assert!(
        culled.windows(2).all(|pair| pair[0] <= pair[1]),
        "{culled:?}"
    );
    assert_eq!(
        *culled.last().unwrap(),
        160,
        "nothing is in the picture: {culled:?}"
    );
    assert!(culled.iter().any(|n| (20..150).contains(n)), "{culled:?}");
}

/// A feather whose tip rides on another joint than its root: where the joints part, its cards are not where the root alone would
/// have them.
#[test]
fn a_bend_between_root_and_tip_does_not_cull() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn(&mut stage, groom(160, RED, "contour"), Vec3::ZERO);
    let world = stage.app.world_mut();
    let (skin, mesh) = {
        let bird = world.entity(bird);
        let skin = bird.get::<SkinnedMesh>().unwrap().clone();
        (skin, bird.get::<Mesh3d>().unwrap().0.clone())
    };
    let second = world
        .spawn((Transform::IDENTITY, Name::new("second"), ChildOf(bird)))
        .id();
    let mut poses =
        world.resource_mut::<Assets<bevy::mesh::skinning::SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(bevy::mesh::skinning::SkinnedMeshInverseBindposes::from(
        vec![Mat4::IDENTITY; 2],
    ));
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(&mesh).unwrap();
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!()
    };
    let low: Vec<bool> = places.iter().map(|p| p[1] < 0.0).collect();
    let of = |low: &bool| if *low { [0, 1, 0, 0] } else { [0_u16; 4] };
    let share = |low: &bool| {
        if *low {
            [0.0, 1.0, 0.0, 0.0]
        } else {
            [1.0, 0.0, 0.0, 0.0]
        }
    };
    let joints = low.iter().map(of).collect();
    let shares: Vec<[f32; 4]> = low.iter().map(share).collect();
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(joints),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, shares);
    drop(mesh);
    world.entity_mut(bird).insert(SkinnedMesh {
        inverse_bindposes,
        joints: vec![skin.joints[0], second],
    });
    stage.settle();
    // The lower half goes down, the camera after it: the roots of the upper half are outside now, their tips are not.
    let world = stage.app.world_mut();
    world.get_mut::<Transform>(second).unwrap().translation.y = -0.06;
    world
        .get_mut::<Transform>(stage.camera)
        .unwrap()
        .translation
        .y = -0.227;
    for _ in 0..3 {
        stage.frame();
    }
    let picture = stage.picture();
    let share = lit_share(&picture[..(SIZE * 7) as usize]);
    assert!(share > 0.1, "stretched feathers vanish: {share}");
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
    let contour = bevy_plumage::anatomy::presets::by_name("contour").unwrap();
    contour
        .write(&folder.0.join("feathers/contour.feather.ron"))
        .unwrap();
    let file = folder.0.join("bird.groom.ron");
    let write = |count| {
        let groom = groom(count, RED, "contour");
        std::fs::write(&file, groom.to_ron("bird").unwrap()).unwrap();
    };
    write(40);
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: folder.0.display().to_string(),
            ..default()
        },
        MeshPlugin,
    ))
    .add_plugins((AnatomyPlugin, GroomPlugin));
    app.finish();
    app.cleanup();
    let groom = app.world().resource::<AssetServer>().load("bird.groom.ron");
    let mesh = Plane3d::new(Vec3::Z, Vec2::splat(0.1)).mesh().build();
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let bird = app
        .world_mut()
        .spawn((Mesh3d(mesh), Transform::default(), Plumage::new(groom)))
        .id();
    let wait = |app: &mut App, what: &str, done: &dyn Fn(&PlumageState) -> bool| {
        let begun = Instant::now();
        while !app.world().get(bird).is_some_and(done) {
            assert!(begun.elapsed() < Duration::from_secs(60), "{what}");
            app.update();
            std::thread::sleep(Duration::from_millis(2));
        }
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
    for _ in 0..30 {
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(app.world().get::<PlumageState>(bird).unwrap().cards, 70);
    write(90);
    app.world()
        .resource::<AssetServer>()
        .reload("bird.groom.ron");
    wait(&mut app, "the mended groom", &|state| {
        state.is_ready() && state.cards == 90
    });
}

#[test]
fn an_app_without_a_gpu_grooms_and_does_not_panic() {
    let mut app = App::new();
    let settings = WgpuSettings {
        backends: None,
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .set(AssetPlugin {
                file_path: concat!(env!("CARGO_MANIFEST_DIR"), "/assets").into(),
                ..default()
            })
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(settings)),
                ..default()
            })
            .disable::<WinitPlugin>(),
    )
    .add_plugins(PlumagePlugins);
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
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
    let begun = Instant::now();
    let state = |app: &App, bird| {
        app.world()
            .get::<PlumageState>(bird)
            .cloned()
            .unwrap_or_default()
    };
    while !(state(app, ball).is_ready() && state(app, strange).error.is_some()) {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{:?}",
            state(app, ball)
        );
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(state(app, ball).cards > 300);
    let error = state(app, strange).error.unwrap();
    assert!(error.contains("triangles"), "{error}");
    assert!(!state(app, nothing).is_ready() && state(app, nothing).error.is_none());
    for _ in 0..3 {
        app.update();
    }
}
