//! Which feather lies over which, and the settling of those that cross.

use super::leaf::Leaf;

/// Pairs of neighbouring feathers that were compared, and those that still cross.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of feathers of which one covers a part of the other.
    pub pairs: usize,
    /// Pairs in which the lower still pokes through the upper.
    pub left: usize,
}

/// Settles the feathers.
pub fn settle(_leaves: &mut [Leaf]) -> Crossings {
    Crossings::default()
}
