//! The judge: coverage by dense quadrature in `f64`. Slow, and shares no formula with the evaluators.
//!
//! At fixed `u` the visible arcs are found by cutting intervals out of intervals, and their mass is summed image by image with
//! libm's erf. Along `u` every gap is split where an arc appears, vanishes or changes its ends, and each panel, no
//! longer than half a sigma, gets a six-point Gauss-Legendre rule.

use bevy_plumage::maths::query::{Cell, Local};

/// Six-point Gauss-Legendre rule on [-1, 1]: nodes and weights of the upper half.
const NODES: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_35),
];

/// Beyond this many periods of standard deviation a wrapped Gaussian is flat to 1e-14.
const FLAT: f64 = 1.3;

/// Mass of the arc `[low, high]` and all its copies one period apart, under a Gaussian.
fn periodic_mass(low: f64, high: f64, mean: f64, sigma: f64) -> f64 {
    if high <= low {
        return 0.0;
    }
    if sigma > FLAT {
        return high - low;
    }
    let cumulative = |x: f64| 0.5 * libm::erfc(-(x - mean) / (sigma * std::f64::consts::SQRT_2));
    let first = (mean - 8.0 * sigma - high).floor() as i64;
    let last = (mean + 8.0 * sigma - low).ceil() as i64;
    (first..=last)
        .map(|j| cumulative(high + j as f64) - cumulative(low + j as f64))
        .sum()
}

/// Parts of `[a, b]` outside all copies of the upper arc.
fn visible(a: f64, b: f64, upper: (f64, f64)) -> Vec<(f64, f64)> {
    let mut left = vec![(a, b)];
    let (ua, ub) = upper;
    let first = (a - ub).floor() as i64;
    let last = (b - ua).ceil() as i64;
    for j in first..=last {
        let (ca, cb) = (ua + j as f64, ub + j as f64);
        left = left
            .into_iter()
            .flat_map(|(p, q)| [(p, q.min(ca)), (p.max(cb), q)])
            .filter(|(p, q)| q > p)
            .collect();
    }
    left
}

/// Upper and visible lower share at a fixed height in gap `k`.
fn slice(cell: &Cell<f64>, k: f64, u: f64, mean: f64, sigma: f64) -> [f64; 2] {
    let upper = cell.kappa * (u - k) + k * cell.e_root + cell.s_d;
    let lower = cell.kappa * (k + 1.0 - u) + (k + 1.0) * cell.e_root + cell.s_p;
    let arc = (upper - cell.h_d, upper + cell.h_d);
    let w_upper = periodic_mass(arc.0, arc.1, mean, sigma);
    let w_lower = visible(lower - cell.h_p, lower + cell.h_p, arc)
        .into_iter()
        .map(|(a, b)| periodic_mass(a, b, mean, sigma))
        .sum();
    [w_upper, w_lower]
}

/// `[barb, upper, lower]` coverage (upper is distal seen from the front), to about 1e-7.
pub fn coverage(cell: &Cell<f64>, local: &Local<f64>) -> [f64; 3] {
    let sigma_u = local.variance.sqrt();
    let sigma = local.conditional.sqrt();
    let flat = sigma_u > FLAT && sigma > FLAT;
    let (first, last) = if flat {
        (0, 0)
    } else {
        (
            (local.u - 7.0 * sigma_u - 1.0).floor() as i64,
            (local.u + 7.0 * sigma_u).ceil() as i64,
        )
    };
    let mut sum = [0.0; 2];
    let mut open = 0.0;
    for k in first..=last {
        let k = k as f64;
        let (mut low, mut high) = (k + cell.v_low, k + cell.v_high);
        if !flat {
            low = low.max(local.u - 7.0 * sigma_u);
            high = high.min(local.u + 7.0 * sigma_u);
        }
        if high <= low {
            continue;
        }
        // Heights at which the ends of two arcs pass each other.
        let mut cuts = vec![low, high];
        let difference =
            |u: f64| cell.kappa * (2.0 * k + 1.0 - 2.0 * u) + cell.e_root + cell.s_p - cell.s_d;
        for offset in [
            cell.h_d - cell.h_p,
            cell.h_p - cell.h_d,
            cell.h_d + cell.h_p,
            -cell.h_d - cell.h_p,
        ] {
            let (a, b) = (difference(high) - offset, difference(low) - offset);
            for j in a.ceil() as i64..=b.floor() as i64 {
                cuts.push(
                    k + 0.5
                        - (j as f64 + offset - cell.e_root - cell.s_p + cell.s_d)
                            / (2.0 * cell.kappa),
                );
            }
        }
        cuts.sort_by(f64::total_cmp);
        let longest = if flat {
            1.0
        } else {
            (0.5 * sigma_u).min(if sigma > FLAT {
                1.0
            } else {
                1.5 * sigma / (cell.kappa + local.slope.abs())
            })
        };
        for pair in cuts.windows(2) {
            let (a, b) = (pair[0].clamp(low, high), pair[1].clamp(low, high));
            if b - a < 1e-15 {
                continue;
            }
            let panels = ((b - a) / longest).ceil().clamp(1.0, 1e6);
            let h = (b - a) / panels;
            for i in 0..panels as u64 {
                let middle = a + (i as f64 + 0.5) * h;
                for (x, weight) in NODES.iter().flat_map(|(x, w)| [(*x, *w), (-*x, *w)]) {
                    let u = middle + 0.5 * h * x;
                    let z = (u - local.u) / sigma_u;
                    let density = if flat {
                        1.0
                    } else {
                        (-0.5 * z * z).exp() / (sigma_u * (2.0 * std::f64::consts::PI).sqrt())
                    };
                    let w = 0.5 * h * weight * density;
                    let mean = local.tau + local.slope * (u - local.u);
                    let [upper, lower] = slice(cell, k, u, mean, sigma);
                    open += w;
                    sum[0] += w * upper;
                    sum[1] += w * lower;
                }
            }
        }
    }
    [1.0 - open, sum[0], sum[1]]
}
