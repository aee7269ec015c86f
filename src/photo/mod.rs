//! One photograph becomes a [`Feather`](crate::anatomy::Feather) (Chen et al. 2026, Sec. 4.1).
//!
//! [`extract`] takes a picture of one whole feather on a background that is plainer than it and returns the asset, its
//! albedo, what was seen on the way (mask, outline, shaft, score map) and how far each result can be trusted. [`load_photograph`]
//! reads a file in bounded memory, [`Extraction::write`] writes what the plugin loads.
//!
//! What reads pictures lives here. It may use `anatomy`, `maths` and the image crates; it may not know grooms or rendering.
//!
//! Pixels. Every point is in pixels of the photograph as given: `(0, 0)` is the outer corner of its top left pixel, whose
//! centre is `(0.5, 0.5)`.

mod assemble;
mod axis;
mod background;
mod barbs;
mod color;
mod confidence;
mod edge;
mod error;
mod find;
mod held;
mod load;
mod loader;
mod objects;
mod outline;
mod overlay;
mod paint;
mod prepare;
mod raster;
mod result;
mod run;
mod score;
mod segment;
mod settings;
mod shaft;
mod silhouette;
mod spread;

pub use confidence::{Confidence, Doubt, Trust};
pub use error::ExtractError;
pub use load::{
    MAX_FILE_BYTES, MAX_PIXELS, MAX_SIDE, MIN_SIDE, decode_photograph, load_photograph,
};
pub use loader::{ExtractPlugin, PhotographLoader};
pub use result::{BarbMeasure, CardFrame, Extraction, PhotoObject, ScoreMap};
pub use run::extract;
pub use settings::{AlbedoFilter, ExtractSettings, Face, ObjectChoice, Progress, Stage};
