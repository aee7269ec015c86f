//! One photograph becomes a feather.
pub mod photograph;
