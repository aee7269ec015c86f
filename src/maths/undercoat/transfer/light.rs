//! Light from all around, as harmonics.

use crate::maths::undercoat::harmonics::{HARMONICS, LOW_HARMONICS, fibonacci_rays, harmonics};
use std::f64::consts::PI;

/// Radiance from all around: the integral of red, green and blue times the basis, bands 0 to 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// One color a harmonic.
    pub harmonics: [[f32; 3]; HARMONICS],
}

impl Sky {
    /// Bands 0 to 2, what [`super::transfer_zonal`] takes.
    pub fn low(&self) -> [[f32; 3]; LOW_HARMONICS] {
        std::array::from_fn(|i| self.harmonics[i])
    }
}

/// The sky whose radiance (red, green, blue) is `radiance`, from `count` evenly spread directions (1024 are plenty for bands 0 to 4
/// of a smooth sky).
pub fn sky(count: usize, radiance: impl Fn([f64; 3]) -> [f64; 3]) -> Sky {
    let count = count.max(1);
    let solid_angle = 4.0 * PI / count as f64;
    sample_sky(
        fibonacci_rays(count)
            .into_iter()
            .map(|d| (d, radiance(d), solid_angle)),
    )
}

/// The sky of samples: direction (of any length above 0), radiance, and solid angle of each, such as the texels of a cube map.
pub fn sample_sky(samples: impl IntoIterator<Item = ([f64; 3], [f64; 3], f64)>) -> Sky {
    let mut sum = [[0.0; 3]; HARMONICS];
    for (direction, radiance, solid_angle) in samples {
        let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
        // One bad texel must not darken the whole sky.
        if !(length > 0.0 && radiance.iter().all(|v| v.is_finite()) && solid_angle.is_finite()) {
            continue;
        }
        for (sum, y) in sum.iter_mut().zip(harmonics(direction.map(|v| v / length))) {
            for (sum, value) in sum.iter_mut().zip(radiance) {
                *sum += y * value * solid_angle;
            }
        }
    }
    Sky {
        harmonics: sum.map(|c| c.map(|v| v as f32)),
    }
}

/// The sky of a map in equirectangular form: `pixels` row by row from the pole +y, the middle column towards -z, columns turning
/// towards +x. Rows that are missing are dark.
pub fn equirect_sky(width: usize, pixels: &[[f32; 3]]) -> Sky {
    let width = width.max(1);
    let height = (pixels.len() / width).max(1);
    let solid = 2.0 * PI / width as f64;
    sample_sky(
        pixels
            .iter()
            .take(width * height)
            .enumerate()
            .map(|(i, pixel)| {
                let edge = |row: usize| (PI * row as f64 / height as f64).cos();
                let (row, column) = (i / width, i % width);
                let theta = PI * (row as f64 + 0.5) / height as f64;
                let phi = 2.0 * PI * ((column as f64 + 0.5) / width as f64 - 0.5);
                let (sin, cos) = theta.sin_cos();
                let direction = [sin * phi.sin(), cos, -sin * phi.cos()];
                let solid_angle = solid * (edge(row) - edge(row + 1));
                (direction, pixel.map(f64::from), solid_angle)
            }),
    )
}
