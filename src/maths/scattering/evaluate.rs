//! One light on one fibre: the twins of `scattering.wgsl`.

use super::{
    FIBRE_HARMONICS, FIBRE_SERIES, FibreShading,
    flat::{ROUND, azimuths, flat_surface},
    frame::polar,
    longitudinal_with,
};
use crate::maths::functions::{Real, clamp, real};

/// K by how its light moves inside the fibre, linear RGB per steradian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreLobes<T> {
    /// R, TRT and TRcT: enters and leaves at the same place.
    pub mirror: [T; 3],
    /// TT and the medulla's light: leaves anywhere.
    pub even: [T; 3],
    /// Cosine of the azimuth between eye and light.
    pub turn: T,
}

impl<T: Real> FibreLobes<T> {
    /// K.
    pub fn sum(&self) -> [T; 3] {
        std::array::from_fn(|c| self.mirror[c] + self.even[c])
    }
}

/// `1 + sum of s_n cos n phi`, at least 0: the density of a lobe in phi times 2 pi.
pub fn azimuthal<T: Real>(series: &[T; FIBRE_HARMONICS], cos_phi: T) -> T {
    raw_series(series, cos_phi).max(T::zero())
}

fn raw_series<T: Real>(series: &[T; FIBRE_HARMONICS], cos_phi: T) -> T {
    let (mut sum, mut now, mut before) = (T::one(), cos_phi, T::one());
    for &s in series {
        sum = sum + s * now;
        (now, before) = (cos_phi * now * real(2.0) - before, now);
    }
    sum
}

/// The sine series of a window; none in the far field, which is even in phi.
#[derive(Clone, Copy)]
pub(super) enum Odd<'a, T> {
    None,
    Some(&'a [[T; FIBRE_HARMONICS]; FIBRE_SERIES]),
}

impl<T: Real> Odd<'_, T> {
    fn sum(self, series: usize, (cos_phi, sin_phi): (T, T)) -> T {
        let Odd::Some(odd) = self else {
            return T::zero();
        };
        let (mut sum, mut now, mut before) = (T::zero(), sin_phi, T::zero());
        for &s in &odd[series] {
            sum = sum + s * now;
            (now, before) = (cos_phi * now * real(2.0) - before, now);
        }
        sum
    }
}

/// How much of the mirror core's lobe is left where the core is dark behind, 0..1; `half_z`: z of the azimuth half way between eye
/// and light.
pub(super) fn core_side<T: Real>(s: &FibreShading<T>, half_z: T) -> T {
    let b = s.back[0];
    let x = clamp((half_z + b) / (b + b), T::zero(), T::one());
    let lit = x * x * (real::<T>(3.0) - x - x);
    T::one() + (lit - T::one()) * s.back[1]
}

/// K = S cos(theta_i) of the fibre for light from `omega_i` (in its frame), linear RGB per steradian, at least 0.
pub fn fibre_evaluate<T: Real>(s: &FibreShading<T>, omega_i: [T; 3]) -> [T; 3] {
    fibre_lobes(s, omega_i).sum()
}

/// The same by how the light moves inside the fibre.
pub fn fibre_lobes<T: Real>(s: &FibreShading<T>, omega_i: [T; 3]) -> FibreLobes<T> {
    evaluate_with(s, Odd::None, omega_i)
}

pub(super) fn evaluate_with<T: Real>(
    s: &FibreShading<T>,
    odd: Odd<T>,
    omega_i: [T; 3],
) -> FibreLobes<T> {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let pi = real::<T>(std::f64::consts::PI);
    let (light, azimuth) = polar(omega_i);
    let at = azimuths(s, azimuth);
    let raw = |k: usize, angle: (T, T)| raw_series(&s.series[k], angle.0) + odd.sum(k, angle);
    let norm = one / (two * pi);
    let m = |i: usize| longitudinal_with(s.eye[i], light, s.spread[i]) * norm;
    let reflected = if s.aspect < real(ROUND) && matches!(odd, Odd::None) {
        flat_surface(s, at.half) / s.energy[0][0].max(real(1e-6))
    } else {
        raw(0, at.surface).max(zero) * at.surface_stretch
    } * m(0);
    let inner = raw(3, at.turn).max(zero) * m(2);
    let (clear, dense) = (raw(1, at.through), raw(2, at.through));
    let through = at.shrink * m(1);
    let fourth = if s.structural {
        raw(4, at.core).max(zero) * at.stretch * m(3) * core_side(s, at.half[1])
    } else {
        medulla_azimuth(s, at.turn.0)
            * norm
            * light.1
            * (two / pi)
            * (one + s.medulla[2] * light.0).max(zero)
    };
    let (mirrored, scattered) = if s.structural {
        (fourth, zero)
    } else {
        (zero, fourth)
    };
    FibreLobes {
        mirror: std::array::from_fn(|c| {
            s.energy[0][c] * reflected + s.energy[2][c] * inner + s.energy[3][c] * mirrored
        }),
        even: std::array::from_fn(|c| {
            let tt = (clear + (dense - clear) * s.dense[c]).max(zero) * through;
            s.energy[1][c] * tt + s.energy[3][c] * scattered
        }),
        turn: at.turn.0,
    }
}

/// Density of the medulla's light in phi times 2 pi.
pub(super) fn medulla_azimuth<T: Real>(s: &FibreShading<T>, cos_phi: T) -> T {
    let two = real::<T>(2.0);
    let f = T::one()
        + two * s.medulla[0] * cos_phi
        + two * s.medulla[1] * (two * cos_phi * cos_phi - T::one());
    f.max(T::zero())
}
