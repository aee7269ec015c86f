//! Color of a stack over the angle: one table, linear between its texels (docs/book/iridescence.md#table). Where the stack's thickness
//! changes over a feather it has a row for every step of it (docs/book/iridescence.md#scale). Twin of `interference.wgsl`.

use super::super::fresnel;
use super::transfer::Spectral;
use super::{Iridescence, Stack, rgb_weights, wavelengths};
use crate::maths::functions::{Real, clamp, real};

/// Texels of a table, even steps in the cosine of incidence from 0 to 1.
pub const STACK_TEXELS: usize = 64;
/// Texels of a row where there are several.
pub const SCALED_TEXELS: usize = 32;
/// Largest ratio of the thicknesses of neighbouring rows: CIEDE2000 stays below 1 for 95 of 100 directions
/// (docs/book/iridescence.md#scale).
pub const SCALE_RATIO: f64 = 1.0283;
/// Refractive index of an inner side without layers.
const BARE: f64 = 1.55;

/// Reflectance of a stack, linear sRGB under D65, for even steps of the cosine of incidence. Channels keep their sign: spectral greens
/// lie outside of sRGB, and [`in_gamut`] comes after the interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct StackTable {
    /// The texels, cosine 0 first; row after row, the thinnest first.
    pub texels: Vec<[f64; 3]>,
    /// Rows, 1 or more: factors on all thicknesses in even ratios.
    pub rows: usize,
    /// Factors of the first and of the last row.
    pub scales: [f64; 2],
}

/// A color of a table, and what a side without layers has instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackLook<T> {
    /// Linear sRGB, in gamut.
    pub color: [T; 3],
    /// Fresnel reflectance of keratin.
    pub bare: T,
}

impl StackTable {
    /// Computes the table: 0.01 (films) to 2 seconds of one core, optimized.
    pub fn build(parameters: &Iridescence) -> Self {
        Self::with_texels(parameters, STACK_TEXELS)
    }

    /// The same with another number of texels, at least 2.
    pub fn with_texels(parameters: &Iridescence, texels: usize) -> Self {
        Self::single(row_of(parameters, texels))
    }

    /// One row of these texels.
    pub fn single(texels: Vec<[f64; 3]>) -> Self {
        Self {
            texels,
            rows: 1,
            scales: [1.0; 2],
        }
    }

    /// A table for factors on the thickness between two. The same as [`Self::build`] where both are 1.
    pub fn scaled(parameters: &Iridescence, scales: [f64; 2]) -> Self {
        let row = |i| scaled_row(parameters, scales, i);
        Self::joined((0..scale_rows(scales)).flat_map(row).collect(), scales)
    }

    /// The table of the rows that [`scaled_row`] computes, one after the other.
    pub fn joined(texels: Vec<[f64; 3]>, scales: [f64; 2]) -> Self {
        Self {
            texels,
            rows: scale_rows(scales),
            scales,
        }
    }

    /// Texels of a row.
    pub fn columns(&self) -> usize {
        self.texels.len() / self.rows
    }

    /// Steps between rows that a factor of 2 makes; 0 for one row.
    pub fn rows_per_octave(&self) -> f64 {
        let octaves = (self.scales[1] / self.scales[0]).log2();
        if self.rows > 1 && octaves > 0.0 {
            (self.rows - 1) as f64 / octaves
        } else {
            0.0
        }
    }

    /// Factor on the thickness of a row.
    pub fn scale_of(&self, row: usize) -> f64 {
        let along = row as f64 / (self.rows - 1).max(1) as f64;
        self.scales[0] * (self.scales[1] / self.scales[0]).powf(along)
    }

    /// Place of a factor on the thickness, in rows from the first.
    pub fn row_place<T: Real>(&self, scale: T) -> T {
        let octaves = (scale / real(self.scales[0])).max(real(1e-3)).log2();
        let last = real((self.rows - 1) as f64);
        clamp(octaves * real(self.rows_per_octave()), T::zero(), last)
    }

    /// Row below a factor on the thickness, and how far the factor lies towards the next.
    pub fn row<T: Real>(&self, scale: T) -> (usize, T) {
        step_from(self.row_place(scale), self.rows)
    }

    /// The color at a cosine of incidence, for a factor on the thickness.
    pub fn look<T: Real>(&self, cosine: T, scale: T) -> StackLook<T> {
        let columns = self.columns();
        let (low, t) = step(clamp(cosine, T::zero(), T::one()), columns);
        let (row, s) = self.row(scale);
        let to_next_row = if self.rows > 1 { columns } else { 0 };
        let cell = cell_triangle([t, s], [1, to_next_row]);
        let corners = cell.corners(row * columns + low);
        let (a, b) = (bare(low, columns), bare(low + 1, columns));
        StackLook {
            color: in_gamut(std::array::from_fn(|c| {
                (0..3).fold(T::zero(), |sum, i| {
                    sum + cell.weights[i] * real(self.texels[corners[i]][c])
                })
            })),
            bare: real::<T>(a) + real::<T>(b - a) * t,
        }
    }

    /// The color at a cosine of incidence, in gamut, at the stack's own thickness.
    pub fn color<T: Real>(&self, cosine: T) -> [T; 3] {
        self.look(cosine, T::one()).color
    }
}

/// A point of a cell of a table between the corners of its simplex. Of these the first is the cell's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simplex<T> {
    /// Steps from the cell's first corner to the second.
    pub second: usize,
    /// To the third.
    pub third: usize,
    /// To the fourth: all steps together.
    pub fourth: usize,
    /// Barycentric coordinates of the point.
    pub weights: [T; 4],
}

impl<T> Simplex<T> {
    /// Indices of the corners of a cell whose first is `first`.
    pub fn corners(&self, first: usize) -> [usize; 4] {
        [0, self.second, self.third, self.fourth].map(|step| first + step)
    }
}

/// The simplex of a cell around a point (Kuhn 1960): along the steps in the order of their fractions, the largest first. Four texels
/// tell what the mean of eight would.
pub fn cell_simplex<T: Real>(fraction: [T; 3], steps: [usize; 3]) -> Simplex<T> {
    let [x, y, z] = fraction;
    let (high, low) = (x.max(y.max(z)), x.min(y.min(z)));
    let middle = x + y + z - high - low;
    let first = fraction.iter().position(|f| *f == high).unwrap_or(0);
    let last = fraction.iter().rposition(|f| *f == low).unwrap_or(2);
    let all = steps.iter().sum::<usize>();
    Simplex {
        second: steps[first],
        third: all - steps[last],
        fourth: all,
        weights: [T::one() - high, high - middle, middle - low, low],
    }
}

/// The same of a cell with four corners; the fourth has no weight.
pub fn cell_triangle<T: Real>(fraction: [T; 2], steps: [usize; 2]) -> Simplex<T> {
    let [x, y] = fraction;
    let (high, low) = (x.max(y), x.min(y));
    let all = steps[0] + steps[1];
    Simplex {
        second: steps[usize::from(x != high)],
        third: all,
        fourth: all,
        weights: [T::one() - high, high - low, low, T::zero()],
    }
}

/// Index and fraction of a place 0..1 among `count` values in even steps.
fn step<T: Real>(place: T, count: usize) -> (usize, T) {
    step_from(place * real((count - 1) as f64), count)
}

/// The same of a place so many steps from the first.
fn step_from<T: Real>(place: T, count: usize) -> (usize, T) {
    let low = place.to_usize().unwrap_or(0).min(count.saturating_sub(2));
    (low, place - real(low as f64))
}

/// Reflectance of an inner side without layers at a texel of a row.
pub fn bare(texel: usize, texels: usize) -> f64 {
    fresnel(texel as f64 / (texels - 1) as f64, BARE)
}

/// Rows of a table between two factors on the thickness.
pub fn scale_rows(scales: [f64; 2]) -> usize {
    let steps = (scales[1] / scales[0]).max(1.0).ln() / SCALE_RATIO.ln();
    // What is a whole number of steps but for rounding is one.
    1 + (steps - 1e-6).ceil().max(0.0) as usize
}

/// Row `i` of [`scale_rows`]: [`STACK_TEXELS`] of them for a single row, otherwise [`SCALED_TEXELS`].
pub fn scaled_row(parameters: &Iridescence, scales: [f64; 2], i: usize) -> Vec<[f64; 3]> {
    let rows = scale_rows(scales);
    let factor = StackTable::joined(Vec::new(), scales).scale_of(i);
    let parameters = Iridescence {
        scale: (f64::from(parameters.limited().scale) * factor) as f32,
        ..*parameters
    };
    let texels = if rows > 1 {
        SCALED_TEXELS
    } else {
        STACK_TEXELS
    };
    row_of(&parameters, texels)
}

fn row_of(parameters: &Iridescence, texels: usize) -> Vec<[f64; 3]> {
    let cosine = |i: usize| i as f64 / (texels - 1) as f64;
    let cosines: Vec<f64> = (0..texels).map(cosine).collect();
    stack_colors(&Stack::new(parameters), &cosines)
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
