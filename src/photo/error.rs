//! Why no feather came out of a photograph.

use crate::asset::AssetError;
use thiserror::Error;

/// Why a photograph was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtractError {
    /// The file could not be read or written.
    #[error("{file}: {message}")]
    Io {
        /// File name.
        file: String,
        /// What the operating system said.
        message: String,
    },
    /// Not a picture in a known format (PNG, JPEG, WebP), or a damaged one. The content counts, not the extension.
    #[error("{file}: not a readable PNG, JPEG or WebP: {message}")]
    Decode {
        /// File name.
        file: String,
        /// What the decoder said.
        message: String,
    },
    /// More bytes than a photograph may have.
    #[error("{file}: {bytes} bytes, a photograph has at most {limit}")]
    TooManyBytes {
        /// File name.
        file: String,
        /// Size found.
        bytes: u64,
        /// Size allowed.
        limit: u64,
    },
    /// Too small to see a feather in, or too large to hold.
    #[error(
        "the photograph has {width} x {height} pixels, allowed are {low} to {high} a side and {pixels} in all"
    )]
    Size {
        /// Width found.
        width: u32,
        /// Height found.
        height: u32,
        /// Least side.
        low: u32,
        /// Largest side.
        high: u32,
        /// Most pixels.
        pixels: u64,
    },
    /// A setting outside its range.
    #[error("setting `{field}` is {value}, allowed is {low} to {high}")]
    Setting {
        /// Name of the setting.
        field: &'static str,
        /// Value found.
        value: f64,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// A name that is no file name.
    #[error("the name {name:?} has a path separator or starts with a dot")]
    Name {
        /// Name found.
        name: String,
    },
    /// Nothing stands out from the background, or nothing that could be a feather.
    #[error("no feather found: {reason}")]
    NoFeather {
        /// What was seen instead.
        reason: String,
    },
    /// More than one object of comparable size.
    #[error("{count} objects of comparable size, a photograph must show one feather")]
    SeveralObjects {
        /// How many.
        count: usize,
    },
    /// The asset that came out is not valid.
    #[error(transparent)]
    Feather(#[from] AssetError),
}
