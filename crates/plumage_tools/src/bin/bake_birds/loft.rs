//! Lofts: superellipse sections along the spine and along the head.

use bevy::math::{Vec2, Vec3};

use crate::species::Species;

const EXPONENT: f32 = 2.1;

/// Where a point lies relative to a loft.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Arc of the nearest section (trunk) or z of it (head), mm.
    pub arc: f32,
    /// Angle round the section: 0 dorsal, 90 widest line, 180 ventral; degrees.
    pub angle: f32,
    /// Approximate signed distance, mm.
    pub distance: f32,
    /// Direction of the spine there, towards the head (zero for the head loft).
    pub spine: Vec3,
}

/// Monotone cubic through (x, y) samples; `x` rises.
fn monotone(xs: &[f32], ys: &[f32], x: f32) -> f32 {
    let n = xs.len();
    let x = x.clamp(xs[0], xs[n - 1]);
    let k = xs.partition_point(|v| *v <= x).clamp(1, n - 1) - 1;
    let slope = |i: usize| (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]);
    let tangent = |i: usize| {
        if i == 0 {
            return slope(0);
        }
        if i == n - 1 {
            return slope(n - 2);
        }
        let (a, b) = (slope(i - 1), slope(i));
        if a * b <= 0.0 {
            0.0
        } else {
            2.0 * a * b / (a + b)
        }
    };
    let h = xs[k + 1] - xs[k];
    let t = (x - xs[k]) / h;
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * ys[k]
        + (t3 - 2.0 * t2 + t) * h * tangent(k)
        + (3.0 * t2 - 2.0 * t3) * ys[k + 1]
        + (t3 - t2) * h * tangent(k + 1)
}

#[derive(Clone, Copy)]
struct Section {
    arc: f32,
    centre: Vec2,
    along: Vec2,
    half_width: f32,
    depth: f32,
    widest: f32,
}

/// Trunk and neck, from the tail root to the base of the skull.
pub struct Trunk {
    sections: Vec<Section>,
}

impl Trunk {
    const COUNT: usize = 160;

    /// Resamples the stations of a bird.
    pub fn new(species: &Species) -> Self {
        let column = |i: usize| species.trunk.map(|s| s[i]);
        let arcs = column(0);
        let tables: [[f32; 13]; 6] = [1, 2, 3, 4, 5, 6].map(column);
        let last = arcs[12];
        let sections = (0..Self::COUNT)
            .map(|i| {
                let arc = last * i as f32 / (Self::COUNT - 1) as f32;
                let v = tables.map(|t| monotone(&arcs, &t, arc));
                let pitch = v[0].to_radians();
                Section {
                    arc,
                    // (y, z) plane.
                    centre: Vec2::new(v[2], v[1]),
                    along: Vec2::new(pitch.sin(), pitch.cos()),
                    depth: v[3],
                    half_width: 0.5 * v[4],
                    widest: v[5],
                }
            })
            .collect();
        Self { sections }
    }

    /// Nearest section of a point; `p.x` is taken as positive.
    pub fn hit(&self, p: Vec3) -> Hit {
        let q = Vec2::new(p.y, p.z);
        let x = p.x.abs();
        let last = self.sections.len() - 1;
        let mut nearest = (f32::MAX, 0);
        for (i, s) in self.sections.iter().enumerate() {
            let d = (q - s.centre).length_squared();
            if d < nearest.0 {
                nearest = (d, i);
            }
        }
        let step = self.sections[1].arc;
        let k = nearest.1;
        let place = (k as f32 + (q - self.sections[k].centre).dot(self.sections[k].along) / step)
            .clamp(0.0, last as f32);
        let i = (place as usize).min(last - 1);
        let t = place - i as f32;
        let (a, b) = (self.sections[i], self.sections[i + 1]);
        let mix = |u: f32, v: f32| u + (v - u) * t;
        let along = a.along.lerp(b.along, t).normalize_or_zero();
        let dorsal = Vec2::new(along.y, -along.x);
        let r = q - a.centre.lerp(b.centre, t);
        let axial = r.dot(along);
        let depth = mix(a.depth, b.depth);
        let widest = mix(a.widest, b.widest);
        let half = mix(a.half_width, b.half_width);
        let up = r.dot(dorsal) - (widest - 0.5) * depth;
        let extent = depth * if up > 0.0 { 1.0 - widest } else { widest };
        // Beyond the ends the loft closes with a half ellipsoid: the tail root, and the top of the neck inside the head.
        let over = if place <= 0.0 && axial < 0.0 {
            -axial / (self.sections[0].depth * 0.85)
        } else if place >= last as f32 && axial > 0.0 {
            axial / (self.sections[last].depth * 0.62)
        } else {
            0.0
        };
        let level =
            ((x / half).powf(EXPONENT) + (up.abs() / extent).powf(EXPONENT) + over.powf(EXPONENT))
                .powf(1.0 / EXPONENT);
        let reach = (x * x + up * up + if over > 0.0 { axial * axial } else { 0.0 }).sqrt();
        let distance = if level > 0.2 {
            reach * (1.0 - 1.0 / level)
        } else {
            -half.min(extent)
        };
        Hit {
            arc: mix(a.arc, b.arc) + if over > 0.0 { axial } else { 0.0 },
            angle: (x / half).atan2(up / extent).to_degrees(),
            distance,
            spine: Vec3::new(0.0, along.x, along.y),
        }
    }
}

/// The head without its bill.
pub struct Head {
    z: [f32; 6],
    y: [f32; 6],
    height: [f32; 6],
    width: [f32; 6],
}

impl Head {
    /// Takes the stations of a bird.
    pub fn new(species: &Species) -> Self {
        Self {
            z: species.head.map(|s| s[0]),
            y: species.head.map(|s| s[1]),
            height: species.head.map(|s| s[2]),
            width: species.head.map(|s| s[3]),
        }
    }

    /// Nearest section of a point.
    pub fn hit(&self, p: Vec3) -> Hit {
        let z = p.z.clamp(self.z[0], self.z[5]);
        let y = p.y - monotone(&self.z, &self.y, z);
        let h = 0.5 * monotone(&self.z, &self.height, z);
        let w = 0.5 * monotone(&self.z, &self.width, z);
        let x = p.x.abs();
        let beyond = (p.z - z).abs();
        let over = beyond / 8.0;
        let level = ((x / w).powf(EXPONENT) + (y.abs() / h).powf(EXPONENT) + over.powf(EXPONENT))
            .powf(1.0 / EXPONENT);
        let reach = (x * x + y * y + beyond * beyond).sqrt();
        let distance = if level > 0.2 {
            reach * (1.0 - 1.0 / level)
        } else {
            -h.min(w)
        };
        Hit {
            arc: p.z,
            angle: (x / w).atan2(y / h).to_degrees(),
            distance,
            spine: Vec3::ZERO,
        }
    }
}
