//! NEAR: everything resolved. A footprint inside one gap has closed forms; any other is cut into cells across the barbs, inside
//! each of which the integral along the barb is in closed form, and the Gaussian of the cell itself is folded into the
//! widths, so that a cell wider than a tooth of the overlap averages over it instead of aliasing.

mod corners;
mod piece;

use super::{
    choose::{Quality, climb},
    vane::{Cell, Local},
};
use crate::maths::functions::{
    Real, clamp, normal_density, normal_distribution, staircase, width, wrap,
};
use corners::{CORNER_VARIANCE, corner_excess};
use piece::{Piece, Widths, family_mass, family_phases, lower_mass, phase_variances};

/// Most gaps that a footprint may touch.
pub const MAX_GAPS: i32 = 32;
/// Most cells in one gap.
pub const MAX_CELLS: i32 = 144;

/// `[barb, upper, lower]` coverage with everything resolved.
pub fn near_coverage<T: Real>(cell: &Cell<T>, local: &Local<T>, quality: &Quality<T>) -> [T; 3] {
    near_counted(cell, local, quality).0
}

/// [`near_coverage`] and the number of cells that it walked through.
pub fn near_counted<T: Real>(
    cell: &Cell<T>,
    local: &Local<T>,
    quality: &Quality<T>,
) -> ([T; 3], u32) {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let sigma = local.variance.sqrt();
    let reach = quality.reach * sigma;
    let barb_width = width(local.variance);
    let open = clamp(
        staircase(cell.v_high - local.u, barb_width) - staircase(cell.v_low - local.u, barb_width),
        zero,
        one,
    );
    let hb = half - cell.h_d;
    let (change_e, change_g) = ((hb - cell.h_p).abs(), hb + cell.h_p);
    let climb = climb(cell, local);
    let sharpness = local.conditional.sqrt();
    let cell_sigmas =
        quality.cell_sigmas * clamp(sharpness / (climb * sigma), quality.least_sigmas, one);
    let mut cell_phase = quality
        .cell_phase
        .min((quality.least_arc * hb.min(cell.h_p)).max(T::of(0.15)));
    // More cells than the loop may take are made coarser, not dropped.
    let estimate = (reach + reach) * (cell.v_high - cell.v_low).max(half) * climb / cell_phase;
    cell_phase = cell_phase * (estimate * T::of(1.0 / 128.0)).max(one);
    // What lies beyond the reach is put into the outermost cells.
    let tail = normal_distribution(-quality.reach);
    let tail_mean = normal_density(quality.reach) / tail;

    let (bottom, top) = (local.u - reach, local.u + reach);
    let first = (bottom - cell.v_high).ceil();
    let last = (top - cell.v_low).floor();
    let gaps = (last - first + one).to_i32().unwrap_or(0).min(MAX_GAPS);
    let (mut total, mut upper, mut lower) = (zero, zero, zero);
    let mut trips = 0;
    // Of a footprint inside one gap the two families' own coverage is exact; cells only have to tell how they overlap.
    let mut exact = None;
    for gap in 0..gaps {
        let k = first + T::of(f64::from(gap));
        let low = bottom.max(k + cell.v_low);
        let high = top.min(k + cell.v_high);
        let length = high - low;
        if length <= zero {
            continue;
        }
        let uncut = low <= bottom && high >= top;
        let x_middle = wrap(cell.phase_difference(half * (low + high) - k) - half);
        let ax = x_middle.abs();
        let vary = cell.kappa * length;
        // No end of an arc changes from one family to the other over the segment.
        let typed = (ax - change_e).abs() > vary
            && (ax - change_g).abs() > vary
            && (one - ax - change_g).abs() > vary
            && ax + vary < half;
        if uncut {
            let w = Widths::new(cell, local, local.variance);
            let phase = family_phases(cell, local, k, local.u);
            let variances = phase_variances(cell, local, local.variance);
            let covered = family_mass(phase[0], cell.h_d, w.upper);
            let whole = family_mass(phase[1], cell.h_p, w.lower);
            let dd = phase[0].abs() - cell.h_d;
            let dp = phase[1].abs() - cell.h_p;
            let visible = if dd * dd > quality.edge_sigmas_squared * variances[0]
                || dp * dp > quality.edge_sigmas_squared * variances[1]
            {
                Some(whole * (one - covered))
            } else if typed {
                Some(lower_mass(cell, phase[0], x_middle, &w, true))
            } else if variances[0].max(variances[1]) < T::of(CORNER_VARIANCE) {
                let slopes = (cell.kappa - local.slope) * (cell.kappa + local.slope);
                let covariance = local.conditional - slopes * local.variance;
                Some(whole * (one - covered) - corner_excess(cell, phase, variances, covariance))
            } else {
                None
            };
            if let Some(visible) = visible {
                total = one;
                lower = visible;
                exact = Some([covered, zero]);
                continue;
            }
            exact = Some([covered, whole]);
        }
        let (za, zb) = ((low - local.u) / sigma, (high - local.u) / sigma);
        let single = !uncut && typed && climb * length < quality.single_sigmas * sharpness;
        let wanted = (length * climb / cell_phase)
            .max((zb - za) / cell_sigmas)
            .ceil();
        let most = T::of(f64::from(MAX_CELLS));
        let count = if single {
            one
        } else {
            clamp(wanted, one, most)
        };
        let step = (zb - za) / count;
        let mut piece = Piece::truncated(za, zb);
        let variance = if single {
            piece.variance
        } else {
            step * step * T::of(1.0 / 12.0)
        };
        let w = Widths::new(cell, local, local.variance * variance);
        let cells = count.to_i32().unwrap_or(1);
        trips += cells.unsigned_abs();
        for i in 0..cells {
            if !single {
                piece = Piece::midpoint(za + (T::of(f64::from(i)) + half) * step, step);
                if i == 0 && low <= bottom {
                    piece = piece.with(-tail_mean, tail);
                }
                if i + 1 == cells && high >= top {
                    piece = piece.with(tail_mean, tail);
                }
            }
            let u = local.u + sigma * piece.mean;
            let phase = family_phases(cell, local, k, u);
            let x = wrap(cell.phase_difference(u - k) - half);
            total = total + piece.mass;
            upper = upper + piece.mass * family_mass(phase[0], cell.h_d, w.upper);
            lower = lower + piece.mass * lower_mass(cell, phase[0], x, &w, single);
            if uncut {
                lower = lower - piece.mass * family_mass(phase[1], cell.h_p, w.lower);
            }
        }
    }
    if total <= zero {
        return ([one - open, zero, zero], trips);
    }
    let scale = open / total.max(T::of(1e-6));
    upper = upper * scale;
    lower = lower * scale;
    if let Some([covered, whole]) = exact {
        upper = covered * open;
        lower = lower + whole * open;
    }
    upper = clamp(upper, zero, open);
    ([one - open, upper, clamp(lower, zero, open - upper)], trips)
}
