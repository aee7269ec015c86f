//! The prismatic shell over a skin: one prism a triangle, extruded along smoothed normals, three tetrahedra a prism.
//!
//! Corners of a prism are sorted by the id of their welded vertex, `a < b < c`, top corners marked with a dash. Its tetrahedra
//! are `(a, b, c, c')`, `(a, b, b', c')` and `(a, a', b', c')`: sorting makes both prisms at a wall cut it along the same diagonal.
//! The ten faces of a prism have the codes
//!
//! | code | face | tetrahedra |
//! |---|---|---|
//! | 0 | bottom `a b c` | 0, skin |
//! | 1 | `a b c'` | 0, 1 |
//! | 2 | `a b' c'` | 1, 2 |
//! | 3 | top `a' b' c'` | 2, air |
//! | 4, 5, 6 | lower halves of the walls `ab`, `bc`, `ac` | 1, 0, 0 |
//! | 7, 8, 9 | upper halves of the same walls | 2, 1, 2 |
//!
//! Only positions, normals and heights move with the skin; the rest is built once.

mod height;
mod links;
mod weld;

pub use height::{LOWEST_RATIO, area_ratio};

use crate::maths::Real;
use thiserror::Error;

/// Corner numbers (0..3 bottom, 3..6 top) of every face of a prism, in sorted order.
pub const FACE_CORNERS: [[u32; 3]; 10] = [
    [0, 1, 2],
    [0, 1, 5],
    [0, 4, 5],
    [3, 4, 5],
    [0, 1, 4],
    [1, 2, 5],
    [0, 2, 5],
    [0, 3, 4],
    [1, 4, 5],
    [0, 3, 5],
];

/// Faces of the three tetrahedra and the sign that turns the cross product of the sorted corners outwards, for a prism whose
/// sorted corners run counter-clockwise seen from the air.
pub const TET_FACES: [[(u32, i32); 4]; 3] = [
    [(0, -1), (1, 1), (6, -1), (5, 1)],
    [(4, 1), (1, -1), (2, 1), (8, -1)],
    [(7, -1), (9, 1), (2, -1), (3, 1)],
];

/// Tetrahedron of the prism that owns a wall's lower half (first three) or upper half.
pub const WALL_TETS: [u32; 6] = [1, 0, 0, 2, 1, 2];

/// No neighbor: the wall is a boundary.
pub const NO_LINK: u32 = u32::MAX;

/// Why no shell can be built.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShellError {
    /// The list of indices is no list of triangles.
    #[error("{0} indices are no whole number of triangles")]
    Indices(usize),
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, there are {vertices}")]
    Index {
        /// Number of the triangle.
        triangle: usize,
        /// The index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// The list of heights does not fit.
    #[error("{heights} heights for {vertices} vertices: give one a vertex")]
    Heights {
        /// Number of heights.
        heights: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A position or height is not finite, or a height negative.
    #[error("vertex {0}: position and height must be finite, the height at least 0")]
    Vertex(usize),
    /// More triangles than a link can name.
    #[error("{0} triangles, at most 2^28")]
    TooMany(usize),
}

/// A welded vertex of the skin (sheets that only touch have their own). 32 bytes on the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellVertex {
    /// Place on the skin, in the units and axes of the mesh.
    pub position: [f32; 3],
    /// Safe height of the shell, in the units of the mesh.
    pub height: f32,
    /// Smoothed normal, unit length.
    pub normal: [f32; 3],
    /// One of the vertices of the mesh at this place: skin that one to skin this.
    pub source: u32,
}

/// One triangle of the skin. 32 bytes on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prism {
    /// Welded vertices, ascending.
    pub corners: [u32; 3],
    /// Which corner of the mesh's triangle each one is (2 bits each), then bit 6: the sorted corners run clockwise seen from the
    /// air; bit 7: no volume (a triangle without area).
    pub order: u32,
    /// Behind the walls `ab`, `bc` and `ac`: `prism * 4 + wall` of the neighbor, or [`NO_LINK`].
    pub links: [u32; 3],
    /// Triangle of the mesh.
    pub triangle: u32,
}

impl Prism {
    /// The orientation: 1 where the sorted corners run counter-clockwise seen from the air, else -1.
    pub fn parity<T: Real>(&self) -> T {
        T::of(if self.order & 64 == 0 { 1.0 } else { -1.0 })
    }

    /// Corner of the mesh's triangle that the sorted corner `k` (0..3) is.
    pub fn source_corner(&self, k: usize) -> usize {
        ((self.order >> (2 * k.min(2))) & 3).min(2) as usize
    }

    /// A triangle without area has no volume.
    pub fn is_empty(&self) -> bool {
        self.order & 128 != 0
    }

    /// As the shader reads it.
    pub fn words(&self) -> [u32; 8] {
        let ([a, b, c], [x, y, z]) = (self.corners, self.links);
        [a, b, c, self.order, x, y, z, self.triangle]
    }
}

impl ShellVertex {
    /// The outer end: position plus height along the normal.
    pub fn top(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.position[k] + self.height * self.normal[k])
    }

    /// As the shader reads it: position, height, normal, source.
    pub fn words(&self) -> [u32; 8] {
        let (p, n) = (
            self.position.map(f32::to_bits),
            self.normal.map(f32::to_bits),
        );
        [
            p[0],
            p[1],
            p[2],
            self.height.to_bits(),
            n[0],
            n[1],
            n[2],
            self.source,
        ]
    }
}

/// A triangle of the shell's outside, where rays enter. 16 bytes on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShellFace {
    /// Its corners, counter-clockwise seen from outside: `vertex * 2`, plus 1 for the outer end.
    pub corners: [u32; 3],
    /// Where a ray starts: `prism * 16 + face code`.
    pub start: u32,
}

/// What building met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShellReport {
    /// Vertices of the mesh that share their place with another one.
    pub welded: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with more than two triangles, or with two that disagree about their orientation. All their triangles are walled.
    pub non_manifold_edges: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Vertices whose height had to be reduced.
    pub lowered: usize,
    /// Triangles that fold over all the same.
    pub folded: usize,
}

/// The shell of a mesh: plain arrays, as the GPU takes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shell {
    /// Welded vertices.
    pub vertices: Vec<ShellVertex>,
    /// One prism a triangle of the mesh, in the same order.
    pub prisms: Vec<Prism>,
    /// The outside: tops of all prisms with volume first, then walls.
    pub faces: Vec<ShellFace>,
    /// How many of `faces` are tops.
    pub tops: usize,
    /// What building met.
    pub report: ShellReport,
}

impl Shell {
    /// Builds the shell of a mesh; `heights` in the units of the mesh, one a vertex.
    pub fn build(
        positions: &[[f32; 3]],
        indices: &[u32],
        heights: &[f32],
    ) -> Result<Self, ShellError> {
        check(positions, indices, heights)?;
        let mut report = ShellReport::default();
        let (mut vertices, ids) = weld::weld(positions, heights, &mut report);
        let mut triangles = indices
            .chunks_exact(3)
            .map(|t| [0, 1, 2].map(|k: usize| ids[t[k] as usize]))
            .collect::<Vec<_>>();
        let torn = links::split(&mut vertices, &mut triangles, &mut report);
        let mut shell = Self {
            vertices,
            prisms: Vec::new(),
            faces: Vec::new(),
            tops: 0,
            report,
        };
        weld::normals(&mut shell.vertices, &triangles);
        height::limit(&mut shell.vertices, &triangles, &mut shell.report);
        links::link(&mut shell, &triangles, &torn);
        Ok(shell)
    }

    /// Place of a prism's corner, 0..3 bottom and 3..6 top.
    pub fn corner(&self, prism: usize, corner: usize) -> [f32; 3] {
        let vertex = &self.vertices[self.prisms[prism].corners[corner % 3] as usize];
        if corner < 3 {
            vertex.position
        } else {
            vertex.top()
        }
    }

    /// All six corners of a prism: a, b, c, a', b', c'.
    pub fn corners<T: Real>(&self, prism: usize) -> [[T; 3]; 6] {
        std::array::from_fn(|k| crate::maths::vector::of(self.corner(prism, k)))
    }
}

fn check(positions: &[[f32; 3]], indices: &[u32], heights: &[f32]) -> Result<(), ShellError> {
    let vertices = positions.len();
    if !indices.len().is_multiple_of(3) {
        return Err(ShellError::Indices(indices.len()));
    }
    if indices.len() / 3 >= 1 << 28 {
        return Err(ShellError::TooMany(indices.len() / 3));
    }
    if heights.len() != vertices {
        return Err(ShellError::Heights {
            heights: heights.len(),
            vertices,
        });
    }
    if let Some(i) = indices.iter().position(|i| *i as usize >= vertices) {
        return Err(ShellError::Index {
            triangle: i / 3,
            index: indices[i],
            vertices,
        });
    }
    let sound =
        |(p, h): (&[f32; 3], &f32)| p.iter().all(|x| x.is_finite()) && h.is_finite() && *h >= 0.0;
    match positions.iter().zip(heights).position(|v| !sound(v)) {
        Some(vertex) => Err(ShellError::Vertex(vertex)),
        None => Ok(()),
    }
}
