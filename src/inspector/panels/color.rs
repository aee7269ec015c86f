//! Editor of a painted [`Pattern`]: stops in a table, which no generic widget draws.

use crate::{
    anatomy::{Bars, Pattern, Rim, Spot, Stop},
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
    softness: Rim::SOFTNESS,
    color: [0.2; 3],
    tint: 0.0,
};
const BARS: Bars = Bars {
    count: 8.0,
    color: [0.2; 3],
    share: 0.4,
    waviness: 0.3,
};
const SPOT: Spot = Spot {
    v: 0.9,
    across: 0.0,
    half_width: 0.2,
    half_length: 0.03,
    color: [0.1; 3],
    tint: 0.0,
};
const TINT: &str = "How far the groom's color of the region takes its place";
/// Most color stops of a pattern, and most spots.
const MOST: usize = 16;

/// Draws the stops, the rim, the bars and the spots of a pattern; whether it changed.
pub fn pattern_editor(ui: &mut egui::Ui, id: &str, pattern: &mut Pattern) -> bool {
    let headings = ["along", "color", "groom's tint"];
    let mut changed = list(
        ui,
        (id, "stops"),
        headings,
        &mut pattern.stops,
        1,
        |ui, stop| {
            share(ui, &mut stop.v) | color_button(ui, &mut stop.color) | share(ui, &mut stop.tint)
        },
    );
    if pattern.stops.len() < MOST && ui.button("Add a stop").clicked() {
        let last = pattern.stops.last().copied();
        pattern.stops.push(last.unwrap_or(GREY));
        changed = true;
    }
    // A stop that is dragged past another one changes places with it.
    pattern.stops.sort_by(|a, b| a.v.total_cmp(&b.v));
    changed |= optional(ui, "rim", &mut pattern.rim, RIM);
    if let Some(Rim {
        width,
        softness,
        color,
        tint,
    }) = &mut pattern.rim
    {
        let hint = "As a share of the half width";
        changed |= inner(ui, "width", hint, |ui| number(ui, width, Some(SHARE)));
        let hint = "Over how much of its width to either side it runs out";
        changed |= inner(ui, "softness", hint, |ui| number(ui, softness, Some(SHARE)));
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
    let headings = [
        "along",
        "across",
        "width",
        "length",
        "color",
        "groom's tint",
    ];
    changed |= list(
        ui,
        (id, "spots"),
        headings,
        &mut pattern.spots,
        0,
        |ui, spot| {
            share(ui, &mut spot.v)
                | number(ui, &mut spot.across, Parameter::of::<Spot>("across"))
                | number(
                    ui,
                    &mut spot.half_width,
                    Parameter::of::<Spot>("half_width"),
                )
                | number(
                    ui,
                    &mut spot.half_length,
                    Parameter::of::<Spot>("half_length"),
                )
                | color_button(ui, &mut spot.color)
                | share(ui, &mut spot.tint)
        },
    );
    if pattern.spots.len() < MOST && ui.button("Add a spot").clicked() {
        let last = pattern.spots.last().copied();
        pattern.spots.push(last.unwrap_or(SPOT));
        changed = true;
    }
    changed |= row(ui, "mottle", "Amplitude of the fine mottling", |ui| {
        number(ui, &mut pattern.mottle, Some(SHARE))
    });
    changed
}

/// A table of items that can be removed as long as more than `least` are there; whether one changed.
fn list<T, const N: usize>(
    ui: &mut egui::Ui,
    id: (&str, &str),
    headings: [&str; N],
    items: &mut Vec<T>,
    least: usize,
    mut cells: impl FnMut(&mut egui::Ui, &mut T) -> bool,
) -> bool {
    let mut changed = false;
    let mut remove = None;
    let count = items.len();
    if count == 0 {
        return false;
    }
    egui::Grid::new(id).num_columns(N + 1).show(ui, |ui| {
        for heading in headings {
            ui.label(heading);
        }
        ui.end_row();
        for (i, item) in items.iter_mut().enumerate() {
            changed |= cells(ui, item);
            let button = egui::Button::new("\u{2212}");
            let button = ui.add_enabled(count > least, button);
            if button.on_hover_text("Remove").clicked() {
                remove = Some(i);
            }
            ui.end_row();
        }
    });
    if let Some(i) = remove {
        items.remove(i);
        changed = true;
    }
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
