//! Wrong input is named: missing textures, attributes that nothing reads, weights that are no numbers, too many triangles.

use bevy::{mesh::VertexAttributeValues, prelude::*};
use bevy_plumage::groom::*;
use plumage_tests::{headless, skins, wait};
use std::time::{Duration, Instant};

/// Grooms whatever `dress` puts on an entity; the sentences that came of it.
fn warnings(dress: impl FnOnce(&mut World, Entity)) -> Vec<String> {
    let mut app = headless::grooms_and_paints();
    let world = app.world_mut();
    let mesh = Plane3d::new(Vec3::Y, Vec2::splat(0.2)).mesh();
    let mesh = mesh.subdivisions(8).build();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let bird = world
        .spawn((Mesh3d(mesh), Transform::default(), Plumage::default()))
        .id();
    dress(world, bird);
    let state = |app: &App| app.world().get::<PlumageState>(bird).cloned();
    wait::until("feathers or an error", || {
        app.update();
        let state = state(&app)?;
        assert_eq!(state.error, None);
        state.is_ready().then_some(())
    });
    for _ in 0..20 {
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
    state(&app).map(|state| state.warnings).unwrap_or_default()
}

fn names(warnings: &[String], words: &[&str]) {
    let named = |text: &String| words.iter().all(|word| text.contains(word));
    assert!(warnings.iter().any(named), "{words:?} in {warnings:?}");
}

#[test]
fn a_missing_texture_is_named() {
    let found = warnings(|world, bird| {
        let texture = world.resource::<AssetServer>().load("no/such_texture.png");
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let material = materials.add(StandardMaterial {
            base_color_texture: Some(texture),
            ..default()
        });
        world.entity_mut(bird).insert(MeshMaterial3d(material));
    });
    names(&found, &["texture", "no/such_texture.png", "base color"]);
}

#[test]
fn attributes_that_nothing_reads_and_masks_out_of_range_are_named() {
    let found = warnings(|world, bird| {
        let mut density = vec![1.0; 100];
        density[7] = 9.0;
        world.entity_mut(bird).insert(SkinMasks {
            density,
            length: vec![1.0; 3],
            lift: vec![f32::NAN; 100],
            unread: vec!["_DENSTIY".into(), "COLOR_1".into()],
            ..default()
        });
    });
    names(&found, &["_DENSTIY", "COLOR_1", "left out"]);
    names(&found, &["_DENSITY", "9", "0 to 4"]);
    names(&found, &["_LIFT", "NaN", "-90 to 90"]);
    names(&found, &["_LENGTH", "3 values", "100"]);
}

#[test]
fn weights_that_are_no_numbers_are_named_and_mended() {
    let mut mesh = skins::body(false);
    let Some(VertexAttributeValues::Float32x4(weights)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_JOINT_WEIGHT)
    else {
        panic!("the body has weights")
    };
    for weights in weights.iter_mut().skip(200).take(300) {
        *weights = [f32::NAN, 0.0, 0.0, 0.0];
    }
    weights[700] = [0.0; 4];
    let skin = SkinMesh::from_meshes(&[&mesh], &[]).expect("a skin");
    let joints = skins::JOINTS.map(String::from).to_vec();
    let groom = Groom::fallback(&skin, &joints);
    let bird = Bird {
        skin,
        joints,
        ..Bird::default()
    };
    let coat = groom_bird(&bird, &groom, 1, 0.25).expect("feathers");
    let flaw = &coat.warnings[0];
    println!("{flaw}");
    for word in [
        "skin 0",
        "WEIGHTS_0 of vertex 200",
        "NaN",
        "301",
        "first joint",
    ] {
        assert!(flaw.contains(word), "{word} in {flaw}");
    }
    for card in &coat.cards {
        let sum: f32 = card.weights.iter().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{:?}", card.weights);
    }
}

#[test]
fn two_million_triangles_are_refused_at_once() {
    let mesh = Plane3d::new(Vec3::Y, Vec2::splat(0.5)).mesh();
    let mesh = mesh.subdivisions(1000).build();
    let begun = Instant::now();
    let refused = SkinMesh::from_meshes(&[&mesh], &[]).expect_err("too many triangles");
    let took = begun.elapsed();
    println!("{refused} ({took:?})");
    assert!(matches!(
        refused,
        GroomError::Value {
            field: "triangles",
            ..
        }
    ));
    let text = refused.to_string();
    for word in ["`triangles` is 2004002", "1000000", "decimate"] {
        assert!(text.contains(word), "{word} in {text}");
    }
    assert!(took < Duration::from_secs(10), "{took:?}");
}
