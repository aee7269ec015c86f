//! How wrong light is that is found at the vertices of a card and interpolated (docs/book/lod.md#light-at-vertices).

use super::functions::{Real, clamp, real, smooth_step};

/// What the error of [`vertex_light_error`] grows by, share of white per degree, where eye or light pass along a card. `half_turn`: half the
/// angle between the normals of two vertices, radians; `facing`: cosine between its normal and eye or light, 0..1.
///
/// Tenfold along the card, and far more where one face gives way to the other between its vertices.
pub fn grazing_error<T: Real>(half_turn: T, facing: T) -> T {
    let least = clamp(facing - half_turn, T::zero(), T::one());
    let along = T::one() - smooth_step(T::zero(), real(0.5), least);
    let edge = T::one() - smooth_step(T::zero(), real(0.2), least);
    real::<T>(4.5e-4) * along + real::<T>(8.0e-3) * edge
}

/// Typical error of the light, as a share of white, of a card whose normals turn by `turn` degrees between two vertices. `eye` and `lights`:
/// cosines between its normal and them, 0..1; `shares`: of what comes from both, each light's, 0..1; 0: there is none.
///
/// It grows with the turn, and where eye or light pass along the card ([`grazing_error`]): a light by no more than what comes from it.
pub fn vertex_light_error<T: Real>(turn: T, eye: T, lights: [T; 2], shares: [T; 2]) -> T {
    let half_turn = turn * real(0.5 * std::f64::consts::PI / 180.0);
    let lit = shares[0] * grazing_error(half_turn, lights[0])
        + shares[1] * grazing_error(half_turn, lights[1]);
    turn * (real::<T>(5.0e-5) + grazing_error(half_turn, eye).max(lit))
}
