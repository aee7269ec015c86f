//! STRIPE: barbs resolved, barbules averaged along the barb, in closed form.

use super::vane::{Cell, Local};
use crate::maths::functions::{
    Real, overlap_integral, overlap_second_integral, overlap_third_integral, staircase,
    staircase_derivatives, width,
};

/// `[barb, upper, lower]` coverage where the footprint averages over `tau`. Valid where `2 kappa sqrt(variance) > 1/2`, that is
/// where the teeth of the overlap are not resolved inside a gap; tends to [`super::mean_coverage`] by itself.
pub fn stripe_coverage<T: Real>(cell: &Cell<T>, local: &Local<T>) -> [T; 3] {
    let w = width(local.variance);
    let (a, b) = (cell.v_low - local.u, cell.v_high - local.u);
    let open = staircase(b, w) - staircase(a, w);
    let (f_d, f_p) = (cell.h_d + cell.h_d, cell.h_p + cell.h_p);
    let at_high = staircase_derivatives(b, w);
    let at_low = staircase_derivatives(a, w);
    let x_high = cell.phase_difference(cell.v_high);
    let x_low = cell.phase_difference(cell.v_low);
    // What the ends of the gap leave of the teeth: repeated integration by parts.
    let inverse = T::of(0.5) / cell.kappa;
    let mut edges = T::zero();
    for (order, integral) in [
        overlap_third_integral,
        overlap_second_integral,
        overlap_integral,
    ]
    .iter()
    .enumerate()
    {
        let [high, low] = [(x_high, at_high), (x_low, at_low)]
            .map(|(x, derivatives)| integral(x, cell.h_d, cell.h_p) * derivatives[2 - order]);
        edges = (edges + high - low) * inverse;
    }
    let lower = f_p * (T::one() - f_d) * open + edges;
    [T::one() - open, f_d * open, lower]
}
