//! LATTICE: [`super::stripe_coverage`] plus the harmonics along the barb that a footprint does not average away.
//!
//! The pattern is exactly doubly periodic, so its coverage is a sum over the nodes of one lattice of frequencies: `(P, q)` in
//! `(u, tau)` with `P = p - q e_root`. All nodes with `q = 0` are in STRIPE already, in closed form. The double sum over the
//! overlap of the two families (Chen et al. 2026, Eq. 25) is one short sum per node, because the lower family is
//! multiplied with the gaps of the upper one instead of with the upper one itself
//! (docs/book/range_queries.md#the-four-evaluators).

use super::{
    stripe::stripe_coverage,
    vane::{Cell, Local},
};
use crate::maths::functions::{Real, clamp, cosine_turns, sine_turns, wrap};

/// Most rows `q` of harmonics.
pub const MAX_ROWS: i32 = 8;
/// Most nodes in a row.
pub const MAX_COLUMNS: i32 = 48;

/// Coefficients `0..=MAX_ROWS + 1` of a train of arcs that covers the share `f` of its circle, and one more: `sin(pi m f) / (pi m)`.
fn coefficients<T: Real>(f: T) -> [T; MAX_ROWS as usize + 2] {
    let mut a = [f; MAX_ROWS as usize + 2];
    let half = T::of(0.5);
    // sin(m x) by the recurrence sin((m + 1) x) = 2 cos x sin(m x) - sin((m - 1) x).
    let mut before = T::zero();
    let mut now = sine_turns(half * f);
    let twice = T::of(2.0) * cosine_turns(half * f);
    for (m, a) in a.iter_mut().enumerate().skip(1) {
        *a = now / T::of(core::f64::consts::PI * m as f64);
        (before, now) = (now, twice * now - before);
    }
    a
}

/// `l sinc(pi x l)`: spectrum of a window of length `l`.
fn window<T: Real>(x: T, l: T) -> T {
    if x.abs() < T::of(1e-3) {
        return l;
    }
    sine_turns(wrap(T::of(0.5) * x * l)) / (T::of(core::f64::consts::PI) * x)
}

/// `[barb, upper, lower]` coverage. `budget`: exponents `A (P - P_s)^2 + sc2 q^2` up to here are kept
/// (see [`choose()`](super::choose())).
pub fn lattice_coverage<T: Real>(cell: &Cell<T>, local: &Local<T>, budget: T) -> [T; 3] {
    let half = T::of(0.5);
    let one = T::one();
    let [barb, mut upper, mut lower] = stripe_coverage(cell, local);
    let open = cell.v_high - cell.v_low;
    let middle = half * (cell.v_low + cell.v_high);
    let a = coefficients(cell.h_d + cell.h_d);
    let b = coefficients(cell.h_p + cell.h_p);
    let root = wrap(cell.kappa + cell.e_root + cell.s_p);
    let limit = T::of(f64::from(MAX_ROWS));
    let rows = clamp(
        (budget.max(T::zero()) / local.conditional).sqrt().floor(),
        T::zero(),
        limit,
    );
    for q in 1..=rows.to_i32().unwrap_or(0) {
        let qt = T::of(f64::from(q));
        let rest = (budget - local.conditional * qt * qt).max(T::zero());
        let reach = (rest / local.variance).sqrt();
        let centre = qt * (cell.e_root - local.slope);
        let first = (centre - reach).ceil();
        let count = (centre + reach - first).floor().to_i32().unwrap_or(0) + 1;
        for i in 0..count.min(MAX_COLUMNS) {
            let p = first + T::of(f64::from(i)) - qt * cell.e_root;
            let off = p + qt * local.slope;
            let damping = T::of(2.0)
                * (T::of(-19.739_208_8)
                    * (local.variance * off * off + local.conditional * qt * qt))
                    .exp();
            let base = wrap(p * local.u) + wrap(qt * local.tau);
            let x = -qt * cell.kappa - p;
            upper = upper
                + damping
                    * a[q as usize]
                    * window(x, open)
                    * cosine_turns(base + wrap(x * middle) - qt * cell.s_d);
            let mut sum = T::zero();
            for m in -1..=q + 1 {
                let n = q - m;
                let (mt, nt) = (T::of(f64::from(m)), T::of(f64::from(n)));
                let gap = if m == 0 {
                    one - a[0]
                } else {
                    -a[m.unsigned_abs() as usize]
                };
                let x = (nt - mt) * cell.kappa - p;
                sum = sum
                    + gap
                        * b[n.unsigned_abs() as usize]
                        * window(x, open)
                        * cosine_turns(base + wrap(x * middle) - nt * root - mt * cell.s_d);
            }
            lower = lower + damping * sum;
        }
    }
    [barb, upper, lower]
}
