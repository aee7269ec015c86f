//! The [`Feather`] asset.
//!
//! Units. The UV rectangle of a feather is its card: `v` runs from 0 at the skin to 1 at the tip, `u` from 0 (left) to 1
//! (right). *Canonical space* is the same plane in units of the feather's length, so that angles are true:
//! `x = (u - F_P(v)) * aspect`, `y = v`, with the rachis on `x = 0` (the paper's map M of Table 1 puts it on 0.5 and has no
//! aspect). Left is `x < 0`. Every length below whose unit is not named is in feather lengths.

use super::{Clumps, Weather, v1};
use crate::{
    asset::{AssetError, RonAsset, parse},
    maths::scattering::{
        Optics,
        interference::{Iridescence, ScaleMap},
    },
    parameter::{Length, Parameter},
};
use bevy::{
    asset::{Asset, Handle, LoadContext},
    image::Image,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};

/// One feather, as it lies in a `*.feather.ron` file.
#[derive(Asset, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Feather {
    /// Format version of the file, [`RonAsset::VERSION`].
    pub version: u32,
    /// Name shown to people, e.g. `primary`; 1 to 256 bytes.
    #[reflect(@Length::new(1, 256))]
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
    /// Clumps of barbs.
    #[serde(default, skip_serializing_if = "Clumps::is_default")]
    pub clumps: Clumps,
    /// Color.
    pub albedo: Albedo,
    /// Fibre optics.
    #[serde(default)]
    pub optics: Optics,
    /// Thin layers that make the dark parts of its barbules shimmer; none in most feathers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub iridescence: Option<Iridescence>,
    /// Factors on the thickness of these layers over the card, for feathers whose color changes from place to place; 1 everywhere when
    /// absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub iridescence_scale: Option<ScaleMap>,
    /// The image that `albedo.image` names; the loader fills it in.
    #[serde(skip)]
    #[dependency]
    pub image: Option<Handle<Image>>,
    /// What its colors are seen under; see [`Feather::weathered`].
    #[serde(skip)]
    #[reflect(ignore)]
    pub(crate) weather: Weather,
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
    /// Reach of the left barbs, 2..1024 values of 0..2.
    #[reflect(@Parameter::new("lengths", 0.0, 2.0), @Length::new(2, 1024))]
    pub left: Vec<f32>,
    /// Reach of the right barbs, 2..1024 values of 0..2.
    #[reflect(@Parameter::new("lengths", 0.0, 2.0), @Length::new(2, 1024))]
    pub right: Vec<f32>,
}

/// Shaft curve F_P(v) and radius r_r(v).
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rachis {
    /// F_P at equal steps of v from 0 to 1, in UV units (0.5 = middle of the card), 2..64 values of -0.5..1.5, joined by a
    /// cubic spline.
    #[reflect(@Parameter::new("", -0.5, 1.5), @Length::new(2, 64))]
    pub curve: Vec<f32>,
    /// r_r at base, middle and tip, in millimetres, 0..50.
    #[reflect(@Parameter::new("mm", 0.0, 50.0))]
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

/// Color of both faces.
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
    #[reflect(@Length::new(1, 1024))]
    pub image: Option<String>,
    /// How much of the painted color each kind of fibre has.
    #[serde(default)]
    pub share: ColorShare,
}

/// Pigment is not spread evenly: factors on the painted color, each 0..4, 1 = as painted. The product is kept below 1.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColorShare {
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

impl Default for ColorShare {
    fn default() -> Self {
        Self {
            rachis: 1.0,
            barb: 1.0,
            barbule: 1.0,
        }
    }
}

/// A painted pattern: bands along the feather, bars, a rim, spots. Each color is sRGB `[r, g, b]` in 0..1; a `tint` share of 0 keeps
/// the color, 1 hands it to the groom (region color of the card), so that one template serves many tracts.
#[derive(Clone, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pattern {
    /// Color stops along v, 1..16 of them, v rising.
    #[reflect(@Length::new(1, 16))]
    pub stops: Vec<Stop>,
    /// A rim of another color.
    pub rim: Option<Rim>,
    /// Cross bars.
    pub bars: Option<Bars>,
    /// Spots, at most 16, each over those before it.
    #[reflect(@Length::new(0, 16))]
    pub spots: Vec<Spot>,
    /// Fine mottling, in streaks along the barbs: amplitude of the value noise, 0..1.
    #[reflect(@Parameter::share())]
    pub mottle: f32,
}

/// A color at one height of a [`Pattern`].
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Height on the card, 0..1.
    #[reflect(@Parameter::share())]
    pub v: f32,
    /// Color, sRGB.
    #[reflect(@Parameter::share())]
    pub color: [f32; 3],
    /// Share handed to the groom's color, 0..1.
    #[reflect(@Parameter::share())]
    pub tint: f32,
}

/// The rim of a [`Pattern`], along the outline.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rim {
    /// Width as a share of the half width, 0..1.
    #[reflect(@Parameter::share())]
    pub width: f32,
    /// Over how much of its width to either side it runs out, 0..1 ([`Rim::SOFTNESS`]).
    #[serde(default = "usual_softness")]
    #[reflect(@Parameter::share())]
    pub softness: f32,
    /// Color, sRGB.
    #[reflect(@Parameter::share())]
    pub color: [f32; 3],
    /// Share handed to the groom's color, 0..1.
    #[reflect(@Parameter::share())]
    pub tint: f32,
}

impl Rim {
    /// The usual [`Rim::softness`].
    pub const SOFTNESS: f32 = 0.35;
}

fn usual_softness() -> f32 {
    Rim::SOFTNESS
}

/// The cross bars of a [`Pattern`].
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bars {
    /// Number along v, 0..200.
    #[reflect(@Parameter::new("", 0.0, 200.0))]
    pub count: f32,
    /// Color, sRGB.
    #[reflect(@Parameter::share())]
    pub color: [f32; 3],
    /// Share of the period that a bar fills, 0..1.
    #[reflect(@Parameter::share())]
    pub share: f32,
    /// Waviness, 0..1.
    #[reflect(@Parameter::share())]
    pub waviness: f32,
}

/// A spot of a [`Pattern`], an ellipse: an owl's pearl, one side of a streak, an eye.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spot {
    /// Height of its middle on the card, 0..1.
    #[reflect(@Parameter::share())]
    pub v: f32,
    /// Place of its middle across the feather, shares of the half width: -1 left edge, 0 rachis, 1 right edge.
    #[reflect(@Parameter::new("", -1.0, 1.0))]
    pub across: f32,
    /// Half its width as a share of the half width, 0.01..2.
    #[reflect(@Parameter::new("", 0.01, 2.0))]
    pub half_width: f32,
    /// Half its length as a share of the feather's length, 0.002..1.
    #[reflect(@Parameter::new("", 0.002, 1.0))]
    pub half_length: f32,
    /// Color, sRGB.
    #[reflect(@Parameter::share())]
    pub color: [f32; 3],
    /// Share handed to the groom's color, 0..1.
    #[reflect(@Parameter::share())]
    pub tint: f32,
}

/// A plain grey body feather of 40 mm.
impl Default for Feather {
    fn default() -> Self {
        Self {
            version: Self::VERSION,
            name: "feather".into(),
            length_mm: 40.0,
            aspect: 0.6,
            contour: Contour::default(),
            rachis: Rachis::default(),
            left: Vane::default(),
            right: Vane::default(),
            gaps: Gaps::default(),
            clumps: Clumps::default(),
            albedo: Albedo::default(),
            optics: Optics::default(),
            iridescence: None,
            iridescence_scale: None,
            image: None,
            weather: Weather::default(),
        }
    }
}

impl Default for Contour {
    fn default() -> Self {
        let reach = vec![0.2, 0.3, 0.3, 0.25, 0.15, 0.0];
        Self {
            start: 0.03,
            left: reach.clone(),
            right: reach,
        }
    }
}

/// A straight shaft in the middle of the card.
impl Default for Rachis {
    fn default() -> Self {
        Self {
            curve: vec![0.5; 2],
            radius_mm: [0.4, 0.2, 0.04],
        }
    }
}

/// A vane of a body feather.
impl Default for Vane {
    fn default() -> Self {
        Self {
            barb_count: 90.0,
            barb_angle: 40.0,
            barb_radius_um: 15.0,
            barbules: Barbules::default(),
            fringe: 0.0,
            downy: 0.0,
        }
    }
}

impl Default for Barbules {
    fn default() -> Self {
        Self {
            spacing_um: 34.0,
            angle: 38.0,
            distal_radius_um: 8.3,
            proximal_radius_um: 8.2,
        }
    }
}

/// Neutral grey that the groom's color replaces by half.
impl Default for Albedo {
    fn default() -> Self {
        Self {
            front: Pattern {
                stops: vec![Stop {
                    v: 0.0,
                    color: [0.5; 3],
                    tint: 0.5,
                }],
                ..Pattern::default()
            },
            back: None,
            image: None,
            share: ColorShare::default(),
        }
    }
}

impl RonAsset for Feather {
    const NAME: &'static str = "Feather";
    const EXTENSION: &'static str = "feather.ron";
    const VERSION: u32 = 2;
    const OLDEST: u32 = 1;

    fn version(&self) -> u32 {
        self.version
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn migrate(_: u32, bytes: &[u8], file: &str) -> Result<Self, AssetError> {
        parse::<v1::Feather>(bytes, file).map(Self::from)
    }

    /// The stops of a pattern rise; the rows of a map are full.
    fn check_relations(&self) -> Result<(), AssetError> {
        let front = std::iter::once(("front", &self.albedo.front));
        for (face, pattern) in front.chain(self.albedo.back.as_ref().map(|back| ("back", back))) {
            let mut last = 0.0;
            for (i, stop) in pattern.stops.iter().enumerate() {
                if stop.v < last {
                    let field = format_args!("albedo.{face}.stops[{i}].v").to_string();
                    return Err(AssetError::value(
                        field,
                        stop.v,
                        format_args!("{last} to 1"),
                    ));
                }
                last = stop.v;
            }
        }
        if let Some(map) = &self.iridescence_scale {
            let (columns, found) = (map.columns as usize, map.factors.len());
            if columns == 0 || !found.is_multiple_of(columns) || found / columns > 64 {
                return Err(AssetError::value(
                    "iridescence_scale.factors",
                    format_args!("{found} long"),
                    format_args!("1 to 64 rows of {columns}"),
                ));
            }
        }
        Ok(())
    }

    fn load_dependencies(&mut self, context: &mut LoadContext<'_>) -> Result<(), AssetError> {
        if let Some(image) = &self.albedo.image {
            let target = context.path().resolve_embed_str(image).map_err(|error| {
                let value = format_args!("{image:?} ({error})").to_string();
                AssetError::value("albedo.image", value, "an asset path")
            })?;
            self.image = Some(context.load(target));
        }
        Ok(())
    }
}
