//! Items that do not move, in columns of cubes: what is near a point lies in few runs of memory.

use bevy::{
    math::{IVec2, IVec3, Vec3},
    platform::collections::HashMap,
};
use std::ops::Range;

/// Items sorted by the cube that their places fall into: columns of cubes one after the other, each from below (z) upwards.
pub struct Columns<T> {
    cell: f32,
    /// Items of each column.
    columns: HashMap<IVec2, Range<usize>>,
    /// Cube of each item along its column.
    heights: Vec<i32>,
    items: Vec<T>,
}

impl<T> Columns<T> {
    /// Sorts the items; those of one cube stay in their order. `cell` is the side of a cube, above 0.
    pub fn new(items: impl IntoIterator<Item = (Vec3, T)>, cell: f32) -> Self {
        let cell = cell.max(f32::MIN_POSITIVE);
        let mut keyed: Vec<(IVec3, T)> = items
            .into_iter()
            .map(|(place, item)| (cube(place, cell), item))
            .collect();
        keyed.sort_by_key(|(cube, _)| cube.to_array());
        let mut columns: HashMap<IVec2, Range<usize>> = HashMap::default();
        for (i, (cube, _)) in keyed.iter().enumerate() {
            columns.entry(cube.truncate()).or_insert(i..i).end = i + 1;
        }
        let (heights, items) = keyed.into_iter().map(|(cube, item)| (cube.z, item)).unzip();
        Self {
            cell,
            columns,
            heights,
            items,
        }
    }

    /// Calls `visit` with runs of all items in the cubes that a box of this half side about the point touches (a superset of the
    /// sphere). A radius beyond eight cubes is cut.
    pub fn near(&self, point: Vec3, radius: f32, mut visit: impl FnMut(&[T])) {
        let reach = Vec3::splat(radius.min(self.cell * 8.0));
        let (low, high) = (
            cube(point - reach, self.cell),
            cube(point + reach, self.cell),
        );
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                let Some(column) = self.columns.get(&IVec2::new(x, y)) else {
                    continue;
                };
                let heights = &self.heights[column.clone()];
                let from = heights.partition_point(|z| *z < low.z);
                let to = heights.partition_point(|z| *z <= high.z);
                visit(&self.items[column.start + from..column.start + to]);
            }
        }
    }
}

fn cube(place: Vec3, cell: f32) -> IVec3 {
    (place / cell).floor().as_ivec3()
}
