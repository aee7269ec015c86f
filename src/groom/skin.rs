//! The skin feathers grow on: triangles with tract, phi, color and joint weights, taken from Bevy meshes.
//!
//! Vertices that coincide are welded into *nodes*, so that seams of normals or texture coordinates do not tear the fields
//! that live on the surface (lay, height). Nothing is assumed about the scale, the topology or the attributes present.

use super::{
    authored::SkinMasks,
    error::{GroomError, MaskFlaw, SkinFlaw},
    mask_textures::SkinTexture,
};
use bevy::{
    math::Vec3,
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};
use std::collections::HashMap;

/// A place on the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Triangle.
    pub triangle: u32,
    /// Barycentric coordinates; not negative, sum 1.
    pub bary: Vec3,
}

/// Most triangles of a skin: beyond it the lay alone takes most of a minute.
pub const MOST_TRIANGLES: usize = 1_000_000;

/// Joints with weights: sum 1, or all zero on a skin without joints.
pub type Weights = ([u16; 4], [f32; 4]);

/// Triangles of the skin in bind pose, model space, metres.
#[derive(Clone, Debug, Default)]
pub struct SkinMesh {
    /// Positions of the vertices.
    pub positions: Vec<Vec3>,
    /// Tract number and phi of each vertex (`TEXCOORD_1`); empty if the mesh has none.
    pub tract_phi: Vec<[f32; 2]>,
    /// Linear color of each vertex, white on meshes without colors; empty if no mesh has any.
    pub colors: Vec<[f32; 3]>,
    /// Texture coordinates of each vertex (`TEXCOORD_0`), 0 on meshes without any.
    pub uvs: Vec<[f32; 2]>,
    /// First vertex of each mesh that the skin was taken from.
    pub first_vertices: Vec<u32>,
    /// Joints and weights of each vertex; empty if the mesh is not skinned.
    pub weights: Vec<Weights>,
    /// What the vertices say about feathers, see [`SkinMesh::with_masks`].
    pub masks: SkinMasks,
    /// Masks in textures, see [`SkinMesh::with_textures`].
    pub textures: Vec<SkinTexture>,
    /// Numbers of the meshes without texture coordinates.
    pub without_uvs: Vec<usize>,
    /// What was wrong with the meshes without being fatal.
    pub flaws: Vec<SkinFlaw>,
    /// What was wrong with masks in textures.
    pub mask_flaws: Vec<MaskFlaw>,
    /// Triangles that have an area.
    pub triangles: Vec<[u32; 3]>,
    /// Area of each triangle.
    pub areas: Vec<f32>,
    /// Unit normal of each triangle, outwards.
    pub face_normals: Vec<Vec3>,
    /// Node of each vertex.
    pub node_of: Vec<u32>,
    /// Position of each node.
    pub nodes: Vec<Vec3>,
    /// Unit normal of each node, area-weighted.
    pub normals: Vec<Vec3>,
    /// Triangles around each node, in compressed rows: `around[starts[n]..starts[n + 1]]`.
    starts: Vec<u32>,
    around: Vec<u32>,
    /// Neighboring nodes of each node, likewise.
    edge_starts: Vec<u32>,
    edges: Vec<u32>,
}

fn floats<const N: usize>(
    mesh: &Mesh,
    id: bevy::mesh::MeshVertexAttribute,
) -> Option<Vec<[f32; N]>> {
    match mesh.try_attribute_option(id).ok()?? {
        VertexAttributeValues::Float32x2(values) if N == 2 => Some(
            values
                .iter()
                .map(|v| std::array::from_fn(|i| v[i]))
                .collect(),
        ),
        VertexAttributeValues::Float32x3(values) if N <= 3 => Some(
            values
                .iter()
                .map(|v| std::array::from_fn(|i| v[i]))
                .collect(),
        ),
        VertexAttributeValues::Float32x4(values) if N <= 4 => Some(
            values
                .iter()
                .map(|v| std::array::from_fn(|i| v[i]))
                .collect(),
        ),
        VertexAttributeValues::Unorm8x4(values) if N <= 4 => Some(
            values
                .iter()
                .map(|v| std::array::from_fn(|i| f32::from(v[i]) / 255.0))
                .collect(),
        ),
        VertexAttributeValues::Unorm16x4(values) if N <= 4 => Some(
            values
                .iter()
                .map(|v| std::array::from_fn(|i| f32::from(v[i]) / 65_535.0))
                .collect(),
        ),
        _ => None,
    }
}

impl SkinMesh {
    /// Takes the skin from meshes that share one skeleton. `joint_maps[m][j]` is the index, in the common list of joints, of
    /// joint `j` of mesh `m`; an empty map leaves the index as it is.
    ///
    /// # Errors
    /// [`GroomError::Skin`] if there is no mesh, a mesh is not made of triangles, has no positions on the CPU, or has no area;
    /// [`GroomError::Value`] for more than [`MOST_TRIANGLES`].
    pub fn from_meshes(meshes: &[&Mesh], joint_maps: &[Vec<u16>]) -> Result<Self, GroomError> {
        let mut skin = Self::default();
        let all_tracts = meshes
            .iter()
            .all(|mesh| floats::<2>(mesh, Mesh::ATTRIBUTE_UV_1).is_some());
        let any_colors = meshes
            .iter()
            .any(|mesh| floats::<3>(mesh, Mesh::ATTRIBUTE_COLOR).is_some());
        let mut triangles = Vec::new();
        let mut normal_sign = 0.0_f64;
        for (number, mesh) in meshes.iter().enumerate() {
            let fail = |message: &str| GroomError::Skin {
                mesh: number,
                message: message.into(),
            };
            if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
                return Err(fail("is not a list of triangles"));
            }
            let positions = floats::<3>(mesh, Mesh::ATTRIBUTE_POSITION).ok_or_else(|| {
                fail("has no positions in main memory (load it with RenderAssetUsages::MAIN_WORLD)")
            })?;
            let count = positions.len();
            let base = skin.positions.len() as u32;
            let clean =
                |v: &[f32; 3]| Vec3::from_array(v.map(|x| if x.is_finite() { x } else { 0.0 }));
            skin.positions.extend(positions.iter().map(clean));
            if all_tracts && let Some(values) = floats::<2>(mesh, Mesh::ATTRIBUTE_UV_1) {
                skin.tract_phi
                    .extend((0..count).map(|i| values.get(i).copied().unwrap_or_default()));
            }
            if any_colors {
                let values = floats::<3>(mesh, Mesh::ATTRIBUTE_COLOR).unwrap_or_default();
                skin.colors
                    .extend((0..count).map(|i| values.get(i).copied().unwrap_or([1.0; 3])));
            }
            let uvs = floats::<2>(mesh, Mesh::ATTRIBUTE_UV_0).unwrap_or_default();
            if uvs.is_empty() {
                skin.without_uvs.push(number);
            }
            skin.uvs
                .extend((0..count).map(|i| uvs.get(i).copied().unwrap_or_default()));
            skin.first_vertices.push(base);
            let map = joint_maps.get(number).map_or(&[][..], Vec::as_slice);
            let (weights, flaw) = vertex_weights(mesh, number, count, map);
            skin.weights.extend(weights);
            skin.flaws.extend(flaw);
            let list: Vec<u32> = match mesh.try_indices_option() {
                Ok(Some(Indices::U16(list))) => list.iter().map(|&i| u32::from(i)).collect(),
                Ok(Some(Indices::U32(list))) => list.clone(),
                Ok(None) => (0..count as u32).collect(),
                Err(_) => return Err(fail("has no indices in main memory")),
            };
            if triangles.len() + list.len() / 3 > MOST_TRIANGLES {
                return Err(GroomError::Value {
                    mesh: number,
                    field: "triangles",
                    value: (triangles.len() + list.len() / 3).to_string(),
                    range: format!("1 to {MOST_TRIANGLES} (feathers hide finer shapes: decimate)"),
                });
            }
            let normals = floats::<3>(mesh, Mesh::ATTRIBUTE_NORMAL).unwrap_or_default();
            for corner in list.chunks_exact(3) {
                if corner.iter().any(|&i| i as usize >= count) {
                    continue;
                }
                if let Some(normal) = normals.get(corner[0] as usize) {
                    let [a, b, c] = [0, 1, 2].map(|k| skin.positions[(base + corner[k]) as usize]);
                    normal_sign += f64::from((b - a).cross(c - a).dot(clean(normal)));
                }
                triangles.push([base + corner[0], base + corner[1], base + corner[2]]);
            }
        }
        if skin.weights.len() != skin.positions.len() {
            skin.weights.clear();
        }
        if normal_sign < 0.0 {
            triangles
                .iter_mut()
                .for_each(|triangle| triangle.swap(1, 2));
        }
        skin.connect(triangles);
        if skin.triangles.is_empty() {
            return Err(GroomError::Skin {
                mesh: 0,
                message: "has no triangle with an area".into(),
            });
        }
        Ok(skin)
    }

    /// Drops triangles without an area, welds vertices and builds the adjacency.
    fn connect(&mut self, triangles: Vec<[u32; 3]>) {
        let low = self
            .positions
            .iter()
            .copied()
            .fold(Vec3::INFINITY, Vec3::min);
        let high = self
            .positions
            .iter()
            .copied()
            .fold(Vec3::NEG_INFINITY, Vec3::max);
        let size = (high - low).max_element().max(f32::MIN_POSITIVE);
        let mut known = HashMap::new();
        for &position in &self.positions {
            let cell = ((position - low) / (size * 1.0e-6))
                .round()
                .to_array()
                .map(|x| x as i64);
            let next = self.nodes.len() as u32;
            let node = *known.entry(cell).or_insert(next);
            if node == next {
                self.nodes.push(position);
            }
            self.node_of.push(node);
        }
        let mut normals = vec![Vec3::ZERO; self.nodes.len()];
        for triangle in triangles {
            let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            let area = 0.5 * normal.length();
            if !area.is_finite() || area <= size * size * 1.0e-12 {
                continue;
            }
            for vertex in triangle {
                normals[self.node_of[vertex as usize] as usize] += normal;
            }
            self.triangles.push(triangle);
            self.areas.push(area);
            self.face_normals.push(normal / (2.0 * area));
        }
        self.normals = normals
            .iter()
            .map(|normal| normal.try_normalize().unwrap_or(Vec3::Y))
            .collect();
        let corners: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .map(|t| t.map(|v| self.node_of[v as usize]))
            .collect();
        let mut around = vec![Vec::new(); self.nodes.len()];
        for (number, corner) in corners.iter().enumerate() {
            corner
                .iter()
                .for_each(|&node| around[node as usize].push(number as u32));
        }
        self.starts.push(0);
        self.edge_starts.push(0);
        let mut ring = Vec::new();
        for (node, list) in around.iter().enumerate() {
            ring.clear();
            ring.extend(
                list.iter()
                    .flat_map(|&t| corners[t as usize])
                    .filter(|&other| other != node as u32),
            );
            ring.sort_unstable();
            ring.dedup();
            self.around.extend(list);
            self.edges.extend(&ring);
            self.starts.push(self.around.len() as u32);
            self.edge_starts.push(self.edges.len() as u32);
        }
    }

    /// Nodes that share an edge with this one.
    pub fn neighbors(&self, node: usize) -> &[u32] {
        &self.edges[self.edge_starts[node] as usize..self.edge_starts[node + 1] as usize]
    }

    /// Triangles around a node.
    pub fn triangles_around(&self, node: usize) -> &[u32] {
        &self.around[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// Nodes of a triangle.
    pub fn corner_nodes(&self, triangle: u32) -> [usize; 3] {
        self.triangles[triangle as usize].map(|vertex| self.node_of[vertex as usize] as usize)
    }

    /// Position of a point.
    pub fn position(&self, point: SurfacePoint) -> Vec3 {
        let [a, b, c] =
            self.triangles[point.triangle as usize].map(|vertex| self.positions[vertex as usize]);
        a * point.bary.x + b * point.bary.y + c * point.bary.z
    }

    /// Smooth unit normal at a point.
    pub fn normal(&self, point: SurfacePoint) -> Vec3 {
        let [a, b, c] = self
            .corner_nodes(point.triangle)
            .map(|node| self.normals[node]);
        let blend = a * point.bary.x + b * point.bary.y + c * point.bary.z;
        blend
            .try_normalize()
            .unwrap_or(self.face_normals[point.triangle as usize])
    }

    /// A vector field given on the nodes, interpolated.
    pub fn interpolate(&self, field: &[Vec3], point: SurfacePoint) -> Vec3 {
        let [a, b, c] = self.corner_nodes(point.triangle).map(|node| field[node]);
        a * point.bary.x + b * point.bary.y + c * point.bary.z
    }

    /// Tract number of a vertex, from the mask or `TEXCOORD_1`; `None` without either.
    pub fn vertex_tract(&self, vertex: usize) -> Option<f32> {
        let masked = self.masks.tract.get(vertex).copied();
        masked.or_else(|| self.tract_phi.get(vertex).map(|[number, _]| *number))
    }

    /// Tract number of a triangle: that of two of its vertices at least, else of the first. `None` without any.
    pub fn tract(&self, triangle: u32) -> Option<i32> {
        let corner = |vertex: u32| Some(self.vertex_tract(vertex as usize)?.round() as i32);
        let [a, b, c] = self.triangles[triangle as usize].map(corner);
        if b == c { b } else { a }
    }

    /// Phi at a point, from the vertices that belong to the triangle's tract. `None` without `TEXCOORD_1`.
    pub fn phi(&self, point: SurfacePoint) -> Option<f32> {
        if self.tract_phi.is_empty() {
            return None;
        }
        let tract = self.tract(point.triangle)?;
        let (mut sum, mut total) = (0.0, 0.0);
        for (vertex, share) in self.triangles[point.triangle as usize]
            .into_iter()
            .zip(point.bary.to_array())
        {
            let [number, phi] = self.tract_phi[vertex as usize];
            let number = self.vertex_tract(vertex as usize).unwrap_or(number);
            if number.round() as i32 == tract {
                // A point on the far edge has no share of the tract's own vertices: keep the mean defined there.
                sum += phi * (share + 1.0e-6);
                total += share + 1.0e-6;
            }
        }
        let phi = sum / total;
        Some(if phi.is_finite() {
            phi.clamp(0.0, 1.0)
        } else {
            0.0
        })
    }

    /// Number of the mesh that a triangle comes from.
    pub fn mesh_of(&self, triangle: u32) -> usize {
        let vertex = self.triangles[triangle as usize][0];
        let before = self
            .first_vertices
            .partition_point(|&first| first <= vertex);
        before.saturating_sub(1)
    }

    /// The place of the skin nearest to a point in space, on the face that turns the way `normal` does: that of a node and
    /// what is downhill from it.
    pub fn nearest(&self, point: Vec3, normal: Vec3) -> Option<SurfacePoint> {
        // The other face of a thin sheet counts as four times as far.
        let distance = |node: usize| {
            let facing = self.normals[node].dot(normal);
            self.nodes[node].distance_squared(point) * (2.5 - 1.5 * facing).powi(2)
        };
        let near = (0..self.nodes.len())
            .filter(|&node| !self.triangles_around(node).is_empty())
            .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
        let start = self.triangles_around(near).first()?;
        Some(self.walk(*start, point))
    }

    /// Joint weights at a point: the four strongest of its triangle.
    pub fn joint_weights(&self, point: SurfacePoint) -> Weights {
        if self.weights.is_empty() {
            return ([0; 4], [0.0; 4]);
        }
        let corners = self.triangles[point.triangle as usize];
        let parts = corners.into_iter().zip(point.bary.to_array());
        blend_weights(parts.map(|(vertex, share)| (self.weights[vertex as usize], share)))
    }

    /// Closest point to `target` that is reached from `start` by walking downhill over neighboring triangles. Unlike the
    /// closest point of the whole skin it never jumps to the other face of a thin sheet.
    pub fn walk(&self, start: u32, target: Vec3) -> SurfacePoint {
        let (mut best, mut inside) = self.closest_on(start, target);
        let mut best_distance = self.position(best).distance_squared(target);
        for _ in 0..64 {
            if inside {
                break;
            }
            let current = best.triangle;
            for node in self.corner_nodes(current) {
                for &triangle in self.triangles_around(node) {
                    if triangle == current {
                        continue;
                    }
                    let (point, within) = self.closest_on(triangle, target);
                    let distance = self.position(point).distance_squared(target);
                    if distance < best_distance {
                        (best, best_distance, inside) = (point, distance, within);
                    }
                }
            }
            if best.triangle == current {
                break;
            }
        }
        best
    }

    /// Closest point of one triangle (Ericson 2005, 5.1.5), and whether the target projects to its inside.
    fn closest_on(&self, triangle: u32, target: Vec3) -> (SurfacePoint, bool) {
        let [a, b, c] =
            self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize]);
        let (ab, ac, ap) = (b - a, c - a, target - a);
        let point = |y: f32, z: f32| SurfacePoint {
            triangle,
            bary: Vec3::new(1.0 - y - z, y, z),
        };
        let (d1, d2) = (ab.dot(ap), ac.dot(ap));
        if d1 <= 0.0 && d2 <= 0.0 {
            return (point(0.0, 0.0), false);
        }
        let bp = target - b;
        let (d3, d4) = (ab.dot(bp), ac.dot(bp));
        if d3 >= 0.0 && d4 <= d3 {
            return (point(1.0, 0.0), false);
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return (point(d1 / (d1 - d3), 0.0), false);
        }
        let cp = target - c;
        let (d5, d6) = (ab.dot(cp), ac.dot(cp));
        if d6 >= 0.0 && d5 <= d6 {
            return (point(0.0, 1.0), false);
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return (point(0.0, d2 / (d2 - d6)), false);
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
            let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return (point(1.0 - t, t), false);
        }
        let inverse = 1.0 / (va + vb + vc);
        (point(vb * inverse, vc * inverse), true)
    }

    /// Mean length of a triangle's side, metres.
    pub fn mean_edge(&self) -> f32 {
        let mean = self
            .areas
            .iter()
            .map(|area| (area * 2.309_4).sqrt())
            .sum::<f32>()
            / self.areas.len().max(1) as f32;
        mean.max(f32::MIN_POSITIVE)
    }
}

/// Joints and weights of a mesh's vertices, none if it is not skinned. A vertex whose weights are no weights rides on its first joint.
fn vertex_weights(
    mesh: &Mesh,
    number: usize,
    count: usize,
    map: &[u16],
) -> (Vec<Weights>, Option<SkinFlaw>) {
    let joints: Vec<[u16; 4]> = match mesh.try_attribute_option(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Ok(Some(VertexAttributeValues::Uint16x4(values))) => values.clone(),
        Ok(Some(VertexAttributeValues::Uint8x4(values))) => {
            values.iter().map(|v| v.map(u16::from)).collect()
        }
        _ => return (Vec::new(), None),
    };
    let Some(weights) = floats::<4>(mesh, Mesh::ATTRIBUTE_JOINT_WEIGHT) else {
        return (Vec::new(), None);
    };
    for found in [joints.len(), weights.len()] {
        if found != count {
            let flaw = SkinFlaw::count(number, "JOINTS_0, WEIGHTS_0", found, count);
            return (Vec::new(), Some(flaw));
        }
    }
    let sound = |weights: &[f32; 4]| {
        let known = weights.iter().all(|w| w.is_finite() && *w >= 0.0);
        known && weights.iter().sum::<f32>() > 0.0
    };
    let wrong = weights.iter().filter(|weights| !sound(weights)).count();
    let flaw = weights.iter().position(|weights| !sound(weights));
    let flaw = flaw.map(|vertex| SkinFlaw {
        mesh: number,
        field: format!("WEIGHTS_0 of vertex {vertex}"),
        value: format!("{:?} ({wrong} such vertices in all)", weights[vertex]),
        range: "numbers from 0 to 1 with a sum above 0".into(),
        mended: "feathers there ride on the first joint",
    });
    let rename = |joint: u16| {
        if map.is_empty() {
            joint
        } else {
            map.get(usize::from(joint)).copied().unwrap_or(0)
        }
    };
    let vertices = joints.iter().zip(&weights).map(|(joint, weight)| {
        let weight = if sound(weight) {
            *weight
        } else {
            [1.0, 0.0, 0.0, 0.0]
        };
        blend_weights([((joint.map(rename), weight), 1.0)])
    });
    (vertices.collect(), flaw)
}

/// Blends sets of joint weights by share; keeps the four strongest, sum 1. Ties go to the lower joint.
pub fn blend_weights(parts: impl IntoIterator<Item = (Weights, f32)>) -> Weights {
    let mut list: Vec<(u16, f32)> = Vec::with_capacity(12);
    for ((joints, weights), share) in parts {
        for (joint, weight) in joints.into_iter().zip(weights) {
            let value = weight * share;
            if value <= 0.0 || !value.is_finite() {
                continue;
            }
            match list.iter_mut().find(|(known, _)| *known == joint) {
                Some((_, sum)) => *sum += value,
                None => list.push((joint, value)),
            }
        }
    }
    list.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    list.truncate(4);
    let total: f32 = list.iter().map(|(_, weight)| weight).sum();
    let (mut joints, mut weights) = ([0; 4], [0.0; 4]);
    if total > 0.0 {
        for (i, (joint, weight)) in list.into_iter().enumerate() {
            (joints[i], weights[i]) = (joint, weight / total);
        }
    }
    (joints, weights)
}
