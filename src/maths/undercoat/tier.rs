//! Which tier draws the undercoat, and whether it is drawn at all (docs/book/undercoat.md#tiers). Twin of the weights:
//! `down_tier.wgsl`.

use super::{
    Density,
    march::{MIDDLE_STEPS, NEAR_STEPS, march_mip},
    slab::{Coat, SlabRay, SlabSettings, slab_radiance, slab_sky},
};
use crate::maths::functions::{Real, clamp};

/// Thickness in pixels from which the near tier, and the middle tier, draw.
pub const TIER_PX: [f64; 2] = [12.0, 3.0];

/// Width of a transition, as a share of its thickness. 0.25 takes a dolly a little over 1/255 a frame
/// (docs/book/undercoat.md#tiers).
pub const TRANSITION: f64 = 0.35;

/// Contrast of down against a skin tinted with its mean color (an estimate: docs/book/undercoat.md#when-it-is-drawn-at-all).
pub const CONTRAST: f64 = 0.3;

/// Cover that contour feathers really give: what the groom measured (`cover`, layers), with the feathers lifted by `lift` radians, the
/// skin stretched to `area` times its rest area, and the share `moult` of them missing.
pub fn cover_now<T: Real>(cover: T, lift: T, area: T, moult: T) -> T {
    let stand = clamp(lift.cos(), T::zero(), T::one());
    let left = T::one() - clamp(moult, T::zero(), T::one());
    cover.max(T::zero()) * stand * left / area.max(T::of(1e-3))
}

/// Share of the undercoat that shows through that many layers of disordered contour feathers (docs/book/fits/cover.py).
pub fn cover_transmittance<T: Real>(cover: T) -> T {
    (T::of(-1.07) * cover.max(T::zero())).exp()
}

/// Whether a tract's undercoat is drawn: its largest difference `contrast` times what shows is above `error` (1/255), or the feathers are
/// lifted by more than 20 degrees (`lift` in radians). `drawn` is the last answer: it holds on over 0.3 layers.
pub fn is_drawn<T: Real>(cover: T, lift: T, contrast: T, error: T, drawn: bool) -> bool {
    // Not below four layers, where V c comes to the usual error.
    let limit = (contrast / error.max(T::of(1e-6))).max(T::one()).ln() / T::of(1.07);
    let hold = if drawn { T::of(0.3) } else { T::zero() };
    cover < limit + hold || lift > T::of(20.0f64.to_radians())
}

/// Shares of the tiers; they sum to 1, and no more than two are not 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TierMix<T> {
    /// Near: 16 steps, 4 light steps.
    pub near: T,
    /// Middle: 14 steps one level up, mean column.
    pub middle: T,
    /// Far: the table.
    pub far: T,
    /// Steps of the march, [`MIDDLE_STEPS`]..=[`NEAR_STEPS`], fractional.
    pub steps: T,
    /// Level of the density's chain, 0..=1.
    pub mip: T,
    /// Opacity of the rim: thin coats cover less than a pixel.
    pub rim: T,
}

/// The tiers of a tract whose coat is `thickness` pixels thick on screen, with the limits `px` ([`TIER_PX`]).
pub fn tier_mix<T: Real>(thickness: T, px: [T; 2]) -> TierMix<T> {
    let ramp = |limit: T| {
        let width = limit.max(T::of(1e-3)) * T::of(TRANSITION);
        let x = (thickness - limit) / width + T::of(0.5);
        let x = clamp(x, T::zero(), T::one());
        x * x * (T::of(3.0) - x - x)
    };
    let near = ramp(px[0]);
    let above = ramp(px[1].min(px[0] * T::of(0.7)));
    TierMix {
        near,
        middle: above - near,
        far: T::one() - above,
        steps: T::of(MIDDLE_STEPS) + T::of(NEAR_STEPS - MIDDLE_STEPS) * near,
        mip: T::one() - near,
        rim: clamp(thickness / px[1].max(T::of(1e-3)), T::zero(), T::one()),
    }
}

/// Nodes of a [`FarTable`] along each axis.
pub const FAR_SIZE: usize = 8;

/// Mean radiance of a coat, by the cosines of eye and light to the normal, for the far tier; and what the middle tier's mean must be
/// multiplied with to agree.
#[derive(Clone, Debug, PartialEq)]
pub struct FarTable {
    /// Under a light of irradiance pi, `eye + FAR_SIZE * light`.
    pub light: Vec<[f32; 3]>,
    /// Near over middle, likewise.
    pub correction: Vec<[f32; 3]>,
    /// Under a uniform sky of radiance 1, by the eye.
    pub sky: [[f32; 3]; FAR_SIZE],
}

/// Cosine of a node: 0.08 to 1, denser at grazing angles.
pub fn far_cosine(node: usize) -> f32 {
    let x = node.min(FAR_SIZE - 1) as f32 / (FAR_SIZE - 1) as f32;
    0.08 + 0.92 * x * x
}

/// Node coordinate of a cosine, 0..=FAR_SIZE - 1.
pub fn far_node<T: Real>(cosine: T) -> T {
    let x = clamp((cosine - T::of(0.08)) / T::of(0.92), T::zero(), T::one());
    x.sqrt() * T::of((FAR_SIZE - 1) as f64)
}

impl FarTable {
    /// Averages the near renderer over a tile: `rays` a node and azimuth (two of those).
    pub fn bake(density: &Density, coat: &Coat<f32>, rays: u32) -> Self {
        let rays = rays.clamp(1, 65_536);
        let direction = |cosine: f32, azimuth: f32| {
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            [sine * azimuth.cos(), sine * azimuth.sin(), cosine]
        };
        let mean =
            |eye: f32, f: &dyn Fn(SlabRay<f32>) -> [f32; 3], azimuths: &[f32], light: f32| {
                let mut sum = [0.0f64; 3];
                for (k, azimuth) in azimuths.iter().enumerate() {
                    for i in 0..rays {
                        // Fibonacci lattice over the tile.
                        let x = (i as f32 + 0.5) / rays as f32;
                        let y = (f64::from(i) * 0.618_033_988_749_895).fract() as f32;
                        // Every ray its own azimuth of the view, so that the tile's axes do not show.
                        let turn = std::f32::consts::TAU
                            * (f64::from(i) * 0.754_877_666_246_693).fract() as f32;
                        let ray = SlabRay {
                            place: [x + 0.5 * k as f32 / rays as f32, y],
                            eye: direction(eye, turn),
                            light: direction(light, turn + azimuth),
                        };
                        let found = f(ray);
                        for (s, v) in sum.iter_mut().zip(found) {
                            *s += f64::from(v);
                        }
                    }
                }
                sum.map(|s| (s / f64::from(rays) / azimuths.len() as f64) as f32)
            };
        let azimuths = [60.0f32.to_radians(), 120.0f32.to_radians()];
        let near = SlabSettings::near();
        let middle = SlabSettings::middle();
        let mut light = Vec::with_capacity(FAR_SIZE * FAR_SIZE);
        let mut correction = Vec::with_capacity(FAR_SIZE * FAR_SIZE);
        for l in 0..FAR_SIZE {
            for e in 0..FAR_SIZE {
                let (l, e) = (far_cosine(l), far_cosine(e));
                let fine = mean(
                    e,
                    &|r| slab_radiance(density, coat, &r, &near),
                    &azimuths,
                    l,
                );
                let rough = mean(
                    e,
                    &|r| slab_radiance(density, coat, &r, &middle),
                    &azimuths,
                    l,
                );
                light.push(fine);
                correction.push(std::array::from_fn(|k| {
                    (fine[k] / rough[k].max(1e-6)).clamp(0.25, 4.0)
                }));
            }
        }
        let sky = std::array::from_fn(|e| {
            let f = |r: SlabRay<f32>| slab_sky(density, coat, &r, &near);
            mean(far_cosine(e), &f, &azimuths[..1], 1.0)
        });
        Self {
            light,
            correction,
            sky,
        }
    }

    fn at(table: &[[f32; 3]], eye: f32, light: f32) -> [f32; 3] {
        let (e, l) = (far_node(eye), far_node(light));
        let last = (FAR_SIZE - 2) as f32;
        let (i, k) = (e.floor().min(last), l.floor().min(last));
        let (s, t) = (e - i, l - k);
        let (i, k) = (i as usize, k as usize);
        std::array::from_fn(|c| {
            let value = |i: usize, k: usize| table[i + FAR_SIZE * k][c];
            let low = value(i, k) * (1.0 - s) + value(i + 1, k) * s;
            let high = value(i, k + 1) * (1.0 - s) + value(i + 1, k + 1) * s;
            low * (1.0 - t) + high * t
        })
    }

    /// Mean radiance under a light of irradiance pi at the cosines `eye` and `light`; nothing from below the horizon.
    pub fn radiance(&self, eye: f32, light: f32) -> [f32; 3] {
        // Below the lowest node the light fades with its cosine.
        let fade = (light / far_cosine(0)).clamp(0.0, 1.0);
        Self::at(&self.light, eye, light).map(|x| x * fade)
    }

    /// What the middle tier is multiplied with.
    pub fn correction(&self, eye: f32, light: f32) -> [f32; 3] {
        Self::at(&self.correction, eye, light)
    }

    /// Mean radiance under a uniform sky of radiance 1.
    pub fn sky(&self, eye: f32) -> [f32; 3] {
        let e = far_node(eye);
        let i = e.floor().min((FAR_SIZE - 2) as f32);
        let (s, i) = (e - i, i as usize);
        std::array::from_fn(|c| self.sky[i][c] * (1.0 - s) + self.sky[i + 1][c] * s)
    }
}

/// What the middle tier must be multiplied with, that its mean is that of the near one, 0.25..=4: of the light,
/// `eye + FAR_SIZE * light` over [`far_cosine`], then of the sky by the eye. From `rays` rays a node and azimuth; the coat's color
/// hardly matters.
///
/// `blocked` is what the fibres block of a ray by its cosine to the normal, over what the density says. Both tiers look at the level
/// that a pixel has where they meet.
pub fn tier_correction(
    density: &Density,
    rays: u32,
    blocked: impl Fn(f32) -> f32,
) -> [f32; FAR_SIZE * (FAR_SIZE + 1)] {
    let coat = Coat {
        albedo: [0.8f32; 3],
        skin: [0.4; 3],
    };
    let cells = density.levels()[0].size.x as f32 / density.width();
    let level = march_mip(cells / TIER_PX[0] as f32, 2.0);
    let count = 2 * rays.clamp(1, 65_536);
    let ray = |i: u32, eye: f32, light: f32| {
        let share = |step: f64| (f64::from(i) * step).fract() as f32;
        let turn = std::f32::consts::TAU * share(0.754_877_666_246_693);
        let apart = if i.is_multiple_of(2) { 60.0f32 } else { 120.0 }.to_radians();
        let direction = |cosine: f32, azimuth: f32| {
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            [sine * azimuth.cos(), sine * azimuth.sin(), cosine]
        };
        SlabRay {
            place: [
                (i as f32 + 0.5) / count as f32,
                share(0.618_033_988_749_895),
            ],
            eye: direction(eye, turn),
            light: direction(light, turn + apart),
        }
    };
    std::array::from_fn(|node| {
        let eye = far_cosine(node % FAR_SIZE);
        let light = far_cosine(node / FAR_SIZE);
        let near = SlabSettings {
            mip: level,
            sines: [blocked(eye), blocked(light)],
            ..SlabSettings::near()
        };
        let middle = SlabSettings {
            mip: level.max(1.0),
            sines: near.sines,
            ..SlabSettings::middle()
        };
        let (mut fine, mut rough) = (0.0, 0.0);
        for i in 0..count {
            if node < FAR_SIZE * FAR_SIZE {
                let ray = ray(i, eye, light);
                fine += slab_radiance(density, &coat, &ray, &near)[1];
                rough += slab_radiance(density, &coat, &ray, &middle)[1];
            } else {
                let ray = ray(i, eye, 1.0);
                fine += slab_sky(density, &coat, &ray, &near)[1];
                rough += slab_sky(density, &coat, &ray, &middle)[1];
            }
        }
        (fine / rough.max(1e-6)).clamp(0.25, 4.0)
    })
}

/// A pixel of the coat at the thickness that `mix` stands for: the tiers blended as the shader blends them.
pub fn tier_radiance(
    density: &Density,
    coat: &Coat<f32>,
    far: &FarTable,
    ray: &SlabRay<f32>,
    mix: &TierMix<f32>,
) -> [f32; 3] {
    let mut sum = [0.0; 3];
    let mut add = |weight: f32, value: [f32; 3]| {
        for (s, v) in sum.iter_mut().zip(value) {
            *s += weight * v;
        }
    };
    let march = |settings: SlabSettings<f32>| {
        let settings = SlabSettings {
            steps: mix.steps,
            mip: mix.mip,
            ..settings
        };
        slab_radiance(density, coat, ray, &settings)
    };
    if mix.near > 0.0 {
        add(mix.near, march(SlabSettings::near()));
    }
    if mix.middle > 0.0 {
        let correction = far.correction(ray.eye[2], ray.light[2]);
        let found = march(SlabSettings::middle());
        add(
            mix.middle,
            std::array::from_fn(|k| found[k] * correction[k]),
        );
    }
    if mix.far > 0.0 {
        add(mix.far, far.radiance(ray.eye[2], ray.light[2]));
    }
    sum
}
