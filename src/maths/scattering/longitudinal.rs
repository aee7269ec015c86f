//! Scattering along the fibre: d'Eon's normalised lobe, shifts and widths.

use super::Lobe;
use crate::maths::functions::{Real, clamp, real};

/// `exp(-x) I_0(x)` for x >= 0: the two polynomials of Abramowitz and Stegun 9.8.1 and 9.8.2, relative error 5e-7.
pub fn i0e<T: Real>(x: T) -> T {
    i0e_times_exp(x, T::zero())
}

/// `exp(-y) exp(-x) I_0(x)` for x >= 0, with one exponential.
fn i0e_times_exp<T: Real>(x: T, y: T) -> T {
    let x = x.max(T::zero());
    if x < real(3.75) {
        let small = x * real(1.0 / 3.75);
        let s = small * small;
        let mut low: T = real(0.004_581_3);
        for k in [
            0.036_076_8,
            0.265_973_2,
            1.206_749_2,
            3.089_942_4,
            3.515_622_9,
            1.0,
        ] {
            low = low * s + real(k);
        }
        return low * (-x - y).exp();
    }
    let r = real::<T>(3.75) / x;
    let mut high: T = real(0.003_923_77);
    for k in [
        -0.016_476_33,
        0.026_355_37,
        -0.020_577_06,
        0.009_162_81,
        -0.001_575_65,
        0.002_253_19,
        0.013_285_92,
        0.398_942_28,
    ] {
        high = high * r + real(k);
    }
    high / x.sqrt() * (-y).exp()
}

/// Brings a shifted inclination back into -pi/2..pi/2 over the pole; without it grazing light loses energy.
pub fn fold<T: Real>(theta: T) -> T {
    let half = real::<T>(std::f64::consts::FRAC_PI_2);
    if theta.abs() > half {
        theta.signum() * (half + half) - theta
    } else {
        theta
    }
}

/// d'Eon's longitudinal lobe M in its stable form (docs/book/scattering.md#along-the-fibre), per radian of inclination over
/// cos(theta_i).
///
/// `eye` is `(sin, cos)` of the folded, shifted inclination of the eye, `light` of the light's; `roughness` in radians is
/// clamped to 0.01..1. The integral of M cos(theta_i) over theta_i is 1.
pub fn longitudinal<T: Real>(eye: (T, T), light: (T, T), roughness: T) -> T {
    longitudinal_with(eye, light, longitudinal_spread(roughness))
}

/// What [`longitudinal`] needs of a roughness, the same for all lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalSpread<T> {
    /// One over the square of the roughness.
    pub inverse: T,
    /// What makes the integral 1.
    pub scale: T,
}

/// Of a roughness in radians, clamped to 0.01..1.
pub fn longitudinal_spread<T: Real>(roughness: T) -> LongitudinalSpread<T> {
    let (one, two) = (T::one(), real::<T>(2.0));
    let b = clamp(roughness, real(0.01), one);
    let inverse = one / (b * b);
    LongitudinalSpread {
        inverse,
        scale: inverse / (one - (-two * inverse).exp()),
    }
}

/// [`longitudinal`] of a roughness already prepared.
pub fn longitudinal_with<T: Real>(eye: (T, T), light: (T, T), spread: LongitudinalSpread<T>) -> T {
    // 1 - cos(theta_i + theta_o') as half a squared chord: no cancellation for narrow lobes.
    let (ds, dc) = (light.0 + eye.0, light.1 - eye.1);
    let chord = (ds * ds + dc * dc) * real(0.5);
    i0e_times_exp(light.1 * eye.1 * spread.inverse, chord * spread.inverse) * spread.scale
}

/// Longitudinal shift of a lobe in radians, from the shift `tilt` of R (docs/book/scattering.md#along-the-fibre).
pub fn lobe_shift<T: Real>(lobe: Lobe, tilt: T, eta: T) -> T {
    match lobe {
        Lobe::R => tilt,
        Lobe::TT | Lobe::TRcT => -(eta - T::one()) * tilt,
        Lobe::TRT => -(eta + eta - T::one()) * tilt,
        Lobe::Medulla => T::zero(),
    }
}

/// Longitudinal roughness of a lobe in radians, from that of R (docs/book/scattering.md#along-the-fibre; the core is half as
/// rough as the surface).
pub fn lobe_width<T: Real>(lobe: Lobe, roughness: T, eta: T) -> T {
    let half = real::<T>(0.5);
    match lobe {
        Lobe::R | Lobe::Medulla => roughness,
        Lobe::TT => roughness * half,
        Lobe::TRT => roughness + roughness,
        Lobe::TRcT => roughness * half * (T::one() + eta * eta).sqrt(),
    }
}
