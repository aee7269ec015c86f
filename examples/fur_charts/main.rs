//! Charts of precomputed transfer, shells and virtual fragments, an SVG and its numbers as CSV each; and what the dense fur of the
//! precomputed transfer paper takes in memory and keeps in detail.
//!
//! `cargo run --config 'profile.dev.opt-level=3' --example fur_charts [folder]` (default `docs/charts`)

mod fragments;
mod picture;
#[allow(dead_code)]
#[path = "../scattering_charts/plot.rs"]
mod plot;
mod shells;
mod transfer;
#[path = "../../tests/down_common/mod.rs"]
mod volumes;

use std::{env, fs, path::Path};

fn main() -> plot::Result<()> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    transfer::stored(folder)?;
    transfer::rays(folder)?;
    shells::count(folder)?;
    fragments::count(folder)?;
    picture::dense();
    Ok(())
}
