//! A flat piece of coat, looked at along one ray: the whole shading of the near and middle tiers on the processor. It bakes the far
//! tier's table, and is what the charts compare with the dense reference.

use super::{
    Density,
    light::{
        column_transmittance, kajiya_kay_diffuse, light_exit, light_step, multiple_scattering,
        scattering_albedo, sky_irradiance, sky_visibility,
    },
    march::{DEPTH_CLIP, MIDDLE_STEPS, March, NEAR_STEPS, march_floor, march_lit, march_step},
};
use crate::maths::functions::{Real, clamp};

/// How the key light reaches a place in the coat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightModel {
    /// It is not blocked at all.
    Open,
    /// By the mean optical depth above the height: no look-up.
    MeanColumn,
    /// By that many quadratic steps.
    Steps(u32),
    /// By that many equal steps through the next four cells, and the mean column above them.
    Near(u32),
}

/// What a coat is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat<T> {
    /// Albedo of a fibre, per color channel, 0..=1.
    pub albedo: [T; 3],
    /// Reflectance of the skin, 0..=1.
    pub skin: [T; 3],
}

/// How to march.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabSettings<T> {
    /// Steps along the ray, 1..=64, may be fractional.
    pub steps: T,
    /// Level of the density's chain, fractional.
    pub mip: T,
    /// Place of the samples in their steps, 0.5 for the middle.
    pub jitter: T,
    /// Mean optical depth at which the ray is cut off.
    pub clip: T,
    /// Light.
    pub light: LightModel,
    /// Whether to multiply by [`multiple_scattering`].
    pub multiple: bool,
    /// What the fibres block towards the eye and towards the light, over what the density says; 1 for random directions.
    pub sines: [T; 2],
}

impl<T: Real> SlabSettings<T> {
    /// The near tier: 16 steps, 4 light steps.
    pub fn near() -> Self {
        Self {
            steps: T::of(NEAR_STEPS),
            mip: T::zero(),
            jitter: T::of(0.5),
            clip: T::of(DEPTH_CLIP),
            light: LightModel::Steps(4),
            multiple: true,
            sines: [T::one(); 2],
        }
    }

    /// The middle tier: 14 steps one level up, light by the mean column.
    pub fn middle() -> Self {
        Self {
            steps: T::of(MIDDLE_STEPS),
            mip: T::one(),
            light: LightModel::MeanColumn,
            ..Self::near()
        }
    }
}

/// A ray that enters the top of the slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabRay<T> {
    /// Where it enters, in tiles.
    pub place: [T; 2],
    /// Unit direction to the eye, z along the normal, z > 0.
    pub eye: [T; 3],
    /// Unit direction to the light.
    pub light: [T; 3],
}

/// Share of the light that reaches a place.
pub fn slab_visibility<T: Real>(
    density: &Density,
    place: [T; 3],
    light: [T; 3],
    model: LightModel,
    mip: T,
    sine: T,
) -> T {
    let mu = light[2];
    if mu <= T::zero() {
        return T::zero();
    }
    let tiles = T::one() / T::of(f64::from(density.width()));
    let at = |way: T| {
        [
            place[0] + way * light[0] * tiles,
            place[1] + way * light[1] * tiles,
            place[2] + way * light[2],
        ]
    };
    let way = light_exit(place[2], mu, T::zero());
    match model {
        LightModel::Open => T::one(),
        LightModel::MeanColumn => column_transmittance(sine * density.column(place[2]), mu),
        LightModel::Steps(count) => {
            let mut depth = T::zero();
            for i in 0..count.min(64) {
                let (middle, width) = light_step::<T>(i, count);
                depth = depth + density.sample(at(middle * way), mip) * width * way;
            }
            (-depth * sine).exp()
        }
        LightModel::Near(count) => {
            let count = count.clamp(1, 64);
            let cells = T::of(4.0 / f64::from(density.levels()[0].size.z));
            let near = way.min(cells * T::of(2.0).powf(mip));
            let step = near / T::of(f64::from(count));
            let mut depth = T::zero();
            for i in 0..count {
                let middle = (T::of(f64::from(i)) + T::of(0.5)) * step;
                depth = depth + density.sample(at(middle), mip) * step;
            }
            (-depth * sine).exp() * column_transmittance(sine * density.column(at(near)[2]), mu)
        }
    }
}

/// Length of a ray worth marching, in heights.
fn slab_length<T: Real>(density: &Density, mu: T, clip: T, sine: T) -> T {
    let (depth, power) = (f64::from(density.mean()), f64::from(density.power()));
    (T::one() - march_floor(mu, sine * T::of(depth), T::of(power), clip)) / mu
}

/// Radiance towards the eye under a directional light of irradiance pi (a white diffuse wall facing it has radiance 1), with an opaque
/// skin below. Fibres of random directions: the sines are dropped.
pub fn slab_radiance<T: Real>(
    density: &Density,
    coat: &Coat<T>,
    ray: &SlabRay<T>,
    settings: &SlabSettings<T>,
) -> [T; 3] {
    let pi = T::of(core::f64::consts::PI);
    let mu = clamp(ray.eye[2], T::of(0.02), T::one());
    let tiles = T::one() / T::of(f64::from(density.width()));
    let whole = T::one() / mu;
    let mean = T::of(f64::from(density.mean()));
    let length = slab_length(density, mu, settings.clip, settings.sines[0]);
    let depth = mean;
    let factor = [0, 1, 2].map(|k: usize| {
        let single = pi * kajiya_kay_diffuse(coat.albedo[k], T::zero(), T::one());
        if settings.multiple {
            let albedo = scattering_albedo(coat.albedo[k], coat.skin[k], depth);
            single * multiple_scattering(mu, ray.light[2].max(T::zero()), albedo)
        } else {
            single
        }
    });
    let at = |t: T| {
        [
            ray.place[0] - t * ray.eye[0] * tiles,
            ray.place[1] - t * ray.eye[1] * tiles,
            T::one() - t * ray.eye[2],
        ]
    };
    let mut march = March::default();
    let mut last = T::zero();
    let count = settings.steps.ceil().to_u32().unwrap_or(1).clamp(1, 64);
    for i in 0..count {
        let (share, width) = march_step(i, settings.steps, settings.jitter);
        let depth =
            density.sample(at(share * length), settings.mip) * settings.sines[0] * width * length;
        let lit = at((share + (march_lit(depth) - settings.jitter) * width) * length);
        let visible = slab_visibility(
            density,
            lit,
            ray.light,
            settings.light,
            settings.mip,
            settings.sines[1],
        );
        march = march.add(depth, factor.map(|f| f * visible), share * length);
        // A short last step counts for its share: nothing jumps as steps come and go.
        last = last + (visible - last) * clamp(width * settings.steps, T::zero(), T::one());
    }
    if length < whole {
        // What is cut off counts as opaque and lit like the last step.
        return march.over(factor.map(|f| f * last));
    }
    let place = at(whole);
    let mut visible = slab_visibility(
        density,
        place,
        ray.light,
        settings.light,
        settings.mip,
        settings.sines[1],
    );
    visible = visible * ray.light[2].max(T::zero());
    march.over(coat.skin.map(|s| s * visible))
}

/// Radiance towards the eye under a uniform sky of radiance 1, without a look-up for light.
pub fn slab_sky<T: Real>(
    density: &Density,
    coat: &Coat<T>,
    ray: &SlabRay<T>,
    settings: &SlabSettings<T>,
) -> [T; 3] {
    let mu = clamp(ray.eye[2], T::of(0.02), T::one());
    let tiles = T::one() / T::of(f64::from(density.width()));
    let whole = T::one() / mu;
    let mean = T::of(f64::from(density.mean()));
    let length = slab_length(density, mu, settings.clip, settings.sines[0]);
    let mut march = March::default();
    let mut last = [T::zero(); 3];
    let count = settings.steps.ceil().to_u32().unwrap_or(1).clamp(1, 64);
    for i in 0..count {
        let (share, width) = march_step(i, settings.steps, settings.jitter);
        let t = share * length;
        let place = [
            ray.place[0] - t * ray.eye[0] * tiles,
            ray.place[1] - t * ray.eye[1] * tiles,
            T::one() - t * ray.eye[2],
        ];
        let depth = density.sample(place, settings.mip) * settings.sines[0] * width * length;
        let lit = T::one() - (share + (march_lit(depth) - settings.jitter) * width) * length * mu;
        // Half the sky above, through the mean column.
        let visible = T::of(0.5) * sky_visibility(density.column(lit));
        let source = [0, 1, 2].map(|k: usize| {
            let albedo = scattering_albedo(coat.albedo[k], coat.skin[k], mean);
            let many = if settings.multiple {
                multiple_scattering(mu, T::of(0.5), albedo)
            } else {
                T::one()
            };
            coat.albedo[k] * visible * many
        });
        march = march.add(depth, source, t);
        let part = clamp(width * settings.steps, T::zero(), T::one());
        last = [0, 1, 2].map(|k: usize| last[k] + (source[k] - last[k]) * part);
    }
    if length < whole {
        return march.over(last);
    }
    let ground = sky_irradiance(mean);
    march.over(coat.skin.map(|s| s * ground))
}
