//! Marching a ray through the coat: where the samples lie, and how they add up.
//!
//! These are the parts of the loop; the caller samples the density (a texture on the GPU, a [`Tile`](super::Tile) here) at
//! [`march_step`], takes the light from [`light`](super::light), and hands both to [`March::add`]. Lengths are in heights of the
//! coat and extinction is in optical depth per height, so that the product is an optical depth. Twin: `down_march.wgsl`.

use crate::maths::functions::{Real, clamp, fraction};

/// Steps of the near tier's march.
pub const NEAR_STEPS: f64 = 16.0;

/// Steps of the middle tier's: 8 cost 9 % of its mean seen from above (docs/book/undercoat.md#tiers).
pub const MIDDLE_STEPS: f64 = 14.0;

/// Mean optical depth at which a ray is cut off: `exp(-7)` is below 1/1000.
pub const DEPTH_CLIP: f64 = 7.0;

/// Transmittance at which a march may stop.
pub const OPAQUE: f64 = 0.003;

/// What a ray has gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct March<T> {
    /// Light towards the eye, premultiplied.
    pub radiance: [T; 3],
    /// Share of what lies behind that still shows, 0..=1.
    pub transmittance: T,
    /// Sum of distance times opacity: over `1 - transmittance`, the mean distance of what is seen.
    pub distance: T,
}

impl<T: Real> Default for March<T> {
    fn default() -> Self {
        Self {
            radiance: [T::zero(); 3],
            transmittance: T::one(),
            distance: T::zero(),
        }
    }
}

impl<T: Real> March<T> {
    /// One step: its optical depth, the radiance that an opaque piece of it would send, and its distance.
    pub fn add(self, depth: T, source: [T; 3], distance: T) -> Self {
        // Not a number counts as clear.
        let through = (-depth.max(T::zero())).exp();
        let weight = self.transmittance * (T::one() - through);
        Self {
            radiance: [0, 1, 2].map(|k: usize| self.radiance[k] + weight * source[k]),
            transmittance: self.transmittance * through,
            distance: self.distance + weight * distance,
        }
    }

    /// Over an opaque ground (the skin): radiance of the pixel.
    pub fn over(self, ground: [T; 3]) -> [T; 3] {
        [0, 1, 2].map(|k: usize| self.radiance[k] + self.transmittance * ground[k])
    }

    /// Opacity-weighted mean distance; 0 where nothing is seen.
    pub fn mean_distance(self) -> T {
        self.distance / (T::one() - self.transmittance).max(T::of(1e-6))
    }
}

/// Length of a ray worth marching through a uniform medium: `length`, or where its extinction `mean` has come to the depth `clip`.
pub fn march_length<T: Real>(length: T, mean: T, clip: T) -> T {
    length
        .max(T::zero())
        .min(clip.max(T::zero()) / mean.max(T::of(1e-6)))
}

/// Mean extinction at a height, per height of the coat, of a coat with the vertical optical depth `depth` whose mean column is
/// `depth (1 - z)^power` ([`Density::power`](super::Density::power); 1 for a uniform one).
pub fn mean_extinction<T: Real>(z: T, depth: T, power: T) -> T {
    let p = clamp(power, T::one(), T::of(8.0));
    depth.max(T::zero()) * p * (T::one() - clamp(z, T::zero(), T::one())).powf(p - T::one())
}

/// Height where a ray with the cosine `mu` to the normal, coming from the top, has met the mean optical depth `clip`; 0 where it
/// reaches the skin first. A ray need not be marched below it: what is left over the skin then counts as lit like the last step.
///
/// The top of a clumpy coat is nearly clear: [`march_length`] with one mean extinction would cut grazing rays off before they meet
/// anything.
pub fn march_floor<T: Real>(mu: T, depth: T, power: T, clip: T) -> T {
    let p = clamp(power, T::one(), T::of(8.0));
    let share = clip.max(T::zero()) * mu.max(T::zero()) / depth.max(T::of(1e-6));
    T::one() - share.min(T::one()).powf(T::one() / p)
}

/// Where sample `i` lies and how long its step is, both as shares of the ray. `count` (1..=64) may be fractional: the last step is
/// then short, and passes into none without a jump. There are `ceil(count)` steps; `jitter` (0..1) is 0.5 for midpoints.
pub fn march_step<T: Real>(i: u32, count: T, jitter: T) -> (T, T) {
    let count = clamp(count, T::one(), T::of(64.0));
    let first = T::of(f64::from(i));
    let width = clamp(count - first, T::zero(), T::one());
    ((first + jitter * width) / count, width / count)
}

/// Where in a step of optical depth `depth` its light is met, as a share of it from the eye's side: half-way between the middle and
/// the mean place of what is seen of a uniform step, because coats grow denser downwards. Cuts the bias of 16 steps to a half or less.
pub fn march_lit<T: Real>(depth: T) -> T {
    // The mean place is 1 / d - 1 / (exp(d) - 1); three terms of its inverse, error 0.006 up to a depth of 4
    // (docs/book/fits/columns.py).
    let d = clamp(depth, T::zero(), T::of(8.0));
    let mean = T::one() / (T::of(2.0) + d * T::of(1.0 / 3.0) + d * d * T::of(1.0 / 18.0));
    T::of(0.25) + T::of(0.5) * mean
}

/// How far a fibre that leans over by `bend` (0..=1, `Down::bend`) has come along the lay at height `z`, in heights
/// of the coat: the integral of its slope `bend z / (1 - bend z)`.
pub fn lean_shift<T: Real>(z: T, bend: T) -> T {
    let b = clamp(bend, T::zero(), T::of(0.95));
    let z = clamp(z, T::zero(), T::one());
    let x = b * z;
    if x < T::of(0.05) {
        // Its series: the difference below would cancel.
        return z * x * (T::of(0.5) + x * (T::of(1.0 / 3.0) + x * T::of(0.25)));
    }
    -z - (T::one() - x).ln() / b
}

/// Jitter of a pixel in a frame: `noise` (blue noise of the pixel, 0..1, never of the place in the world) advanced by the golden
/// ratio. 0.5 without temporal antialiasing.
pub fn march_jitter<T: Real>(noise: T, frame: u32) -> T {
    fraction(noise + T::of(f64::from(frame & 1023)) * T::of(0.618_033_988_749_895))
}

/// Level of the density's mip chain for a pixel that covers `cells` cells of it (a length): 0..=`deepest`, fractional.
pub fn march_mip<T: Real>(cells: T, deepest: T) -> T {
    clamp(cells.max(T::one()).log2(), T::zero(), deepest)
}

/// What fibres along `tangent` block of a ray with the cosine `cos` to them, over what they block across: the sine, with a floor
/// from the spread of their directions (0: parallel fibres, 1: random ones). Without the floor a coat is transparent, and black, along
/// its fibres (docs/book/undercoat.md#density).
pub fn extinction_sine<T: Real>(cos: T, spread: T) -> T {
    let c = clamp(cos * cos, T::zero(), T::one());
    let e = clamp(spread, T::zero(), T::one());
    (T::one() - c + e * e * c).sqrt()
}
