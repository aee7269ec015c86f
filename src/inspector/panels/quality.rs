//! Error budget, transparency and debug views of one bird.

use crate::{
    groom::Plumage,
    inspector::fields::{Fields, number},
    parameter::Parameter,
    render::FeatherQuality,
};
use bevy_egui::egui;

const DENSITY: Parameter = Parameter::new("", 0.01, 16.0).logarithmic();

/// Draws the widgets; whether the quality and whether the plumage changed.
pub fn quality_panel(
    ui: &mut egui::Ui,
    fields: &Fields,
    quality: &mut FeatherQuality,
    plumage: &mut Plumage,
) -> (bool, bool) {
    let changed = fields.edit(ui, "quality", quality);
    ui.label(format!(
        "Switch from NEAR to the averages at a footprint variance of {:.3} periods\u{b2}",
        quality.settings.threshold()
    ))
    .on_hover_text("What the error budget comes to (range query study, sec. 4)");
    ui.separator();
    let mut regroom = false;
    ui.horizontal(|ui| {
        ui.label("density")
            .on_hover_text("Number of scattered feathers relative to the groom's own; their size follows, so that cover stays");
        regroom |= number(ui, &mut plumage.density, Some(DENSITY));
    });
    ui.horizontal(|ui| {
        ui.label("seed");
        regroom |= ui.add(egui::DragValue::new(&mut plumage.seed)).changed();
    });
    (changed, regroom)
}
