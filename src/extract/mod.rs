//! One photograph becomes a [`Feather`](crate::anatomy::Feather) (Chen et al. 2026, Sec. 4.1).
//!
//! [`extract`] takes a picture of one whole feather on a background that is plainer than it and returns the asset, its
//! albedo, what was seen on the way (mask, outline, shaft, score map) and how far each result can be trusted. [`load_photograph`]
//! reads a file in bounded memory, [`Extraction::write`] writes what the plugin loads.
//!
//! Pixels. Every point is in pixels of the photograph as given: `(0, 0)` is the outer corner of its top left pixel, whose
//! centre is `(0.5, 0.5)`.

mod confidence;
mod error;
mod load;
pub mod photograph;
mod result;
mod settings;

pub use confidence::{Confidence, Doubt, Trust};
pub use error::ExtractError;
pub use load::{
    MAX_FILE_BYTES, MAX_PIXELS, MAX_SIDE, MIN_SIDE, decode_photograph, load_photograph,
};
pub use result::{BarbMeasure, CardFrame, Extraction, ScoreMap};
pub use settings::{AlbedoFilter, ExtractSettings, Face, Progress, Stage};

use image::DynamicImage;

/// Extracts the one feather of a photograph. `progress` hears each stage as it begins. Deterministic; bounded in time and
/// memory whatever the picture shows.
pub fn extract(
    photograph: &DynamicImage,
    settings: &ExtractSettings,
    progress: &mut dyn FnMut(Progress),
) -> Result<Extraction, ExtractError> {
    load::check_size(photograph.width(), photograph.height())?;
    settings.check()?;
    progress(Progress::begin(Stage::Prepare));
    Err(ExtractError::NoFeather {
        reason: "not written yet".to_owned(),
    })
}
