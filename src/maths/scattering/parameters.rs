//! What a fibre's evaluation reads besides its table row, the same on the CPU and on the GPU: twelve numbers, and what follows from
//! them for all eyes and lights.

use super::{Lobe, LongitudinalSpread, lobe_shift, lobe_width, longitudinal_spread};
use crate::maths::functions::{Real, clamp, real};

/// Unpacked parameters of one fibre; see [`fibre_parameters`] for the packed order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreParameters<T> {
    /// Longitudinal roughness of R in radians, 0.01..1.
    pub longitudinal_roughness: T,
    /// Azimuthal roughness of every lobe in radians, 0.05..2.
    pub azimuthal_roughness: T,
    /// Longitudinal shift of R in radians.
    pub tilt: T,
    /// Minor over major axis, 0.2..1; the minor axis is the local z.
    pub aspect: T,
    /// Refractive index.
    pub eta: T,
    /// Has a mirror core (lobe TRcT) rather than a medulla.
    pub structural: bool,
    /// Radius of the core or of the medulla over the fibre's.
    pub core: T,
    /// Mean Fresnel reflectance over the width of the fibre at theta_o = 0: its smallest albedo.
    pub fresnel: T,
    /// Product k t of the fibre's own color curve `(1 + sigma t)^-k` at theta_o = 0.
    pub color_kt: T,
    /// t of that curve, at least 1e-4; per unit of absorption times fibre radius.
    pub color_t: T,
    /// Scattering of the medulla per fibre radius; 0 for a structural fibre.
    pub scattering: T,
    /// c in the sum `R (1 - c)/(1 - c R)` of the round trips between core and surface at theta_o = 0.
    pub round_trips: T,
    /// Sine and cosine of the longitudinal shift of R, TT, TRT and TRcT.
    pub shift: [(T, T); 4],
    /// Their longitudinal roughness as their terms need it.
    pub spread: [LongitudinalSpread<T>; 4],
}

impl<T: Real> FibreParameters<T> {
    /// Least albedo that color gives a fibre: its surface reflects alone.
    pub fn darkest(&self) -> T {
        self.fresnel + real(0.002)
    }
}

/// Unpacks three vec4s: `a` = (longitudinal roughness, azimuthal roughness, tilt, aspect), `b` = (eta, 1 for a structural
/// fibre or 0, core or medulla radius, mean Fresnel), `c` = (k t, t, scattering of the medulla, share of round trips).
///
/// Every value is clamped to its range, so a zeroed buffer gives a defined, grey fibre.
pub fn fibre_parameters<T: Real>(a: [T; 4], b: [T; 4], c: [T; 4]) -> FibreParameters<T> {
    let longitudinal_roughness = clamp(a[0], real(0.01), T::one());
    let tilt = clamp(a[2], real(-0.5), real(0.5));
    let eta = clamp(b[0], real(1.05), real(3.0));
    let lobes = [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT];
    FibreParameters {
        longitudinal_roughness,
        azimuthal_roughness: clamp(a[1], real(0.05), real(2.0)),
        tilt,
        aspect: clamp(a[3], real(0.2), T::one()),
        eta,
        structural: b[1] > real(0.5),
        core: clamp(b[2], T::zero(), real(0.999_999)),
        fresnel: clamp(b[3], T::zero(), real(0.9)),
        color_kt: c[0].max(T::zero()),
        color_t: c[1].max(real(1e-4)),
        scattering: clamp(c[2], T::zero(), real(1e3)),
        round_trips: clamp(c[3], T::zero(), real(0.9)),
        shift: lobes.map(|lobe| lobe_shift(lobe, tilt, eta).sin_cos()),
        spread: lobes
            .map(|lobe| longitudinal_spread(lobe_width(lobe, longitudinal_roughness, eta))),
    }
}
