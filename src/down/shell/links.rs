//! Which prism lies behind each wall, by directed edges, and the outside of the shell.

use super::{FACE_CORNERS, NO_LINK, Prism, Shell, ShellFace, TET_FACES, WALL_TETS};
use crate::down::vector::{cross, dot, sub};
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

pub(super) fn link(shell: &mut Shell, triangles: &[[u32; 3]]) {
    let area = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| shell.vertices[v as usize].position.map(f64::from));
        let n = cross(sub(q, p), sub(r, p));
        dot(n, n).sqrt()
    };
    let empty = triangles
        .iter()
        .map(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || area(t) < SMALLEST)
        .collect::<Vec<_>>();
    shell.report.degenerate = empty.iter().filter(|e| **e).count();

    let edges = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let sound = || triangles.iter().enumerate().filter(|(i, _)| !empty[*i]);
    let mut owner: HashMap<u64, u32> = HashMap::with_capacity(3 * triangles.len());
    let mut shared: HashSet<u64> = HashSet::new();
    for (i, t) in sound() {
        for (from, to) in edges(t) {
            if owner.insert(key(from, to), i as u32).is_some() {
                shared.insert(key(from.min(to), from.max(to)));
            }
        }
    }

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
            let torn = shared.contains(&key(pair.0, pair.1));
            let other = owner.get(&key(to, from)).filter(|_| !torn);
            if let Some((other, theirs)) =
                other.and_then(|o| Some((*o, wall(&prisms[*o as usize])?)))
            {
                prisms[i].links[own] = other * 4 + theirs as u32;
            } else {
                boundary += usize::from(!torn);
                walls.push((i, own as u32));
            }
        }
    }
    shell.report.boundary_edges = boundary;
    shell.report.non_manifold_edges = shared.len();
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
