//! The pixel footprint.

use super::{
    error::QueryError,
    functions::{Real, clamp},
};

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
    /// A footprint from its mean and covariance `[xx, xy, yy]`, or what is wrong with them: each has to be finite, the mean within 16
    /// feather lengths, the variances 0 to 256, and `xy` at most `sqrt(xx yy)` (to rounding). A singular covariance is one.
    ///
    /// The fields are public, and every function of the query moves what is not a footprint to the nearest one instead of
    /// failing; this is for callers that want to know.
    pub fn new(mean: [T; 2], covariance: [T; 3]) -> Result<Self, QueryError> {
        let check = |field: &'static str, value: T, low: f64, high: f64| {
            let value = value.to_f64().unwrap_or(f64::NAN);
            if !value.is_finite() {
                Err(QueryError::NotFinite { field, value })
            } else if value < low || value > high {
                Err(QueryError::OutOfRange {
                    field,
                    value,
                    low,
                    high,
                })
            } else {
                Ok(())
            }
        };
        check("mean[0]", mean[0], -16.0, 16.0)?;
        check("mean[1]", mean[1], -16.0, 16.0)?;
        check("covariance[0]", covariance[0], 0.0, 256.0)?;
        check("covariance[2]", covariance[2], 0.0, 256.0)?;
        let bound = (covariance[0] * covariance[2])
            .sqrt()
            .to_f64()
            .unwrap_or(0.0);
        let bound = bound * (1.0 + 1e-5) + 1e-30;
        check("covariance[1]", covariance[1], -bound, bound)?;
        Ok(Self { mean, covariance })
    }

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
