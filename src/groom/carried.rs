//! The vertices of a coat as the joints of one pose carry them.

use super::{leaf::Leaf, pose::blend};
use bevy::math::{Affine3A, Vec3};
use std::ops::Range;

/// One feather's block of vertices.
pub struct Block {
    /// First vertex.
    pub first: usize,
    /// Vertices across.
    pub wide: usize,
    /// Vertices along.
    pub rows: usize,
}

/// A place on a feather: three vertices and their shares.
pub type Spot = [(u32, f32); 3];

impl Block {
    #[inline]
    fn vertex(&self, i: usize, j: usize) -> u32 {
        (self.first + i * self.wide + j) as u32
    }

    /// The corners of the two triangles of a quad.
    #[inline]
    pub fn triangles(&self, i: usize, j: usize) -> [[u32; 3]; 2] {
        let (a, b) = (self.vertex(i, j), self.vertex(i, j + 1));
        let (c, d) = (self.vertex(i + 1, j + 1), self.vertex(i + 1, j));
        [[a, b, c], [a, c, d]]
    }

    /// Rows and columns of the first vertices of all quads.
    pub fn quads(&self) -> impl Iterator<Item = (usize, usize)> {
        self.quads_in(0..self.rows - 1)
    }

    /// Those whose first vertices lie in these rows.
    #[inline]
    pub fn quads_in(&self, rows: Range<usize>) -> impl Iterator<Item = (usize, usize)> + use<> {
        let wide = self.wide - 1;
        rows.flat_map(move |i| (0..wide).map(move |j| (i, j)))
    }

    /// The triangle of the mesh at shares across (-1..1) and along (0..1).
    pub fn spot(&self, across: f32, along: f32) -> Spot {
        let x = (0.5 + 0.5 * across).clamp(0.0, 1.0) * (self.wide - 1) as f32;
        let y = along.clamp(0.0, 1.0) * (self.rows - 1) as f32;
        let (j, i) = (
            (x as usize).min(self.wide - 2),
            (y as usize).min(self.rows - 2),
        );
        let (u, v) = (x - j as f32, y - i as f32);
        let (a, c) = (self.vertex(i, j), self.vertex(i + 1, j + 1));
        if u > v {
            [(a, 1.0 - u), (self.vertex(i, j + 1), u - v), (c, v)]
        } else {
            [(a, 1.0 - v), (self.vertex(i + 1, j), v - u), (c, u)]
        }
    }
}

/// The vertices of a coat in one pose, before they are raised in it.
pub struct Carried {
    /// Blocks, one per leaf.
    pub blocks: Vec<Block>,
    /// Places.
    pub places: Vec<Vec3>,
    /// Where a unit of height goes: the normal of bind pose as the joints carry it.
    pub normals: Vec<Vec3>,
    /// Median width of the cards, metres.
    pub median: f32,
}

impl Carried {
    /// Carries the leaves. `skinning`: what each joint, those of rows included, does to bind pose; empty: bind pose.
    pub fn new(leaves: &[Leaf], skinning: &[Affine3A]) -> Self {
        let mut blocks = Vec::with_capacity(leaves.len());
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        for leaf in leaves {
            let (rows, wide) = (leaf.shaft.points.len(), leaf.columns + 1);
            blocks.push(Block {
                first: places.len(),
                wide,
                rows,
            });
            let vertices = leaf.vertices();
            // What is raised in the first pose is raised further in another from there, as the renderer does it.
            let further = (!leaf.raised.is_empty()).then(|| leaf.vertex_normals(&vertices));
            for i in 0..rows {
                let map = blend(&leaf.weights_at(i), skinning);
                for j in 0..wide {
                    let x = 2.0 * j as f32 / leaf.columns as f32 - 1.0;
                    let at = i * wide + j;
                    let normal = further.as_ref().map_or(leaf.normal(i, x), |list| list[at]);
                    places.push(map.transform_point3(vertices[at]));
                    normals.push(map.transform_vector3(normal));
                }
            }
        }
        let mut widths: Vec<f32> = leaves.iter().map(|leaf| leaf.card.width).collect();
        widths.sort_by(f32::total_cmp);
        let median = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
        Self {
            blocks,
            places,
            normals,
            median,
        }
    }

    /// Places with heights.
    pub fn raised(&self, heights: &[f32]) -> Vec<Vec3> {
        let parts = self.places.iter().zip(&self.normals).zip(heights);
        parts.map(|((p, n), h)| *p + *n * *h).collect()
    }
}
