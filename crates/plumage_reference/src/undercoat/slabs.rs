//! Opacity of the shells that draw a tile layer by layer (docs/book/undercoat.md#shells).
//!
//! A shell stands for the slab between it and the next one. Its opacity comes from the integral of the extinction over the slab
//! and from the length of the eye's path through it, so that neither the number of shells nor the angle changes the mean.
//! Twin of `down_slabs.wgsl`.

use bevy_plumage::maths::functions::{Real, clamp, real};
use bevy_plumage::maths::undercoat::Tile;
use bevy_plumage::maths::undercoat::strands::LEAST_COSINE;

/// Least and most shells of a coat.
pub const SHELL_COUNTS: [u32; 2] = [4, 32];

/// Optical depth of the columns above each boundary between layers: `size.z + 1` boundaries from the skin (the whole column) to
/// the top (0), x fastest, then y, then z. A texture of these, filtered, gives every slab's integral as a difference.
pub fn columns(tile: &Tile) -> Vec<f32> {
    let size = tile.size().as_usizevec3();
    let layer = size.x * size.y;
    let mut out = vec![0.0; layer * (size.z + 1)];
    for z in (0..size.z).rev() {
        for i in 0..layer {
            out[z * layer + i] =
                out[(z + 1) * layer + i] + tile.extinction()[z * layer + i] / size.z as f32;
        }
    }
    out
}

/// Opacity of a slab: `low` and `high` are the optical depths of the column above its lower and upper face, `cos` the cosine
/// between the eye and the normal of the skin.
pub fn slab_alpha<T: Real>(low: T, high: T, cos: T) -> T {
    let path = T::one() / clamp(cos.abs(), real(LEAST_COSINE), T::one());
    T::one() - (-((low - high).max(T::zero()) * path)).exp()
}

/// Number of shells for a coat that is `thickness` pixels high where seen from the side, `sine` between the eye and the normal
/// and `layers` cells in the tile: gaps of 1.5 pixels, 4 to 32, never more than layers.
pub fn shell_count<T: Real>(thickness: T, sine: T, layers: u32) -> T {
    let [least, most] = SHELL_COUNTS.map(|n| n.min(layers.max(1)));
    let wanted = (thickness * clamp(sine, real(0.35), T::one()) / real(1.5)).ceil();
    clamp(wanted, real(f64::from(least)), real(f64::from(most)))
}

/// The paper's shell opacity: the extinction at the shell itself, `1 / shells` thick whatever the angle.
pub fn published_alpha<T: Real>(extinction: T, shells: T) -> T {
    T::one() - (-(extinction.max(T::zero()) / shells.max(T::one()))).exp()
}
