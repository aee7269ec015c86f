//! Widgets for reflected values: unit, range and tooltip come from the one Reflect struct.
//!
//! The structure of a value (structs, enums, lists) and the tooltips are drawn by `bevy-inspector-egui`; numbers, spans and
//! colors are drawn here, so that a number shows its [`Parameter`]. The type registry is our own: the app's stays as it is.

use crate::{
    anatomy::{Feather, Weather},
    groom::{Groom, Segments, Span, Tint},
    parameter::Parameter,
    render::FeatherQuality,
};
use bevy::reflect::{
    PartialReflect, ReflectMut, ReflectRef, TypeInfo, TypeRegistration, TypeRegistry,
    enums::{DynamicEnum, DynamicVariant, VariantInfo},
    structs::DynamicStruct,
};
use bevy_egui::egui;
use bevy_inspector_egui::{
    inspector_egui_impls::InspectorEguiImpl,
    inspector_options::{InspectorOptions, ReflectInspectorOptions, Target},
    reflect_inspector::{Context, InspectorUi},
};
use std::any::Any;

/// Width of the column of names in points.
pub const NAMES: f32 = 142.0;
/// What the names of a struct in a struct are set in by, in points.
const INSET: f32 = 12.0;
/// A range from here on is too wide for a slider of equal steps.
const WIDE: f64 = 2000.0;

/// Types that the panels show, with a [`Parameter`] as the option of every field that has one.
pub struct Fields(TypeRegistry);

impl Default for Fields {
    fn default() -> Self {
        let mut registry = TypeRegistry::new();
        registry.register::<Feather>();
        registry.register::<Groom>();
        registry.register::<FeatherQuality>();
        registry.register::<Weather>();
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
    /// Draws a row for every field of a struct, those of structs in it below a heading; anything else as one widget. Whether it
    /// changed.
    pub fn edit(&self, ui: &mut egui::Ui, id: &str, value: &mut dyn PartialReflect) -> bool {
        self.rows(ui, id, value, 0)
    }

    fn rows(&self, ui: &mut egui::Ui, id: &str, value: &mut dyn PartialReflect, depth: u8) -> bool {
        let Some(TypeInfo::Struct(info)) = value.get_represented_type_info() else {
            return self.widget(ui, egui::Id::new(id), value, None);
        };
        ui.push_id(id, |ui| {
            info.iter().fold(false, |changed, field| {
                self.field(ui, value, field.name(), None, depth) | changed
            })
        })
        .inner
    }

    /// Draws one field of a struct; whether it changed. A name that is not there draws nothing.
    pub fn edit_field(
        &self,
        ui: &mut egui::Ui,
        value: &mut dyn PartialReflect,
        name: &'static str,
    ) -> bool {
        self.edit_field_as(ui, value, name, None)
    }

    /// The same with this unit and range in place of the field's own: those of a length depend on the unit of the groom.
    pub fn edit_field_as(
        &self,
        ui: &mut egui::Ui,
        value: &mut dyn PartialReflect,
        name: &'static str,
        usual: Option<Parameter>,
    ) -> bool {
        self.field(ui, value, name, usual, 0)
    }

    fn field(
        &self,
        ui: &mut egui::Ui,
        value: &mut dyn PartialReflect,
        name: &'static str,
        usual: Option<Parameter>,
        depth: u8,
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
        let parameter = usual.or_else(|| field.get_attribute::<Parameter>().copied());
        self.named(ui, name, field.docs(), inner, parameter, depth)
    }

    /// A value under its name.
    fn named(
        &self,
        ui: &mut egui::Ui,
        name: &'static str,
        docs: Option<&str>,
        value: &mut dyn PartialReflect,
        parameter: Option<Parameter>,
        depth: u8,
    ) -> bool {
        let hint = format!(
            "{}\n\nIn files: {name}",
            docs.unwrap_or_default()
                .lines()
                .map(str::trim)
                .collect::<Vec<_>>()
                .join(" ")
                .trim()
        );
        let title = words(name);
        match value.reflect_ref() {
            ReflectRef::Struct(_) if !value.represents::<Segments>() => {
                row_of(ui, NAMES, depth, &title, &hint, |_| ());
                self.rows(ui, name, value, depth + 1)
            }
            ReflectRef::Enum(_) => {
                let mut changed = row_of(ui, NAMES, depth, &title, &hint, |ui| {
                    self.variant(ui, name, value)
                });
                let variant = value
                    .get_represented_type_info()
                    .and_then(|info| info.as_enum().ok())
                    .zip(value.reflect_ref().as_enum().ok())
                    .and_then(|(info, value)| info.variant(value.variant_name()));
                if let (Some(VariantInfo::Struct(info)), ReflectMut::Enum(value)) =
                    (variant, value.reflect_mut())
                {
                    for field in info.iter() {
                        if let Some(inner) = value.field_mut(field.name()) {
                            let (name, docs) = (field.name(), field.docs());
                            let parameter = field.get_attribute::<Parameter>().copied();
                            changed |= self.named(ui, name, docs, inner, parameter, depth + 1);
                        }
                    }
                }
                changed
            }
            _ => row_of(ui, NAMES, depth, &title, &hint, |ui| {
                self.widget(ui, ui.id().with(name), value, parameter)
            }),
        }
    }

    /// A list of the variants of an enum; with them what structure knows to draw, unless that is rows of their own.
    fn variant(&self, ui: &mut egui::Ui, name: &str, value: &mut dyn PartialReflect) -> bool {
        let id = ui.id().with(name);
        let Some(TypeInfo::Enum(info)) = value.get_represented_type_info() else {
            return false;
        };
        // Names and numbers with a range: the numbers of a new variant begin in the middle, where they are valid.
        let plain = info.iter().all(|variant| match variant {
            VariantInfo::Unit(_) => true,
            VariantInfo::Struct(fields) => fields
                .iter()
                .all(|field| field.is::<f32>() && field.has_attribute::<Parameter>()),
            VariantInfo::Tuple(_) => false,
        });
        if !plain {
            return ui.vertical(|ui| self.widget(ui, id, value, None)).inner;
        }
        let ReflectMut::Enum(present) = value.reflect_mut() else {
            return false;
        };
        let mut chosen = None;
        egui::ComboBox::from_id_salt(id)
            .selected_text(split(present.variant_name()))
            .show_ui(ui, |ui| {
                for variant in info.iter() {
                    let is = variant.name() == present.variant_name();
                    let item = ui.selectable_label(is, split(variant.name()));
                    if item
                        .on_hover_text(variant.docs().unwrap_or_default().trim())
                        .clicked()
                        && !is
                    {
                        chosen = Some(variant);
                    }
                }
            });
        let Some(chosen) = chosen else {
            return false;
        };
        let mut fields = DynamicStruct::default();
        if let VariantInfo::Struct(info) = chosen {
            for field in info.iter() {
                if let Some(parameter) = field.get_attribute::<Parameter>() {
                    fields.insert(field.name(), parameter.middle() as f32);
                }
            }
        }
        let new = match chosen {
            VariantInfo::Struct(_) => DynamicEnum::new(chosen.name(), fields),
            _ => DynamicEnum::new(chosen.name(), DynamicVariant::Unit),
        };
        present.try_apply(&new).is_ok()
    }

    /// The widget of a value without its name.
    fn widget(
        &self,
        ui: &mut egui::Ui,
        id: egui::Id,
        value: &mut dyn PartialReflect,
        parameter: Option<Parameter>,
    ) -> bool {
        let none: &dyn Any = &();
        let options = parameter.as_ref().map_or(none, |p| p as &dyn Any);
        let mut context = Context::default();
        InspectorUi::new(&self.0, &mut context, Some(leaf), None, None)
            .ui_for_reflect_with_options(value, ui, id, options)
    }

    /// The registry of the types shown.
    pub fn registry(&self) -> &TypeRegistry {
        &self.0
    }
}

/// The name of a field as words, without the unit that follows the number.
fn words(name: &str) -> String {
    let name = name
        .strip_suffix("_mm")
        .or_else(|| name.strip_suffix("_um"))
        .unwrap_or(name);
    name.replace('_', " ")
}

/// The name of a variant as words.
fn split(name: &str) -> String {
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push(' ');
            words.extend(letter.to_lowercase());
        } else {
            words.push(letter);
        }
    }
    words
}

/// A row of a panel: the name, in a column as wide as all others, then what the value is edited with.
pub fn row<R>(
    ui: &mut egui::Ui,
    name: &str,
    hint: &str,
    widget: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    row_of(ui, NAMES, 0, name, hint, widget)
}

/// The same with a column of names of this width; `depth` is how far the name is set in.
pub fn row_of<R>(
    ui: &mut egui::Ui,
    width: f32,
    depth: u8,
    name: &str,
    hint: &str,
    widget: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    ui.horizontal(|ui| {
        let start = ui.cursor().left();
        if depth > 0 {
            ui.add_space(f32::from(depth) * INSET);
        }
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

/// Numbers, spans and colors; everything else is left to the structure.
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
    if let Some(Segments { along, across }) = value.downcast_mut::<Segments>() {
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
                let first = color_button(ui, &mut tint.0);
                ui.label("to");
                color_button(ui, &mut tint.1) | first
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
    let Some(parameter) = parameter.filter(|p| p.logarithmic || p.high - p.low < WIDE) else {
        return drag(ui, value, parameter);
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
        .speed(speed)
        .custom_formatter(|x, decimals| {
            egui::emath::format_with_decimals_in_range(x, 0..=*decimals.end())
        });
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

/// A button with the color (sRGB, 0..1) that opens a picker; whether it changed.
pub fn color_button(ui: &mut egui::Ui, rgb: &mut [f32; 3]) -> bool {
    let mut bytes = rgb.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8);
    let changed = ui.color_edit_button_srgb(&mut bytes).changed();
    if changed {
        *rgb = bytes.map(|b| f32::from(b) / 255.0);
    }
    changed
}
