//! More feathers where bent joints draw the skin apart.

use bevy::{
    asset::RenderAssetUsages,
    math::Vec3,
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};
use bevy_plumage::groom::*;
use plumage_tests::skins::region;

/// A strip of 0.4 by 0.04 m whose left half the first joint carries, the right half the second, with this much between them, m.
const BETWEEN: f32 = 0.08;
/// Width of the strip, m.
const WIDTH: f32 = 0.04;
/// How far the joint lies below the strip, m.
const LEVER: f32 = 0.06;

fn strip() -> Bird {
    let (wide, high) = (80_u32, 4_u32);
    let (mut positions, mut joints, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=high {
        for j in 0..=wide {
            let x = 0.4 * j as f32 / wide as f32 - 0.2;
            positions.push([x, 0.0, WIDTH * (i as f32 / high as f32 - 0.5)]);
            let second = (0.5 + x / BETWEEN).clamp(0.0, 1.0);
            joints.push([0_u16, 1, 0, 0]);
            weights.push([1.0 - second, second, 0.0, 0.0]);
        }
    }
    let mut indices = Vec::new();
    for i in 0..high {
        for j in 0..wide {
            let a = i * (wide + 1) + j;
            let b = a + wide + 1;
            indices.extend([a, b, a + 1, a + 1, b, b + 1]);
        }
    }
    let usages = RenderAssetUsages::default();
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, usages);
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    let joints = VertexAttributeValues::Uint16x4(joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    mesh.insert_indices(Indices::U32(indices));
    Bird {
        skin: SkinMesh::from_meshes(&[&mesh], &[]).expect("a sound mesh"),
        joints: ["first", "second"].map(String::from).to_vec(),
        pivots: vec![Vec3::new(-10.0, 0.0, 0.0), Vec3::new(0.0, -LEVER, 0.0)],
    }
}

fn groomed(bird: &Bird, bend: f32) -> Vec<Vec3> {
    let mut groom = Groom::default();
    let mut all = region("all", Select::All, 1500, 1.0);
    (all.length, all.width) = (Span(20.0, 20.0), Span(10.0, 10.0));
    groom.regions = vec![all];
    groom.feathers = vec!["feathers/contour.feather.ron".into()];
    groom.bend = bend;
    let coat = groom_bird(bird, &groom, 3, 1.0).unwrap();
    coat.cards.iter().map(|card| card.root).collect()
}

/// Feathers per square metre between two distances from the middle.
fn density(roots: &[Vec3], from: f32, to: f32) -> f32 {
    let inside = roots.iter().filter(|p| (from..to).contains(&p.x.abs()));
    inside.count() as f32 / (2.0 * (to - from) * WIDTH)
}

/// Bent by an angle, the skin over a joint gets longer by the angle times the distance to the joint.
#[test]
fn more_feathers_grow_where_joints_stretch_the_skin() {
    let bird = strip();
    for bend in [30.0_f32, 60.0] {
        let roots = groomed(&bird, bend);
        let ratio = density(&roots, 0.0, 0.3 * BETWEEN) / density(&roots, BETWEEN, 0.19);
        let longer = 1.0 + bend.to_radians() * LEVER / BETWEEN;
        println!("{bend} degrees: {ratio:.2} times as many, skin {longer:.2} times as long");
        assert!((ratio / longer - 1.0).abs() < 0.12, "{ratio} {longer}");
    }
    // Never more than three times as many.
    let most = groomed(&bird, 120.0);
    let near = Bird {
        pivots: vec![Vec3::NAN, Vec3::new(0.0, -10.0, 0.0)],
        ..bird.clone()
    };
    let far = groomed(&near, 120.0);
    let ratio = density(&far, 0.0, 0.3 * BETWEEN) / density(&far, BETWEEN, 0.19);
    assert!((2.6..3.2).contains(&ratio), "{ratio}");
    assert!(most.len() > 1500 && far.len() < 3 * 1500);
}

/// Without knowledge of the joints the coat is as without `bend`.
#[test]
fn unknown_joints_stretch_nothing() {
    let bird = strip();
    let unknown = Bird {
        pivots: Vec::new(),
        ..bird.clone()
    };
    assert_eq!(groomed(&unknown, 60.0), groomed(&bird, 0.0));
}
