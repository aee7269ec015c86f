//! A guide drawn with mirroring on gives its mirror image on the other side of the bird, wherever the bird stands.
use bevy::{
    math::{Quat, Vec3},
    mesh::Mesh,
    prelude::Transform,
};
use bevy_plumage::groom::*;
use bevy_plumage::inspector::{
    MirrorPlane, add_guide, guide_through, move_point, nearest_guide_point,
};
use plumage_tests::skins::*;

/// The made-up bird with bumps that leave it symmetric in one plane only, moved to a place.
fn moved(place: Transform) -> (Mesh, Bird) {
    let mut mesh = body(false);
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    if let Some(bevy::mesh::VertexAttributeValues::Float32x3(points)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        for [_, y, z] in points {
            *y += 3.0 * *z * *z + 0.2 * *z;
        }
    }
    let mesh = mesh.transformed_by(place);
    let skin = SkinMesh::from_meshes(&[&mesh], &[]).unwrap();
    let bird = Bird {
        skin,
        ..Bird::default()
    };
    (mesh, bird)
}

fn positions(mesh: &Mesh) -> Vec<Vec3> {
    let values = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
    let values = values.as_float3().unwrap();
    values.iter().map(|p| Vec3::from_array(*p)).collect()
}

/// A guide from head to tail, this many degrees from the bird's back.
fn tailwards(place: Transform) -> impl Fn(f32) -> Guide {
    move |degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let points = [0.8_f32, 0.4, 0.0, -0.4, -0.8].map(|z| {
            let unit = Vec3::new(sin, cos, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z;
            (place.transform_point(unit * HALF) * 1000.0).to_array()
        });
        Guide::new(points)
    }
}

/// Mean angle in degrees between the feathers near `place` and `lay`.
fn away(coat: &Coat, place: Vec3, lay: Vec3) -> f32 {
    let near: Vec<f32> = coat
        .cards
        .iter()
        .filter(|card| card.root.distance(place) < 0.025)
        .map(|card| card.along.angle_between(lay).to_degrees())
        .collect();
    assert!(near.len() >= 5, "{} feathers near {place}", near.len());
    near.iter().sum::<f32>() / near.len() as f32
}

#[test]
fn a_stroke_lays_the_feathers_of_both_sides() {
    let turned = Transform::from_xyz(0.3, -0.2, 0.1)
        .with_rotation(Quat::from_rotation_y(0.4) * Quat::from_rotation_z(0.1));
    for (place, flagged) in [(Transform::IDENTITY, true), (turned, false)] {
        let (mesh, bird) = moved(place);
        let plane = MirrorPlane::find(&positions(&mesh)).expect("the bird is symmetric");
        let normal = place.rotation * Vec3::X;
        assert!(plane.normal.cross(normal).length() < 0.01, "{plane:?}");
        // Up the left side, across the usual lay.
        let stroke: Vec<Vec3> = (0..30)
            .map(|i| {
                let turn = (100.0 - 2.0 * i as f32).to_radians();
                let unit = Vec3::new(turn.sin(), turn.cos(), 0.0);
                place.transform_point(unit * HALF) * 1000.0
            })
            .collect();
        let guide = guide_through(&stroke).unwrap();
        let mut both = groom();
        both.guides = [20.0, 160.0, 200.0, 340.0].map(tailwards(place)).to_vec();
        both.rows.clear();
        both.regions = vec![region("all", Select::All, 900, 0.0)];
        let mut one = both.clone();
        let in_mm = plane.scaled(1000.0);
        add_guide(&mut both, guide.clone(), Some((in_mm, 0.5)));
        add_guide(&mut one, guide, None);
        assert_eq!(both.guides[4].mirror, flagged);
        assert_eq!(both.guides.len(), if flagged { 5 } else { 6 });
        let (both_coat, one_coat) = (
            groom_bird(&bird, &both, 3, 1.0).unwrap(),
            groom_bird(&bird, &one, 3, 1.0).unwrap(),
        );
        let middle = stroke[15] / 1000.0;
        let lay = (stroke[16] - stroke[14]).normalize();
        let (other, other_lay) = (
            plane.image(middle),
            plane.image(lay) - plane.image(Vec3::ZERO),
        );
        assert!(other.distance(middle) > 0.08, "on the other side");
        assert!(away(&both_coat, middle, lay) < 25.0);
        assert!(away(&both_coat, other, other_lay) < 25.0);
        assert!(
            away(&one_coat, other, other_lay) > 60.0,
            "without mirroring the other side goes its own way"
        );

        // Moving a point from either side moves its image too.
        let point = both.guides[4].points[3].into();
        let (from, to) = (in_mm.image(point), in_mm.image(point + Vec3::Y));
        let grab = nearest_guide_point(&both, from, 0.1).unwrap();
        assert_eq!(grab.image, flagged);
        move_point(&mut both, grab, to, Some((in_mm, 0.5)));
        let now = Vec3::from_array(both.guides[4].points[3]);
        assert!(now.distance(point + Vec3::Y) < 0.5, "{now} {point}");
        let there = nearest_guide_point(&both, to, 0.1).unwrap();
        assert_eq!((there.point, there.image), (3, flagged));
    }
}
