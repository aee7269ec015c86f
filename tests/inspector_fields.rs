//! Every unit and range that a slider shows is the one that validation enforces.
#![cfg(feature = "inspector")]

use bevy::reflect::{
    GetPath, PartialReflect, Reflect, ReflectRef, TypeInfo, Typed, enums::VariantInfo,
};
use bevy_plumage::{
    anatomy::{Feather, presets},
    groom::{Groom, Span},
    parameter::Parameter,
    scattering::FibreKind,
};

/// Paths of all numeric fields below `value` that have a parameter, with it.
fn parameters(value: &dyn PartialReflect, path: &str, found: &mut Vec<(String, Parameter)>) {
    let mut visit = |name: &str, field: &dyn PartialReflect, parameter: Option<&Parameter>| {
        let path = format!("{path}.{name}");
        match parameter {
            Some(parameter) if field.try_downcast_ref::<Span>().is_some() => {
                found.push((format!("{path}.0"), *parameter));
                found.push((format!("{path}.1"), *parameter));
            }
            Some(parameter) => found.push((path, *parameter)),
            None => parameters(field, &path, found),
        }
    };
    let info = value.get_represented_type_info();
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => {
            let Some(TypeInfo::Struct(info)) = info else {
                return;
            };
            for (i, field) in info.iter().enumerate() {
                if let Some(value) = fields.field_at(i) {
                    visit(field.name(), value, field.get_attribute::<Parameter>());
                }
            }
        }
        ReflectRef::Enum(fields) => {
            let Some(TypeInfo::Enum(info)) = info else {
                return;
            };
            if let Some(VariantInfo::Struct(info)) = info.variant(fields.variant_name()) {
                for (i, field) in info.iter().enumerate() {
                    if let Some(value) = fields.field_at(i) {
                        visit(field.name(), value, field.get_attribute::<Parameter>());
                    }
                }
            }
        }
        ReflectRef::List(list) => {
            for (i, item) in list.iter().enumerate().take(1) {
                parameters(item, &format!("{path}[{i}]"), found);
            }
        }
        _ => {}
    }
}

/// Sets a number by its path.
fn set<T: Reflect>(value: &mut T, path: &str, number: f64) {
    let field = value.reflect_path_mut(path).unwrap();
    if let Some(x) = field.try_downcast_mut::<f32>() {
        *x = number as f32;
    } else if let Some(x) = field.try_downcast_mut::<u32>() {
        *x = number.max(0.0) as u32;
    } else {
        panic!("{path} is no number");
    }
}

fn check<T: Reflect + Typed + Clone>(
    value: &T,
    least: usize,
    valid: impl Fn(&T) -> Result<(), String>,
) {
    let mut found = Vec::new();
    parameters(value, "", &mut found);
    assert!(found.len() >= least, "{} parameters", found.len());
    for (path, parameter) in found {
        for (number, inside) in [
            (parameter.low, true),
            (parameter.high, true),
            (
                parameter.high + (parameter.high - parameter.low) * 0.01 + 1.0,
                false,
            ),
            (
                parameter.low - (parameter.high - parameter.low) * 0.01,
                false,
            ),
        ] {
            if !inside && number < 0.0 && parameter.low == 0.0 && path.ends_with("count") {
                // An unsigned number has nothing below 0.
                continue;
            }
            let mut other = value.clone();
            set(&mut other, &path, number);
            let result = valid(&other);
            assert_eq!(
                result.is_ok(),
                inside,
                "{path} = {number}, slider {} to {}: {result:?}",
                parameter.low,
                parameter.high
            );
        }
    }
}

#[test]
fn sliders_of_a_feather_end_where_validation_does() {
    let mut feather: Feather = presets::by_name("macaw_primary").unwrap();
    feather.gaps.count = 3;
    feather.optics.barb.kind = FibreKind::Structural { core_radius: 0.7 };
    feather.optics.distal.kind = FibreKind::Pigment {
        medulla_radius: 0.8,
        scattering: 2.0,
        anisotropy: 0.4,
    };
    check(&feather, 45, |feather| {
        feather.validate().map_err(|error| error.to_string())
    });
}

#[test]
fn sliders_of_a_groom_end_where_validation_does() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/assets/grooms/parrot.groom.ron"
    );
    let groom = Groom::from_ron(&std::fs::read_to_string(path).unwrap(), "parrot").unwrap();
    check(&groom, 20, |groom| {
        groom.validate("parrot").map_err(|error| error.to_string())
    });
}
