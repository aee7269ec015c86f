//! The cards of one bird as one skinned mesh.

use super::{card::CardGeometry, leaf::Leaf, worn::ATTRIBUTE_RAISED};
use crate::maths::order::raised_pack;
use bevy::{
    asset::RenderAssetUsages,
    math::Vec3,
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};

/// Builds the mesh and fills in each card's bounding sphere.
///
/// Vertices, card after card: `POSITION`; `NORMAL` of the front face; `TANGENT`, the direction of the rachis, with w = -1 on a
/// plain card and +1 on a mirrored one, so that `cross(normal, tangent) * w` points to +u; `UV_0` card uv (u from left to right
/// seen from the front, tip up; v from root to tip); `UV_1` card number and layer rank 0..1; and, if the bird is skinned,
/// `JOINT_INDEX` and `JOINT_WEIGHT`; and [`ATTRIBUTE_RAISED`], heights in units of `reach`. Triangles of higher layers come first, so that the depth test drops what they cover.
/// Indices are short where they fit.
pub fn build_mesh(leaves: &mut [Leaf], skinned: bool, reach: f32) -> (Mesh, Vec<CardGeometry>) {
    let count: usize = leaves
        .iter()
        .map(|leaf| leaf.shaft.points.len() * (leaf.columns + 1))
        .sum();
    let mut positions = Vec::with_capacity(count);
    let mut normals = Vec::with_capacity(count);
    let mut tangents = Vec::with_capacity(count);
    let mut uvs = Vec::with_capacity(count);
    let mut ids = Vec::with_capacity(count);
    let mut joints = Vec::with_capacity(count);
    let mut weights = Vec::with_capacity(count);
    let mut geometry = Vec::with_capacity(leaves.len());
    let mut order: Vec<usize> = (0..leaves.len()).collect();
    order.sort_by(|&a, &b| {
        leaves[b]
            .card
            .layer
            .total_cmp(&leaves[a].card.layer)
            .then(a.cmp(&b))
    });
    let mut rank = vec![0.0; leaves.len()];
    for (place, &leaf) in order.iter().enumerate() {
        rank[leaf] = 1.0 - (place as f32 + 0.5) / leaves.len() as f32;
    }
    let mut raised: Vec<[u16; 4]> = Vec::with_capacity(count);
    let of_pose =
        |lists: &[Vec<f32>], pose: usize, at: usize| lists.get(pose).map_or(0.0, |list| list[at]);
    for (number, leaf) in leaves.iter_mut().enumerate() {
        let first = positions.len();
        let rows = leaf.shaft.points.len();
        let places = leaf.vertices();
        let fronts = leaf.vertex_normals(&places);
        for i in 0..rows {
            let along = leaf.along(i);
            let (joint, weight) = leaf.weights_at(i);
            for j in 0..=leaf.columns {
                let at = i * (leaf.columns + 1) + j;
                let normal = fronts[at];
                let tangent = (along - normal * along.dot(normal))
                    .try_normalize()
                    .unwrap_or(leaf.card.along);
                let u = j as f32 / leaf.columns as f32;
                let mirrored = leaf.card.mirrored;
                positions.push(places[at].to_array());
                normals.push(normal.to_array());
                tangents.push(tangent.extend(if mirrored { 1.0 } else { -1.0 }).to_array());
                uvs.push([
                    if mirrored { 1.0 - u } else { u },
                    i as f32 / (rows - 1) as f32,
                ]);
                ids.push([number as f32, rank[number]]);
                joints.push(joint);
                weights.push(weight);
                let further =
                    |k| of_pose(&leaf.raised_further, k, at) / reach.max(f32::MIN_POSITIVE);
                raised.push(raised_pack(
                    std::array::from_fn(further),
                    std::array::from_fn(|k| of_pose(&leaf.windows, k, at)),
                    leaf.held,
                ));
            }
        }
        let wide = leaf.columns + 1;
        let beside = (0..fronts.len()).filter(|at| (at + 1) % wide > 0);
        let above = (0..fronts.len()).filter(|at| at + wide < fronts.len());
        let pairs = beside
            .map(|at| (at, at + 1))
            .chain(above.map(|at| (at, at + wide)));
        let turns = pairs.map(|(a, b)| fronts[a].angle_between(fronts[b]));
        leaf.card.turn = turns.fold(0.0, f32::max);
        let (low, high) = places
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
                (a.min(*p), b.max(*p))
            });
        leaf.card.center = 0.5 * (low + high);
        let farther = leaf.raised_further.iter().flatten();
        let farther = farther.fold(0.0_f32, |most, height| most.max(height.abs()));
        let distances = places.iter().map(|p| p.distance(leaf.card.center));
        leaf.card.radius = distances.fold(0.0, f32::max) + farther;
        let vertex_count = (positions.len() - first) as u32;
        geometry.push(CardGeometry {
            first_vertex: first as u32,
            vertex_count,
        });
    }
    let mut indices: Vec<u32> = Vec::new();
    for number in order {
        let (leaf, first) = (&leaves[number], geometry[number].first_vertex);
        let wide = leaf.columns as u32 + 1;
        for i in 0..leaf.shaft.points.len() as u32 - 1 {
            for j in 0..leaf.columns as u32 {
                let a = first + i * wide + j;
                indices.extend([a, a + 1, a + wide + 1, a, a + wide + 1, a + wide]);
            }
        }
    }
    let mut mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
    mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, ids);
    if skinned {
        mesh.insert_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(joints),
        );
        mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    }
    mesh.insert_attribute(ATTRIBUTE_RAISED, VertexAttributeValues::Uint16x4(raised));
    let short = |indices: &[u32]| -> Option<Vec<u16>> {
        indices
            .iter()
            .map(|index| (*index).try_into().ok())
            .collect()
    };
    mesh.insert_indices(short(&indices).map_or(Indices::U32(indices), Indices::U16));
    (mesh, geometry)
}
