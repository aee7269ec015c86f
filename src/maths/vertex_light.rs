//! How wrong light is that is found at the vertices of a card and interpolated (docs/book/lod.md#light-at-vertices).

use super::functions::{Real, clamp, real, smooth_step};

/// Typical error of the light, as a share of white, of a card whose normals turn by `turn` degrees between two vertices. `facing`: the least
/// of the cosines between its normal and eye and lights, 0..1.
///
/// It grows with the turn, tenfold where eye or light pass along the card, and far more where one face gives way to the other between its
/// vertices.
pub fn vertex_light_error<T: Real>(turn: T, facing: T) -> T {
    let half = turn * real(0.5 * std::f64::consts::PI / 180.0);
    let least = clamp(facing - half, T::zero(), T::one());
    let along = T::one() - smooth_step(T::zero(), real(0.5), least);
    let edge = T::one() - smooth_step(T::zero(), real(0.2), least);
    turn * (real::<T>(5.0e-5) + real::<T>(4.5e-4) * along + real::<T>(8.0e-3) * edge)
}
