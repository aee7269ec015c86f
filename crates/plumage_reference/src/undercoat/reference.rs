//! The judges, in double precision: a dense march through a tile, and photons in a slab. They share no code with what they judge.

use bevy_plumage::maths::undercoat::Tile;
use rand_pcg::{
    Pcg64Mcg,
    rand_core::{Rng, SeedableRng},
};
use std::f64::consts::{PI, TAU};

/// A tile as a continuous medium: linear between the centres of its cells.
pub struct Medium {
    size: [usize; 3],
    width: f64,
    extinction: Vec<f64>,
}

/// Light that reaches every point of a lattice over a tile, from one direction.
pub struct Lit {
    size: [usize; 3],
    share: Vec<f64>,
}

fn lattice(values: &[f64], size: [usize; 3], place: [f64; 3], ends: bool) -> f64 {
    let mut sum = 0.0;
    let wrap = |i: i64, n: usize| i.rem_euclid(n as i64) as usize;
    let mut low = [0i64; 3];
    let mut part = [0.0; 3];
    for k in 0..3 {
        let n = size[k] as f64;
        // `ends`: the lattice has points at z = 0 and z = 1, cells otherwise have their values in the middle.
        let x = match (k, ends) {
            (2, true) => place[2].clamp(0.0, 1.0) * (n - 1.0),
            (2, false) => (place[2] * n - 0.5).clamp(0.0, n - 1.0),
            _ => place[k] * n - 0.5,
        };
        low[k] = x.floor() as i64;
        part[k] = x - x.floor();
    }
    for corner in 0..8 {
        let bit = |k: usize| corner >> k & 1;
        let weight: f64 = (0..3)
            .map(|k| if bit(k) == 1 { part[k] } else { 1.0 - part[k] })
            .product();
        if weight > 0.0 {
            let x = wrap(low[0] + bit(0), size[0]);
            let y = wrap(low[1] + bit(1), size[1]);
            let z = (low[2] + bit(2)).clamp(0, size[2] as i64 - 1) as usize;
            sum += weight * values[x + size[0] * (y + size[1] * z)];
        }
    }
    sum
}

impl Medium {
    /// The medium of a tile.
    pub fn new(tile: &Tile) -> Self {
        Self {
            size: tile.size().as_usizevec3().to_array(),
            width: f64::from(tile.width()),
            extinction: tile.extinction().iter().map(|e| f64::from(*e)).collect(),
        }
    }

    /// Extinction at a place (u and v in tiles, height).
    pub fn extinction(&self, place: [f64; 3]) -> f64 {
        lattice(&self.extinction, self.size, place, false)
    }

    fn along(&self, place: [f64; 3], direction: [f64; 3], way: f64) -> [f64; 3] {
        [
            place[0] + way * direction[0] / self.width,
            place[1] + way * direction[1] / self.width,
            place[2] + way * direction[2],
        ]
    }

    /// Optical depth from a place to the top in `steps` steps.
    pub fn depth(&self, place: [f64; 3], direction: [f64; 3], steps: usize) -> f64 {
        let way = (1.0 - place[2]) / direction[2];
        let step = way / steps as f64;
        let sample =
            |i: usize| self.extinction(self.along(place, direction, (i as f64 + 0.5) * step));
        step * (0..steps).map(sample).sum::<f64>()
    }

    /// Light from a direction at a lattice of points: those of the tile, with twice the points in height.
    pub fn lit(&self, light: [f64; 3]) -> Lit {
        let size = [self.size[0], self.size[1], 2 * self.size[2] + 1];
        let mut share = Vec::with_capacity(size.iter().product());
        for z in 0..size[2] {
            let height = z as f64 / (size[2] - 1) as f64;
            // Half a cell a step.
            let steps = 2.0 * self.size[2] as f64 * (1.0 - height) / light[2];
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let place = [
                        (x as f64 + 0.5) / size[0] as f64,
                        (y as f64 + 0.5) / size[1] as f64,
                        height,
                    ];
                    let depth = self.depth(place, light, (steps.ceil() as usize).max(1));
                    share.push((-depth).exp());
                }
            }
        }
        Lit { size, share }
    }

    /// Single scattering towards the eye, over `albedo / 4 pi` times the irradiance, and the transmittance to the skin, by `steps` equal
    /// steps from the top to the skin.
    pub fn radiance(&self, entry: [f64; 2], eye: [f64; 3], lit: &Lit, steps: usize) -> (f64, f64) {
        let way = 1.0 / eye[2];
        let step = way / steps as f64;
        let down = eye.map(|x| -x);
        let (mut sum, mut through) = (0.0, 1.0f64);
        for i in 0..steps {
            let place = self.along([entry[0], entry[1], 1.0], down, (i as f64 + 0.5) * step);
            let clear = (-self.extinction(place) * step).exp();
            sum += through * (1.0 - clear) * lit.at(place);
            through *= clear;
        }
        (sum, through)
    }
}

impl Lit {
    /// Share of the light that reaches a place.
    pub fn at(&self, place: [f64; 3]) -> f64 {
        lattice(&self.share, self.size, place, true)
    }
}

/// Photons in a uniform slab of isotropic scatterers over a diffuse skin.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// Vertical optical depth.
    pub depth: f64,
    /// Single-scattering albedo, 0..=1.
    pub albedo: f64,
    /// Reflectance of the skin, 0..=1.
    pub skin: f64,
}

fn uniform(rng: &mut Pcg64Mcg) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

impl Slab {
    /// Share of a light at the cosine `mu` that comes back out of the top. Photons carry weight: no noise from absorption.
    pub fn albedo(&self, mu: f64, photons: u32, seed: u64) -> f64 {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut out = 0.0;
        for _ in 0..photons {
            let (mut z, mut direction, mut weight) = (0.0f64, mu, 1.0f64);
            // `z` is the optical depth below the top; `direction` the cosine downwards.
            for _ in 0..2000 {
                let free = -(1.0 - uniform(&mut rng)).ln();
                z += free * direction;
                if z <= 0.0 {
                    out += weight;
                    break;
                }
                if z >= self.depth {
                    z = self.depth;
                    weight *= self.skin;
                    direction = -uniform(&mut rng).sqrt();
                } else {
                    weight *= self.albedo;
                    direction = 2.0 * uniform(&mut rng) - 1.0;
                }
                if weight < 1e-6 {
                    break;
                }
            }
        }
        out / f64::from(photons)
    }
}

/// Mean of `f` over the hemisphere of directions weighted with their cosine (an irradiance over pi), by a product rule.
pub fn hemisphere(f: impl Fn([f64; 3]) -> f64) -> f64 {
    let (rings, around) = (200, 8);
    let mut sum = 0.0;
    for i in 0..rings {
        // Equal shares of the projected disc.
        let mu = ((f64::from(i) + 0.5) / f64::from(rings)).sqrt();
        let sine = (1.0 - mu * mu).sqrt();
        for k in 0..around {
            let phi = TAU * (f64::from(k) + 0.5) / f64::from(around);
            sum += f([sine * phi.cos(), sine * phi.sin(), mu]);
        }
    }
    sum / f64::from(rings * around)
}

/// Exponential integral `E_n(x)`, n >= 1, as the integral of `exp(-x / mu) mu^(n-2)` over mu in 0..1.
pub fn exponential_integral(n: i32, x: f64) -> f64 {
    let count = 20_000;
    let value = |i: i32| {
        let mu = (f64::from(i) + 0.5) / f64::from(count);
        (-x / mu).exp() * mu.powi(n - 2)
    };
    (0..count).map(value).sum::<f64>() / f64::from(count)
}

/// Integral over the sphere, poles along z, by a product rule of midpoints.
pub fn sphere(f: impl Fn([f64; 3]) -> f64) -> f64 {
    let (rings, around) = (400, 128);
    let mut sum = 0.0;
    for i in 0..rings {
        let theta = PI * (f64::from(i) + 0.5) / f64::from(rings);
        for k in 0..around {
            let phi = TAU * (f64::from(k) + 0.5) / f64::from(around);
            let (s, c) = theta.sin_cos();
            sum += s * f([s * phi.cos(), s * phi.sin(), c]);
        }
    }
    sum * (PI / f64::from(rings)) * (TAU / f64::from(around))
}
