//! The [`Feather`] asset.
//!
//! Units. The UV rectangle of a feather is its card: `v` runs from 0 at the skin to 1 at the tip, `u` from 0 (left) to 1
//! (right). *Canonical space* is the same plane in units of the feather's length, so that angles are true:
//! `x = (u - F_P(v)) * aspect`, `y = v`, with the rachis on `x = 0` (the paper's map M of Table 1 puts it on 0.5 and has no
//! aspect). Left is `x < 0`. Every length below whose unit is not named is in feather lengths.

use crate::{parameter::Parameter, scattering::Optics};
use bevy::{
    asset::{Asset, Handle},
    image::Image,
    reflect::Reflect,
};
use serde::{Deserialize, Serialize};

/// One feather, as it lies in a `*.feather.ron` file.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Feather {
    /// Format version of the file, [`Feather::VERSION`].
    pub version: u32,
    /// Name shown to people, e.g. `primary`.
    pub name: String,
    /// Length from skin to tip in millimetres; the physical scale of every other length.
    #[reflect(@Parameter::new("mm", 0.1, 5000.0).logarithmic())]
    pub length_mm: f32,
    /// Width over length of the UV rectangle, 0.01..2.
    #[reflect(@Parameter::new("", 0.01, 2.0).logarithmic())]
    pub aspect: f32,
    /// Outline P.
    pub contour: Contour,
    /// Shaft curve F_P and its radius r_r.
    pub rachis: Rachis,
    /// The vane on the left of the rachis seen from the front, tip up.
    pub left: Vane,
    /// The vane on the right.
    pub right: Vane,
    /// Splits of the contour (Eq. 3-5).
    #[serde(default)]
    pub gaps: Gaps,
    /// Colour.
    pub albedo: Albedo,
    /// Fibre optics.
    #[serde(default)]
    pub optics: Optics,
    /// The image that `albedo.image` names; the loader fills it in.
    #[serde(skip)]
    #[dependency]
    pub image: Option<Handle<Image>>,
}

/// Outline P: half widths of the two vanes along the feather, as the *reach of the barb* rooted at each height.
///
/// Sample `i` of `n` belongs to the barb rooted at `y = start + (1 - start) i/(n-1)`; its value is how far from the rachis
/// (along x, in feather lengths) that barb reaches. A contour polyline is converted by intersecting it with the barbs.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contour {
    /// Height where the vane begins (above it the calamus is bare), 0..0.9.
    #[reflect(@Parameter::new("", 0.0, 0.9))]
    pub start: f32,
    /// Reach of the left barbs, 2..1024 values.
    pub left: Vec<f32>,
    /// Reach of the right barbs, 2..1024 values.
    pub right: Vec<f32>,
}

/// Shaft curve F_P(v) and radius r_r(v).
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rachis {
    /// F_P at equal steps of v from 0 to 1, in UV units (0.5 = middle of the card), 2..64 values, joined by a cubic spline.
    pub curve: Vec<f32>,
    /// r_r at base, middle and tip, in millimetres.
    pub radius_mm: [f32; 3],
}

/// One vane: the barbs of one side and their barbules (Table 1).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vane {
    /// N_b: barbs per feather length along the rachis, 4..5000.
    #[reflect(@Parameter::new("per length", 4.0, 5000.0).logarithmic())]
    pub barb_count: f32,
    /// alpha_b: angle between barb and rachis in degrees, 5..85.
    #[reflect(@Parameter::degrees(5.0, 85.0))]
    pub barb_angle: f32,
    /// r_b in micrometres.
    #[reflect(@Parameter::new("\u{b5}m", 0.1, 2000.0).logarithmic())]
    pub barb_radius_um: f32,
    /// Barbules of both families.
    pub barbules: Barbules,
    /// Share of the barb's outer end whose barbules do not hook (a frayed rim), 0..1.
    #[serde(default)]
    #[reflect(@Parameter::share())]
    pub fringe: f32,
    /// Share of the feather's length, from the base, that is down (barbules do not hook), 0..1.
    #[serde(default)]
    #[reflect(@Parameter::share())]
    pub downy: f32,
}

/// Distal and proximal barbules of one vane.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Barbules {
    /// d_bl: spacing along the barb in micrometres.
    #[reflect(@Parameter::new("\u{b5}m", 1.0, 5000.0).logarithmic())]
    pub spacing_um: f32,
    /// alpha_bl: angle between barbule and barb in degrees, 10..80.
    #[reflect(@Parameter::degrees(10.0, 80.0))]
    pub angle: f32,
    /// r_bd in micrometres.
    #[reflect(@Parameter::new("\u{b5}m", 0.05, 500.0).logarithmic())]
    pub distal_radius_um: f32,
    /// r_bp in micrometres.
    #[reflect(@Parameter::new("\u{b5}m", 0.05, 500.0).logarithmic())]
    pub proximal_radius_um: f32,
}

/// Splits in the contour, placed by noise (Eq. 3-5).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gaps {
    /// K: number of splits per feather, 0..64.
    #[reflect(@Parameter::new("", 0.0, 64.0))]
    pub count: u32,
    /// sigma_k: width of a split, in feather lengths, 0..0.2.
    #[reflect(@Parameter::new("lengths", 0.0, 0.2))]
    pub width: f32,
    /// A_k: how far a split goes in along the barb, as a share of the barb, 0..1.
    #[reflect(@Parameter::share())]
    pub depth: f32,
    /// Seed of the noise.
    pub seed: u32,
}

impl Default for Gaps {
    fn default() -> Self {
        Self {
            count: 0,
            width: 0.01,
            depth: 0.5,
            seed: 1,
        }
    }
}

/// Colour of both faces.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Albedo {
    /// The face that looks away from the body.
    pub front: Pattern,
    /// The face towards the body; the front's when absent.
    #[serde(default)]
    pub back: Option<Pattern>,
    /// An image over the UV rectangle that replaces the front pattern, path relative to the feather file (from a photograph).
    #[serde(default)]
    pub image: Option<String>,
    /// How much of the painted colour each kind of fibre has.
    #[serde(default)]
    pub share: ColourShare,
}

/// Pigment is not spread evenly: factors on the painted colour, each 0..4, 1 = as painted. The product is kept below 1.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColourShare {
    /// Of the shaft.
    #[reflect(@Parameter::new("", 0.0, 4.0))]
    pub rachis: f32,
    /// Of the barbs.
    #[reflect(@Parameter::new("", 0.0, 4.0))]
    pub barb: f32,
    /// Of both families of barbules.
    #[reflect(@Parameter::new("", 0.0, 4.0))]
    pub barbule: f32,
}

impl Default for ColourShare {
    fn default() -> Self {
        Self {
            rachis: 1.0,
            barb: 1.0,
            barbule: 1.0,
        }
    }
}

/// A painted pattern: bands along the feather, a rim, bars. Each colour is sRGB `[r, g, b]` in 0..1, and each has a `tint`
/// share: 0 keeps the colour, 1 hands it to the groom (region colour of the card), so that one template serves many tracts.
#[derive(Clone, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pattern {
    /// Colour stops along v: (v, colour, tint share), 1..16 of them, v rising.
    pub stops: Vec<(f32, [f32; 3], f32)>,
    /// A rim of another colour: (width as a share of the half width, colour, tint share).
    pub rim: Option<(f32, [f32; 3], f32)>,
    /// Cross bars: (count along v, colour, share of the period they fill 0..1, waviness 0..1).
    pub bars: Option<(f32, [f32; 3], f32, f32)>,
    /// Fine mottling: amplitude of the value noise, 0..1.
    #[reflect(@Parameter::share())]
    pub mottle: f32,
}

impl Feather {
    /// Version that this crate writes.
    pub const VERSION: u32 = 1;
}
