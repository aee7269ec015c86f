//! One feather: the symbols of the paper's Table 1, its map and outline, presets, and its file.

mod contour;
mod error;
mod feather;
mod loader;
pub mod map;
mod pattern;
pub mod presets;
mod rachis;
mod table1;
#[cfg(test)]
mod tests;
mod validate;

pub use contour::{CONTOUR_ROWS, RACHIS_ROWS, ShapeTable};
pub use error::FeatherError;
pub use feather::{Albedo, Barbules, ColourShare, Contour, Feather, Gaps, Pattern, Rachis, Vane};
pub use loader::{AnatomyPlugin, FeatherLoader, FeatherSaver};
pub use map::CanonicalFootprint;
pub use pattern::{BAKE_HEIGHT, BAKE_WIDTH};
pub use rachis::{FeatherMap, Spline};
pub use table1::Side;
