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
    /// A number of the mesh is beyond what can be groomed.
    #[error("skin {mesh}: `{field}` is {value}, allowed is {range}")]
    Value {
        /// Number of the mesh among those given.
        mesh: usize,
        /// What is counted or measured.
        field: &'static str,
        /// The value found.
        value: String,
        /// What is allowed.
        range: String,
    },
}

/// What is wrong with a mesh without being fatal, and what is done about it.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("skin {mesh}: `{field}` is {value}, allowed is {range}: {mended}")]
#[non_exhaustive]
pub struct SkinFlaw {
    /// Number of the mesh among those given.
    pub mesh: usize,
    /// Vertex attribute.
    pub field: String,
    /// The value found, the first of several.
    pub value: String,
    /// What is allowed.
    pub range: String,
    /// What is done about it.
    pub mended: &'static str,
}

impl SkinFlaw {
    /// An attribute with another number of values than the mesh has vertices.
    pub(super) fn count(mesh: usize, field: &str, found: usize, wanted: usize) -> Self {
        Self {
            mesh,
            field: field.into(),
            value: format!("{found} values long"),
            range: format!("{wanted}, the number of vertices"),
            mended: "left out",
        }
    }
}
