//! What the tests, charts and benchmarks of bevy_plumage share: apps without a window, shaders run by themselves, skins, scenes.
//!
//! Support lives here, never an assertion about the library. It may use the library and its references; the library may not use it.
#![allow(missing_docs)]

pub mod air;
pub mod app;
pub mod awkward;
pub mod bare;
pub mod birds;
pub mod cases;
pub mod counted;
pub mod curves;
pub mod feather_card;
pub mod fibres;
pub mod flip;
pub mod geometry;
pub mod golden;
pub mod gpu;
pub mod headless;
pub mod order;
pub mod photographs;
pub mod pixel;
pub mod scene;
pub mod scene_bird;
pub mod shaders;
pub mod shells;
pub mod shipped;
pub mod skins;
pub mod stability;
pub mod stack;
pub mod sweep;
pub mod tiles;
pub mod view;
pub mod wait;

use std::path::PathBuf;

/// The repository's own folder.
pub fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// A file of `assets`.
pub fn asset(path: &str) -> PathBuf {
    root().join("assets").join(path)
}

/// A file under `target/test_failures`, where a failing test leaves what it saw; the folder is made.
pub fn failure(file: &str) -> PathBuf {
    let folder = root().join("target/test_failures");
    let _ = std::fs::create_dir_all(&folder);
    folder.join(file)
}
