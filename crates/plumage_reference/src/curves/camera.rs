//! Pixels of the reference: the plugin's Gaussian footprint, stratified.

use super::{CurveShader, Curves, Ray};
use bevy_plumage::maths::vector::cross;

/// A camera in card space. Pixel (0, 0) is the upper left one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveCamera {
    /// The eye; for an orthographic camera the middle of its picture plane.
    pub eye: [f64; 3],
    /// Unit vector to the right of the picture.
    pub right: [f64; 3],
    /// Unit vector to the top of the picture.
    pub up: [f64; 3],
    /// Size of a pixel: feather lengths for an orthographic camera, radians in the middle of the picture for a perspective one.
    pub pixel: f64,
    /// Are rays parallel?
    pub orthographic: bool,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Inverse of the normal distribution, `p` in 0..1 (clamped to 1e-9 from the ends): Newton's method on an error function.
pub fn normal_quantile(p: f64) -> f64 {
    let p = p.clamp(1e-9, 1.0 - 1e-9);
    // Winitzki's start, then three steps.
    let x = 2.0 * p - 1.0;
    let a = 0.147;
    let l = (1.0 - x * x).ln();
    let b = 2.0 / (std::f64::consts::PI * a) + 0.5 * l;
    let mut z =
        x.signum() * ((b * b - l / a).sqrt() - b).max(0.0).sqrt() * std::f64::consts::SQRT_2;
    for _ in 0..3 {
        let below = 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
        let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        z -= (below - p) / density.max(1e-300);
    }
    z
}

/// A number in 0..1 from four integers, for jitter that needs no state (SplitMix64).
fn jitter(seed: u64, a: u32, b: u32, c: u32) -> f64 {
    let mut x = seed
        .wrapping_add(u64::from(a).wrapping_mul(0x9E37_79B9_7F4A_7C15))
        .wrapping_add(u64::from(b).wrapping_mul(0xBF58_476D_1CE4_E5B9))
        .wrapping_add(u64::from(c).wrapping_mul(0x94D0_49BB_1331_11EB));
    for shift in [30, 27, 31] {
        x = (x ^ (x >> shift)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    }
    (x >> 11) as f64 * 0.5_f64.powi(53)
}

impl CurveCamera {
    /// A camera that looks from `eye` at `target`, `up` about upwards.
    pub fn looking_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: [f64; 3],
        pixel: f64,
        orthographic: bool,
        size: [u32; 2],
    ) -> Self {
        let back = unit([0, 1, 2].map(|i| eye[i] - target[i]));
        let right = unit(cross(up, back));
        Self {
            eye,
            right,
            up: cross(back, right),
            pixel,
            orthographic,
            size,
        }
    }

    /// Ray through a point of the picture in pixels from its upper left corner.
    pub fn ray(&self, at: [f64; 2]) -> Ray {
        let x = (at[0] - 0.5 * f64::from(self.size[0])) * self.pixel;
        let y = (0.5 * f64::from(self.size[1]) - at[1]) * self.pixel;
        let forward = cross(self.up, self.right);
        let along = |f: f64| [0, 1, 2].map(|i| self.right[i] * x + self.up[i] * y + forward[i] * f);
        if self.orthographic {
            let offset = along(0.0);
            Ray {
                origin: [0, 1, 2].map(|i| self.eye[i] + offset[i]),
                direction: forward,
            }
        } else {
            Ray {
                origin: self.eye,
                direction: unit(along(1.0)),
            }
        }
    }

    /// One row of the picture: linear RGB, premultiplied, and coverage. `samples` squared rays a pixel, stratified over a
    /// Gaussian of half a pixel's deviation, which is the plugin's footprint. Deterministic for a `seed`.
    pub fn row(
        &self,
        curves: &Curves,
        shader: &CurveShader,
        row: u32,
        samples: u32,
        seed: u64,
    ) -> Vec<[f64; 4]> {
        let n = samples.max(1);
        let share = 1.0 / f64::from(n * n);
        (0..self.size[0])
            .map(|column| {
                let mut sum = [0.0; 4];
                for i in 0..n * n {
                    let place = |k: u32, c: u32| {
                        let u = jitter(seed, column, row, 2 * i + c);
                        0.5 * normal_quantile((f64::from(k) + u) / f64::from(n))
                    };
                    let at = [
                        f64::from(column) + 0.5 + place(i % n, 0),
                        f64::from(row) + 0.5 + place(i / n, 1),
                    ];
                    let ray = self.ray(at);
                    let Some(hit) = curves.hit(&ray, f64::NEG_INFINITY, None) else {
                        continue;
                    };
                    let random = |k: u32| jitter(seed ^ 0x5bd1_e995, column, row, i * 8 + k);
                    let light = shader.radiance(curves, &hit, ray.direction, random);
                    for c in 0..3 {
                        sum[c] += light[c] * share;
                    }
                    sum[3] += share;
                }
                sum
            })
            .collect()
    }
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let l = a.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-30);
    a.map(|x| x / l)
}
