//! One feather: the symbols of the paper's Table 1, their presets and their file.

mod feather;
pub use feather::{Albedo, Barbules, Contour, Feather, Gaps, Pattern, Rachis, Vane};
