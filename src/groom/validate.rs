//! Reading, checking and writing of the [`Groom`] file.

use super::asset::{Groom, Guide, Jitter, Region, Row, Select, Span, Tint};
use super::error::GroomError;

/// Most feathers that one region may hold at density 1.
const MAX_COUNT: u32 = 200_000;

/// Most vertices of all cards together: 4 million take about 300 MB while they are made.
const MAX_VERTICES: f64 = 4.0e6;

/// Most touches of the brush.
const MAX_DABS: usize = 10_000;

/// Collects the path of a field while the asset is walked, and turns the first bad value into an error.
struct Check<'a> {
    file: &'a str,
}

impl Check<'_> {
    fn fail<T>(
        &self,
        field: String,
        value: impl ToString,
        range: impl ToString,
    ) -> Result<T, GroomError> {
        Err(GroomError::Value {
            file: self.file.into(),
            field,
            value: value.to_string(),
            range: range.to_string(),
        })
    }

    fn within(
        &self,
        field: impl Into<String>,
        value: f32,
        low: f32,
        high: f32,
    ) -> Result<(), GroomError> {
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(());
        }
        self.fail(field.into(), value, format!("{low}..={high}"))
    }

    fn finite(&self, field: impl Into<String>, values: &[f32]) -> Result<(), GroomError> {
        match values
            .iter()
            .find(|value| !value.is_finite() || value.abs() > 1.0e9)
        {
            None => Ok(()),
            Some(value) => self.fail(field.into(), value, "a finite number below 1e9"),
        }
    }

    fn span(&self, field: &str, span: Span, low: f32, high: f32) -> Result<(), GroomError> {
        self.within(format!("{field}.0"), span.0, low, high)?;
        self.within(format!("{field}.1"), span.1, low, high)
    }

    fn segments(&self, field: &str, segments: (u8, u8)) -> Result<(), GroomError> {
        self.within(
            format!("{field}.segments.0"),
            f32::from(segments.0),
            1.0,
            64.0,
        )?;
        self.within(
            format!("{field}.segments.1"),
            f32::from(segments.1),
            1.0,
            16.0,
        )
    }

    fn tint(&self, field: &str, tint: Tint) -> Result<(), GroomError> {
        for value in tint.0.into_iter().chain(tint.1) {
            self.within(format!("{field}.tint"), value, 0.0, 1.0)?;
        }
        Ok(())
    }

    fn jitter(&self, field: &str, jitter: Jitter) -> Result<(), GroomError> {
        self.within(format!("{field}.jitter.length"), jitter.length, 0.0, 0.25)?;
        self.within(format!("{field}.jitter.width"), jitter.width, 0.0, 0.25)?;
        self.within(format!("{field}.jitter.yaw"), jitter.yaw, 0.0, 45.0)?;
        self.within(format!("{field}.jitter.roll"), jitter.roll, 0.0, 45.0)?;
        self.within(format!("{field}.jitter.lift"), jitter.lift, 0.0, 45.0)?;
        self.within(format!("{field}.jitter.hue"), jitter.hue, 0.0, 180.0)?;
        self.within(format!("{field}.jitter.value"), jitter.value, 0.0, 0.25)
    }

    fn feather(&self, field: &str, feather: u16, count: usize) -> Result<(), GroomError> {
        if usize::from(feather) < count {
            return Ok(());
        }
        self.fail(
            format!("{field}.feather"),
            feather,
            format!("an index below {count} (the length of feathers)"),
        )
    }

    fn select(&self, field: &str, select: &Select) -> Result<(), GroomError> {
        match select {
            Select::Color(color, distance) => {
                self.finite(format!("{field}.Color"), color)?;
                self.within(format!("{field}.Color.1"), *distance, 0.0, 10.0)
            }
            Select::Nearest(color, others) => {
                self.finite(format!("{field}.Nearest"), color)?;
                let other = |color: &[f32; 3]| self.finite(format!("{field}.Nearest.1"), color);
                others.iter().try_for_each(other)
            }
            Select::Within(low, high) => {
                self.finite(format!("{field}.Within"), low)?;
                self.finite(format!("{field}.Within"), high)
            }
            Select::Any(list) | Select::Every(list) => {
                list.iter().try_for_each(|inner| self.select(field, inner))
            }
            Select::Not(inner) => self.select(field, inner),
            Select::All | Select::Tract(_) | Select::Joints(_) => Ok(()),
        }
    }

    fn region(&self, field: &str, region: &Region, feathers: usize) -> Result<(), GroomError> {
        self.select(&format!("{field}.select"), &region.select)?;
        self.feather(field, region.feather, feathers)?;
        if region.count > MAX_COUNT {
            return self.fail(
                format!("{field}.count"),
                region.count,
                format!("0..={MAX_COUNT}"),
            );
        }
        if let super::asset::Placement::Rows(rows) = region.placement
            && !(1..=10_000).contains(&rows)
        {
            return self.fail(format!("{field}.placement.Rows"), rows, "1..=10000");
        }
        self.span(&format!("{field}.length"), region.length, 1.0e-6, 1.0e6)?;
        self.span(&format!("{field}.width"), region.width, 1.0e-6, 1.0e6)?;
        self.span(&format!("{field}.lift"), region.lift, -30.0, 89.0)?;
        self.within(format!("{field}.camber"), region.camber, 0.0, 0.5)?;
        self.within(format!("{field}.curl"), region.curl, -180.0, 180.0)?;
        self.within(format!("{field}.stiffness"), region.stiffness, 0.0, 1.0)?;
        self.within(format!("{field}.layer"), region.layer, -1.0e4, 1.0e4)?;
        self.segments(field, region.segments)?;
        self.tint(field, region.tint)?;
        self.jitter(field, region.jitter)
    }

    fn guide(&self, field: &str, guide: &Guide, regions: &[Region]) -> Result<(), GroomError> {
        if guide.points.len() < 2 || guide.points.len() > 4096 {
            return self.fail(
                format!("{field}.points"),
                format!("{} points", guide.points.len()),
                "2..=4096 points",
            );
        }
        for (i, point) in guide.points.iter().enumerate() {
            self.finite(format!("{field}.points[{i}]"), point)?;
        }
        for name in &guide.regions {
            if !regions.iter().any(|region| &region.name == name) {
                return self.fail(
                    format!("{field}.regions"),
                    format!("{name:?}"),
                    "the name of a region",
                );
            }
        }
        Ok(())
    }

    fn row(&self, field: &str, row: &Row, feathers: usize) -> Result<(), GroomError> {
        self.feather(field, row.feather, feathers)?;
        if row.lengths.is_empty() || row.lengths.len() > 512 {
            return self.fail(
                format!("{field}.lengths"),
                format!("{} values", row.lengths.len()),
                "1..=512 values",
            );
        }
        for (i, length) in row.lengths.iter().enumerate() {
            self.within(format!("{field}.lengths[{i}]"), *length, 1.0e-6, 1.0e6)?;
        }
        self.span(&format!("{field}.width"), row.width, 1.0e-6, 1.0e6)?;
        if row.stations.len() < 2 {
            return self.fail(
                format!("{field}.stations"),
                format!("{} stations", row.stations.len()),
                "2 or more stations",
            );
        }
        let mut before = f32::NEG_INFINITY;
        for (i, station) in row.stations.iter().enumerate() {
            let field = format!("{field}.stations[{i}]");
            self.within(format!("{field}.at"), station.at, 0.0, 1.0)?;
            if station.at <= before {
                return self.fail(
                    format!("{field}.at"),
                    station.at,
                    format!("more than the station before ({before})"),
                );
            }
            before = station.at;
            self.finite(format!("{field}.root"), &station.root)?;
            for (name, vector) in [("direction", station.direction), ("normal", station.normal)] {
                self.finite(format!("{field}.{name}"), &vector)?;
                if vector.iter().map(|x| x * x).sum::<f32>() < 1.0e-12 {
                    return self.fail(
                        format!("{field}.{name}"),
                        format!("{vector:?}"),
                        "a vector longer than 1e-6",
                    );
                }
            }
            for (name, weights) in [("ride", &station.ride), ("follow", &station.follow)] {
                for (joint, weight) in weights {
                    self.within(format!("{field}.{name}.{joint}"), *weight, 0.0, 1.0e3)?;
                }
            }
        }
        self.span(&format!("{field}.lift"), row.lift, -89.0, 89.0)?;
        self.within(format!("{field}.camber"), row.camber, 0.0, 0.5)?;
        self.within(format!("{field}.curl"), row.curl, -180.0, 180.0)?;
        self.span(&format!("{field}.layer"), row.layer, -1.0e4, 1.0e4)?;
        self.within(format!("{field}.offset"), row.offset, -1.0e3, 1.0e3)?;
        self.segments(field, row.segments)?;
        self.tint(field, row.tint)?;
        self.jitter(field, row.jitter)
    }
}

impl Groom {
    /// Reads a groom from RON text and checks it. `file` names it in errors.
    ///
    /// # Errors
    /// [`GroomError::Parse`] with line and column, or what [`Groom::validate`] finds.
    pub fn from_ron(text: &str, file: &str) -> Result<Self, GroomError> {
        let groom: Self = ron::from_str(text).map_err(|error| GroomError::Parse {
            file: file.into(),
            line: error.span.start.line,
            column: error.span.start.col,
            message: error.code.to_string(),
        })?;
        groom.validate(file)?;
        Ok(groom)
    }

    /// Writes the groom as RON text that [`Groom::from_ron`] reads back to the same value.
    ///
    /// # Errors
    /// [`GroomError::Write`] if a value has no text form.
    pub fn to_ron(&self, file: &str) -> Result<String, GroomError> {
        let config = ron::ser::PrettyConfig::new().depth_limit(4);
        ron::ser::to_string_pretty(self, config).map_err(|error| GroomError::Write {
            file: file.into(),
            message: error.to_string(),
        })
    }

    /// Checks every field. `file` names the groom in errors.
    ///
    /// # Errors
    /// [`GroomError::Value`] for the first field that is out of range.
    pub fn validate(&self, file: &str) -> Result<(), GroomError> {
        let check = Check { file };
        if self.version != Self::VERSION {
            return check.fail("version".into(), self.version, Self::VERSION);
        }
        check.within("unit", self.unit, 1.0e-9, 1.0e9)?;
        if self.feathers.len() > 4096 {
            return check.fail(
                "feathers".into(),
                format!("{} paths", self.feathers.len()),
                "0..=4096 paths",
            );
        }
        if self.regions.len() + self.rows.len() > 4096 {
            let found = self.regions.len() + self.rows.len();
            return check.fail("regions and rows".into(), found, "4096 together");
        }
        for (i, path) in self.feathers.iter().enumerate() {
            if path.is_empty() {
                return check.fail(format!("feathers[{i}]"), "\"\"", "an asset path");
            }
        }
        for (i, region) in self.regions.iter().enumerate() {
            check.region(&format!("regions[{i}]"), region, self.feathers.len())?;
        }
        for (i, guide) in self.guides.iter().enumerate() {
            check.guide(&format!("guides[{i}]"), guide, &self.regions)?;
        }
        for (i, row) in self.rows.iter().enumerate() {
            check.row(&format!("rows[{i}]"), row, self.feathers.len())?;
        }
        if self.paint.len() > MAX_DABS {
            let found = format!("{} dabs", self.paint.len());
            return check.fail("paint".into(), found, format!("0..={MAX_DABS} dabs"));
        }
        for (i, dab) in self.paint.iter().enumerate() {
            check.finite(format!("paint[{i}].at"), &dab.at)?;
            check.within(format!("paint[{i}].radius"), dab.radius, 1.0e-6, 1.0e6)?;
            check.within(format!("paint[{i}].density"), dab.density, 0.0, 4.0)?;
            check.within(format!("paint[{i}].length"), dab.length, 0.05, 4.0)?;
        }
        self.check_size(file, 1.0)
    }

    /// Whether the cards fit into memory at a density.
    pub(super) fn check_size(&self, file: &str, density: f32) -> Result<(), GroomError> {
        let grid = |(along, across): (u8, u8)| (f64::from(along) + 1.0) * (f64::from(across) + 1.0);
        let scattered: f64 = self
            .regions
            .iter()
            .map(|region| f64::from(region.count) * grid(region.segments))
            .sum();
        let rows: f64 = self
            .rows
            .iter()
            .map(|row| 2.0 * row.lengths.len() as f64 * grid(row.segments))
            .sum();
        let found = scattered * f64::from(density) + rows;
        if found > MAX_VERTICES {
            return Check { file }.fail(
                "regions and rows".into(),
                format!("{found} vertices (counts times segments times density {density})"),
                format!("0..={MAX_VERTICES}"),
            );
        }
        Ok(())
    }
}
