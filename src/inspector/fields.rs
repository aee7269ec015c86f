//! Widgets for reflected values: unit, range and tooltip come from the one Reflect struct.
//!
//! The structure of a value (structs, enums, lists) and the tooltips are drawn by `bevy-inspector-egui`; numbers, spans and
//! colours are drawn here, so that a number shows its [`Parameter`]. The type registry is our own: the app's stays as it is.

use crate::{
    anatomy::Feather,
    groom::{Groom, Span, Tint},
    parameter::Parameter,
    render::FeatherQuality,
};
use bevy::reflect::{
    PartialReflect, ReflectMut, TypeInfo, TypeRegistration, TypeRegistry, enums::VariantInfo,
};
use bevy_egui::egui;
use bevy_inspector_egui::{
    inspector_egui_impls::InspectorEguiImpl,
    inspector_options::{InspectorOptions, ReflectInspectorOptions, Target},
    reflect_inspector::{Context, InspectorUi},
};
use std::any::Any;

/// Width of the column of names in points.
const NAMES: f32 = 140.0;

/// Types that the panels show, with a [`Parameter`] as the option of every field that has one.
pub struct Fields(TypeRegistry);

impl Default for Fields {
    fn default() -> Self {
        let mut registry = TypeRegistry::new();
        registry.register::<Feather>();
        registry.register::<Groom>();
        registry.register::<FeatherQuality>();
        registry.register_type_data::<bool, InspectorEguiImpl>();
        registry.register_type_data::<String, InspectorEguiImpl>();
        for registration in registry.iter_mut() {
            let options = options_of(registration);
            registration.insert(ReflectInspectorOptions(options));
        }
        Self(registry)
    }
}

impl Fields {
    /// Draws widgets for `value`; whether it changed.
    pub fn edit(&self, ui: &mut egui::Ui, id: &str, value: &mut dyn PartialReflect) -> bool {
        let mut context = Context::default();
        InspectorUi::new(&self.0, &mut context, Some(leaf), None, None).ui_for_reflect_with_options(
            value,
            ui,
            egui::Id::new(id),
            &(),
        )
    }

    /// Draws one field of a struct as a labelled row; whether it changed. A name that is not there draws nothing.
    pub fn edit_field(
        &self,
        ui: &mut egui::Ui,
        value: &mut dyn PartialReflect,
        name: &'static str,
    ) -> bool {
        let Some(TypeInfo::Struct(info)) = value.get_represented_type_info() else {
            return false;
        };
        let Some(field) = info.field(name) else {
            return false;
        };
        let ReflectMut::Struct(value) = value.reflect_mut() else {
            return false;
        };
        let Some(inner) = value.field_mut(name) else {
            return false;
        };
        let none: &dyn Any = &();
        let options = field
            .get_attribute::<Parameter>()
            .map_or(none, |p| p as &dyn Any);
        row(ui, name, field.docs().unwrap_or_default().trim(), |ui| {
            let mut context = Context::default();
            InspectorUi::new(&self.0, &mut context, Some(leaf), None, None)
                .ui_for_reflect_with_options(inner, ui, egui::Id::new(name), options)
        })
    }

    /// The registry of the types shown.
    pub fn registry(&self) -> &TypeRegistry {
        &self.0
    }
}

/// A row of a panel: the name, in a column as wide as all others, then what the value is edited with.
pub fn row<R>(
    ui: &mut egui::Ui,
    name: &str,
    hint: &str,
    widget: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    row_of(ui, NAMES, name, hint, widget)
}

/// The same with a column of names of this width.
pub fn row_of<R>(
    ui: &mut egui::Ui,
    width: f32,
    name: &str,
    hint: &str,
    widget: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    ui.horizontal(|ui| {
        let start = ui.cursor().left();
        let label = ui.label(name);
        if !hint.is_empty() {
            label.on_hover_text(hint);
        }
        let rest = width - (ui.cursor().left() - start);
        if rest > 0.0 {
            ui.add_space(rest);
        }
        widget(ui)
    })
    .inner
}

/// The parameters of a type's fields, as `bevy-inspector-egui` hands them to the widgets.
fn options_of(registration: &TypeRegistration) -> InspectorOptions {
    let mut options = InspectorOptions::new();
    match registration.type_info() {
        TypeInfo::Struct(info) => {
            for (i, field) in info.iter().enumerate() {
                if let Some(parameter) = field.get_attribute::<Parameter>() {
                    options.insert(Target::Field(i), *parameter);
                }
            }
        }
        TypeInfo::Enum(info) => {
            for (variant_index, variant) in info.iter().enumerate() {
                let VariantInfo::Struct(variant) = variant else {
                    continue;
                };
                for (field_index, field) in variant.iter().enumerate() {
                    if let Some(parameter) = field.get_attribute::<Parameter>() {
                        let target = Target::VariantField {
                            variant_index,
                            field_index,
                        };
                        options.insert(target, *parameter);
                    }
                }
            }
        }
        _ => {}
    }
    options
}

/// Numbers, spans and colours; everything else is left to the structure.
fn leaf(
    _: &mut InspectorUi<'_, '_>,
    value: &mut dyn PartialReflect,
    ui: &mut egui::Ui,
    _: egui::Id,
    options: &dyn Any,
) -> Option<bool> {
    let parameter = options.downcast_ref::<Parameter>().copied();
    let value = value.try_as_reflect_mut()?.as_any_mut();
    if let Some(number) = value.downcast_mut::<f32>() {
        return Some(self::number(ui, number, parameter));
    }
    if let Some(number) = value.downcast_mut::<u32>() {
        return Some(self::number(ui, number, parameter));
    }
    if let Some(number) = value.downcast_mut::<u16>() {
        return Some(self::number(ui, number, parameter));
    }
    if let Some(number) = value.downcast_mut::<u8>() {
        return Some(self::number(ui, number, parameter));
    }
    if let Some((along, across)) = value.downcast_mut::<(u8, u8)>() {
        // Only the segments of a card are such a pair.
        let count = |ui: &mut egui::Ui, value, most| {
            ui.add(egui::DragValue::new(value).range(1..=most).speed(0.1))
                .changed()
        };
        return Some(
            ui.horizontal(|ui| {
                let first = count(ui, along, 64);
                ui.label("along,");
                let second = count(ui, across, 16);
                ui.label("across");
                first | second
            })
            .inner,
        );
    }
    if let Some(span) = value.downcast_mut::<Span>() {
        return Some(
            ui.horizontal(|ui| {
                let first = drag(ui, &mut span.0, parameter);
                ui.label("to");
                drag(ui, &mut span.1, parameter) | first
            })
            .inner,
        );
    }
    if let Some(tint) = value.downcast_mut::<Tint>() {
        return Some(
            ui.horizontal(|ui| {
                let first = colour(ui, &mut tint.0);
                ui.label("to");
                colour(ui, &mut tint.1) | first
            })
            .inner,
        );
    }
    None
}

/// A slider where the range is known, else a number to drag; whether it changed.
pub fn number<N: egui::emath::Numeric>(
    ui: &mut egui::Ui,
    value: &mut N,
    parameter: Option<Parameter>,
) -> bool {
    let Some(parameter) = parameter else {
        return drag(ui, value, None);
    };
    let range = N::from_f64(parameter.low)..=N::from_f64(parameter.high);
    let slider = egui::Slider::new(value, range)
        .logarithmic(parameter.logarithmic)
        .suffix(suffix(parameter.unit));
    ui.add(slider).changed()
}

fn drag<N: egui::emath::Numeric>(
    ui: &mut egui::Ui,
    value: &mut N,
    parameter: Option<Parameter>,
) -> bool {
    // A drag of a hundred points doubles a value.
    let (least, decimals) = if N::INTEGRAL { (0.1, 0) } else { (1.0e-3, 4) };
    let speed = (value.to_f64() * 0.01).abs().max(least);
    let mut widget = egui::DragValue::new(value)
        .max_decimals(decimals)
        .speed(speed);
    if let Some(parameter) = parameter {
        widget = widget
            .range(N::from_f64(parameter.low)..=N::from_f64(parameter.high))
            .suffix(suffix(parameter.unit));
    }
    ui.add(widget).changed()
}

fn suffix(unit: &str) -> String {
    if unit.is_empty() || unit == "\u{b0}" {
        unit.to_owned()
    } else {
        format!(" {unit}")
    }
}

/// A button with the colour (sRGB, 0..1) that opens a picker; whether it changed.
pub fn colour(ui: &mut egui::Ui, rgb: &mut [f32; 3]) -> bool {
    let mut bytes = rgb.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8);
    let changed = ui.color_edit_button_srgb(&mut bytes).changed();
    if changed {
        *rgb = bytes.map(|b| f32::from(b) / 255.0);
    }
    changed
}
