//! What a fibre is made of: the parameters every lobe reads.

use crate::parameter::Parameter;
use bevy::reflect::Reflect;
use serde::{Deserialize, Serialize};

/// How a fibre gets its color (Sec. 6.1).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FibreKind {
    /// Lobes R, TT, TRcT, TRT: a mirror core of the wanted color, black behind.
    Structural {
        /// Core radius over fibre radius, 0..1 (0.65 and more: no white light passes beside it).
        #[reflect(@Parameter::share())]
        core_radius: f32,
    },
    /// Lobes R, TT, TRT and the medulla's scattered light (Yan et al. 2017).
    Pigment {
        /// Medulla radius over fibre radius, 0.3..0.95.
        #[reflect(@Parameter::new("", 0.3, 0.95))]
        medulla_radius: f32,
        /// Optical depth of scattering along the medulla's radius, 0.25..8.
        #[reflect(@Parameter::new("", 0.25, 8.0).logarithmic())]
        scattering: f32,
        /// Henyey-Greenstein mean cosine, 0..0.85.
        #[reflect(@Parameter::new("", 0.0, 0.85))]
        anisotropy: f32,
    },
}

/// One fibre: rachis, barb, or a family of barbules.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Fibre {
    /// Where the color comes from.
    pub kind: FibreKind,
    /// Refractive index of keratin, 1.3..2 (1.55).
    #[reflect(@Parameter::new("", 1.3, 2.0))]
    pub eta: f32,
    /// Longitudinal roughness of R in radians, 0.05..0.8.
    #[reflect(@Parameter::new("rad", 0.05, 0.8))]
    pub longitudinal_roughness: f32,
    /// Azimuthal roughness in radians, 0.2..1.
    #[reflect(@Parameter::new("rad", 0.2, 1.0))]
    pub azimuthal_roughness: f32,
    /// Longitudinal shift of R in radians, -0.2..0.2 (scales tilt towards the tip: negative).
    #[reflect(@Parameter::new("rad", -0.2, 0.2))]
    pub tilt: f32,
    /// Minor over major axis of the cross-section, 0.2..1; the minor axis stands on the vane.
    #[reflect(@Parameter::new("", 0.2, 1.0))]
    pub aspect: f32,
}

impl Default for Fibre {
    fn default() -> Self {
        Self {
            kind: FibreKind::Pigment {
                medulla_radius: 0.85,
                scattering: 2.0,
                anisotropy: 0.4,
            },
            eta: 1.55,
            longitudinal_roughness: 0.2,
            azimuthal_roughness: 0.4,
            tilt: -0.07,
            aspect: 1.0,
        }
    }
}

/// The soft rim light of dense barbules (Zeltner et al. 2022, volume variant).
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sheen {
    /// Strength, 0..1 (0 turns the lobe off).
    #[reflect(@Parameter::share())]
    pub strength: f32,
    /// Roughness, 0.1..1.
    #[reflect(@Parameter::new("", 0.1, 1.0))]
    pub roughness: f32,
}

impl Default for Sheen {
    fn default() -> Self {
        Self {
            strength: 0.3,
            roughness: 0.5,
        }
    }
}

/// The fibres of one feather. Color itself is the albedo's business.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Optics {
    /// The shaft.
    pub rachis: Fibre,
    /// The barbs.
    pub barb: Fibre,
    /// The barbules on the side of the tip, on top when seen from the front.
    pub distal: Fibre,
    /// The barbules on the side of the base.
    pub proximal: Fibre,
    /// The rim light over all of them.
    pub sheen: Sheen,
}
