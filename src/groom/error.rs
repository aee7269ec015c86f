//! Why a bird was not groomed.

use crate::asset::AssetError;
use thiserror::Error;

/// Why a bird was not groomed: the groom is wrong, or the skin that it is put on.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GroomError {
    /// The groom holds what it must not.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// The mesh cannot carry feathers.
    #[error("skin {mesh}: {message}")]
    Skin {
        /// Number of the mesh among those given.
        mesh: usize,
        /// What is wrong with it.
        message: String,
    },
}
