//! Four numbers a cell: the open share of the sphere and the bent vector.

use super::RawTransfer;
use crate::maths::functions::{Real, clamp, real};
use crate::maths::undercoat::harmonics::{BANDS, HARMONICS, LOW_HARMONICS, harmonics, legendre};
use crate::maths::vector::dot;
use std::f64::consts::PI;

/// Terms of the cubic polynomial that predicts a band.
pub const FOUR_FIT: usize = 10;
/// Vectors of four that a [`TransferBands`] takes in a uniform buffer.
pub const BANDS_VEC4S: usize = 8;

/// Transfer of one cell.
///
/// With V(w) the share of the light from direction w that arrives, `openness` is the mean of V over the sphere and `bent` the mean
/// of V(w) w. Over black skin V is at most 1, `openness` 1/2 and `bent` 1/4 long; skin of albedo 1 adds up to 2 to V. Both average
/// linearly, so that mips and filtering are right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Four<T> {
    /// Mean of V(w) w over the sphere, in the frame of the skin (x along the lay, z out of it) or any frame it is turned to.
    pub bent: [T; 3],
    /// Mean of V over the sphere.
    pub openness: T,
}

/// Polynomials that predict the zonal coefficients of bands 2 to 4 from band 0 and band 1, fitted to one tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferBands {
    /// Coefficients of 1, a, c, a^2, a c, c^2, a^3, a^2 c, a c^2, c^3 with a the openness and c four times the length of the bent
    /// vector; one row a band.
    pub fit: [[f32; FOUR_FIT]; 3],
    /// Length of the longest bent vector of the tile: what 1 stands for in its texture.
    pub longest: f32,
    /// Most that V can be: 1, and twice the albedo of the skin.
    pub brightest: f32,
}

/// A compressed tile.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// One a cell, in the tile's order.
    pub cells: Vec<Four<f32>>,
    /// How the higher bands follow.
    pub bands: TransferBands,
}

fn terms<T: Real>(a: T, c: T) -> [T; FOUR_FIT] {
    let (a2, c2) = (a * a, c * c);
    [
        T::one(),
        a,
        c,
        a2,
        a * c,
        c2,
        a2 * a,
        a2 * c,
        a * c2,
        c2 * c,
    ]
}

impl TransferBands {
    /// The layout of a uniform buffer: the three rows one after the other, then `longest` and `brightest`.
    pub fn vec4s(&self) -> [[f32; 4]; BANDS_VEC4S] {
        let mut flat = [0.0; 4 * BANDS_VEC4S];
        for (out, value) in flat.iter_mut().zip(self.fit.iter().flatten()) {
            *out = *value;
        }
        flat[30] = self.longest;
        flat[31] = self.brightest;
        std::array::from_fn(|i| std::array::from_fn(|k| flat[4 * i + k]))
    }
}

/// Zonal coefficients of bands 0 to 4 of a cell: the means over the sphere of V P_l about the bent vector.
pub fn transfer_bands<T: Real>(four: &Four<T>, bands: &TransferBands) -> [T; BANDS + 1] {
    let a = clamp(four.openness, T::zero(), T::one());
    let length = dot(four.bent, four.bent).sqrt().min(a);
    let terms = terms(a, length * real(4.0));
    let mut out = [a, length, T::zero(), T::zero(), T::zero()];
    for (band, fit) in out[2..].iter_mut().zip(bands.fit) {
        let sum = terms
            .iter()
            .zip(fit)
            .fold(T::zero(), |sum, (t, f)| sum + *t * real(f64::from(f)));
        // |P_l| <= 1, so no mean exceeds that of V.
        *band = clamp(sum, -a, a);
    }
    out
}

/// Unit direction of the bent vector; z for none.
fn axis<T: Real>(bent: [T; 3]) -> [T; 3] {
    let length = dot(bent, bent).sqrt();
    if length > real(1e-6) {
        bent.map(|v| v / length)
    } else {
        [T::zero(), T::zero(), T::one()]
    }
}

/// Mean over all directions of the radiance that reaches a cell from an environment of bands 0 to 2 (integrals of radiance times
/// basis, in the frame of `four.bent`). A white sky of radiance 1 gives the openness. Never negative.
pub fn transfer_zonal<T: Real>(
    four: &Four<T>,
    bands: &TransferBands,
    light: &[[T; 3]; LOW_HARMONICS],
) -> [T; 3] {
    zonal(four, bands, light)
}

/// The same with bands 0 to 4.
pub fn transfer_zonal_full<T: Real>(
    four: &Four<T>,
    bands: &TransferBands,
    light: &[[T; 3]; HARMONICS],
) -> [T; 3] {
    zonal(four, bands, light)
}

fn zonal<T: Real>(four: &Four<T>, bands: &TransferBands, light: &[[T; 3]]) -> [T; 3] {
    let zonal = transfer_bands(four, bands);
    let y = harmonics(axis(four.bent));
    let mut sum = [T::zero(); 3];
    let mut first = 0;
    for (l, z) in zonal.into_iter().enumerate() {
        for i in first..((l + 1) * (l + 1)).min(light.len()) {
            for (sum, light) in sum.iter_mut().zip(light[i]) {
                *sum = *sum + z * y[i] * light;
            }
        }
        first = (l + 1) * (l + 1);
    }
    sum.map(|v| v.max(T::zero()))
}

/// V itself: the share of a light in the unit direction `light` that reaches a cell, 0 to `bands.brightest`.
pub fn transfer_towards<T: Real>(four: &Four<T>, bands: &TransferBands, light: [T; 3]) -> T {
    let zonal = transfer_bands(four, bands);
    let p = legendre(clamp(dot(axis(four.bent), light), -T::one(), T::one()));
    let sum = (0..=BANDS).fold(T::zero(), |sum, l| {
        sum + real::<T>((2 * l + 1) as f64) * zonal[l] * p[l]
    });
    clamp(sum, T::zero(), real(f64::from(bands.brightest)))
}

/// A cell turned with the skin: `frame` holds the world directions of the tile's x, y and z.
pub fn transfer_rotate<T: Real>(four: &Four<T>, frame: [[T; 3]; 3]) -> Four<T> {
    let [x, y, z] = four.bent;
    Four {
        bent: std::array::from_fn(|k| frame[0][k] * x + frame[1][k] * y + frame[2][k] * z),
        openness: four.openness,
    }
}

/// Mean radiance of a cell from its `count` first raw harmonics and those of the environment, in the frame of the tile.
pub fn transfer_raw<T: Real>(
    cell: &[T; HARMONICS],
    light: &[[T; 3]; HARMONICS],
    count: usize,
) -> [T; 3] {
    let mut sum = [T::zero(); 3];
    for (t, light) in cell.iter().zip(light).take(count) {
        for (sum, light) in sum.iter_mut().zip(*light) {
            *sum = *sum + *t * light;
        }
    }
    sum.map(|v| (v / real(4.0 * PI)).max(T::zero()))
}

impl Transfer {
    /// Compresses raw transfer, and fits the prediction to it.
    pub fn compress(raw: &RawTransfer) -> Self {
        let cells: Vec<Four<f32>> = raw.cells.iter().map(four).collect();
        let bands = fit(raw, &cells);
        Self { cells, bands }
    }
}

/// Band 0 and 1 of a cell as means over the sphere.
fn four(cell: &[f32; HARMONICS]) -> Four<f32> {
    let zeroth = 1.0 / (4.0 * PI).sqrt();
    let first = 1.0 / (12.0 * PI).sqrt();
    Four {
        bent: [cell[3], cell[1], cell[2]].map(|t| t * first as f32),
        openness: cell[0] * zeroth as f32,
    }
}

/// Least squares of the zonal coefficients about each cell's own axis.
fn fit(raw: &RawTransfer, cells: &[Four<f32>]) -> TransferBands {
    const N: usize = FOUR_FIT;
    let mut normal = [[0.0; N]; N];
    let mut right = [[0.0; N]; 3];
    for (cell, four) in raw.cells.iter().zip(cells) {
        let bent = four.bent.map(f64::from);
        let length = dot(bent, bent).sqrt();
        let terms = terms(f64::from(four.openness), 4.0 * length);
        let y = harmonics(axis(bent));
        for (row, a) in normal.iter_mut().zip(terms) {
            for (sum, b) in row.iter_mut().zip(terms) {
                *sum += a * b;
            }
        }
        for (band, right) in right.iter_mut().enumerate() {
            let l = band + 2;
            let target = (l * l..(l + 1) * (l + 1))
                .map(|i| f64::from(cell[i]) * y[i])
                .sum::<f64>()
                / (2 * l + 1) as f64;
            for (sum, a) in right.iter_mut().zip(terms) {
                *sum += a * target;
            }
        }
    }
    // A tile whose cells are all alike leaves the polynomial open: the least one serves.
    let trace: f64 = (0..N).map(|i| normal[i][i]).sum();
    for (i, row) in normal.iter_mut().enumerate() {
        row[i] += 1e-9 * trace.max(1e-9);
    }
    TransferBands {
        fit: right.map(|b| solve(normal, b).map(|v| v as f32)),
        longest: cells
            .iter()
            .map(|c| dot(c.bent, c.bent).sqrt())
            .fold(1e-3, f32::max),
        brightest: 1.0 + 2.0 * raw.albedo,
    }
}

/// Solves a symmetric positive system by Cholesky's decomposition.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for i in 0..N {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            a[i][j] = if i == j {
                sum.max(1e-300).sqrt()
            } else {
                sum / a[j][j]
            };
        }
    }
    for i in 0..N {
        b[i] = (b[i] - (0..i).map(|k| a[i][k] * b[k]).sum::<f64>()) / a[i][i];
    }
    for i in (0..N).rev() {
        b[i] = (b[i] - (i + 1..N).map(|k| a[k][i] * b[k]).sum::<f64>()) / a[i][i];
    }
    b
}
