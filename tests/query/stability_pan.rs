//! A slow pan at sub-pixel steps: how much each pixel flickers, against supersampling.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{
    Component, ErrorBudget, Lod, Vane, mask_vane, point_query, reduce, vane_coverage,
};
use plumage_reference::coverage;
use plumage_tests::{
    stability::{self, Step},
    sweep::between,
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Pixels per side, frames, and frames per pixel of the pan.
const SIDE: i32 = 4;
const FRAMES: i32 = 32;
const STEPS_PER_PIXEL: f64 = 16.0;

/// `count` points of a standard normal distribution in the plane, the same in every pixel and frame: a rank-1 lattice
/// (R2 sequence, Roberts 2018) through Box and Muller's map.
fn samples(count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| {
            let i = i as f64 + 0.5;
            let radius = (-2.0 * (1.0 - i / count as f64 * (1.0 - 1e-9)).ln()).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * i * 0.618_033_988_749_894_8).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect()
}

/// A tilted view of a vane: pixel footprints are `mean + basis x` with `x` standard normal.
struct View {
    vane: Vane<f64>,
    view: [f64; 3],
    /// Columns: half a pixel to the right and half a pixel up.
    basis: [[f64; 2]; 2],
    origin: [f64; 2],
    /// Pan in pixels per frame times `STEPS_PER_PIXEL`.
    direction: [f64; 2],
}

impl View {
    /// `size`: half a pixel in barb periods.
    fn random(random: &mut Pcg64Mcg, size: f64) -> Self {
        let vane = Vane::from_measures(
            between(random, 150.0, 400.0),
            between(random, 30.0, 60.0),
            between(random, 10.0, 40.0),
            between(random, 20.0, 60.0),
            between(random, 25.0, 60.0),
            between(random, 3.0, 12.0),
            between(random, 3.0, 12.0),
            between(random, 60.0, 200.0),
        );
        let sigma = size * vane.p_b;
        let tilt = between(random, 0.0, 1.3);
        let (s, c) = between(random, 0.0, std::f64::consts::TAU).sin_cos();
        let (rs, rc) = between(random, 0.0, std::f64::consts::TAU).sin_cos();
        let long = sigma / tilt.cos();
        // Stretched along (c, s), then pixels turned against it.
        let basis = [
            [
                long * c * rc - sigma * s * rs,
                long * s * rc + sigma * c * rs,
            ],
            [
                -long * c * rs - sigma * s * rc,
                -long * s * rs + sigma * c * rc,
            ],
        ];
        let (ds, dc) = between(random, 0.0, std::f64::consts::TAU).sin_cos();
        Self {
            vane,
            view: [c * tilt.sin(), s * tilt.sin(), tilt.cos()],
            basis,
            origin: [between(random, -0.3, -0.1), between(random, 0.3, 0.7)],
            direction: [dc, ds],
        }
    }

    fn mean(&self, x: i32, y: i32, frame: i32) -> [f64; 2] {
        let t = f64::from(frame) / STEPS_PER_PIXEL;
        // Two columns of the basis make a pixel.
        let px = 2.0 * (f64::from(x) + t * self.direction[0]);
        let py = 2.0 * (f64::from(y) + t * self.direction[1]);
        let [a, b] = self.basis;
        [
            self.origin[0] + px * a[0] + py * b[0],
            self.origin[1] + px * a[1] + py * b[1],
        ]
    }

    fn footprint(&self, mean: [f64; 2]) -> Footprint<f64> {
        let [a, b] = self.basis;
        Footprint {
            mean,
            covariance: [
                a[0] * a[0] + b[0] * b[0],
                a[0] * a[1] + b[0] * b[1],
                a[1] * a[1] + b[1] * b[1],
            ],
        }
    }

    fn supersampled(&self, mean: [f64; 2], pattern: &[[f64; 2]]) -> [f64; 3] {
        let cell = mask_vane(&self.vane, self.view);
        let [a, b] = self.basis;
        let mut sum = [0.0; 3];
        for [x, y] in pattern {
            let point = [mean[0] + x * a[0] + y * b[0], mean[1] + x * a[1] + y * b[1]];
            match point_query(&cell, &self.vane, point).component {
                Component::Barb => sum[0] += 1.0,
                Component::Distal => sum[1] += 1.0,
                Component::Proximal => sum[2] += 1.0,
                _ => {}
            }
        }
        sum.map(|s| s / pattern.len() as f64)
    }

    fn ours(&self, footprint: &Footprint<f64>) -> [f64; 3] {
        let v = &self.vane;
        let vane = Vane::<f32> {
            p_b: v.p_b as f32,
            d_bl: v.d_bl as f32,
            cos_b: v.cos_b as f32,
            sin_b: v.sin_b as f32,
            cos_bl: v.cos_bl as f32,
            sin_bl: v.sin_bl as f32,
            r_b: v.r_b as f32,
            r_bd: v.r_bd as f32,
            r_bp: v.r_bp as f32,
            hooked: v.hooked as f32,
        };
        let f = Footprint {
            mean: footprint.mean.map(|x| x as f32),
            covariance: footprint.covariance.map(|x| x as f32),
        };
        let cell = mask_vane(&vane, self.view.map(|x| x as f32));
        vane_coverage(&cell, &vane, &f, Lod::Mixed, &ErrorBudget::default()).map(f64::from)
    }
}

/// Mean over the components of the variance along time.
fn variance(series: &[[f64; 3]]) -> f64 {
    let n = series.len() as f64;
    (0..3)
        .map(|i| {
            let mean = series.iter().map(|v| v[i]).sum::<f64>() / n;
            series.iter().map(|v| (v[i] - mean).powi(2)).sum::<f64>() / n
        })
        .sum::<f64>()
        / 3.0
}

fn minus(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter()
        .zip(b)
        .map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]])
        .collect()
}

#[test]
fn pan_flickers_less_than_supersampling() {
    let patterns = [samples(16), samples(64)];
    let mut random = Pcg64Mcg::seed_from_u64(501);
    // Sums over pixels: variance of the picture itself and of its error, for ours, 16 and 64 samples, and the truth.
    let mut own = [0.0; 4];
    let mut error = [0.0; 3];
    let mut above = [0; 2];
    let mut count = 0;
    let mut worst = (0.0, Vec::new());
    // Half a step of an 8-bit picture cannot be seen.
    let unseen = (0.5f64 / 255.0).powi(2);
    for i in 0..12 {
        let view = View::random(&mut random, 0.02 * 1.7f64.powi(i));
        for pixel in 0..SIDE * SIDE {
            let (x, y) = (pixel % SIDE, pixel / SIDE);
            let mut series: [Vec<[f64; 3]>; 4] = Default::default();
            for frame in 0..FRAMES {
                let mean = view.mean(x, y, frame);
                let footprint = view.footprint(mean);
                let cell = mask_vane(&view.vane, view.view);
                series[0].push(view.ours(&footprint));
                series[1].push(view.supersampled(mean, &patterns[0]));
                series[2].push(view.supersampled(mean, &patterns[1]));
                let local = reduce(&cell, &view.vane, &footprint);
                series[3].push(coverage::coverage(&cell, &local));
            }
            for (sum, s) in own.iter_mut().zip(&series) {
                *sum += variance(s);
            }
            let e: Vec<f64> = (0..3)
                .map(|k| variance(&minus(&series[k], &series[3])))
                .collect();
            for (sum, e) in error.iter_mut().zip(&e) {
                *sum += e;
            }
            above[0] += i32::from(e[0] > e[1].max(unseen));
            above[1] += i32::from(e[0] > e[2].max(unseen));
            count += 1;
            if e[0] > worst.0 {
                let steps = (0..FRAMES as usize).map(|frame| Step {
                    at: frame as f64 / STEPS_PER_PIXEL,
                    value: series[0][frame],
                    truth: series[3][frame],
                    kind: (bevy_plumage::maths::query::Evaluator::Near, false),
                });
                worst = (e[0], steps.collect());
            }
        }
    }
    let n = f64::from(count);
    let [a, b, c, d] = own.map(|v| (v / n).sqrt());
    eprintln!(
        "{count} pixels, standard deviation along the pan: ours {a:.5}, 16 samples {b:.5}, 64 samples {c:.5}, reference {d:.5}"
    );
    let [ea, eb, ec] = error.map(|v| (v / n).sqrt());
    eprintln!(
        "of the error: ours {ea:.6}, 16 samples {eb:.5}, 64 samples {ec:.5}; worst pixel {:.5}",
        worst.0.sqrt()
    );
    eprintln!(
        "pixels that flicker visibly more than with 16 samples: {}, than with 64: {}",
        above[0], above[1]
    );
    if own[0] > own[1] || ea > 0.1 * ec || above != [0, 0] {
        let file = stability::failure_file("stability_pan");
        let title = "Pan: the pixel that flickers most";
        stability::draw(&file, title, "pixels panned", &worst.1, unseen.sqrt());
        panic!(
            "flicker: {own:?} {error:?} {above:?}, picture {}",
            file.display()
        );
    }
}
