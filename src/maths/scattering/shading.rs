//! One pixel: what the lights that fall on a fibre share.

use super::{
    FIBRE_HARMONICS, FibreParameters, FibreRow, LongitudinalSpread, fibre_color,
    flat::{ROUND, core_aspect, flat_reflection, stretch},
    frame::polar,
    gamma_memory, gamma_transmittance,
};
use crate::maths::functions::{Real, clamp, real};

fn sq<T: Real>(x: T) -> T {
    x * x
}

/// Series of a fibre: R, TT clear, TT dense, TRT, TRcT.
pub const FIBRE_SERIES: usize = 5;

/// Everything about a fibre and the eye that the lights of a pixel share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreShading<T> {
    /// Energy of R, TT, TRT and TRcT (or the medulla) per color channel; their sum is the albedo at this inclination.
    pub energy: [[T; 3]; 4],
    /// Damped series of R, TT clear, TT dense, TRT, TRcT: factors of cos n phi, n = 1..8, relative to the mean.
    pub series: [[T; FIBRE_HARMONICS]; FIBRE_SERIES],
    /// Azimuthal blur in radians that damped each series.
    pub blur: [T; FIBRE_SERIES],
    /// How far TT goes from the clear to the dense shape per channel, 0..1.3.
    pub dense: [T; 3],
    /// (sin, cos) of the eye's shifted and folded inclination per lobe.
    pub eye: [(T, T); 4],
    /// Longitudinal roughness per lobe, as [`longitudinal_with`](super::longitudinal_with) needs it.
    pub spread: [LongitudinalSpread<T>; 4],
    /// Medulla: a1, a2 and the slope in sin theta_i; zeros for a structural fibre.
    pub medulla: [T; 3],
    /// Has a mirror core.
    pub structural: bool,
    /// Minor over major axis.
    pub aspect: T,
    /// Aspect that R sees, the roughness taken into account; at most 1.
    pub surface_aspect: T,
    /// Aspect that TRcT's warp takes: towards round where the eye sees a flat fibre edge on.
    pub core_aspect: T,
    /// Refractive index and cosine of the eye's inclination: the reflection of flat fibres needs them.
    pub eta: T,
    /// See [`Self::eta`].
    pub cos_eye: T,
    /// Azimuth of the eye as the unit vector (y, z).
    pub azimuth: [T; 2],
    /// Half width of the transition to the dark back, and how dark the back is (0..1).
    pub back: [T; 2],
    /// How much of the medulla's light remembers around the fibre where it entered, per color channel: twice the mean cosine,
    /// over what it is for directions instead of places.
    pub around: [T; 3],
    /// How much of it remembers where along the fibre it entered, 0..1: 0 until [`fibre_along`](super::fibre_along) is asked.
    pub along: [T; 3],
    /// Absorption per fibre radius, per color channel.
    pub absorption: [T; 3],
}

/// 2 (pi / 4)^2: places spread over a silhouette, so the angle between two of them follows the directions' by pi/4 each.
pub(super) const TWICE_SILHOUETTE: f64 = 1.233_700_550_136_169_7;

/// Blur that one term can show, radians; more terms show less in proportion.
pub(super) const FIRST_BLUR: f64 = 1.6;

/// Series factors of a shape stored in two vec4s, damped by a Gaussian blur, cut after `harmonics`.
pub(super) fn damped<T: Real>(
    row: &FibreRow<T>,
    at: usize,
    blur: T,
    harmonics: u32,
) -> [T; FIBRE_HARMONICS] {
    let mut out = [T::zero(); FIBRE_HARMONICS];
    // exp(-n^2 b^2/2) from the one before: the exponents are 1, 1 + 3, 1 + 3 + 5..
    let first = (blur * blur * real(-0.5)).exp();
    let (square, mut step) = (first * first, first);
    let mut factor = real::<T>(2.0);
    for (n, o) in out.iter_mut().enumerate().take(harmonics as usize) {
        factor = factor * step;
        step = step * square;
        *o = row[at + n / 4][n % 4] * factor;
    }
    out
}

/// Prepares a fibre for the lights of one pixel.
///
/// `row`: the fibre's table at cos theta_o = |(y, z) of `omega_o`|; `albedo`: linear RGB; `omega_o`: to the eye, in the
/// fibre's frame; `dark_back`: 1 where the core is a mirror on the outer face only (local +z) and black behind, 0 where it is one all
/// around; `harmonics`: 1..=8 terms, 8 near, 3 for the mean level of detail (fewer terms blur the azimuth).
pub fn fibre_shading<T: Real>(
    p: &FibreParameters<T>,
    row: &FibreRow<T>,
    albedo: [T; 3],
    omega_o: [T; 3],
    dark_back: T,
    harmonics: u32,
) -> FibreShading<T> {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let harmonics = harmonics.clamp(1, FIBRE_HARMONICS as u32);
    let ((sin_o, cos_o), azimuth) = polar(omega_o);
    let color = fibre_color(p, albedo);

    let mut energy = [[zero; 3]; 4];
    let mut dense = [zero; 3];
    let series_share = row[2][0];
    // The lobe of a flat fibre is as narrow as it is flat: what blur would add is taken off the flatness. 1.37: the deviation of
    // a round one's (docs/book/fits/fibre.py).
    let surface_aspect = (sq(p.aspect) + sq(p.azimuthal_roughness / real(1.37)))
        .sqrt()
        .min(one);
    let (mut surface, mut entering) = (row[0][0], one);
    if p.aspect < real(ROUND) {
        surface = flat_reflection(surface_aspect, p.eta, cos_o, azimuth);
        entering = (one - surface) / (one - row[0][0]).max(real(1e-6));
    }
    for c in 0..3 {
        let sigma = color.absorption[c];
        dense[c] = (two * sigma / (two + sigma)).min(real(1.3));
        energy[0][c] = surface;
        energy[1][c] = row[0][1] * entering * gamma_transmittance(row[1][0], row[1][1], sigma);
        energy[2][c] = row[0][2] * entering * gamma_transmittance(row[1][2], row[1][3], sigma);
        energy[3][c] = row[0][3]
            * entering
            * if p.structural {
                let r = color.core[c];
                r * (one - series_share) / (one - series_share * r)
            } else {
                gamma_transmittance(row[2][0], row[2][1], sigma)
            };
    }

    // Too few terms for a narrow lobe would ring: blur it to what they can show.
    let blur = p
        .azimuthal_roughness
        .max(real::<T>(FIRST_BLUR) / real(f64::from(harmonics)));
    let warped = blur * stretch(p.aspect, azimuth);
    let core_aspect = core_aspect(p.aspect, azimuth);
    let narrowed = blur / p.aspect.sqrt();
    let blur = [
        warped,
        narrowed,
        narrowed,
        blur,
        blur * stretch(core_aspect, azimuth),
    ];
    let series = [
        damped(row, 5, blur[0], harmonics),
        damped(row, 7, blur[1], harmonics),
        damped(row, 9, blur[2], harmonics),
        damped(row, 11, blur[3], harmonics),
        if p.structural {
            damped(row, 3, blur[4], harmonics)
        } else {
            [zero; FIBRE_HARMONICS]
        },
    ];
    let mut eye = [(zero, one); 4];
    for (eye, (s, c)) in eye.iter_mut().zip(p.shift) {
        // Beyond the pole the cosine turns negative: its absolute value is the fold.
        *eye = (sin_o * c - cos_o * s, (cos_o * c + sin_o * s).abs());
    }
    let forward = if sin_o < zero { -one } else { one };
    let around = color.absorption.map(|sigma| {
        if p.structural {
            return zero;
        }
        gamma_memory(row[2][0], row[2][1], sigma, row[3][1]) * real(TWICE_SILHOUETTE)
    });
    let medulla = if p.structural {
        [zero; 3]
    } else {
        [
            row[2][2],
            row[2][3],
            clamp(real::<T>(4.0) * row[3][0], -one, one) * forward,
        ]
    };
    FibreShading {
        energy,
        series,
        blur,
        dense,
        eye,
        spread: p.spread,
        medulla,
        structural: p.structural,
        aspect: p.aspect,
        surface_aspect,
        core_aspect,
        eta: p.eta,
        cos_eye: cos_o,
        azimuth,
        back: [p.azimuthal_roughness, clamp(dark_back, zero, one)],
        around,
        along: [zero; 3],
        absorption: color.absorption,
    }
}
