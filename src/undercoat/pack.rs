//! A shell as the shaders read it (`shaders/undercoat_data.wgsl`): nodes, prisms, and the triangles through which rays enter.

use super::UndercoatError;
use crate::groom::SkinMesh;
use crate::maths::undercoat::shell::{Shell, ShellFace};
use bevy::{
    asset::RenderAssetUsages,
    math::{Vec2, Vec3},
    mesh::{Mesh, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues, VertexFormat},
};

/// Vec4s of a node in the shell's buffer: (bottom, height), (top, 0), (lay, color). In metres of the world.
pub const NODE_VEC4S: u32 = 3;
/// Vec4s of a prism, behind the nodes: (corners, order), (links, triangle), (uv, uv), (uv, 0, 0).
pub const PRISM_VEC4S: u32 = 4;
/// Vec4s of a node at rest: (position, height), (normal, 0), (lay, color), (joints, weights).
pub const REST_VEC4S: u32 = 4;
/// Height of a vertex in [`CELL`]: the top of the shell.
const TOP: u32 = 255;

/// (node * 256 + height, prism * 16 + face) of a vertex; of one of several shells (node * 256 + shell, prism * 16 + face).
pub const CELL: MeshVertexAttribute = MeshVertexAttribute::new(
    "Undercoat_Cell",
    0x7c1f_93d2_40ab_5e01,
    VertexFormat::Uint32x2,
);

/// What a shell is built of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellShape {
    /// Thickness of the coat, model units.
    pub height: f32,
    /// Metres of the world in a model unit.
    pub world_scale: f32,
    /// Width of the tile, model units.
    pub tile: f32,
    /// Direction of the lay, model space.
    pub lay: Vec3,
    /// Where on the tile the mesh lies.
    pub offset: Vec2,
    /// Whether the shell lies below the skin, its top on it: under feathers, which are groomed on the top of the down.
    pub sunk: bool,
}

/// A shell ready to be uploaded.
#[derive(Clone, Debug)]
pub struct PackedShell {
    /// The shell at rest.
    pub shell: Shell,
    /// Nodes (zero, the extrusion fills them) and prisms.
    pub bytes: Vec<u8>,
    /// Nodes at rest.
    pub rest: Vec<u8>,
}

fn put(bytes: &mut Vec<u8>, values: [f32; 4]) {
    values
        .iter()
        .for_each(|value| bytes.extend(value.to_le_bytes()));
}

fn put_words(bytes: &mut Vec<u8>, words: [u32; 4]) {
    words
        .iter()
        .for_each(|word| bytes.extend(word.to_le_bytes()));
}

/// A linear color in three bytes, as square roots: dark ones keep their hue.
fn color_word(color: Option<&[f32; 3]>) -> u32 {
    let step = |value: f32| (value.clamp(0.0, 1.0).sqrt() * 255.0).round() as u32;
    color.map_or(u32::MAX, |c| {
        step(c[0]) | step(c[1]) << 8 | step(c[2]) << 16 | 0xff00_0000
    })
}

/// Place on the tile of a corner: the position seen along the largest axis of the triangle's normal, so that no texture
/// coordinates are needed and none can tear it or stretch it (by more than 1.73).
fn tile_place(position: Vec3, normal: Vec3, shape: &ShellShape) -> Vec2 {
    let size = normal.abs();
    let flat = if size.x >= size.y && size.x >= size.z {
        Vec2::new(position.z, position.y)
    } else if size.y >= size.z {
        Vec2::new(position.x, position.z)
    } else {
        Vec2::new(position.x, position.y)
    };
    let place = flat / shape.tile.max(f32::MIN_POSITIVE);
    // Wandering, so that the eye finds no rows of tiles.
    let wander = |phase: f32| {
        let p = position / shape.tile.max(f32::MIN_POSITIVE) * 1.7;
        (p.x + phase).sin() * (p.y * 0.8 + 2.0 * phase).cos() + (p.z * 0.9 + 3.0 * phase).sin()
    };
    place + 0.12 * Vec2::new(wander(0.3), wander(1.9)) + shape.offset
}

impl PackedShell {
    /// The shell over the triangles of a skin for which `chosen` says so.
    ///
    /// # Errors
    /// [`UndercoatError::Skin`] if nothing is chosen or the shell cannot be built.
    pub fn build(
        skin: &SkinMesh,
        chosen: impl Fn(usize) -> bool,
        lay: Option<&[Vec3]>,
        shape: &ShellShape,
    ) -> Result<Self, UndercoatError> {
        let fail = |message: String| UndercoatError::Skin { message };
        let triangles: Vec<[u32; 3]> = (0..skin.triangles.len())
            .filter(|t| chosen(*t))
            .map(|t| skin.triangles[t])
            .collect();
        if triangles.is_empty() {
            return Err(fail("no triangle is chosen".into()));
        }
        // Only what is used: a tract is a small part of a bird.
        let mut local = vec![u32::MAX; skin.positions.len()];
        let mut used = Vec::new();
        let mut indices = Vec::with_capacity(3 * triangles.len());
        for vertex in triangles.iter().flatten() {
            let slot = &mut local[*vertex as usize];
            if *slot == u32::MAX {
                *slot = used.len() as u32;
                used.push(*vertex as usize);
            }
            indices.push(*slot);
        }
        let positions: Vec<[f32; 3]> = used.iter().map(|v| skin.positions[*v].to_array()).collect();
        let heights = vec![shape.height; positions.len()];
        let shell = Shell::build(&positions, &indices, &heights)
            .map_err(|error| fail(error.to_string()))?;
        let mut bytes = vec![0; 16 * NODE_VEC4S as usize * shell.vertices.len()];
        bytes.reserve(16 * PRISM_VEC4S as usize * shell.prisms.len());
        for prism in &shell.prisms {
            let words = prism.words();
            put_words(&mut bytes, [words[0], words[1], words[2], words[3]]);
            put_words(&mut bytes, [words[4], words[5], words[6], words[7]]);
            let corners =
                [0, 1, 2].map(|k| Vec3::from(shell.vertices[prism.corners[k] as usize].position));
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let [a, b, c] = corners.map(|corner| tile_place(corner, normal, shape));
            put(&mut bytes, [a.x, a.y, b.x, b.y]);
            put(&mut bytes, [c.x, c.y, 0.0, 0.0]);
        }
        let mut rest = Vec::with_capacity(16 * REST_VEC4S as usize * shell.vertices.len());
        for vertex in &shell.vertices {
            let source = used[vertex.source as usize];
            // Of a tract the normals of the whole skin, so that neighbors meet.
            let whole = skin.node_of.get(source);
            let normal = whole
                .and_then(|node| skin.normals.get(*node as usize))
                .filter(|_| triangles.len() < skin.triangles.len())
                .map_or(Vec3::from(vertex.normal), |normal| *normal);
            let depth = if shape.sunk { vertex.height } else { 0.0 };
            let [x, y, z] = (Vec3::from(vertex.position) - depth * normal).to_array();
            put(&mut rest, [x, y, z, vertex.height * shape.world_scale]);
            let [x, y, z] = normal.to_array();
            put(&mut rest, [x, y, z, 0.0]);
            let along = lay
                .and_then(|lay| lay.get(*skin.node_of.get(source)? as usize))
                .copied()
                .unwrap_or(shape.lay);
            let color = color_word(skin.colors.get(source));
            put(
                &mut rest,
                [along.x, along.y, along.z, f32::from_bits(color)],
            );
            let (joints, weights) = skin.weights.get(source).copied().unwrap_or_default();
            let [a, b, c, d] = joints.map(u32::from);
            let [p, q, r, s] = weights.map(|w| (w.clamp(0.0, 1.0) * 65_535.0).round() as u32);
            put_words(
                &mut rest,
                [a | b << 16, c | d << 16, p | q << 16, r | s << 16],
            );
        }
        Ok(Self { shell, bytes, rest })
    }

    /// The outside of the shell: what rays enter through.
    pub fn outside(&self) -> Mesh {
        let cells = self
            .shell
            .faces
            .iter()
            .flat_map(|face| {
                let top = |corner: u32| (corner & 1) * TOP;
                face.corners
                    .map(|corner| [(corner >> 1) << 8 | top(corner), face.start])
            })
            .collect();
        cell_mesh(cells)
    }

    /// `count` shells (at most 256), from the skin to the tips: what lies over another comes later. The material says how many
    /// of them are drawn, and the shader at which height.
    pub fn shells(&self, count: u32) -> Mesh {
        let count = count.min(TOP + 1);
        let tops: &[ShellFace] = &self.shell.faces[..self.shell.tops];
        let mut cells = Vec::with_capacity(3 * tops.len() * count as usize);
        for shell in 0..count {
            for face in tops {
                cells.extend(
                    face.corners
                        .map(|corner| [(corner >> 1) << 8 | shell, face.start]),
                );
            }
        }
        cell_mesh(cells)
    }
}

fn cell_mesh(cells: Vec<[u32; 2]>) -> Mesh {
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(CELL, VertexAttributeValues::Uint32x2(cells))
}
