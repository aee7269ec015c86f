//! Surface nets: the signed distance becomes a closed triangle mesh.

use std::collections::HashMap;

use bevy::math::{IVec3, Vec3};

use crate::body::Body;

/// A closed mesh.
pub struct Surface {
    /// Vertices.
    pub points: Vec<Vec3>,
    /// Triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

struct Lattice {
    low: IVec3,
    size: [usize; 3],
    cell: f32,
    values: Vec<f32>,
}

impl Lattice {
    fn place(&self, i: [usize; 3]) -> Vec3 {
        let o = IVec3::new(i[0] as i32, i[1] as i32, i[2] as i32);
        (self.low + o).as_vec3() * self.cell
    }

    fn at(&self, i: [usize; 3]) -> f32 {
        self.values[(i[2] * self.size[1] + i[1]) * self.size[0] + i[0]]
    }

    fn sample(body: &Body) -> Self {
        let cell = body.species.cell;
        let mut low = Vec3::splat(f32::MAX);
        let mut high = Vec3::splat(f32::MIN);
        let margin = Vec3::splat(6.0 * cell);
        let mut grow = |p: Vec3, r: f32| {
            low = low.min(p - Vec3::splat(r));
            high = high.max(p + Vec3::splat(r));
        };
        for s in body.species.trunk {
            grow(Vec3::new(0.0, s[3], s[2]), 0.5 * s[4].max(s[5]));
        }
        for s in body.species.head {
            grow(Vec3::new(0.0, s[1], s[0]), 0.5 * s[2].max(s[3]));
        }
        for p in body.wing.points {
            grow(p, body.species.arm[0]);
        }
        for name in ["femur_L", "tibia_L", "tarsus_L"] {
            grow(body.species.joint(name), body.species.legs[0][0]);
        }
        if body.species.feathered_tarsus {
            grow(body.species.joint("foot_L"), body.species.legs[2][1]);
        }
        let half = ((high.x + margin.x) / cell).ceil() as i32;
        let lo = ((low - margin) / cell).floor().as_ivec3();
        let hi = ((high + margin) / cell).ceil().as_ivec3();
        let size = [
            (2 * half + 1) as usize,
            (hi.y - lo.y + 1) as usize,
            (hi.z - lo.z + 1) as usize,
        ];
        let mut lattice = Self {
            low: IVec3::new(-half, lo.y, lo.z),
            size,
            cell,
            values: vec![0.0; size[0] * size[1] * size[2]],
        };
        for k in 0..size[2] {
            for j in 0..size[1] {
                let mut skip = 0;
                for i in (half as usize)..size[0] {
                    let d = if skip > 0 {
                        skip -= 1;
                        f32::MAX
                    } else {
                        let d = body.distance(lattice.place([i, j, k]));
                        // Far outside, neighbors cannot be inside: the loft distance is at least half the true one.
                        skip = if d > 8.0 * cell {
                            (0.3 * d / cell) as usize
                        } else {
                            0
                        };
                        d
                    };
                    let row = (k * size[1] + j) * size[0];
                    lattice.values[row + i] = d;
                    lattice.values[row + 2 * half as usize - i] = d;
                }
            }
        }
        lattice
    }
}

/// Polygonises and relaxes the skin of a bird.
pub fn polygonise(body: &Body) -> Surface {
    let lattice = Lattice::sample(body);
    let [nx, ny, nz] = lattice.size;
    let mut points = Vec::new();
    let mut index: HashMap<[usize; 3], u32> = HashMap::new();
    for k in 0..nz - 1 {
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                if let Some(p) = cell_vertex(&lattice, [i, j, k]) {
                    index.insert([i, j, k], points.len() as u32);
                    points.push(p);
                }
            }
        }
    }
    let mut quads = Vec::new();
    for k in 1..nz - 1 {
        for j in 1..ny - 1 {
            for i in 1..nx - 1 {
                let inside = lattice.at([i, j, k]) < 0.0;
                for axis in 0..3 {
                    let mut next = [i, j, k];
                    next[axis] += 1;
                    if inside == (lattice.at(next) < 0.0) {
                        continue;
                    }
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let around = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                        let mut c = [i, j, k];
                        c[u] -= 1 - a;
                        c[v] -= 1 - b;
                        index.get(&c).copied()
                    });
                    if let [Some(a), Some(b), Some(c), Some(d)] = around {
                        quads.push(if inside { [a, b, c, d] } else { [a, d, c, b] });
                    }
                }
            }
        }
    }
    relax(body, &mut points, &quads);
    let triangles = quads
        .iter()
        .flat_map(|q| {
            let p = q.map(|i| points[i as usize]);
            if p[0].distance_squared(p[2]) <= p[1].distance_squared(p[3]) {
                [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
            } else {
                [[q[0], q[1], q[3]], [q[1], q[2], q[3]]]
            }
        })
        .collect();
    Surface { points, triangles }
}

/// Mean of the edge crossings of one cell.
fn cell_vertex(lattice: &Lattice, c: [usize; 3]) -> Option<Vec3> {
    let corner = |b: usize| [c[0] + (b & 1), c[1] + ((b >> 1) & 1), c[2] + (b >> 2)];
    let values: [f32; 8] = std::array::from_fn(|b| lattice.at(corner(b)));
    let mut sum = Vec3::ZERO;
    let mut count = 0.0;
    for a in 0..8 {
        for bit in [1, 2, 4] {
            let b = a | bit;
            if b != a && (values[a] < 0.0) != (values[b] < 0.0) {
                let t = (values[a] / (values[a] - values[b])).clamp(0.0, 1.0);
                let t = if t.is_finite() { t } else { 0.5 };
                sum += lattice.place(corner(a)).lerp(lattice.place(corner(b)), t);
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// Evens the spacing along the surface while keeping the vertices on it.
fn relax(body: &Body, points: &mut [Vec3], quads: &[[u32; 4]]) {
    let mut neighbors = vec![Vec::<u32>::new(); points.len()];
    for q in quads {
        for i in 0..4 {
            let (a, b) = (q[i], q[(i + 1) % 4]);
            if !neighbors[a as usize].contains(&b) {
                neighbors[a as usize].push(b);
                neighbors[b as usize].push(a);
            }
        }
    }
    for p in points.iter_mut() {
        *p = body.project(*p, 2);
    }
    for _ in 0..5 {
        let old = points.to_vec();
        for (i, p) in points.iter_mut().enumerate() {
            if neighbors[i].is_empty() {
                continue;
            }
            let mean = neighbors[i].iter().map(|n| old[*n as usize]).sum::<Vec3>()
                / neighbors[i].len() as f32;
            let g = body.gradient(old[i]).normalize_or(Vec3::Y);
            let shift = mean - old[i];
            *p = body.project(old[i] + 0.6 * (shift - g * shift.dot(g)), 1);
        }
    }
}
