//! One feather on a flat card of its own.

use super::{app::Stage, wait};
use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_plumage::groom::{Card, CardGeometry, PlumageCards};
use bevy_plumage::prelude::*;

/// Share of the picture that a feather of [`spawn_filling`] is to cover.
const SHARE: f32 = 1.0 / 3.0;
/// Share of its card that a feather covers, about.
const OUTLINE: f32 = 0.67;

/// Spawns the feather of a file, tip to the right, so large that it fills a third of the picture (or the width of it).
pub fn spawn_filling(stage: &mut Stage, file: &'static str) -> Entity {
    spawn_segments(stage, file, (1, 1))
}

/// The same on a card of so many segments across and along.
pub fn spawn_segments(stage: &mut Stage, file: &'static str, segments: (usize, usize)) -> Entity {
    let handle: Handle<Feather> = stage.app.world().resource::<AssetServer>().load(file);
    let aspect = wait::until(file, || {
        stage.frame();
        let feathers = stage.app.world().resource::<Assets<Feather>>();
        feathers.get(&handle).map(|feather| feather.aspect)
    });
    // The camera's lens is 45 degrees high, half a metre away.
    let height = (std::f32::consts::PI / 8.0).tan();
    let width = height * stage.size.0 as f32 / stage.size.1 as f32;
    let length = (SHARE * width * height / (OUTLINE * aspect))
        .sqrt()
        .min(0.95 * width);
    let quality = FeatherQuality {
        settings: FeatherSettings {
            shelter: 0.0,
            ..default()
        },
        transparency: FeatherTransparency::Blend,
    };
    let world = stage.app.world_mut();
    let mesh =
        world
            .resource_mut::<Assets<Mesh>>()
            .add(card_mesh(length, length * aspect, segments));
    let owner = world
        .spawn((
            Transform::from_xyz(-0.5 * length, 0.0, 0.0)
                .with_rotation(Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2)),
            Visibility::default(),
        ))
        .id();
    let card = Card {
        root: Vec3::ZERO,
        along: Vec3::Y,
        normal: Vec3::Z,
        center: Vec3::Y * 0.5 * length,
        radius: 0.5 * length.hypot(length * aspect) * 1.1,
        length,
        width: length * aspect,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer: 0.0,
        tint: [0.1, 0.4, 0.7],
        seed: 1,
        turn: 0.0,
        mirrored: false,
    };
    world.entity_mut(owner).insert((
        Mesh3d(mesh),
        quality,
        PlumageCards::new(
            [card],
            [CardGeometry {
                first_vertex: 0,
                vertex_count: ((segments.0 + 1) * (segments.1 + 1)) as u32,
            }],
            vec![handle],
        ),
    ));
    stage.frames(3);
    owner
}

fn card_mesh(length: f32, width: f32, (across, along): (usize, usize)) -> Mesh {
    let wide = across + 1;
    let count = wide * (along + 1);
    let uvs: Vec<[f32; 2]> = (0..count)
        .map(|i| {
            [
                (i % wide) as f32 / across as f32,
                (i / wide) as f32 / along as f32,
            ]
        })
        .collect();
    let positions: Vec<[f32; 3]> = uvs
        .iter()
        .map(|[u, v]| [(u - 0.5) * width, v * length, 0.0])
        .collect();
    let quads = (0..along).flat_map(|row| (0..across).map(move |column| row * wide + column));
    let indices = quads.flat_map(|a| [a, a + 1, a + wide + 1, a, a + wide + 1, a + wide]);
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; count])
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0, 1.0, 0.0, -1.0]; count])
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, vec![[0.0, 0.0]; count])
    .with_inserted_indices(Indices::U32(indices.map(|i| i as u32).collect()))
}

/// Share of a picture that is not black.
pub fn covered_share(picture: &[[f32; 3]]) -> f32 {
    let lit = picture
        .iter()
        .filter(|p| p.iter().sum::<f32>() > 0.01)
        .count();
    lit as f32 / picture.len().max(1) as f32
}

/// Writes what a failing test saw into `target/test_failures`.
pub fn save(name: &str, (width, height): (u32, u32), picture: &[[f32; 3]]) {
    let shown = |p: &[f32; 3]| p.map(|x| (x.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
    let bytes = picture.iter().flat_map(shown).collect();
    if let Some(image) = image::RgbImage::from_raw(width, height, bytes) {
        let _ = image.save(crate::failure(&format!("{name}.png")));
    }
}
