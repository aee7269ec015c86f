//! What can be wrong with a groom, its file or the skin it is put on.

use thiserror::Error;

/// A groom that cannot be used, and where it is wrong.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GroomError {
    /// The file could not be read.
    #[error("{file}: cannot be read: {message}")]
    Read {
        /// Asset path.
        file: String,
        /// What the reader said.
        message: String,
    },
    /// The file is not a groom in RON.
    #[error("{file}:{line}:{column}: {message}")]
    Parse {
        /// Asset path.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser said.
        message: String,
    },
    /// A field holds what it must not.
    #[error("{file}: {field} is {value}, allowed is {range}")]
    Value {
        /// Asset path.
        file: String,
        /// The field, as a path into the asset (`regions[3].width.0`).
        field: String,
        /// The value found.
        value: String,
        /// What is allowed.
        range: String,
    },
    /// The groom cannot be written as text.
    #[error("{file}: cannot be written: {message}")]
    Write {
        /// Asset path.
        file: String,
        /// What the writer said.
        message: String,
    },
    /// The mesh cannot carry feathers.
    #[error("skin {mesh}: {message}")]
    Skin {
        /// Number of the mesh among those given.
        mesh: usize,
        /// What is wrong with it.
        message: String,
    },
}
