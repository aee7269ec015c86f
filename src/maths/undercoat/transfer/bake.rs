//! Tracing rays from every cell.

use crate::maths::undercoat::{
    Tile,
    harmonics::{HARMONICS, fibonacci_rays, harmonics},
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, ops::Range};
use thiserror::Error;

/// Optical depth at which a ray is taken as dark: less than 0.0002 of the light is left.
const DARK: f32 = 8.5;
/// Most cells a ray walks through; what is left of its way goes through the mean of the tile.
const MOST_STEPS: u32 = 512;

/// How rays are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rays {
    /// A Fibonacci lattice: the error falls with the number of rays, not with its root.
    Fibonacci,
    /// A lattice in one quarter of the azimuth, mirrored in x and in y: a mirrored tile then has the mirrored transfer to rounding,
    /// and no side is brighter. Takes one and a half times as many rays as the plain lattice for the same error.
    #[default]
    Mirrored,
    /// Independent random directions, as published.
    Random(u64),
}

/// What a ray that meets the skin brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Skin {
    /// The light that the skin reflects: its albedo, 0 to 1.
    Opaque(f32),
    /// All light from below, as if there were no animal: as published.
    Clear,
}

/// How transfer is baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferSettings {
    /// Rays a cell, 16 to 65536.
    pub count: u32,
    /// How they are spread.
    pub rays: Rays,
    /// What is below.
    pub skin: Skin,
    /// Whether the sine between the ray and the fibre is inside the integral, as the diffuse light of a fibre needs it.
    pub sine: bool,
}

impl Default for TransferSettings {
    fn default() -> Self {
        Self {
            count: 512,
            rays: Rays::Mirrored,
            skin: Skin::Opaque(0.0),
            sine: false,
        }
    }
}

/// Settings that cannot be baked.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum TransferError {
    /// A number outside its range.
    #[error("{field} is {value}; allowed are {low} to {high}")]
    OutOfRange {
        /// What it is.
        field: &'static str,
        /// What was given.
        value: f64,
        /// Least allowed value.
        low: f64,
        /// Greatest allowed value.
        high: f64,
    },
}

/// Transfer as 25 harmonics a cell: the integral over directions of the light that arrives, times the basis.
#[derive(Clone, Debug, PartialEq)]
pub struct RawTransfer {
    /// One array a cell, in the tile's order.
    pub cells: Vec<[f32; HARMONICS]>,
    /// Albedo of the skin below; 0 without.
    pub albedo: f32,
}

/// Directions of a set of rays, each worth `4 pi / count`.
pub fn rays(rays: Rays, count: u32) -> Vec<[f64; 3]> {
    let count = count.max(1) as usize;
    match rays {
        Rays::Fibonacci => fibonacci_rays(count),
        Rays::Mirrored => {
            let quarter = count.div_ceil(4);
            let golden = 0.5 * (5f64.sqrt() - 1.0);
            let mut all = Vec::with_capacity(quarter * 4);
            for i in 0..quarter {
                let z = 1.0 - (2 * i + 1) as f64 / quarter as f64;
                let r = (1.0 - z * z).max(0.0).sqrt();
                // Folded like the mirrored function: a lattice is exact for whole periods only.
                let turn = 2.0 * ((i as f64 + 0.5) * golden).fract();
                let phi = 0.5 * PI * (1.0 - (turn - 1.0).abs());
                let (x, y) = (r * phi.cos(), r * phi.sin());
                all.extend([[x, y, z], [-x, y, z], [-x, -y, z], [x, -y, z]]);
            }
            all
        }
        Rays::Random(seed) => {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
            (0..count)
                .map(|_| {
                    let z = 2.0 * uniform() - 1.0;
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    let (sin, cos) = (2.0 * PI * uniform()).sin_cos();
                    [r * cos, r * sin, z]
                })
                .collect()
        }
    }
}

/// A ray with what its walk needs.
struct Ray {
    direction: [f32; 3],
    /// Steps of the cell's indices.
    step: [i32; 3],
    /// Way from one wall to the next, per axis, in heights.
    stride: [f32; 3],
    basis: [f32; HARMONICS],
}

/// A tile ready to be baked, cell by cell: [`Baker::bake`] takes any range of cells, so that a caller may spread them over a
/// task pool.
pub struct Baker<'a> {
    tile: &'a Tile,
    rays: Vec<Ray>,
    settings: TransferSettings,
    /// Mean extinction of the tile.
    mean: f32,
    /// Per harmonic: light that the skin reflects of a light that is this harmonic.
    skin_light: [f32; HARMONICS],
}

impl<'a> Baker<'a> {
    /// Prepares the rays, and the light on the skin if it reflects.
    pub fn new(tile: &'a Tile, settings: &TransferSettings) -> Result<Self, TransferError> {
        let within = |field, value: f64, low, high| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(TransferError::OutOfRange {
                    field,
                    value,
                    low,
                    high,
                })
            }
        };
        within("count", f64::from(settings.count), 16.0, 65_536.0)?;
        if let Skin::Opaque(albedo) = settings.skin {
            within("skin albedo", f64::from(albedo), 0.0, 1.0)?;
        }
        let size = tile.size().as_vec3();
        let width = [tile.width() / size.x, tile.width() / size.y, 1.0 / size.z];
        let rays = rays(settings.rays, settings.count)
            .into_iter()
            .map(|d| Ray {
                direction: d.map(|v| v as f32),
                step: d.map(|v| if v < 0.0 { -1 } else { 1 }),
                stride: [0, 1, 2].map(|k| width[k] / (d[k].abs() as f32).max(1e-9)),
                basis: harmonics(d).map(|v| v as f32),
            })
            .collect();
        let total: f64 = tile.extinction().iter().map(|e| f64::from(*e)).sum();
        let mut baker = Self {
            tile,
            rays,
            settings: *settings,
            mean: (total / tile.extinction().len() as f64) as f32,
            skin_light: [0.0; HARMONICS],
        };
        if let Skin::Opaque(albedo) = settings.skin
            && albedo > 0.0
        {
            baker.skin_light = baker.light_on_skin().map(|v| v * albedo);
        }
        Ok(baker)
    }

    /// Cells of the tile.
    pub fn cells(&self) -> usize {
        self.tile.extinction().len()
    }

    /// Transfer of some cells. The range is cut to the tile.
    pub fn bake(&self, cells: Range<usize>) -> Vec<[f32; HARMONICS]> {
        let end = cells.end.min(self.cells());
        (cells.start.min(end)..end).map(|i| self.cell(i)).collect()
    }

    /// Light left of every ray that leaves a cell, in the order of [`rays`]; 0 for those that opaque skin blocks. What the harmonics
    /// are made from. Empty for a cell that is not there.
    pub fn visibility(&self, cell: usize) -> Vec<f32> {
        if cell >= self.cells() {
            return Vec::new();
        }
        let size = self.tile.size().as_usizevec3();
        let place = [
            cell % size.x,
            cell / size.x % size.y,
            cell / (size.x * size.y),
        ];
        let clear = self.settings.skin == Skin::Clear;
        self.rays
            .iter()
            .map(|ray| {
                if ray.step[2] < 0 && !clear {
                    0.0
                } else {
                    self.transmittance(ray, place, 0.5)
                }
            })
            .collect()
    }

    fn cell(&self, index: usize) -> [f32; HARMONICS] {
        let size = self.tile.size().as_usizevec3();
        let place = [
            index % size.x,
            index / size.x % size.y,
            index / (size.x * size.y),
        ];
        let tangent = self.tile.tangent()[index].to_array();
        let weight = (4.0 * PI / self.rays.len() as f64) as f32;
        let mut sum = [0.0; HARMONICS];
        let mut blocked = 0.0;
        for ray in &self.rays {
            let down = ray.step[2] < 0;
            let clear = self.settings.skin == Skin::Clear;
            if down && !clear && self.skin_light[0] == 0.0 {
                continue;
            }
            let mut light = self.transmittance(ray, place, 0.5) * weight;
            if self.settings.sine {
                let cos = (0..3).map(|k| tangent[k] * ray.direction[k]).sum::<f32>();
                light *= (1.0 - cos * cos).max(0.0).sqrt();
            }
            if down && !clear {
                blocked += light;
                continue;
            }
            if light == 0.0 {
                continue;
            }
            for (sum, y) in sum.iter_mut().zip(ray.basis) {
                *sum += light * y;
            }
        }
        for (sum, skin) in sum.iter_mut().zip(self.skin_light) {
            *sum += blocked * skin;
        }
        sum
    }

    /// Radiance of a white skin under each harmonic: the mean over the cells of the lowest layer.
    fn light_on_skin(&self) -> [f32; HARMONICS] {
        let size = self.tile.size().as_usizevec3();
        let mut sum = [0.0; HARMONICS];
        let weight = 4.0 / (self.rays.len() * size.x * size.y) as f32;
        for ray in self.rays.iter().filter(|ray| ray.step[2] > 0) {
            for i in 0..size.x * size.y {
                let t = self.transmittance(ray, [i % size.x, i / size.x, 0], 0.0);
                let light = t * weight * ray.direction[2];
                for (sum, y) in sum.iter_mut().zip(ray.basis) {
                    *sum += light * y;
                }
            }
        }
        sum
    }

    /// Light left of a ray that starts in the middle of a cell (at `rise` of its height) and leaves the tile above or below.
    fn transmittance(&self, ray: &Ray, place: [usize; 3], rise: f32) -> f32 {
        let size = self.tile.size().as_usizevec3().to_array();
        let extinction = self.tile.extinction();
        let layer = size[0] * size[1];
        let up = ray.step[2] > 0;
        let [mut x, mut y, mut z] = place;
        let [sx, sy, sz] = ray.stride;
        let (mut next_x, mut next_y) = (sx * 0.5, sy * 0.5);
        let mut next_z = sz * if up { 1.0 - rise } else { rise };
        let mut way = 0.0;
        let mut depth = 0.0;
        for _ in 0..MOST_STEPS {
            let here = extinction[x + size[0] * y + layer * z];
            if next_x < next_y && next_x < next_z {
                depth += here * (next_x - way);
                way = next_x;
                next_x += sx;
                x = wrapped(x, ray.step[0], size[0]);
            } else if next_y < next_z {
                depth += here * (next_y - way);
                way = next_y;
                next_y += sy;
                y = wrapped(y, ray.step[1], size[1]);
            } else {
                depth += here * (next_z - way);
                way = next_z;
                next_z += sz;
                z = if up { z + 1 } else { z.wrapping_sub(1) };
                if z >= size[2] {
                    return (-depth).exp();
                }
            }
            if depth > DARK {
                return 0.0;
            }
        }
        let layers = if up { size[2] - z } else { z + 1 };
        depth += self.mean * (layers as f32 * sz);
        (-depth).exp()
    }
}

/// The next index along a period.
fn wrapped(i: usize, step: i32, size: usize) -> usize {
    if step > 0 {
        if i + 1 == size { 0 } else { i + 1 }
    } else if i == 0 {
        size - 1
    } else {
        i - 1
    }
}

/// Bakes a whole tile, on as many threads as asked for (1: on the caller's own).
pub fn bake(
    tile: &Tile,
    settings: &TransferSettings,
    threads: usize,
) -> Result<RawTransfer, TransferError> {
    let baker = Baker::new(tile, settings)?;
    let all = baker.cells();
    let albedo = match settings.skin {
        Skin::Opaque(albedo) => albedo,
        Skin::Clear => 0.0,
    };
    let threads = threads.clamp(1, 64);
    if threads == 1 {
        return Ok(RawTransfer {
            cells: baker.bake(0..all),
            albedo,
        });
    }
    // More parts than threads would be fairer, but cells of one layer cost about the same: deal out rows in turn.
    let part = all.div_ceil(threads * 8).max(1);
    let parts: Vec<Range<usize>> = (0..all)
        .step_by(part)
        .map(|i| i..(i + part).min(all))
        .collect();
    let mut cells = vec![[0.0; HARMONICS]; all];
    std::thread::scope(|scope| {
        let baker = &baker;
        let mut lanes: Vec<Vec<(Range<usize>, &mut [[f32; HARMONICS]])>> =
            (0..threads).map(|_| Vec::new()).collect();
        let mut rest = cells.as_mut_slice();
        for (i, range) in parts.into_iter().enumerate() {
            let (head, tail) = rest.split_at_mut(range.len());
            rest = tail;
            lanes[i % threads].push((range, head));
        }
        for lane in lanes {
            scope.spawn(move || {
                for (range, out) in lane {
                    out.copy_from_slice(&baker.bake(range));
                }
            });
        }
    });
    Ok(RawTransfer { cells, albedo })
}
