//! Down and fur: the undercoat below contour feathers, and stand-alone fur on any skinned mesh.
//!
//! Two systems share one periodic [`Tile`] of fibres: a prismatic shell over the skin whose volume is marched (Andersen et al.,
//! *Hybrid fur rendering*), and shells lit by precomputed radiance transfer. Everything here is pure maths; each function that
//! the GPU needs has a WGSL twin of the same name in `shaders/down_*.wgsl`.

pub mod coverage;
pub mod fragments;
pub mod harmonics;
pub mod slabs;
pub mod strands;
pub mod texture;
pub mod tile;
pub mod transfer;

pub use tile::Tile;
