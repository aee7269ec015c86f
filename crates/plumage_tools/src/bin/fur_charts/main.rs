//! Charts of precomputed transfer, shells and virtual fragments, an SVG and its numbers as CSV each; and what the dense fur of
//! Kloetzli 2005 takes in memory and keeps in detail.
//!
//! `cargo run --config 'profile.dev.opt-level=3' -p plumage_tools --bin fur_charts [folder]` (default `docs/charts`)

use plumage_tools::plot;
mod fragments;
mod picture;
mod shells;
mod transfer;

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
