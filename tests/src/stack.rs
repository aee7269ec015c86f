//! Feathers one behind the other, each a mesh of its own, so that Bevy's sorted blending is exact.

use super::app::Stage;
use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_plumage::groom::{Card, CardGeometry, PlumageCards};
use bevy_plumage::prelude::*;

/// The feathers.
pub struct Stack {
    cards: Vec<Entity>,
    shown: Option<(FeatherTransparency, bool)>,
    feather: Handle<Feather>,
    count: usize,
    /// Vertices of a card, along and across.
    pub grid: [usize; 2],
}

const LENGTH: f32 = 0.16;
const WIDTH: f32 = 0.09;

impl Stack {
    /// `count` feathers between the origin and 4 cm behind it.
    pub fn new(stage: &mut Stage, count: usize) -> Self {
        Self::of(stage, count, "feathers/contour.feather.ron")
    }

    /// The same of feathers from a file.
    pub fn of(stage: &mut Stage, count: usize, file: &'static str) -> Self {
        let feather = stage.app.world().resource::<AssetServer>().load(file);
        Self {
            cards: Vec::new(),
            shown: None,
            feather,
            count,
            // As the groom makes them.
            grid: [4, 3],
        }
    }

    /// A picture. `apart`: every feather is an entity that Bevy sorts; else one mesh holds all, in the wrong order.
    pub fn draw(
        &mut self,
        stage: &mut Stage,
        msaa: Msaa,
        way: FeatherTransparency,
        apart: bool,
    ) -> Vec<[f32; 3]> {
        for card in self.cards.drain(..) {
            stage.app.world_mut().entity_mut(card).despawn();
        }
        let camera = stage.camera;
        stage.app.world_mut().entity_mut(camera).insert(msaa);
        self.shown = Some((way, apart));
        let all: Vec<usize> = (0..self.count).collect();
        let groups: Vec<Vec<usize>> = if apart {
            all.iter().map(|i| vec![*i]).collect()
        } else {
            vec![all]
        };
        for group in groups {
            let card = self.spawn(stage, &group, way);
            self.cards.push(card);
        }
        stage.settle();
        stage.settle();
        stage.picture()
    }

    fn spawn(&self, stage: &mut Stage, group: &[usize], way: FeatherTransparency) -> Entity {
        let cards: Vec<Card> = group.iter().map(|i| card(*i, self.count)).collect();
        let world = stage.app.world_mut();
        // Bevy sorts by the middle of the mesh, so each mesh is around its own origin.
        let depth = if group.len() == 1 {
            cards[0].root.z
        } else {
            0.0
        };
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(sheet(&cards, depth, self.grid));
        let entity = world.spawn_empty().id();
        let mut quality = FeatherQuality {
            transparency: way,
            ..default()
        };
        quality.settings.shelter = 0.0;
        let geometry = CardGeometry {
            first_vertex: 0,
            vertex_count: self.grid.iter().product::<usize>() as u32,
        };
        let geometry = vec![geometry; cards.len()];
        world.entity_mut(entity).insert((
            Mesh3d(mesh),
            Transform::from_xyz(0.0, 0.0, depth),
            Visibility::default(),
            bevy::light::NotShadowCaster,
            quality,
            PlumageCards::new(cards, geometry, vec![self.feather.clone()]),
        ));
        entity
    }
}

fn card(index: usize, count: usize) -> Card {
    let turn = index as f32 * 2.4;
    let along = Vec3::new(turn.sin() * 0.4, 1.0, 0.0).normalize();
    let root = Vec3::new(
        0.02 * turn.cos(),
        -0.09 + 0.02 * turn.sin(),
        -0.04 * index as f32 / count as f32,
    );
    let hue = index as f32 / count as f32;
    Card {
        root,
        along,
        normal: Vec3::Z,
        center: root + along * 0.5 * LENGTH,
        radius: 0.6 * LENGTH,
        length: LENGTH,
        width: WIDTH,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer: index as f32,
        tint: [hue, 0.2, 1.0 - hue],
        seed: index as u32 * 7919 + 1,
        turn: 0.0,
        mirrored: false,
    }
}

/// One flat grid per card; nearest first, which is the wrong order for blending.
fn sheet(cards: &[Card], depth: f32, [rows, columns]: [usize; 2]) -> Mesh {
    let (mut positions, mut uvs, mut ids, mut tangents, mut indices) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, card) in cards.iter().enumerate() {
        let side = card.along.cross(card.normal);
        let first = positions.len() as u32;
        for at in 0..rows * columns {
            let u = (at % columns) as f32 / (columns - 1) as f32;
            let v = (at / columns) as f32 / (rows - 1) as f32;
            let place =
                card.root + side * ((u - 0.5) * card.width) + card.along * (v * card.length);
            positions.push((place - Vec3::Z * depth).to_array());
            uvs.push([u, v]);
            ids.push([i as f32, 0.0]);
            tangents.push(card.along.extend(-1.0).to_array());
        }
        let wide = columns as u32;
        for row in 0..rows as u32 - 1 {
            for column in 0..wide - 1 {
                let k = first + row * wide + column;
                indices.extend([k, k + 1, k + wide + 1, k, k + wide + 1, k + wide]);
            }
        }
    }
    let count = positions.len();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; count])
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, tangents)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, ids)
    .with_inserted_indices(Indices::U32(indices))
}
