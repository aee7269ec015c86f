//! The spatial method (Chen et al. 2026, Eq. 12-19): Gauss-Legendre nodes across the barbs and a sum over barbules at each.

use bevy_plumage::maths::functions::{Real, clamp, normal_density, normal_distribution};
use bevy_plumage::maths::query::vane::{Cell, Local};

/// Most gaps that are visited: four deviations either side of a footprint 30 gaps wide.
pub const MAX_PUBLISHED_GAPS: i32 = 256;
/// Most barbules that are summed at a node. Of a longer footprint those around its middle stand for all.
pub const MAX_BARBULES: i32 = 1024;

/// Mass of an interval under a Gaussian.
fn interval<T: Real>(low: T, high: T, mean: T, sigma: T) -> T {
    if high <= low {
        return T::zero();
    }
    normal_distribution((high - mean) / sigma) - normal_distribution((low - mean) / sigma)
}

/// First index and number of the barbules within `span` of `at`, at most [`MAX_BARBULES`] around it.
fn barbules<T: Real>(at: T, span: T) -> (T, i32) {
    let span = span.min(T::of(f64::from(MAX_BARBULES / 2)));
    let first = (at - span).ceil();
    let count = (at + span - first).floor().to_i32().unwrap_or(0) + 1;
    (first, count.min(MAX_BARBULES))
}

/// Eq. 15-19 at one node: mass of the upper family and of what is left of the lower one, at `u` in gap `k`.
fn node<T: Real>(cell: &Cell<T>, local: &Local<T>, k: T, u: T) -> [T; 2] {
    let (one, half) = (T::one(), T::of(0.5));
    let sigma = local.conditional.sqrt();
    let mean = local.tau + local.slope * (u - local.u);
    let c_d = cell.kappa * (u - k) + k * cell.e_root + cell.s_d;
    let c_p = cell.kappa * (k + one - u) + (k + one) * cell.e_root + cell.s_p;
    let span = T::of(4.0) * sigma + one;
    let reach = T::of(f64::from(MAX_BARBULES / 2));
    let all = if span > reach {
        interval(mean - reach, mean + reach, mean, sigma)
    } else {
        one
    };
    let mut upper = T::zero();
    let (first, count) = barbules(mean - c_d, span);
    for j in 0..count {
        let c = c_d + first + T::of(f64::from(j));
        upper = upper + interval(c - cell.h_d, c + cell.h_d, mean, sigma);
    }
    let mut lower = T::zero();
    let (first, count) = barbules(mean - c_p, span);
    for j in 0..count {
        let c = c_p + first + T::of(f64::from(j));
        lower = lower + interval(c - cell.h_p, c + cell.h_p, mean, sigma);
        let nearest = (c - c_d + half).floor();
        for offset in [-one, T::zero(), one] {
            let d = c_d + nearest + offset;
            let from = (d - cell.h_d).max(c - cell.h_p);
            let to = (d + cell.h_d).min(c + cell.h_p);
            lower = lower - interval(from, to, mean, sigma);
        }
    }
    [upper / all, lower / all]
}

fn integrate<T: Real>(cell: &Cell<T>, local: &Local<T>, nodes: &[(T, T)], clipped: bool) -> [T; 3] {
    let one = T::one();
    let half = T::of(0.5);
    let sigma = local.variance.sqrt();
    let reach = T::of(4.0) * sigma;
    let mut sum = [T::zero(); 3];
    let first = (local.u - reach - one).floor();
    let gaps = (local.u + reach + one - first).to_i32().unwrap_or(0) + 1;
    for i in 0..gaps.min(MAX_PUBLISHED_GAPS) {
        let k = first + T::of(f64::from(i));
        // Eq. 12: the barb between this gap and the last.
        sum[0] = sum[0] + interval(k - (one - cell.v_high), k + cell.v_low, local.u, sigma);
        let (mut low, mut high) = (k + cell.v_low, k + cell.v_high);
        if clipped {
            low = low.max(local.u - reach);
            high = high.min(local.u + reach);
        }
        if high <= low {
            continue;
        }
        for (x, weight) in nodes {
            let u = half * (low + high) + half * (high - low) * *x;
            let mass =
                half * (high - low) * *weight * normal_density((u - local.u) / sigma) / sigma;
            let [upper, lower] = node(cell, local, k, u);
            sum[1] = sum[1] + mass * upper;
            sum[2] = sum[2] + mass * lower;
        }
    }
    [clamp(sum[0], T::zero(), one), sum[1], sum[2]]
}

/// `[barb, upper, lower]` coverage by the spatial method with the given nodes per gap, with two kindnesses without which it does
/// not work at all: the interval is clipped to four deviations of the footprint, and the overlap looks at the three nearest
/// distal barbules only.
pub fn spatial<T: Real>(cell: &Cell<T>, local: &Local<T>, nodes: &[(T, T)]) -> [T; 3] {
    integrate(cell, local, nodes, true)
}

/// The same with the nodes spread over the whole gap, as Eq. 15 is printed: they miss a footprint narrower than their spacing.
pub fn spatial_whole_gap<T: Real>(cell: &Cell<T>, local: &Local<T>, nodes: &[(T, T)]) -> [T; 3] {
    integrate(cell, local, nodes, false)
}
