//! Color of a stack over the angle: one table, linear between its texels (docs/book/iridescence.md#table).

use super::transfer::Spectral;
use super::{Iridescence, Stack, rgb_weights, wavelengths};
use crate::maths::functions::{Real, clamp, real};

/// Texels of a table, even steps in the cosine of incidence from 0 to 1.
pub const STACK_TEXELS: usize = 64;

/// Reflectance of a stack, linear sRGB under D65, for [`STACK_TEXELS`] cosines of incidence. Channels keep their sign: spectral greens
/// lie outside of sRGB, and [`in_gamut`] comes after the interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct StackTable {
    /// The texels, cosine 0 first.
    pub texels: Vec<[f64; 3]>,
}

impl StackTable {
    /// Computes the table: 0.3 to 2 seconds of one core.
    pub fn build(parameters: &Iridescence) -> Self {
        let stack = Stack::new(parameters);
        let cosine = |i: usize| i as f64 / (STACK_TEXELS - 1) as f64;
        let cosines: Vec<f64> = (0..STACK_TEXELS).map(cosine).collect();
        Self {
            texels: stack_colors(&stack, &cosines),
        }
    }

    /// The color at a cosine of incidence, in gamut.
    pub fn color<T: Real>(&self, cosine: T) -> [T; 3] {
        let place = clamp(cosine, T::zero(), T::one()) * real((STACK_TEXELS - 1) as f64);
        let low = place.to_usize().unwrap_or(0).min(STACK_TEXELS - 2);
        let t = place - real(low as f64);
        let (a, b) = (self.texels[low], self.texels[low + 1]);
        in_gamut(std::array::from_fn(|c| {
            real::<T>(a[c]) + real::<T>(b[c] - a[c]) * t
        }))
    }
}

/// Linear sRGB of a stack at some cosines of incidence, without a table.
pub fn stack_colors(stack: &Stack, cosines: &[f64]) -> Vec<[f64; 3]> {
    let realizations = stack.realizations();
    let mut colors = vec![[0.0; 3]; cosines.len()];
    for (wavelength, weight) in wavelengths().zip(rgb_weights()) {
        let spectral = Spectral::new(stack, wavelength);
        for (&cosine, color) in cosines.iter().zip(&mut colors) {
            let reflected = spectral.reflectance(cosine, &realizations);
            for (sum, weight) in color.iter_mut().zip(weight) {
                *sum += weight * reflected;
            }
        }
    }
    colors
}

/// Reflectance of a stack at a wavelength in nanometres: the mean over polarizations, mixings and realizations.
pub fn stack_reflectance(stack: &Stack, cosine: f64, wavelength: f64) -> f64 {
    Spectral::new(stack, wavelength).reflectance(cosine, &stack.realizations())
}

/// Brings linear sRGB with negative channels into gamut, luminance kept: towards its grey.
pub fn in_gamut<T: Real>(rgb: [T; 3]) -> [T; 3] {
    let y = (rgb[0] * real(0.2126) + rgb[1] * real(0.7152) + rgb[2] * real(0.0722)).max(T::zero());
    let least = rgb[0].min(rgb[1]).min(rgb[2]).min(T::zero());
    let share = y / (y - least).max(real(1e-9));
    rgb.map(|x| clamp(y + (x - y) * share, T::zero(), T::one()))
}
