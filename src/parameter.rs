//! [`Parameter`] and [`Length`]: unit and range of a field, said once.

use bevy::reflect::{Reflect, TypeInfo, Typed};

/// Unit and range of a numeric field, as an attribute that reflection carries (`#[reflect(@Parameter::new("mm", 0.1, 5000.0))]`).
///
/// Sliders read it and files are checked against it. On a field of several numbers (an array, a list, a pair, an option) it
/// holds for each of them.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct Parameter {
    /// Unit as shown after the number; empty for a pure number.
    pub unit: &'static str,
    /// Smallest valid value.
    pub low: f64,
    /// Largest valid value.
    pub high: f64,
    /// Whether equal steps on a slider are equal ratios.
    pub logarithmic: bool,
}

impl Parameter {
    /// A field in `low..=high`, in this unit.
    pub const fn new(unit: &'static str, low: f64, high: f64) -> Self {
        Self {
            unit,
            low,
            high,
            logarithmic: false,
        }
    }

    /// The attribute of a field of a struct; `None` if it has no such field, or that has none.
    pub fn of<T: Typed>(field: &str) -> Option<Self> {
        let TypeInfo::Struct(info) = T::type_info() else {
            return None;
        };
        info.field(field)?.get_attribute::<Self>().copied()
    }

    /// A share: 0 to 1, no unit.
    pub const fn share() -> Self {
        Self::new("", 0.0, 1.0)
    }

    /// An angle of `low..=high` degrees.
    pub const fn degrees(low: f64, high: f64) -> Self {
        Self::new("\u{b0}", low, high)
    }

    /// With a slider of equal ratios, for a range of several decades; `low` must be above 0 (a count may start at 0).
    pub const fn logarithmic(self) -> Self {
        Self {
            logarithmic: true,
            ..self
        }
    }

    /// The middle of the range, as the slider has it.
    pub fn middle(&self) -> f64 {
        if self.logarithmic && self.low > 0.0 {
            (self.low * self.high).sqrt()
        } else {
            0.5 * (self.low + self.high)
        }
    }
}

/// How many elements a list may have, or bytes a text, as an attribute that reflection carries
/// (`#[reflect(@Length::new(2, 64))]`). Files are checked against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct Length {
    /// Fewest.
    pub least: usize,
    /// Most.
    pub most: usize,
}

impl Length {
    /// From `least` to `most` elements.
    pub const fn new(least: usize, most: usize) -> Self {
        Self { least, most }
    }
}
