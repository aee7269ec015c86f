//! A groom: its regions and rows, and the tools that work on the bird itself.

use super::feather::section;
use crate::{
    groom::Groom,
    inspector::fields::{Fields, number},
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
    /// New guides are repeated on the other side.
    pub mirror: bool,
    /// Factor that the brush paints.
    pub factor: f32,
    /// Radius of the brush, in the groom's units.
    pub radius: f32,
    /// Region shown.
    pub region: usize,
    /// Row shown.
    pub row: usize,
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
        }
    }
}

const FACTOR: Parameter = Parameter::new("", 0.0, 4.0);

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
        match panel.tool {
            Tool::Draw | Tool::Move => {
                ui.checkbox(&mut panel.mirror, "mirror new guides");
            }
            Tool::Density | Tool::Length => {
                ui.horizontal(|ui| {
                    ui.label("factor");
                    number(ui, &mut panel.factor, Some(FACTOR));
                });
                ui.horizontal(|ui| {
                    ui.label("radius");
                    ui.add(
                        egui::DragValue::new(&mut panel.radius)
                            .range(1.0e-3..=1.0e6)
                            .speed(0.2),
                    );
                    ui.label("groom units");
                });
            }
            Tool::Pick => {}
        }
        ui.label(format!("{} guides", groom.guides.len()));
        if panel.tool == Tool::Draw
            && ui
                .add_enabled(
                    !groom.guides.is_empty(),
                    egui::Button::new("Remove last guide"),
                )
                .clicked()
        {
            groom.guides.pop();
            changed = true;
        }
    });
    section(ui, "Regions", true, |ui| {
        let names = groom.regions.iter().map(|region| region.name.as_str());
        choose(ui, "region", &mut panel.region, names);
        if let Some(region) = groom.regions.get_mut(panel.region) {
            changed |= fields.edit(ui, "region fields", region);
        }
    });
    section(ui, "Rows", false, |ui| {
        let names = groom.rows.iter().map(|row| row.name.as_str());
        choose(ui, "row", &mut panel.row, names);
        if let Some(row) = groom.rows.get_mut(panel.row) {
            for name in [
                "width", "lift", "camber", "curl", "layer", "offset", "tint", "jitter",
            ] {
                changed |= fields.edit_field(ui, row, name);
            }
        }
    });
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
        .show_ui(ui, |ui| {
            for (i, name) in names.enumerate() {
                ui.selectable_value(selected, i, name);
            }
        });
}
