//! Procedural, multiscale, real-time feathers for Bevy.
//!
//! See the README for pictures and the two commands that show them.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod anatomy;
pub mod groom;
pub mod query;
pub mod scattering;
