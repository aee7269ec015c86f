//! Fibre scattering: lobes, far-field series, medulla, sheen, colour inversion. Pure maths.
//!
//! The quantity that everything here returns is **K = S cos(theta_i)**: a density in the direction of the light whose
//! integral over the sphere is the albedo (at most 1). The product of the feather's BSDF and the cosine of the
//! rendering equation is a plain sum of K over the visible fibres ([`feather_bsdf`]), so nothing is ever divided by a
//! cosine. Lengths are in units of the fibre's radius.
//!
//! One fibre goes through three steps: [`FibreTable::build`] once per material, [`fibre_shading`] once per pixel,
//! [`fibre_evaluate`] once per light. The shader modules `scattering.wgsl` and `sheen.wgsl` hold the same functions under
//! the same names.

mod colour;
mod evaluate;
mod feather;
mod fibre;
mod lobes;
mod longitudinal;
mod medulla;
mod near;
mod parameters;
pub mod published;
mod quadrature;
pub mod reference;
mod sample;
mod sheen;
mod table;
mod tier;

pub use colour::{
    FibreColour, fibre_colour, gamma_fit, gamma_transmittance, multiple_scattering,
    single_scattering_albedo,
};
pub use evaluate::{
    FIBRE_SERIES, FibreEnergy, FibreShading, azimuthal, fibre_albedo, fibre_energy_split,
    fibre_evaluate, fibre_local, fibre_shading, light_visibility, mean_visibility,
};
pub use feather::{FeatherPart, feather_bsdf};
pub use fibre::{Fibre, FibreKind, Optics, Sheen};
pub use lobes::{Crossing, Lobe, attenuation, crossing, exit_angle, fresnel};
pub use longitudinal::{fold, i0e, lobe_shift, lobe_width, longitudinal};
pub use medulla::{MEDULLA_AXES, MEDULLA_TABLE_LENGTH, MedullaShape, medulla_shape};
pub use near::{
    FibreNear, FibreWindow, NEAR_SEGMENTS, fibre_near, fibre_near_evaluate, fibre_window,
};
pub use parameters::{FibreParameters, fibre_parameters};
pub use quadrature::gauss_legendre;
pub use sample::{FibreSample, fibre_invert_series, fibre_lobe_chances, fibre_pdf, fibre_sample};
pub use sheen::{
    SHEEN_TABLE_SIZE, sheen_albedo, sheen_evaluate, sheen_lookup, sheen_row, sheen_table,
    sheen_tint,
};
pub use table::{
    FIBRE_HARMONICS, FIBRE_ROW_VEC4S, FIBRE_ROWS, FibreRow, FibreTable, fibre_row_at, fibre_row_mix,
};
pub use tier::{MEAN_TERMS, fibre_terms, near_deviation, near_limit};

use num_traits::Float;

/// A constant in the working precision.
#[inline]
pub(crate) fn real<T: Float>(value: f64) -> T {
    T::from(value).unwrap_or_else(T::zero)
}

/// `value` within `low..=high`; NaN becomes `low`.
#[inline]
pub(crate) fn clamp<T: Float>(value: T, low: T, high: T) -> T {
    value.max(low).min(high)
}

/// Scalar product of two directions.
#[inline]
pub(crate) fn dot<T: Float>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
