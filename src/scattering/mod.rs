//! Fibre scattering: lobes, far-field series, medulla, sheen, colour inversion. Pure maths.

mod fibre;
pub use fibre::{Fibre, FibreKind, Optics, Sheen};
