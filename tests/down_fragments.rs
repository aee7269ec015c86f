//! Test D10 of the undercoat study: fur and strands mixed in a pixel, against the exact interleaving.

use bevy_plumage::down::fragments::*;
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
struct Pixel {
    /// Optical depth per unit of depth, and radiance, of each fine step.
    extinction: Vec<f64>,
    radiance: Vec<[f64; 3]>,
    strands: Vec<F>,
    background: [f64; 3],
}

fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

impl Pixel {
    /// Clumped fur of optical depth 4 on average, lit less and less towards the skin, and strands of other colours. Contrast and
    /// opacity of the strands are such that the methods which are not judged here (one fragment at the front, Eq. 4) err as in the
    /// study.
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
                    colour: [0; 3].map(|_| shade * (0.6 + 0.4 * uniform(random))),
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
    fn march(&self, steps: usize) -> Vec<([f64; 3], f64, f64)> {
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

    fn optical_depth(&self) -> f64 {
        self.extinction.iter().sum::<f64>() / FINE as f64
    }

    /// The judge: fine steps and strands one by one, front to back.
    fn exact(&self) -> [f64; 3] {
        let mut order: Vec<&F> = self.strands.iter().collect();
        order.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        let mut waiting = order.into_iter().peekable();
        let mut sum = [0.0; 3];
        let mut left = 1.0;
        let mut add = |colour: [f64; 3], alpha: f64| {
            for (sum, c) in sum.iter_mut().zip(colour) {
                *sum += left * alpha * c;
            }
            left *= 1.0 - alpha;
        };
        for i in 0..FINE {
            let depth = (i + 1) as f64 / FINE as f64;
            while let Some(strand) = waiting.next_if(|s| s.depth < depth) {
                add(strand.colour, strand.alpha);
            }
            add(
                self.radiance[i],
                1.0 - (-self.extinction[i] / FINE as f64).exp(),
            );
        }
        for strand in waiting {
            add(strand.colour, strand.alpha);
        }
        add(self.background, 1.0);
        sum
    }

    fn virtual_fragments(&self, count: u32, optical_depth: f64) -> [f64; 3] {
        let mut slabs = slabs(count, optical_depth);
        for (radiance, alpha, depth) in self.march(STEPS) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let own = (0..count as usize).map(|k| slab_fragment(&slabs, k));
        let mut all: Vec<F> = own.chain(self.strands.iter().copied()).collect();
        blend(&mut all, self.background)
    }

    /// The whole fur as one fragment, at its mean depth or at its front.
    fn one(&self, front: bool) -> [f64; 3] {
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

    fn published(&self, attenuation: f64, product: bool) -> [f64; 3] {
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

fn pixels(strands: usize) -> Vec<Pixel> {
    let mut random = Pcg64Mcg::seed_from_u64(40 + strands as u64);
    (0..400).map(|_| Pixel::new(&mut random, strands)).collect()
}

/// Root of the mean square over pixels and channels, over the mean.
fn error(pixels: &[Pixel], exact: &[[f64; 3]], method: impl Fn(&Pixel) -> [f64; 3]) -> f64 {
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

/// The undercoat study's table A5, for 1, 3, 8 and 20 strands a pixel.
const TABLE: [(&str, [f64; 4]); 7] = [
    ("front", [0.094, 0.178, 0.214, 0.285]),
    ("published", [0.097, 0.133, 0.136, 0.111]),
    ("product", [0.082, 0.111, 0.115, 0.095]),
    ("mean depth", [0.062, 0.118, 0.118, 0.113]),
    ("2", [0.037, 0.051, 0.051, 0.049]),
    ("4", [0.017, 0.026, 0.024, 0.026]),
    ("8", [0.008, 0.011, 0.012, 0.012]),
];

#[test]
fn d10_virtual_fragments_stay_within_the_table() {
    for (column, strands) in [1, 3, 8, 20].into_iter().enumerate() {
        let pixels = pixels(strands);
        let exact: Vec<_> = pixels.iter().map(Pixel::exact).collect();
        let best = |product: bool| {
            (0..=12)
                .map(|i| {
                    let attenuation = 2f64.powf(f64::from(i) * 0.5);
                    error(&pixels, &exact, |p| p.published(attenuation, product))
                })
                .fold(f64::INFINITY, f64::min)
        };
        let mut rows = vec![
            error(&pixels, &exact, |p| p.one(true)),
            best(false),
            best(true),
            error(&pixels, &exact, |p| p.one(false)),
        ];
        for count in [2, 4, 8] {
            rows.push(error(&pixels, &exact, |p| {
                p.virtual_fragments(count, p.optical_depth())
            }));
        }
        let mean: Vec<f64> = [2, 4, 8]
            .map(|count| error(&pixels, &exact, |p| p.virtual_fragments(count, 4.0)))
            .into();
        println!("D10, {strands} strands:");
        for ((name, study), row) in TABLE.iter().zip(&rows) {
            println!("  {name:12} {row:.4}  study {}", study[column]);
        }
        println!("  cut by the mean depth, 2/4/8: {mean:.4?}");
        for ((name, study), row) in TABLE.iter().zip(&rows).skip(3) {
            assert!(
                *row < 1.2 * study[column],
                "{strands} strands, {name}: {row}"
            );
        }
        for (i, (mean, row)) in mean.iter().zip(&rows[4..]).enumerate() {
            assert!(
                *mean < 1.2 * TABLE[4 + i].1[column],
                "{strands} strands, mean depth: {mean} {row}"
            );
        }
        for (row, (name, study)) in rows.iter().zip(TABLE).take(3) {
            let ratio = row / study[column];
            assert!(
                (0.85..1.15).contains(&ratio),
                "{name}: other pixels than the study's, {ratio}"
            );
        }
        assert!(
            rows[1] > rows[4] && rows[2] > rows[4],
            "two fragments beat Eq. (4)"
        );
    }
}

#[test]
fn slabs_alone_are_the_march() {
    for pixel in pixels(0) {
        for count in 1..=8 {
            for expected in [pixel.optical_depth(), 4.0, 0.5, 20.0] {
                let mut slabs = slabs(count, expected);
                let (mut sum, mut left) = ([0.0; 3], 1.0);
                for (radiance, alpha, depth) in pixel.march(40) {
                    slab_add(&mut slabs, radiance, alpha, depth);
                    for (sum, c) in sum.iter_mut().zip(radiance) {
                        *sum += left * alpha * c;
                    }
                    left *= 1.0 - alpha;
                }
                for (sum, c) in sum.iter_mut().zip(pixel.background) {
                    *sum += left * c;
                }
                let mut all: Vec<F> = (0..count as usize)
                    .map(|k| slab_fragment(&slabs, k))
                    .collect();
                let depths: Vec<f64> = all
                    .iter()
                    .filter(|f| f.alpha > 0.0)
                    .map(|f| f.depth)
                    .collect();
                let sorted = depths.windows(2).all(|d| d[0] < d[1] + 1e-12);
                assert!(sorted, "{depths:?}");
                for (a, b) in blend(&mut all, pixel.background).into_iter().zip(sum) {
                    assert!(
                        (a - b).abs() < 1e-5,
                        "{count} slabs, depth {expected}: {a} {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn slabs_have_equal_opacity() {
    for pixel in pixels(0).iter().take(50) {
        let mut slabs = slabs(4, pixel.optical_depth());
        for (radiance, alpha, depth) in pixel.march(16) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let whole = 1.0 - (-pixel.optical_depth()).exp();
        let mut left = 1.0;
        for k in 0..4 {
            let alpha = slab_fragment(&slabs, k).alpha;
            assert!(
                (left * alpha - whole / 4.0).abs() < 1e-5,
                "slab {k}: {}",
                left * alpha
            );
            left *= 1.0 - alpha;
        }
    }
}

#[test]
fn bad_marches_give_no_fragments() {
    for depth in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let mut march = slabs(0, depth);
        slab_add(&mut march, [1.0; 3], f64::NAN, 0.5);
        slab_add(&mut march, [1.0; 3], 2.0, 0.5);
        slab_add(&mut march, [1.0; 3], 0.5, 0.5);
        for k in [0, 7, 99] {
            let f = slab_fragment(&march, k);
            assert!(
                f.alpha.is_finite()
                    && f.depth.is_finite()
                    && f.colour.iter().all(|c| c.is_finite())
            );
            assert!((0.0..=1.0).contains(&f.alpha));
        }
    }
}

#[test]
fn printed_blending_takes_off_for_strands_that_are_not_there() {
    let fur = F {
        colour: [1.0; 3],
        alpha: 0.9,
        depth: 0.0,
    };
    let ghost = F {
        colour: [0.0; 3],
        alpha: 0.0,
        depth: 0.1,
    };
    assert!(published::alpha(&fur, &[ghost], 2.0) < 0.1);
    assert_eq!(published::alpha(&fur, &[ghost; 4], 2.0), 0.0);
    assert_eq!(published::product_alpha(&fur, &[ghost; 4], 2.0), 0.9);
}
