//! Items that do not move, in square columns along z: what is near a point lies in few runs of memory.

use bevy::{
    math::{IVec2, Vec2, Vec3},
    platform::collections::HashMap,
};
use std::ops::Range;

/// Items sorted by the column that their places fall into, those of one column from below (z) upwards.
pub struct Columns<T> {
    side: f32,
    /// Items of each column.
    columns: HashMap<IVec2, Range<usize>>,
    /// z of each item.
    heights: Vec<f32>,
    items: Vec<T>,
}

impl<T> Columns<T> {
    /// Sorts the items; those of equal z stay in their order. `side` of a column, above 0.
    pub fn new(items: impl IntoIterator<Item = (Vec3, T)>, side: f32) -> Self {
        let side = side.max(f32::MIN_POSITIVE);
        let mut keyed: Vec<(IVec2, f32, T)> = items
            .into_iter()
            .map(|(place, item)| (column(place, side), place.z, item))
            .collect();
        keyed.sort_by(|(a, low, _), (b, high, _)| {
            a.to_array().cmp(&b.to_array()).then(low.total_cmp(high))
        });
        let mut columns: HashMap<IVec2, Range<usize>> = HashMap::default();
        for (i, (column, ..)) in keyed.iter().enumerate() {
            columns.entry(*column).or_insert(i..i).end = i + 1;
        }
        let (heights, items) = keyed.into_iter().map(|(_, z, item)| (z, item)).unzip();
        Self {
            side,
            columns,
            heights,
            items,
        }
    }

    /// Calls `visit` with runs of all items of this distance from the point at most, and of some a little beyond. A radius of more
    /// than eight columns is cut.
    pub fn near(&self, point: Vec3, radius: f32, mut visit: impl FnMut(&[T])) {
        let reach = Vec3::splat(radius.min(self.side * 8.0));
        let low = column(point - reach, self.side);
        let high = column(point + reach, self.side);
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                let Some(column) = self.columns.get(&IVec2::new(x, y)) else {
                    continue;
                };
                let heights = &self.heights[column.clone()];
                let from = heights.partition_point(|z| *z < point.z - reach.z);
                let to = from + heights[from..].partition_point(|z| *z <= point.z + reach.z);
                visit(&self.items[column.start + from..column.start + to]);
            }
        }
    }
}

fn column(place: Vec3, side: f32) -> IVec2 {
    (Vec2::new(place.x, place.y) / side).floor().as_ivec2()
}
