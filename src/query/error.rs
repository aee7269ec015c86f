//! What the query refuses.

use thiserror::Error;

/// A number that is no footprint, budget or view.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum QueryError {
    /// Not a number, or infinite.
    #[error("{field} is {value}; it has to be finite")]
    NotFinite {
        /// What it is, e.g. `covariance[0]`.
        field: &'static str,
        /// What was given.
        value: f64,
    },
    /// Outside the allowed range.
    #[error("{field} is {value}; allowed are {low} to {high}")]
    OutOfRange {
        /// What it is.
        field: &'static str,
        /// What was given.
        value: f64,
        /// Least allowed value.
        low: f64,
        /// Largest allowed value.
        high: f64,
    },
}
