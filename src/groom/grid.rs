//! A grid of points for neighbor queries; its answers come in a fixed order.

use bevy::{
    math::{IVec3, Vec3},
    platform::collections::HashMap,
};

/// Points sorted into cubes of one size.
pub struct PointGrid {
    cell: f32,
    cells: HashMap<IVec3, Vec<u32>>,
}

impl PointGrid {
    /// An empty grid. `cell` is the side of a cube: queries of that radius are cheapest.
    pub fn new(cell: f32) -> Self {
        Self {
            cell: if cell.is_finite() && cell > 0.0 {
                cell
            } else {
                1.0
            },
            cells: HashMap::default(),
        }
    }

    /// A grid of all these points, numbered in order.
    pub fn of(points: &[Vec3], cell: f32) -> Self {
        let mut grid = Self::new(cell);
        points
            .iter()
            .enumerate()
            .for_each(|(i, &point)| grid.insert(i as u32, point));
        grid
    }

    fn key(&self, point: Vec3) -> IVec3 {
        (point / self.cell).floor().as_ivec3()
    }

    /// Adds a point.
    pub fn insert(&mut self, number: u32, point: Vec3) {
        self.cells.entry(self.key(point)).or_default().push(number);
    }

    /// Calls `visit` with every point in the cubes that a box of this half side touches (a superset of the sphere). A radius
    /// beyond eight cubes is cut.
    pub fn near(&self, point: Vec3, radius: f32, mut visit: impl FnMut(u32)) {
        let reach = Vec3::splat(radius.min(self.cell * 8.0));
        let (low, high) = (self.key(point - reach), self.key(point + reach));
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    if let Some(list) = self.cells.get(&IVec3::new(x, y, z)) {
                        list.iter().for_each(|&number| visit(number));
                    }
                }
            }
        }
    }
}
