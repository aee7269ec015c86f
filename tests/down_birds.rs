//! Down below the feathers of the real birds (study test D13): at rest it is not drawn, and nobody can tell; ruffled it shows.
//!
//! The whole birds take minutes: `cargo test --test down_birds -- --ignored --nocapture`.

mod common;
mod down_scene;

use bevy::{
    asset::AssetPath,
    gltf::GltfAssetLabel,
    prelude::*,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::{
    down::{UndercoatShell, draws_down},
    groom::PlumageGround,
    prelude::*,
};
use common::app::Stage;
use down_scene::{Picture, settle};

/// The clip that a bird rests in.
#[derive(Component)]
struct Resting(Handle<AnimationClip>);

fn rest(
    ready: On<WorldInstanceReady>,
    birds: Query<&Resting>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let Ok(resting) = birds.get(ready.entity) else {
        return;
    };
    for entity in children.iter_descendants(ready.entity) {
        if let Ok(mut player) = players.get_mut(entity) {
            let (graph, node) = AnimationGraph::from_clip(resting.0.clone());
            let graph = AnimationGraphHandle(graphs.add(graph));
            commands.entity(entity).insert(graph);
            player.play(node).pause();
        }
    }
}

/// A bird at rest, seen from the front; its entity.
fn perch(stage: &mut Stage, name: &str, eye: Vec3, target: Vec3) -> Entity {
    stage.app.add_observer(rest);
    let camera = stage.camera;
    let file = format!("birds/{name}.glb");
    let world = stage.app.world_mut();
    world.entity_mut(camera).insert((
        // Far quicker on a software adapter.
        Msaa::Off,
        Transform::from_translation(eye).looking_at(target, Vec3::Y),
        Projection::Perspective(PerspectiveProjection {
            fov: 0.45,
            near: 0.01,
            ..default()
        }),
    ));
    let mut suns = world.query::<&mut DirectionalLight>();
    for mut sun in suns.iter_mut(world) {
        sun.shadow_maps_enabled = false;
    }
    let assets = world.resource::<AssetServer>().clone();
    let label = |label: GltfAssetLabel| -> AssetPath<'static> { label.from_asset(file.clone()) };
    let bird = world
        .spawn((
            WorldAssetRoot(assets.load(label(GltfAssetLabel::Scene(0)))),
            Resting(assets.load(label(GltfAssetLabel::Animation(0)))),
            // A quarter of the feathers, twice as large: cover stays.
            Plumage::new(assets.load(format!("grooms/{name}.groom.ron"))).with_density(0.25),
            FeatherQuality {
                transparency: FeatherTransparency::Hashed,
                ..default()
            },
            Transform::IDENTITY,
        ))
        .id();
    stage.settle();
    bird
}

/// Pixels along a side of the pictures compared.
const SIDE: u32 = 48;
/// Samples of each along a side: hashed feathers have one a sample, and noise that is not the down's.
const SAMPLES: u32 = 6;

/// The picture with its samples averaged.
fn reduced(stage: &mut Stage) -> Picture {
    let samples = stage.picture();
    let weight = 1.0 / (SAMPLES * SAMPLES) as f32;
    let mut picture = vec![[0.0; 3]; (SIDE * SIDE) as usize];
    for (i, sample) in samples.iter().enumerate() {
        let (x, y) = (i as u32 % stage.size.0, i as u32 / stage.size.0);
        let pixel = &mut picture[(y / SAMPLES * SIDE + x / SAMPLES) as usize];
        for (sum, value) in pixel.iter_mut().zip(sample) {
            *sum += weight * value;
        }
    }
    picture
}

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
    let picture = reduced(stage);
    let mut states = stage.app.world_mut().query::<&UndercoatState>();
    let drawn = states
        .iter(stage.app.world())
        .map(|state| state.drawn)
        .sum();
    (picture, drawn)
}

/// Writes a picture into `target/test_failures`.
fn save(name: &str, picture: &Picture, (width, height): (u32, u32)) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/target/test_failures");
    std::fs::create_dir_all(folder).unwrap();
    let shown = image::RgbImage::from_fn(width, height, |x, y| {
        let [r, g, b] = picture[(y * width + x) as usize];
        let srgb = Color::linear_rgb(r, g, b).to_srgba();
        image::Rgb([srgb.red, srgb.green, srgb.blue].map(|c| (c * 255.0).round() as u8))
    });
    shown.save(format!("{folder}/{name}.png")).unwrap();
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

/// At rest the rule leaves out all down below four layers of feathers: no shell, no memory, no draw; and the picture is that with down
/// everywhere.
fn check_rest(stage: &mut Stage, name: &str) -> (f32, f32) {
    let (ruled, drawn) = everywhere(stage, false);
    let grown = shells(stage);
    let (all, everything) = everywhere(stage, true);
    let (largest, usual) = steps_apart(&ruled, &all);
    let mut grounds = stage.app.world_mut().query::<&PlumageGround>();
    let covers: Vec<f32> = grounds
        .iter(stage.app.world())
        .flat_map(|ground| ground.tracts.iter().map(|tract| tract.cover))
        .collect();
    let open = covers
        .iter()
        .filter(|cover| draws_down(**cover, 0.0, 1.0 / 255.0, false));
    let open = open.count();
    println!(
        "{name}: least cover {:.2}",
        covers.iter().copied().fold(f32::MAX, f32::min)
    );
    let apart: Picture = ruled
        .iter()
        .zip(&all)
        .map(|(a, b)| [0, 1, 2].map(|k: usize| (a[k] - b[k]).abs()))
        .collect();
    for (kind, picture) in [("rule", &ruled), ("all", &all), ("difference", &apart)] {
        save(&format!("down_birds_{name}_{kind}"), picture, (SIDE, SIDE));
    }
    println!(
        "{name}: {drawn} tracts drawn by the rule, {everything} without it; largest difference {largest:.2}/255, P99.9 {usual:.2}/255"
    );
    assert!(down_scene::brightness(&ruled) > 0.01, "{name}");
    assert_eq!((drawn as usize, grown), (open, open), "{name}");
    assert!(everything >= 5, "{name}: {everything}");
    (largest, usual)
}

fn assert_hidden((largest, usual): (f32, f32), name: &str) {
    assert!(usual <= 1.0, "{name}: {usual}");
    assert!(largest <= 2.0, "{name}: {largest}");
}

#[test]
#[ignore = "minutes on a software adapter"]
fn a_parrot_at_rest_needs_no_down_and_a_ruffled_one_shows_it() {
    let Some(mut stage) = Stage::sized(SIDE * SAMPLES, SIDE * SAMPLES) else {
        return;
    };
    let (eye, target) = (Vec3::new(0.75, 0.25, 0.8), Vec3::new(0.0, 0.1, 0.0));
    let bird = perch(&mut stage, "parrot", eye, target);
    let apart = check_rest(&mut stage, "parrot");

    // Ruffled, with and without its down.
    stage.app.world_mut().entity_mut(bird).insert(Ruffle {
        amount: 1.0,
        ..default()
    });
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
    for _ in 0..2 {
        stage.frame();
    }
    let bare = reduced(&mut stage);
    save("down_birds_parrot_ruffled", &ruffled, (SIDE, SIDE));
    save("down_birds_parrot_ruffled_bare", &bare, (SIDE, SIDE));
    let paler = ruffled
        .iter()
        .zip(&bare)
        .filter(|(down, skin)| down.iter().sum::<f32>() > skin.iter().sum::<f32>() + 0.03)
        .count();
    println!("parrot, ruffled: {drawn} tracts, {paler} pixels paler than without down");
    assert!(paler > 20, "{paler}");
    assert_hidden(apart, "parrot");
}

#[test]
#[ignore = "a minute: the larger bird"]
fn an_eagle_at_rest_needs_no_down() {
    let Some(mut stage) = Stage::sized(SIDE * SAMPLES, SIDE * SAMPLES) else {
        return;
    };
    let (eye, target) = (Vec3::new(1.5, 0.5, 1.6), Vec3::new(0.0, 0.2, 0.0));
    perch(&mut stage, "eagle", eye, target);
    let apart = check_rest(&mut stage, "eagle");
    assert_hidden(apart, "eagle");
}
