//! Single strands as buffers and meshes.

use super::{
    GuardStrands,
    material::{STRAND, StrandUniform, UndercoatUniform},
};
use crate::maths::seed::mix;
use crate::maths::undercoat::{shell::Shell, strands::strand_roots};
use bevy::{
    asset::RenderAssetUsages,
    color::Color,
    math::{Vec3, Vec4},
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};

/// Segments of a strand.
const SEGMENTS: u32 = 6;

/// What strands are grown of.
pub(super) struct StrandInput<'a> {
    pub shell: &'a Shell,
    pub strands: &'a GuardStrands,
    /// Model units in a metre of the animal.
    pub factor: f32,
    /// Metres of the world in a metre of the animal.
    pub scale: f32,
    pub seed: u64,
}

/// Strands ready to be uploaded.
pub(super) struct HairParts {
    pub count: u32,
    pub roots: Vec<u8>,
    pub mesh: Mesh,
}

impl HairParts {
    /// Bytes on the GPU.
    pub(super) fn bytes(&self) -> u64 {
        let vertices = self.mesh.count_vertices() as u64 * self.mesh.get_vertex_size();
        let indices = self
            .mesh
            .indices()
            .map_or(0, |indices| indices.len() as u64 * 4);
        self.roots.len() as u64 + vertices + indices
    }

    /// The uniform of the strands over a coat.
    pub(super) fn uniform(
        &self,
        strands: &GuardStrands,
        coat: &UndercoatUniform,
        scale: f32,
        covered: bool,
    ) -> StrandUniform {
        let linear = |color: [f32; 3]| {
            let linear = Color::srgb_from_array(color).to_linear();
            Vec3::new(linear.red, linear.green, linear.blue)
        };
        StrandUniform {
            node_count: coat.node_count,
            prism_count: coat.prism_count,
            color: linear(strands.color),
            radius: 1.0e-6 * scale * strands.radius_um.clamp(1.0, 2000.0),
            tip_color: linear(strands.tip_color),
            fade: strands.fade.clamp(0.0, 8.0),
            lean: strands.bend.clamp(0.0, 1.0),
            droop: strands.gravity.clamp(0.0, 1.5),
            highlight_strength: 0.08,
            highlight_exponent: 40.0,
            column: if covered {
                coat.column
            } else {
                [Vec4::ZERO; super::material::COLUMN / 4]
            },
        }
    }
}

/// Grows strands over a shell.
pub(super) fn grow_strands(input: &StrandInput) -> HairParts {
    let StrandInput {
        shell,
        strands,
        factor,
        scale,
        seed,
    } = input;
    let positions: Vec<Vec3> = shell.vertices.iter().map(|v| v.position.into()).collect();
    // Corners in the order of the prisms, so that the weights are those of the sorted corners.
    let triangles: Vec<[u32; 3]> = shell.prisms.iter().map(|prism| prism.corners).collect();
    let metre = factor.max(1e-12);
    let density = 1.0e4 * strands.density.clamp(0.0, 1000.0) / (metre * metre);
    let seed = mix(*seed, strands.seed);
    let mut roots = strand_roots(&positions, &triangles, density, seed, |_| 1.0);
    // Shuffled: any first part of them is a fair thinning.
    roots.truncate(strands.limit.min(200_000) as usize);
    let mut bytes = Vec::with_capacity(16 * roots.len());
    for root in &roots {
        let share = |value: f32| (value.clamp(0.0, 1.0) * 65_535.0).round() as u32;
        let place = share(root.barycentric[0]) | share(root.barycentric[1]) << 16;
        let vary = (root.seed & 0xffff) as f32 / 32_767.5 - 1.0;
        let (mean, spread) = (strands.length_mm, strands.length_spread);
        let length = scale
            * 1.0e-3
            * mean.clamp(0.1, 300.0)
            * (1.0 + spread.clamp(0.0, 1.0) * vary).max(0.05);
        for word in [root.triangle, place, length.to_bits(), root.seed] {
            bytes.extend(word.to_le_bytes());
        }
    }
    let count = roots.len() as u32;
    let mut vertices = Vec::with_capacity(2 * (SEGMENTS as usize + 1) * roots.len());
    let mut indices = Vec::with_capacity(6 * SEGMENTS as usize * roots.len());
    for strand in 0..count {
        let first = vertices.len() as u32;
        for row in 0..=SEGMENTS {
            for side in 0..2 {
                vertices.push([strand, row << 16 | SEGMENTS << 8 | side]);
            }
        }
        for row in 0..SEGMENTS {
            let k = first + 2 * row;
            indices.extend([k, k + 1, k + 3, k, k + 3, k + 2]);
        }
    }
    let mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(STRAND, VertexAttributeValues::Uint32x2(vertices))
    .with_inserted_indices(Indices::U32(indices));
    HairParts {
        count,
        roots: bytes,
        mesh,
    }
}
