//! One feather and one kind of down: the symbols of the paper's Table 1, a feather's map and outline, and the assets
//! `*.feather.ron` and `*.down.ron`.
//!
//! What describes a single feather lives here, on the processor. It may use `asset` and `maths`; it may not know grooms, materials or
//! shaders.

mod builtin;
mod clumps;
mod contour;
mod down;
mod feather;
mod outline;
mod pattern;
mod plugin;
mod rachis;
mod strip;
mod table1;
mod v1;
mod weather;

#[cfg(any(feature = "inspector", feature = "photo"))]
pub use builtin::primary;
pub use builtin::{contour, covering};
pub use clumps::Clumps;
pub use contour::{CONTOUR_ROWS, RACHIS_ROWS, ShapeTable};
pub use down::{Coat, Down, Interval, Specular, Spread, Transfer};
pub use feather::{
    Albedo, Barbules, Bars, ColorShare, Contour, Feather, Gaps, Pattern, Rachis, Rim, Spot, Stop,
    Vane,
};
pub use pattern::{BAKE_HEIGHT, BAKE_WIDTH};
pub use plugin::AnatomyPlugin;
pub(crate) use plugin::DownPlugin;
pub use rachis::{FeatherMap, Spline};
pub use table1::Side;
pub use weather::Weather;
