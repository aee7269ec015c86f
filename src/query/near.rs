//! NEAR: everything resolved. The footprint is cut into cells across the barbs; inside each the integral along the barb is in
//! closed form, and the Gaussian of the cell itself is folded into the widths, so that a cell wider than a tooth of the overlap
//! averages over it instead of aliasing.

use super::{
    choose::Quality,
    math::{
        Real, Width, clamp, normal_density, normal_distribution, overlap_integral, smooth_positive,
        staircase, width, wrap,
    },
    vane::{Cell, Local},
};

/// Most gaps that a footprint may touch.
pub const MAX_GAPS: i32 = 32;
/// Most cells in one gap.
pub const MAX_CELLS: i32 = 144;

/// A piece of the footprint: its share, and its mean and variance of `u`.
#[derive(Clone, Copy)]
struct Piece<T> {
    mass: T,
    mean: T,
    variance: T,
}

/// Piece of a standard normal of `width` sigmas around `z`, by its moments.
fn midpoint_piece<T: Real>(z: T, w: T) -> Piece<T> {
    let w2 = w * w * T::of(1.0 / 12.0);
    Piece {
        mass: normal_density(z) * w * (T::one() + T::of(0.5) * (z * z - T::one()) * w2),
        mean: z * (T::one() - w2),
        variance: w2,
    }
}

/// The same between two bounds that may be far apart, exactly.
fn truncated_piece<T: Real>(za: T, zb: T) -> Piece<T> {
    let w = zb - za;
    if w < T::of(0.8) {
        return midpoint_piece(T::of(0.5) * (za + zb), w);
    }
    let mass = (normal_distribution(zb) - normal_distribution(za)).max(T::of(1e-6));
    let (pa, pb) = (normal_density(za), normal_density(zb));
    let mean = (pa - pb) / mass;
    let variance = T::one() + (za * pa - zb * pb) / mass - mean * mean;
    Piece {
        mass,
        mean: clamp(mean, za, zb),
        variance: clamp(variance, T::zero(), T::one()),
    }
}

/// Widths of the steps in a piece.
struct Widths<T> {
    upper: Width<T>,
    lower: Width<T>,
    both: Width<T>,
    /// Half width by which the phase difference of the families varies inside the piece.
    box_half: T,
}

fn widths<T: Real>(cell: &Cell<T>, local: &Local<T>, variance: T) -> Widths<T> {
    let nd = cell.kappa - local.slope;
    let np = cell.kappa + local.slope;
    let vd = local.conditional + nd * nd * variance;
    let vp = local.conditional + np * np * variance;
    Widths {
        upper: width(vd),
        lower: width(vp),
        both: width(T::of(0.5) * (vd + vp)),
        box_half: T::of(3.464_101_6) * cell.kappa * variance.sqrt(),
    }
}

/// Mass on `tau` of one visible arc of the lower family, `x` from the middle of the upper one's complement, and its length.
fn arc<T: Real>(x: T, y: T, hb: T, h_p: T, w: &Widths<T>, box_half: T) -> [T; 2] {
    let from_below = x - h_p + hb;
    let from_above = hb - x - h_p;
    let low = smooth_positive(from_below, box_half) - hb;
    let high = hb - smooth_positive(from_above, box_half);
    let length = (high - low).max(T::zero());
    // Where smoothing leaves next to nothing, a short arc around the middle stands for the density.
    let half = (T::of(0.5) * (high - low)).max(T::of(0.005));
    let middle = T::of(0.5) * (high + low);
    let select = |d: T| {
        if d >= box_half {
            w.lower
        } else if d <= -box_half {
            w.upper
        } else {
            w.both
        }
    };
    let mass = staircase(middle + half - y, select(from_above))
        - staircase(middle - half - y, select(from_below));
    [mass * length / (half + half), length]
}

/// Phases of a piece: `[tau - upper centre, tau - lower centre, difference of the centres]`.
fn phases<T: Real>(cell: &Cell<T>, local: &Local<T>, k: T, u: T) -> [T; 2] {
    let along = local.tau + local.slope * (u - local.u);
    let v = u - k;
    let upper = along - cell.kappa * v - k * cell.e0 - cell.s_d;
    let lower = along - cell.kappa * (T::one() - v) - (k + T::one()) * cell.e0 - cell.s_p;
    [wrap(upper), wrap(lower)]
}

/// Upper, visible lower and whole lower coverage of one piece of mass 1, with `u` its mean. `typed`: no arc's end changes from
/// one family to the other inside the piece, so nothing is smoothed.
fn piece_coverage<T: Real>(
    cell: &Cell<T>,
    phase: [T; 2],
    x: T,
    w: &Widths<T>,
    typed: bool,
) -> [T; 2] {
    let half = T::of(0.5);
    let hb = half - cell.h_d;
    let [d, _] = phase;
    let upper = staircase(cell.h_d - d, w.upper) - staircase(-cell.h_d - d, w.upper);
    let y = wrap(d - half);
    let box_half = if typed { T::zero() } else { w.box_half };
    let first = arc(x, y, hb, cell.h_p, w, box_half);
    let mut mass = first[0];
    let mut length = first[1];
    if cell.h_p + hb + box_half > T::one() - x.abs() {
        let other = if x > T::zero() {
            x - T::one()
        } else {
            x + T::one()
        };
        let second = arc(other, y, hb, cell.h_p, w, box_half);
        mass = mass + second[0];
        length = length + second[1];
    }
    if box_half > T::of(0.02) {
        let x0 = x + half;
        let s = overlap_integral(x0 + box_half, cell.h_d, cell.h_p)
            - overlap_integral(x0 - box_half, cell.h_d, cell.h_p);
        let open = T::of(4.0) * cell.h_p * hb;
        let exact = open - s / (box_half + box_half);
        mass = mass * clamp(exact, T::zero(), T::one()) / length.max(T::of(1e-4));
    }
    [upper, mass]
}

/// Coverage of a piece by the whole lower family.
fn whole_lower<T: Real>(cell: &Cell<T>, phase: [T; 2], w: &Widths<T>) -> T {
    staircase(cell.h_p - phase[1], w.lower) - staircase(-cell.h_p - phase[1], w.lower)
}

/// Distance from a point at phase `d` of an arc's centre to the nearest end of an arc of half width `h`.
fn edge_distance<T: Real>(d: T, h: T) -> T {
    (d.abs() - h).abs()
}

/// `[barb, upper, lower]` coverage with everything resolved.
pub fn near<T: Real>(cell: &Cell<T>, local: &Local<T>, quality: &Quality<T>) -> [T; 3] {
    let zero = T::zero();
    let one = T::one();
    let half = T::of(0.5);
    let sigma = local.variance.sqrt();
    let reach = quality.reach * sigma;
    let barb_width = width(local.variance);
    let open = clamp(
        staircase(cell.v1 - local.u, barb_width) - staircase(cell.v0 - local.u, barb_width),
        zero,
        one,
    );
    let hb = half - cell.h_d;
    let change_e = (hb - cell.h_p).abs();
    let change_g = hb + cell.h_p;
    let climb = if local.conditional < T::of(0.2) {
        cell.kappa + local.slope.abs()
    } else {
        cell.kappa
    };
    let sharpness = local.conditional.sqrt();
    let cell_sigmas =
        quality.cell_sigmas * clamp(T::of(1.5) * sharpness / (climb * sigma), half, one);
    let mut cell_phase = quality
        .cell_phase
        .min((quality.least_arc * hb.min(cell.h_p)).max(T::of(0.15)));
    // More cells than the loop may take are made coarser, not dropped.
    let estimate = (reach + reach) * (cell.v1 - cell.v0).max(half) * climb / cell_phase;
    cell_phase = cell_phase * (estimate * T::of(1.0 / 128.0)).max(one);

    let first = (local.u - reach - cell.v1).ceil();
    let last = (local.u + reach - cell.v0).floor();
    let gaps = (last - first + one).to_i32().unwrap_or(0).min(MAX_GAPS);
    let mut total = zero;
    let mut upper = zero;
    let mut lower = zero;
    let mut correction = [zero, zero];
    let mut exact = false;
    let mut k = first;
    for _ in 0..gaps {
        let bottom = local.u - reach;
        let top = local.u + reach;
        let low = bottom.max(k + cell.v0);
        let high = top.min(k + cell.v1);
        let length = high - low;
        if length > zero {
            let uncut = low <= bottom && high >= top;
            let middle = half * (low + high);
            let x = wrap(cell.phase_difference(middle - k) - half);
            let ax = x.abs();
            let vary = cell.kappa * length;
            let typed = (ax - change_e).abs() > vary
                && (ax - change_g).abs() > vary
                && (one - ax - change_g).abs() > vary
                && ax + vary < half;
            let mut done = false;
            if uncut {
                let w = widths(cell, local, local.variance);
                let phase = phases(cell, local, k, local.u);
                exact = true;
                let whole = whole_lower(cell, phase, &w);
                let covered = staircase(cell.h_d - phase[0], w.upper)
                    - staircase(-cell.h_d - phase[0], w.upper);
                correction = [covered, whole];
                let nd = cell.kappa - local.slope;
                let np = cell.kappa + local.slope;
                let vd = local.conditional + nd * nd * local.variance;
                let vp = local.conditional + np * np * local.variance;
                let dd = edge_distance(phase[0], cell.h_d);
                let dp = edge_distance(phase[1], cell.h_p);
                if dd * dd > quality.edge_sigmas_squared * vd
                    || dp * dp > quality.edge_sigmas_squared * vp
                {
                    total = one;
                    lower = whole * (one - covered);
                    correction[1] = zero;
                    done = true;
                } else if typed {
                    let result = piece_coverage(cell, phase, x, &w, true);
                    total = one;
                    lower = result[1];
                    correction[1] = zero;
                    done = true;
                }
            }
            if !done {
                let za = (low - local.u) / sigma;
                let zb = (high - local.u) / sigma;
                let single = !uncut && typed && climb * length < quality.single_sigmas * sharpness;
                let wanted = if single {
                    one
                } else {
                    (length * climb / cell_phase)
                        .max((zb - za) / cell_sigmas)
                        .ceil()
                };
                let count = clamp(wanted, one, T::of(f64::from(MAX_CELLS)));
                let step = (zb - za) / count;
                let mut piece = truncated_piece(za, zb);
                let variance = if single {
                    piece.variance
                } else {
                    step * step * T::of(1.0 / 12.0)
                };
                let w = widths(cell, local, local.variance * variance);
                for i in 0..count.to_i32().unwrap_or(1) {
                    if !single {
                        piece = midpoint_piece(za + (T::of(f64::from(i)) + half) * step, step);
                    }
                    let u = local.u + sigma * piece.mean;
                    let phase = phases(cell, local, k, u);
                    let x = wrap(cell.phase_difference(u - k) - half);
                    let result = piece_coverage(cell, phase, x, &w, single);
                    total = total + piece.mass;
                    upper = upper + piece.mass * result[0];
                    lower = lower + piece.mass * result[1];
                    if uncut {
                        lower = lower - piece.mass * whole_lower(cell, phase, &w);
                    }
                }
            }
        }
        k = k + one;
    }
    if total <= zero {
        return [one - open, zero, zero];
    }
    let scale = open / total.max(T::of(1e-6));
    upper = upper * scale;
    lower = lower * scale;
    if exact {
        upper = correction[0] * open;
        lower = lower + correction[1] * open;
    }
    upper = clamp(upper, zero, open);
    [one - open, upper, clamp(lower, zero, open - upper)]
}
