//! Down and fur: density, march, transfer, walk through the shell and strands against brute force in float64, the shaders against
//! their twins; and pictures of coats that grow, bend, move and change.
//! Whole motions, minutes long: `cargo test -p plumage_tests --test undercoat -- --ignored --nocapture`.

mod birds;
mod coverage;
mod fragments;
mod gpu;
mod light;
mod march;
mod motion;
mod prism;
mod render;
mod settings;
mod strands;
mod tier;
mod transfer;
mod walk;
