//! How much of a pixel a disc covers: the cross section of a hair in a layer of the fur texture (docs/book/undercoat.md#density,
//! test D6).
//!
//! [`disc_coverage`] is exact for any radius. [`disc_coverage_separable`] is a product of two one-dimensional integrals, at most
//! 0.011 of a pixel off. Twin of
//! `down_coverage.wgsl`.

use crate::maths::functions::{Real, clamp, real};

/// Area of the disc of radius `r` at the origin beyond x > a and y > b.
pub fn disc_quadrant<T: Real>(r: T, a: T, b: T) -> T {
    let zero = T::zero();
    if a >= r || b >= r || r <= zero {
        return zero;
    }
    let (a, b) = (a.max(-r), b.max(-r));
    if a * a + b * b < r * r {
        // The corner is inside: a triangle fan from the corner and a segment of the circle.
        let xa = (r * r - b * b).max(zero).sqrt();
        let ya = (r * r - a * a).max(zero).sqrt();
        let t = ya.atan2(a) - b.atan2(xa);
        // The chord from (xa, b) to (a, ya) bounds the segment that `t` spans.
        return real::<T>(0.5) * ((xa - a) * (ya - b) + r * r * (t - t.sin()));
    }
    // The corner is outside: what is beyond one line and not cut by the other, or both, or neither.
    if a >= zero && b >= zero {
        return zero;
    }
    let whole = real::<T>(std::f64::consts::PI) * r * r;
    if a >= zero {
        return segment(r, a);
    }
    if b >= zero {
        return segment(r, b);
    }
    whole - segment(r, -a) - segment(r, -b)
}

/// Area of the disc of radius `r` beyond a line at distance `d` (0 to r) from its centre.
fn segment<T: Real>(r: T, d: T) -> T {
    let d = clamp(d, T::zero(), r);
    let h = ((r - d) * (r + d)).max(T::zero()).sqrt();
    r * r * h.atan2(d) - d * h
}

/// Area of the disc of radius `r` around `centre` inside the unit pixel 0..1 x 0..1. Exact, any radius.
pub fn disc_coverage<T: Real>(r: T, centre: [T; 2]) -> T {
    let [x, y] = centre;
    let one = T::one();
    let area =
        disc_quadrant(r, -x, -y) - disc_quadrant(r, one - x, -y) - disc_quadrant(r, -x, one - y)
            + disc_quadrant(r, one - x, one - y);
    clamp(area, T::zero(), one)
}

/// The same as a product: `pi r^2` times the shares of the disc's area between the pixel's two pairs of sides.
pub fn disc_coverage_separable<T: Real>(r: T, centre: [T; 2]) -> T {
    if r <= T::zero() {
        return T::zero();
    }
    let [x, y] = centre.map(|c| share((T::one() - c) / r) - share(-c / r));
    clamp(
        real::<T>(std::f64::consts::PI) * r * r * x * y,
        T::zero(),
        T::one(),
    )
}

/// Share of a unit disc's area left of `u`.
fn share<T: Real>(u: T) -> T {
    let u = clamp(u, -T::one(), T::one());
    let root = (T::one() - u * u).max(T::zero()).sqrt();
    real::<T>(0.5) + (u * root + u.atan2(root)) / real(std::f64::consts::PI)
}
