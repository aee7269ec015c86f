//! How thick the coat is where: the procedural *down*, and the chain of coarser densities that far pixels use.
//!
//! A place is `[u, v, z]`: `u` and `v` in tiles (they wrap), `z` the height, 0 on the skin and 1 at the top. The procedural functions
//! have twins in `down_density.wgsl`.

use super::Tile;
use crate::maths::functions::{Real, clamp};
use crate::maths::vector::normalize;
use bevy::math::{UVec3, Vec3};

/// Cells of the usual tile: 128 KB in 8 bits, for all birds.
pub const TILE_SIZE: UVec3 = UVec3::new(64, 64, 32);

/// Shape of procedural down (docs/book/undercoat.md#density).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DownShape {
    /// Clumps along a tile, 1..=64.
    pub clumps: u32,
    /// Fibres along a tile, 1..=128; a second set is twice as fine.
    pub fibres: u32,
    /// How far the tips wander, in tiles, 0..=0.2.
    pub jitter: f32,
    /// Height of the coat between clumps over that in their middle, 0..=1.
    pub valley: f32,
    /// Over what part of the height a clump thins out to its tip, 0.01..=1.
    pub tip: f32,
    /// How far the tips bend over to `lay`, 0..=1.
    pub bend: f32,
    /// Where the fibres lie to, along the tile.
    pub lay: [f32; 2],
    /// Spread of the directions at the roots and what the tips add.
    pub spread: [f32; 2],
    /// Seed.
    pub seed: u32,
}

impl Default for DownShape {
    fn default() -> Self {
        Self {
            clumps: 8,
            fibres: 24,
            jitter: 0.05,
            valley: 0.55,
            tip: 0.25,
            bend: 0.3,
            lay: [1.0, 0.0],
            spread: [0.15, 0.7],
            seed: 1,
        }
    }
}

/// A random number of a lattice point, 0..1 (PCG's output permutation, the same bits on the GPU).
pub fn lattice_noise<T: Real>(x: u32, y: u32, seed: u32) -> T {
    let mut state = x
        .wrapping_mul(0x9E37_79B1)
        .wrapping_add(y.wrapping_mul(0x85EB_CA77))
        .wrapping_add(seed.wrapping_mul(0xC2B2_AE3D));
    for _ in 0..2 {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        state = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        state ^= state >> 22;
    }
    // 24 bits: exact in both precisions.
    T::of(f64::from(state >> 8) / 16_777_216.0)
}

/// Smooth noise, 0..1, with `period` lattice points a tile.
pub fn value_noise<T: Real>(u: T, v: T, period: u32, seed: u32) -> T {
    let n = period.max(1);
    let scale = T::of(f64::from(n));
    let (x, y) = (u * scale, v * scale);
    let (i, k) = (x.floor(), y.floor());
    let smooth = |t: T| t * t * (T::of(3.0) - t - t);
    let (s, t) = (smooth(x - i), smooth(y - k));
    let wrap = |x: T| {
        let r = x - scale * (x / scale).floor();
        // Rounding may land on the period itself.
        r.to_u32().unwrap_or(0) % n
    };
    let (i, k) = (wrap(i), wrap(k));
    let (j, l) = ((i + 1) % n, (k + 1) % n);
    let mix = |a: T, b: T, t: T| a + (b - a) * t;
    mix(
        mix(lattice_noise(i, k, seed), lattice_noise(j, k, seed), s),
        mix(lattice_noise(i, l, seed), lattice_noise(j, l, seed), s),
        t,
    )
}

/// Density of procedural down at a place, 0 to about 1 (no unit: scale it to an optical depth).
pub fn down_density<T: Real>(place: [T; 3], shape: &DownShape) -> T {
    let [u, v, z] = place;
    let seed = shape.seed.wrapping_mul(8);
    let noise = |u: T, v: T, period: u32, k: u32| value_noise(u, v, period, seed.wrapping_add(k));
    let half = T::of(0.5);
    let shift = T::of(f64::from(shape.jitter)) * z * z;
    let (a, b) = (noise(u, v, 16, 0), noise(u, v, 16, 1));
    let (p, q) = (u + shift * (a - half), v + shift * (b - half));
    let clump = noise(u, v, shape.clumps, 2);
    let fibre = half * (noise(p, q, shape.fibres, 3) + noise(p, q, 2 * shape.fibres, 4));
    let valley = T::of(f64::from(shape.valley));
    let height = valley + (T::one() - valley) * clump;
    let tip = T::of(f64::from(shape.tip.max(0.01)));
    fibre * clamp((height - z) / tip, T::zero(), T::one())
}

/// Direction of the fibres at a place in the frame of the skin (x and y along the tile, z the normal), unit length.
pub fn down_tangent<T: Real>(place: [T; 3], shape: &DownShape) -> [T; 3] {
    let [u, v, z] = place;
    let seed = shape.seed.wrapping_mul(8).wrapping_add(5);
    let random = [0, 1, 2].map(|k| {
        let n: T = value_noise(u, v, shape.fibres, seed.wrapping_add(k * 131));
        n + n - T::one()
    });
    let real = |x: f32| T::of(f64::from(x));
    let bend = real(shape.bend) * z;
    let spread = real(shape.spread[0]) + real(shape.spread[1]) * z;
    let lay = [bend * real(shape.lay[0]), bend * real(shape.lay[1])];
    normalize(
        [
            lay[0] + spread * random[0],
            lay[1] + spread * random[1],
            T::one() - bend + spread * random[2],
        ],
        [T::zero(), T::zero(), T::one()],
    )
}

/// A tile of procedural down with a mean vertical optical depth of `depth`, `width` heights wide.
pub fn down_tile(shape: &DownShape, size: UVec3, width: f32, depth: f32) -> Option<Tile> {
    let size = size.clamp(UVec3::ONE, UVec3::splat(512));
    let cells = size.as_usizevec3().element_product();
    let place = |i: usize| {
        let (x, y) = (i as u32 % size.x, i as u32 / size.x % size.y);
        let z = i as u32 / (size.x * size.y);
        [(x, size.x), (y, size.y), (z, size.z)].map(|(i, n)| (i as f32 + 0.5) / n as f32)
    };
    let mut extinction = (0..cells)
        .map(|i| down_density(place(i), shape))
        .collect::<Vec<f32>>();
    let mean = extinction.iter().map(|e| f64::from(*e)).sum::<f64>() / cells as f64;
    let scale = f64::from(depth) / mean.max(1e-9);
    for e in &mut extinction {
        *e = (f64::from(*e) * scale) as f32;
    }
    let tangent = (0..cells)
        .map(|i| Vec3::from(down_tangent(place(i), shape)))
        .collect();
    Tile::new(size, width, extinction, tangent)
}

/// Extinction of parallel fibres across them, per millimetre: `fibres` a square millimetre, `diameter` in micrometres.
///
/// Mink's underfur, 200 of 13 micrometres, has 2.6.
pub fn fibre_extinction<T: Real>(fibres: T, diameter: T) -> T {
    fibres * diameter * T::of(1e-3)
}

/// Extinction of loose down, per millimetre: `density` in mg/cm^3 (loose down 2 to 10), barbules of `diameter` micrometres, keratin of
/// 1.3 g/cm^3.
pub fn loose_extinction<T: Real>(density: T, diameter: T) -> T {
    // Volume fraction over diameter; micrometres to millimetres.
    density / T::of(1300.0) / (diameter.max(T::of(1e-3)) * T::of(1e-3))
}

/// Extinction of a skin stretched to `area` times its rest area: the fibres stay, their number an area falls.
pub fn stretched_extinction<T: Real>(extinction: T, area: T) -> T {
    extinction / area.max(T::of(1e-3))
}

/// One level of a [`Density`].
#[derive(Clone, Debug, PartialEq)]
pub struct DensityLevel {
    /// Cells along x, y and z.
    pub size: UVec3,
    /// Extinction of every cell, x fastest, in optical depth per height of the coat.
    pub extinction: Vec<f32>,
}

/// A tile with its chain of coarser levels and its mean column: what the march reads.
///
/// A coarse cell holds the *effective* density `-ln(mean exp(-depth)) / length`, mean over the three axes, not the mean one: what it
/// hides is what its cells hid (docs/book/undercoat.md#density).
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    levels: Vec<DensityLevel>,
    width: f32,
    /// Optical depth above the lower end of every layer, and 0 last.
    column: Vec<f32>,
}

impl Density {
    /// All levels of a tile, down to one cell.
    pub fn new(tile: &Tile) -> Self {
        let finest = DensityLevel {
            size: tile.size(),
            extinction: tile.extinction().to_vec(),
        };
        let layer = (finest.size.x * finest.size.y) as usize;
        let mut column = vec![0.0f32];
        for cells in finest.extinction.chunks_exact(layer).rev() {
            let mean = cells.iter().sum::<f32>() / layer as f32;
            column.push(column[column.len() - 1] + mean / finest.size.z as f32);
        }
        column.reverse();
        let mut levels = vec![finest];
        while let Some(coarser) = coarser(&levels[levels.len() - 1], tile.width()) {
            levels.push(coarser);
        }
        Self {
            levels,
            width: tile.width(),
            column,
        }
    }

    /// The levels, finest first.
    pub fn levels(&self) -> &[DensityLevel] {
        &self.levels
    }

    /// Width of the tile in heights of the coat.
    pub fn width(&self) -> f32 {
        self.width
    }

    /// Mean extinction, which is the mean vertical optical depth.
    pub fn mean(&self) -> f32 {
        self.column[0]
    }

    /// Mean optical depth above a height.
    pub fn column<T: Real>(&self, z: T) -> T {
        let layers = self.column.len() - 1;
        let x = clamp(z, T::zero(), T::one()) * T::of(layers as f64);
        let i = x.floor().to_usize().unwrap_or(0).min(layers - 1);
        let t = x - T::of(i as f64);
        let at = |i: usize| T::of(f64::from(self.column[i]));
        at(i) + (at(i + 1) - at(i)) * t
    }

    /// Optical depths above the lower end of every layer, 0 last: the table behind [`Density::column`].
    pub fn columns(&self) -> &[f32] {
        &self.column
    }

    /// Power of the mean column, for [`mean_extinction`](super::march::mean_extinction): 1 for a uniform tile, more where the top is
    /// clear. The column's mean over height is right.
    pub fn power(&self) -> f32 {
        let layers = self.column.len() - 1;
        let sum = self
            .column
            .windows(2)
            .map(|c| 0.5 * (c[0] + c[1]))
            .sum::<f32>();
        let mean = sum / layers as f32;
        (self.mean() / mean.max(1e-6) - 1.0).clamp(1.0, 8.0)
    }

    /// Extinction at a place, linear between cells and between levels; u and v wrap, z is clamped.
    pub fn sample<T: Real>(&self, place: [T; 3], level: T) -> T {
        let deepest = T::of((self.levels.len() - 1) as f64);
        let level = clamp(level, T::zero(), deepest);
        let low = level.floor();
        let i = low.to_usize().unwrap_or(0);
        let fine = self.levels[i].sample(place);
        if level > low && i + 1 < self.levels.len() {
            fine + (self.levels[i + 1].sample(place) - fine) * (level - low)
        } else {
            fine
        }
    }
}

impl DensityLevel {
    fn sample<T: Real>(&self, place: [T; 3]) -> T {
        let half = T::of(0.5);
        let size = self.size.to_array();
        let mut low = [0usize; 3];
        let mut high = [0usize; 3];
        let mut part = [T::zero(); 3];
        for k in 0..3 {
            let n = T::of(f64::from(size[k]));
            let last = size[k] as usize - 1;
            let x = if k < 2 {
                (place[k] - place[k].floor()) * n - half
            } else {
                clamp(place[k] * n - half, T::zero(), T::of(last as f64))
            };
            let floor = x.floor();
            part[k] = x - floor;
            if floor < T::zero() {
                (low[k], high[k]) = (last, 0);
            } else {
                low[k] = floor.to_usize().unwrap_or(0).min(last);
                high[k] = if low[k] < last {
                    low[k] + 1
                } else if k < 2 {
                    0
                } else {
                    last
                };
            }
        }
        let row = size[0] as usize;
        let layer = row * size[1] as usize;
        let at = |x: usize, y: usize, z: usize| {
            T::of(f64::from(self.extinction[x + row * y + layer * z]))
        };
        let mix = |a: T, b: T, t: T| a + (b - a) * t;
        let line = |y: usize, z: usize| mix(at(low[0], y, z), at(high[0], y, z), part[0]);
        let plane = |z: usize| mix(line(low[1], z), line(high[1], z), part[1]);
        mix(plane(low[2]), plane(high[2]), part[2])
    }
}

/// The next level: blocks of two cells along every axis that has them. `None` below one cell.
fn coarser(fine: &DensityLevel, width: f32) -> Option<DensityLevel> {
    let size = fine.size;
    if size == UVec3::ONE {
        return None;
    }
    let half = (size / 2).max(UVec3::ONE);
    let cell = [
        width / size.x as f32,
        width / size.y as f32,
        1.0 / size.z as f32,
    ];
    let at = |p: [u32; 3]| {
        let x =
            p[0].min(size.x - 1) + size.x * (p[1].min(size.y - 1) + size.y * p[2].min(size.z - 1));
        fine.extinction[x as usize]
    };
    let mut extinction = Vec::with_capacity(half.as_usizevec3().element_product());
    for z in 0..half.z {
        for y in 0..half.y {
            for x in 0..half.x {
                let block = |i: u32, j: u32, k: u32| at([2 * x + i, 2 * y + j, 2 * z + k]);
                let mut sum = 0.0;
                for (axis, cell) in cell.iter().enumerate() {
                    let mut through = 0.0;
                    for column in 0..4u32 {
                        let (i, j) = (column & 1, column >> 1);
                        let depth = (0..2)
                            .map(|k| match axis {
                                0 => block(k, i, j),
                                1 => block(i, k, j),
                                _ => block(i, j, k),
                            })
                            .sum::<f32>();
                        through += 0.25 * (-depth * cell).exp();
                    }
                    sum -= through.max(1e-30).ln() / (2.0 * cell);
                }
                extinction.push(sum / 3.0);
            }
        }
    }
    Some(DensityLevel {
        size: half,
        extinction,
    })
}
