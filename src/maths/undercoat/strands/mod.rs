//! Explicit strands: guard hairs, filoplumes, bristles (docs/book/undercoat.md#strands).
//!
//! Roots after Van Gelder and Wilhelms (1997): so many a triangle, thinned by a density map, in shuffled order. A strand is a
//! cubic Bezier curve drawn as a ribbon that faces the camera. Twin of `down_strands.wgsl` from [`strand_curve`] on.

mod curve;
mod roots;

pub use curve::{
    LEAST_COSINE, LEAST_SEGMENTS, MOST_SEGMENTS, Ribbon, StrandShape, strand_alpha, strand_curve,
    strand_point, strand_radius, strand_ribbon, strand_segments, strand_shadow, strand_side,
    strand_tangent,
};
pub use roots::{MOST_STRANDS, StrandRoot, strand_roots};
