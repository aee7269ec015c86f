//! Meshes of few triangles, rounded for the coat over them: each triangle is split into four, the new points bulge out by Phong
//! tessellation (Boubekeur and Alexa 2008, Eq. 4, with their alpha of 3/4).

use bevy::{
    asset::RenderAssetUsages,
    math::Vec3,
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};
use std::collections::HashMap;

/// Share by which a point follows the tangent planes of its corners.
const ALPHA: f32 = 0.75;
/// Most times that triangles are split.
pub(super) const MOST: u32 = 3;
/// No split that leads to more triangles.
const MOST_TRIANGLES: usize = 1 << 18;

/// A vertex with all that a coat needs of it.
#[derive(Clone, Copy)]
struct Vertex {
    position: Vec3,
    uv: Option<[f32; 2]>,
    color: Option<[f32; 4]>,
    skin: Option<([u16; 4], [f32; 4])>,
}

fn place_of(position: Vec3) -> [u32; 3] {
    // Adding zero makes one zero of two.
    position.to_array().map(|x| (x + 0.0).to_bits())
}

/// Unit normals by place, weighted with areas; seams have one.
fn normals(vertices: &[Vertex], triangles: &[[usize; 3]]) -> HashMap<[u32; 3], Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for t in triangles {
        let [a, b, c] = t.map(|v| vertices[v].position);
        let area = (b - a).cross(c - a);
        for corner in [a, b, c] {
            *sums.entry(place_of(corner)).or_insert(Vec3::ZERO) += area;
        }
    }
    for sum in sums.values_mut() {
        *sum = sum.normalize_or_zero();
    }
    sums
}

/// The four heaviest joints of two vertices, half of each.
fn middle_skin(a: ([u16; 4], [f32; 4]), b: ([u16; 4], [f32; 4])) -> ([u16; 4], [f32; 4]) {
    let mut joints: Vec<(u16, f32)> = Vec::with_capacity(8);
    for (joint, weight) in [a, b].iter().flat_map(|(j, w)| j.iter().zip(w)) {
        match joints.iter_mut().find(|(known, _)| known == joint) {
            Some((_, sum)) => *sum += 0.5 * weight,
            None => joints.push((*joint, 0.5 * weight)),
        }
    }
    joints.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    joints.resize(4, (0, 0.0));
    let total: f32 = joints.iter().map(|(_, weight)| weight).sum();
    let scale = if total > 0.0 { total.recip() } else { 0.0 };
    (
        [0, 1, 2, 3].map(|k: usize| joints[k].0),
        [0, 1, 2, 3].map(|k: usize| joints[k].1 * scale),
    )
}

/// The point between two: the same bits from either side of an edge.
fn middle(a: &Vertex, b: &Vertex, normals: &HashMap<[u32; 3], Vec3>) -> Vertex {
    let flat = 0.5 * (a.position + b.position);
    let onto = |v: &Vertex| {
        let normal = normals.get(&place_of(v.position)).copied();
        let normal = normal.unwrap_or_default();
        flat - normal * (flat - v.position).dot(normal)
    };
    let bulged = 0.5 * (onto(a) + onto(b));
    let both = |x: [f32; 4], y: [f32; 4]| [0, 1, 2, 3].map(|k: usize| 0.5 * (x[k] + y[k]));
    Vertex {
        position: flat * (1.0 - ALPHA) + bulged * ALPHA,
        uv: a
            .uv
            .zip(b.uv)
            .map(|(x, y)| [0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1])]),
        color: a.color.zip(b.color).map(|(x, y)| both(x, y)),
        skin: a.skin.zip(b.skin).map(|(x, y)| middle_skin(x, y)),
    }
}

fn read(mesh: &Mesh) -> Option<(Vec<Vertex>, Vec<[usize; 3]>)> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return None;
    }
    let attribute = |id| mesh.try_attribute_option(id).ok().flatten();
    let positions = attribute(Mesh::ATTRIBUTE_POSITION)?.as_float3()?;
    let uvs = match attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(uvs)) => Some(uvs),
        _ => None,
    };
    let colors = match attribute(Mesh::ATTRIBUTE_COLOR) {
        Some(VertexAttributeValues::Float32x4(colors)) => Some(colors),
        _ => None,
    };
    let joints = match attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Some(VertexAttributeValues::Uint16x4(joints)) => Some(joints),
        _ => None,
    };
    let weights = match attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT) {
        Some(VertexAttributeValues::Float32x4(weights)) => Some(weights),
        _ => None,
    };
    let vertices = positions
        .iter()
        .enumerate()
        .map(|(i, position)| Vertex {
            position: Vec3::from(*position),
            uv: uvs.and_then(|uvs| uvs.get(i).copied()),
            color: colors.and_then(|colors| colors.get(i).copied()),
            skin: joints
                .and_then(|joints| joints.get(i).copied())
                .zip(weights.and_then(|weights| weights.get(i).copied())),
        })
        .collect::<Vec<_>>();
    let flat: Vec<usize> = match mesh.indices() {
        Some(indices) => indices.iter().collect(),
        None => (0..vertices.len()).collect(),
    };
    let triangles = flat.chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
    let triangles: Vec<_> = triangles
        .filter(|t| t.iter().all(|v| *v < vertices.len()))
        .collect();
    Some((vertices, triangles))
}

/// The mesh with every triangle split into four, `times` times (0..=3). As it is if it is no list of triangles or would get too many.
pub(super) fn refined(mesh: &Mesh, times: u32) -> Mesh {
    let Some((mut vertices, mut triangles)) = read(mesh).filter(|_| times > 0) else {
        return mesh.clone();
    };
    for _ in 0..times.min(MOST) {
        if 4 * triangles.len() > MOST_TRIANGLES {
            break;
        }
        let normals = normals(&vertices, &triangles);
        let mut middles: HashMap<(usize, usize), usize> = HashMap::new();
        let mut split = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                let key = (p.min(q), p.max(q));
                *middles.entry(key).or_insert_with(|| {
                    let between = middle(&vertices[key.0], &vertices[key.1], &normals);
                    vertices.push(between);
                    vertices.len() - 1
                })
            });
            split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = split;
    }
    let mut mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_POSITION,
        vertices
            .iter()
            .map(|v| v.position.to_array())
            .collect::<Vec<_>>(),
    )
    .with_inserted_indices(Indices::U32(
        triangles.iter().flatten().map(|v| *v as u32).collect(),
    ));
    if let Some(uvs) = vertices.iter().map(|v| v.uv).collect::<Option<Vec<_>>>() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    let colors = vertices.iter().map(|v| v.color);
    if let Some(colors) = colors.collect::<Option<Vec<_>>>() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    }
    let skin = vertices.iter().map(|v| v.skin);
    if let Some(skin) = skin.collect::<Option<Vec<_>>>() {
        let (joints, weights): (Vec<_>, Vec<_>) = skin.into_iter().unzip();
        mesh.insert_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(joints),
        );
        mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::undercoat::shell::Shell;

    /// An octahedron whose eight sides share no vertex, on two joints.
    fn octahedron() -> Mesh {
        let mut positions = Vec::new();
        for i in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|k| if i >> k & 1 == 0 { 1.0f32 } else { -1.0 });
            let mut corners = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
            if x * y * z < 0.0 {
                corners.swap(1, 2);
            }
            positions.extend(corners.map(|p| p.to_array()));
        }
        let weights: Vec<[f32; 4]> = positions
            .iter()
            .map(|p| [0.5 + 0.5 * p[1], 0.5 - 0.5 * p[1], 0.0, 0.0])
            .collect();
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(vec![[3, 7, 0, 0]; positions.len()]),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    }

    #[test]
    fn rounding_keeps_seams_shut_and_skin_on_its_joints() {
        for times in 0..=3 {
            let (vertices, triangles) = read(&refined(&octahedron(), times)).unwrap();
            assert_eq!(triangles.len(), 8 << (2 * times));
            let positions: Vec<_> = vertices.iter().map(|v| v.position.to_array()).collect();
            let indices: Vec<u32> = triangles.iter().flatten().map(|v| *v as u32).collect();
            let heights = vec![0.1; positions.len()];
            let shell = Shell::build(&positions, &indices, &heights).unwrap();
            assert_eq!(shell.report.boundary_edges, 0, "{times}");
            assert_eq!(shell.report.non_manifold_edges, 0, "{times}");
            // Nearer and nearer to a ball: the flat sides of the octahedron are 0.577 from its middle.
            let nearest = |t: &[usize; 3]| {
                let [a, b, c] = t.map(|v| vertices[v].position);
                ((a + b + c) / 3.0).length()
            };
            let nearest = triangles.iter().map(nearest).fold(2.0, f32::min);
            let least = [0.577, 0.67, 0.71, 0.72][times as usize];
            assert!(nearest > least, "{times}: {nearest}");
            for vertex in &vertices {
                let (joints, weights) = vertex.skin.unwrap();
                let at = |joint: u16| -> f32 {
                    let pairs = joints.iter().zip(weights);
                    pairs.filter(|(j, _)| **j == joint).map(|(_, w)| w).sum()
                };
                assert!((at(3) + at(7) - 1.0).abs() < 1e-5);
                // Weights are those of the flat sides, whose height differs from a ball's by 0.318 at most.
                assert!((at(3) - at(7) - vertex.position.y).abs() < 0.32);
            }
        }
    }
}
