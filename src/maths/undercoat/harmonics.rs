//! Real spherical harmonics of bands 0 to 4 as polynomials of a unit vector, and rays spread over the sphere.
//!
//! The basis is the corrected form of Kloetzli 2005, Eq. (5)-(6) (docs/book/undercoat.md#transfer): |m| in the
//! normalisation, the polynomial taken *of* cos(theta). Index `l (l + 1) + m`; band 1 is proportional to (y, z, x). Twin of
//! `down_transfer.wgsl`.

use crate::maths::functions::{Real, real};

/// Basis functions of bands 0 to 4.
pub const HARMONICS: usize = 25;
/// Basis functions of bands 0 to 2: what an environment is stored in at run time.
pub const LOW_HARMONICS: usize = 9;
/// The highest band.
pub const BANDS: usize = 4;

/// The 25 basis functions in the unit direction `d`.
pub fn harmonics<T: Real>(d: [T; 3]) -> [T; HARMONICS] {
    let [x, y, z] = d;
    let c = |v: f64| real::<T>(v);
    let (x2, y2, z2) = (x * x, y * y, z * z);
    let difference = x2 - y2;
    let left = x * (x2 - c(3.0) * y2);
    let right = y * (c(3.0) * x2 - y2);
    let five = c(5.0) * z2 - c(1.0);
    let seven = c(7.0) * z2;
    [
        c(0.282_094_791_773_878_14),
        c(0.488_602_511_902_919_9) * y,
        c(0.488_602_511_902_919_9) * z,
        c(0.488_602_511_902_919_9) * x,
        c(1.092_548_430_592_079_2) * x * y,
        c(1.092_548_430_592_079_2) * y * z,
        c(0.315_391_565_252_520_05) * (c(3.0) * z2 - c(1.0)),
        c(1.092_548_430_592_079_2) * x * z,
        c(0.546_274_215_296_039_6) * difference,
        c(0.590_043_589_926_643_5) * right,
        c(2.890_611_442_640_554) * x * y * z,
        c(0.457_045_799_464_465_8) * y * five,
        c(0.373_176_332_590_115_4) * z * (c(5.0) * z2 - c(3.0)),
        c(0.457_045_799_464_465_8) * x * five,
        c(1.445_305_721_320_277) * z * difference,
        c(0.590_043_589_926_643_5) * left,
        c(2.503_342_941_796_704_6) * x * y * difference,
        c(1.770_130_769_779_930_4) * z * right,
        c(0.946_174_695_757_560_1) * x * y * (seven - c(1.0)),
        c(0.669_046_543_557_289_2) * y * z * (seven - c(3.0)),
        c(0.105_785_546_915_204_31) * ((c(35.0) * z2 - c(30.0)) * z2 + c(3.0)),
        c(0.669_046_543_557_289_2) * x * z * (seven - c(3.0)),
        c(0.473_087_347_878_780_04) * difference * (seven - c(1.0)),
        c(1.770_130_769_779_930_4) * z * left,
        c(0.625_835_735_449_176_1) * (x2 * (x2 - c(6.0) * y2) + y2 * y2),
    ]
}

/// Legendre polynomials P_0 to P_4 of `x` in -1..=1.
pub fn legendre<T: Real>(x: T) -> [T; BANDS + 1] {
    let c = |v: f64| real::<T>(v);
    let x2 = x * x;
    [
        c(1.0),
        x,
        c(1.5) * x2 - c(0.5),
        x * (c(2.5) * x2 - c(1.5)),
        (c(4.375) * x2 - c(3.75)) * x2 + c(0.375),
    ]
}

/// `count` directions spread evenly over the sphere (the spherical Fibonacci lattice), each with the same solid angle
/// `4 pi / count`.
pub fn fibonacci_rays(count: usize) -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let (sin, cos) = (golden * i as f64).sin_cos();
            [r * cos, r * sin, z]
        })
        .collect()
}

/// `Gram[i][j]`: mean of the product of two basis functions over `rays`, times 4 pi. The identity for a perfect set of rays.
pub fn gram(rays: &[[f64; 3]]) -> [[f64; HARMONICS]; HARMONICS] {
    let mut sum = [[0.0; HARMONICS]; HARMONICS];
    let weight = 4.0 * std::f64::consts::PI / rays.len().max(1) as f64;
    for ray in rays {
        let y = harmonics(*ray);
        for (row, a) in sum.iter_mut().zip(y) {
            for (cell, b) in row.iter_mut().zip(y) {
                *cell += weight * a * b;
            }
        }
    }
    sum
}
