//! What a groom needs to know of a bird.

use super::skin::SkinMesh;
use bevy::math::Vec3;

/// A bird to be feathered.
#[derive(Clone, Debug, Default)]
pub struct Bird {
    /// Its skin in bind pose.
    pub skin: SkinMesh,
    /// Names of the joints of its skin, in their order; empty if it is not skinned.
    pub joints: Vec<String>,
    /// Where each of them is in bind pose, model space, metres; empty if that is not known. Used by [`Groom::bend`](super::Groom::bend).
    pub pivots: Vec<Vec3>,
}
