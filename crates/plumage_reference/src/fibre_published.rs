//! The structural fibre and the feather as printed (Chen et al. 2026, Eq. 30-35), for comparison in charts. Not used for rendering.
//!
//! Differences to [`bevy_plumage::maths::scattering::fibre_evaluate`]: a Gaussian instead of d'Eon's lobe, attenuation at theta_d with path lengths over
//! cos theta_d, open series of inner reflections, the far field by the midpoint rule over h. Taken literally (without the
//! cosine of the light, [`published_bcsdf`]) its integral diverges at grazing light; [`published_evaluate`] keeps the cosine, which is
//! the kindest reading.

use bevy_plumage::maths::scattering::{Crossing, Lobe, crossing, exit_angle};
use std::f64::consts::PI;

/// A structural fibre in the printed model, one color channel.
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

/// Marschner's index for an elliptic fibre of minor over major axis `aspect`, at the half-way azimuth `phi_h` from the minor axis.
///
/// As printed, without bounds: it falls below 1 for flat fibres seen broadside (0.846 at aspect 0.6), where no light refracts.
pub fn published_index(eta: f64, aspect: f64, phi_h: f64) -> f64 {
    let square = aspect * aspect;
    let broadside = 2.0 * (eta - 1.0) * square - eta + 2.0;
    let edge_on = 2.0 * (eta - 1.0) / square - eta + 2.0;
    0.5 * ((broadside + edge_on) + (2.0 * phi_h).cos() * (broadside - edge_on))
}

/// Azimuthal terms N of R, TT, TRT and TRcT (Eq. 32), averaged over h by the midpoint rule; `cos_d` = cos theta_d, `eta` the index
/// for refraction (Fresnel keeps the fibre's own).
pub fn published_azimuthal(f: &PublishedFibre, eta: f64, cos_d: f64, phi: f64) -> [f64; 4] {
    let (n, beta) = (f.nodes.max(1), f.azimuthal_roughness.max(1e-3));
    let mut azimuth = [0.0; 4];
    for i in 0..n {
        let h = -1.0 + 2.0 * (i as f64 + 0.5) / n as f64;
        let c = Crossing {
            fresnel: crossing(f.eta, cos_d, h).fresnel,
            ..crossing(eta, cos_d, h)
        };
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
    azimuth
}

/// Longitudinal terms M of R, TT, TRT and TRcT (Eq. 31) with Marschner's shifts and widths.
pub fn published_longitudinal(f: &PublishedFibre, theta_i: f64, theta_o: f64) -> [f64; 4] {
    let (a, b) = (f.tilt, f.longitudinal_roughness.max(1e-3));
    [
        (a, b),
        (-0.5 * a, 0.5 * b),
        (-1.5 * a, 2.0 * b),
        (-0.5 * a, b),
    ]
    .map(|(shift, width)| gaussian(theta_i + theta_o - shift, width))
}

/// S of Eq. 30, to the letter: M N over cos^2 theta_i, per steradian. Not bounded towards the poles.
pub fn published_bcsdf(f: &PublishedFibre, theta_i: f64, theta_o: f64, phi: f64) -> f64 {
    let cos_d = (0.5 * (theta_i - theta_o)).cos().max(1e-3);
    let along = published_longitudinal(f, theta_i, theta_o);
    let around = published_azimuthal(f, f.eta, cos_d, phi);
    let sum: f64 = around.iter().zip(along).map(|(n, m)| n * m).sum();
    sum / theta_i.cos().powi(2).max(1e-12)
}

/// S cos(theta_i) of the printed model at inclinations in -pi/2..pi/2 and relative azimuth `phi`, per steradian.
///
/// Not bounded: it grows towards the poles. cos theta_i is kept at 0.02 or more.
pub fn published_evaluate(f: &PublishedFibre, theta_i: f64, theta_o: f64, phi: f64) -> f64 {
    let cos = theta_i.cos();
    published_bcsdf(f, theta_i, theta_o, phi) * cos * cos / cos.max(0.02)
}

/// The same for an elliptic fibre: [`published_index`] bends TRT, as the index was made for; `phi_o` and `phi_i` are the azimuths of
/// eye and light from the minor axis. The index is kept within 1.05..3.
pub fn published_elliptic(
    f: &PublishedFibre,
    aspect: f64,
    (theta_i, phi_i): (f64, f64),
    (theta_o, phi_o): (f64, f64),
) -> f64 {
    let cos_d = (0.5 * (theta_i - theta_o)).cos().max(1e-3);
    let phi = phi_i - phi_o;
    let eta = published_index(f.eta, aspect, 0.5 * (phi_i + phi_o)).clamp(1.05, 3.0);
    let mut around = published_azimuthal(f, f.eta, cos_d, phi);
    around[2] = published_azimuthal(f, eta, cos_d, phi)[2];
    let along = published_longitudinal(f, theta_i, theta_o);
    let sum: f64 = around.iter().zip(along).map(|(n, m)| n * m).sum();
    sum / theta_i.cos().max(0.02)
}

/// The BSDF f_s of Eq. 35, to the letter: the sum of weights times S, over |omega_i . n|. The delta of what shines through,
/// `w_t = 1 - sum of weights`, is left out. Infinite for light in the plane of the vane.
pub fn published_feather(parts: &[(f64, f64)], cos_normal: f64) -> f64 {
    let sum: f64 = parts.iter().map(|(weight, s)| weight * s).sum();
    sum / cos_normal.abs()
}

fn gaussian(x: f64, deviation: f64) -> f64 {
    (-0.5 * (x / deviation).powi(2)).exp() / (deviation * (2.0 * PI).sqrt())
}
