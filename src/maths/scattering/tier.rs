//! Which evaluator of a fibre is good enough. One number decides, the chooser's threshold that the error budget comes to
//! ([`crate::maths::query::ErrorBudget::threshold`]): the variance, in squares of a pattern's period, from which its mean serves.

use super::FIBRE_HARMONICS;
use crate::maths::functions::{Real, clamp, real};

/// Terms of the series of cards of the mean level of detail.
pub const MEAN_TERMS: u32 = 3;

/// Largest standard deviation of a footprint across a fibre, in half widths of it, for which the near field shows. Brightness
/// over the width repeats once in two half widths; light that comes through shows in one of them.
pub fn near_limit<T: Real>(threshold: T) -> T {
    real::<T>(4.0) * clamp(threshold, real(0.01), real(1.0)).sqrt()
}

/// Footprint for [`super::fibre_window`]: the deviation grows without bound towards [`near_limit`], so that the near field
/// passes into the far field without a step. None beyond it.
pub fn near_deviation<T: Real>(deviation: T, threshold: T) -> Option<T> {
    let limit = near_limit(threshold);
    if deviation.is_nan() || deviation >= limit {
        return None;
    }
    let x = clamp(
        (deviation / limit - real(0.6)) / real(0.4),
        T::zero(),
        T::one(),
    );
    let fade = x * x * (real::<T>(3.0) - x - x);
    Some(deviation / (T::one() - fade).max(real(1e-2)))
}

/// Terms of the series for an azimuthal roughness in radians, 3..=8: 1.6/roughness for 1 %, 2.4/roughness for 0.1 %
/// (docs/book/scattering.md#around-the-fibre-the-far-field-as-a-cosine-series).
pub fn fibre_terms<T: Real>(threshold: T, azimuthal_roughness: T) -> u32 {
    let wanted = clamp(
        real::<T>(6.858) * threshold - real(0.282),
        T::one(),
        real(3.0),
    );
    let terms = (wanted / azimuthal_roughness.max(real(0.05))).ceil();
    let terms = clamp(
        terms,
        real(f64::from(MEAN_TERMS)),
        real(FIBRE_HARMONICS as f64),
    );
    terms.to_u32().unwrap_or(MEAN_TERMS)
}
