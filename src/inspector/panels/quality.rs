//! Error budget, transparency and debug views of one bird, and its weather.

use crate::{anatomy::Weather, inspector::fields::Fields, render::FeatherQuality};
use bevy_egui::egui;

/// Draws the widgets; whether the quality changed.
pub fn quality_panel(ui: &mut egui::Ui, fields: &Fields, quality: &mut FeatherQuality) -> bool {
    let mut changed = false;
    let usual = FeatherQuality::default();
    let button = egui::Button::new("Reset");
    if ui
        .add_enabled(*quality != usual, button)
        .on_hover_text("Back to the defaults")
        .clicked()
    {
        *quality = usual;
        changed = true;
    }
    for name in [
        "error_budget",
        "debug_view",
        "coverage_method",
        "dither",
        "pattern",
        "multiple_scattering",
        "shelter",
        "environment_samples",
        "lights_together",
        "light_budget",
        "order_window",
    ] {
        changed |= fields.edit_field(ui, &mut quality.settings, name);
    }
    changed |= fields.edit_field(ui, quality, "transparency");
    ui.separator();
    ui.label(format!(
        "The error budget puts the switch from NEAR to the averages at a footprint variance of {:.3} periods\u{b2}.",
        quality.settings.threshold()
    ))
    .on_hover_text("The threshold of the LOD that the error budget comes to");
    changed
}

/// Draws the widgets of a bird's weather; whether it changed.
pub fn weather_panel(ui: &mut egui::Ui, fields: &Fields, weather: &mut Weather) -> bool {
    ["wetness", "dirt", "age"]
        .into_iter()
        .fold(false, |changed, name| {
            fields.edit_field(ui, weather, name) | changed
        })
}
