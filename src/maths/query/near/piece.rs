//! One piece of a footprint: its moments, and its coverage in closed form.

use crate::maths::functions::{
    Real, Width, clamp, normal_density, normal_distribution, overlap_integral, smooth_positive,
    staircase, width, wrap,
};
use crate::maths::query::vane::{Cell, Local};

/// A piece of the footprint: its share, and its mean and variance of `u`.
#[derive(Clone, Copy)]
pub(super) struct Piece<T> {
    pub mass: T,
    pub mean: T,
    pub variance: T,
}

impl<T: Real> Piece<T> {
    /// Piece of a standard normal of `width` sigmas around `z`, by its moments.
    pub fn midpoint(z: T, width: T) -> Self {
        let w2 = width * width * T::of(1.0 / 12.0);
        Self {
            mass: normal_density(z) * width * (T::one() + T::of(0.5) * (z * z - T::one()) * w2),
            mean: z * (T::one() - w2),
            variance: w2,
        }
    }

    /// The same between two bounds that may be far apart, exactly.
    pub fn truncated(za: T, zb: T) -> Self {
        let w = zb - za;
        if w < T::of(0.8) {
            return Self::midpoint(T::of(0.5) * (za + zb), w);
        }
        let mass = (normal_distribution(zb) - normal_distribution(za)).max(T::of(1e-6));
        let (pa, pb) = (normal_density(za), normal_density(zb));
        let mean = (pa - pb) / mass;
        let variance = T::one() + (za * pa - zb * pb) / mass - mean * mean;
        Self {
            mass,
            mean: clamp(mean, za, zb),
            variance: clamp(variance, T::zero(), T::one()),
        }
    }

    /// With a piece that has no width added to it.
    pub fn with(self, mean: T, mass: T) -> Self {
        let total = self.mass + mass;
        Self {
            mass: total,
            mean: (self.mass * self.mean + mass * mean) / total,
            variance: self.variance,
        }
    }
}

/// Variances of the upper and the lower family's phase in a piece of the given variance of `u`.
pub(super) fn phase_variances<T: Real>(cell: &Cell<T>, local: &Local<T>, variance: T) -> [T; 2] {
    let nd = cell.kappa - local.slope;
    let np = cell.kappa + local.slope;
    [
        local.conditional + nd * nd * variance,
        local.conditional + np * np * variance,
    ]
}

/// Widths of the steps in a piece.
pub(super) struct Widths<T> {
    pub upper: Width<T>,
    pub lower: Width<T>,
    both: Width<T>,
    /// Half width by which the phase difference of the families varies inside the piece.
    box_half: T,
}

impl<T: Real> Widths<T> {
    pub fn new(cell: &Cell<T>, local: &Local<T>, variance: T) -> Self {
        let [vd, vp] = phase_variances(cell, local, variance);
        Self {
            upper: width(vd),
            lower: width(vp),
            both: width(T::of(0.5) * (vd + vp)),
            box_half: T::of(3.464_101_6) * cell.kappa * variance.sqrt(),
        }
    }

    /// Width of an arc's end, by which family it belongs to in this piece.
    fn end(&self, distance: T, box_half: T) -> Width<T> {
        if distance >= box_half {
            self.lower
        } else if distance <= -box_half {
            self.upper
        } else {
            self.both
        }
    }
}

/// Phases of a piece against the centres of the upper and the lower family, at `u` in gap `k`.
pub(super) fn family_phases<T: Real>(cell: &Cell<T>, local: &Local<T>, k: T, u: T) -> [T; 2] {
    let along = local.tau + local.slope * (u - local.u);
    let v = u - k;
    let upper = along - cell.kappa * v - k * cell.e_root - cell.s_d;
    let lower = along - cell.kappa * (T::one() - v) - (k + T::one()) * cell.e_root - cell.s_p;
    [wrap(upper), wrap(lower)]
}

/// Mass of a family of arcs of half width `h` at phase `d` of its centre.
pub(super) fn family_mass<T: Real>(d: T, h: T, w: Width<T>) -> T {
    staircase(h - d, w) - staircase(-h - d, w)
}

/// Mass and length of one visible arc of the lower family, `x` from the middle of the upper one's complement (half width `hb`).
fn visible_arc<T: Real>(x: T, y: T, hb: T, h_p: T, w: &Widths<T>, box_half: T) -> [T; 2] {
    let from_below = x - h_p + hb;
    let from_above = hb - x - h_p;
    let mut low = smooth_positive(from_below, box_half) - hb;
    let mut high = hb - smooth_positive(from_above, box_half);
    let seen = high - low;
    if seen <= -box_half {
        return [T::zero(), T::of(1e-6)];
    }
    // An arc that appears inside the piece grows from the end of the complement that it touches first, and has one width: two
    // would leave a mass where its ends meet.
    let length = smooth_positive(seen, box_half).max(T::of(1e-6));
    if x > T::zero() {
        low = high - length;
    } else {
        high = low + length;
    }
    let [above, below] = if seen < box_half {
        [w.both, w.both]
    } else {
        [w.end(from_above, box_half), w.end(from_below, box_half)]
    };
    let mass = staircase(high - y, above) - staircase(low - y, below);
    [mass, length]
}

/// Visible lower coverage of one piece of mass 1: `d` its phase against the upper family, `x` the phase difference of the families.
/// `typed`: no arc's end changes from one family to the other inside the piece, so nothing is smoothed.
pub(super) fn lower_mass<T: Real>(cell: &Cell<T>, d: T, x: T, w: &Widths<T>, typed: bool) -> T {
    let half = T::of(0.5);
    let hb = half - cell.h_d;
    let y = wrap(d - half);
    let box_half = if typed { T::zero() } else { w.box_half };
    let [mut mass, mut length] = visible_arc(x, y, hb, cell.h_p, w, box_half);
    if cell.h_p + hb + box_half > T::one() - x.abs() {
        let other = if x > T::zero() {
            x - T::one()
        } else {
            x + T::one()
        };
        let second = visible_arc(other, y, hb, cell.h_p, w, box_half);
        mass = mass + second[0];
        length = length + second[1];
    }
    if box_half > T::of(0.02) {
        // The arcs' mean length over the piece is known exactly: what aliasing would make of it is taken out.
        let at = x + half;
        let s = overlap_integral(at + box_half, cell.h_d, cell.h_p)
            - overlap_integral(at - box_half, cell.h_d, cell.h_p);
        let exact = T::of(4.0) * cell.h_p * hb - s / (box_half + box_half);
        return mass * clamp(exact, T::zero(), T::one()) / length;
    }
    mass
}
