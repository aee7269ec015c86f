//! A coat that was settled in several poses lies, in each of them, as grooming has settled it there.

use bevy::{
    mesh::{VertexAttributeValues, skinning::SkinnedMesh},
    prelude::*,
};
use bevy_plumage::{
    groom::{
        ATTRIBUTE_RAISED, Bird, JointPose, KeyPose, PlumageCards, SkinMesh, fit_cards, groom_bird,
    },
    maths::order::raised_heights,
    prelude::*,
};
use plumage_tests::{
    app::Stage,
    shipped,
    view::{frames, orthographic, part_skin, patch_groom, showing},
};

const SEED: u64 = 3;
/// How far the lower half of the skin is bent, radians.
const BEND: f32 = 0.6;

/// Places of a mesh, raised by what its second pose asks for, in units of `reach`.
fn raised(mesh: &Mesh, reach: f32) -> Mesh {
    let vectors = |attribute| match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(list)) => list.clone(),
        _ => panic!("no vectors"),
    };
    let Some(VertexAttributeValues::Uint16x4(words)) = mesh.attribute(ATTRIBUTE_RAISED) else {
        panic!("the coat has one pose");
    };
    let parts = vectors(Mesh::ATTRIBUTE_POSITION)
        .into_iter()
        .zip(vectors(Mesh::ATTRIBUTE_NORMAL))
        .zip(words);
    let places: Vec<[f32; 3]> = parts
        .map(|((place, normal), words)| {
            let height = raised_heights::<f32>(*words)[0] * reach;
            (Vec3::from(place) + Vec3::from(normal) * height).to_array()
        })
        .collect();
    let mut mesh = mesh.clone();
    mesh.remove_attribute(ATTRIBUTE_RAISED);
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, places);
    mesh
}

#[test]
fn a_bent_bird_wears_the_heights_of_its_bent_pose() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let camera = stage.camera;
    let bird = stage.spawn_skin();
    let lower = part_skin(&mut stage, bird);
    let bend = Quat::from_rotation_x(BEND);
    let mut groom = patch_groom(120);
    let bent = JointPose {
        joint: "lower".into(),
        rotation: bend.to_array(),
        ..default()
    };
    groom.poses = vec![
        KeyPose::default(),
        KeyPose {
            name: "bent".into(),
            joints: vec![bent],
        },
    ];
    let world = stage.app.world_mut();
    let skin = world.get::<SkinnedMesh>(bird).unwrap();
    let name = |joint: &Entity| world.get::<Name>(*joint).unwrap().to_string();
    let joints = skin.joints.iter().map(name).collect();
    let mesh = world.get::<Mesh3d>(bird).unwrap().0.clone();
    let meshes = world.resource::<Assets<Mesh>>();
    let skin = SkinMesh::from_meshes(&[meshes.get(&mesh).unwrap()], &[]).unwrap();
    let body = Bird {
        skin,
        joints,
        ..Bird::default()
    };
    let mut coat = groom_bird(&body, &groom, SEED, 1.0).unwrap();
    let feather = shipped::feather("contour");
    fit_cards(
        &mut coat.mesh,
        &coat.cards,
        &coat.geometry,
        &[Some(&feather)],
    );
    assert!(
        coat.worn.reach > 1.0e-4,
        "bending asks for no other heights"
    );
    let groom = world.resource_mut::<Assets<Groom>>().add(groom);
    world.entity_mut(bird).insert((
        Plumage::new(groom).with_seed(SEED),
        showing(DebugView::Card, FeatherTransparency::Hashed),
    ));
    world.entity_mut(camera).insert((orthographic(), Msaa::Off));
    stage.settle();
    let world = stage.app.world_mut();
    let mut coats = world.query_filtered::<Entity, With<PlumageCards>>();
    let cards = coats.single(world).unwrap();
    let worn = world.get::<Mesh3d>(cards).unwrap().0.clone();
    let meshes = world.resource::<Assets<Mesh>>();
    let drawn = meshes.get(&worn).unwrap().clone();
    assert_eq!(
        drawn
            .attribute(ATTRIBUTE_RAISED)
            .map(|list| list.get_bytes()),
        coat.mesh
            .attribute(ATTRIBUTE_RAISED)
            .map(|list| list.get_bytes()),
    );
    let mut joint = world.get_mut::<Transform>(lower).unwrap();
    joint.rotation = bend;
    frames(&mut stage, 4);
    let found = stage.picture();
    let mut picture_of = |mesh: Mesh| {
        let world = stage.app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        world.entity_mut(cards).insert(Mesh3d(mesh));
        stage.settle();
        frames(&mut stage, 4);
        stage.picture()
    };
    let wanted = picture_of(raised(&drawn, coat.worn.reach));
    let flat = picture_of(raised(&drawn, 0.0));
    let apart = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        let differ = |(a, b): &(&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.02);
        a.iter().zip(b).filter(differ).count() as f32 / a.len() as f32
    };
    let (off, moved) = (apart(&found, &wanted), apart(&found, &flat));
    println!("pixels that differ: {off:.4} from the twin, {moved:.4} from the first pose");
    assert!(off < 0.002, "{off} of the pixels show another feather");
    assert!(
        moved > 0.01,
        "the heights of the pose change {moved} of the pixels"
    );
}
