//! Which prism lies behind each wall, by directed edges, and the outside of the shell.

use super::{
    FACE_CORNERS, NO_LINK, Prism, Shell, ShellFace, ShellReport, ShellVertex, TET_FACES, WALL_TETS,
};
use crate::maths::vector::{cross, dot, sub};
use std::collections::{HashMap, HashSet};

/// Twice the area of a triangle that has none, in square units of the mesh.
const SMALLEST: f64 = 2e-12;

/// Walls as pairs of sorted corners.
const WALLS: [(usize, usize); 3] = [(0, 1), (1, 2), (0, 2)];

fn key(from: u32, to: u32) -> u64 {
    (u64::from(from) << 32) | u64::from(to)
}

fn sorted(triangle: &[u32; 3], index: usize, empty: bool) -> Prism {
    let mut corners = [0u32, 1, 2];
    corners.sort_by_key(|k| triangle[*k as usize]);
    // Odd permutations turn the orientation around.
    let odd = matches!(corners, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
    let order = corners[0] | corners[1] << 2 | corners[2] << 4;
    Prism {
        corners: corners.map(|k| triangle[k as usize]),
        order: order | u32::from(odd) << 6 | u32::from(empty) << 7,
        links: [NO_LINK; 3],
        triangle: index as u32,
    }
}

/// Who owns each directed edge.
struct Edges {
    /// Triangles without area: they own none.
    empty: Vec<bool>,
    owner: HashMap<u64, u32>,
    /// Edges (lower vertex first) with a direction that two triangles claim.
    torn: HashSet<u64>,
}

impl Edges {
    fn find(vertices: &[ShellVertex], triangles: &[[u32; 3]]) -> Self {
        let area = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| vertices[v as usize].position.map(f64::from));
            let n = cross(sub(q, p), sub(r, p));
            dot(n, n).sqrt()
        };
        let empty = triangles
            .iter()
            .map(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || area(t) < SMALLEST)
            .collect::<Vec<_>>();
        let mut owner = HashMap::with_capacity(3 * triangles.len());
        let mut torn = HashSet::new();
        for (i, t) in triangles.iter().enumerate().filter(|(i, _)| !empty[*i]) {
            for (from, to) in edges(t) {
                if owner.insert(key(from, to), i as u32).is_some() {
                    torn.insert(key(from.min(to), from.max(to)));
                }
            }
        }
        Self { empty, owner, torn }
    }

    fn is_torn(&self, from: u32, to: u32) -> bool {
        self.torn.contains(&key(from.min(to), from.max(to)))
    }

    /// The triangle on the other side of an edge.
    fn across(&self, from: u32, to: u32) -> Option<u32> {
        let other = self.owner.get(&key(to, from)).copied();
        other.filter(|_| !self.is_torn(from, to))
    }
}

fn edges(t: &[u32; 3]) -> [(u32, u32); 3] {
    [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
}

fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}

/// Gives every sheet of skin its own vertices where sheets only touch, so that each rises along its own normal. The welded vertices
/// and triangles become those of the shell; the torn edges among them come back.
pub(super) fn split(
    vertices: &mut Vec<ShellVertex>,
    triangles: &mut [[u32; 3]],
    report: &mut ShellReport,
) -> HashSet<u64> {
    let found = Edges::find(vertices, triangles);
    report.non_manifold_edges = found.torn.len();
    let mut parents = (0..3 * triangles.len() as u32).collect::<Vec<_>>();
    for (i, t) in triangles
        .iter()
        .enumerate()
        .filter(|(i, _)| !found.empty[*i])
    {
        for (from, to) in edges(t) {
            let Some(other) = found.across(from, to) else {
                continue;
            };
            for v in [from, to] {
                let corner = |t: &[u32; 3]| t.iter().position(|w| *w == v).unwrap_or(0) as u32;
                let mine = root(&mut parents, 3 * i as u32 + corner(t));
                let theirs = 3 * other + corner(&triangles[other as usize]);
                let theirs = root(&mut parents, theirs);
                parents[mine.max(theirs) as usize] = mine.min(theirs);
            }
        }
    }
    // The first sheet at a place keeps the vertex, the others get copies of it.
    let mut owner = vec![NO_LINK; vertices.len()];
    let mut copies: HashMap<u32, u32> = HashMap::new();
    let mut places = (0..vertices.len() as u32).collect::<Vec<_>>();
    for (i, triangle) in triangles.iter_mut().enumerate() {
        if found.empty[i] {
            continue;
        }
        for (k, v) in triangle.iter_mut().enumerate() {
            let sheet = root(&mut parents, (3 * i + k) as u32);
            let place = *v;
            if owner[place as usize] == NO_LINK {
                owner[place as usize] = sheet;
            } else if owner[place as usize] != sheet {
                *v = *copies.entry(sheet).or_insert_with(|| {
                    vertices.push(vertices[place as usize]);
                    places.push(place);
                    vertices.len() as u32 - 1
                });
            }
        }
    }
    // In the ids of the new vertices, for those that count boundaries.
    let mut torn = HashSet::new();
    for t in triangles.iter() {
        for (from, to) in edges(t) {
            let (p, q) = (places[from as usize], places[to as usize]);
            if found.is_torn(p, q) {
                torn.insert(key(from.min(to), from.max(to)));
            }
        }
    }
    torn
}

pub(super) fn link(shell: &mut Shell, triangles: &[[u32; 3]], torn: &HashSet<u64>) {
    let found = Edges::find(&shell.vertices, triangles);
    let empty = &found.empty;
    shell.report.degenerate = empty.iter().filter(|e| **e).count();
    let sound = || triangles.iter().enumerate().filter(|(i, _)| !empty[*i]);

    let mut prisms = triangles
        .iter()
        .enumerate()
        .map(|(i, t)| sorted(t, i, empty[i]))
        .collect::<Vec<_>>();
    let mut boundary = 0;
    let mut walls = Vec::new();
    for (i, t) in sound() {
        for (from, to) in edges(t) {
            let pair = (from.min(to), from.max(to));
            let wall = |prism: &Prism| {
                WALLS
                    .iter()
                    .position(|w| (prism.corners[w.0], prism.corners[w.1]) == pair)
            };
            let Some(own) = wall(&prisms[i]) else {
                continue;
            };
            let other = found.across(from, to);
            if let Some((other, theirs)) = other.and_then(|o| Some((o, wall(&prisms[o as usize])?)))
            {
                prisms[i].links[own] = other * 4 + theirs as u32;
            } else {
                boundary += usize::from(!torn.contains(&key(pair.0, pair.1)));
                walls.push((i, own as u32));
            }
        }
    }
    shell.report.boundary_edges = boundary;
    shell.prisms = prisms;

    let face = |prism: usize, code: u32| outside(&shell.prisms[prism], prism, code);
    let mut faces = sound().map(|(i, _)| face(i, 3)).collect::<Vec<_>>();
    shell.tops = faces.len();
    faces.extend(
        walls
            .into_iter()
            .flat_map(|(i, wall)| [face(i, 4 + wall), face(i, 7 + wall)]),
    );
    shell.faces = faces;
}

/// A face as a triangle of the outside.
fn outside(prism: &Prism, index: usize, code: u32) -> ShellFace {
    let tet = if code == 3 {
        2
    } else {
        WALL_TETS[code as usize - 4]
    };
    let sign = TET_FACES[tet as usize]
        .iter()
        .find(|(face, _)| *face == code)
        .map_or(1, |(_, sign)| *sign);
    let mut corners =
        FACE_CORNERS[code as usize].map(|k| prism.corners[k as usize % 3] * 2 + u32::from(k >= 3));
    if (sign < 0) != (prism.order & 64 != 0) {
        corners.swap(1, 2);
    }
    ShellFace {
        corners,
        start: (index as u32) * 16 + code,
    }
}
