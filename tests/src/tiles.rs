//! Volumes and lights of the down tests and charts.

use bevy::math::{UVec3, Vec3};
use bevy_plumage::maths::undercoat::Tile;
use bevy_plumage::maths::undercoat::harmonics::fibonacci_rays;
use bevy_plumage::maths::undercoat::texture::{Fur, fur_tile};

/// A word mixed from three.
fn hash(x: u64, y: u64, seed: u64) -> f64 {
    let mut z = x
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(y.wrapping_mul(0xd1b5_4a32_d192_ed03))
        .wrapping_add(seed.wrapping_mul(0x8cb9_2ba7_2f3d_8dd7));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Value noise on a lattice of `n` cells, periodic over 0..1.
fn noise(u: f64, v: f64, n: u64, seed: u64) -> f64 {
    let (x, y) = (u.rem_euclid(1.0) * n as f64, v.rem_euclid(1.0) * n as f64);
    let (i, j) = (x.floor() as u64, y.floor() as u64);
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let (s, t) = (smooth(x.fract()), smooth(y.fract()));
    let at = |a: u64, b: u64| hash((i + a) % n, (j + b) % n, seed);
    let low = at(0, 0) * (1.0 - s) + at(1, 0) * s;
    let high = at(0, 1) * (1.0 - s) + at(1, 1) * s;
    low * (1.0 - t) + high * t
}

/// The volume `down` of docs/book/undercoat.md: smooth clumps of mean optical depth 4, as high as `size.z` cells that are cubes.
pub fn down_tile(size: u32, layers: u32, seed: u64) -> Tile {
    let scale = |n: u64| (n * u64::from(size) / 64).max(1);
    let mut extinction = Vec::new();
    for k in 0..layers {
        let z = (f64::from(k) + 0.5) / f64::from(layers);
        for j in 0..size {
            for i in 0..size {
                let (u, v) = (
                    (f64::from(i) + 0.5) / f64::from(size),
                    (f64::from(j) + 0.5) / f64::from(size),
                );
                let clump = noise(u, v, scale(8), seed);
                let shift = 0.05 * z * z;
                let u = u + shift * (noise(u, v, scale(16), seed + 1) - 0.5);
                let v = v + shift * (noise(u, v, scale(16), seed + 2) - 0.5);
                let fibre =
                    0.5 * noise(u, v, scale(24), seed + 3) + 0.5 * noise(u, v, scale(48), seed + 4);
                let height = 0.55 + 0.45 * clump;
                let cut = ((height - z) / 0.25).clamp(0.0, 1.0);
                extinction.push((fibre * fibre * cut) as f32);
            }
        }
    }
    let mean = extinction.iter().sum::<f32>() / extinction.len() as f32;
    for e in &mut extinction {
        *e *= 4.0 / mean;
    }
    let width = size as f32 / layers as f32;
    let count = extinction.len();
    Tile::new(
        UVec3::new(size, size, layers),
        width,
        extinction,
        vec![Vec3::Z; count],
    )
    .expect("a sound tile")
}

/// The volume `hair` of docs/book/undercoat.md, `size` cells wide (64 there), with as many hairs a cell.
pub fn hair_tile(size: u32, layers: u32, seed: u64) -> Tile {
    let mut fur = Fur {
        size: UVec3::new(size, size, layers),
        width: size as f32 / layers as f32,
        seed,
        ..Fur::default()
    };
    for coat in &mut fur.coats {
        coat.hairs = coat.hairs * size * size / 4096;
    }
    fur_tile(&fur).expect("a sound fur")
}

/// A tile of one extinction.
pub fn uniform_tile(size: u32, layers: u32, extinction: f32) -> Tile {
    let count = (size * size * layers) as usize;
    let width = size as f32 / layers as f32;
    Tile::new(
        UVec3::new(size, size, layers),
        width,
        vec![extinction; count],
        vec![Vec3::X; count],
    )
    .expect("a sound tile")
}

/// The tile mirrored in x.
pub fn mirrored(tile: &Tile) -> Tile {
    let size = tile.size();
    let mut extinction = Vec::new();
    let mut tangent = Vec::new();
    for z in 0..size.z as i32 {
        for y in 0..size.y as i32 {
            for x in 0..size.x as i32 {
                let from = tile.cell(size.x as i32 - 1 - x, y, z);
                extinction.push(tile.extinction()[from]);
                tangent.push(tile.tangent()[from] * Vec3::new(-1.0, 1.0, 1.0));
            }
        }
    }
    Tile::new(size, tile.width(), extinction, tangent).expect("a sound tile")
}

/// What is left of a ray, by steps of about `step` heights through the tile: shares nothing with the walk of the crate.
pub fn reference_ray(tile: &Tile, from: [f64; 3], d: [f64; 3], step: f64) -> f64 {
    let size = tile.size().as_dvec3();
    let way = if d[2] > 0.0 {
        (1.0 - from[2]) / d[2]
    } else {
        from[2] / -d[2]
    };
    let steps = (way / step).ceil().min(1e6) as usize;
    let step = way / steps as f64;
    let mut depth = 0.0;
    for i in 0..steps {
        let t = (i as f64 + 0.5) * step;
        let p = [0, 1, 2].map(|k| from[k] + t * d[k]);
        let width = f64::from(tile.width());
        let cell = tile.cell(
            (p[0] / width * size.x).floor() as i32,
            (p[1] / width * size.y).floor() as i32,
            (p[2] * size.z).floor() as i32,
        );
        depth += f64::from(tile.extinction()[cell]) * step;
        if depth > 20.0 {
            break;
        }
    }
    (-depth).exp()
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A bluish sky, lighter towards the zenith, with a soft sun in direction `sun`: red, green, blue.
pub fn sky_light(sun: [f64; 3], d: [f64; 3]) -> [f64; 3] {
    let up = 0.5 + 0.5 * d[2];
    let sun = 3.0 * (12.0 * (dot(sun, d) - 1.0)).exp();
    [0.6 * up + sun, 0.8 * up + 0.9 * sun, up + 0.7 * sun]
}

/// The light of Kloetzli 2005: one lobe.
pub fn lobe_light(axis: [f64; 3], d: [f64; 3]) -> f64 {
    (5.0 * dot(axis, d) - 4.0).max(0.0)
}

/// Lights over the upper hemisphere: 16 directions.
pub fn light_directions() -> Vec<[f64; 3]> {
    fibonacci_rays(32)
        .into_iter()
        .filter(|d| d[2] > 0.0)
        .collect()
}

/// Luminance.
pub fn grey(c: [f64; 3]) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

/// Cells of a tile spread over all heights, and what reaches each from a light, by 2048 rays of the judge.
pub struct Judge {
    /// Cells that are judged.
    pub cells: Vec<usize>,
    rays: Vec<[f64; 3]>,
    visible: Vec<Vec<f64>>,
}

impl Judge {
    pub fn new(tile: &Tile, step: usize) -> Self {
        let size = tile.size();
        let rays: Vec<[f64; 3]> = fibonacci_rays(2048)
            .into_iter()
            .filter(|d| d[2] > 0.0)
            .collect();
        let cells: Vec<usize> = (0..tile.extinction().len()).step_by(step).collect();
        let place = |cell: usize| {
            let at = |i: usize, n: u32, width: f64| (i as f64 + 0.5) / f64::from(n) * width;
            let (nx, ny) = (size.x as usize, size.y as usize);
            let width = f64::from(tile.width());
            [
                at(cell % nx, size.x, width),
                at(cell / nx % ny, size.y, width),
                at(cell / nx / ny, size.z, 1.0),
            ]
        };
        let step = 0.3 / f64::from(size.z);
        let visible = cells
            .iter()
            .map(|cell| {
                rays.iter()
                    .map(|d| reference_ray(tile, place(*cell), *d, step))
                    .collect()
            })
            .collect();
        Self {
            cells,
            rays,
            visible,
        }
    }

    /// Root of the mean square over cells and suns of what `guess` says (cell, sun) against the judge, over the mean.
    pub fn error(
        &self,
        light: impl Fn([f64; 3], [f64; 3]) -> f64,
        guess: impl Fn(usize, usize) -> f64,
    ) -> f64 {
        let (mut square, mut sum, mut count) = (0.0, 0.0, 0.0);
        for (s, sun) in light_directions().into_iter().enumerate() {
            let values: Vec<f64> = self.rays.iter().map(|d| light(sun, *d)).collect();
            for (cell, visible) in self.cells.iter().zip(&self.visible) {
                let lit: f64 = visible.iter().zip(&values).map(|(v, l)| v * l).sum();
                let truth = lit / 2048.0;
                square += (guess(*cell, s) - truth).powi(2);
                sum += truth;
                count += 1.0;
            }
        }
        f64::sqrt(square / count) / (sum / count)
    }
}
