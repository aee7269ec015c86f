//! Down and fur: the undercoat below contour feathers, and stand-alone fur on any skinned mesh.
//!
//! Two systems share one periodic [`Tile`] of fibres: a prismatic shell over the skin whose volume is marched (Andersen et al.,
//! *Hybrid fur rendering*), and shells lit by precomputed radiance transfer. Everything here is pure maths; each function that
//! the GPU needs has a WGSL twin of the same name in `shaders/down_*.wgsl`.

pub mod light;
pub mod march;
pub mod prism;
pub mod shell;
pub mod tile;
mod vector;
pub mod walk;

pub use tile::Tile;
