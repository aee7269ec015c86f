//! Brute force: rays through a real fibre, in double precision. The judge of the model; shares no code with it.
//!
//! Directions point away from the fibre; its axis is x. The eye is at azimuth 0 (+z), inclination theta_o. Absorption and
//! scattering are per fibre radius.

use rand_pcg::{Pcg64Mcg, rand_core::Rng};
use std::f64::consts::PI;

/// A fibre as a solid body.
#[derive(Clone, Copy, Debug)]
pub struct TracedFibre {
    /// Refractive index.
    pub eta: f64,
    /// Minor over major axis of the cross-section (minor along z), with major semi-axis 1. Core and medulla are similar ellipses.
    pub aspect: f64,
    /// Radius of the inner cylinder over the fibre's.
    pub inner: f64,
    /// Reflectance of a mirror at the inner cylinder; None lets light pass into the medulla.
    pub mirror: Option<f64>,
    /// Scattering coefficient of the medulla.
    pub scattering: f64,
    /// Henyey-Greenstein mean cosine of the medulla.
    pub anisotropy: f64,
    /// Absorption in cortex and medulla.
    pub absorption: f64,
    /// Standard deviation of the azimuth of the outer normal in radians (0: smooth).
    pub normal_spread: f64,
}

/// What happened to a ray on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct History {
    /// Entered the fibre at all.
    pub entered: bool,
    /// Reflections at the inside of the outer wall.
    pub inner_reflections: u32,
    /// Reflections at the mirror core.
    pub core_reflections: u32,
    /// Scattering events in the medulla.
    pub scatterings: u32,
}

impl History {
    /// Slot of the model's lobe: 0 R, 1 TT, 2 TRT and beyond, 3 TRcT and beyond, 4 medulla.
    pub fn lobe(&self) -> usize {
        match self {
            h if !h.entered => 0,
            h if h.scatterings > 0 => 4,
            h if h.core_reflections > 0 => 3,
            h if h.inner_reflections > 0 => 2,
            _ => 1,
        }
    }
}

/// One exit of light.
#[derive(Clone, Copy, Debug)]
pub struct Exit {
    /// Share of the ray's power.
    pub weight: f64,
    /// Direction of travel outside.
    pub direction: [f64; 3],
    /// How it got there.
    pub history: History,
}

impl Exit {
    /// Azimuth of the exit relative to the eye at azimuth `eye`, in -pi..pi.
    pub fn azimuth(&self, eye: f64) -> f64 {
        let a = self.direction[1].atan2(self.direction[2]) - eye;
        a.sin().atan2(a.cos())
    }
}

/// A uniform number in 0..1.
pub fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 * (0.5_f64).powi(53)
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    let radius = (-2.0 * (1.0 - uniform(random)).ln()).sqrt();
    radius * (2.0 * PI * uniform(random)).cos()
}

fn add(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

fn inner(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Power reflectance from Fresnel's angles, sin and tan of difference and sum.
fn reflectance(incident: f64, from: f64, to: f64) -> f64 {
    let sin_t = from / to * incident.sin();
    if sin_t >= 1.0 {
        return 1.0;
    }
    let refracted = sin_t.asin();
    let (difference, sum) = (incident - refracted, incident + refracted);
    if sum < 1e-7 {
        return ((from - to) / (from + to)).powi(2);
    }
    let s = (difference.sin() / sum.sin()).powi(2);
    let p = (difference.tan() / sum.tan()).powi(2);
    0.5 * (s + p)
}

impl TracedFibre {
    /// A clear fibre without a core.
    pub fn clear(eta: f64) -> Self {
        Self {
            eta,
            aspect: 1.0,
            inner: 0.0,
            mirror: None,
            scattering: 0.0,
            anisotropy: 0.0,
            absorption: 0.0,
            normal_spread: 0.0,
        }
    }

    /// Smallest and largest distance to the ellipse of `scale`, along `d` from `p`.
    fn meet(&self, p: [f64; 3], d: [f64; 3], scale: f64) -> Option<[f64; 2]> {
        let squash = 1.0 / (self.aspect * self.aspect);
        let a = d[1] * d[1] + squash * d[2] * d[2];
        let half_b = p[1] * d[1] + squash * p[2] * d[2];
        let c = p[1] * p[1] + squash * p[2] * p[2] - scale * scale;
        let discriminant = half_b * half_b - a * c;
        if discriminant < 0.0 || a < 1e-20 {
            return None;
        }
        let root = discriminant.sqrt();
        Some([(-half_b - root) / a, (-half_b + root) / a])
    }

    fn outward(&self, p: [f64; 3]) -> [f64; 3] {
        let n = [0.0, p[1], p[2] / (self.aspect * self.aspect)];
        let l = inner(n, n).sqrt();
        [0.0, n[1] / l, n[2] / l]
    }

    fn rough(&self, n: [f64; 3], random: &mut Pcg64Mcg) -> [f64; 3] {
        if self.normal_spread <= 0.0 {
            return n;
        }
        let (s, c) = (self.normal_spread * normal(random)).sin_cos();
        [0.0, n[1] * c + n[2] * s, n[2] * c - n[1] * s]
    }

    /// Traces one ray from the eye at inclination `theta` and azimuth `azimuth`, at height `h` in -1..1 of the silhouette, and
    /// hands every exit to `sink`. Splits at the outer wall by weight until a ray has scattered, then by chance.
    pub fn trace(
        &self,
        theta: f64,
        azimuth: f64,
        h: f64,
        random: &mut Pcg64Mcg,
        mut sink: impl FnMut(Exit),
    ) {
        let to_eye = [
            theta.sin(),
            theta.cos() * azimuth.sin(),
            theta.cos() * azimuth.cos(),
        ];
        let across = [0.0, azimuth.cos(), -azimuth.sin()];
        let silhouette = (across[1].powi(2) + (self.aspect * across[2]).powi(2)).sqrt();
        let start = add([0.0; 3], across, h * silhouette);
        let start = add(start, to_eye, 10.0 / theta.cos().max(1e-6));
        let towards = to_eye.map(|x| -x);
        let Some([near, _]) = self.meet(start, towards, 1.0) else {
            return;
        };
        let mut p = add(start, towards, near);
        let n = self.rough(self.outward(p), random);
        let cos = inner(n, to_eye);
        if cos <= 0.0 {
            // A rough normal turned away: as if mirrored at the true one.
            let m = self.outward(p);
            let d = add(towards, m, -2.0 * inner(towards, m));
            sink(Exit {
                weight: 1.0,
                direction: d,
                history: History::default(),
            });
            return;
        }
        let f = reflectance(cos.min(1.0).acos(), 1.0, self.eta);
        sink(Exit {
            weight: f,
            direction: add(towards, n, 2.0 * cos),
            history: History::default(),
        });
        let ratio = 1.0 / self.eta;
        let cos_t = (1.0 - ratio * ratio * (1.0 - cos * cos)).sqrt();
        let mut d = add(towards.map(|x| x * ratio), n, ratio * cos - cos_t);
        let mut weight = 1.0 - f;
        let mut history = History {
            entered: true,
            ..History::default()
        };
        for _ in 0..4000 {
            if weight < 1e-9 {
                return;
            }
            let Some([_, wall]) = self.meet(p, d, 1.0) else {
                return;
            };
            let body = if self.inner > 0.0 {
                self.meet(p, d, self.inner)
            } else {
                None
            };
            if let Some([enter, leave]) = body
                && leave > 1e-9
            {
                if let Some(mirror) = self.mirror
                    && enter > 1e-9
                {
                    weight *= mirror * (-self.absorption * enter).exp();
                    p = add(p, d, enter);
                    let n = self.outward(p);
                    d = add(d, n, -2.0 * inner(d, n));
                    history.core_reflections += 1;
                    continue;
                }
                if self.mirror.is_none() && self.scattering > 0.0 {
                    let enter = enter.max(0.0);
                    let free = -(1.0 - uniform(random)).ln() / self.scattering;
                    if free < leave - enter {
                        weight *= (-self.absorption * (enter + free)).exp();
                        p = add(p, d, enter + free);
                        d = self.scatter(d, random);
                        history.scatterings += 1;
                        continue;
                    }
                }
            }
            weight *= (-self.absorption * wall).exp();
            p = add(p, d, wall);
            let n = self.rough(self.outward(p), random);
            let cos = inner(n, d).clamp(1e-9, 1.0);
            let f = reflectance(cos.acos(), self.eta, 1.0);
            let leaves = if history.scatterings > 0 {
                f64::from(u8::from(uniform(random) >= f))
            } else {
                1.0 - f
            };
            if leaves > 0.0 {
                let k = (1.0 - self.eta * self.eta * (1.0 - cos * cos))
                    .max(0.0)
                    .sqrt()
                    - self.eta * cos;
                sink(Exit {
                    weight: weight * leaves,
                    direction: add(d.map(|x| x * self.eta), n, k),
                    history,
                });
            }
            weight *= 1.0 - leaves;
            let m = self.outward(p);
            d = add(d, m, -2.0 * inner(d, m));
            history.inner_reflections += 1;
        }
    }

    fn scatter(&self, d: [f64; 3], random: &mut Pcg64Mcg) -> [f64; 3] {
        let g = self.anisotropy;
        let u = uniform(random);
        let cos = if g.abs() < 1e-6 {
            1.0 - 2.0 * u
        } else {
            (1.0 + g * g - ((1.0 - g * g) / (1.0 + g - 2.0 * g * u)).powi(2)) / (2.0 * g)
        };
        // Any direction across: rejection from the ball, made orthogonal.
        let side = loop {
            let r = [0; 3].map(|_| 2.0 * uniform(random) - 1.0);
            let s = add(r, d, -inner(r, d));
            let (l2, whole) = (inner(s, s), inner(r, r));
            if whole <= 1.0 && l2 > 1e-6 {
                break s.map(|x| x / l2.sqrt());
            }
        };
        let out = add(d.map(|x| x * cos), side, (1.0 - cos * cos).max(0.0).sqrt());
        let l = inner(out, out).sqrt();
        out.map(|x| x / l)
    }

    /// Mean energy of the five lobes over `count` evenly spaced heights of the silhouette.
    pub fn energies(&self, theta: f64, count: usize, random: &mut Pcg64Mcg) -> [f64; 5] {
        let mut sum = [0.0; 5];
        for i in 0..count {
            let h = (2.0 * (i as f64 + uniform(random)) / count as f64 - 1.0)
                .clamp(-1.0 + 1e-12, 1.0 - 1e-12);
            self.trace(theta, 0.0, h, random, |e| sum[e.history.lobe()] += e.weight);
        }
        sum.map(|s| s / count as f64)
    }

    /// Density over the azimuth of the light relative to the eye, `bins` bins over -pi..pi, per radian, for each lobe.
    pub fn histogram(
        &self,
        theta: f64,
        eye: f64,
        count: usize,
        bins: usize,
        random: &mut Pcg64Mcg,
    ) -> [Vec<f64>; 5] {
        let mut out: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; bins]);
        let scale = bins as f64 / (2.0 * PI) / count as f64;
        for i in 0..count {
            let h = (2.0 * (i as f64 + uniform(random)) / count as f64 - 1.0)
                .clamp(-1.0 + 1e-12, 1.0 - 1e-12);
            self.trace(theta, eye, h, random, |e| {
                let bin = ((e.azimuth(eye) + PI) / (2.0 * PI) * bins as f64) as usize;
                out[e.history.lobe()][bin.min(bins - 1)] += e.weight * scale;
            });
        }
        out
    }
}
