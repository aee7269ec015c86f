//! The [`Groom`] asset: regions, guides and rows, all of them data.
//!
//! All positions and directions are in the model space of the skinned mesh in bind pose (glTF axes: +Y up, +Z forward, +X the
//! bird's left), in units of `unit` metres. Left and right: data is given for the left half; `mirror` repeats it with x negated
//! and joint names' `_L` turned into `_R`.

use crate::parameter::Parameter;
use bevy::{asset::Asset, reflect::Reflect};
use serde::{Deserialize, Serialize};

/// Where feathers grow on one kind of bird; file `*.groom.ron`.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Groom {
    /// Format version of the file, [`Groom::VERSION`].
    pub version: u32,
    /// Name shown to people.
    pub name: String,
    /// Metres per length unit of this file (0.001: millimetres).
    pub unit: f32,
    /// The feathers worn: asset paths, relative to this file.
    pub feathers: Vec<String>,
    /// Tracts of scattered feathers.
    pub regions: Vec<Region>,
    /// Strokes along the lay of the plumage, interpolated over the surface.
    pub guides: Vec<Guide>,
    /// Rows of feathers on bones: remiges, rectrices and their coverts.
    pub rows: Vec<Row>,
    /// Touches of a brush on the skin, laid over each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<Dab>,
}

/// One touch of a brush: factors on number and length of the feathers around a point, full in the middle, none at the rim.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dab {
    /// Middle, near the skin.
    pub at: [f32; 3],
    /// Distance at which it ends; above 0.
    pub radius: f32,
    /// Factor on the number of feathers, 0..4 (1 leaves it).
    pub density: f32,
    /// Factor on their length, 0.05..4 (1 leaves it).
    pub length: f32,
}

impl Dab {
    /// How much of the dab is felt at a point, 0..1.
    pub fn weight(&self, point: [f32; 3]) -> f32 {
        let square: f32 = point
            .iter()
            .zip(self.at)
            .map(|(a, b)| (a - b) * (a - b))
            .sum();
        let rest = 1.0 - square / (self.radius * self.radius).max(1.0e-12);
        if rest > 0.0 { rest * rest } else { 0.0 }
    }
}

/// Factors on number and length that all dabs leave at a point.
pub fn painted(dabs: &[Dab], point: [f32; 3]) -> (f32, f32) {
    dabs.iter().fold((1.0, 1.0), |(density, length), dab| {
        let weight = dab.weight(point);
        (
            density * (1.0 + weight * (dab.density - 1.0)),
            length * (1.0 + weight * (dab.length - 1.0)),
        )
    })
}

impl Groom {
    /// Version that this crate writes.
    pub const VERSION: u32 = 1;
}

/// A value over a tract: from its cranial end (phi 0) to its caudal end (phi 1).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
pub struct Span(pub f32, pub f32);

impl Span {
    /// Value at `phi` in 0..1.
    pub fn at(self, phi: f32) -> f32 {
        self.0 + (self.1 - self.0) * phi.clamp(0.0, 1.0)
    }
}

/// Which part of the skin a region is.
#[derive(Clone, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
pub enum Select {
    /// Everything.
    #[default]
    All,
    /// Triangles whose `TEXCOORD_1.x`, rounded, is this tract number.
    Tract(u32),
    /// Triangles whose vertex colour is within the distance of the colour (linear RGB, distance).
    Color([f32; 3], f32),
    /// Triangles whose vertex colour is nearer to the first colour than to any of the others (linear RGB).
    Nearest([f32; 3], Vec<[f32; 3]>),
    /// Triangles mostly carried by one of the joints named.
    Joints(Vec<String>),
    /// Triangles inside the box (minimum, maximum).
    Within([f32; 3], [f32; 3]),
    /// Any of these.
    Any(#[reflect(ignore)] Vec<Select>),
    /// All of these.
    Every(#[reflect(ignore)] Vec<Select>),
    /// Not this.
    Not(#[reflect(ignore)] Box<Select>),
}

/// How a region is filled.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
pub enum Placement {
    /// Blue noise, denser across the lay.
    Scatter,
    /// Staggered rows across the lay: this many.
    Rows(u32),
}

/// Spread of the random variation, one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Jitter {
    /// Relative length.
    #[reflect(@Parameter::new("", 0.0, 0.25))]
    pub length: f32,
    /// Relative width.
    #[reflect(@Parameter::new("", 0.0, 0.25))]
    pub width: f32,
    /// Degrees about the normal.
    #[reflect(@Parameter::degrees(0.0, 45.0))]
    pub yaw: f32,
    /// Degrees about the rachis.
    #[reflect(@Parameter::degrees(0.0, 45.0))]
    pub roll: f32,
    /// Degrees of lift.
    #[reflect(@Parameter::degrees(0.0, 45.0))]
    pub lift: f32,
    /// Hue, degrees.
    #[reflect(@Parameter::degrees(0.0, 180.0))]
    pub hue: f32,
    /// Value, relative.
    #[reflect(@Parameter::new("", 0.0, 0.25))]
    pub value: f32,
}

impl Default for Jitter {
    fn default() -> Self {
        Self {
            length: 0.06,
            width: 0.08,
            yaw: 3.0,
            roll: 4.0,
            lift: 1.0,
            hue: 2.0,
            value: 0.06,
        }
    }
}

/// Colour for the tintable parts of a feather's albedo, sRGB, over phi.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
pub struct Tint(pub [f32; 3], pub [f32; 3]);

/// One tract of scattered feathers.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Name; part of every feather's seed.
    pub name: String,
    /// Where on the skin. A region takes only what its predicate selects; regions may overlap (scapulars over the mantle).
    pub select: Select,
    /// Feather worn: index into [`Groom::feathers`].
    pub feather: u16,
    /// Number of feathers at density 1, both sides of the bird together.
    #[reflect(@Parameter::new("feathers", 0.0, 200000.0).logarithmic())]
    pub count: u32,
    /// How they are placed.
    pub placement: Placement,
    /// Visible length of a feather.
    pub length: Span,
    /// Width of a feather.
    pub width: Span,
    /// Angle of the rachis to the skin at the root, degrees.
    #[reflect(@Parameter::degrees(-30.0, 89.0))]
    pub lift: Span,
    /// Sagitta over width of the cross-section, 0..0.5.
    #[reflect(@Parameter::new("", 0.0, 0.5))]
    pub camber: f32,
    /// Bend along the rachis, degrees; positive: tip towards the body.
    #[reflect(@Parameter::degrees(-180.0, 180.0))]
    pub curl: f32,
    /// How far the card leaves the skin's curve for its own straight line, 0 (drapes) to 1 (stiff).
    #[reflect(@Parameter::share())]
    pub stiffness: f32,
    /// Layer key: of two regions that grow side by side the higher lies over the lower. Feathers rooted up the lay lie over those
    /// that they point to, in a region and across its border (see [`super::order`]).
    pub layer: f32,
    /// Segments along and columns across of a card.
    pub segments: (u8, u8),
    /// Colour.
    pub tint: Tint,
    /// Random variation.
    #[serde(default)]
    pub jitter: Jitter,
    /// Down below the feathers: asset path of a [`Down`](crate::down::Down), relative to this file. It shows where they leave the skin
    /// open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<String>,
}

/// A stroke along the lay, root to tip: at least two points near the skin.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guide {
    /// Points.
    pub points: Vec<[f32; 3]>,
    /// Repeat on the other side.
    #[serde(default)]
    pub mirror: bool,
    /// Only for the regions of these names (all when empty).
    #[serde(default)]
    pub regions: Vec<String>,
}

/// One end or bend of a row.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Station {
    /// Place along the row, 0..1; stations rise.
    pub at: f32,
    /// Root of the feather there.
    pub root: [f32; 3],
    /// Direction of the rachis there, root to tip.
    pub direction: [f32; 3],
    /// Normal of the front face there.
    pub normal: [f32; 3],
    /// Joints that carry the root, with weights.
    pub ride: Vec<(String, f32)>,
    /// Joints whose rotation (since bind pose) the feather follows, blended with these weights: this is what fans the row.
    pub follow: Vec<(String, f32)>,
}

/// A row of feathers on bones. Feather `i` of `n` stands at `i/(n-1)`, its frame interpolated between the stations.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Name; part of every feather's seed.
    pub name: String,
    /// Feather worn: index into [`Groom::feathers`].
    pub feather: u16,
    /// Length of each feather in order, one side; as many as there are feathers.
    pub lengths: Vec<f32>,
    /// Width of the first and the last.
    pub width: Span,
    /// Two or more.
    pub stations: Vec<Station>,
    /// Repeat on the other side.
    pub mirror: bool,
    /// The feather's left vane is the leading one on the left side of the bird (so the mirrored copy swaps its vanes).
    #[serde(default)]
    pub handed: bool,
    /// Angle to the row's plane, degrees.
    #[reflect(@Parameter::degrees(-89.0, 89.0))]
    pub lift: Span,
    /// Sagitta over width, 0..0.5.
    #[reflect(@Parameter::new("", 0.0, 0.5))]
    pub camber: f32,
    /// Bend along the rachis, degrees; positive: tip towards the body.
    #[reflect(@Parameter::degrees(-180.0, 180.0))]
    pub curl: f32,
    /// Layer key of the first and the last feather.
    pub layer: Span,
    /// Distance between the planes of neighbouring feathers along their normal, so that a closed stack never coincides.
    pub offset: f32,
    /// Segments along and columns across of a card.
    pub segments: (u8, u8),
    /// Colour.
    pub tint: Tint,
    /// Random variation.
    #[serde(default)]
    pub jitter: Jitter,
}
