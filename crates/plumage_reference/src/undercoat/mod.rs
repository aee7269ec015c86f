//! References for down and fur, and the published forms of their methods.

pub mod coverage_published;
pub mod fragments;
pub mod prism;
pub mod published;
pub mod reference;
pub mod slabs;
pub mod transfer_published;
