//! The [`Groom`] file: version, dependencies, and what several of its fields must fulfil together.

use super::{
    asset::{Groom, Region, Row, Segments},
    v1,
};
use crate::asset::{AssetError, RonAsset, parse};
use bevy::asset::LoadContext;

/// Most vertices of all cards together: 4 million take about 300 MB while they are made.
const MAX_VERTICES: f64 = 4.0e6;

/// Most regions and rows together.
const MAX_PARTS: usize = 4096;

impl RonAsset for Groom {
    const NAME: &'static str = "Groom";
    const EXTENSION: &'static str = "groom.ron";
    const VERSION: u32 = 2;
    const OLDEST: u32 = 1;

    fn version(&self) -> u32 {
        self.version
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn migrate(_: u32, bytes: &[u8], file: &str) -> Result<Self, AssetError> {
        parse::<v1::Groom>(bytes, file).map(Self::from)
    }

    fn check_relations(&self) -> Result<(), AssetError> {
        let parts = self.regions.len() + self.rows.len();
        if parts > MAX_PARTS {
            let range = format_args!("{MAX_PARTS} together").to_string();
            return Err(AssetError::value("regions and rows", parts, range));
        }
        if let Some(i) = self.feathers.iter().position(|link| link.is_empty()) {
            let field = format_args!("feathers[{i}]").to_string();
            return Err(AssetError::value(field, "\"\"", "an asset path"));
        }
        for (i, region) in self.regions.iter().enumerate() {
            self.check_feather(&format!("regions[{i}]"), region.feather)?;
            if region.down.as_ref().is_some_and(|link| link.is_empty()) {
                let field = format!("regions[{i}].down");
                return Err(AssetError::value(field, "\"\"", "an asset path"));
            }
        }
        if let Some(i) = self.masks.iter().position(|mask| mask.texture.is_empty()) {
            let field = format_args!("masks[{i}].texture").to_string();
            return Err(AssetError::value(field, "\"\"", "an asset path"));
        }
        for (i, guide) in self.guides.iter().enumerate() {
            let known = |name: &String| self.regions.iter().any(|region| &region.name == name);
            if let Some(name) = guide.regions.iter().find(|name| !known(name)) {
                let (field, value) = (format!("guides[{i}].regions"), format!("{name:?}"));
                return Err(AssetError::value(field, value, "the name of a region"));
            }
        }
        for (i, row) in self.rows.iter().enumerate() {
            self.check_feather(&format!("rows[{i}]"), row.feather)?;
            row.check_stations(&format!("rows[{i}]"))?;
        }
        self.check_size(1.0)
    }

    fn load_dependencies(&mut self, context: &mut LoadContext<'_>) -> Result<(), AssetError> {
        for (i, feather) in self.feathers.iter_mut().enumerate() {
            feather.load_dependency(|| format!("feathers[{i}]"), context)?;
        }
        for (i, mask) in self.masks.iter_mut().enumerate() {
            let field = || format!("masks[{i}].texture");
            mask.texture.load_dependency(field, context)?;
        }
        for (i, region) in self.regions.iter_mut().enumerate() {
            if let Some(down) = &mut region.down {
                down.load_dependency(|| format!("regions[{i}].down"), context)?;
            }
        }
        Ok(())
    }
}

impl Groom {
    fn check_feather(&self, part: &str, feather: u16) -> Result<(), AssetError> {
        let count = self.feathers.len();
        if usize::from(feather) < count {
            return Ok(());
        }
        Err(AssetError::value(
            format_args!("{part}.feather"),
            feather,
            format_args!("an index below {count} (the length of feathers)"),
        ))
    }

    /// Whether the cards fit into memory at a density.
    pub(super) fn check_size(&self, density: f32) -> Result<(), AssetError> {
        let grid = |segments: Segments| f64::from(segments.vertices());
        let scattered = |region: &Region| f64::from(region.count) * grid(region.segments);
        let rows = |row: &Row| 2.0 * row.lengths.len() as f64 * grid(row.segments);
        let found = self.regions.iter().map(scattered).sum::<f64>() * f64::from(density)
            + self.rows.iter().map(rows).sum::<f64>();
        if found <= MAX_VERTICES {
            return Ok(());
        }
        Err(AssetError::value(
            "regions and rows",
            format_args!("{found} vertices (counts times segments times density {density})"),
            format_args!("0 to {MAX_VERTICES}"),
        ))
    }
}

impl Row {
    /// Stations rise, and their frames have directions.
    fn check_stations(&self, row: &str) -> Result<(), AssetError> {
        let mut before = f32::NEG_INFINITY;
        for (i, station) in self.stations.iter().enumerate() {
            let field = format!("{row}.stations[{i}]");
            if station.at <= before {
                return Err(AssetError::value(
                    format_args!("{field}.at"),
                    station.at,
                    format_args!("more than the station before ({before})"),
                ));
            }
            before = station.at;
            for (name, vector) in [("direction", station.direction), ("normal", station.normal)] {
                if vector.iter().map(|x| x * x).sum::<f32>() < 1.0e-12 {
                    return Err(AssetError::value(
                        format_args!("{field}.{name}"),
                        format_args!("{vector:?}"),
                        "a vector longer than 1e-6",
                    ));
                }
            }
        }
        Ok(())
    }
}
