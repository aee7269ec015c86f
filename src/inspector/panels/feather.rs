//! One feather: shape, vanes, color and optics.

use super::{Swatch, lobe_plot, pattern_editor};
use crate::{
    anatomy::Feather,
    inspector::fields::{Fields, number, row},
    maths::scattering::{Fibre, interference::Iridescence},
    parameter::Parameter,
};
use bevy_egui::egui;

/// A component of the feather.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// The shaft.
    Rachis,
    /// The barbs.
    #[default]
    Barb,
    /// The barbules towards the tip.
    Distal,
    /// The barbules towards the base.
    Proximal,
}

impl Part {
    /// Every part, with the name it is shown by.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rachis, "rachis"),
        (Self::Barb, "barb"),
        (Self::Distal, "distal"),
        (Self::Proximal, "proximal"),
    ];

    /// The fibre of this part.
    pub fn fibre(self, feather: &mut Feather) -> &mut Fibre {
        match self {
            Self::Rachis => &mut feather.optics.rachis,
            Self::Barb => &mut feather.optics.barb,
            Self::Distal => &mut feather.optics.distal,
            Self::Proximal => &mut feather.optics.proximal,
        }
    }

    /// Its factor on the painted color.
    pub fn share(self, feather: &Feather) -> f32 {
        let share = feather.albedo.share;
        match self {
            Self::Rachis => share.rachis,
            Self::Barb => share.barb,
            Self::Distal | Self::Proximal => share.barbule,
        }
    }
}

/// What the panel remembers.
#[derive(Clone, Debug, Default)]
pub struct FeatherPanel {
    /// Component whose optics are shown.
    pub part: Part,
    /// Edits of one vane go to both.
    pub both_vanes: bool,
    /// The right vane is shown.
    pub right: bool,
    /// Inclination of the light's opposite, the eye, for the polar plot, in degrees.
    pub eye: f32,
    /// Colors of the thin layers.
    pub swatch: Swatch,
}

const EYE: Parameter = Parameter::degrees(-80.0, 80.0);
const RADIUS: Parameter = Parameter::new("mm", 0.0, 50.0);

/// Draws the widgets of a feather into a scroll area; whether `feather` changed.
pub fn feather_panel(
    ui: &mut egui::Ui,
    fields: &Fields,
    panel: &mut FeatherPanel,
    feather: &mut Feather,
) -> bool {
    let mut changed = false;
    section(ui, "Shape", true, |ui| {
        for name in ["name", "length_mm", "aspect"] {
            changed |= fields.edit_field(ui, feather, name);
        }
        changed |= fields.edit_field(ui, &mut feather.contour, "start");
        row(ui, "rachis radius", "r_r at base, middle and tip", |ui| {
            for radius in &mut feather.rachis.radius_mm {
                changed |= ui
                    .add(
                        egui::DragValue::new(radius)
                            .range(RADIUS.low..=RADIUS.high)
                            .speed(0.002)
                            .max_decimals(3),
                    )
                    .changed();
            }
            ui.label(RADIUS.unit);
        });
        contour_plot(ui, feather);
    });
    section(ui, "Barbs and barbules", true, |ui| {
        ui.horizontal(|ui| {
            ui.selectable_value(&mut panel.right, false, "left vane");
            ui.selectable_value(&mut panel.right, true, "right vane");
            ui.checkbox(&mut panel.both_vanes, "edit both");
        });
        let (this, other) = if panel.right {
            (&mut feather.right, &mut feather.left)
        } else {
            (&mut feather.left, &mut feather.right)
        };
        if fields.edit(ui, "vane", this) {
            changed = true;
            if panel.both_vanes {
                *other = *this;
            }
        }
    });
    section(ui, "Splits of the contour", false, |ui| {
        changed |= fields.edit(ui, "gaps", &mut feather.gaps);
    });
    section(ui, "Clumps of barbs", false, |ui| {
        changed |= fields.edit(ui, "clumps", &mut feather.clumps);
    });
    section(ui, "Color, front", false, |ui| {
        changed |= pattern_editor(ui, "front", &mut feather.albedo.front);
        ui.add_space(4.0);
        ui.label("Share of the painted color");
        changed |= fields.edit(ui, "share", &mut feather.albedo.share);
    });
    section(ui, "Color, back", false, |ui| {
        let mut own = feather.albedo.back.is_some();
        if ui.checkbox(&mut own, "has colors of its own").changed() {
            feather.albedo.back = own.then(|| feather.albedo.front.clone());
            changed = true;
        }
        if let Some(back) = &mut feather.albedo.back {
            changed |= pattern_editor(ui, "back", back);
        }
    });
    section(ui, "Optics", true, |ui| {
        ui.horizontal(|ui| {
            for (part, name) in Part::ALL {
                ui.selectable_value(&mut panel.part, part, name);
            }
        });
        changed |= fields.edit(ui, "fibre", panel.part.fibre(feather));
        let color = feather
            .albedo
            .front
            .stops
            .get(feather.albedo.front.stops.len() / 2);
        let share = panel.part.share(feather);
        let albedo = color.map_or([0.5; 3], |stop| {
            stop.color.map(|c| (c.powf(2.2) * share).min(0.98))
        });
        let hint = "Inclination of the eye along the fibre in the plot";
        row(ui, "eye", hint, |ui| {
            number(ui, &mut panel.eye, Some(EYE));
        });
        lobe_plot(
            ui,
            panel.part.fibre(feather),
            albedo,
            panel.eye.to_radians(),
        );
        ui.add_space(4.0);
        ui.label("Sheen");
        changed |= fields.edit(ui, "sheen", &mut feather.optics.sheen);
    });
    section(ui, "Thin layers", feather.iridescence.is_some(), |ui| {
        changed |= layers_editor(ui, fields, &mut panel.swatch, feather);
    });
    changed
}

/// The layers of barbules that shimmer, and their color over the angle.
fn layers_editor(
    ui: &mut egui::Ui,
    fields: &Fields,
    swatch: &mut Swatch,
    feather: &mut Feather,
) -> bool {
    let mut changed = false;
    let mut own = feather.iridescence.is_some();
    if ui.checkbox(&mut own, "barbules shimmer").changed() {
        feather.iridescence = own.then(Iridescence::default);
        changed = true;
    }
    if let Some(layers) = &mut feather.iridescence {
        swatch.draw(ui, layers);
        changed |= fields.edit(ui, "iridescence", layers);
    }
    if let Some(map) = &feather.iridescence_scale {
        let ([columns, rows], [low, high]) = (map.size(), map.range());
        ui.label(format!(
            "Thickness over the card: {columns} by {rows} factors, {low:.2} to {high:.2}"
        ));
    }
    changed
}

/// A heading that folds.
pub fn section(ui: &mut egui::Ui, title: &str, open: bool, body: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(title)
        .default_open(open)
        .show(ui, body);
}

/// The outline as the reach of the barbs, lying on its side.
fn contour_plot(ui: &mut egui::Ui, feather: &Feather) {
    let size = egui::vec2(ui.available_width().min(280.0), 46.0);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let painter = ui.painter_at(rect);
    let widest = feather
        .contour
        .left
        .iter()
        .chain(&feather.contour.right)
        .fold(1e-6_f32, |widest, reach| widest.max(*reach));
    let line = |values: &[f32], sign: f32| -> Vec<egui::Pos2> {
        let last = (values.len().max(2) - 1) as f32;
        let start = feather.contour.start;
        values
            .iter()
            .enumerate()
            .map(|(i, reach)| {
                let y = start + (1.0 - start) * i as f32 / last;
                egui::pos2(
                    rect.left() + y * rect.width(),
                    rect.center().y + sign * reach / widest * 0.48 * rect.height(),
                )
            })
            .collect()
    };
    let stroke = egui::Stroke::new(1.0, ui.visuals().text_color());
    painter.line(line(&feather.contour.left, -1.0), stroke);
    painter.line(line(&feather.contour.right, 1.0), stroke);
    painter.hline(
        rect.x_range(),
        rect.center().y,
        egui::Stroke::new(1.5, ui.visuals().weak_text_color()),
    );
}
