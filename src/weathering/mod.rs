//! Feathers that are wet, dirty or old: which of a bird's cards wear which weathered feather.
//!
//! What hands weathered feathers out lives here. It may use `anatomy` and `groom`; it may not place a feather, nor know shaders. What
//! weather makes of one feather is `anatomy`'s.

mod plugin;

pub use plugin::{Weathering, WeatheringPlugin};
