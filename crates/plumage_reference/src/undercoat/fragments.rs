//! Virtual fragments: how a marched volume mixes with strands drawn into it (docs/book/undercoat.md#virtual-fragments).
//!
//! A ray's march is gathered into a few slabs; each slab becomes one transparent fragment at its opacity-weighted mean depth,
//! sorted with the strands' own. Slabs of equal opacity lose least. Twin of `down_fragments.wgsl`.

use bevy_plumage::maths::{Real, clamp, real};

/// Most virtual fragments of one ray.
pub const MOST_FRAGMENTS: usize = 8;

/// A transparent surface in a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fragment<T> {
    /// Straight (not premultiplied) radiance.
    pub color: [T; 3],
    /// Opacity, 0 to 1.
    pub alpha: T,
    /// Distance from the eye along the ray, or any depth that grows with it.
    pub depth: T,
}

/// A march being gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slabs<T> {
    /// Per slab: premultiplied radiance and, last, the sum of depth times opacity.
    light: [[T; 4]; MOST_FRAGMENTS],
    /// Per slab: its transmittance.
    transmittance: [T; MOST_FRAGMENTS],
    /// Number of slabs.
    count: usize,
    /// Opacity at which the last slab ends.
    whole: T,
    /// Opacity so far.
    opacity: T,
}

/// Begins a march of `count` slabs (1 to 8) through a medium whose optical depth is expected to be `optical_depth`. An exact
/// depth gives slabs of exactly equal opacity; the mean depth of the tile does nearly as well.
pub fn slabs<T: Real>(count: u32, optical_depth: T) -> Slabs<T> {
    let zero = T::zero();
    Slabs {
        light: [[zero; 4]; MOST_FRAGMENTS],
        transmittance: [T::one(); MOST_FRAGMENTS],
        count: (count as usize).clamp(1, MOST_FRAGMENTS),
        whole: (T::one() - (-optical_depth.max(zero)).exp()).max(real(1e-6)),
        opacity: zero,
    }
}

/// Adds a step of the march, front to back: its straight radiance, its opacity and the depth of its middle. A step that passes
/// the end of a slab is cut there.
pub fn slab_add<T: Real>(slabs: &mut Slabs<T>, radiance: [T; 3], alpha: T, depth: T) {
    let one = T::one();
    let mut rest = one - clamp(alpha, T::zero(), one);
    for _ in 0..slabs.count {
        let before = one - slabs.opacity;
        let place = slabs.opacity * real(slabs.count as f64) / slabs.whole;
        let index = place.to_usize().unwrap_or(0).min(slabs.count - 1);
        // Transmittance from the eye where this slab ends; the last one takes all that comes.
        let end = if index + 1 == slabs.count {
            T::zero()
        } else {
            one - slabs.whole * real((index + 1) as f64 / slabs.count as f64)
        };
        let part = rest.max((end / before.max(real(1e-6))).min(one));
        let done = part <= rest;
        let share = slabs.transmittance[index] * (one - part);
        let light = &mut slabs.light[index];
        for (sum, value) in light.iter_mut().zip(radiance) {
            *sum = *sum + share * value;
        }
        light[3] = light[3] + share * depth;
        slabs.transmittance[index] = slabs.transmittance[index] * part;
        // Past the end by a rounding error, so that the next part falls into the next slab.
        slabs.opacity = if done {
            one - before * part
        } else {
            slabs.whole * real((index + 1) as f64 / slabs.count as f64) * real(1.000_000_5)
        };
        if done {
            return;
        }
        rest = rest / part.max(real(1e-6));
    }
}

/// The fragment of slab `index`; its opacity is 0 where nothing fell into it.
pub fn slab_fragment<T: Real>(slabs: &Slabs<T>, index: usize) -> Fragment<T> {
    let index = index.min(MOST_FRAGMENTS - 1);
    let alpha = T::one() - slabs.transmittance[index];
    let light = slabs.light[index];
    if alpha <= real(1e-6) {
        return Fragment {
            color: [T::zero(); 3],
            alpha: T::zero(),
            depth: T::zero(),
        };
    }
    Fragment {
        color: [light[0] / alpha, light[1] / alpha, light[2] / alpha],
        alpha,
        depth: light[3] / alpha,
    }
}

/// Radiance of fragments over a background, sorted here (front first) and composited.
pub fn blend<T: Real>(fragments: &mut [Fragment<T>], background: [T; 3]) -> [T; 3] {
    fragments.sort_by(|a, b| {
        a.depth
            .partial_cmp(&b.depth)
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut sum = [T::zero(); 3];
    let mut left = T::one();
    for fragment in fragments.iter() {
        let alpha = clamp(fragment.alpha, T::zero(), T::one());
        for (sum, c) in sum.iter_mut().zip(fragment.color) {
            *sum = *sum + left * alpha * c;
        }
        left = left * (T::one() - alpha);
    }
    for (sum, c) in sum.iter_mut().zip(background) {
        *sum = *sum + left * c;
    }
    sum
}

/// The simplified blending of *Hybrid fur rendering*, for comparison: the whole fur is one fragment at the front of its shell, made
/// more transparent by the strands behind it.
pub mod published {
    use super::Fragment;
    use bevy_plumage::maths::{Real, clamp};

    /// Eq. (4) as printed: each strand behind the shell takes `exp(-attenuation distance)` off its opacity, however transparent the
    /// strand is.
    pub fn alpha<T: Real>(fur: &Fragment<T>, strands: &[Fragment<T>], attenuation: T) -> T {
        let taken = strands
            .iter()
            .filter(|s| s.depth >= fur.depth)
            .fold(T::zero(), |sum, s| {
                sum + (-(attenuation * (s.depth - fur.depth))).exp()
            });
        clamp(fur.alpha - taken, T::zero(), T::one())
    }

    /// The repair: a product over the strands, each with its own opacity (docs/book/undercoat.md#virtual-fragments).
    pub fn product_alpha<T: Real>(fur: &Fragment<T>, strands: &[Fragment<T>], attenuation: T) -> T {
        strands
            .iter()
            .filter(|s| s.depth >= fur.depth)
            .fold(fur.alpha, |alpha, s| {
                alpha * (T::one() - s.alpha * (-(attenuation * (s.depth - fur.depth))).exp())
            })
    }
}
