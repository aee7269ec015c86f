//! What can be wrong with a feather file.

use std::fmt::Display;
use thiserror::Error;

/// Why a feather was refused. Each case names the file, and for a value its field and the range allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FeatherError {
    /// The file could not be read or written.
    #[error("{file}: {message}")]
    Io {
        /// File or feather name.
        file: String,
        /// What the operating system or asset source said.
        message: String,
    },
    /// The file is larger than [`Feather::MAX_BYTES`](super::Feather::MAX_BYTES).
    #[error("{file}: {bytes} bytes, a feather file has at most {limit}")]
    TooLarge {
        /// File or feather name.
        file: String,
        /// Size found.
        bytes: usize,
        /// Size allowed.
        limit: usize,
    },
    /// Not RON, or not the structure of a feather.
    #[error("{file}:{line}:{column}: {message}")]
    Syntax {
        /// File or feather name.
        file: String,
        /// Line, from 1 (0: unknown).
        line: usize,
        /// Column, from 1 (0: unknown).
        column: usize,
        /// What was expected there.
        message: String,
    },
    /// A format version that this crate does not read.
    #[error("{file}: format version {found}, this crate reads {supported} ({hint})")]
    Version {
        /// File or feather name.
        file: String,
        /// Version of the file.
        found: u32,
        /// Version of the crate.
        supported: u32,
        /// What to do about it.
        hint: &'static str,
    },
    /// A value outside its range.
    #[error("{file}: `{field}` is {value}, allowed is {allowed}")]
    Range {
        /// File or feather name.
        file: String,
        /// Path of the field, e.g. `left.barbules.angle`.
        field: String,
        /// The value found.
        value: String,
        /// The range allowed.
        allowed: String,
    },
}

impl FeatherError {
    /// The same error about another file (validation of a feather in memory knows only its name).
    pub fn in_file(mut self, path: &str) -> Self {
        let (Self::Io { file, .. }
        | Self::TooLarge { file, .. }
        | Self::Syntax { file, .. }
        | Self::Version { file, .. }
        | Self::Range { file, .. }) = &mut self;
        *file = path.to_owned();
        self
    }

    pub(super) fn range(field: impl Display, value: impl Display, allowed: impl Display) -> Self {
        Self::Range {
            file: String::new(),
            field: field.to_string(),
            value: value.to_string(),
            allowed: allowed.to_string(),
        }
    }
}
