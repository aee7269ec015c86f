//! The [`Groom`] asset: regions, guides and rows, all of them data.
//!
//! All positions and directions are in the model space of the skinned mesh in bind pose (glTF axes: +Y up, +Z forward, +X the
//! bird's left), in units of `unit` metres. Left and right: data is given for the left half; `mirror` repeats it with x negated
//! and joint names' `_L` turned into `_R`.

use super::{mask_textures::MaskTexture, pose::KeyPose};
use crate::{
    anatomy::{Down, Feather},
    asset::{AssetLink, RonAsset},
    parameter::{Length, Parameter},
};
use bevy::{
    asset::{Asset, UntypedAssetId, VisitAssetDependencies},
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};

/// A length in units of the groom.
const MEASURE: Parameter = Parameter::new("", 1.0e-6, 1.0e6);
/// A coordinate in units of the groom.
const PLACE: Parameter = Parameter::new("", -1.0e9, 1.0e9);
/// A layer key.
const LAYER: Parameter = Parameter::new("", -1.0e4, 1.0e4);

/// Where feathers grow on one kind of bird; file `*.groom.ron`.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Groom {
    /// Format version of the file, [`RonAsset::VERSION`].
    pub version: u32,
    /// Name shown to people.
    pub name: String,
    /// Metres per length unit of this file (0.001: millimetres), 1e-9..1e9.
    #[reflect(@Parameter::new("m", 1.0e-9, 1.0e9))]
    pub unit: f32,
    /// The feathers worn, at most 4096.
    #[dependency]
    #[reflect(@Length::new(0, 4096))]
    pub feathers: Vec<AssetLink<Feather>>,
    /// Tracts of scattered feathers; with the rows at most 4096.
    #[dependency]
    pub regions: Vec<Region>,
    /// Strokes along the lay of the plumage, interpolated over the surface.
    pub guides: Vec<Guide>,
    /// Rows of feathers on bones: remiges, rectrices and their coverts.
    pub rows: Vec<Row>,
    /// Masks in textures over the whole skin, at most 16.
    #[dependency]
    #[reflect(@Length::new(0, 16))]
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masks: Vec<MaskTexture>,
    /// Touches of a brush on the skin, laid over each other; at most 10,000.
    #[reflect(@Length::new(0, 10_000))]
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<Dab>,
    /// Poses that the bird wears, at most 5: the coat is settled in each of them, and worn as in the nearest; in bind pose without
    /// any. None of them draws feathers far out of shape.
    #[reflect(@Length::new(0, 5))]
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<KeyPose>,
    /// How far joints bend on either side of bind pose, degrees, 0..120: where that draws the skin apart, more feathers grow, at most
    /// three times as many; regions in rows then become blue noise. 0 grows none.
    #[reflect(@Parameter::degrees(0.0, 120.0))]
    #[serde(default, skip_serializing_if = "is_zero")]
    pub bend: f32,
}

/// One touch of a brush: factors on number and length of the feathers around a point, full in the middle, none at the rim.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Dab {
    /// Middle, near the skin.
    #[reflect(@PLACE)]
    pub at: [f32; 3],
    /// Distance at which it ends; above 0.
    #[reflect(@MEASURE)]
    pub radius: f32,
    /// Factor on the number of feathers, 0..4 (1 leaves it).
    #[reflect(@Parameter::new("", 0.0, 4.0))]
    pub density: f32,
    /// Factor on their length, 0.05..4 (1 leaves it).
    #[reflect(@Parameter::new("", 0.05, 4.0))]
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
#[reflect(no_field_bounds, Default, Clone, PartialEq)]
pub enum Select {
    /// Everything.
    #[default]
    All,
    /// Triangles whose `TEXCOORD_1.x`, rounded, is this tract number.
    Tract(u32),
    /// Triangles whose vertex color is near a color.
    Color {
        /// The color, linear RGB.
        #[reflect(@PLACE)]
        color: [f32; 3],
        /// Largest distance in linear RGB, 0..10.
        #[reflect(@Parameter::new("", 0.0, 10.0))]
        distance: f32,
    },
    /// Triangles whose vertex color is nearer to one color than to any of the others.
    Nearest {
        /// The color, linear RGB.
        #[reflect(@PLACE)]
        color: [f32; 3],
        /// The others, linear RGB.
        #[reflect(@PLACE)]
        others: Vec<[f32; 3]>,
    },
    /// Triangles mostly carried by one of the joints named.
    Joints(Vec<String>),
    /// Triangles inside a box.
    Within {
        /// Smallest coordinates.
        #[reflect(@PLACE)]
        low: [f32; 3],
        /// Largest coordinates.
        #[reflect(@PLACE)]
        high: [f32; 3],
    },
    /// Any of these.
    Any(Vec<Select>),
    /// All of these.
    Every(Vec<Select>),
    /// None of these.
    Not(Vec<Select>),
}

/// How a region is filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
pub enum Placement {
    /// Blue noise, denser across the lay.
    #[default]
    Scatter,
    /// Staggered rows across the lay: this many, 1..10000.
    Rows(#[reflect(@Parameter::new("rows", 1.0, 10_000.0))] u32),
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

impl Jitter {
    /// No variation.
    pub const NONE: Self = Self {
        length: 0.0,
        width: 0.0,
        yaw: 0.0,
        roll: 0.0,
        lift: 0.0,
        hue: 0.0,
        value: 0.0,
    };
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

/// Color for the tintable parts of a feather's albedo, sRGB, over phi.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
pub struct Tint(pub [f32; 3], pub [f32; 3]);

/// How finely the card of a feather is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segments {
    /// Along the rachis, 1..64.
    #[reflect(@Parameter::new("", 1.0, 64.0))]
    pub along: u8,
    /// Across it, 1..16; even numbers have vertices along the shaft, where light at vertices needs them.
    #[reflect(@Parameter::new("", 1.0, 16.0))]
    pub across: u8,
}

impl Segments {
    /// This many along and across.
    pub const fn new(along: u8, across: u8) -> Self {
        Self { along, across }
    }

    /// Vertices of a card.
    pub fn vertices(self) -> u32 {
        (u32::from(self.along) + 1) * (u32::from(self.across) + 1)
    }
}

impl Default for Segments {
    fn default() -> Self {
        Self::new(4, 2)
    }
}

/// One tract of scattered feathers.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
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
    #[reflect(@MEASURE)]
    pub length: Span,
    /// Width of a feather.
    #[reflect(@MEASURE)]
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
    #[reflect(@LAYER)]
    pub layer: f32,
    /// How finely a card is divided.
    pub segments: Segments,
    /// Color.
    #[reflect(@Parameter::share())]
    pub tint: Tint,
    /// Share of its color that a feather takes from the skin at its root (base color, texture and vertex colors), 0..1; the rest is
    /// the tint.
    #[reflect(@Parameter::share())]
    #[serde(default, skip_serializing_if = "is_zero")]
    pub skin_color: f32,
    /// Random variation.
    #[serde(default)]
    pub jitter: Jitter,
    /// Down below the feathers. It shows where they leave the skin open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<AssetLink<Down>>,
}

/// A stroke along the lay, root to tip: at least two points near the skin.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Guide {
    /// Points, 2..4096 of them.
    #[reflect(@PLACE, @Length::new(2, 4096))]
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
#[non_exhaustive]
pub struct Station {
    /// Place along the row, 0..1; stations rise.
    #[reflect(@Parameter::share())]
    pub at: f32,
    /// Root of the feather there.
    #[reflect(@PLACE)]
    pub root: [f32; 3],
    /// Direction of the rachis there, root to tip.
    #[reflect(@PLACE)]
    pub direction: [f32; 3],
    /// Normal of the front face there.
    #[reflect(@PLACE)]
    pub normal: [f32; 3],
    /// Joints that carry the root.
    pub ride: Vec<JointWeight>,
    /// Joints whose rotation (since bind pose) the feather follows, blended with these weights: this is what fans the row.
    pub follow: Vec<JointWeight>,
}

/// A joint and how much it counts beside others.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointWeight {
    /// Name of the joint.
    pub joint: String,
    /// Weight, 0..1000.
    #[reflect(@Parameter::new("", 0.0, 1.0e3))]
    pub weight: f32,
}

impl JointWeight {
    /// A joint of this weight.
    pub fn new(joint: impl Into<String>, weight: f32) -> Self {
        Self {
            joint: joint.into(),
            weight,
        }
    }
}

/// A row of feathers on bones. Feather `i` of `n` stands at `i/(n-1)`, its frame interpolated between the stations.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Row {
    /// Name; part of every feather's seed.
    pub name: String,
    /// Feather worn: index into [`Groom::feathers`].
    pub feather: u16,
    /// Length of each feather in order, one side; as many as there are feathers, 1..512.
    #[reflect(@MEASURE, @Length::new(1, 512))]
    pub lengths: Vec<f32>,
    /// Width of the first and the last.
    #[reflect(@MEASURE)]
    pub width: Span,
    /// 2..4096 of them.
    #[reflect(@Length::new(2, 4096))]
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
    #[reflect(@LAYER)]
    pub layer: Span,
    /// Distance between the planes of neighboring feathers along their normal, so that a closed stack never coincides.
    #[reflect(@Parameter::new("", -1.0e3, 1.0e3))]
    pub offset: f32,
    /// How finely a card is divided.
    pub segments: Segments,
    /// Color.
    #[reflect(@Parameter::share())]
    pub tint: Tint,
    /// Share of its color that a feather takes from the skin at its root (base color, texture and vertex colors), 0..1; the rest is
    /// the tint.
    #[reflect(@Parameter::share())]
    #[serde(default, skip_serializing_if = "is_zero")]
    pub skin_color: f32,
    /// Random variation.
    #[serde(default)]
    pub jitter: Jitter,
}

/// What need not be written.
fn is_zero(share: &f32) -> bool {
    *share == 0.0
}

impl Groom {
    /// Share of the skin's color of each region, then of each row.
    pub(super) fn shares(&self) -> impl Iterator<Item = f32> {
        let regions = self.regions.iter().map(|region| region.skin_color);
        regions.chain(self.rows.iter().map(|row| row.skin_color))
    }
}

/// An empty groom in millimetres.
impl Default for Groom {
    fn default() -> Self {
        Self {
            version: Self::VERSION,
            name: "groom".into(),
            unit: 0.001,
            feathers: Vec::new(),
            regions: Vec::new(),
            guides: Vec::new(),
            rows: Vec::new(),
            masks: Vec::new(),
            paint: Vec::new(),
            poses: Vec::new(),
            bend: 0.0,
        }
    }
}

impl VisitAssetDependencies for Region {
    fn visit_dependencies(&self, visit: &mut impl FnMut(UntypedAssetId)) {
        if let Some(down) = &self.down {
            down.visit_dependencies(visit);
        }
    }
}

/// No feathers anywhere; length and width of a small body feather in millimetres.
impl Default for Region {
    fn default() -> Self {
        Self {
            name: String::new(),
            select: Select::All,
            feather: 0,
            count: 0,
            placement: Placement::Scatter,
            length: Span(20.0, 20.0),
            width: Span(10.0, 10.0),
            lift: Span(10.0, 10.0),
            camber: 0.05,
            curl: 0.0,
            stiffness: 0.1,
            layer: 0.0,
            segments: Segments::default(),
            tint: Tint::default(),
            skin_color: 0.0,
            jitter: Jitter::default(),
            down: None,
        }
    }
}

impl Region {
    /// A region of this name on the whole skin, without feathers yet: set `count`, `length` and `width`.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }
}

impl Default for Tint {
    fn default() -> Self {
        Self([0.5; 3], [0.5; 3])
    }
}

impl Guide {
    /// A stroke through these points, for all regions, on one side.
    pub fn new(points: impl Into<Vec<[f32; 3]>>) -> Self {
        Self {
            points: points.into(),
            mirror: false,
            regions: Vec::new(),
        }
    }
}

impl Dab {
    /// A dab that changes nothing yet: set `density` or `length`.
    pub fn new(at: [f32; 3], radius: f32) -> Self {
        Self {
            at,
            radius,
            density: 1.0,
            length: 1.0,
        }
    }
}

impl Station {
    /// A feather's frame at a place along the row, carried by no joint yet.
    pub fn new(at: f32, root: [f32; 3], direction: [f32; 3], normal: [f32; 3]) -> Self {
        Self {
            at,
            root,
            direction,
            normal,
            ride: Vec::new(),
            follow: Vec::new(),
        }
    }
}

impl Row {
    /// A row of this name with feathers of these lengths between these stations, on one side.
    pub fn new(name: impl Into<String>, lengths: Vec<f32>, stations: Vec<Station>) -> Self {
        Self {
            name: name.into(),
            feather: 0,
            lengths,
            width: Span(10.0, 10.0),
            stations,
            mirror: false,
            handed: false,
            lift: Span(0.0, 0.0),
            camber: 0.05,
            curl: 0.0,
            layer: Span(0.0, 0.0),
            offset: 0.0,
            segments: Segments::default(),
            tint: Tint::default(),
            skin_color: 0.0,
            jitter: Jitter::default(),
        }
    }
}
