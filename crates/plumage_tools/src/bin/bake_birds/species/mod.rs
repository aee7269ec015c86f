//! Birds as numbers: millimetres, degrees, sRGB. Left side only where a table is one-sided. One file is one bird.

mod bird;
mod coat;
mod eagle;
mod face;
mod macaw;
mod motion;
mod owl;
mod tract;

use bevy::color::Srgba;

pub use bird::{SHOULDER, Species, WingPose};
pub use coat::{Limb, RowLook, TractRow};
pub use face::{BareFace, Bill, EyeRim, FaceLines, Ledge, Naked, Slice};
pub use tract::Tract;

/// All birds.
pub fn all() -> [Species; 3] {
    [macaw::species(), eagle::species(), owl::species()]
}

/// Linear RGB of an sRGB hex color.
pub fn linear(hex: u32) -> [f32; 3] {
    srgb(hex).map(Srgba::gamma_function)
}

/// sRGB components in 0..1 of a hex color.
pub fn srgb(hex: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| ((hex >> shift) & 255) as f32 / 255.0)
}
