//! Checks the fields of a reflected value against the [`Parameter`] and [`Length`] attributes that they carry.

use super::AssetError;
use crate::parameter::{Length, Parameter};
use bevy::reflect::{
    PartialReflect, ReflectRef, TypeInfo, attributes::CustomAttributes, enums::VariantInfo,
};
use std::fmt::Write as _;

/// Structures nested deeper are refused; RON's parser stops at 128.
const DEEPEST: usize = 128;

/// Checks every number, list and text below `value`: a [`Parameter`] holds for all numbers below its field that have none of
/// their own (an array, an `Option`, a pair), a [`Length`] for the field's own elements; a number without either must be finite.
pub(super) fn check(value: &dyn PartialReflect) -> Result<(), AssetError> {
    Walk::default().value(value, Rules::default())
}

/// What holds for a value.
#[derive(Clone, Copy, Default)]
struct Rules {
    parameter: Option<Parameter>,
    length: Option<Length>,
}

impl Rules {
    /// What holds for a field, given what holds for the value that it is part of.
    fn of(attributes: &CustomAttributes, outer: Self) -> Self {
        Self {
            parameter: attributes.get::<Parameter>().copied().or(outer.parameter),
            length: attributes.get::<Length>().copied(),
        }
    }

    /// What holds for an element of a list.
    fn of_element(self) -> Self {
        Self {
            length: None,
            ..self
        }
    }
}

/// One step from a value to a part of it.
#[derive(Clone, Copy)]
enum Step {
    Name(&'static str),
    Place(usize),
    Index(usize),
}

/// A way down a value, kept so that an error can name its field.
#[derive(Default)]
struct Walk {
    path: Vec<Step>,
}

impl Walk {
    fn value(&mut self, value: &dyn PartialReflect, rules: Rules) -> Result<(), AssetError> {
        if self.path.len() > DEEPEST {
            return Err(self.refuse("nested deeper", format_args!("{DEEPEST} levels")));
        }
        let info = value.get_represented_type_info();
        match (value.reflect_ref(), info) {
            (ReflectRef::Struct(fields), Some(TypeInfo::Struct(info))) => {
                for (i, field) in info.iter().enumerate() {
                    let rules = Rules::of(field.custom_attributes(), rules);
                    self.part(Step::Name(field.name()), fields.field_at(i), rules)?;
                }
            }
            (ReflectRef::TupleStruct(fields), Some(TypeInfo::TupleStruct(info))) => {
                for (i, field) in info.iter().enumerate() {
                    let rules = Rules::of(field.custom_attributes(), rules);
                    self.part(Step::Place(i), fields.field(i), rules)?;
                }
            }
            (ReflectRef::Enum(fields), Some(TypeInfo::Enum(info))) => {
                let variant = info.variant(fields.variant_name());
                match variant {
                    Some(VariantInfo::Struct(info)) => {
                        for (i, field) in info.iter().enumerate() {
                            let rules = Rules::of(field.custom_attributes(), rules);
                            self.part(Step::Name(field.name()), fields.field_at(i), rules)?;
                        }
                    }
                    Some(VariantInfo::Tuple(info)) => {
                        // An option is no level of its own in a file.
                        let named = info.name() != "Some";
                        if named {
                            self.path.push(Step::Name(info.name()));
                        }
                        for (i, field) in info.iter().enumerate() {
                            let own = Rules::of(field.custom_attributes(), rules);
                            let Some(inner) = fields.field_at(i) else {
                                continue;
                            };
                            if info.field_len() > 1 {
                                self.part(Step::Place(i), Some(inner), own)?;
                            } else {
                                let length = own.length.or(rules.length);
                                self.value(inner, Rules { length, ..own })?;
                            }
                        }
                        if named {
                            self.path.pop();
                        }
                    }
                    _ => {}
                }
            }
            (ReflectRef::Tuple(fields), _) => {
                for i in 0..fields.field_len() {
                    self.part(Step::Place(i), fields.field(i), rules.of_element())?;
                }
            }
            (ReflectRef::Array(items), _) => {
                for i in 0..items.len() {
                    self.part(Step::Index(i), items.get(i), rules.of_element())?;
                }
            }
            (ReflectRef::List(items), _) => {
                self.count(items.len(), rules.length)?;
                for i in 0..items.len() {
                    self.part(Step::Index(i), items.get(i), rules.of_element())?;
                }
            }
            _ => self.leaf(value, rules)?,
        }
        Ok(())
    }

    fn part(
        &mut self,
        step: Step,
        value: Option<&dyn PartialReflect>,
        rules: Rules,
    ) -> Result<(), AssetError> {
        let Some(value) = value else {
            return Ok(());
        };
        self.path.push(step);
        self.value(value, rules)?;
        self.path.pop();
        Ok(())
    }

    fn leaf(&self, value: &dyn PartialReflect, rules: Rules) -> Result<(), AssetError> {
        if let Some(&x) = value.try_downcast_ref::<f32>() {
            // In the precision of the value: the end of a range is in it.
            let inside = rules
                .parameter
                .is_none_or(|p| (p.low as f32..=p.high as f32).contains(&x));
            return self.number(x, x.is_finite() && inside, rules);
        }
        if let Some(&x) = value.try_downcast_ref::<f64>() {
            let inside = rules
                .parameter
                .is_none_or(|p| (p.low..=p.high).contains(&x));
            return self.number(x, x.is_finite() && inside, rules);
        }
        if let Some(text) = value.try_downcast_ref::<String>() {
            return self.count(text.len(), rules.length);
        }
        let whole = None
            .or_else(|| value.try_downcast_ref::<u8>().map(|&x| i128::from(x)))
            .or_else(|| value.try_downcast_ref::<u16>().map(|&x| i128::from(x)))
            .or_else(|| value.try_downcast_ref::<u32>().map(|&x| i128::from(x)))
            .or_else(|| value.try_downcast_ref::<u64>().map(|&x| i128::from(x)))
            .or_else(|| value.try_downcast_ref::<usize>().map(|&x| x as i128))
            .or_else(|| value.try_downcast_ref::<i32>().map(|&x| i128::from(x)));
        if let (Some(x), Some(p)) = (whole, rules.parameter) {
            return self.number(x, (p.low..=p.high).contains(&(x as f64)), rules);
        }
        Ok(())
    }

    fn number(
        &self,
        value: impl std::fmt::Display,
        inside: bool,
        rules: Rules,
    ) -> Result<(), AssetError> {
        if inside {
            return Ok(());
        }
        Err(match rules.parameter {
            Some(p) => self.refuse(value, format_args!("{} to {}", p.low, p.high)),
            None => self.refuse(value, "a finite number"),
        })
    }

    fn count(&self, count: usize, length: Option<Length>) -> Result<(), AssetError> {
        match length {
            Some(Length { least, most }) if !(least..=most).contains(&count) => Err(self.refuse(
                format_args!("{count} values long"),
                format_args!("{least} to {most} values"),
            )),
            _ => Ok(()),
        }
    }

    fn refuse(&self, value: impl std::fmt::Display, range: impl std::fmt::Display) -> AssetError {
        let mut field = String::new();
        for step in &self.path {
            // Writing to a text cannot fail.
            let _ = match step {
                Step::Name(name) if field.is_empty() => write!(field, "{name}"),
                Step::Name(name) => write!(field, ".{name}"),
                Step::Place(i) => write!(field, ".{i}"),
                Step::Index(i) => write!(field, "[{i}]"),
            };
        }
        AssetError::value(field, value, range)
    }
}
