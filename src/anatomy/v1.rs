//! Version 1 of the feather and down files, read only. The spelling of its fields is part of the format.

use super::{
    Clumps, Coat, ColorShare, Contour, Gaps, Interval, Rachis, Spread, Stop, Transfer, Vane,
};
use crate::{asset::RonAsset, maths::scattering::Optics};
use serde::Deserialize;

/// A feather whose patterns are tuples.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Feather {
    #[serde(rename = "version")]
    _version: u32,
    name: String,
    length_mm: f32,
    aspect: f32,
    contour: Contour,
    rachis: Rachis,
    left: Vane,
    right: Vane,
    #[serde(default)]
    gaps: Gaps,
    albedo: Albedo,
    #[serde(default)]
    optics: Optics,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Albedo {
    front: Pattern,
    #[serde(default)]
    back: Option<Pattern>,
    #[serde(default)]
    image: Option<String>,
    #[serde(default)]
    share: ColorShare,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Pattern {
    /// v, color, tint share.
    stops: Vec<(f32, [f32; 3], f32)>,
    /// Width, color, tint share.
    rim: Option<(f32, [f32; 3], f32)>,
    /// Count, color, share of the period, waviness.
    bars: Option<(f32, [f32; 3], f32, f32)>,
    mottle: f32,
}

impl From<Feather> for super::Feather {
    fn from(old: Feather) -> Self {
        Self {
            version: Self::VERSION,
            name: old.name,
            length_mm: old.length_mm,
            aspect: old.aspect,
            contour: old.contour,
            rachis: old.rachis,
            left: old.left,
            right: old.right,
            gaps: old.gaps,
            clumps: Clumps::default(),
            albedo: super::Albedo {
                front: old.albedo.front.into(),
                back: old.albedo.back.map(Into::into),
                image: old.albedo.image,
                share: old.albedo.share,
            },
            optics: old.optics,
            iridescence: None,
            iridescence_scale: None,
            image: None,
            weather: Default::default(),
        }
    }
}

impl From<Pattern> for super::Pattern {
    fn from(old: Pattern) -> Self {
        let stop = |(v, color, tint)| Stop { v, color, tint };
        Self {
            stops: old.stops.into_iter().map(stop).collect(),
            rim: old.rim.map(|(width, color, tint)| super::Rim {
                width,
                softness: super::Rim::SOFTNESS,
                color,
                tint,
            }),
            bars: old.bars.map(|(count, color, share, waviness)| super::Bars {
                count,
                color,
                share,
                waviness,
            }),
            spots: Vec::new(),
            mottle: old.mottle,
        }
    }
}

/// A down whose pairs are tuples.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Down {
    #[serde(rename = "version")]
    _version: u32,
    name: String,
    thickness_mm: f32,
    optical_depth: f32,
    clump_mm: f32,
    uv_jitter: f32,
    tangent_spread: (f32, f32),
    bend: f32,
    lay: [f32; 3],
    #[serde(rename = "colour")]
    color: [f32; 3],
    #[serde(rename = "tip_colour")]
    tip_color: [f32; 3],
    skin: [f32; 3],
    specular: (f32, f32),
    coats: Vec<Hairs>,
    tile: [u32; 3],
    transfer: Transfer,
    seed: u64,
}

#[derive(Deserialize)]
#[serde(rename = "Coat", deny_unknown_fields)]
struct Hairs {
    hairs: u32,
    radius: (f32, f32),
    length: (f32, f32),
    curl: f32,
}

/// What a file of version 1 leaves out.
impl Default for Down {
    fn default() -> Self {
        Self {
            _version: 1,
            name: "down".into(),
            thickness_mm: 4.0,
            optical_depth: 4.0,
            clump_mm: 1.0,
            uv_jitter: 0.05,
            tangent_spread: (0.15, 0.85),
            bend: 0.3,
            lay: [0.0, -1.0, -0.4],
            color: [0.62, 0.60, 0.58],
            tip_color: [0.93, 0.91, 0.88],
            skin: [0.62, 0.42, 0.36],
            specular: (0.03, 20.0),
            coats: Vec::new(),
            tile: [64, 64, 32],
            transfer: Transfer::Four,
            seed: 1,
        }
    }
}

impl From<Down> for super::Down {
    fn from(old: Down) -> Self {
        let coat = |old: Hairs| Coat {
            hairs: old.hairs,
            radius: Interval::new(old.radius.0, old.radius.1),
            length: Interval::new(old.length.0, old.length.1),
            curl: old.curl,
        };
        Self {
            version: Self::VERSION,
            name: old.name,
            thickness_mm: old.thickness_mm,
            optical_depth: old.optical_depth,
            clump_mm: old.clump_mm,
            uv_jitter: old.uv_jitter,
            tangent_spread: Spread {
                skin: old.tangent_spread.0,
                tips: old.tangent_spread.1,
            },
            bend: old.bend,
            lay: old.lay,
            color: old.color,
            tip_color: old.tip_color,
            skin: old.skin,
            specular: super::Specular {
                strength: old.specular.0,
                exponent: old.specular.1,
            },
            coats: old.coats.into_iter().map(coat).collect(),
            tile: old.tile,
            transfer: old.transfer,
            seed: old.seed,
        }
    }
}
