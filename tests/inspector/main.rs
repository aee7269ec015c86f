//! The editor's panels without a window: every field has its slider, with the range that validation has.
//! Edits are told, undone and written.
//! Strokes are mirrored.

mod fields;
mod mirror;
mod panels;
