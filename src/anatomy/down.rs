//! The [`Down`] asset: one kind of undercoat or fur.

use super::v1;
use crate::{
    asset::{AssetError, RonAsset, parse},
    parameter::{Length, Parameter},
};
use bevy::{
    asset::Asset,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};

/// One kind of undercoat or fur; file `*.down.ron`.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Down {
    /// Format version of the file, [`RonAsset::VERSION`].
    pub version: u32,
    /// Name shown to people.
    pub name: String,
    /// Thickness of the coat, millimetres, 0.2..60 (macaw 4, eagle 8).
    #[reflect(@Parameter::new("mm", 0.2, 60.0).logarithmic())]
    pub thickness_mm: f32,
    /// Mean optical depth from the tips straight down to the skin, 0..12. Loose down of 2 to 10 mg/cm³ has 1 to 6 through 4 mm.
    #[reflect(@Parameter::new("", 0.0, 12.0))]
    pub optical_depth: f32,
    /// Width of a clump, millimetres, 0.05..40; the tile is eight clumps wide.
    #[reflect(@Parameter::new("mm", 0.05, 40.0).logarithmic())]
    pub clump_mm: f32,
    /// Displacement of the fibres towards the tips, shares of the tile, 0..0.2.
    #[reflect(@Parameter::new("", 0.0, 0.2))]
    pub uv_jitter: f32,
    /// Spread of the fibres' directions, 0..2: 0 parallel, 1 random. A floor on the sine between fibre and light, without which a
    /// coat turns transparent along its fibres.
    #[reflect(@Parameter::new("", 0.0, 2.0))]
    pub tangent_spread: Spread,
    /// How far the tips lean over into the lay, 0 (upright) to 1 (flat).
    #[reflect(@Parameter::share())]
    pub bend: f32,
    /// Direction of the lay in the model space of the mesh; of any length. Where it is along the normal the coat stands up.
    #[reflect(@Parameter::new("", -1.0e6, 1.0e6))]
    pub lay: [f32; 3],
    /// Albedo of the fibres at the skin, sRGB, 0..1.
    #[reflect(@Parameter::share())]
    pub color: [f32; 3],
    /// Albedo of the tips, sRGB, 0..1.
    #[reflect(@Parameter::share())]
    pub tip_color: [f32; 3],
    /// Albedo of the skin below, sRGB, 0..1.
    #[reflect(@Parameter::share())]
    pub skin: [f32; 3],
    /// Highlight of the fibres.
    pub specular: Specular,
    /// Hairs of the tile, up to 8 kinds; without any the tile is clumped noise.
    #[reflect(@Length::new(0, Down::MAX_COATS))]
    pub coats: Vec<Coat>,
    /// Cells of the tile along x, y and z, each 4..256.
    #[reflect(@Parameter::new("cells", 4.0, 256.0))]
    pub tile: [u32; 3],
    /// What is precomputed for light from all around.
    pub transfer: Transfer,
    /// Seed of everything random in the tile.
    pub seed: u64,
}

/// Spread of the fibres' directions, 0..2.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// At the skin.
    pub skin: f32,
    /// At the tips.
    pub tips: f32,
}

/// Highlight of the fibres.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Specular {
    /// Share of light that a fibre's surface reflects, 0..1.
    #[reflect(@Parameter::share())]
    pub strength: f32,
    /// Exponent of the highlight, 1..500.
    #[reflect(@Parameter::new("", 1.0, 500.0).logarithmic())]
    pub exponent: f32,
}

/// The smallest and the largest value that occurs.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interval {
    /// Smallest.
    pub low: f32,
    /// Largest; not below `low`.
    pub high: f32,
}

impl Interval {
    /// From `low` to `high`.
    pub const fn new(low: f32, high: f32) -> Self {
        Self { low, high }
    }
}

/// Hairs of one kind in the tile (docs/book/undercoat.md#density).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default)]
#[serde(deny_unknown_fields)]
pub struct Coat {
    /// Number of hairs in the tile, 0..20000.
    #[reflect(@Parameter::new("", 0.0, 20_000.0).logarithmic())]
    pub hairs: u32,
    /// Radius at the skin, in cells, 0.02..4.
    #[reflect(@Parameter::new("cells", 0.02, 4.0))]
    pub radius: Interval,
    /// Length in heights of the coat, 0.05..1.
    #[reflect(@Parameter::new("", 0.05, 1.0))]
    pub length: Interval,
    /// How far the tip leans to the side, cells, 0..64.
    #[reflect(@Parameter::new("cells", 0.0, 64.0))]
    pub curl: f32,
}

impl Default for Coat {
    fn default() -> Self {
        Self {
            hairs: 1000,
            radius: Interval::new(0.4, 0.8),
            length: Interval::new(0.5, 1.0),
            curl: 8.0,
        }
    }
}

/// What is precomputed for light from all around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect, Serialize, Deserialize)]
pub enum Transfer {
    /// Nothing: the sky is a function of the height alone.
    Off,
    /// Four numbers a cell: mean visibility and bent vector.
    #[default]
    Four,
}

impl Default for Down {
    fn default() -> Self {
        Self {
            version: Self::VERSION,
            name: "down".into(),
            thickness_mm: 4.0,
            optical_depth: 4.0,
            clump_mm: 1.0,
            uv_jitter: 0.05,
            tangent_spread: Spread {
                skin: 0.15,
                tips: 0.85,
            },
            bend: 0.3,
            lay: [0.0, -1.0, -0.4],
            color: [0.62, 0.60, 0.58],
            tip_color: [0.93, 0.91, 0.88],
            skin: [0.62, 0.42, 0.36],
            specular: Specular {
                strength: 0.03,
                exponent: 20.0,
            },
            coats: Vec::new(),
            tile: [64, 64, 32],
            transfer: Transfer::Four,
            seed: 1,
        }
    }
}

impl Down {
    /// Most kinds of hair in a tile.
    pub const MAX_COATS: usize = 8;

    /// Width of the periodic tile on the skin, metres: eight clumps.
    pub fn tile_metres(&self) -> f32 {
        8.0e-3 * self.clump_mm
    }
}

impl RonAsset for Down {
    const NAME: &'static str = "Down";
    const EXTENSION: &'static str = "down.ron";
    const VERSION: u32 = 2;
    const OLDEST: u32 = 1;

    fn version(&self) -> u32 {
        self.version
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn migrate(_: u32, bytes: &[u8], file: &str) -> Result<Self, AssetError> {
        parse::<v1::Down>(bytes, file).map(Self::from)
    }

    /// Intervals rise.
    fn check_relations(&self) -> Result<(), AssetError> {
        for (i, coat) in self.coats.iter().enumerate() {
            for (name, interval, most) in [("radius", coat.radius, 4), ("length", coat.length, 1)] {
                if interval.high < interval.low {
                    let field = format_args!("coats[{i}].{name}.high").to_string();
                    let range = format_args!("{} to {most}", interval.low).to_string();
                    return Err(AssetError::value(field, interval.high, range));
                }
            }
        }
        Ok(())
    }
}
