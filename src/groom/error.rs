//! Why a bird was not groomed.

use super::Channel;
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

/// What is wrong with a mask in a texture. Where it cannot be read it counts as no say.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaskFlaw {
    /// The texture is not there.
    #[error("mask {file}: the texture did not load, feathers grow without it: {cause}")]
    NotLoaded {
        /// The texture.
        file: String,
        /// What the asset server said.
        cause: String,
    },
    /// Its format cannot be read on the processor.
    #[error(
        "mask {file}: the format {format} cannot be read, feathers grow without it (a PNG serves)"
    )]
    Unreadable {
        /// The texture.
        file: String,
        /// Format found.
        format: String,
    },
    /// It has no such channel.
    #[error(
        "mask {file}: `channel` is {channel:?}, the texture has only the first {channels}; feathers grow without it"
    )]
    NoChannel {
        /// The texture.
        file: String,
        /// Channel asked for.
        channel: Channel,
        /// How many it has.
        channels: u8,
    },
    /// The channel has one value everywhere.
    #[error("mask {file}: channel {channel:?} is {value} everywhere")]
    Flat {
        /// The texture.
        file: String,
        /// Channel asked for.
        channel: Channel,
        /// Its value, 0..1.
        value: f32,
    },
    /// A mesh of the skin says not where the texture lies on it.
    #[error(
        "mask {file}: skin {mesh} has no texture coordinates (TEXCOORD_0), feathers grow there without it"
    )]
    NoCoordinates {
        /// The texture.
        file: String,
        /// Number of the mesh among those given.
        mesh: usize,
    },
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
