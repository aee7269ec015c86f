//! Pixels in which fur and strands mix, with their exact radiance.

use plumage_reference::undercoat::fragments::*;
use rand_pcg::{
    Pcg64Mcg,
    rand_core::{Rng, SeedableRng},
};

type F = Fragment<f64>;

/// Steps of the judge's march.
const FINE: usize = 2000;
/// Steps of the march that is judged.
const STEPS: usize = 64;

/// A ray through fur of unit depth, with strands in it.
pub struct Pixel {
    /// Optical depth per unit of depth, and radiance, of each fine step.
    pub extinction: Vec<f64>,
    pub radiance: Vec<[f64; 3]>,
    pub strands: Vec<F>,
    pub background: [f64; 3],
}

fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

impl Pixel {
    /// Clumped fur of optical depth 4 on average, lit less and less towards the skin, and strands of other colors. Contrast and
    /// opacity of the strands are such that the methods which are not judged here (one fragment at the front, Eq. 4) err as in
    /// docs/book/undercoat.md#reference-values.
    fn new(random: &mut Pcg64Mcg, strands: usize) -> Self {
        let clumps: Vec<f64> = (0..12).map(|_| uniform(random).powi(2)).collect();
        let light = 0.5 + uniform(random);
        let tint = [0; 3].map(|_| 0.5 + 0.5 * uniform(random));
        let mut extinction = Vec::new();
        let mut radiance = Vec::new();
        for i in 0..FINE {
            let x = (i as f64 + 0.5) / FINE as f64;
            let at = x * 11.0;
            let (k, f) = (at.floor() as usize, at.fract());
            let f = f * f * (3.0 - 2.0 * f);
            extinction.push(12.0 * (clumps[k] * (1.0 - f) + clumps[k + 1] * f));
            radiance.push(tint.map(|t| t * light * (-1.5 * x).exp()));
        }
        let strands = (0..strands)
            .map(|_| {
                let shade = 0.4 + 0.8 * uniform(random);
                F {
                    color: [0; 3].map(|_| shade * (0.6 + 0.4 * uniform(random))),
                    alpha: 0.1 + 0.6 * uniform(random),
                    depth: uniform(random),
                }
            })
            .collect();
        Self {
            extinction,
            radiance,
            strands,
            background: [0.1; 3],
        }
    }

    /// The fur as a march of `steps`: radiance, opacity, depth.
    pub fn march(&self, steps: usize) -> Vec<([f64; 3], f64, f64)> {
        let part = FINE / steps;
        (0..steps)
            .map(|i| {
                let range = i * part..(i + 1) * part;
                let depth: f64 = self.extinction[range.clone()].iter().sum::<f64>() / FINE as f64;
                let middle = self.radiance[i * part + part / 2];
                (
                    middle,
                    1.0 - (-depth).exp(),
                    (i as f64 + 0.5) / steps as f64,
                )
            })
            .collect()
    }

    /// Optical depth of the whole fur.
    pub fn optical_depth(&self) -> f64 {
        self.extinction.iter().sum::<f64>() / FINE as f64
    }

    /// The judge: fine steps and strands one by one, front to back.
    pub fn exact(&self) -> [f64; 3] {
        let mut order: Vec<&F> = self.strands.iter().collect();
        order.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        let mut waiting = order.into_iter().peekable();
        let mut sum = [0.0; 3];
        let mut left = 1.0;
        let mut add = |color: [f64; 3], alpha: f64| {
            for (sum, c) in sum.iter_mut().zip(color) {
                *sum += left * alpha * c;
            }
            left *= 1.0 - alpha;
        };
        for i in 0..FINE {
            let depth = (i + 1) as f64 / FINE as f64;
            while let Some(strand) = waiting.next_if(|s| s.depth < depth) {
                add(strand.color, strand.alpha);
            }
            add(
                self.radiance[i],
                1.0 - (-self.extinction[i] / FINE as f64).exp(),
            );
        }
        for strand in waiting {
            add(strand.color, strand.alpha);
        }
        add(self.background, 1.0);
        sum
    }

    /// The fur as so many virtual fragments, cut for an expected optical depth.
    pub fn virtual_fragments(&self, count: u32, optical_depth: f64) -> [f64; 3] {
        let mut slabs = slabs(count, optical_depth);
        for (radiance, alpha, depth) in self.march(STEPS) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let own = (0..count as usize).map(|k| slab_fragment(&slabs, k));
        let mut all: Vec<F> = own.chain(self.strands.iter().copied()).collect();
        blend(&mut all, self.background)
    }

    /// The whole fur as one fragment, at its mean depth or at its front.
    pub fn one(&self, front: bool) -> [f64; 3] {
        let mut slabs = slabs(1, self.optical_depth());
        for (radiance, alpha, depth) in self.march(STEPS) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let mut fur = slab_fragment(&slabs, 0);
        if front {
            fur.depth = 0.0;
        }
        let mut all: Vec<F> = std::iter::once(fur)
            .chain(self.strands.iter().copied())
            .collect();
        blend(&mut all, self.background)
    }

    /// Eq. (4), or its repair as a product.
    pub fn published(&self, attenuation: f64, product: bool) -> [f64; 3] {
        let mut slabs = slabs(1, self.optical_depth());
        for (radiance, alpha, depth) in self.march(STEPS) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let mut fur = slab_fragment(&slabs, 0);
        fur.depth = 0.0;
        fur.alpha = if product {
            published::product_alpha(&fur, &self.strands, attenuation)
        } else {
            published::alpha(&fur, &self.strands, attenuation)
        };
        let mut all: Vec<F> = std::iter::once(fur)
            .chain(self.strands.iter().copied())
            .collect();
        blend(&mut all, self.background)
    }
}

/// 400 pixels with so many strands each.
pub fn pixels(strands: usize) -> Vec<Pixel> {
    let mut random = Pcg64Mcg::seed_from_u64(40 + strands as u64);
    (0..400).map(|_| Pixel::new(&mut random, strands)).collect()
}

/// Root of the mean square over pixels and channels, over the mean.
pub fn pixel_error(
    pixels: &[Pixel],
    exact: &[[f64; 3]],
    method: impl Fn(&Pixel) -> [f64; 3],
) -> f64 {
    let (mut square, mut sum) = (0.0, 0.0);
    for (pixel, exact) in pixels.iter().zip(exact) {
        for (guess, exact) in method(pixel).into_iter().zip(exact) {
            square += (guess - exact).powi(2);
            sum += exact;
        }
    }
    let n = 3.0 * pixels.len() as f64;
    (square / n).sqrt() / (sum / n)
}
