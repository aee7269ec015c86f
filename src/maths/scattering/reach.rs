//! One fibre among others: what of a light reaches it, and where on it.

use super::{FibreLobes, FibreParameters, FibreRow, FibreShading, gamma_memory};
use crate::maths::functions::{Real, real};

/// What of a light reaches one fibre among others (see [`VaneLight`](crate::maths::query::VaneLight)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreReach<T> {
    /// Factor on the mirror lobes.
    pub mirror: T,
    /// Share for the others, where light forgets its place.
    pub even: T,
    /// What this gains for light that remembers its place along the fibre.
    pub along: T,
    /// Cosine between the middles of what is seen and of what is lit.
    pub place: T,
}

impl<T: Real> FibreReach<T> {
    /// All of it.
    pub fn whole(turn: T) -> Self {
        Self {
            mirror: T::one(),
            even: T::one(),
            along: T::zero(),
            place: turn,
        }
    }
}

/// K of a fibre among others: `reach` of the light reaches it.
pub fn fibre_lit<T: Real>(
    s: &FibreShading<T>,
    lobes: &FibreLobes<T>,
    reach: &FibreReach<T>,
) -> [T; 3] {
    let (zero, one) = (T::zero(), T::one());
    std::array::from_fn(|c| {
        let share = (reach.even + reach.along * s.along[c]).max(zero);
        let around = (one + s.around[c] * reach.place).max(zero)
            / (one + s.around[c] * lobes.turn).max(real(0.1));
        // Where all that is seen is lit, at most about twice the mean comes back.
        reach.mirror * lobes.mirror[c] + (share * around).min(one + one) * lobes.even[c]
    })
}

/// How much of the medulla's light remembers where along the fibre it entered, per color channel, 0..1: `absorption` of
/// [`FibreShading`], for a shadow of which the square of the frequency is `frequency` times that of the table
/// ([`MEDULLA_PLACE`](super::MEDULLA_PLACE)).
pub fn fibre_along<T: Real>(
    p: &FibreParameters<T>,
    row: &FibreRow<T>,
    absorption: [T; 3],
    frequency: T,
) -> [T; 3] {
    if p.structural {
        return [T::zero(); 3];
    }
    absorption.map(|sigma| {
        let a = gamma_memory(row[2][0], row[2][1], sigma, row[3][2]);
        a / (a + frequency * (T::one() - a)).max(real(1e-6))
    })
}
