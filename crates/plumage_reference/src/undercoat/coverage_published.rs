//! Coverage of pixels by discs as Kloetzli 2005 approximates it: chords and wedges.

use bevy_plumage::maths::functions::{Real, real};

/// Eq. (1): area of the disc of radius `r` beyond a chord, `d` deep (0 to 2 r).
pub fn chord<T: Real>(r: T, d: T) -> T {
    if d <= T::zero() {
        return T::zero();
    }
    let m = (d * (r + r - d)).max(T::zero()).sqrt();
    if m <= T::zero() {
        return T::zero();
    }
    real::<T>(4.0 / 3.0) * d * m + d * d * d / (real::<T>(4.0) * m)
}

/// Eq. (2): area of a wedge of sides `s1` and `s2`, a quarter of the disc with their mean as radius.
pub fn wedge<T: Real>(s1: T, s2: T) -> T {
    let r = (s1 + s2) * real(0.5);
    real::<T>(std::f64::consts::FRAC_PI_4) * r * r
}

/// Coverage of the four pixels that a disc of diameter at most 1 may touch: the one that holds the centre, its neighbor along
/// x, the diagonal one, and that along y (towards the nearer sides). `centre` lies in 0..1.
pub fn four_pixels<T: Real>(r: T, centre: [T; 2]) -> [T; 4] {
    let zero = T::zero();
    let one = T::one();
    // Distance to the nearer side, and how deep the disc reaches across it.
    let near = centre.map(|c| c.min(one - c));
    let deep = near.map(|n| (r - n).max(zero));
    let [x, y] = deep.map(|d| chord(r, d));
    let corner = if deep[0] > zero && deep[1] > zero {
        let side = |a: T, b: T| ((r * r - a * a).max(zero).sqrt() - b).max(zero);
        wedge(side(near[1], near[0]), side(near[0], near[1]))
    } else {
        zero
    };
    let disc = real::<T>(std::f64::consts::PI) * r * r;
    [disc - (x + y - corner), x - corner, corner, y - corner]
}
