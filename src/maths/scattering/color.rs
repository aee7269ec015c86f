//! From a wanted albedo to the fibre's material: reflectance of the core or absorption
//! (docs/book/scattering.md#color-from-an-albedo).

use super::FibreParameters;
use crate::maths::functions::{Real, clamp, real};

/// Material of a fibre per color channel (linear RGB).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreColor<T> {
    /// Reflectance of the mirror core, 0..1 (1 for pigment fibres, which have none).
    pub core: [T; 3],
    /// Absorption per fibre radius, 0..1e4, of the light that does not meet the core.
    pub absorption: [T; 3],
}

impl<T: Real> FibreColor<T> {
    /// A fibre that absorbs nothing.
    pub fn white() -> Self {
        Self {
            core: [T::one(); 3],
            absorption: [T::zero(); 3],
        }
    }
}

/// `(1 + sigma t)^-k`: how a distribution of path lengths absorbs; `kt` = k t, `t` >= 1e-4.
pub fn gamma_transmittance<T: Real>(kt: T, t: T, sigma: T) -> T {
    let t = t.max(real(1e-4));
    (-kt * (sigma * t).ln_1p() / t).exp()
}

/// What is left of a memory that fades with the path like an absorption `rate`, in light of which [`gamma_transmittance`] lets through
/// the rest: `((1 + sigma t)/(1 + (sigma + rate) t))^k`.
pub fn gamma_memory<T: Real>(kt: T, t: T, sigma: T, rate: T) -> T {
    let t = t.max(real(1e-4));
    (-kt * (rate * t / (T::one() + sigma * t)).ln_1p() / t).exp()
}

/// Fits k t and t of [`gamma_transmittance`] through two measured transmittances `r1` at `sigma1` and `r2` at `sigma2`
/// (`sigma1 < sigma2`). Without absorption at all it returns (0, 1).
pub fn gamma_fit(sigma1: f64, r1: f64, sigma2: f64, r2: f64) -> (f64, f64) {
    let (l1, l2) = (-r1.clamp(1e-300, 1.0).ln(), -r2.clamp(1e-300, 1.0).ln());
    if l1 < 1e-9 {
        return (0.0, 1.0);
    }
    let wanted = l2 / l1;
    // The ratio falls from sigma2 / sigma1 to 1 as t grows.
    let (mut low, mut high) = (1e-4_f64.ln(), 1e3_f64.ln());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let t = middle.exp();
        if (sigma2 * t).ln_1p() / (sigma1 * t).ln_1p() > wanted {
            low = middle
        } else {
            high = middle
        }
    }
    let t = (0.5 * (low + high)).exp();
    (l1 * t / (sigma1 * t).ln_1p(), t)
}

/// Material whose white-furnace albedo at theta_o = 0 is `albedo` (linear RGB, clamped to what the fibre can reach: its
/// surface reflection + 0.002 to 0.995).
///
/// Structural fibres: the core takes the color; light beside a small core is absorbed to the same color. Pigment fibres:
/// one absorption for cortex and medulla.
pub fn fibre_color<T: Real>(p: &FibreParameters<T>, albedo: [T; 3]) -> FibreColor<T> {
    let one = T::one();
    let f = p.fresnel;
    let series = p.round_trips;
    let mut color = FibreColor::white();
    for (c, &a) in albedo.iter().enumerate() {
        let y = (clamp(a, p.darkest(), real(0.995)) - f) / (one - f);
        if p.structural {
            color.core[c] = clamp(y / (one - series + series * y), T::zero(), one);
        }
        if p.color_kt > real(1e-6) {
            let exponent = -y.ln() * p.color_t / p.color_kt;
            color.absorption[c] = clamp(
                exponent.min(real(60.0)).exp_m1() / p.color_t,
                T::zero(),
                real(1e4),
            );
        }
    }
    color
}

/// Albedo that one fibre must have for dense plumage to show `albedo`, when scattered light meets another fibre with chance
/// `meeting` (0..1; 0 returns `albedo`; 0.5 is dense). See docs/book/light_between_fibres.md#multiple-scattering.
pub fn single_scattering_albedo<T: Real>(albedo: [T; 3], meeting: T) -> [T; 3] {
    albedo.map(|shown| inner_albedo(shown, meeting))
}

/// [`single_scattering_albedo`] of one channel.
pub fn inner_albedo<T: Real>(albedo: T, meeting: T) -> T {
    let (zero, one) = (T::zero(), T::one());
    let p = clamp(meeting, zero, real(0.99));
    let later = real::<T>(0.5) * p + real(0.25);
    let shown = clamp(albedo, zero, one);
    let b = one - p + shown * later;
    let root = (b * b + shown * (p + p - one)).max(zero).sqrt();
    (shown + shown) / (b + root)
}

/// What dense plumage shows of fibres of `albedo` (0..1): the inverse of [`single_scattering_albedo`].
pub fn shown_albedo<T: Real>(albedo: T, meeting: T) -> T {
    let one = T::one();
    let p = clamp(meeting, T::zero(), real(0.99));
    let later = real::<T>(0.5) * p + real(0.25);
    (one - p) * albedo + p * (one - later) * albedo * albedo / (one - later * albedo)
}

/// Of the meetings with further fibres, the share with fibres parallel to the first, where a fibre mirrors: light that met no others
/// stays on its cone. See docs/book/light_between_fibres.md#multiple-scattering.
pub const PARALLEL_MEETINGS: f64 = 0.25;

/// Light that met further fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultipleScattering<T> {
    /// Energy that has lost its direction, linear RGB: to be multiplied by the mean radiance around the feather.
    pub spread: [T; 3],
    /// Factor on the light that met one fibre, 1 and more: what met parallel fibres alone goes where that goes.
    pub cone: [T; 3],
}

/// Light that met further fibres, for a fibre of albedo `a` of whose light the share `p = meeting` meets another one, and
/// `q = p/2 + 1/4` of what that scatters one more: `spread` and `cone` times the direct light `(1 - p) a` are together
/// `(1 - p) a + p (1 - q) a^2/(1 - q a)`, 1 for a white fibre. `parallel`: [`PARALLEL_MEETINGS`] of fibres that mirror, 0 of others.
/// See docs/book/light_between_fibres.md#multiple-scattering.
pub fn multiple_scattering<T: Real>(
    albedo: [T; 3],
    meeting: [T; 3],
    parallel: T,
) -> MultipleScattering<T> {
    let one = T::one();
    let albedo = albedo.map(|a| clamp(a, T::zero(), one));
    let lost: [T; 3] =
        std::array::from_fn(|c| clamp(meeting[c], T::zero(), real(0.99)) * albedo[c]);
    let cone = lost.map(|lost| one / (one - parallel * lost));
    MultipleScattering {
        spread: std::array::from_fn(|c| {
            let later = real::<T>(0.5) * lost[c] + real::<T>(0.25) * albedo[c];
            lost[c] * (albedo[c] - later) / (one - later) - (albedo[c] - lost[c]) * (cone[c] - one)
        }),
        cone,
    }
}
