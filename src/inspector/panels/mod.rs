//! The panels. Each is a function of an `egui::Ui` and plain data, so that it can be tested without a window.

mod color;
mod feather;
mod groom;
mod layers;
mod lobes;
mod quality;
mod statistics;
mod toolbar;

pub use color::pattern_editor;
pub use feather::{FeatherPanel, Part, feather_panel};
pub use groom::{GroomPanel, Tool, groom_panel, plumage_panel};
pub use layers::Swatch;
pub use lobes::lobe_plot;
pub use quality::{quality_panel, weather_panel};
pub use statistics::{Sample, Statistics, statistics_panel};
pub use toolbar::{Toolbar, toolbar};
