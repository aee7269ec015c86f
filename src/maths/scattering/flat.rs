//! Flat fibres: elliptic cross-sections seen as warps of a round one's azimuth (docs/book/scattering.md#flat-fibres).

use super::{FibreShading, fresnel};
use crate::maths::functions::{Real, clamp, real};

/// Aspect from which on a fibre counts as round.
pub(super) const ROUND: f64 = 0.999;

/// Squared sines of the eye's azimuth between which the warp of TRcT fades out.
const EDGE_ON: (f64, f64) = (0.5, 0.9);

/// Energy of R of an elliptic fibre: less than a round one's when seen broadside, more edge on.
pub(super) fn flat_reflection<T: Real>(aspect: T, eta: T, cos_o: T, azimuth: [T; 2]) -> T {
    // t is the parametric angle of the ellipse; its value where the eye looks straight at the fibre:
    let (y, z) = (aspect * azimuth[0], azimuth[1]);
    let l = (y * y + z * z).max(real(1e-12)).sqrt();
    let (st, ct) = (y / l, z / l);
    // Gauss-Legendre in asin h, 8 nodes.
    let nodes = [
        (0.998_055_213_9, 0.009_912_027_6),
        (0.949_425_384_3, 0.109_682_471_3),
        (0.734_889_938_8, 0.334_189_396_1),
        (0.284_167_923_9, 0.546_216_104_9),
    ];
    let mut sum = T::zero();
    for (h, weight) in nodes {
        let c = real::<T>((1.0_f64 - h * h).sqrt());
        for h in [real::<T>(h), real(-h)] {
            let (z, y) = (ct * c - st * h, aspect * (st * c + ct * h));
            let cos = (z * azimuth[1] + y * azimuth[0]) / (z * z + y * y).max(real(1e-12)).sqrt();
            sum = sum + fresnel(cos_o * cos, eta) * real(0.5 * weight);
        }
    }
    sum.min(T::one())
}

/// Stretch of the azimuth warp of R and TRcT where the eye meets the fibre head on (docs/book/scattering.md#flat-fibres).
pub(super) fn stretch<T: Real>(aspect: T, azimuth: [T; 2]) -> T {
    let (s2, c2, a2) = (
        azimuth[0] * azimuth[0],
        azimuth[1] * azimuth[1],
        aspect * aspect,
    );
    (c2 + a2 * a2 * s2) / (aspect * (c2 + a2 * s2))
}

/// Aspect for the warp of TRcT. Seen edge on, rays pass beside the core of a flat fibre, and the warp, which was made for rays that
/// hit it, is farther from the truth than a circle: it fades out there.
pub(super) fn core_aspect<T: Real>(aspect: T, azimuth: [T; 2]) -> T {
    let x = clamp(
        (azimuth[0] * azimuth[0] - real(EDGE_ON.0)) / real(EDGE_ON.1 - EDGE_ON.0),
        T::zero(),
        T::one(),
    );
    let fade = x * x * (real::<T>(3.0) - x - x);
    aspect + (T::one() - aspect) * fade
}

/// The azimuths of one light as the lobes see them, each as (cos, sin) of the angle from the eye.
pub(super) struct Azimuths<T> {
    /// From eye to light.
    pub turn: (T, T),
    /// The same warped for TRcT; `stretch` its Jacobian.
    pub core: (T, T),
    pub stretch: T,
    /// Warped for R, with its Jacobian.
    pub surface: (T, T),
    pub surface_stretch: T,
    /// Narrowed for TT; `shrink` its Jacobian, 0 where nothing arrives.
    pub through: (T, T),
    pub shrink: T,
    /// Azimuth half way between eye and light as the unit vector (y, z).
    pub half: [T; 2],
}

/// Warps of the azimuth of the light for flat fibres (docs/book/scattering.md#flat-fibres), the identity for round ones.
pub(super) fn azimuths<T: Real>(s: &FibreShading<T>, light: [T; 2]) -> Azimuths<T> {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let o = s.azimuth;
    let cos_phi = clamp(o[0] * light[0] + o[1] * light[1], -one, one);
    let sin_phi = light[0] * o[1] - light[1] * o[0];
    // Direction of the normal half way between eye and light; exactly opposite: the side does not matter.
    let mut half = [o[0] + light[0], o[1] + light[1]];
    let length2 = half[0] * half[0] + half[1] * half[1];
    half = if length2 > real(1e-12) {
        let l = length2.sqrt();
        [half[0] / l, half[1] / l]
    } else {
        [o[1], -o[0]]
    };
    let turn = (cos_phi, sin_phi);
    let mut out = Azimuths {
        turn,
        core: turn,
        stretch: one,
        surface: turn,
        surface_stretch: one,
        through: turn,
        shrink: one,
        half,
    };
    if s.aspect < real(ROUND) {
        let warp = |a: T| {
            let hit2 = (sq(half[0]) + sq(a * half[1])).max(real(1e-6));
            let eye2 = sq(a * o[0]) + sq(o[1]);
            let scale = one / (hit2 * eye2).max(real(1e-12)).sqrt();
            // Cosine and sine of half the warped angle.
            let c = (a * half[1] * o[1] + half[0] * a * o[0]) * scale;
            let d = (half[0] * o[1] - a * a * half[1] * o[0]) * scale;
            let cos = clamp(two * c * c - one, -one, one);
            ((cos, two * c * d), a / hit2)
        };
        (out.core, out.stretch) = warp(s.core_aspect);
        (out.surface, out.surface_stretch) = warp(s.surface_aspect);
        let root = s.aspect.sqrt();
        let bend = (-cos_phi).max(-one).min(one).acos() / root;
        out.shrink = if bend > real(std::f64::consts::PI) {
            zero
        } else {
            one / root
        };
        let sin = bend.sin();
        out.through = (-bend.cos(), if sin_phi < zero { -sin } else { sin });
    }
    out
}

/// Density of R in phi times 2 pi and its energy for a flat fibre: the closed form J F cos(phi'/2)/4
/// (docs/book/scattering.md#flat-fibres). `half` is the azimuth half way between eye and light.
pub(super) fn flat_surface<T: Real>(s: &FibreShading<T>, half: [T; 2]) -> T {
    let (a, o) = (s.surface_aspect, s.azimuth);
    let hit2 = (sq(half[0]) + sq(a * half[1])).max(real(1e-6));
    let eye2 = sq(a * o[0]) + sq(o[1]);
    let incidence = half[0] * o[0] + half[1] * o[1];
    let d = a * incidence / (hit2 * eye2).max(real(1e-12)).sqrt();
    real::<T>(std::f64::consts::FRAC_PI_2) * a / hit2
        * d.abs().min(T::one())
        * fresnel(s.cos_eye * incidence, s.eta)
}

/// Cosine in the cross-section between the eye and the normal of a flat fibre, where a round one has its normal `gamma` away.
pub(super) fn flat_normal<T: Real>(s: &FibreShading<T>, gamma: T) -> T {
    let (a, o) = (s.surface_aspect, s.azimuth);
    let (y, z) = (a * o[0], o[1]);
    let l = (y * y + z * z).max(real(1e-12)).sqrt();
    let (sin, cos) = gamma.sin_cos();
    // Parametric angle of the point, then its normal.
    let (ny, nz) = (a * (y * cos + z * sin) / l, (z * cos - y * sin) / l);
    (ny * o[0] + nz * o[1]) / (ny * ny + nz * nz).max(real(1e-12)).sqrt()
}

fn sq<T: Real>(x: T) -> T {
    x * x
}
