//! The structural fibre as printed (Chen et al. 2026, Eq. 30-33), for comparison in charts. Not used for rendering.
//!
//! Differences to [`super::fibre_evaluate`]: a Gaussian instead of d'Eon's lobe, attenuation at theta_d with path lengths over
//! cos theta_d, open series of inner reflections, the far field by the midpoint rule over h. Taken literally (without the
//! cosine of the light) its integral diverges at grazing light; here the cosine is kept, which is the kindest reading.

use super::{Crossing, Lobe, crossing, exit_angle};
use std::f64::consts::PI;

/// A structural fibre in the printed model, one colour channel.
#[derive(Clone, Copy, Debug)]
pub struct PublishedFibre {
    /// Refractive index.
    pub eta: f64,
    /// Radius of the core over the fibre's, 0..1.
    pub core: f64,
    /// Reflectance of the core, 0..1.
    pub reflectance: f64,
    /// Absorption in the cortex per fibre radius.
    pub absorption: f64,
    /// Longitudinal roughness of R in radians.
    pub longitudinal_roughness: f64,
    /// Azimuthal roughness in radians.
    pub azimuthal_roughness: f64,
    /// Longitudinal shift of R in radians.
    pub tilt: f64,
    /// Midpoints over h, at least 1.
    pub nodes: usize,
}

/// Attenuation of R, TT, TRT and TRcT with open series; `cos_d` = cos theta_d.
pub fn published_attenuation(f: &PublishedFibre, c: &Crossing<f64>, cos_d: f64) -> [f64; 4] {
    let through = (1.0 - c.fresnel).powi(2);
    let cos_t = (1.0 - c.offset * c.offset).max(0.0).sqrt();
    if c.offset.abs() < f.core {
        // Eq. 33.
        let length = 2.0 * (cos_t - (f.core * f.core - c.offset * c.offset).max(0.0).sqrt());
        let t = f.reflectance * (-f.absorption * length / cos_d).exp();
        return [c.fresnel, 0.0, 0.0, through * t];
    }
    let t = (-2.0 * f.absorption * cos_t / cos_d).exp();
    [c.fresnel, through * t, through * c.fresnel * t * t, 0.0]
}

/// S cos(theta_i) of the printed model at inclinations in -pi/2..pi/2 and relative azimuth `phi`, per steradian.
///
/// Not bounded: it grows towards the poles. cos theta_i is kept at 0.02 or more.
pub fn published_evaluate(f: &PublishedFibre, theta_i: f64, theta_o: f64, phi: f64) -> f64 {
    let cos_d = (0.5 * (theta_i - theta_o)).cos().max(1e-3);
    let (n, beta) = (f.nodes.max(1), f.azimuthal_roughness.max(1e-3));
    let mut azimuth = [0.0; 4];
    for i in 0..n {
        let h = -1.0 + 2.0 * (i as f64 + 0.5) / n as f64;
        let c = crossing(f.eta, cos_d, h);
        let a = published_attenuation(f, &c, cos_d);
        for (lobe, kind) in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT]
            .into_iter()
            .enumerate()
        {
            if a[lobe] > 0.0 {
                let x = phi - exit_angle(kind, &c, f.core);
                let x = x - 2.0 * PI * (x / (2.0 * PI)).round();
                azimuth[lobe] += a[lobe] * gaussian(x, beta) / n as f64;
            }
        }
    }
    // Marschner's shifts and widths.
    let (a, b) = (f.tilt, f.longitudinal_roughness.max(1e-3));
    let lobes = [
        (a, b),
        (-0.5 * a, 0.5 * b),
        (-1.5 * a, 2.0 * b),
        (-0.5 * a, b),
    ];
    let along = lobes.map(|(shift, width)| gaussian(theta_i + theta_o - shift, width));
    let sum: f64 = azimuth.iter().zip(along).map(|(n, m)| n * m).sum();
    sum / theta_i.cos().max(0.02)
}

fn gaussian(x: f64, deviation: f64) -> f64 {
    (-0.5 * (x / deviation).powi(2)).exp() / (deviation * (2.0 * PI).sqrt())
}
