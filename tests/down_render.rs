//! Coats as an app draws them: on closed and open skins, with seams and joints, taken off and put on again, twice in one scene.
//! Small pictures on whatever adapter there is.

mod common;

use bevy::{
    asset::RenderAssetUsages,
    mesh::{
        Indices, PrimitiveTopology, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_plumage::{down::UndercoatQuality, prelude::*};
use common::app::Stage;
use std::{
    f32::consts::{FRAC_PI_2, TAU},
    time::{Duration, Instant},
};

type Picture = Vec<[f32; 3]>;

/// A coat that can be seen: 12 mm thick on skins of 10 to 20 cm.
fn down() -> Down {
    Down {
        thickness_mm: 12.0,
        clump_mm: 3.0,
        tile: [32, 32, 16],
        ..Down::default()
    }
}

fn grid(columns: u32, rows: u32, wrap: (bool, bool), place: impl Fn(f32, f32) -> Vec3) -> Mesh {
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

fn torus() -> Mesh {
    grid(32, 16, (true, true), |u, v| {
        let (a, b) = (u * TAU, v * TAU);
        let r = 0.08 + 0.035 * b.cos();
        Vec3::new(r * a.cos(), r * a.sin(), 0.035 * b.sin())
    })
}

/// A square of 8 x 8 cells without four of them.
fn holes() -> Mesh {
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

fn tube() -> Mesh {
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
fn spawn(stage: &mut Stage, mesh: Mesh, transform: Transform) -> Entity {
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

fn dress(stage: &mut Stage, entity: Entity) {
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

/// Frames until every coat is grown.
fn settle(stage: &mut Stage) {
    let start = Instant::now();
    loop {
        stage.frame();
        let mut states = stage.app.world_mut().query::<&UndercoatState>();
        let states: Vec<_> = states.iter(stage.app.world()).cloned().collect();
        assert!(
            states.iter().all(|state| state.error.is_none()),
            "{states:?}"
        );
        if states.iter().all(|state| state.ready) {
            break;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "never grown");
        std::thread::sleep(Duration::from_millis(2));
    }
    for _ in 0..4 {
        stage.frame();
    }
}

fn brightness(picture: &Picture) -> f32 {
    picture.iter().flatten().sum::<f32>() / (3 * picture.len()) as f32
}

fn covered(picture: &Picture, least: f32) -> usize {
    picture
        .iter()
        .filter(|pixel| pixel.iter().sum::<f32>() > 3.0 * least)
        .count()
}

fn difference(a: &Picture, b: &Picture) -> f32 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

fn state(stage: &Stage, entity: Entity) -> UndercoatState {
    stage
        .app
        .world()
        .get::<UndercoatState>(entity)
        .unwrap()
        .clone()
}

#[test]
fn coats_grow_on_closed_and_open_skins() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let cube = Mesh::from(Cuboid::from_length(0.12));
    for (name, mesh, walls) in [
        ("torus", torus(), 0),
        ("holes", holes(), 4 * 8 + 4 * 4),
        // Its sides do not share a vertex, but they share a skin.
        ("cube", cube, 0),
    ] {
        let entity = spawn(&mut stage, mesh, Transform::default());
        for _ in 0..3 {
            stage.frame();
        }
        let bare = stage.picture();
        dress(&mut stage, entity);
        let coat = stage.picture();
        assert_eq!(state(&stage, entity).walls, walls, "{name}");
        // Pale down over a dark skin, over all of it and beyond its rim.
        let (skin, fur) = (covered(&bare, 0.004), covered(&coat, 0.02));
        assert!(fur as f32 > 1.05 * skin as f32, "{name}: {skin} to {fur}");
        assert!(
            brightness(&coat) > 2.0 * brightness(&bare),
            "{name}: {} to {}",
            brightness(&bare),
            brightness(&coat)
        );
        // Inside the outline no ray is lost: no pixel is darker than the darkest skin.
        let mut holes = 0;
        for (before, after) in bare.iter().zip(&coat) {
            let lit = before.iter().sum::<f32>() > 0.012;
            holes +=
                usize::from(lit && after.iter().sum::<f32>() < 0.5 * before.iter().sum::<f32>());
        }
        assert_eq!(holes, 0, "{name}");

        // Taken off and put on again.
        stage
            .app
            .world_mut()
            .entity_mut(entity)
            .remove::<Undercoat>();
        for _ in 0..3 {
            stage.frame();
        }
        assert!(difference(&stage.picture(), &bare) < 1e-6, "{name}");
        dress(&mut stage, entity);
        assert!(difference(&stage.picture(), &coat) < 1.5 / 255.0, "{name}");
        stage.app.world_mut().despawn(entity);
        for _ in 0..3 {
            stage.frame();
        }
        assert!(brightness(&stage.picture()) < 1e-6, "{name}");
    }
}

#[test]
fn two_coats_in_one_scene_are_alike() {
    let Some(mut stage) = Stage::sized(192, 96) else {
        return;
    };
    let world = stage.app.world_mut();
    world
        .entity_mut(stage.camera)
        .insert(Projection::Orthographic(OrthographicProjection {
            scaling_mode: bevy::camera::ScalingMode::FixedVertical {
                viewport_height: 0.3,
            },
            ..OrthographicProjection::default_3d()
        }));
    for x in [-0.15, 0.15] {
        let entity = spawn(&mut stage, torus(), Transform::from_xyz(x, 0.0, 0.0));
        dress(&mut stage, entity);
    }
    let picture = stage.picture();
    let half = |left: bool| -> Picture {
        picture
            .chunks_exact(192)
            .flat_map(|row| if left { &row[..96] } else { &row[96..] })
            .copied()
            .collect()
    };
    let (left, right) = (half(true), half(false));
    assert!(brightness(&left) > 0.02);
    assert!(
        difference(&left, &right) < 2.5 / 255.0,
        "{}",
        difference(&left, &right)
    );
}

/// A tube on two joints; returns the upper one.
fn spawn_tube(stage: &mut Stage) -> (Entity, Entity) {
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

#[test]
fn fur_does_not_swim_or_flicker_on_a_bending_skin() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let (entity, upper) = spawn_tube(&mut stage);
    dress(&mut stage, entity);
    // The same motion by the usual steps, and by as many as there may be.
    let mut film = |settings: UndercoatSettings| -> Vec<Picture> {
        stage
            .app
            .world_mut()
            .entity_mut(entity)
            .insert(UndercoatQuality(settings));
        (0..7)
            .map(|frame| {
                let bend = FRAC_PI_2 / 1.5 * (0.6 + 0.02 * frame as f32);
                let turn = Quat::from_rotation_z(bend) * Quat::from_rotation_y(0.02 * frame as f32);
                *stage.app.world_mut().get_mut::<Transform>(upper).unwrap() =
                    Transform::from_rotation(turn);
                stage.frame();
                stage.picture()
            })
            .collect()
    };
    let usual = film(UndercoatSettings::default());
    let reference = film(UndercoatSettings {
        eye_steps: 64,
        light_steps: 16,
        depth_clip: 16.0,
        ..default()
    });
    // Second differences in time: what moves evenly cancels, what flickers stays.
    let flicker = |film: &[Picture]| {
        let mut sum = 0.0f64;
        for three in film.windows(3) {
            for ((a, b), c) in three[0].iter().zip(&three[1]).zip(&three[2]) {
                for k in 0..3 {
                    sum += f64::from(a[k] - 2.0 * b[k] + c[k]).powi(2);
                }
            }
        }
        sum.sqrt()
    };
    let (ours, truth) = (flicker(&usual), flicker(&reference));
    assert!(truth > 0.0 && ours <= 1.5 * truth, "{ours} against {truth}");
    assert!(brightness(&usual[0]) > 0.005);
}

#[test]
fn a_change_of_the_down_grows_it_anew() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let entity = spawn(&mut stage, torus(), Transform::default());
    dress(&mut stage, entity);
    let before = stage.picture();
    let handle = stage
        .app
        .world()
        .get::<Undercoat>(entity)
        .unwrap()
        .down
        .clone();
    {
        let mut downs = stage.app.world_mut().resource_mut::<Assets<Down>>();
        downs.get_mut(&handle).unwrap().tip_colour = [0.9, 0.1, 0.1];
    }
    stage.frame();
    settle(&mut stage);
    let after = stage.picture();
    let green = |picture: &Picture| picture.iter().map(|pixel| pixel[1]).sum::<f32>();
    assert!(green(&after) < 0.8 * green(&before));
}

#[test]
fn strands_stand_out_of_the_coat() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let entity = spawn(&mut stage, torus(), Transform::default());
    dress(&mut stage, entity);
    let coat = stage.picture();
    stage
        .app
        .world_mut()
        .entity_mut(entity)
        .insert(GuardStrands {
            density: 10.0,
            length_mm: (40.0, 0.1),
            radius_um: 400.0,
            fade: 0.0,
            bend: 0.2,
            tip_colour: [1.0, 1.0, 1.0],
            ..default()
        });
    stage.frame();
    settle(&mut stage);
    let hairy = stage.picture();
    let strands = state(&stage, entity).strands;
    // 10 for each of 2 pi 8 cm times 2 pi 3.5 cm, a little less on a faceted torus.
    assert!((1020..1120).contains(&strands), "{strands}");
    assert!(covered(&hairy, 0.01) > covered(&coat, 0.01) + 300);
}
