//! A groom: its regions and rows, and the tools that work on the bird itself.

use super::feather::section;
use crate::{
    anatomy::Feather,
    asset::AssetLink,
    groom::{Dab, Groom, Plumage, PlumageState},
    inspector::fields::{Fields, number, row},
    parameter::Parameter,
};
use bevy_egui::egui;

/// What a drag on the bird does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// A click picks a feather; a drag turns the camera.
    #[default]
    Pick,
    /// A drag draws a guide stroke along the lay.
    Draw,
    /// A drag moves the nearest point of a guide.
    Move,
    /// A drag paints how many feathers grow.
    Density,
    /// A drag paints how long they are.
    Length,
}

impl Tool {
    /// Every tool, with its name and what it does.
    pub const ALL: [(Self, &str, &str); 5] = [
        (Self::Pick, "Pick", "Click a feather to see what it is"),
        (
            Self::Draw,
            "Draw guide",
            "Drag over the bird along the lay, from root to tip",
        ),
        (
            Self::Move,
            "Move guide",
            "Drag a point of a guide over the skin",
        ),
        (
            Self::Density,
            "Paint density",
            "Drag over the bird; the factor multiplies the number of feathers",
        ),
        (
            Self::Length,
            "Paint length",
            "Drag over the bird; the factor multiplies the length of feathers",
        ),
    ];
}

/// What the panel remembers.
#[derive(Clone, Debug)]
pub struct GroomPanel {
    /// What a drag on the bird does.
    pub tool: Tool,
    /// What a tool does is repeated as its mirror image on the other side of the bird.
    pub mirror: bool,
    /// Factor that the brush paints.
    pub factor: f32,
    /// Radius of the brush, in the groom's units.
    pub radius: f32,
    /// Region shown.
    pub region: usize,
    /// Row shown.
    pub row: usize,
    /// What the last stroke could not do.
    pub note: Option<String>,
}

impl Default for GroomPanel {
    fn default() -> Self {
        Self {
            tool: Tool::Pick,
            mirror: true,
            factor: 1.5,
            radius: 20.0,
            region: 0,
            row: 0,
            note: None,
        }
    }
}

/// The bird as a whole: number of feathers and seed; whether `plumage` changed.
pub fn plumage_panel(ui: &mut egui::Ui, plumage: &mut Plumage, state: &PlumageState) -> bool {
    let mut changed = false;
    section(ui, "Bird", true, |ui| {
        let hint = "Number of scattered feathers relative to the groom's own; their size follows, so that cover stays";
        changed |= row(ui, "density", hint, |ui| {
            number(
                ui,
                &mut plumage.density,
                Parameter::of::<Plumage>("density"),
            )
        });
        changed |= row(ui, "seed", "The same seed gives the same bird", |ui| {
            ui.add(egui::DragValue::new(&mut plumage.seed)).changed()
        });
        if let Some(error) = &state.error {
            ui.colored_label(ui.visuals().error_fg_color, error);
        } else if state.is_ready() {
            ui.weak(format!("{} feathers", state.cards));
        } else {
            ui.horizontal(|ui| {
                ui.add(egui::Spinner::new().size(14.0));
                ui.weak("growing feathers in the background");
            });
        }
    });
    changed
}

/// Draws the widgets of a groom; whether `groom` changed.
pub fn groom_panel(
    ui: &mut egui::Ui,
    fields: &Fields,
    panel: &mut GroomPanel,
    groom: &mut Groom,
) -> bool {
    let mut changed = false;
    section(ui, "Tools", true, |ui| {
        ui.horizontal_wrapped(|ui| {
            for (tool, name, hint) in Tool::ALL {
                ui.selectable_value(&mut panel.tool, tool, name)
                    .on_hover_text(hint);
            }
        });
        if panel.tool != Tool::Pick {
            ui.checkbox(&mut panel.mirror, "mirror on the other side of the bird");
        }
        if matches!(panel.tool, Tool::Density | Tool::Length) {
            let hint = "What the brush multiplies by in its middle";
            row(ui, "factor", hint, |ui| {
                let field = if panel.tool == Tool::Density {
                    "density"
                } else {
                    "length"
                };
                number(ui, &mut panel.factor, Parameter::of::<Dab>(field));
            });
        }
        if matches!(panel.tool, Tool::Density | Tool::Length | Tool::Move) {
            row(ui, "radius", "Where the brush ends", |ui| {
                ui.add(
                    egui::DragValue::new(&mut panel.radius)
                        .range(1.0e-3..=1.0e6)
                        .max_decimals(2)
                        .speed(0.2)
                        .suffix(format!(" {}", unit_of(groom.unit))),
                );
            });
        }
        let hint = Tool::ALL
            .iter()
            .find(|(tool, ..)| *tool == panel.tool)
            .map_or("", |(.., hint)| hint);
        ui.weak(hint);
        if panel.tool != Tool::Pick {
            ui.weak("The right button turns the view.");
        }
        if let Some(note) = &panel.note {
            ui.colored_label(ui.visuals().warn_fg_color, note);
        }
        ui.horizontal(|ui| {
            ui.label(format!(
                "{} guides, {} dabs",
                groom.guides.len(),
                groom.paint.len()
            ));
            let remove = |ui: &mut egui::Ui, there: bool, text: &str| {
                ui.add_enabled(there, egui::Button::new(text)).clicked()
            };
            if panel.tool == Tool::Draw && remove(ui, !groom.guides.is_empty(), "Remove last guide")
            {
                groom.guides.pop();
                changed = true;
            }
            if matches!(panel.tool, Tool::Density | Tool::Length)
                && remove(ui, !groom.paint.is_empty(), "Remove all paint")
            {
                groom.paint.clear();
                changed = true;
            }
        });
    });
    let measure = Parameter::new(unit_of(groom.unit), 1.0e-6, 1.0e6);
    let offset = Parameter::new(measure.unit, -1.0e3, 1.0e3);
    let feathers = groom.feathers.clone();
    section(ui, "Regions", true, |ui| {
        let names = groom.regions.iter().map(|region| region.name.as_str());
        row(ui, "region", "A tract of scattered feathers", |ui| {
            choose(ui, "region", &mut panel.region, names);
        });
        let Some(region) = groom.regions.get_mut(panel.region) else {
            return;
        };
        changed |= worn(ui, "region feather", &mut region.feather, &feathers);
        changed |= fields.edit_field(ui, region, "count");
        for name in ["length", "width"] {
            changed |= fields.edit_field_as(ui, region, name, Some(measure));
        }
        for name in [
            "lift",
            "camber",
            "curl",
            "stiffness",
            "layer",
            "tint",
            "placement",
            "segments",
            "select",
            "name",
        ] {
            changed |= fields.edit_field(ui, region, name);
        }
        ui.weak("\u{201c}to\u{201d}: from the head end to the tail end");
    });
    section(ui, "Random variation of the region", false, |ui| {
        if let Some(region) = groom.regions.get_mut(panel.region) {
            changed |= fields.edit(ui, "region jitter", &mut region.jitter);
        }
    });
    section(ui, "Rows", false, |ui| {
        let names = groom.rows.iter().map(|row| row.name.as_str());
        row(ui, "row", "A row of feathers on bones", |ui| {
            choose(ui, "row", &mut panel.row, names);
        });
        let Some(row) = groom.rows.get_mut(panel.row) else {
            return;
        };
        changed |= worn(ui, "row feather", &mut row.feather, &feathers);
        changed |= fields.edit_field_as(ui, row, "width", Some(measure));
        for name in ["lift", "camber", "curl", "layer"] {
            changed |= fields.edit_field(ui, row, name);
        }
        changed |= fields.edit_field_as(ui, row, "offset", Some(offset));
        for name in ["tint", "segments"] {
            changed |= fields.edit_field(ui, row, name);
        }
    });
    section(ui, "Random variation of the row", false, |ui| {
        if let Some(row) = groom.rows.get_mut(panel.row) {
            changed |= fields.edit(ui, "row jitter", &mut row.jitter);
        }
    });
    changed
}

/// The unit of a groom.
fn unit_of(metres: f32) -> &'static str {
    match metres {
        1.0 => "m",
        0.01 => "cm",
        0.001 => "mm",
        _ => "units",
    }
}

/// The feather that a region or row wears, by the names of the files.
fn worn(ui: &mut egui::Ui, id: &str, feather: &mut u16, files: &[AssetLink<Feather>]) -> bool {
    let name = |link: &AssetLink<Feather>| {
        let handle = link.handle().and_then(|handle| handle.path());
        let file = handle.map_or_else(|| link.path().to_owned(), ToString::to_string);
        let file = file.rsplit('/').next().unwrap_or("?");
        file.split('.').next().unwrap_or(file).to_owned()
    };
    let mut chosen = usize::from(*feather);
    row(ui, "feather", "Feather worn", |ui| {
        let names: Vec<String> = files.iter().map(name).collect();
        choose(ui, id, &mut chosen, names.iter().map(String::as_str));
    });
    let changed = chosen != usize::from(*feather);
    *feather = u16::try_from(chosen).unwrap_or(*feather);
    changed
}

fn choose<'a>(
    ui: &mut egui::Ui,
    id: &str,
    selected: &mut usize,
    names: impl Iterator<Item = &'a str> + Clone,
) {
    let shown = names.clone().nth(*selected).unwrap_or("none");
    egui::ComboBox::from_id_salt(id)
        .selected_text(shown)
        .height(400.0)
        .show_ui(ui, |ui| {
            for (i, name) in names.enumerate() {
                ui.selectable_value(selected, i, name);
            }
        });
}
