//! What an extraction returns.

use super::{Confidence, ExtractError};
use crate::{anatomy::Feather, asset::RonAsset};
use bevy::math::Vec2;
use image::{GrayImage, RgbaImage};
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// One of the objects in a photograph, in its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoObject {
    /// Middle of its area.
    pub center: Vec2,
    /// Upper left corner of the box around it.
    pub low: Vec2,
    /// Lower right corner.
    pub high: Vec2,
}

impl fmt::Display for PhotoObject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (center, size) = (self.center, self.high - self.low);
        write!(
            f,
            "at ({:.0}, {:.0}) of {:.0} x {:.0} pixels",
            center.x, center.y, size.x, size.y
        )
    }
}

/// Barbs of one vane as the photograph shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarbMeasure {
    /// alpha_b in canonical space (against the straightened shaft) in radians, the median over the vane.
    pub angle: f32,
    /// Interquartile range of the angle over the vane, radians.
    pub spread: f32,
    /// Barbs per feather length along the rachis, where the photograph resolves them.
    pub count: Option<f32>,
    /// Coherence of the structure tensor, 0..1, the mean over the vane.
    pub coherence: f32,
}

/// Where the feather's UV rectangle lies in the photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardFrame {
    /// Pixel of `uv = (0, 0)` .
    pub origin: Vec2,
    /// Pixels from u = 0 to u = 1.
    pub u: Vec2,
    /// Pixels from v = 0 (base) to v = 1 (tip).
    pub v: Vec2,
}

impl CardFrame {
    /// Pixel at `uv`.
    pub fn pixel(&self, uv: Vec2) -> Vec2 {
        self.origin + self.u * uv.x + self.v * uv.y
    }

    /// `uv` of a pixel.
    pub fn uv(&self, pixel: Vec2) -> Vec2 {
        let from = pixel - self.origin;
        let determinant = self.u.perp_dot(self.v);
        if determinant.abs() < 1e-12 {
            return Vec2::ZERO;
        }
        Vec2::new(from.perp_dot(self.v), self.u.perp_dot(from)) / determinant
    }
}

/// The score map S of Eq. 1.
#[derive(Clone, Debug)]
pub struct ScoreMap {
    /// S scaled to 0..255.
    pub image: GrayImage,
    /// Pixel of the photograph at the map's outer corner.
    pub origin: Vec2,
    /// Unit vector of the map's x axis in the photograph; its y axis is a quarter turn on.
    pub axis: Vec2,
    /// Pixels of the photograph per pixel of the map.
    pub scale: f32,
}

/// A feather and the evidence for it.
#[derive(Clone, Debug)]
pub struct Extraction {
    /// The asset. `albedo.image` names the file that [`Extraction::write`] writes.
    pub feather: Feather,
    /// Color over the UV rectangle, sRGB, opaque; row 0 is v = 0 (the skin), column 0 is u = 0, as the plugin reads it.
    pub albedo: RgbaImage,
    /// 255 on the feather, 0 beside it, as large as the photograph.
    pub mask: GrayImage,
    /// Outline, closed, at equal steps.
    pub contour: Vec<Vec2>,
    /// Centre line of the shaft from base to tip, at equal steps.
    pub rachis: Vec<Vec2>,
    /// Score map that the shaft was found in.
    pub score: ScoreMap,
    /// Barbs of the left and right vane, where directions are visible.
    pub barbs: [Option<BarbMeasure>; 2],
    /// Where the card lies in the photograph.
    pub frame: CardFrame,
    /// What to trust.
    pub confidence: Confidence,
}

impl Extraction {
    /// Writes `NAME.feather.ron` and `NAME_albedo.png` into a directory that exists; returns both paths. NAME is the feather's.
    pub fn write(&self, directory: &Path) -> Result<[PathBuf; 2], ExtractError> {
        let picture = format!("{}_albedo.png", self.feather.name);
        let paths = [
            directory.join(format!("{}.feather.ron", self.feather.name)),
            directory.join(&picture),
        ];
        self.albedo
            .save_with_format(&paths[1], image::ImageFormat::Png)
            .map_err(|error| ExtractError::Io {
                file: paths[1].display().to_string(),
                message: error.to_string(),
            })?;
        let mut feather = self.feather.clone();
        feather.albedo.image = Some(picture);
        feather.write(&paths[0])?;
        Ok(paths)
    }
}
