//! Where the vertices of a skinned mesh are now, and what a ray meets there.

use bevy::{
    math::Affine3A,
    mesh::{
        Indices, Mesh, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};

/// A triangle met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in metres.
    pub distance: f32,
    /// Vertices of the triangle.
    pub vertices: [u32; 3],
    /// Barycentric coordinates.
    pub bary: Vec3,
}

impl Hit {
    /// A value of the vertices at the place met.
    pub fn blend<T>(&self, value: impl Fn(u32) -> T) -> T
    where
        T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.vertices.map(value);
        a * self.bary.x + b * self.bary.y + c * self.bary.z
    }
}

/// Möller and Trumbore 1997, both faces: distance and barycentric coordinates.
pub fn ray_triangle(ray: Ray3d, [a, b, c]: [Vec3; 3]) -> Option<(f32, Vec3)> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let from = ray.origin - a;
    let u = from.dot(p) / determinant;
    let q = from.cross(ab);
    let v = ray.direction.dot(q) / determinant;
    let t = ac.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0;
    inside.then(|| (t, Vec3::new(1.0 - u - v, u, v)))
}

/// The matrices that take vertices from bind pose to the world, one per joint.
pub fn skinning_matrices(
    skin: &SkinnedMesh,
    poses: &Assets<SkinnedMeshInverseBindposes>,
    joints: &Query<&GlobalTransform>,
) -> Option<Vec<Affine3A>> {
    let bind = poses.get(&skin.inverse_bindposes)?;
    skin.joints
        .iter()
        .zip(bind.iter())
        .map(|(joint, bind)| {
            let now = joints.get(*joint).ok()?.affine();
            Some(now * Affine3A::from_mat4(*bind))
        })
        .collect()
}

/// How the vertices of one mesh get to the world.
pub enum Pose {
    /// By joints.
    Skinned(Vec<Affine3A>),
    /// All alike.
    Rigid(Affine3A),
}

impl Pose {
    /// The map of a vertex with these joints and weights.
    pub fn map(&self, joints: [u16; 4], weights: [f32; 4]) -> Affine3A {
        match self {
            Self::Rigid(map) => *map,
            Self::Skinned(matrices) => {
                let mut sum = Affine3A {
                    matrix3: bevy::math::Mat3A::ZERO,
                    translation: bevy::math::Vec3A::ZERO,
                };
                for (joint, weight) in joints.into_iter().zip(weights) {
                    if let Some(map) = matrices.get(usize::from(joint)) {
                        sum.matrix3 += map.matrix3 * weight;
                        sum.translation += map.translation * weight;
                    }
                }
                sum
            }
        }
    }
}

/// The vertex data of a mesh that posing needs.
pub struct Vertices<'a> {
    positions: &'a [[f32; 3]],
    weights: Option<(&'a [[u16; 4]], &'a [[f32; 4]])>,
}

impl<'a> Vertices<'a> {
    /// The vertices of a mesh that is kept in main memory.
    pub fn of(mesh: &'a Mesh) -> Option<Self> {
        let positions = mesh
            .try_attribute_option(Mesh::ATTRIBUTE_POSITION)
            .ok()??
            .as_float3()?;
        let joints = mesh.try_attribute_option(Mesh::ATTRIBUTE_JOINT_INDEX);
        let weights = mesh.try_attribute_option(Mesh::ATTRIBUTE_JOINT_WEIGHT);
        let weights = match (joints, weights) {
            (
                Ok(Some(VertexAttributeValues::Uint16x4(joints))),
                Ok(Some(VertexAttributeValues::Float32x4(weights))),
            ) => Some((joints.as_slice(), weights.as_slice())),
            _ => None,
        };
        Some(Self { positions, weights })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Position of a vertex in bind pose.
    pub fn bind(&self, index: u32) -> Vec3 {
        self.positions
            .get(index as usize)
            .map_or(Vec3::ZERO, |p| Vec3::from_array(*p))
    }

    /// What takes the skin at a vertex from bind pose to the world.
    pub fn map(&self, pose: &Pose, index: u32) -> Affine3A {
        let i = index as usize;
        match self.weights {
            Some((joints, weights)) if i < joints.len().min(weights.len()) => {
                pose.map(joints[i], weights[i])
            }
            _ => pose.map([0; 4], [1.0, 0.0, 0.0, 0.0]),
        }
    }

    /// Position of a vertex in the world.
    pub fn posed(&self, pose: &Pose, index: u32) -> Vec3 {
        self.map(pose, index).transform_point3(self.bind(index))
    }

    /// Positions of all vertices in bind pose.
    pub fn positions(&self) -> &[[f32; 3]] {
        self.positions
    }
}

/// The triangles of a mesh.
pub fn triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let corners: Vec<u32> = match mesh.try_indices_option() {
        Ok(Some(Indices::U16(list))) => list.iter().map(|&i| u32::from(i)).collect(),
        Ok(Some(Indices::U32(list))) => list.clone(),
        _ => (0..mesh.count_vertices() as u32).collect(),
    };
    corners
        .chunks_exact(3)
        .map(|c| [c[0], c[1], c[2]])
        .collect()
}

/// The nearest triangle that a ray meets on a posed mesh.
pub fn cast(ray: Ray3d, mesh: &Mesh, pose: &Pose) -> Option<Hit> {
    let vertices = Vertices::of(mesh)?;
    let posed: Vec<Vec3> = (0..vertices.len() as u32)
        .map(|i| vertices.posed(pose, i))
        .collect();
    let corner = |i: u32| posed.get(i as usize).copied().unwrap_or(Vec3::NAN);
    triangles(mesh)
        .into_iter()
        .filter_map(|vertices| {
            let (distance, bary) = ray_triangle(ray, vertices.map(corner))?;
            Some(Hit {
                distance,
                vertices,
                bary,
            })
        })
        .min_by(|a, b| a.distance.total_cmp(&b.distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_the_posed_mesh() {
        let mesh = Mesh::from(Plane3d::new(Vec3::Z, Vec2::ONE));
        let ray = Ray3d::new(Vec3::new(0.25, 3.5, 5.0), Dir3::NEG_Z);
        assert_eq!(cast(ray, &mesh, &Pose::Rigid(Affine3A::IDENTITY)), None);
        let pose = Pose::Rigid(Affine3A::from_translation(Vec3::new(0.0, 3.0, 1.0)));
        let hit = cast(ray, &mesh, &pose).unwrap();
        assert!((hit.distance - 4.0).abs() < 1e-5);
        let vertices = Vertices::of(&mesh).unwrap();
        let bind = hit.blend(|i| vertices.bind(i));
        assert!(bind.distance(Vec3::new(0.25, 0.5, 0.0)) < 1e-5);
        assert!((hit.bary.element_sum() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn nothing_is_met_behind_or_edge_on() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let behind = Ray3d::new(Vec3::new(0.2, 0.2, -1.0), Dir3::NEG_Z);
        assert_eq!(ray_triangle(behind, triangle), None);
        let edge = Ray3d::new(Vec3::new(-1.0, 0.2, 0.0), Dir3::X);
        assert_eq!(ray_triangle(edge, triangle), None);
        assert_eq!(ray_triangle(edge, [Vec3::ZERO; 3]), None);
    }
}
