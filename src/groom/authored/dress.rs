//! A groom with what the file of the skin adds to it.

use super::{Authored, AuthoredRow, AuthoredStation};
use crate::groom::asset::{Groom, Guide, JointWeight, Row, Segments, Span, Station};
use bevy::math::Vec3;

/// Width over length of a feather whose row does not say.
const WIDTH: f32 = 0.22;

impl Authored {
    /// Adds guides and rows; a row that the groom has already gets the file's stations. What cannot be used is said in `notes`.
    pub(in crate::groom) fn dress(&self, groom: &mut Groom, notes: &mut Vec<String>) {
        let unit = groom.unit;
        for guide in &self.guides {
            let points = guide.points.iter();
            let points: Vec<[f32; 3]> = points.map(|point| (*point / unit).to_array()).collect();
            groom.guides.push(Guide {
                mirror: guide.mirror,
                regions: guide.regions.clone(),
                ..Guide::new(points)
            });
        }
        for row in &self.rows {
            if let Err(note) = row.dress(groom) {
                notes.push(format!(
                    "{}: row {:?} of the file: {note}",
                    groom.name, row.name
                ));
            }
        }
    }
}

impl AuthoredRow {
    fn dress(&self, groom: &mut Groom) -> Result<(), String> {
        let unit = groom.unit;
        if self.stations.len() < 2 {
            let (name, count) = (&self.name, self.stations.len());
            return Err(format!(
                "{count} nodes named row.{name}.NUMBER, at least 2 are wanted: left out"
            ));
        }
        let stations = self.stations.iter().map(|station| station.of(unit));
        let stations: Vec<Station> = stations.collect();
        let known = groom.rows.iter().position(|row| row.name == self.name);
        let at = match known {
            Some(at) => at,
            None if self.lengths.is_empty() => {
                return Err(format!(
                    "the node row.{} has no extra `lengths` (metres, one a feather): left out",
                    self.name
                ));
            }
            None => {
                let mut row = Row::new(self.name.clone(), Vec::new(), Vec::new());
                let ends = [self.lengths.first(), self.lengths.last()];
                let [first, last] = ends.map(|length| length.map_or(0.0, |x| x * WIDTH / unit));
                row.width = Span(first, last);
                row.segments = Segments::new(6, 4);
                row.layer = Span(3.0, 2.0);
                row.skin_color = 1.0;
                groom.rows.push(row);
                groom.rows.len() - 1
            }
        };
        let row = &mut groom.rows[at];
        row.stations = stations;
        if !self.lengths.is_empty() {
            row.lengths = self.lengths.iter().map(|length| length / unit).collect();
        }
        if let Some([first, last]) = self.width {
            row.width = Span(first / unit, last / unit);
        }
        row.mirror = self.mirror.unwrap_or(row.mirror);
        row.feather = self.feather.unwrap_or(row.feather);
        Ok(())
    }
}

impl AuthoredStation {
    fn of(&self, unit: f32) -> Station {
        let list = |joints: &[(String, f32)]| {
            let joints = joints.iter();
            joints
                .map(|(joint, weight)| JointWeight::new(joint.clone(), *weight))
                .collect()
        };
        let vector = |v: Vec3| v.normalize_or_zero().to_array();
        let mut station = Station::new(
            self.at.unwrap_or(0.0),
            (self.root / unit).to_array(),
            vector(self.direction),
            vector(self.normal),
        );
        station.ride = list(&self.ride);
        station.follow = list(&self.follow);
        station
    }
}
