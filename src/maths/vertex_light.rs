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

/// By about so much what a vane shows of its paint fades where a light passes along it: what is left changes evenly from vertex to vertex, so
/// that the light of paint is interpolated over this. `facing`: cosine between light and normal, -1..1, above 0 where the light comes from the
/// eye's side; from the other side less of it comes through.
///
/// The numbers are a fit to three contour feathers turned under a light; `cargo test -p plumage_tests --test scattering -- interpolated` says
/// what it is good for.
pub fn grazing_light<T: Real>(facing: T) -> T {
    (facing.max(-facing * real(0.4)) + real(0.01)) / (facing.abs() + real(0.3))
}

/// Share that the cores of structural fibres show of a light that passes along their card, where the eye does not; chosen, held by
/// `cargo test -p plumage_tests --test view -- far`.
const MIRRORED: f64 = 0.3;

/// Share that shows, 0..1, of what a light does that passes along a card: all where the eye passes along it, too, or looks against the light,
/// because surfaces mirror there, and three tenths of it of structural fibres (`mirrors` 1, of others 0), whose cores do; little else than paint
/// answers on other sides, and that [`grazing_light`] follows. `eye`: cosine to the card's normal, 0..1; `against`: cosine between the way to the eye and the
/// way that the light goes, -1..1.
pub fn glint_share<T: Real>(half_turn: T, eye: T, against: T, mirrors: T) -> T {
    let along = T::one() - smooth_step(T::zero(), real(0.4), eye - half_turn);
    along
        .max(smooth_step(real(0.2), real(0.7), against))
        .max(real::<T>(MIRRORED) * mirrors)
}

/// Typical error of the light, as a share of white, of a card whose normals turn by `turn` degrees between two vertices. `eye` and `lights`:
/// cosines between its normal and them, 0..1; `against`: cosines between the way to the eye and the ways that the lights go; `shares`: of what
/// comes from both, each light's, 0..1; 0: there is none; `mirrors`: of [`glint_share`].
///
/// It grows with the turn, and where eye or light pass along the card ([`grazing_error`]): a light by no more than what comes from it and what
/// of it shows ([`glint_share`]).
pub fn vertex_light_error<T: Real>(
    turn: T,
    eye: T,
    lights: [T; 2],
    against: [T; 2],
    shares: [T; 2],
    mirrors: T,
) -> T {
    let half_turn = turn * real(0.5 * std::f64::consts::PI / 180.0);
    let of = |i: usize| {
        shares[i]
            * glint_share(half_turn, eye, against[i], mirrors)
            * grazing_error(half_turn, lights[i])
    };
    turn * (real::<T>(5.0e-5) + grazing_error(half_turn, eye).max(of(0) + of(1)))
}
