//! Fibre scattering: lobes, far-field series, medulla, sheen, color inversion. Pure maths: no app, no GPU, and nothing of `query`
//! or `undercoat`.
//!
//! The quantity that everything here returns is **K = S cos(theta_i)**: a density in the direction of the light whose
//! integral over the sphere is the albedo (at most 1). The product of the feather's BSDF and the cosine of the
//! rendering equation is a plain sum of K over the visible fibres ([`feather_bsdf`]), so nothing is ever divided by a
//! cosine. Lengths are in units of the fibre's radius.
//!
//! One fibre goes through three steps: [`FibreTable::build`] once per material, [`fibre_shading`] once per pixel,
//! [`fibre_evaluate`] once per light. The shader modules `scattering.wgsl` and `sheen.wgsl` hold the same functions under
//! the same names.

mod color;
mod energy;
mod evaluate;
mod feather;
mod fibre;
mod flat;
mod frame;
pub mod interference;
mod kept;
mod lobes;
mod longitudinal;
mod medulla;
mod near;
mod parameters;
mod reach;
mod sample;
mod shading;
mod sheen;
mod short;
mod table;
mod tier;

pub use color::{
    FibreColor, MultipleScattering, PARALLEL_MEETINGS, fibre_color, gamma_fit, gamma_memory,
    gamma_transmittance, inner_albedo, multiple_scattering, shown_albedo, single_scattering_albedo,
};
pub use energy::{FibreEnergy, fibre_albedo, fibre_energy_split};
pub use evaluate::{FibreLobes, azimuthal, fibre_evaluate, fibre_lobes};
pub use feather::{FeatherPart, feather_bsdf};
pub use fibre::{Fibre, FibreKind, Optics, Sheen};
pub use frame::fibre_local;
pub use kept::{
    KEPT_AZIMUTHS, KEPT_LEVELS, KeptLight, KeptPart, kept_at, kept_light, mean_caught,
    mirror_place, part_tangent,
};
pub use lobes::{Crossing, Lobe, attenuation, crossing, exit_angle, fresnel};
pub use longitudinal::{
    LongitudinalSpread, fold, i0e, lobe_shift, lobe_width, longitudinal, longitudinal_spread,
    longitudinal_with,
};
pub use medulla::{MEDULLA_AXES, MEDULLA_PLACE, MEDULLA_TABLE_LENGTH, MedullaShape, medulla_shape};
pub use near::{
    FibreNear, FibreWindow, NEAR_SEGMENTS, fibre_near, fibre_near_evaluate, fibre_near_lobes,
    fibre_window,
};
pub use parameters::{FibreParameters, fibre_parameters};
pub use reach::{FibreReach, fibre_along, fibre_lit};
pub use sample::{FibreSample, fibre_invert_series, fibre_lobe_chances, fibre_pdf, fibre_sample};
pub use shading::{FIBRE_SERIES, FibreShading, fibre_shading};
pub use sheen::{
    SHEEN_TABLE_SIZE, sheen_albedo, sheen_evaluate, sheen_lookup, sheen_row, sheen_table,
    sheen_tint,
};
pub use short::{
    MEAN_COSINES, SHORT_HEAD_VEC4S, SHORT_ROW_VEC4S, SHORT_STEP_VEC4S, SHORT_TABLE_VEC4S,
    ShortColor, ShortLobes, ShortRow, ShortShading, ShortTerms, short_again, short_color,
    short_lit, short_lobes, short_row_step, short_shading,
};
pub use table::{
    FIBRE_HARMONICS, FIBRE_PARAMETER_VEC4S, FIBRE_ROW_VEC4S, FIBRE_ROWS, FibreRow, FibreTable,
    fibre_row_at, fibre_row_mix,
};
pub use tier::{MEAN_TERMS, fibre_terms, near_deviation, near_limit};
