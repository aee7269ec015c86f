//! The editor's panels without a window: every field has its slider, with the range that validation has.
//! Edits are told, undone and written.
//! Strokes are mirrored. Of a photograph with several objects one is clicked.

mod fields;
mod mirror;
mod panels;
mod photos;
