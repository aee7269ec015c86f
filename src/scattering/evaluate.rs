//! One pixel, then one light: the twins of `scattering.wgsl`.

use super::{
    FIBRE_HARMONICS, FibreParameters, FibreRow, Lobe, clamp, dot, fibre_colour, fresnel,
    gamma_transmittance, lobe_shift, lobe_width, longitudinal, real,
};
use num_traits::Float;

/// Series of a fibre: R, TT clear, TT dense, TRT, TRcT.
pub const FIBRE_SERIES: usize = 5;

/// Everything about a fibre and the eye that the lights of a pixel share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreShading<T> {
    /// Energy of R, TT, TRT and TRcT (or the medulla) per colour channel; their sum is the albedo at this inclination.
    pub energy: [[T; 3]; 4],
    /// Damped series of R, TT clear, TT dense, TRT, TRcT: factors of cos n phi, n = 1..8, relative to the mean.
    pub series: [[T; FIBRE_HARMONICS]; FIBRE_SERIES],
    /// Azimuthal blur in radians that damped each series.
    pub blur: [T; FIBRE_SERIES],
    /// How far TT goes from the clear to the dense shape per channel, 0..1.3.
    pub dense: [T; 3],
    /// (sin, cos) of the eye's shifted and folded inclination per lobe.
    pub eye: [(T, T); 4],
    /// Longitudinal roughness per lobe.
    pub width: [T; 4],
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
}

/// Energy by where it goes, for light that has no single direction (environment maps).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreEnergy<T> {
    /// Surface reflection R, colourless.
    pub specular: T,
    /// All other light that returns to the side of the eye.
    pub front: [T; 3],
    /// Light that passes to the other side.
    pub back: [T; 3],
}

/// A direction in the frame of a fibre: x along `tangent`, z the normal made orthogonal to it, y = z cross x.
///
/// `tangent` and `normal` need not be unit vectors; parallel or zero ones give a defined frame.
pub fn fibre_local<T: Float>(tangent: [T; 3], normal: [T; 3], omega: [T; 3]) -> [T; 3] {
    let x = unit(tangent, [T::one(), T::zero(), T::zero()]);
    let d = dot(x, normal);
    let raw = [
        normal[0] - x[0] * d,
        normal[1] - x[1] * d,
        normal[2] - x[2] * d,
    ];
    // A normal along the tangent: any direction across will do.
    let spare = if x[0].abs() < real(0.7) {
        [T::one(), T::zero(), T::zero()]
    } else {
        [T::zero(), T::one(), T::zero()]
    };
    let z = unit(
        raw,
        unit(cross(cross(x, spare), x), [T::zero(), T::zero(), T::one()]),
    );
    let y = cross(z, x);
    [dot(omega, x), dot(omega, y), dot(omega, z)]
}

fn cross<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit<T: Float>(a: [T; 3], otherwise: [T; 3]) -> [T; 3] {
    let l2 = dot(a, a);
    if l2 > real(1e-12) {
        let s = T::one() / l2.sqrt();
        [a[0] * s, a[1] * s, a[2] * s]
    } else {
        otherwise
    }
}

/// (sin, cos) of the inclination and the unit azimuth (y, z) of a local direction; azimuth 0 along the fibre.
pub(super) fn polar<T: Float>(omega: [T; 3]) -> ((T, T), [T; 2]) {
    let across = omega[1] * omega[1] + omega[2] * omega[2];
    let c = across.max(T::zero()).sqrt();
    let azimuth = if across > real(1e-12) {
        [omega[1] / c, omega[2] / c]
    } else {
        [T::zero(), T::one()]
    };
    (
        (clamp(omega[0], -T::one(), T::one()), c.min(T::one())),
        azimuth,
    )
}

/// Aspect from which on a fibre counts as round.
pub(super) const ROUND: f64 = 0.999;

/// Squared sines of the eye's azimuth between which the warp of TRcT fades out.
const EDGE_ON: (f64, f64) = (0.5, 0.9);

/// Energy of R of an elliptic fibre: less than a round one's when seen broadside, more edge on.
fn flat_reflection<T: Float>(aspect: T, eta: T, cos_o: T, azimuth: [T; 2]) -> T {
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

/// Stretch of the azimuth warp of R and TRcT where the eye meets the fibre head on (scattering study 1.5).
fn stretch<T: Float>(aspect: T, azimuth: [T; 2]) -> T {
    let (s2, c2, a2) = (
        azimuth[0] * azimuth[0],
        azimuth[1] * azimuth[1],
        aspect * aspect,
    );
    (c2 + a2 * a2 * s2) / (aspect * (c2 + a2 * s2))
}

/// Aspect for the warp of TRcT. Seen edge on, rays pass beside the core of a flat fibre, and the warp, which was made for rays that
/// hit it, is farther from the truth than a circle: it fades out there.
fn core_aspect<T: Float>(aspect: T, azimuth: [T; 2]) -> T {
    let x = clamp(
        (azimuth[0] * azimuth[0] - real(EDGE_ON.0)) / real(EDGE_ON.1 - EDGE_ON.0),
        T::zero(),
        T::one(),
    );
    let fade = x * x * (real::<T>(3.0) - x - x);
    aspect + (T::one() - aspect) * fade
}

/// Series factors of a shape stored in two vec4s, damped by a Gaussian blur, cut after `harmonics`.
fn damped<T: Float>(row: &FibreRow<T>, at: usize, blur: T, harmonics: u32) -> [T; FIBRE_HARMONICS] {
    let mut out = [T::zero(); FIBRE_HARMONICS];
    for (n, o) in out.iter_mut().enumerate().take(harmonics as usize) {
        let k = real::<T>((n + 1) as f64) * blur;
        *o = row[at + n / 4][n % 4] * (k * k * real(-0.5)).exp() * real(2.0);
    }
    out
}

/// Prepares a fibre for the lights of one pixel.
///
/// `row`: the fibre's table at cos theta_o = |(y, z) of `omega_o`|; `albedo`: linear RGB; `omega_o`: to the eye, in the
/// fibre's frame; `dark_back`: 1 where the core is a mirror on the outer face only (local +z) and black behind, 0 where it is one all
/// around; `harmonics`: 1..=8 terms, 8 near, 3 for the mean level of detail (fewer terms blur the azimuth).
pub fn fibre_shading<T: Float>(
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
    let colour = fibre_colour(p, albedo);

    let mut energy = [[zero; 3]; 4];
    let mut dense = [zero; 3];
    let series_share = row[2][0];
    // The lobe of a flat fibre is as narrow as it is flat: what blur would add is taken off the flatness.
    let surface_aspect = (sq(p.aspect) + sq(p.azimuthal_roughness / real(1.37)))
        .sqrt()
        .min(one);
    let (mut surface, mut entering) = (row[0][0], one);
    if p.aspect < real(ROUND) {
        surface = flat_reflection(surface_aspect, p.eta, cos_o, azimuth);
        entering = (one - surface) / (one - row[0][0]).max(real(1e-6));
    }
    for c in 0..3 {
        let sigma = colour.absorption[c];
        dense[c] = (two * sigma / (two + sigma)).min(real(1.3));
        energy[0][c] = surface;
        energy[1][c] = row[0][1] * entering * gamma_transmittance(row[1][0], row[1][1], sigma);
        energy[2][c] = row[0][2] * entering * gamma_transmittance(row[1][2], row[1][3], sigma);
        energy[3][c] = row[0][3]
            * entering
            * if p.structural {
                let r = colour.core[c];
                r * (one - series_share) / (one - series_share * r)
            } else {
                gamma_transmittance(row[2][0], row[2][1], sigma)
            };
    }

    // Too few terms for a narrow lobe would ring: blur it to what they can show.
    let blur = p
        .azimuthal_roughness
        .max(real::<T>(1.6) / real(f64::from(harmonics)));
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
    let mut width = [one; 4];
    for (i, lobe) in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT]
        .into_iter()
        .enumerate()
    {
        // Beyond the pole the cosine turns negative: its absolute value is the fold.
        let (s, c) = lobe_shift(lobe, p.tilt, p.eta).sin_cos();
        eye[i] = (sin_o * c - cos_o * s, (cos_o * c + sin_o * s).abs());
        width[i] = lobe_width(lobe, p.longitudinal_roughness, p.eta);
    }
    let forward = if sin_o < zero { -one } else { one };
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
        width,
        medulla,
        structural: p.structural,
        aspect: p.aspect,
        surface_aspect,
        core_aspect,
        eta: p.eta,
        cos_eye: cos_o,
        azimuth,
        back: [p.azimuthal_roughness, clamp(dark_back, zero, one)],
    }
}

/// `1 + sum of s_n cos n phi`, at least 0: the density of a lobe in phi times 2 pi.
pub fn azimuthal<T: Float>(series: &[T; FIBRE_HARMONICS], cos_phi: T) -> T {
    raw_series(series, cos_phi).max(T::zero())
}

fn raw_series<T: Float>(series: &[T; FIBRE_HARMONICS], cos_phi: T) -> T {
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

impl<T: Float> Odd<'_, T> {
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

/// Warps of the azimuth of the light for flat fibres (scattering study 1.5), the identity for round ones.
pub(super) fn azimuths<T: Float>(s: &FibreShading<T>, light: [T; 2]) -> Azimuths<T> {
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

/// How much of the mirror core's lobe is left where the core is dark behind, 0..1; `half_z`: z of the azimuth half way between eye
/// and light.
pub(super) fn core_side<T: Float>(s: &FibreShading<T>, half_z: T) -> T {
    let b = s.back[0];
    let x = clamp((half_z + b) / (b + b), T::zero(), T::one());
    let lit = x * x * (real::<T>(3.0) - x - x);
    T::one() + (lit - T::one()) * s.back[1]
}

/// K = S cos(theta_i) of the fibre for light from `omega_i` (in its frame), linear RGB per steradian, at least 0.
pub fn fibre_evaluate<T: Float>(s: &FibreShading<T>, omega_i: [T; 3]) -> [T; 3] {
    evaluate_with(s, Odd::None, omega_i)
}

pub(super) fn evaluate_with<T: Float>(s: &FibreShading<T>, odd: Odd<T>, omega_i: [T; 3]) -> [T; 3] {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let pi = real::<T>(std::f64::consts::PI);
    let (light, azimuth) = polar(omega_i);
    let at = azimuths(s, azimuth);
    let raw = |k: usize, angle: (T, T)| raw_series(&s.series[k], angle.0) + odd.sum(k, angle);
    let norm = one / (two * pi);
    let m = |i: usize| longitudinal(s.eye[i], light, s.width[i]) * norm;
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
    std::array::from_fn(|c| {
        let tt = (clear + (dense - clear) * s.dense[c]).max(zero) * through;
        s.energy[0][c] * reflected
            + s.energy[1][c] * tt
            + s.energy[2][c] * inner
            + s.energy[3][c] * fourth
    })
}

/// Density of the medulla's light in phi times 2 pi.
pub(super) fn medulla_azimuth<T: Float>(s: &FibreShading<T>, cos_phi: T) -> T {
    let two = real::<T>(2.0);
    let f = T::one()
        + two * s.medulla[0] * cos_phi
        + two * s.medulla[1] * (two * cos_phi * cos_phi - T::one());
    f.max(T::zero())
}

/// Density of R in phi times 2 pi and its energy for a flat fibre: the closed form J F cos(phi'/2)/4 (scattering study 1.5).
/// `half` is the azimuth half way between eye and light.
fn flat_surface<T: Float>(s: &FibreShading<T>, half: [T; 2]) -> T {
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
pub(super) fn flat_normal<T: Float>(s: &FibreShading<T>, gamma: T) -> T {
    let (a, o) = (s.surface_aspect, s.azimuth);
    let (y, z) = (a * o[0], o[1]);
    let l = (y * y + z * z).max(real(1e-12)).sqrt();
    let (sin, cos) = gamma.sin_cos();
    // Parametric angle of the point, then its normal.
    let (ny, nz) = (a * (y * cos + z * sin) / l, (z * cos - y * sin) / l);
    (ny * o[0] + nz * o[1]) / (ny * ny + nz * nz).max(real(1e-12)).sqrt()
}

fn sq<T: Float>(x: T) -> T {
    x * x
}

/// Share of a fibre in a flat array that light from `omega_i` sees between its neighbours, 0..1 (scattering study 6.3).
///
/// `cos_normal`: |omega_i . n|; `coverage`: width of the fibres over their period, seen along the normal; `cos_theta`: cosine of the
/// light's inclination in the fibre's frame. Without it a vane lit at grazing angles would scatter more than it receives.
pub fn light_visibility<T: Float>(cos_normal: T, coverage: T, cos_theta: T) -> T {
    clamp(
        cos_normal.abs() / (coverage.max(T::zero()) * cos_theta.max(real(1e-3))).max(real(1e-6)),
        T::zero(),
        T::one(),
    )
}

/// Mean of [`light_visibility`] over light from all around a fibre, 2/pi (dense) to 1 (alone): in closed form, since the visibility
/// depends on the azimuth only, `min(1, |cos phi| / coverage)`.
pub fn mean_visibility<T: Float>(coverage: T) -> T {
    let one = T::one();
    let c = clamp(coverage, real(1e-3), one);
    // 1 - sqrt(1 - c^2) without cancellation.
    let sine = (one - c * c).max(T::zero()).sqrt();
    (c.acos() + c / (one + sine)) * real(std::f64::consts::FRAC_2_PI)
}

/// Share of a lobe that stays on the side of the eye (|phi| below 90 degrees), 0..1.
fn share_front<T: Float>(s: &[T; FIBRE_HARMONICS]) -> T {
    let odd = s[0] - s[2] / real(3.0) + s[4] / real(5.0) - s[6] / real(7.0);
    clamp(
        real::<T>(0.5) + odd * real(std::f64::consts::FRAC_1_PI),
        T::zero(),
        T::one(),
    )
}

/// Share of light that the fibre scatters into all directions, linear RGB, 0..1.
pub fn fibre_albedo<T: Float>(s: &FibreShading<T>) -> [T; 3] {
    std::array::from_fn(|c| s.energy[0][c] + s.energy[1][c] + s.energy[2][c] + s.energy[3][c])
}

/// Splits the fibre's energy for light without a direction. `specular + front + back` is the albedo, less what a dark back
/// swallows.
pub fn fibre_energy_split<T: Float>(s: &FibreShading<T>) -> FibreEnergy<T> {
    let one = T::one();
    let facing = one + (clamp((one + s.azimuth[1]) * real(0.5), T::zero(), one) - one) * s.back[1];
    let (clear, dense) = (share_front(&s.series[1]), share_front(&s.series[2]));
    let inner = share_front(&s.series[3]);
    let (fourth, lit) = if s.structural {
        (share_front(&s.series[4]), facing)
    } else {
        (
            clamp(
                real::<T>(0.5) + s.medulla[0] * real(2.0 * std::f64::consts::FRAC_1_PI),
                T::zero(),
                one,
            ),
            one,
        )
    };
    let mut out = FibreEnergy {
        specular: s.energy[0][0],
        front: [T::zero(); 3],
        back: [T::zero(); 3],
    };
    for c in 0..3 {
        let tt = clamp(clear + (dense - clear) * s.dense[c], T::zero(), one);
        let last = s.energy[3][c] * lit;
        out.front[c] = s.energy[1][c] * tt + s.energy[2][c] * inner + last * fourth;
        out.back[c] =
            s.energy[1][c] * (one - tt) + s.energy[2][c] * (one - inner) + last * (one - fourth);
    }
    out
}
