//! Reading, writing and checking of a [`Feather`]. Nothing here panics, whatever the bytes.

use super::{Contour, Feather, FeatherError, Pattern, Rachis, Vane};
use crate::scattering::{Fibre, FibreKind, Optics};
use serde::Deserialize;

/// Only the version: read first, so that a file of another version is not called malformed.
#[derive(Deserialize)]
#[serde(rename = "Feather")]
struct Header {
    version: u32,
}

fn syntax(path: &str, error: ron::error::SpannedError) -> FeatherError {
    FeatherError::Syntax {
        file: path.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        message: error.code.to_string(),
    }
}

fn inside(field: &str, value: f32, low: f32, high: f32) -> Result<(), FeatherError> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    Err(FeatherError::range(
        field,
        value,
        format_args!("{low} to {high}"),
    ))
}

fn all_inside(field: &str, values: &[f32], low: f32, high: f32) -> Result<(), FeatherError> {
    values
        .iter()
        .enumerate()
        .try_for_each(|(i, &value)| inside(&format!("{field}[{i}]"), value, low, high))
}

fn counted(field: &str, count: usize, low: usize, high: usize) -> Result<(), FeatherError> {
    if (low..=high).contains(&count) {
        return Ok(());
    }
    Err(FeatherError::range(
        field,
        format_args!("{count} values long"),
        format_args!("{low} to {high} values"),
    ))
}

impl Feather {
    /// Largest file read, in bytes.
    pub const MAX_BYTES: usize = 4 << 20;

    /// Parses and validates a feather file; `path` is only for messages.
    pub fn from_ron(bytes: &[u8], path: &str) -> Result<Self, FeatherError> {
        if bytes.len() > Self::MAX_BYTES {
            return Err(FeatherError::TooLarge {
                file: path.to_owned(),
                bytes: bytes.len(),
                limit: Self::MAX_BYTES,
            });
        }
        if let Ok(Header { version }) = ron::de::from_bytes(bytes) {
            check_version(version).map_err(|error| error.in_file(path))?;
        }
        let feather: Self = ron::de::from_bytes(bytes).map_err(|error| syntax(path, error))?;
        feather.validate().map_err(|error| error.in_file(path))?;
        Ok(feather)
    }

    /// The text of a feather file. Fails on a feather that could not be read back.
    pub fn to_ron(&self) -> Result<String, FeatherError> {
        self.validate()?;
        let style = ron::ser::PrettyConfig::new()
            .new_line("\n")
            .compact_arrays(true);
        let mut text =
            ron::ser::to_string_pretty(self, style).map_err(|error| FeatherError::Io {
                file: self.name.clone(),
                message: error.to_string(),
            })?;
        text.push('\n');
        if text.len() > Self::MAX_BYTES {
            return Err(FeatherError::TooLarge {
                file: self.name.clone(),
                bytes: text.len(),
                limit: Self::MAX_BYTES,
            });
        }
        Ok(text)
    }

    /// Checks every value against the range documented at its field. The error's `file` is the feather's name.
    pub fn validate(&self) -> Result<(), FeatherError> {
        self.check().map_err(|error| error.in_file(&self.name))
    }

    fn check(&self) -> Result<(), FeatherError> {
        check_version(self.version)?;
        counted("name", self.name.len(), 1, 256)?;
        inside("length_mm", self.length_mm, 0.1, 5000.0)?;
        inside("aspect", self.aspect, 0.01, 2.0)?;
        self.contour.check()?;
        self.rachis.check()?;
        self.left.check("left")?;
        self.right.check("right")?;
        if self.gaps.count > 64 {
            return Err(FeatherError::range(
                "gaps.count",
                self.gaps.count,
                "0 to 64",
            ));
        }
        inside("gaps.width", self.gaps.width, 0.0, 0.2)?;
        inside("gaps.depth", self.gaps.depth, 0.0, 1.0)?;
        self.albedo.front.check("albedo.front")?;
        if let Some(back) = &self.albedo.back {
            back.check("albedo.back")?;
        }
        let share = self.albedo.share;
        inside("albedo.share.rachis", share.rachis, 0.0, 4.0)?;
        inside("albedo.share.barb", share.barb, 0.0, 4.0)?;
        inside("albedo.share.barbule", share.barbule, 0.0, 4.0)?;
        if let Some(image) = &self.albedo.image {
            counted("albedo.image", image.len(), 1, 1024)?;
        }
        check_optics(&self.optics)
    }
}

fn check_version(found: u32) -> Result<(), FeatherError> {
    let hint = match found.cmp(&Feather::VERSION) {
        std::cmp::Ordering::Equal => return Ok(()),
        std::cmp::Ordering::Greater => "written by a newer bevy_plumage: update the crate",
        std::cmp::Ordering::Less => "too old: write it anew",
    };
    Err(FeatherError::Version {
        file: String::new(),
        found,
        supported: Feather::VERSION,
        hint,
    })
}

impl Contour {
    fn check(&self) -> Result<(), FeatherError> {
        inside("contour.start", self.start, 0.0, 0.9)?;
        for (field, reach) in [("contour.left", &self.left), ("contour.right", &self.right)] {
            counted(field, reach.len(), 2, 1024)?;
            all_inside(field, reach, 0.0, 2.0)?;
        }
        Ok(())
    }
}

impl Rachis {
    fn check(&self) -> Result<(), FeatherError> {
        counted("rachis.curve", self.curve.len(), 2, 64)?;
        all_inside("rachis.curve", &self.curve, -0.5, 1.5)?;
        all_inside("rachis.radius_mm", &self.radius_mm, 0.0, 50.0)
    }
}

impl Vane {
    fn check(&self, side: &str) -> Result<(), FeatherError> {
        let at =
            |field: &str, value, low, high| inside(&format!("{side}.{field}"), value, low, high);
        at("barb_count", self.barb_count, 4.0, 5000.0)?;
        at("barb_angle", self.barb_angle, 5.0, 85.0)?;
        at("barb_radius_um", self.barb_radius_um, 0.1, 2000.0)?;
        at("barbules.spacing_um", self.barbules.spacing_um, 1.0, 5000.0)?;
        at("barbules.angle", self.barbules.angle, 10.0, 80.0)?;
        at(
            "barbules.distal_radius_um",
            self.barbules.distal_radius_um,
            0.05,
            500.0,
        )?;
        at(
            "barbules.proximal_radius_um",
            self.barbules.proximal_radius_um,
            0.05,
            500.0,
        )?;
        at("fringe", self.fringe, 0.0, 1.0)?;
        at("downy", self.downy, 0.0, 1.0)
    }
}

impl Pattern {
    fn check(&self, face: &str) -> Result<(), FeatherError> {
        let colour = |field: String, rgb: &[f32; 3]| all_inside(&field, rgb, 0.0, 1.0);
        counted(&format!("{face}.stops"), self.stops.len(), 1, 16)?;
        let mut last = 0.0;
        for (i, (v, rgb, tint)) in self.stops.iter().enumerate() {
            inside(&format!("{face}.stops[{i}].v"), *v, last, 1.0)?;
            last = *v;
            colour(format!("{face}.stops[{i}].colour"), rgb)?;
            inside(&format!("{face}.stops[{i}].tint"), *tint, 0.0, 1.0)?;
        }
        if let Some((width, rgb, tint)) = &self.rim {
            inside(&format!("{face}.rim.width"), *width, 0.0, 1.0)?;
            colour(format!("{face}.rim.colour"), rgb)?;
            inside(&format!("{face}.rim.tint"), *tint, 0.0, 1.0)?;
        }
        if let Some((count, rgb, share, waviness)) = &self.bars {
            inside(&format!("{face}.bars.count"), *count, 0.0, 200.0)?;
            colour(format!("{face}.bars.colour"), rgb)?;
            inside(&format!("{face}.bars.share"), *share, 0.0, 1.0)?;
            inside(&format!("{face}.bars.waviness"), *waviness, 0.0, 1.0)?;
        }
        inside(&format!("{face}.mottle"), self.mottle, 0.0, 1.0)
    }
}

fn check_optics(optics: &Optics) -> Result<(), FeatherError> {
    let fibres = [
        ("rachis", &optics.rachis),
        ("barb", &optics.barb),
        ("distal", &optics.distal),
        ("proximal", &optics.proximal),
    ];
    for (name, fibre) in fibres {
        check_fibre(&format!("optics.{name}"), fibre)?;
    }
    inside("optics.sheen.strength", optics.sheen.strength, 0.0, 1.0)?;
    inside("optics.sheen.roughness", optics.sheen.roughness, 0.1, 1.0)
}

fn check_fibre(path: &str, fibre: &Fibre) -> Result<(), FeatherError> {
    let at = |field: &str, value, low, high| inside(&format!("{path}.{field}"), value, low, high);
    match fibre.kind {
        FibreKind::Structural { core_radius } => at("kind.core_radius", core_radius, 0.0, 1.0)?,
        FibreKind::Pigment {
            medulla_radius,
            scattering,
            anisotropy,
        } => {
            at("kind.medulla_radius", medulla_radius, 0.3, 0.95)?;
            at("kind.scattering", scattering, 0.25, 8.0)?;
            at("kind.anisotropy", anisotropy, 0.0, 0.85)?;
        }
    }
    at("eta", fibre.eta, 1.3, 2.0)?;
    at(
        "longitudinal_roughness",
        fibre.longitudinal_roughness,
        0.05,
        0.8,
    )?;
    at("azimuthal_roughness", fibre.azimuthal_roughness, 0.2, 1.0)?;
    at("tilt", fibre.tilt, -0.2, 0.2)?;
    at("aspect", fibre.aspect, 0.2, 1.0)
}
