//! The range query as published (Chen et al. 2026, Eq. 12-19), kept for the charts: the spatial method with Gauss-Legendre
//! nodes across the barbs and a sum over barbules at each of them.
//!
//! Two kindnesses without which it does not work at all: the interval is clipped to four sigmas of the footprint (as written,
//! six nodes over a whole gap miss a narrow footprint), and the overlap looks at the three nearest distal barbules only.

use super::{
    math::{Real, clamp, normal_distribution},
    vane::{Cell, Local},
};

/// Gauss-Legendre nodes and weights on [-1, 1] by Newton's method on the Legendre polynomial.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|i| {
            let n = count as f64;
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut q) = (1.0, x);
                for j in 2..=count {
                    let j = j as f64;
                    (p, q) = (q, ((2.0 * j - 1.0) * x * q - (j - 1.0) * p) / j);
                }
                slope = n * (x * q - p) / (x * x - 1.0);
                let step = q / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Mass of an interval under a Gaussian.
fn interval<T: Real>(low: T, high: T, mean: T, sigma: T) -> T {
    if high <= low {
        return T::zero();
    }
    normal_distribution((high - mean) / sigma) - normal_distribution((low - mean) / sigma)
}

/// `[barb, upper, lower]` coverage by the spatial method with the given nodes per gap.
pub fn spatial<T: Real>(cell: &Cell<T>, local: &Local<T>, nodes: &[(T, T)]) -> [T; 3] {
    let zero = T::zero();
    let one = T::one();
    let half = T::of(0.5);
    let sigma_u = local.variance.sqrt();
    let sigma = local.conditional.sqrt();
    let reach = T::of(4.0) * sigma_u;
    let mut barb = zero;
    let mut upper = zero;
    let mut lower = zero;
    let mut k = (local.u - reach - one).floor();
    let last = local.u + reach + one;
    while k <= last {
        // Eq. 12: the barb between this gap and the last.
        barb = barb + interval(k - (one - cell.v_high), k + cell.v_low, local.u, sigma_u);
        let low = (k + cell.v_low).max(local.u - reach);
        let high = (k + cell.v_high).min(local.u + reach);
        if high > low {
            for (x, weight) in nodes {
                let u = half * (low + high) + half * (high - low) * *x;
                let z = (u - local.u) / sigma_u;
                let mass = half * (high - low) * *weight * super::math::normal_density(z) / sigma_u;
                let mean = local.tau + local.slope * (u - local.u);
                let c_d = cell.kappa * (u - k) + k * cell.e_root + cell.s_d;
                let c_p = cell.kappa * (k + one - u) + (k + one) * cell.e_root + cell.s_p;
                let span = T::of(4.0) * sigma + one;
                // Eq. 15-16.
                let mut j = (mean - span - c_d).floor();
                while j <= mean + span - c_d {
                    let c = c_d + j;
                    upper = upper + mass * interval(c - cell.h_d, c + cell.h_d, mean, sigma);
                    j = j + one;
                }
                // Eq. 18-19.
                let mut j = (mean - span - c_p).floor();
                while j <= mean + span - c_p {
                    let c = c_p + j;
                    let mut visible = interval(c - cell.h_p, c + cell.h_p, mean, sigma);
                    let nearest = (c - c_d + half).floor();
                    for offset in [-one, zero, one] {
                        let d = c_d + nearest + offset;
                        let from = (d - cell.h_d).max(c - cell.h_p);
                        let to = (d + cell.h_d).min(c + cell.h_p);
                        visible = visible - interval(from, to, mean, sigma);
                    }
                    lower = lower + mass * visible;
                    j = j + one;
                }
            }
        }
        k = k + one;
    }
    [clamp(barb, zero, one), upper, lower]
}
