//! Every unit and range that a slider shows is the one that validation enforces.
use bevy::reflect::{
    GetPath, PartialReflect, Reflect, ReflectRef, TypeInfo, Typed, enums::VariantInfo,
};
use bevy_plumage::anatomy::{Coat, Down};
use bevy_plumage::groom::{Dab, Placement, Select};
use bevy_plumage::maths::scattering::FibreKind;
use bevy_plumage::{Parameter, asset::RonAsset};

/// Paths of all numbers below `value` for which a parameter holds, with it: that of the field, or of the field that it is part of.
fn parameters(
    value: &dyn PartialReflect,
    path: &str,
    outer: Option<Parameter>,
    found: &mut Vec<(String, Parameter)>,
) {
    let number = [
        value.represents::<f32>(),
        value.represents::<u32>(),
        value.represents::<u8>(),
    ];
    if number.contains(&true) {
        found.extend(outer.map(|parameter| (path.to_owned(), parameter)));
        return;
    }
    let mut visit = |name: String, part: Option<&dyn PartialReflect>, own: Option<&Parameter>| {
        if let Some(part) = part {
            let parameter = own.copied().or(outer);
            parameters(part, &format!("{path}{name}"), parameter, found);
        }
    };
    let info = value.get_represented_type_info();
    match (value.reflect_ref(), info) {
        (ReflectRef::Struct(fields), Some(TypeInfo::Struct(info))) => {
            for (i, field) in info.iter().enumerate() {
                let name = format!(".{}", field.name());
                visit(name, fields.field_at(i), field.get_attribute());
            }
        }
        (ReflectRef::TupleStruct(fields), Some(TypeInfo::TupleStruct(info))) => {
            for (i, field) in info.iter().enumerate() {
                visit(format!(".{i}"), fields.field(i), field.get_attribute());
            }
        }
        (ReflectRef::Enum(fields), Some(TypeInfo::Enum(info))) => {
            match info.variant(fields.variant_name()) {
                Some(VariantInfo::Struct(info)) => {
                    for (i, field) in info.iter().enumerate() {
                        let name = format!(".{}", field.name());
                        visit(name, fields.field_at(i), field.get_attribute());
                    }
                }
                Some(VariantInfo::Tuple(info)) => {
                    for (i, field) in info.iter().enumerate() {
                        visit(format!(".{i}"), fields.field_at(i), field.get_attribute());
                    }
                }
                _ => {}
            }
        }
        (ReflectRef::List(list), _) => visit("[0]".into(), list.get(0), None),
        (ReflectRef::Array(array), _) => visit("[0]".into(), array.get(0), None),
        _ => {}
    }
}

/// Sets a number by its path; whether it can be so: an unsigned one has nothing below 0.
fn set<T: Reflect>(value: &mut T, path: &str, number: f64) -> bool {
    let field = value.reflect_path_mut(path).unwrap();
    if let Some(x) = field.try_downcast_mut::<f32>() {
        *x = number as f32;
    } else if let Some(x) = field.try_downcast_mut::<u32>() {
        *x = number as u32;
        return number >= 0.0;
    } else if let Some(x) = field.try_downcast_mut::<u8>() {
        *x = number as u8;
        return number >= 0.0;
    } else {
        panic!("{path} is no number");
    }
    true
}

fn check<T: Reflect + Typed + Clone>(
    value: &T,
    least: usize,
    valid: impl Fn(&T) -> Result<(), String>,
) {
    let mut found = Vec::new();
    parameters(value, "", None, &mut found);
    assert!(found.len() >= least, "{} parameters", found.len());
    // That stations rise is a relation of its own: the first of a row cannot be at its end.
    found.retain(|(path, _)| !path.ends_with("stations[0].at"));
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
            let mut other = value.clone();
            if !set(&mut other, &path, number) {
                continue;
            }
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
    let mut feather = plumage_tests::shipped::feather("eagle_primary");
    feather.gaps.count = 3;
    feather.optics.barb.kind = FibreKind::Structural { core_radius: 0.7 };
    feather.optics.distal.kind = FibreKind::Pigment {
        medulla_radius: 0.8,
        scattering: 2.0,
        anisotropy: 0.4,
    };
    // That stops rise is a relation of its own: one alone may be anywhere.
    feather.albedo.front.stops.truncate(1);
    feather.albedo.back = Some(feather.albedo.front.clone());
    check(&feather, 70, |feather| {
        feather.validate("eagle").map_err(|error| error.to_string())
    });
}

#[test]
fn sliders_of_a_groom_end_where_validation_does() {
    let mut groom = plumage_tests::shipped::groom("parrot");
    groom.regions[0].placement = Placement::Rows(3);
    groom.regions[0].select = Select::Any(vec![Select::Within {
        low: [0.0; 3],
        high: [1.0; 3],
    }]);
    groom.paint = vec![Dab::new([0.0; 3], 5.0)];
    check(&groom, 50, |groom| {
        groom.validate("parrot").map_err(|error| error.to_string())
    });
}

#[test]
fn ranges_of_a_down_are_those_that_validation_enforces() {
    let mut down = Down::default();
    down.coats = vec![Coat::default()];
    // An interval that may rise or fall to any end of its range.
    check(&down, 20, |down| {
        let mut down = down.clone();
        for coat in &mut down.coats {
            for interval in [&mut coat.radius, &mut coat.length] {
                if interval.low > interval.high {
                    std::mem::swap(&mut interval.low, &mut interval.high);
                }
            }
        }
        down.validate("down").map_err(|error| error.to_string())
    });
}
