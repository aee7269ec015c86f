//! The periodic block of fibres that a coat repeats over the skin.

use bevy::math::{UVec3, Vec3};

/// A block of fibres, periodic along x and y (the skin), from the skin (z = 0) to the top of the coat (z = 1).
///
/// Extinction is in optical depth per height of the coat: a uniform tile of extinction 4 hides `1 - exp(-4)` of the skin seen
/// straight down. Cells are stored x fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    size: UVec3,
    /// Width of the tile in heights of the coat, at least 0.
    width: f32,
    extinction: Vec<f32>,
    tangent: Vec<Vec3>,
}

impl Tile {
    /// A tile of `size` cells, `width` heights wide; `extinction` and `tangent` (unit length, coverage-weighted direction of
    /// the fibres in the frame of the skin) hold one value a cell. `None` if a length does not fit `size`, or if a value is
    /// not finite or an extinction negative.
    pub fn new(size: UVec3, width: f32, extinction: Vec<f32>, tangent: Vec<Vec3>) -> Option<Self> {
        let cells = size.as_usizevec3().element_product();
        let sound = cells > 0
            && width.is_finite()
            && width > 0.0
            && extinction.len() == cells
            && tangent.len() == cells
            && extinction.iter().all(|e| e.is_finite() && *e >= 0.0)
            && tangent.iter().all(|t| t.is_finite());
        sound.then_some(Self {
            size,
            width,
            extinction,
            tangent,
        })
    }

    /// Cells along x, y and z.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Width of the tile along x and y, in heights of the coat.
    pub fn width(&self) -> f32 {
        self.width
    }

    /// Extinction of every cell, x fastest, in optical depth per height of the coat.
    pub fn extinction(&self) -> &[f32] {
        &self.extinction
    }

    /// Direction of the fibres of every cell.
    pub fn tangent(&self) -> &[Vec3] {
        &self.tangent
    }

    /// Index of a cell: x and y wrap, z is clamped.
    pub fn cell(&self, x: i32, y: i32, z: i32) -> usize {
        let size = self.size.as_ivec3();
        let (x, y) = (x.rem_euclid(size.x), y.rem_euclid(size.y));
        let z = z.clamp(0, size.z - 1);
        (x + size.x * (y + size.y * z)) as usize
    }
}
