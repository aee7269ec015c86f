//! Several bounces: light that meets fibre after fibre, for measuring what single scattering leaves out.

use super::{CurveShader, Curves, Ray, shade::world, trace::lit_point};
use bevy_plumage::maths::scattering::fibre_sample;

/// Where a path left the feather.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape {
    /// Unit direction of travel, card space.
    pub direction: [f64; 3],
    /// Product of albedos on the way, linear RGB.
    pub weight: [f64; 3],
    /// Fibres met.
    pub bounces: u32,
}

/// Follows light backwards from the eye through the feather until it escapes. None: the first ray meets nothing. A path still
/// inside after `most` bounces ends with weight 0.
///
/// The mean weight over rays that hit is the share of a white furnace's light that comes back to the eye. `albedo` replaces
/// the painted color. Every fibre scatters by its far field: the way in and the way out are at independent places of its width.
pub fn furnace_path(
    curves: &Curves,
    shader: &CurveShader,
    ray: Ray,
    albedo: [f64; 3],
    most: u32,
    mut random: impl FnMut() -> f64,
) -> Option<Escape> {
    let mut hit = curves.hit(&ray, f64::NEG_INFINITY, None)?;
    let mut direction = ray.direction;
    let mut weight = [1.0; 3];
    for bounces in 1..=most {
        let s = shader.prepare(&hit, direction, albedo);
        let sample = fibre_sample(&s, [random(), random(), random(), random()]);
        let Some(sample) = sample else {
            return Some(Escape {
                direction,
                weight: [0.0; 3],
                bounces,
            });
        };
        direction = world(hit.tangent, sample.direction);
        weight = [0, 1, 2].map(|c| weight[c] * sample.weight[c]);
        let next = Ray {
            origin: lit_point(&hit, direction, 2.0 * random() - 1.0),
            direction,
        };
        match curves.hit(&next, 0.0, Some(hit.fibre)) {
            Some(other) => hit = other,
            None => {
                return Some(Escape {
                    direction,
                    weight,
                    bounces,
                });
            }
        }
    }
    Some(Escape {
        direction,
        weight: [0.0; 3],
        bounces: most,
    })
}
