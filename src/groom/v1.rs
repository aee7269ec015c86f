//! Version 1 of the groom file, read only. The spelling of its fields is part of the format.

use super::asset::{self, Dab, Guide, Jitter, JointWeight, Placement, Segments, Span, Tint};
use crate::asset::RonAsset;
use serde::Deserialize;

/// A groom whose segments, weights and selections are tuples.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Groom {
    #[serde(rename = "version")]
    _version: u32,
    name: String,
    unit: f32,
    feathers: Vec<String>,
    regions: Vec<Region>,
    guides: Vec<Guide>,
    rows: Vec<Row>,
    #[serde(default)]
    paint: Vec<Dab>,
}

#[derive(Deserialize)]
enum Select {
    All,
    Tract(u32),
    /// Color, distance.
    Color([f32; 3], f32),
    /// Color, others.
    Nearest([f32; 3], Vec<[f32; 3]>),
    Joints(Vec<String>),
    /// Smallest and largest coordinates.
    Within([f32; 3], [f32; 3]),
    Any(Vec<Select>),
    Every(Vec<Select>),
    Not(Box<Select>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Region {
    name: String,
    select: Select,
    feather: u16,
    count: u32,
    placement: Placement,
    length: Span,
    width: Span,
    lift: Span,
    camber: f32,
    curl: f32,
    stiffness: f32,
    layer: f32,
    /// Along, across.
    segments: (u8, u8),
    tint: Tint,
    #[serde(default)]
    jitter: Jitter,
    #[serde(default)]
    down: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Station {
    at: f32,
    root: [f32; 3],
    direction: [f32; 3],
    normal: [f32; 3],
    /// Joint, weight.
    ride: Vec<(String, f32)>,
    /// Joint, weight.
    follow: Vec<(String, f32)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    name: String,
    feather: u16,
    lengths: Vec<f32>,
    width: Span,
    stations: Vec<Station>,
    mirror: bool,
    #[serde(default)]
    handed: bool,
    lift: Span,
    camber: f32,
    curl: f32,
    layer: Span,
    offset: f32,
    /// Along, across.
    segments: (u8, u8),
    tint: Tint,
    #[serde(default)]
    jitter: Jitter,
}

impl From<Groom> for asset::Groom {
    fn from(old: Groom) -> Self {
        Self {
            version: Self::VERSION,
            name: old.name,
            unit: old.unit,
            feathers: old.feathers.into_iter().map(Into::into).collect(),
            regions: old.regions.into_iter().map(Into::into).collect(),
            guides: old.guides,
            rows: old.rows.into_iter().map(Into::into).collect(),
            paint: old.paint,
            masks: Vec::new(),
            poses: Vec::new(),
            bend: 0.0,
        }
    }
}

impl From<Select> for asset::Select {
    fn from(old: Select) -> Self {
        let all = |list: Vec<Select>| list.into_iter().map(Into::into).collect();
        match old {
            Select::All => Self::All,
            Select::Tract(number) => Self::Tract(number),
            Select::Color(color, distance) => Self::Color { color, distance },
            Select::Nearest(color, others) => Self::Nearest { color, others },
            Select::Joints(names) => Self::Joints(names),
            Select::Within(low, high) => Self::Within { low, high },
            Select::Any(list) => Self::Any(all(list)),
            Select::Every(list) => Self::Every(all(list)),
            Select::Not(inner) => Self::Not(match *inner {
                Select::Any(list) => all(list),
                other => vec![other.into()],
            }),
        }
    }
}

impl From<Region> for asset::Region {
    fn from(old: Region) -> Self {
        Self {
            name: old.name,
            select: old.select.into(),
            feather: old.feather,
            count: old.count,
            placement: old.placement,
            length: old.length,
            width: old.width,
            lift: old.lift,
            camber: old.camber,
            curl: old.curl,
            stiffness: old.stiffness,
            layer: old.layer,
            segments: Segments::new(old.segments.0, old.segments.1),
            tint: old.tint,
            skin_color: 0.0,
            jitter: old.jitter,
            down: old.down.map(Into::into),
        }
    }
}

impl From<Station> for asset::Station {
    fn from(old: Station) -> Self {
        let weights = |list: Vec<(String, f32)>| {
            list.into_iter()
                .map(|(joint, weight)| JointWeight { joint, weight })
                .collect()
        };
        Self {
            at: old.at,
            root: old.root,
            direction: old.direction,
            normal: old.normal,
            ride: weights(old.ride),
            follow: weights(old.follow),
        }
    }
}

impl From<Row> for asset::Row {
    fn from(old: Row) -> Self {
        Self {
            name: old.name,
            feather: old.feather,
            lengths: old.lengths,
            width: old.width,
            stations: old.stations.into_iter().map(Into::into).collect(),
            mirror: old.mirror,
            handed: old.handed,
            lift: old.lift,
            camber: old.camber,
            curl: old.curl,
            layer: old.layer,
            offset: old.offset,
            segments: Segments::new(old.segments.0, old.segments.1),
            tint: old.tint,
            skin_color: 0.0,
            jitter: old.jitter,
        }
    }
}
