//! Importance sampling of one fibre (after Chen et al. 2026, Sec. 6.2.1), from the far-field series.

use super::{FIBRE_HARMONICS, FibreShading, azimuthal, clamp, fibre_evaluate, longitudinal};
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

/// Chance of each lobe: its luminance.
fn chances(s: &FibreShading<f64>) -> [f64; 4] {
    let light = s
        .energy
        .map(|e| (0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2]).max(0.0));
    let sum: f64 = light.iter().sum();
    if sum > 1e-12 {
        light.map(|l| l / sum)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    }
}

/// Azimuth series of a lobe as the sampler uses it. Shapes are unwarped: a flat fibre is sampled as a round one.
fn series(s: &FibreShading<f64>, lobe: usize) -> [f64; FIBRE_HARMONICS] {
    match lobe {
        0 => s.series[0],
        1 => s.series[1],
        2 => s.series[3],
        _ if s.structural => s.series[4],
        _ => {
            let mut out = [0.0; FIBRE_HARMONICS];
            (out[0], out[1]) = (2.0 * s.medulla[0], 2.0 * s.medulla[1]);
            out
        }
    }
}

/// Density of [`fibre_sample`] at a direction, per steradian.
pub fn fibre_pdf(s: &FibreShading<f64>, omega_i: [f64; 3]) -> f64 {
    let across = (omega_i[1] * omega_i[1] + omega_i[2] * omega_i[2]).sqrt();
    let light = (omega_i[0].clamp(-1.0, 1.0), across.min(1.0));
    let u = if across > 1e-6 {
        [omega_i[1] / across, omega_i[2] / across]
    } else {
        [0.0, 1.0]
    };
    let cos_phi = (s.azimuth[0] * u[0] + s.azimuth[1] * u[1]).clamp(-1.0, 1.0);
    let chance = chances(s);
    (0..4)
        .map(|lobe| {
            let along = if lobe == 3 && !s.structural {
                light.1 * 2.0 / PI
            } else {
                longitudinal(s.eye[lobe], light, s.width[lobe])
            };
            chance[lobe] * along * azimuthal(&series(s, lobe), cos_phi) / (2.0 * PI)
        })
        .sum()
}

/// Samples a direction of the light. `u` holds four numbers in 0..1: lobe, two along the fibre, one around it.
///
/// The mean of the weights is the albedo. None where the density vanishes.
pub fn fibre_sample(s: &FibreShading<f64>, u: [f64; 4]) -> Option<FibreSample> {
    let u = u.map(|x| clamp(x, 0.0, 1.0 - 1e-12));
    let chance = chances(s);
    let mut lobe = 0;
    let mut below = 0.0;
    while lobe < 3 && u[0] >= below + chance[lobe] {
        below += chance[lobe];
        lobe += 1;
    }
    let turn = (2.0 * PI * u[2]).cos();
    let sin_i = if lobe == 3 && !s.structural {
        // Projected disc: the density of its x coordinate is (2/pi) sqrt(1 - x^2).
        u[1].sqrt() * turn
    } else {
        // d'Eon et al. 2011: exact inversion of M.
        let v = s.width[lobe].clamp(0.01, 1.0).powi(2);
        let u1 = u[1].max(1e-9);
        let along = 1.0 + v * (u1 + (1.0 - u1) * (-2.0 / v).exp()).ln();
        let (sin_o, cos_o) = s.eye[lobe];
        -along * sin_o + (1.0 - along * along).max(0.0).sqrt() * turn * cos_o
    }
    .clamp(-1.0, 1.0);
    let phi = invert(&series(s, lobe), u[3]);
    let cos_i = (1.0 - sin_i * sin_i).max(0.0).sqrt();
    let (sp, cp) = phi.sin_cos();
    let [y, z] = s.azimuth;
    let direction = [sin_i, cos_i * (y * cp + z * sp), cos_i * (z * cp - y * sp)];
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

/// Azimuth at which the cumulated series reaches `u`, by bisection (the series may touch 0, where Newton fails).
fn invert(series: &[f64; FIBRE_HARMONICS], u: f64) -> f64 {
    let cumulated = |phi: f64| {
        let waves: f64 = series
            .iter()
            .enumerate()
            .map(|(i, s)| s * ((i + 1) as f64 * phi).sin() / (i + 1) as f64)
            .sum();
        0.5 + (phi + waves) / (2.0 * PI)
    };
    let (mut low, mut high) = (-PI, PI);
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if cumulated(middle) < u {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}
