//! Nearest neighbors among fixed points: a k-d tree stored as the points' own order.

use bevy::math::Vec3;
use std::cmp::Ordering;

/// Points sorted so that the middle one of every range splits it along an axis: x at the root, then y, z, x and so on.
pub struct PointTree {
    points: Vec<(Vec3, u32)>,
}

/// A point found: the square of its distance, and its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Square of the distance, in the square of the points' unit.
    pub squared: f32,
    /// Number of the point in the order given to [`PointTree::new`].
    pub number: u32,
}

impl Near {
    /// Nearer first; of equally near ones the lower number. Points that are not numbers come last.
    fn order(&self, other: &Self) -> Ordering {
        let distance = self.squared.total_cmp(&other.squared);
        distance.then(self.number.cmp(&other.number))
    }
}

impl PointTree {
    /// A tree of these points, numbered in order.
    pub fn new(points: impl Iterator<Item = Vec3>) -> Self {
        let mut points: Vec<_> = points.zip(0..).collect();
        arrange(&mut points, 0);
        Self { points }
    }

    /// The `count` points nearest to `point`, nearest first; fewer if there are fewer.
    pub fn nearest(&self, point: Vec3, count: usize) -> Vec<Near> {
        let mut found = Vec::with_capacity(count + 1);
        if count > 0 {
            search(&self.points, 0, point, count, &mut found);
        }
        found
    }
}

fn arrange(points: &mut [(Vec3, u32)], axis: usize) {
    if points.len() < 2 {
        return;
    }
    let middle = points.len() / 2;
    let by_axis = |a: &(Vec3, u32), b: &(Vec3, u32)| a.0[axis].total_cmp(&b.0[axis]);
    let (low, _, high) = points.select_nth_unstable_by(middle, by_axis);
    arrange(low, (axis + 1) % 3);
    arrange(high, (axis + 1) % 3);
}

fn search(points: &[(Vec3, u32)], axis: usize, point: Vec3, count: usize, found: &mut Vec<Near>) {
    let middle = points.len() / 2;
    let Some(&(here, number)) = points.get(middle) else {
        return;
    };
    let near = Near {
        squared: here.distance_squared(point),
        number,
    };
    let place = found.partition_point(|other| other.order(&near).is_lt());
    found.insert(place, near);
    found.truncate(count);
    let (low, high) = (&points[..middle], &points[middle + 1..]);
    let aside = point[axis] - here[axis];
    let (first, second) = if aside < 0.0 {
        (low, high)
    } else {
        (high, low)
    };
    let next = (axis + 1) % 3;
    search(first, next, point, count, found);
    // The other side matters unless enough points are nearer than the plane between.
    let beyond = found.len() == count && found[count - 1].squared < aside * aside;
    if !beyond {
        search(second, next, point, count, found);
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
        let mut point = || Vec3::from_array(std::array::from_fn(|_| random.random::<f32>()));
        for length in [0, 1, 2, 7, 500] {
            // On a coarse lattice many points coincide, and many distances are equal.
            let points: Vec<_> = (0..length).map(|_| (point() * 6.0).floor() / 6.0).collect();
            let tree = PointTree::new(points.iter().copied());
            for count in [0, 1, 8] {
                for _ in 0..50 {
                    let place = point();
                    let mut all: Vec<_> = (0..)
                        .zip(&points)
                        .map(|(number, other)| Near {
                            squared: other.distance_squared(place),
                            number,
                        })
                        .collect();
                    all.sort_by(Near::order);
                    all.truncate(count);
                    assert_eq!(tree.nearest(place, count), all);
                }
            }
        }
    }

    #[test]
    fn survives_points_that_are_not_numbers() {
        let points = [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY, Vec3::ONE];
        let tree = PointTree::new(points.into_iter());
        assert_eq!(tree.nearest(Vec3::splat(0.1), 1)[0].number, 1);
        assert_eq!(tree.nearest(Vec3::NAN, 4).len(), 4);
    }
}
