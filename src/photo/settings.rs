//! What the caller may say about a photograph, and what it hears while it waits.

use super::{ExtractError, MAX_SIDE};
use serde::{Deserialize, Serialize};

/// Which face of the feather the camera saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Face {
    /// The face that looks away from the body: left in the picture (tip up) is the left vane.
    #[default]
    Front,
    /// The face towards the body: left in the picture (tip up) is the right vane.
    Back,
}

/// How barbs and their shadows are taken out of the color.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AlbedoFilter {
    /// A Gaussian, as in the paper. Blurs the borders of patterns.
    LowPass,
    /// A low-pass that stops at borders of patterns (guided by a smoothed copy of the picture).
    #[default]
    EdgeAware,
}

/// Which object of a photograph is the feather.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum ObjectChoice {
    /// The only one; several of comparable size are an error that lists them ([`ExtractError::SeveralObjects`]).
    #[default]
    Only,
    /// The one of this number, counted from 1 and from left to right as that error lists them.
    Number(u32),
    /// The one at, or next to, a point in pixels of the photograph, `x` to the right and `y` down.
    At([f32; 2]),
}

/// Settings of [`extract`](super::extract).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExtractSettings {
    /// Name of the feather and of its files, 1..128 bytes without `/` and `\\`. The asset loader puts the file's name in place of
    /// the default.
    pub name: String,
    /// Which face the photograph shows.
    pub face: Face,
    /// Which object is the feather, where several lie in the picture.
    pub object: ObjectChoice,
    /// Length of the feather from quill to tip in millimetres, 0.1..5000. Without it a length typical of a flight feather is
    /// taken and flagged.
    pub length_mm: Option<f32>,
    /// Longest side of the feather's surroundings in pixels while it is analysed, 256..4096. Smaller pictures are enlarged at
    /// most twice.
    pub resolution: u32,
    /// How the color is smoothed.
    pub albedo: AlbedoFilter,
    /// Standard deviation of the color's low-pass, as a share of the feather's length, 0.0005..0.05.
    pub albedo_sigma: f32,
    /// Height of the albedo image in pixels, 32..2048; its width follows from the feather's aspect.
    pub albedo_height: u32,
    /// Samples of each vane's reach in the asset, 16..1024.
    pub contour_samples: u32,
    /// The alpha channel, where the picture has one that is not opaque throughout, is the mask.
    pub use_alpha: bool,
    /// Seed of the extracted feather's noise (splits).
    pub seed: u32,
}

impl Default for ExtractSettings {
    fn default() -> Self {
        Self {
            name: "photograph".to_owned(),
            face: Face::Front,
            object: ObjectChoice::Only,
            length_mm: None,
            resolution: 1200,
            albedo: AlbedoFilter::EdgeAware,
            albedo_sigma: 0.006,
            albedo_height: 512,
            contour_samples: 256,
            use_alpha: true,
            seed: 1,
        }
    }
}

impl ExtractSettings {
    /// Checks every value against its range.
    pub fn check(&self) -> Result<(), ExtractError> {
        let inside = |field: &'static str, value: f64, low: f64, high: f64| {
            if value.is_finite() && (low..=high).contains(&value) {
                return Ok(());
            }
            Err(ExtractError::Setting {
                field,
                value,
                low,
                high,
            })
        };
        if self.name.contains(['/', '\\']) || self.name.starts_with('.') {
            return Err(ExtractError::Name {
                name: self.name.clone(),
            });
        }
        inside("name.len()", self.name.len() as f64, 1.0, 128.0)?;
        if let Some(length) = self.length_mm {
            inside("length_mm", f64::from(length), 0.1, 5000.0)?;
        }
        if let ObjectChoice::At(place) = self.object {
            for at in place {
                inside("object", f64::from(at), 0.0, f64::from(MAX_SIDE))?;
            }
        }
        inside("resolution", f64::from(self.resolution), 256.0, 4096.0)?;
        inside("albedo_sigma", f64::from(self.albedo_sigma), 0.0005, 0.05)?;
        inside("albedo_height", f64::from(self.albedo_height), 32.0, 2048.0)?;
        inside(
            "contour_samples",
            f64::from(self.contour_samples),
            16.0,
            1024.0,
        )
    }
}

/// One step of an extraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Resolution, noise, contrast.
    Prepare,
    /// Feather or background.
    Segment,
    /// Outline.
    Contour,
    /// Score map and shaft.
    Rachis,
    /// Barb angle and density.
    Barbs,
    /// Color.
    Albedo,
    /// The asset.
    Assemble,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 7] = [
        Self::Prepare,
        Self::Segment,
        Self::Contour,
        Self::Rachis,
        Self::Barbs,
        Self::Albedo,
        Self::Assemble,
    ];
}

/// Progress of an extraction: the stage that begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What begins.
    pub stage: Stage,
    /// Share of the stages done, 0..1.
    pub share: f32,
}

impl Progress {
    pub(super) fn begin(stage: Stage) -> Self {
        let done = Stage::ALL.iter().position(|&s| s == stage).unwrap_or(0);
        Self {
            stage,
            share: done as f32 / Stage::ALL.len() as f32,
        }
    }
}
