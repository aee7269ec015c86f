//! Furred meshes on a stage, and what is measured in their pictures.

use crate::{app::Stage, golden, wait};
use bevy::{
    asset::RenderAssetUsages,
    mesh::{
        Indices, PrimitiveTopology, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_plumage::prelude::*;
use std::f32::consts::TAU;

/// Linear RGB, row by row.
pub type Picture = Vec<[f32; 3]>;

/// A coat that can be seen: 12 mm thick on skins of 10 to 20 cm.
pub fn down() -> Down {
    let mut down = Down::default();
    down.thickness_mm = 12.0;
    down.clump_mm = 3.0;
    down.tile = [32, 32, 16];
    down
}

/// A surface of `columns` by `rows` cells, closed where `wrap` says so.
pub fn grid(columns: u32, rows: u32, wrap: (bool, bool), place: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let (w, h) = (columns + u32::from(!wrap.0), rows + u32::from(!wrap.1));
    let mut positions = Vec::new();
    for j in 0..h {
        for i in 0..w {
            positions.push(place(i as f32 / columns as f32, j as f32 / rows as f32).to_array());
        }
    }
    let mut indices = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let at = |i: u32, j: u32| (j % h) * w + i % w;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            indices.extend([a, b, c, a, c, d]);
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_indices(Indices::U32(indices))
    .with_computed_normals()
}

/// 8 and 3.5 cm.
pub fn torus() -> Mesh {
    grid(32, 16, (true, true), |u, v| {
        let (a, b) = (u * TAU, v * TAU);
        let r = 0.08 + 0.035 * b.cos();
        Vec3::new(r * a.cos(), r * a.sin(), 0.035 * b.sin())
    })
}

/// A square of 8 x 8 cells without four of them.
pub fn holes() -> Mesh {
    let mut mesh = grid(8, 8, (false, false), |u, v| {
        Vec3::new(0.2 * u - 0.1, 0.2 * v - 0.1, 0.0)
    });
    let Some(Indices::U32(indices)) = mesh.indices() else {
        unreachable!()
    };
    let kept: Vec<u32> = indices
        .chunks_exact(6)
        .enumerate()
        .filter(|(cell, _)| ![18, 21, 42, 45].contains(cell))
        .flat_map(|(_, corners)| corners.iter().copied())
        .collect();
    mesh.insert_indices(Indices::U32(kept));
    mesh
}

/// A tube of 3 cm, 20 cm long; its upper half hangs on the second joint.
pub fn tube() -> Mesh {
    let mut mesh = grid(16, 24, (true, false), |u, v| {
        let a = u * TAU;
        Vec3::new(0.03 * a.cos(), 0.2 * v - 0.1, -0.03 * a.sin())
    });
    let weights: Vec<[f32; 4]> = mesh
        .attribute(Mesh::ATTRIBUTE_POSITION)
        .and_then(|positions| positions.as_float3())
        .unwrap()
        .iter()
        .map(|p| {
            let upper = (0.5 + p[1] / 0.08).clamp(0.0, 1.0);
            [1.0 - upper, upper, 0.0, 0.0]
        })
        .collect();
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(vec![[0, 1, 0, 0]; weights.len()]),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    mesh
}

/// The mesh with a dark, dull skin of its own.
pub fn spawn(stage: &mut Stage, mesh: Mesh, transform: Transform) -> Entity {
    let world = stage.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let skin = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            base_color: Color::srgb(0.1, 0.05, 0.05),
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..default()
        });
    world
        .spawn((Mesh3d(mesh), MeshMaterial3d(skin), transform))
        .id()
}

/// Puts a coat on, and waits for it.
pub fn dress(stage: &mut Stage, entity: Entity) {
    let down = stage
        .app
        .world_mut()
        .resource_mut::<Assets<Down>>()
        .add(down());
    stage
        .app
        .world_mut()
        .entity_mut(entity)
        .insert(Undercoat::new(down));
    settle(stage);
}

/// Whether the camera draws: frames of a large scene that only waits are not worth their seconds.
pub fn draw(stage: &mut Stage, draws: bool) {
    let mut camera = stage.app.world_mut().entity_mut(stage.camera);
    if let Some(mut camera) = camera.get_mut::<Camera>() {
        camera.is_active = draws;
    }
}

/// Frames until every coat is grown.
pub fn settle(stage: &mut Stage) {
    draw(stage, false);
    wait::until("the coat", || {
        stage.frame();
        let mut states = stage.app.world_mut().query::<&UndercoatState>();
        let states: Vec<_> = states.iter(stage.app.world()).cloned().collect();
        assert!(
            states.iter().all(|state| state.error.is_none()),
            "{states:?}"
        );
        states.iter().all(UndercoatState::is_ready).then_some(())
    });
    draw(stage, true);
    stage.frames(4);
}

/// Mean of all channels.
pub fn brightness(picture: &Picture) -> f32 {
    picture.iter().flatten().sum::<f32>() / (3 * picture.len()) as f32
}

/// Pixels brighter than that.
pub fn covered(picture: &Picture, least: f32) -> usize {
    picture
        .iter()
        .filter(|pixel| pixel.iter().sum::<f32>() > 3.0 * least)
        .count()
}

/// Largest of all channels.
pub fn difference(a: &Picture, b: &Picture) -> f32 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

/// A tube on two joints; returns the upper one.
pub fn spawn_tube(stage: &mut Stage) -> (Entity, Entity) {
    let entity = spawn(stage, tube(), Transform::default());
    let world = stage.app.world_mut();
    let bind = world
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]));
    let lower = world.spawn((Transform::default(), ChildOf(entity))).id();
    let upper = world.spawn((Transform::default(), ChildOf(entity))).id();
    world.entity_mut(entity).insert(SkinnedMesh {
        inverse_bindposes: bind,
        joints: vec![lower, upper],
    });
    (entity, upper)
}

/// Compares a picture of 96 by 96 with the one kept.
pub fn golden(name: &str, picture: &Picture) {
    const SIDE: u32 = crate::app::SIZE;
    golden::check(name, picture, (SIDE, SIDE), &golden::PIXELWISE);
}
