//! STRIPE: barbs resolved, barbules averaged along the barb, in closed form.

use super::{
    math::{
        Real, overlap_integral, overlap_second_integral, staircase, staircase_derivatives, width,
    },
    vane::{Cell, Local},
};

/// `[barb, upper, lower]` coverage where the footprint averages over `tau`. Valid where `2 kappa sqrt(variance) > 1/2`, that is
/// where the teeth of the overlap are not resolved inside a gap; tends to [`super::mean`] by itself.
pub fn stripe<T: Real>(cell: &Cell<T>, local: &Local<T>) -> [T; 3] {
    let w = width(local.variance);
    let (a, b) = (cell.v0 - local.u, cell.v1 - local.u);
    let open = staircase(b, w) - staircase(a, w);
    let (f_d, f_p) = (cell.h_d + cell.h_d, cell.h_p + cell.h_p);
    let (first1, second1) = staircase_derivatives(b, w);
    let (first0, second0) = staircase_derivatives(a, w);
    let x1 = cell.phase_difference(cell.v1);
    let x0 = cell.phase_difference(cell.v0);
    let edge = overlap_integral(x1, cell.h_d, cell.h_p) * first1
        - overlap_integral(x0, cell.h_d, cell.h_p) * first0;
    let slope = overlap_second_integral(x1, cell.h_d, cell.h_p) * second1
        - overlap_second_integral(x0, cell.h_d, cell.h_p) * second0;
    let inverse = T::of(0.5) / cell.kappa;
    let lower = f_p * (T::one() - f_d) * open + edge * inverse + slope * inverse * inverse;
    [T::one() - open, f_d * open, lower]
}
