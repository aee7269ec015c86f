//! Feathers in the colors of the skin they grow on: its base color, texture and vertex colors at each root.
//!
//! What looks a color up lives here. It may use `groom`; it may not place a feather, nor know shaders or the GPU.

mod plugin;
mod surface;

pub use plugin::SkinColorPlugin;
pub use surface::{Surface, skin_color};
