//! Items that do not move, in square columns along z and cells within: what is near a point lies in few runs of memory, and four at a
//! time are compared with it.

use bevy::math::{IVec2, Vec2, Vec3, Vec4};

/// Columns at most.
const MOST: usize = 1 << 20;
/// Cells for each item at most.
const CELLS: usize = 16;
/// Furthest that is looked along any axis, sides of a column.
const FAR: f32 = 8.0;
/// What rounding takes from distances between columns, relative.
const ROUNDING: f32 = 1.0e-4;

/// Cells of a column that hold items.
#[derive(Clone, Copy, Default)]
struct Column {
    /// First of all cells.
    first: u32,
    /// How many.
    count: u32,
    /// Which the first is along z, counted from the origin.
    low: i32,
}

/// Items sorted by columns, those of one column from below (z) upwards.
pub struct Cells<T> {
    /// Corner of the columns, counted from the origin.
    low: IVec2,
    /// Columns along x and y.
    counts: [usize; 2],
    columns: Vec<Column>,
    /// Sides of a column, and of a cell along z.
    side: f32,
    deep: f32,
    /// First item of each cell, and of the end.
    starts: Vec<u32>,
    /// Coordinates of the items, with three more at the end that are nowhere.
    places: [Vec<f32>; 3],
    items: Vec<T>,
}

/// Whole sides below a coordinate.
fn sides(x: f32, side: f32) -> i32 {
    let x = x / side;
    let whole = x as i32;
    whole.saturating_sub(i32::from(x < whole as f32))
}

impl<T: Copy> Cells<T> {
    /// Sorts the items, but for those that are nowhere; those of equal z stay in their order. `side` of a column, above 0; wider where there would be too many.
    pub fn new(items: &[(Vec3, T)], side: f32) -> Self {
        let places = items.iter().map(|(place, _)| *place);
        let (low, high) = places
            .filter(|place| place.is_finite())
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let (low, high) = if low.is_finite() {
            (low, high)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        // No finer than the numbers are.
        let mut side = side
            .max(f32::MIN_POSITIVE)
            .max((high - low).max_element() * 1.0e-6);
        let range = |side: f32| {
            let corner = |place: Vec3| IVec2::new(sides(place.x, side), sides(place.y, side));
            let count =
                |axis: usize| corner(high)[axis].saturating_sub(corner(low)[axis]) as usize + 1;
            (corner(low), [count(0), count(1)])
        };
        while range(side).1.iter().product::<usize>() > MOST {
            side *= 1.25;
        }
        let (low, counts) = range(side);
        let mut cells = Self {
            low,
            counts,
            columns: vec![Column::default(); counts.iter().product()],
            side,
            deep: side,
            starts: Vec::new(),
            places: std::array::from_fn(|_| vec![f32::NAN; items.len() + 3]),
            items: Vec::with_capacity(items.len()),
        };
        let mut order: Vec<(u32, u32)> = items
            .iter()
            .zip(0..)
            .filter(|((place, _), _)| place.is_finite())
            .map(|((place, _), number)| (cells.column(*place) as u32, number))
            .collect();
        let z = |number: u32| items[number as usize].0.z;
        order.sort_by(|(a, i), (b, j)| a.cmp(b).then(z(*i).total_cmp(&z(*j))));
        loop {
            let mut sum = 0_usize;
            for run in order.chunk_by(|(a, _), (b, _)| a == b) {
                let ends = [run[0].1, run[run.len() - 1].1].map(|i| sides(z(i), cells.deep));
                let count = ends[1].saturating_sub(ends[0]).max(0) as usize + 1;
                cells.columns[run[0].0 as usize] = Column {
                    first: sum as u32,
                    count: count as u32,
                    low: ends[0],
                };
                sum += count;
            }
            if sum <= CELLS * items.len() + 1 {
                cells.starts = vec![0; sum + 1];
                break;
            }
            cells.deep *= 2.0;
        }
        for (to, (column, from)) in order.into_iter().enumerate() {
            let (place, item) = items[from as usize];
            for (list, x) in cells.places.iter_mut().zip(place.to_array()) {
                list[to] = x;
            }
            cells.items.push(item);
            let cell = cells.cell(&cells.columns[column as usize], place.z);
            cells.starts[cell + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut cells.starts {
            sum += *start;
            *start = sum;
        }
        cells
    }

    /// Column or row of a coordinate; the nearest there is.
    fn index(&self, axis: usize, x: f32) -> usize {
        let at = sides(x, self.side).saturating_sub(self.low[axis]).max(0);
        (at as usize).min(self.counts[axis] - 1)
    }

    fn column(&self, place: Vec3) -> usize {
        self.index(0, place.x) * self.counts[1] + self.index(1, place.y)
    }

    /// Cell of a column at a height; the nearest there is.
    fn cell(&self, column: &Column, z: f32) -> usize {
        let at = sides(z, self.deep).saturating_sub(column.low).max(0);
        column.first as usize + (at as usize).min(column.count.saturating_sub(1) as usize)
    }

    /// Calls `visit` with the square of the distance of every item no further from the point than `radius`, and no further than eight
    /// sides of a column along any axis; column by column, from below upwards.
    pub fn near(&self, point: Vec3, radius: f32, mut visit: impl FnMut(f32, &T)) {
        let reach = radius.min(self.side * FAR);
        let most = radius * radius;
        let [px, py, pz] = point.to_array().map(Vec4::splat);
        let squared = Vec4::splat(most);
        let [lowest, highest] = [point.z - reach, point.z + reach].map(Vec4::splat);
        let [xs, ys, zs] = &self.places;
        let flat = Vec2::new(point.x, point.y);
        let from = [0, 1].map(|axis| self.index(axis, flat[axis] - reach));
        let to = [0, 1].map(|axis| self.index(axis, flat[axis] + reach));
        // How far the point is from a row of columns.
        let away = |axis: usize, at: usize| {
            let low = (self.low[axis] + at as i32) as f32 * self.side;
            let above = flat[axis] - low - self.side;
            (low - flat[axis]).max(above).max(0.0)
        };
        for x in from[0]..to[0] + 1 {
            let aside = away(0, x);
            for y in from[1]..to[1] + 1 {
                let column = &self.columns[x * self.counts[1] + y];
                let aside = aside * aside + away(1, y) * away(1, y);
                let room = most * (1.0 + ROUNDING) - aside;
                if column.count == 0 || room < 0.0 {
                    continue;
                }
                let half = reach.min(room.sqrt() + ROUNDING * self.side);
                let mut at = self.starts[self.cell(column, point.z - half)] as usize;
                let end = self.starts[self.cell(column, point.z + half) + 1] as usize;
                // Four at a time, without iterators: a search visits millions.
                while at < end {
                    let z = Vec4::from_slice(&zs[at..]);
                    let dx = Vec4::from_slice(&xs[at..]) - px;
                    let dy = Vec4::from_slice(&ys[at..]) - py;
                    let dz = z - pz;
                    let distance = dx * dx + dy * dy + dz * dz;
                    let within = z.cmpge(lowest) & z.cmple(highest);
                    let mut hits = (distance.cmple(squared) & within).bitmask();
                    if hits != 0 {
                        let distance = distance.to_array();
                        if end - at < 4 {
                            hits &= (1 << (end - at)) - 1;
                        }
                        while hits != 0 {
                            let lane = hits.trailing_zeros() as usize;
                            hits &= hits - 1;
                            visit(distance[lane], &self.items[at + lane]);
                        }
                    }
                    at += 4;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn finds_what_a_full_search_finds() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut point = |wide: f32| {
            let place = Vec3::from_array(std::array::from_fn(|_| random.random::<f32>()));
            (place - 0.5) * wide
        };
        for count in [0, 1, 3, 400] {
            let mut items: Vec<(Vec3, u32)> = (0..count).map(|i| (point(2.0), i)).collect();
            if let Some((place, _)) = items.get_mut(1) {
                *place = Vec3::NAN;
            }
            let cells = Cells::new(&items, 0.1);
            for radius in [0.0, 0.03, 0.2, 0.7] {
                for _ in 0..40 {
                    let place = point(2.4);
                    let mut found = Vec::new();
                    cells.near(place, radius, |distance, number| {
                        found.push((*number, distance))
                    });
                    found.sort_by_key(|(number, _)| *number);
                    let all = items
                        .iter()
                        .map(|(at, number)| (*number, at.distance_squared(place)));
                    let all: Vec<(u32, f32)> = all
                        .filter(|(_, distance)| *distance <= radius * radius)
                        .collect();
                    assert_eq!(found, all, "{count} items, radius {radius}");
                }
            }
        }
    }

    #[test]
    fn survives_sizes_that_do_not_fit() {
        for wide in [0.0, 1.0e-30, 1.0e30, f32::INFINITY] {
            let items = [(Vec3::ZERO, 0), (Vec3::splat(wide), 1), (Vec3::NAN, 2)];
            let cells = Cells::new(&items, 1.0e-3);
            let mut found = Vec::new();
            cells.near(Vec3::ZERO, 0.0, |_, number| found.push(*number));
            assert!(found.contains(&0), "{wide}: {found:?}");
            cells.near(Vec3::NAN, 1.0, |_, _| {
                panic!("nothing is near what is no number")
            });
        }
    }
}
