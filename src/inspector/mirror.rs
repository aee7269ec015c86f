//! The plane that a bird is its own mirror image in.

use crate::groom::PointTree;
use bevy::math::{DMat3, DVec3, Vec3};

/// Most points looked at.
const SAMPLES: usize = 800;
/// Most rounds of pairing points with their images.
const ROUNDS: usize = 24;
/// Share of the pairs that count: the rest may be what only one side has.
const KEPT: f64 = 0.85;
/// Largest mean distance of an image from the nearest point, in sizes of the whole, that still counts as symmetry.
const TOLERANCE: f64 = 0.03;

/// A plane that a shape is symmetric in: all points with `normal * point == offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPlane {
    /// Unit normal.
    pub normal: Vec3,
    /// Distance from the origin along the normal, in the unit of the points.
    pub offset: f32,
}

impl MirrorPlane {
    /// The plane that a groom's `mirror` flags mean: x = 0.
    pub const MODEL: Self = Self {
        normal: Vec3::X,
        offset: 0.0,
    };

    /// The mirror image of a point.
    pub fn image(&self, point: Vec3) -> Vec3 {
        point - self.normal * (2.0 * (self.normal.dot(point) - self.offset))
    }

    /// The same plane in another unit: `factor` units of the new kind in one of the old.
    pub fn scaled(self, factor: f32) -> Self {
        Self {
            offset: self.offset * factor,
            ..self
        }
    }

    /// Whether this is the plane of a groom's `mirror` flags, to within `tolerance` at this distance from the origin.
    pub fn is_model(&self, reach: f32, tolerance: f32) -> bool {
        let tilt = self.normal.cross(Vec3::X).length();
        tilt * reach + self.offset.abs() <= tolerance
    }

    /// The plane that these points (of a skin in bind pose) are symmetric in, if there is one.
    ///
    /// Every point's image is paired with the nearest point; the plane that fits the pairs best (least squares over all but
    /// the worst) pairs anew, from several first guesses. Of planes that are about as good the first wins, so that a shape
    /// that is symmetric in several keeps the usual one, x = 0.
    pub fn find(points: &[Vec3]) -> Option<Self> {
        let step = points.len().div_ceil(SAMPLES).max(1);
        let sample: Vec<DVec3> = points
            .iter()
            .filter(|point| point.is_finite())
            .step_by(step)
            .map(|point| point.as_dvec3())
            .collect();
        let all: Vec<Vec3> = points
            .iter()
            .copied()
            .filter(|point| point.is_finite())
            .collect();
        if sample.len() < 4 {
            return None;
        }
        let count = sample.len() as f64;
        let middle = sample.iter().copied().sum::<DVec3>() / count;
        let size = (sample
            .iter()
            .map(|p| (*p - middle).length_squared())
            .sum::<f64>()
            / count)
            .sqrt();
        if size <= 0.0 {
            return None;
        }
        let tree = PointTree::new(all.iter().copied());
        let mut spread = DMat3::ZERO;
        for point in &sample {
            let from = *point - middle;
            spread += DMat3::from_cols(from * from.x, from * from.y, from * from.z);
        }
        // The normal is a principal axis, but for what only one side has; else it is likely an axis of the model.
        let normals = principal_axes(spread)
            .into_iter()
            .chain([DVec3::X, DVec3::Z]);
        let found: Vec<_> = std::iter::once((DVec3::X, 0.0))
            .chain(normals.map(|normal| (normal, normal.dot(middle))))
            .map(|start| refine(&sample, &tree, &all, start))
            .collect();
        let least = found
            .iter()
            .map(|(_, error)| *error)
            .fold(f64::INFINITY, f64::min);
        let enough = (1.2 * least + 1e-3 * size).min(TOLERANCE * size);
        found
            .into_iter()
            .find(|(_, error)| *error <= enough)
            .map(|((normal, offset), _)| Self {
                normal: normal.as_vec3(),
                offset: offset as f32,
            })
    }
}

/// The best plane near a first guess, and the mean distance of images from the points.
fn refine(
    sample: &[DVec3],
    tree: &PointTree,
    all: &[Vec3],
    (mut normal, mut offset): (DVec3, f64),
) -> ((DVec3, f64), f64) {
    let mut best = ((normal, offset), f64::INFINITY);
    for _ in 0..=ROUNDS {
        let mut pairs: Vec<(f64, DVec3, DVec3)> = sample
            .iter()
            .map(|&point| {
                let image = point - normal * (2.0 * (normal.dot(point) - offset));
                let nearest = tree.nearest(image.as_vec3(), 1);
                let other = nearest
                    .first()
                    .and_then(|near| all.get(near.number as usize))
                    .map_or(image, |other| other.as_dvec3());
                (image.distance(other), point, other)
            })
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.truncate(((pairs.len() as f64 * KEPT) as usize).max(3));
        let count = pairs.len() as f64;
        let error = pairs.iter().map(|pair| pair.0).sum::<f64>() / count;
        if error < best.1 {
            best = ((normal, offset), error);
        }
        // |q' - (I - 2 n n^T) p'|^2 summed is least for the n that makes n^T (P Q^T + Q P^T) n least.
        let (p, q) = pairs
            .iter()
            .fold((DVec3::ZERO, DVec3::ZERO), |(p, q), pair| {
                (p + pair.1, q + pair.2)
            });
        let (p, q) = (p / count, q / count);
        let mut moment = DMat3::ZERO;
        for (_, a, b) in &pairs {
            let (a, b) = (*a - p, *b - q);
            moment += DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        }
        let last = normal;
        [normal, ..] = principal_axes(moment + moment.transpose());
        offset = normal.dot(p + q) * 0.5;
        if last.cross(normal).length() < 1e-7 && error >= best.1 {
            break;
        }
    }
    best
}

/// Unit eigenvectors of a symmetric matrix by rising eigenvalue, by Jacobi's rotations.
fn principal_axes(mut matrix: DMat3) -> [DVec3; 3] {
    let mut axes = DMat3::IDENTITY;
    for _ in 0..12 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b, c) = (matrix.col(i)[i], matrix.col(j)[j], matrix.col(j)[i]);
            if c == 0.0 {
                continue;
            }
            let (sin, cos) = (0.5 * (2.0 * c).atan2(b - a)).sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(i)[i] = cos;
            turn.col_mut(j)[j] = cos;
            turn.col_mut(j)[i] = sin;
            turn.col_mut(i)[j] = -sin;
            matrix = turn.transpose() * matrix * turn;
            axes *= turn;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| matrix.col(i)[i].total_cmp(&matrix.col(j)[j]));
    order.map(|i| axes.col(i).try_normalize().unwrap_or(DVec3::X))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Quat;

    /// Points of a bird-like shape symmetric in x = 0, which no turn brings onto itself, and something on one side only.
    fn shape() -> Vec<Vec3> {
        let mut points = Vec::new();
        for i in 0..40 {
            for j in 0..40 {
                let (along, around) = (i as f32 / 39.0, j as f32 / 39.0 * std::f32::consts::PI);
                let girth = 0.3 * (1.0 - along) + 0.05 + 0.2 * (along * 5.0).sin().max(0.0);
                // The wings spread in the middle.
                let wide = 1.0 + 2.0 * (-((along - 0.4) * 6.0).powi(2)).exp() * around.sin();
                let half = Vec3::new(
                    girth * wide * around.sin(),
                    girth * around.cos() - along * along,
                    along * 2.0,
                );
                points.extend([half, half * Vec3::new(-1.0, 1.0, 1.0)]);
            }
        }
        points.extend((0..60).map(|i| Vec3::new(0.5, 0.1 + 0.005 * i as f32, 0.2)));
        points
    }

    #[test]
    fn the_plane_is_found_wherever_the_shape_stands() {
        for (turn, shift) in [
            (Quat::IDENTITY, Vec3::ZERO),
            (Quat::from_rotation_y(0.2), Vec3::new(0.3, -1.0, 2.0)),
            (Quat::from_rotation_y(1.5), Vec3::new(-4.0, 0.0, 0.5)),
            (
                Quat::from_rotation_z(0.15) * Quat::from_rotation_y(-0.25),
                Vec3::ZERO,
            ),
        ] {
            let points: Vec<Vec3> = shape().iter().map(|p| turn * *p + shift).collect();
            let plane = MirrorPlane::find(&points).unwrap();
            let normal = turn * Vec3::X;
            assert!(
                plane.normal.cross(normal).length() < 2e-3,
                "{plane:?} {normal}"
            );
            let miss = plane.normal.dot(shift) - plane.offset;
            assert!(miss.abs() < 2e-3, "{miss}");
            assert_eq!(
                plane.is_model(2.0, 0.02),
                turn == Quat::IDENTITY && shift == Vec3::ZERO
            );
            // An image's image is the point itself.
            let point = Vec3::new(0.3, 0.2, -0.4);
            assert!(plane.image(plane.image(point)).distance(point) < 1e-5);
            assert!(plane.image(point).distance(point) > 0.01);
        }
    }

    #[test]
    fn a_shape_without_symmetry_has_no_plane() {
        let spiral: Vec<Vec3> = (0..900)
            .map(|i| {
                let t = i as f32 * 0.01;
                Vec3::new(t.cos() * (1.0 + t), t.sin() * (1.0 + t * 0.5), t * t * 0.2)
            })
            .collect();
        assert_eq!(MirrorPlane::find(&spiral), None);
        assert_eq!(MirrorPlane::find(&[]), None);
        assert_eq!(MirrorPlane::find(&[Vec3::ONE; 30]), None);
        assert_eq!(MirrorPlane::find(&[Vec3::NAN; 30]), None);
    }
}
