//! The [`Down`] asset: one kind of undercoat or fur.

use super::DownError;
use crate::parameter::Parameter;
use bevy::{asset::Asset, reflect::Reflect};
use serde::{Deserialize, Serialize};

/// One kind of undercoat or fur; file `*.down.ron`.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Down {
    /// Format version of the file, [`Down::VERSION`].
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
    /// Spread of the fibres' directions at the skin and at the tips, 0..2: 0 parallel, 1 random. A floor on the sine between fibre
    /// and light, without which a coat turns transparent along its fibres.
    pub tangent_spread: (f32, f32),
    /// How far the tips lean over into the lay, 0 (upright) to 1 (flat).
    #[reflect(@Parameter::share())]
    pub bend: f32,
    /// Direction of the lay in the model space of the mesh; of any length. Where it is along the normal the coat stands up.
    pub lay: [f32; 3],
    /// Albedo of the fibres at the skin, sRGB, 0..1.
    pub colour: [f32; 3],
    /// Albedo of the tips, sRGB, 0..1.
    pub tip_colour: [f32; 3],
    /// Albedo of the skin below, sRGB, 0..1.
    pub skin: [f32; 3],
    /// Share of light that a fibre's surface reflects as a highlight, 0..1, and the exponent of the highlight, 1..500.
    pub specular: (f32, f32),
    /// Hairs of the tile; without any the tile is clumped noise.
    pub coats: Vec<Coat>,
    /// Cells of the tile along x, y and z, each 4..256.
    pub tile: [u32; 3],
    /// What is precomputed for light from all around.
    pub transfer: Transfer,
    /// Seed of everything random in the tile.
    pub seed: u64,
}

/// Hairs of one kind in the tile (precomputed radiance transfer study, sec. B1).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coat {
    /// Number of hairs in the tile, 0..20000.
    pub hairs: u32,
    /// Radius at the skin, smallest and largest, in cells, 0.02..4.
    pub radius: (f32, f32),
    /// Length, smallest and largest, in heights of the coat, 0.05..1.
    pub length: (f32, f32),
    /// How far the tip leans to the side, cells, 0..64.
    pub curl: f32,
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
            tangent_spread: (0.15, 0.85),
            bend: 0.3,
            lay: [0.0, -1.0, -0.4],
            colour: [0.62, 0.60, 0.58],
            tip_colour: [0.93, 0.91, 0.88],
            skin: [0.62, 0.42, 0.36],
            specular: (0.03, 20.0),
            coats: Vec::new(),
            tile: [64, 64, 32],
            transfer: Transfer::Four,
            seed: 1,
        }
    }
}

/// Only the version: read first, so that a file of another version is not called malformed.
#[derive(Deserialize)]
#[serde(rename = "Down")]
struct Header {
    version: u32,
}

fn inside(field: &str, value: f32, low: f32, high: f32) -> Result<(), DownError> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    Err(DownError::range(
        field,
        value,
        format_args!("{low} to {high}"),
    ))
}

fn rising(field: &str, (low, high): (f32, f32), range: (f32, f32)) -> Result<(), DownError> {
    inside(&format!("{field}.0"), low, range.0, range.1)?;
    inside(&format!("{field}.1"), high, low, range.1)
}

impl Down {
    /// Version that this crate writes.
    pub const VERSION: u32 = 1;
    /// Most kinds of hair in a tile.
    pub const MAX_COATS: usize = 8;

    /// Parses and validates a down file; `path` is only for messages.
    ///
    /// # Errors
    /// [`DownError::Syntax`], [`DownError::Version`] or [`DownError::Range`].
    pub fn from_ron(bytes: &[u8], path: &str) -> Result<Self, DownError> {
        if let Ok(Header { version }) = ron::de::from_bytes(bytes)
            && version != Self::VERSION
        {
            return Err(DownError::Version {
                file: path.to_owned(),
                found: version,
                supported: Self::VERSION,
            });
        }
        let down: Self = ron::de::from_bytes(bytes).map_err(|error| DownError::Syntax {
            file: path.to_owned(),
            line: error.span.start.line,
            column: error.span.start.col,
            message: error.code.to_string(),
        })?;
        down.validate().map_err(|error| error.in_file(path))?;
        Ok(down)
    }

    /// The text of a down file.
    ///
    /// # Errors
    /// [`DownError::Range`] for a down that could not be read back.
    pub fn to_ron(&self) -> Result<String, DownError> {
        self.validate()?;
        let style = ron::ser::PrettyConfig::new()
            .new_line("\n")
            .compact_arrays(true);
        let text = ron::ser::to_string_pretty(self, style).map_err(|error| DownError::Io {
            file: self.name.clone(),
            message: error.to_string(),
        })?;
        Ok(text + "\n")
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`DownError::Range`] with the first field outside its range.
    pub fn validate(&self) -> Result<(), DownError> {
        self.check().map_err(|error| error.in_file(&self.name))
    }

    fn check(&self) -> Result<(), DownError> {
        inside("thickness_mm", self.thickness_mm, 0.2, 60.0)?;
        inside("optical_depth", self.optical_depth, 0.0, 12.0)?;
        inside("clump_mm", self.clump_mm, 0.05, 40.0)?;
        inside("uv_jitter", self.uv_jitter, 0.0, 0.2)?;
        inside("tangent_spread.0", self.tangent_spread.0, 0.0, 2.0)?;
        inside("tangent_spread.1", self.tangent_spread.1, 0.0, 2.0)?;
        inside("bend", self.bend, 0.0, 1.0)?;
        for (name, values, low, high) in [
            ("lay", self.lay, -1.0e6, 1.0e6),
            ("colour", self.colour, 0.0, 1.0),
            ("tip_colour", self.tip_colour, 0.0, 1.0),
            ("skin", self.skin, 0.0, 1.0),
        ] {
            for (i, value) in values.into_iter().enumerate() {
                inside(&format!("{name}[{i}]"), value, low, high)?;
            }
        }
        inside("specular.0", self.specular.0, 0.0, 1.0)?;
        inside("specular.1", self.specular.1, 1.0, 500.0)?;
        for (i, cells) in self.tile.into_iter().enumerate() {
            if !(4..=256).contains(&cells) {
                return Err(DownError::range(
                    format_args!("tile[{i}]"),
                    cells,
                    "4 to 256",
                ));
            }
        }
        if self.coats.len() > Self::MAX_COATS {
            let found = format_args!("{} values long", self.coats.len()).to_string();
            return Err(DownError::range("coats", found, "at most 8 values"));
        }
        for (i, coat) in self.coats.iter().enumerate() {
            if coat.hairs > 20_000 {
                let field = format!("coats[{i}].hairs");
                return Err(DownError::range(field, coat.hairs, "0 to 20000"));
            }
            rising(&format!("coats[{i}].radius"), coat.radius, (0.02, 4.0))?;
            rising(&format!("coats[{i}].length"), coat.length, (0.05, 1.0))?;
            inside(&format!("coats[{i}].curl"), coat.curl, 0.0, 64.0)?;
        }
        Ok(())
    }

    /// Width of the periodic tile on the skin, metres: eight clumps.
    pub fn tile_metres(&self) -> f32 {
        8.0e-3 * self.clump_mm
    }
}
