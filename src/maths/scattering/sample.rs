//! Importance sampling of one fibre (Chen et al. 2026, Sec. 6.2.1) from the far-field series. Twin of `scattering_sample.wgsl`.
//!
//! A lobe by its energy, the inclination by the exact inversion of its longitudinal term, the azimuth by inversion of its series.
//! The series are the ones that [`fibre_evaluate`] sums, warps of flat fibres included, so a white round fibre has a constant
//! weight: its albedo.

use super::evaluate::medulla_azimuth;
use super::flat::{ROUND, azimuths};
use super::frame::polar;
use super::{FIBRE_HARMONICS, FibreShading, azimuthal, fibre_evaluate, longitudinal_with};
use crate::maths::functions::{Real, clamp, real};
use crate::maths::vector::dot;
use std::f64::consts::PI;

/// A sampled direction of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreSample {
    /// Direction to the light in the fibre's frame.
    pub direction: [f64; 3],
    /// Density per steradian with which it was chosen.
    pub pdf: f64,
    /// K over pdf, linear RGB.
    pub weight: [f64; 3],
}

/// Steps of the inversion of a series.
const STEPS: usize = 24;
/// Least share of its energy with which the core's lobe is sampled from the dark side.
const LEAST_SIDE: f64 = 0.05;

/// Luminance of linear RGB.
fn luminance<T: Real>(c: [T; 3]) -> T {
    dot(c, [real(0.2126), real(0.7152), real(0.0722)]).max(T::zero())
}

/// Chance of each lobe, R, TT, TRT, TRcT or medulla: its luminance, that of a one-sided core less where the eye is behind it.
pub fn fibre_lobe_chances<T: Real>(s: &FibreShading<T>) -> [T; 4] {
    let mut light = s.energy.map(luminance);
    if s.structural {
        let facing = (T::one() + s.azimuth[1]) * real(0.5);
        let side = T::one() + (clamp(facing, real(LEAST_SIDE), T::one()) - T::one()) * s.back[1];
        light[3] = light[3] * side;
    }
    let sum = light[0] + light[1] + light[2] + light[3];
    if sum > real(1e-9) {
        light.map(|l| l / sum)
    } else {
        [T::one(), T::zero(), T::zero(), T::zero()]
    }
}

/// The azimuth series that a lobe is sampled from, in its warped angle.
fn lobe_series<T: Real>(s: &FibreShading<T>, lobe: usize) -> [T; FIBRE_HARMONICS] {
    match lobe {
        0 => s.series[0],
        1 => {
            // The shape of TT between clear and dense, as far as the luminance goes.
            let whole = luminance(s.energy[1]).max(real(1e-9));
            let share = luminance(std::array::from_fn(|c| s.energy[1][c] * s.dense[c])) / whole;
            std::array::from_fn(|n| s.series[1][n] + (s.series[2][n] - s.series[1][n]) * share)
        }
        2 => s.series[3],
        _ if s.structural => s.series[4],
        _ => {
            let mut out = [T::zero(); FIBRE_HARMONICS];
            out[0] = s.medulla[0] + s.medulla[0];
            out[1] = s.medulla[1] + s.medulla[1];
            out
        }
    }
}

/// Density of [`fibre_sample`] at a direction, per steradian.
pub fn fibre_pdf(s: &FibreShading<f64>, omega_i: [f64; 3]) -> f64 {
    let (light, azimuth) = polar(omega_i);
    let at = azimuths(s, azimuth);
    let m = |i: usize| longitudinal_with(s.eye[i], light, s.spread[i]);
    let chance = fibre_lobe_chances(s);
    let round = |lobe: usize, cos: f64| azimuthal(&lobe_series(s, lobe), cos);
    let last = if s.structural {
        round(3, at.core.0) * at.stretch * m(3)
    } else {
        medulla_azimuth(s, at.turn.0)
            * light.1
            * (2.0 / PI)
            * (1.0 + s.medulla[2] * light.0).max(0.0)
    };
    let sum = chance[0] * round(0, at.surface.0) * at.surface_stretch * m(0)
        + chance[1] * round(1, at.through.0) * at.shrink * m(1)
        + chance[2] * round(2, at.turn.0) * m(2)
        + chance[3] * last;
    sum / (2.0 * PI)
}

/// Samples a direction of the light. `u` holds four numbers in 0..1: lobe, two along the fibre, one around it.
///
/// The mean of the weights is the albedo. None where the density vanishes.
pub fn fibre_sample(s: &FibreShading<f64>, u: [f64; 4]) -> Option<FibreSample> {
    let u = u.map(|x| clamp(x, 0.0, 1.0 - 1e-12));
    let chance = fibre_lobe_chances(s);
    let mut lobe = 0;
    let mut below = 0.0;
    while lobe < 3 && u[0] >= below + chance[lobe] {
        below += chance[lobe];
        lobe += 1;
    }
    let turn = (2.0 * PI * u[2]).cos();
    let sin_i = if lobe == 3 && !s.structural {
        // A projected disc has the density (2/pi) sqrt(1 - x^2); turning some points over tilts it.
        let x = u[1].sqrt() * turn;
        let rest = (u[0] - below) / chance[lobe].max(1e-9);
        if rest > 0.5 * (1.0 + s.medulla[2] * x) {
            -x
        } else {
            x
        }
    } else {
        // d'Eon et al. 2011: exact inversion of M.
        let v = 1.0 / s.spread[lobe].inverse;
        let u1 = u[1].max(1e-9);
        let along = 1.0 + v * (u1 + (1.0 - u1) * (-2.0 / v).exp()).ln();
        let (sin_o, cos_o) = s.eye[lobe];
        -along * sin_o + (1.0 - along * along).max(0.0).sqrt() * turn * cos_o
    }
    .clamp(-1.0, 1.0);
    let warped = fibre_invert_series(&lobe_series(s, lobe), u[3]);
    let [y, z] = unwarp(s, lobe, warped);
    let cos_i = (1.0 - sin_i * sin_i).max(0.0).sqrt();
    let direction = [sin_i, cos_i * y, cos_i * z];
    let pdf = fibre_pdf(s, direction);
    if pdf.is_nan() || pdf <= 1e-12 {
        return None;
    }
    Some(FibreSample {
        direction,
        pdf,
        weight: fibre_evaluate(s, direction).map(|k| k / pdf),
    })
}

/// Azimuth of the light (y, z) of a lobe's warped angle from the eye: the inverse of the warps of flat fibres.
fn unwarp(s: &FibreShading<f64>, lobe: usize, warped: f64) -> [f64; 2] {
    let o = s.azimuth;
    let turned = |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        [o[0] * cos + o[1] * sin, o[1] * cos - o[0] * sin]
    };
    if s.aspect >= ROUND {
        return turned(warped);
    }
    let a = match lobe {
        0 => s.surface_aspect,
        1 => {
            let back = warped - PI * warped.signum();
            return turned(PI + back * s.aspect.sqrt());
        }
        3 if s.structural => s.core_aspect,
        _ => return turned(warped),
    };
    // Half way in the parametric angle, then the normal there; the light is the eye mirrored at it.
    let (sin, cos) = (0.5 * warped).sin_cos();
    let (y, z) = (a * o[0], o[1]);
    let n = [a * (y * cos + z * sin), z * cos - y * sin];
    let l2 = (n[0] * n[0] + n[1] * n[1]).max(1e-12);
    let d = 2.0 * (n[0] * o[0] + n[1] * o[1]) / l2;
    [d * n[0] - o[0], d * n[1] - o[1]]
}

/// Angle in -pi..pi below which the share `u` of the density (1 + sum of s_n cos n phi)/2 pi lies: Newton's method, kept inside a
/// shrinking bracket because the series may touch 0.
pub fn fibre_invert_series<T: Real>(series: &[T; FIBRE_HARMONICS], u: T) -> T {
    let (half, pi) = (real::<T>(0.5), real::<T>(PI));
    let (mut low, mut high) = (-pi, pi);
    let wanted = (clamp(u, T::zero(), T::one()) - half) * (pi + pi);
    let mut phi = wanted;
    for _ in 0..STEPS {
        let (sin, cos) = phi.sin_cos();
        let (mut s, mut c) = (sin, cos);
        let (mut cumulated, mut density) = (phi, T::one());
        for (n, &a) in series.iter().enumerate() {
            cumulated = cumulated + a * s / real((n + 1) as f64);
            density = density + a * c;
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
        }
        let off = cumulated - wanted;
        if off < T::zero() {
            low = phi
        } else {
            high = phi
        }
        let next = phi - off / density.max(real(1e-3));
        phi = if next > low && next < high {
            next
        } else {
            (low + high) * half
        };
    }
    phi
}
