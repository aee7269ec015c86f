//! A photograph becomes a feather: synthetic photographs, whose feather is known, and what is measured in them.
//! Damaged, strange and random pictures are errors or doubts, never a panic.
//! No renderer is needed.

mod held;
mod loader;
mod objects;
mod robust;
mod truth;
