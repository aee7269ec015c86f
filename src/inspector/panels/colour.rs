//! Editor of a painted [`Pattern`]: its tuples have no names that a generic widget could show.

use crate::{
    anatomy::Pattern,
    inspector::fields::{NAMES, colour, number, row, row_of},
    parameter::Parameter,
};
use bevy_egui::egui;

const SHARE: Parameter = Parameter::share();
const BARS: Parameter = Parameter::new("", 0.0, 200.0);
const TINT: &str = "How far the groom's colour of the region takes its place";
/// Most colour stops of a pattern.
const MAX_STOPS: usize = 16;

/// Draws the stops, the rim and the bars of a pattern; whether it changed.
pub fn pattern_editor(ui: &mut egui::Ui, id: &str, pattern: &mut Pattern) -> bool {
    let mut changed = false;
    let mut remove = None;
    egui::Grid::new((id, "stops"))
        .num_columns(4)
        .show(ui, |ui| {
            for heading in ["along", "colour", "groom's tint", ""] {
                ui.label(heading);
            }
            ui.end_row();
            let count = pattern.stops.len();
            for (i, (v, rgb, tint)) in pattern.stops.iter_mut().enumerate() {
                changed |= share(ui, v);
                changed |= colour(ui, rgb);
                changed |= share(ui, tint);
                let button = egui::Button::new("\u{2212}");
                if ui
                    .add_enabled(count > 1, button)
                    .on_hover_text("Remove")
                    .clicked()
                {
                    remove = Some(i);
                }
                ui.end_row();
            }
        });
    if let Some(i) = remove {
        pattern.stops.remove(i);
        changed = true;
    }
    if pattern.stops.len() < MAX_STOPS && ui.button("Add a stop").clicked() {
        let last = pattern.stops.last().copied();
        pattern.stops.push(last.unwrap_or((1.0, [0.5; 3], 0.0)));
        changed = true;
    }
    // A stop that is dragged past another one changes places with it.
    pattern.stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    changed |= optional(ui, "rim", &mut pattern.rim, (0.2, [0.2; 3], 0.0));
    if let Some((width, rgb, tint)) = &mut pattern.rim {
        let hint = "As a share of the half width";
        changed |= inner(ui, "width", hint, |ui| number(ui, width, Some(SHARE)));
        changed |= inner(ui, "colour", "", |ui| colour(ui, rgb));
        changed |= inner(ui, "groom's tint", TINT, |ui| number(ui, tint, Some(SHARE)));
    }
    changed |= optional(ui, "bars", &mut pattern.bars, (8.0, [0.2; 3], 0.4, 0.3));
    if let Some((count, rgb, filled, waviness)) = &mut pattern.bars {
        changed |= inner(ui, "count", "", |ui| number(ui, count, Some(BARS)));
        changed |= inner(ui, "colour", "", |ui| colour(ui, rgb));
        let hint = "Of the period that they fill";
        changed |= inner(ui, "share", hint, |ui| number(ui, filled, Some(SHARE)));
        changed |= inner(ui, "waviness", "", |ui| number(ui, waviness, Some(SHARE)));
    }
    changed |= row(ui, "mottle", "Amplitude of the fine mottling", |ui| {
        number(ui, &mut pattern.mottle, Some(SHARE))
    });
    changed
}

/// A value of 0 to 1, narrow enough for several in a row.
fn share(ui: &mut egui::Ui, value: &mut f32) -> bool {
    ui.add(
        egui::DragValue::new(value)
            .range(0.0..=1.0)
            .speed(0.005)
            .max_decimals(3),
    )
    .changed()
}

/// A row that belongs to the one above.
fn inner(
    ui: &mut egui::Ui,
    name: &str,
    hint: &str,
    widget: impl FnOnce(&mut egui::Ui) -> bool,
) -> bool {
    row_of(ui, NAMES, 1, name, hint, widget)
}

fn optional<T>(ui: &mut egui::Ui, name: &str, value: &mut Option<T>, first: T) -> bool {
    let mut there = value.is_some();
    let changed = row(ui, name, "", |ui| ui.checkbox(&mut there, "").changed());
    if changed {
        *value = there.then_some(first);
    }
    changed
}
