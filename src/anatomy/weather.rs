//! What water, dirt and age make of a feather.

use super::{Clumps, Feather, Gaps};
use crate::{
    maths::scattering::{Fibre, Optics, Sheen},
    parameter::Parameter,
};
use bevy::{
    math::FloatExt,
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// Share of diffuse light that a smooth surface of water (refractive index 1.33) mirrors from outside (docs/book/weather.md, Judd 1942).
const FILM_OUTSIDE: f32 = 0.066;
/// The same from inside: 1 - (1 - [`FILM_OUTSIDE`]) / 1.33^2.
const FILM_INSIDE: f32 = 0.472;
/// Linear color of brown soil (Munsell 10YR 4/3).
const SOIL: [f32; 3] = [0.159, 0.107, 0.058];
/// Share of a vane that the thickest dirt covers, chosen.
const COVERED: f32 = 0.95;
/// Share of the pigment that a feather loses until it is molted, chosen.
const BLEACHED: f32 = 0.2;

/// Water, dirt and age, each 0..1. With all of them 0 a feather is as its file says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct Weather {
    /// How wet: darker, its barbs in pointed clumps, smooth with water.
    #[reflect(@Parameter::share())]
    pub wetness: f32,
    /// How much soil lies on it: of the soil's color, and dull.
    #[reflect(@Parameter::share())]
    pub dirt: f32,
    /// How far from its molt: paler, its edge worn.
    #[reflect(@Parameter::share())]
    pub age: f32,
}

impl Weather {
    /// Of this much of it, 0..1; what is no number counts as 0.
    pub(crate) fn scaled(&self, share: f32) -> Self {
        let scale = |x: f32| {
            let x = x * share;
            if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
        };
        Self {
            wetness: scale(self.wetness),
            dirt: scale(self.dirt),
            age: scale(self.age),
        }
    }

    /// A linear color under it. Age: pigment absorbs along paths as long as before, so that reflectance rises to a power. Dirt covers.
    /// Water: of the light that the vane scatters, the film's surface mirrors a part back onto it, again and again
    /// (Ångström 1925, Lekner and Dorf 1988): `(1 - R) (1 - p) A / (1 - p A)`.
    pub fn color(&self, rgb: [f32; 3]) -> [f32; 3] {
        let Self { wetness, dirt, age } = self.scaled(1.0);
        std::array::from_fn(|c| {
            let bleached = rgb[c].clamp(0.0, 1.0).powf(1.0 - BLEACHED * age);
            let dirty = bleached.lerp(SOIL[c], COVERED * dirt);
            let wet =
                (1.0 - FILM_OUTSIDE) * (1.0 - FILM_INSIDE) * dirty / (1.0 - FILM_INSIDE * dirty);
            dirty.lerp(wet, wetness)
        })
    }

    /// Water fills what is rough on a fibre and flattens its scales; dirt roughens it.
    fn fibre(&self, fibre: Fibre) -> Fibre {
        let smooth = fibre.longitudinal_roughness.lerp(0.05, 0.7 * self.wetness);
        Fibre {
            longitudinal_roughness: smooth.lerp(smooth.max(0.5), self.dirt),
            tilt: fibre.tilt * (1.0 - self.wetness),
            ..fibre
        }
    }
}

impl Feather {
    /// The clean feather in this weather. Its colors change where they are painted or looked up.
    pub fn weathered(&self, weather: Weather) -> Self {
        let weather = weather.scaled(1.0);
        let Weather { wetness, dirt, age } = weather;
        let own = self.clumps;
        // Water pulls barbs together; few and deep, whatever clumps there were.
        let clumps = Clumps {
            count: own.count.max(6),
            size: own.size.max(0.6 * wetness),
            depth: own.depth.max(0.85 * wetness),
            falloff: 1.0,
            tip_bias: own.tip_bias.lerp(0.5, wetness),
            variation: own.variation.max(0.6),
            seed: own.seed,
        };
        let gaps = self.gaps;
        let Optics {
            rachis,
            barb,
            distal,
            proximal,
            sheen,
        } = self.optics;
        Self {
            clumps: if wetness > 0.0 { clumps } else { own },
            gaps: Gaps {
                count: gaps
                    .count
                    .saturating_add((8.0 * age).round() as u32)
                    .min(64),
                width: gaps.width.lerp(gaps.width.max(0.012), age),
                depth: gaps.depth.lerp(gaps.depth.max(0.5), age),
                ..gaps
            },
            optics: Optics {
                rachis: weather.fibre(rachis),
                barb: weather.fibre(barb),
                distal: weather.fibre(distal),
                proximal: weather.fibre(proximal),
                // Barbules that stick to each other have no fuzz.
                sheen: Sheen {
                    strength: sheen.strength * (1.0 - wetness) * (1.0 - 0.5 * dirt),
                    ..sheen
                },
            },
            weather,
            ..self.clone()
        }
    }
}
