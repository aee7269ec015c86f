//! Pure maths: coverage queries, fibre scattering, the undercoat's volume and strands.
//!
//! What lives here is generic over `f32` and `f64` and has a WGSL twin in `shaders/maths`.
//! It may not know an app, an asset or the GPU.

pub mod card;
mod error;
pub(crate) mod footprint;
pub mod functions;
pub mod order;
mod quadrature;
pub mod query;
pub mod scattering;
pub mod seed;
pub mod undercoat;
pub mod vector;
pub mod vertex_light;
pub mod wind;

pub use error::QueryError;
pub use footprint::Footprint;
pub use functions::{Real, clamp, real};
pub use quadrature::gauss_legendre;
