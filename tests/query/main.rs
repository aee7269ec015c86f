//! Coverage of rachis, barbs and barbules under a footprint: the closed forms against float64 references that share no code with
//! them, their bounds and limits, masking and shadow, stability in motion, and the shader against its twin on the processor.
//! Figures of the README: `cargo test -p plumage_tests --test query -- --nocapture`.

mod accuracy;
mod bounds;
mod edges;
mod gpu;
mod limits;
mod map;
mod masking;
mod point;
mod published;
mod shadow;
mod stability_dolly;
mod stability_moving;
mod stability_pan;
mod stability_sweeps;
