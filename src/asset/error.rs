//! What can be wrong with an asset file.

use std::fmt::Display;
use thiserror::Error;

/// Why an asset file was not read or written. Each case names the file, and for a value its field and what is allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AssetError {
    /// The file could not be read.
    #[error("{file}: cannot be read: {message}")]
    Read {
        /// File name or asset path.
        file: String,
        /// What the operating system or asset source said.
        message: String,
    },
    /// The file could not be written.
    #[error("{file}: cannot be written: {message}")]
    Write {
        /// File name or asset path.
        file: String,
        /// What the operating system, asset source or text format said.
        message: String,
    },
    /// The file is larger than [`RonAsset::MAX_BYTES`](super::RonAsset::MAX_BYTES).
    #[error("{file}: {bytes} bytes, a file of this kind has at most {limit}")]
    TooLarge {
        /// File name or asset path.
        file: String,
        /// Size found.
        bytes: usize,
        /// Size allowed.
        limit: usize,
    },
    /// Not RON, or not the structure of this asset.
    #[error("{file}:{line}:{column}: {message}")]
    Syntax {
        /// File name or asset path.
        file: String,
        /// Line, from 1 (0: unknown).
        line: usize,
        /// Column, from 1 (0: unknown).
        column: usize,
        /// What was expected there.
        message: String,
    },
    /// A format version that this crate does not read.
    #[error("{file}: format version {found}, this crate reads {oldest} to {newest} ({hint})")]
    Version {
        /// File name or asset path.
        file: String,
        /// Version of the file.
        found: u32,
        /// Oldest version that is read.
        oldest: u32,
        /// Version that is written.
        newest: u32,
        /// What to do about it.
        hint: &'static str,
    },
    /// A value that is not allowed.
    #[error("{file}: `{field}` is {value}, allowed is {range}")]
    Value {
        /// File name or asset path.
        file: String,
        /// Path of the field, e.g. `regions[3].width.0`.
        field: String,
        /// The value found.
        value: String,
        /// What is allowed.
        range: String,
    },
}

impl AssetError {
    /// A value that is not allowed, in a file yet to be named ([`AssetError::in_file`]).
    pub fn value(field: impl Display, value: impl Display, range: impl Display) -> Self {
        Self::Value {
            file: String::new(),
            field: field.to_string(),
            value: value.to_string(),
            range: range.to_string(),
        }
    }

    /// The same error about this file.
    pub fn in_file(mut self, name: &str) -> Self {
        let (Self::Read { file, .. }
        | Self::Write { file, .. }
        | Self::TooLarge { file, .. }
        | Self::Syntax { file, .. }
        | Self::Version { file, .. }
        | Self::Value { file, .. }) = &mut self;
        name.clone_into(file);
        self
    }
}
