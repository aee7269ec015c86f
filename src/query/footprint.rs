//! The pixel footprint.

use super::math::{Real, clamp};

/// A Gaussian over the canonical plane: what one pixel sees (Chen et al. 2026, Sec. 5.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint<T> {
    /// Mean `[x, y]` in feather lengths.
    pub mean: [T; 2],
    /// Covariance `[xx, xy, yy]` in feather lengths squared.
    pub covariance: [T; 3],
}

/// Largest ratio of the axes of a footprint that the evaluators get to see, squared.
pub(crate) const ASPECT_SQUARED: f64 = 256.0;
/// Smallest variance of a footprint, feather lengths squared (a few nanometres on a 100 mm feather).
pub(crate) const LEAST_VARIANCE: f64 = 1e-16;

impl<T: Real> Footprint<T> {
    /// A round footprint.
    pub fn round(mean: [T; 2], sigma: T) -> Self {
        Self {
            mean,
            covariance: [sigma * sigma, T::zero(), sigma * sigma],
        }
    }

    /// The footprint with its minor axis widened to a sixteenth of the major one, as texture filtering does: thinner lines
    /// cost without bound and show nothing. Not a number, infinities and negative variances are replaced.
    ///
    /// Also returns the determinant of the covariance, free of the cancellation in `xx yy - xy^2`.
    pub fn widened(&self) -> (Self, T) {
        let limit = T::of(16.0);
        let mean = self
            .mean
            .map(|x| clamp(if x.is_nan() { T::zero() } else { x }, -limit, limit));
        let [xx, xy, yy] = self.covariance;
        let least = T::of(LEAST_VARIANCE);
        let xx = clamp(xx, least, T::of(256.0));
        let yy = clamp(yy, least, T::of(256.0));
        let bound = (xx * yy).sqrt();
        let xy = clamp(if xy.is_nan() { T::zero() } else { xy }, -bound, bound);
        let half = T::of(0.5) * (xx + yy);
        let d = T::of(0.5) * (xx - yy);
        let r = (d * d + xy * xy).sqrt();
        let major = half + r;
        let minor = half - r;
        let floor = (major * T::of(1.0 / ASPECT_SQUARED)).max(least);
        if minor >= floor {
            return (
                Self {
                    mean,
                    covariance: [xx, xy, yy],
                },
                minor * major,
            );
        }
        // r > 0 here, because the major axis is at least twice the floor or both equal the least variance.
        let share = T::of(0.5) * (floor - minor) / r.max(T::of(1e-30));
        let covariance = [xx + share * (r - d), xy - share * xy, yy + share * (r + d)];
        (Self { mean, covariance }, floor * major)
    }

    /// Mirror image at the rachis: brings the right vane to where the left one is.
    pub fn mirrored(&self) -> Self {
        let [x, y] = self.mean;
        let [xx, xy, yy] = self.covariance;
        Self {
            mean: [-x, y],
            covariance: [xx, -xy, yy],
        }
    }
}
