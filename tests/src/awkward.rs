//! Skins that are awkward to feather: several materials, open edges, joints without a clip, tiny scale, mirrored.

use crate::{app::Stage, scene, skins};
use bevy::{
    mesh::{
        Indices,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_plumage::prelude::*;
use std::f32::consts::PI;

fn part(stage: &mut Stage, owner: Entity, name: &str, mesh: Mesh, color: Color) {
    let world = stage.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let material = StandardMaterial::from(color);
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Name::new(name.to_owned()),
        Transform::default(),
        ChildOf(owner),
    ));
}

fn owner(stage: &mut Stage, transform: Transform) -> Entity {
    let bundle = (transform, Visibility::default(), Plumage::default());
    stage.app.world_mut().spawn(bundle).id()
}

/// The triangles of a mesh whose middle fulfills a condition.
fn some(mesh: &Mesh, keep: impl Fn(Vec3) -> bool) -> Mesh {
    let places = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
    let places = places.and_then(|places| places.as_float3());
    let (Some(places), Some(indices)) = (places, mesh.indices()) else {
        return mesh.clone();
    };
    let list: Vec<usize> = indices.iter().collect();
    let middle = |corners: &&[usize]| {
        let sum: Vec3 = corners.iter().map(|&i| Vec3::from_array(places[i])).sum();
        keep(sum / 3.0)
    };
    let kept = list.chunks_exact(3).filter(middle).flatten();
    let kept = kept.map(|&i| i as u32).collect();
    mesh.clone().with_inserted_indices(Indices::U32(kept))
}

/// A ball in this shape.
fn ball(shape: Vec3) -> Mesh {
    let ball = Sphere::new(1.0).mesh().uv(96, 48);
    ball.scaled_by(shape).with_computed_normals()
}

/// A gull of a white body, thin gray wings with black ends, and an orange bill: four primitives of one node.
pub fn gull(stage: &mut Stage, transform: Transform) -> Entity {
    let owner = owner(stage, transform);
    let wings = ball(Vec3::new(0.5, 0.012, 0.08)).translated_by(Vec3::Y * 0.02);
    let parts = [
        (
            "gull.white",
            ball(Vec3::new(0.07, 0.065, 0.19)),
            Color::WHITE,
        ),
        (
            "gull.gray",
            some(&wings, |p| p.x.abs() < 0.4),
            Color::srgb(0.5, 0.5, 0.55),
        ),
        (
            "gull.black",
            some(&wings, |p| p.x.abs() >= 0.4),
            Color::BLACK,
        ),
        (
            "gull.bill",
            ball(Vec3::new(0.012, 0.01, 0.03)).translated_by(Vec3::Z * 0.2),
            Color::srgb(1.0, 0.5, 0.0),
        ),
    ];
    for (name, mesh, color) in parts {
        part(stage, owner, name, mesh, color);
    }
    owner
}

/// A mantle with open edges all around: a third of a tube, wavy, closed nowhere.
pub fn mantle(stage: &mut Stage) -> Entity {
    let owner = owner(stage, Transform::default());
    let mesh = scene::grid(40, 60, (false, false), |u, v| {
        let a = (0.15 + 0.7 * u) * PI;
        let r = 0.1 + 0.01 * (12.0 * v).sin();
        Vec3::new(r * a.cos(), r * a.sin(), 0.2 - 0.4 * v)
    });
    part(stage, owner, "mantle", mesh, Color::srgb(0.4, 0.3, 0.2));
    owner
}

/// A body on joints without a clip, a thousandth of its size; its joints.
pub fn tiny(stage: &mut Stage) -> (Entity, Vec<Entity>) {
    let owner = owner(stage, Transform::from_scale(Vec3::splat(1.0e-3)));
    part(stage, owner, "body", skins::body(false), Color::WHITE);
    let world = stage.app.world_mut();
    let joints: Vec<Entity> = skins::JOINTS
        .iter()
        .zip(skins::joint_places())
        .map(|(name, place)| {
            let transform = Transform::from_translation(place);
            world
                .spawn((Name::new(*name), transform, ChildOf(owner)))
                .id()
        })
        .collect();
    let inverse_bindposes = world
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .add(SkinnedMeshInverseBindposes::from(skins::inverse_bind()));
    let mut meshes = world.query_filtered::<Entity, (With<Mesh3d>, With<ChildOf>)>();
    for mesh in meshes.iter(world).collect::<Vec<_>>() {
        world.entity_mut(mesh).insert(SkinnedMesh {
            inverse_bindposes: inverse_bindposes.clone(),
            joints: joints.clone(),
        });
    }
    (owner, joints)
}
