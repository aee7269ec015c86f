//! A footprint inside one gap, narrower than the arcs: the overlap of the two families by bivariate normal integrals.

use crate::maths::functions::{Real, arc_sine, clamp, cosine_turns, sine_turns, wrap};
use crate::maths::query::vane::Cell;

/// Largest variance of either family's phase for which the nearest corners are enough: their images lie 2.5 sigmas further out.
pub(super) const CORNER_VARIANCE: f64 = 0.04;

/// Six-point Gauss-Legendre rule on [0, 1].
const NODES: [(f64, f64); 6] = [
    (0.033_765_242_9, 0.085_662_246_2),
    (0.169_395_306_8, 0.180_380_786_5),
    (0.380_690_406_9, 0.233_956_967_3),
    (0.619_309_593_1, 0.233_956_967_3),
    (0.830_604_693_2, 0.180_380_786_5),
    (0.966_234_757_1, 0.085_662_246_2),
];

/// What correlation adds to the overlap of the two families over the product of their shares. `phase` of the footprint against
/// both, `variances` of them, and their `covariance`.
///
/// The two phases are a bivariate normal, and the overlap is its mass on a lattice of rectangles. Its derivative by the covariance is
/// the density at their corners (Plackett 1954), so the excess over the independent case is an integral of densities over
/// the arc sine of the correlation (Drezner and Wesolowsky 1990).
pub(super) fn corner_excess<T: Real>(
    cell: &Cell<T>,
    phase: [T; 2],
    variances: [T; 2],
    covariance: T,
) -> T {
    let one = T::one();
    let [sd, sp] = variances.map(T::sqrt);
    let correlation = clamp(covariance / (sd * sp), -one, one);
    let sign = if correlation < T::zero() { -one } else { one };
    let turns = arc_sine(correlation.abs()) * T::of(0.5 / core::f64::consts::PI);
    let d = [cell.h_d, -cell.h_d].map(|edge| wrap(edge - phase[0]) / sd);
    let p = [cell.h_p, -cell.h_p].map(|edge| wrap(edge - phase[1]) / sp * sign);
    let mut sum = T::zero();
    for (x, weight) in NODES {
        let sine = sine_turns(T::of(x) * turns);
        let cosine = cosine_turns(T::of(x) * turns);
        let sharp = T::of(0.5) / (cosine * cosine).max(T::of(1e-9));
        let flat = one / (one + sine);
        // (h^2 + k^2 - 2 h k sine) / (2 cosine^2) without its cancellation.
        let density = |h: T, k: T| (-(h - k) * (h - k) * sharp - h * k * flat).exp();
        let corners =
            density(d[0], p[0]) - density(d[0], p[1]) - density(d[1], p[0]) + density(d[1], p[1]);
        sum = sum + T::of(weight) * corners;
    }
    sign * turns * sum
}
