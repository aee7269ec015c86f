//! Invalid input of the maths.

use thiserror::Error;

/// Invalid footprint, error budget or view direction.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum QueryError {
    /// Not a number, or infinite.
    #[error("{field} is {value}; it has to be finite")]
    NotFinite {
        /// The field, e.g. `covariance[0]`.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// Outside the allowed range.
    #[error("{field} is {value}; allowed are {low} to {high}")]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Least allowed value.
        low: f64,
        /// Largest allowed value.
        high: f64,
    },
}
