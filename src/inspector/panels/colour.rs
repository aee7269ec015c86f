//! Editor of a painted [`Pattern`]: its tuples have no names that a generic widget could show.

use crate::{
    anatomy::Pattern,
    inspector::fields::{colour, number},
    parameter::Parameter,
};
use bevy_egui::egui;

const SHARE: Parameter = Parameter::share();
const BARS: Parameter = Parameter::new("", 0.0, 200.0);
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
    changed |= optional(ui, "Rim", &mut pattern.rim, (0.2, [0.2; 3], 0.0));
    if let Some((width, rgb, tint)) = &mut pattern.rim {
        ui.horizontal(|ui| {
            changed |= labelled(ui, "width", |ui| share(ui, width));
            changed |= colour(ui, rgb);
            changed |= labelled(ui, "tint", |ui| share(ui, tint));
        });
    }
    changed |= optional(ui, "Bars", &mut pattern.bars, (8.0, [0.2; 3], 0.4, 0.3));
    if let Some((count, rgb, share_, waviness)) = &mut pattern.bars {
        changed |= labelled(ui, "count", |ui| number(ui, count, Some(BARS)));
        ui.horizontal(|ui| {
            changed |= colour(ui, rgb);
            changed |= labelled(ui, "share", |ui| share(ui, share_));
            changed |= labelled(ui, "waviness", |ui| share(ui, waviness));
        });
    }
    changed |= labelled(ui, "mottle", |ui| {
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

fn labelled(ui: &mut egui::Ui, label: &str, widget: impl FnOnce(&mut egui::Ui) -> bool) -> bool {
    ui.horizontal(|ui| {
        ui.label(label);
        widget(ui)
    })
    .inner
}

fn optional<T>(ui: &mut egui::Ui, label: &str, value: &mut Option<T>, first: T) -> bool {
    let mut there = value.is_some();
    let changed = ui.checkbox(&mut there, label).changed();
    if changed {
        *value = there.then_some(first);
    }
    changed
}
