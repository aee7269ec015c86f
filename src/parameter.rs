//! [`Parameter`]: unit and range of a field, said once.

use bevy::reflect::Reflect;

/// Unit and range of a numeric field, as an attribute that reflection carries (`#[reflect(@Parameter::new("mm", 0.1, 5000.0))]`).
///
/// Sliders read it, and the tests hold validation to it.
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
