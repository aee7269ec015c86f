//! Where the light of a fibre goes, for light that has no single direction.

use super::{FIBRE_HARMONICS, FibreShading};
use crate::maths::functions::{Real, clamp, real};

/// Energy by where it goes, for light that has no single direction (environment maps).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreEnergy<T> {
    /// Surface reflection R, colorless.
    pub specular: T,
    /// All other light that returns to the side of the eye.
    pub front: [T; 3],
    /// Light that passes to the other side.
    pub back: [T; 3],
}

/// Share of a lobe that stays on the side of the eye (|phi| below 90 degrees), 0..1.
fn share_front<T: Real>(s: &[T; FIBRE_HARMONICS]) -> T {
    let odd = s[0] - s[2] / real(3.0) + s[4] / real(5.0) - s[6] / real(7.0);
    clamp(
        real::<T>(0.5) + odd * real(std::f64::consts::FRAC_1_PI),
        T::zero(),
        T::one(),
    )
}

/// Share of light that the fibre scatters into all directions, linear RGB, 0..1.
pub fn fibre_albedo<T: Real>(s: &FibreShading<T>) -> [T; 3] {
    std::array::from_fn(|c| s.energy[0][c] + s.energy[1][c] + s.energy[2][c] + s.energy[3][c])
}

/// Splits the fibre's energy for light without a direction. `specular + front + back` is the albedo, less what a dark back
/// swallows.
pub fn fibre_energy_split<T: Real>(s: &FibreShading<T>) -> FibreEnergy<T> {
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
