//! Editor of a painted [`Pattern`]: stops in a table, which no generic widget draws.

use crate::{
    anatomy::{Bars, Pattern, Rim, Stop},
    inspector::fields::{NAMES, color_button, number, row, row_of},
    parameter::Parameter,
};
use bevy_egui::egui;

const SHARE: Parameter = Parameter::share();
/// What is added first.
const GREY: Stop = Stop {
    v: 1.0,
    color: [0.5; 3],
    tint: 0.0,
};
const RIM: Rim = Rim {
    width: 0.2,
    color: [0.2; 3],
    tint: 0.0,
};
const BARS: Bars = Bars {
    count: 8.0,
    color: [0.2; 3],
    share: 0.4,
    waviness: 0.3,
};
const TINT: &str = "How far the groom's color of the region takes its place";
/// Most color stops of a pattern.
const MAX_STOPS: usize = 16;

/// Draws the stops, the rim and the bars of a pattern; whether it changed.
pub fn pattern_editor(ui: &mut egui::Ui, id: &str, pattern: &mut Pattern) -> bool {
    let mut changed = false;
    let mut remove = None;
    egui::Grid::new((id, "stops"))
        .num_columns(4)
        .show(ui, |ui| {
            for heading in ["along", "color", "groom's tint", ""] {
                ui.label(heading);
            }
            ui.end_row();
            let count = pattern.stops.len();
            for (i, stop) in pattern.stops.iter_mut().enumerate() {
                changed |= share(ui, &mut stop.v);
                changed |= color_button(ui, &mut stop.color);
                changed |= share(ui, &mut stop.tint);
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
        pattern.stops.push(last.unwrap_or(GREY));
        changed = true;
    }
    // A stop that is dragged past another one changes places with it.
    pattern.stops.sort_by(|a, b| a.v.total_cmp(&b.v));
    changed |= optional(ui, "rim", &mut pattern.rim, RIM);
    if let Some(Rim { width, color, tint }) = &mut pattern.rim {
        let hint = "As a share of the half width";
        changed |= inner(ui, "width", hint, |ui| number(ui, width, Some(SHARE)));
        changed |= inner(ui, "color", "", |ui| color_button(ui, color));
        changed |= inner(ui, "groom's tint", TINT, |ui| number(ui, tint, Some(SHARE)));
    }
    changed |= optional(ui, "bars", &mut pattern.bars, BARS);
    if let Some(bars) = &mut pattern.bars {
        let Bars {
            count,
            color,
            share: filled,
            waviness,
        } = bars;
        changed |= inner(ui, "count", "", |ui| {
            number(ui, count, Parameter::of::<Bars>("count"))
        });
        changed |= inner(ui, "color", "", |ui| color_button(ui, color));
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
