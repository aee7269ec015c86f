//! The shaft curve F_P as a natural cubic spline.

use super::Rachis;
use crate::maths::card;

/// A natural cubic spline through values at equal steps of 0..1.
#[derive(Clone, Debug)]
pub struct Spline {
    values: Vec<f64>,
    /// Second derivative at each value, per squared step.
    bends: Vec<f64>,
}

impl Spline {
    /// Fits the spline (tridiagonal system, bend 0 at both ends). One value makes a constant, none makes 0.
    pub fn new(values: &[f32]) -> Self {
        let values: Vec<f64> = values.iter().map(|&value| f64::from(value)).collect();
        let n = values.len();
        let mut bends = vec![0.0; n];
        let mut upper = vec![0.0; n];
        for i in 1..n.saturating_sub(1) {
            let pivot = 4.0 - upper[i - 1];
            let right = 6.0 * (values[i + 1] - 2.0 * values[i] + values[i - 1]);
            upper[i] = 1.0 / pivot;
            bends[i] = (right - bends[i - 1]) / pivot;
        }
        for i in (1..n.saturating_sub(1)).rev() {
            bends[i] -= upper[i] * bends[i + 1];
        }
        Self { values, bends }
    }

    /// Value and derivative at `v`, clamped to 0..1.
    pub fn at(&self, v: f64) -> (f64, f64) {
        let n = self.values.len();
        if n < 2 {
            return (self.values.first().copied().unwrap_or(0.0), 0.0);
        }
        let steps = (n - 1) as f64;
        let place = if v.is_finite() {
            v.clamp(0.0, 1.0) * steps
        } else {
            0.0
        };
        let i = (place as usize).min(n - 2);
        let t = place - i as f64;
        let (y0, y1, m0, m1) = (
            self.values[i],
            self.values[i + 1],
            self.bends[i],
            self.bends[i + 1],
        );
        let s = 1.0 - t;
        let value = s * y0 + t * y1 + ((s * s * s - s) * m0 + (t * t * t - t) * m1) / 6.0;
        let slope = y1 - y0 + ((1.0 - 3.0 * s * s) * m0 + (3.0 * t * t - 1.0) * m1) / 6.0;
        (value, slope * steps)
    }
}

impl Rachis {
    /// F_P as a spline over v.
    pub fn spline(&self) -> Spline {
        Spline::new(&self.curve)
    }
}

/// Map M of one feather with its spline at hand.
#[derive(Clone, Debug)]
pub struct FeatherMap {
    spline: Spline,
    aspect: f64,
}

impl FeatherMap {
    /// F_P and F_P' at v.
    pub fn curve(&self, v: f64) -> (f64, f64) {
        self.spline.at(v)
    }

    /// Canonical point of `uv`.
    pub fn canonical(&self, uv: [f64; 2]) -> [f64; 2] {
        card::canonical(uv, self.spline.at(uv[1]).0, self.aspect)
    }

    /// `uv` of a canonical point.
    pub fn uv(&self, point: [f64; 2]) -> [f64; 2] {
        card::uv(point, self.spline.at(point[1]).0, self.aspect)
    }

    /// Rows of d(canonical)/d(uv) at v.
    pub fn jacobian(&self, v: f64) -> [[f64; 2]; 2] {
        card::jacobian(self.spline.at(v).1, self.aspect)
    }

    /// Gaussian of a pixel, see [`card::canonical_footprint`].
    pub fn footprint(
        &self,
        uv: [f64; 2],
        duv_dx: [f64; 2],
        duv_dy: [f64; 2],
    ) -> crate::maths::Footprint<f64> {
        let (curve, slope) = self.spline.at(uv[1]);
        card::canonical_footprint(uv, duv_dx, duv_dy, curve, slope, self.aspect)
    }
}

impl super::Feather {
    /// The map M of this feather.
    pub fn map(&self) -> FeatherMap {
        FeatherMap {
            spline: self.rachis.spline(),
            aspect: f64::from(self.aspect),
        }
    }
}
