//! Why a mesh got no coat.

use thiserror::Error;

/// Why a mesh got no coat.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UndercoatError {
    /// The mesh cannot carry a coat.
    #[error("skin: {message}")]
    Skin {
        /// What is wrong with it.
        message: String,
    },
}
