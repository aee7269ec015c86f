//! MEAN: the average over the whole vane, exact.

use super::vane::Cell;
use crate::maths::functions::{Real, overlap_integral};

/// `[barb, upper, lower]` coverage averaged over the pattern: a constant of the cell.
pub fn mean_coverage<T: Real>(cell: &Cell<T>) -> [T; 3] {
    let open = cell.v_high - cell.v_low;
    let (f_d, f_p) = (cell.h_d + cell.h_d, cell.h_p + cell.h_p);
    let s1 = overlap_integral(cell.phase_difference(cell.v_high), cell.h_d, cell.h_p);
    let s0 = overlap_integral(cell.phase_difference(cell.v_low), cell.h_d, cell.h_p);
    let lower = f_p * (T::one() - f_d) * open + (s1 - s0) / (cell.kappa + cell.kappa);
    [T::one() - open, f_d * open, lower]
}
