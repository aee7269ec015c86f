//! The surface of an iridescent barbule as biologists describe it.

use crate::parameter::Parameter;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use serde::{Deserialize, Serialize};

/// What the layers of melanosomes are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Structure {
    /// No melanosomes: the cortex alone is the film (pigeon's neck, glossy black).
    Film,
    /// Rows of solid rods (mallard, starling).
    #[default]
    SolidRods,
    /// Rows of rods around air (magpie, quetzal).
    HollowRods,
    /// Solid platelets (sunbirds).
    SolidPlatelets,
    /// Platelets full of air (hummingbirds).
    HollowPlatelets,
    /// Solid rods with air channels between the rows (peacock).
    RodsAndChannels,
}

/// What lies below the layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect, Serialize, Deserialize)]
pub enum Base {
    /// Half melanin, half keratin: swallows what arrives.
    #[default]
    Melanin,
    /// Keratin.
    Keratin,
    /// Air.
    Air,
}

/// Thin layers on the flat side of barbules, and how that side lies (docs/book/iridescence.md).
///
/// Peaks lie at about 1.6 (rods) to 1.2 (hollow platelets) times twice the period and move to shorter wavelengths away from the
/// normal.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default)]
#[serde(default, deny_unknown_fields)]
pub struct Iridescence {
    /// What the melanosomes are.
    pub structure: Structure,
    /// Keratin above the first layer, the film itself where there are no layers, 0..2500 nm.
    #[reflect(@Parameter::new("nm", 0.0, 2500.0))]
    pub cortex_nm: f32,
    /// Layers of melanosomes, 0..24; 0 is bare keratin.
    #[reflect(@Parameter::new("", 0.0, 24.0))]
    pub layers: u32,
    /// Diameter of rods, thickness of platelets, 20..400 nm.
    #[reflect(@Parameter::new("nm", 20.0, 400.0))]
    pub melanosome_nm: f32,
    /// Air inside over diameter or thickness, 0..0.9.
    #[reflect(@Parameter::new("", 0.0, 0.9))]
    pub hollow: f32,
    /// Keratin between layers, -60..400 nm; negative: rows of rods interlock.
    #[reflect(@Parameter::new("nm", -60.0, 400.0))]
    pub gap_nm: f32,
    /// Diameter over lateral spacing, 0.2..1.
    #[reflect(@Parameter::new("", 0.2, 1.0))]
    pub fill: f32,
    /// Diameter of the air channels between rows of rods, 0..120 nm.
    #[reflect(@Parameter::new("nm", 0.0, 120.0))]
    pub channel_nm: f32,
    /// Thickness of the outermost platelet, 0..300 nm; 0: like the others.
    #[reflect(@Parameter::new("nm", 0.0, 300.0))]
    pub first_nm: f32,
    /// What lies below.
    pub base: Base,
    /// Standard deviation of each layer's thickness, as a share, 0..0.2.
    #[reflect(@Parameter::new("", 0.0, 0.2))]
    pub disorder: f32,
    /// Standard deviation of all thicknesses from barbule to barbule, as a share, 0..0.3.
    #[reflect(@Parameter::new("", 0.0, 0.3))]
    pub variation: f32,
    /// Factor on all thicknesses, 0.6..1.6: the hue, as peaks follow it.
    #[reflect(@Parameter::new("", 0.6, 1.6).logarithmic())]
    pub scale: f32,
    /// Minor over major axis of the section of the side that mirrors, 0.05..1.
    #[reflect(@Parameter::new("", 0.05, 1.0).logarithmic())]
    pub flatness: f32,
    /// Standard deviation of the side's slope along the barbule, 2..20 degrees.
    #[reflect(@Parameter::degrees(2.0, 20.0))]
    pub slope: f32,
    /// How far the sides lean towards the barb's tip, -60..60 degrees.
    #[reflect(@Parameter::degrees(-60.0, 60.0))]
    pub tilt: f32,
    /// How far barbules rise out of the vane, -45..45 degrees.
    #[reflect(@Parameter::degrees(-45.0, 45.0))]
    pub rise: f32,
    /// How much of the stack the inner side has too, 0..1; the rest is bare keratin.
    #[reflect(@Parameter::share())]
    pub back: f32,
}

/// Eight rows of solid rods, blue-green.
impl Default for Iridescence {
    fn default() -> Self {
        Self {
            structure: Structure::SolidRods,
            cortex_nm: 120.0,
            layers: 8,
            melanosome_nm: 120.0,
            hollow: 0.0,
            gap_nm: 40.0,
            fill: 0.85,
            channel_nm: 0.0,
            first_nm: 0.0,
            base: Base::Melanin,
            disorder: 0.05,
            variation: 0.02,
            scale: 1.0,
            flatness: 0.4,
            slope: 8.0,
            tilt: 0.0,
            rise: 0.0,
            back: 1.0,
        }
    }
}

impl Iridescence {
    /// The same with every number in its range; the least one for what is not a number.
    pub fn limited(&self) -> Self {
        // The ranges of the fields, said again: a constant costs no search through their attributes.
        let at = crate::maths::functions::clamp::<f32>;
        Self {
            cortex_nm: at(self.cortex_nm, 0.0, 2500.0),
            layers: self.layers.min(24),
            melanosome_nm: at(self.melanosome_nm, 20.0, 400.0),
            hollow: at(self.hollow, 0.0, 0.9),
            gap_nm: at(self.gap_nm, -60.0, 400.0),
            fill: at(self.fill, 0.2, 1.0),
            channel_nm: at(self.channel_nm, 0.0, 120.0),
            first_nm: at(self.first_nm, 0.0, 300.0),
            disorder: at(self.disorder, 0.0, 0.2),
            variation: at(self.variation, 0.0, 0.3),
            scale: at(self.scale, 0.6, 1.6),
            flatness: at(self.flatness, 0.05, 1.0),
            slope: at(self.slope, 2.0, 20.0),
            tilt: at(self.tilt, -60.0, 60.0),
            rise: at(self.rise, -45.0, 45.0),
            back: at(self.back, 0.0, 1.0),
            ..*self
        }
    }

    /// Whether the layers are the same, whatever side they are on: the table of one is that of the other.
    pub fn same_layers(&self, other: &Self) -> bool {
        let bare = |stack: &Self| Self {
            flatness: 1.0,
            slope: 2.0,
            tilt: 0.0,
            rise: 0.0,
            back: 1.0,
            ..stack.limited()
        };
        bare(self) == bare(other)
    }
}
