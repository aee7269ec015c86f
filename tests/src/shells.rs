//! Meshes and the brute-force judge of the shell's walk.

use bevy_plumage::maths::undercoat::shell::Shell;
use rand::{Rng, RngExt};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A mesh: positions, indices, height.
pub struct Skin {
    /// Name for messages.
    pub name: &'static str,
    /// Positions.
    pub positions: Vec<[f32; 3]>,
    /// Triangles.
    pub indices: Vec<u32>,
    /// Height of every vertex.
    pub height: f32,
}

impl Skin {
    /// Its shell.
    pub fn shell(&self) -> Shell {
        let heights = vec![self.height; self.positions.len()];
        Shell::build(&self.positions, &self.indices, &heights).expect("a sound mesh")
    }
}

/// A torus, R 1, r 0.4, `bumps` of the small radius; `open` leaves out a quarter of the way around.
pub fn torus(
    name: &'static str,
    around: u32,
    across: u32,
    bumps: f64,
    open: bool,
    height: f32,
) -> Skin {
    let mut positions = Vec::new();
    for i in 0..around {
        for k in 0..across {
            let (u, v) = (
                TAU * f64::from(i) / f64::from(around),
                TAU * f64::from(k) / f64::from(across),
            );
            let r = 0.4 * (1.0 + bumps * (5.0 * u).sin() * (3.0 * v).cos());
            let w = 1.0 + r * v.cos();
            positions.push([w * u.cos(), r * v.sin(), w * u.sin()].map(|x| x as f32));
        }
    }
    let mut indices = Vec::new();
    let last = if open { 3 * around / 4 } else { around };
    for i in 0..last {
        for k in 0..across {
            let at = |i: u32, k: u32| (i % around) * across + k % across;
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
            indices.extend([a, b, c, b, d, c]);
        }
    }
    Skin {
        name,
        positions,
        indices,
        height,
    }
}

/// Three sheets that share an edge, and a triangle without area beside them.
pub fn fan() -> Skin {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    let n = 8u32;
    // Axis points first, then every sheet's.
    for sheet in 0..3 {
        let angle = TAU * f64::from(sheet) / 3.0 + 0.2;
        let base = positions.len() as u32;
        for i in 0..=n {
            for k in 0..=n {
                let (x, r) = (f64::from(i) / 8.0, f64::from(k) / 8.0);
                positions.push([x, r * angle.cos(), r * angle.sin()].map(|v| {
                    // One axis for all, to the bit.
                    if k == 0 && v.abs() < 1e-9 {
                        0.0
                    } else {
                        v as f32
                    }
                }));
            }
        }
        for i in 0..n {
            for k in 0..n {
                let at = |i: u32, k: u32| base + i * (n + 1) + k;
                let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
                indices.extend([a, c, b, b, c, d]);
            }
        }
    }
    // Two corners at one place, and one in a line.
    indices.extend([0, 0, 1, 0, 1, 2]);
    Skin {
        name: "fan",
        positions,
        indices,
        height: 0.05,
    }
}

/// The skins of the walk's test.
pub fn skins() -> Vec<Skin> {
    vec![
        torus("torus", 40, 20, 0.0, false, 0.1),
        torus("open torus", 40, 20, 0.0, true, 0.1),
        torus("bumpy torus", 56, 32, 0.15, false, 0.1),
        fan(),
    ]
}

type V = [f64; 3];

fn minus(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn times(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn inner(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// What belongs to one prism, inside a sphere: tetrahedra (any four points), and triangles where a ray may enter, with their start.
struct Block {
    centre: V,
    radius: f64,
    tets: Vec<[V; 4]>,
    faces: Vec<([V; 3], u32)>,
}

/// Neighbours in the order of the mesh, inside one sphere.
struct Group {
    centre: V,
    radius: f64,
    blocks: std::ops::Range<usize>,
}

/// All tetrahedra of a shell, to be cut one by one; what a ray passes by is left out unseen.
pub struct Brute {
    blocks: Vec<Block>,
    groups: Vec<Group>,
}

fn meets(centre: V, radius: f64, origin: V, direction: V) -> bool {
    let off = times(minus(centre, origin), direction);
    inner(off, off) <= radius * radius
}

impl Brute {
    /// Every prism as three tetrahedra between its corners, by the ids of their vertices.
    pub fn new(shell: &Shell) -> Self {
        let point = |c: u32| {
            let v = &shell.vertices[c as usize / 2];
            // The same rounding as the shell's own corners: those are what is judged, not the extrusion.
            if c & 1 == 1 { v.top() } else { v.position }.map(f64::from)
        };
        let mut blocks = shell
            .prisms
            .iter()
            .enumerate()
            .map(|(i, prism)| {
                let mut ids = prism.corners;
                ids.sort_unstable();
                let (low, high) = (ids.map(|v| point(2 * v)), ids.map(|v| point(2 * v + 1)));
                let all = low.iter().chain(&high);
                let centre = [0, 1, 2].map(|k| all.clone().map(|p| p[k]).sum::<f64>() / 6.0);
                let far = all.map(|p| inner(minus(*p, centre), minus(*p, centre)));
                let radius = far.fold(0.0, f64::max).sqrt() * 1.000_001;
                let tets = vec![
                    [low[0], low[1], low[2], high[2]],
                    [low[0], low[1], high[1], high[2]],
                    [low[0], high[0], high[1], high[2]],
                ];
                // The skin as seen from the body: the mesh's triangle turned around.
                let [a, b, c] = prism.corners.map(|v| 2 * v);
                let clockwise = prism.order & 64 != 0;
                let skin = if clockwise { [a, b, c] } else { [a, c, b] };
                Block {
                    centre,
                    radius,
                    tets: if prism.is_empty() { Vec::new() } else { tets },
                    faces: vec![(skin.map(point), i as u32 * 16)],
                }
            })
            .collect::<Vec<_>>();
        for face in &shell.faces {
            let corners = face.corners.map(point);
            blocks[face.start as usize / 16]
                .faces
                .push((corners, face.start));
        }
        blocks.retain(|b| !b.tets.is_empty());
        let groups = (0..blocks.len())
            .step_by(16)
            .map(|first| {
                let range = first..(first + 16).min(blocks.len());
                let some = &blocks[range.clone()];
                let mean = |k: usize| some.iter().map(|b| b.centre[k]).sum::<f64>();
                let centre = [0, 1, 2].map(|k| mean(k) / some.len() as f64);
                let reach = |b: &Block| {
                    let off = minus(b.centre, centre);
                    inner(off, off).sqrt() + b.radius
                };
                Group {
                    centre,
                    radius: some.iter().map(reach).fold(0.0, f64::max) * 1.000_001,
                    blocks: range,
                }
            })
            .collect();
        Self { blocks, groups }
    }

    fn near(&self, origin: V, direction: V) -> impl Iterator<Item = &Block> {
        self.groups
            .iter()
            .filter(move |group| meets(group.centre, group.radius, origin, direction))
            .flat_map(|group| &self.blocks[group.blocks.clone()])
            .filter(move |block| meets(block.centre, block.radius, origin, direction))
    }

    /// The intervals of a ray (unit direction, t > 0) inside the shell, ordered and joined where they touch within `gap`.
    pub fn intervals(&self, origin: V, direction: V, gap: f64) -> Vec<(f64, f64)> {
        let mut cut = self
            .near(origin, direction)
            .flat_map(|block| &block.tets)
            .filter_map(|tet| clip(tet, origin, direction))
            .collect::<Vec<_>>();
        cut.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut joined: Vec<(f64, f64)> = Vec::new();
        for (from, to) in cut {
            match joined.last_mut() {
                Some(last) if from <= last.1 + gap => last.1 = last.1.max(to),
                _ => joined.push((from, to)),
            }
        }
        joined
    }

    /// Triangles where a ray enters the shell (front faces of its outside, and the skin from below), nearest first: `(t, start)`. A
    /// hit on an edge counts for all its triangles.
    pub fn entries(&self, origin: V, direction: V) -> Vec<(f64, u32)> {
        let mut hits = self
            .near(origin, direction)
            .flat_map(|block| &block.faces)
            .filter_map(|([p, q, r], start)| {
                let n = times(minus(*q, *p), minus(*r, *p));
                let slope = inner(n, direction);
                if slope >= 0.0 {
                    return None;
                }
                let t = inner(n, minus(*p, origin)) / slope;
                let x = [0, 1, 2].map(|k| origin[k] + t * direction[k]);
                let size = inner(n, n);
                let inside = [(p, q), (q, r), (r, p)]
                    .iter()
                    .all(|(a, b)| inner(times(minus(**b, **a), minus(x, **a)), n) >= -1e-9 * size);
                (t > 0.0 && inside).then_some((t, *start))
            })
            .collect::<Vec<_>>();
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        hits
    }
}

/// The part of a ray inside a tetrahedron (half spaces, either orientation).
fn clip(points: &[V; 4], origin: V, direction: V) -> Option<(f64, f64)> {
    let (mut from, mut to) = (0.0f64, f64::MAX);
    for k in 0..4 {
        let [p, q, r] = [1, 2, 3].map(|j| points[(k + j) % 4]);
        let mut n = times(minus(q, p), minus(r, p));
        let inside = inner(n, minus(points[k], p));
        if inside.abs() < 1e-24 {
            return None;
        }
        if inside < 0.0 {
            n = n.map(|x| -x);
        }
        let (here, slope) = (inner(n, minus(origin, p)), inner(n, direction));
        if slope > 0.0 {
            from = from.max(-here / slope);
        } else if slope < 0.0 {
            to = to.min(-here / slope);
        } else if here < 0.0 {
            return None;
        }
    }
    (from < to).then_some((from, to))
}

/// Rays at a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// Between two points of a sphere around it.
    Random,
    /// Along the surface, at a random height of the shell.
    Tangent,
    /// At vertices and edges.
    Vertices,
}

fn unit(a: V) -> V {
    let length = inner(a, a).sqrt();
    a.map(|x| x / length)
}

fn sphere(rng: &mut impl Rng) -> V {
    let z = rng.random_range(-1.0..1.0f64);
    let a = rng.random_range(0.0..TAU);
    let r = (1.0 - z * z).sqrt();
    [r * a.cos(), r * a.sin(), z]
}

/// A ray from outside: origin and unit direction.
pub fn ray(shell: &Shell, aim: Aim, rng: &mut impl Rng) -> (V, V) {
    match aim {
        Aim::Random => {
            let origin = sphere(rng).map(|x| 2.5 * x);
            let target = sphere(rng).map(|x| 1.2 * x);
            (origin, unit(minus(target, origin)))
        }
        Aim::Tangent => {
            let v = &shell.vertices[rng.random_range(0..shell.vertices.len())];
            let n = v.normal.map(f64::from);
            let height = f64::from(v.height) * rng.random_range(0.0..1.0);
            let along = unit(times(n, sphere(rng)));
            let origin =
                [0, 1, 2].map(|k| f64::from(v.position[k]) + height * n[k] - 3.0 * along[k]);
            (origin, along)
        }
        Aim::Vertices => {
            let prism = &shell.prisms[rng.random_range(0..shell.prisms.len())];
            let [p, q] = [0, 1].map(|k: usize| {
                let v = &shell.vertices[prism.corners[k] as usize];
                let end = if rng.random_range(0..2) == 0 {
                    v.position
                } else {
                    v.top()
                };
                end.map(f64::from)
            });
            let s = if rng.random_range(0..2) == 0 {
                0.0
            } else {
                rng.random_range(0.0..1.0)
            };
            let target = [0, 1, 2].map(|k| p[k] + s * (q[k] - p[k]));
            let origin = sphere(rng).map(|x| 2.5 * x);
            (origin, unit(minus(target, origin)))
        }
    }
}

/// Sums `f` over the numbers below `count`, on all processors.
pub fn sum<const N: usize>(count: u64, f: impl Fn(u64) -> [f64; N] + Sync + Send) -> [f64; N] {
    (0..count)
        .into_par_iter()
        .map(f)
        .reduce(|| [0.0; N], |a, b| std::array::from_fn(|k| a[k] + b[k]))
}
