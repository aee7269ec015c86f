//! What can be wrong with a down file or with the mesh that it is put on.

use std::fmt::Display;
use thiserror::Error;

/// Why a down was refused. Each case names the file, and for a value its field and the range allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DownError {
    /// The file could not be read.
    #[error("{file}: {message}")]
    Io {
        /// File name.
        file: String,
        /// What the operating system or asset source said.
        message: String,
    },
    /// Not RON, or not the structure of a down.
    #[error("{file}:{line}:{column}: {message}")]
    Syntax {
        /// File name.
        file: String,
        /// Line, from 1 (0: unknown).
        line: usize,
        /// Column, from 1 (0: unknown).
        column: usize,
        /// What was expected there.
        message: String,
    },
    /// A format version that this crate does not read.
    #[error("{file}: format version {found}, this crate reads {supported}")]
    Version {
        /// File name.
        file: String,
        /// Version of the file.
        found: u32,
        /// Version of the crate.
        supported: u32,
    },
    /// A value outside its range.
    #[error("{file}: `{field}` is {value}, allowed is {allowed}")]
    Range {
        /// File name.
        file: String,
        /// Path of the field, e.g. `coats[1].length`.
        field: String,
        /// The value found.
        value: String,
        /// The range allowed.
        allowed: String,
    },
    /// The mesh cannot carry a coat.
    #[error("skin: {message}")]
    Skin {
        /// What is wrong with it.
        message: String,
    },
}

impl DownError {
    /// The same error about another file (validation of a down in memory knows only its name).
    pub fn in_file(mut self, path: &str) -> Self {
        if let Self::Io { file, .. }
        | Self::Syntax { file, .. }
        | Self::Version { file, .. }
        | Self::Range { file, .. } = &mut self
        {
            *file = path.to_owned();
        }
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
