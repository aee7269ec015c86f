//! How high a shell may rise before it folds over itself.

use super::{ShellReport, ShellVertex};
use crate::maths::{
    Real,
    vector::{add, cross, dot, scale, sub},
};

/// A top triangle's area along the bottom's normal, over the bottom's area, at least (docs/book/undercoat.md#shell: at 0.59 the
/// walk loses no ray, at 0.12 it begins to).
pub const LOWEST_RATIO: f64 = 0.3;

/// What a pass leaves of the height of an unsafe triangle's vertices.
const SHRINK: f32 = 0.7;
const PASSES: usize = 8;

/// Area of the top triangle along the normal of the bottom one, over the bottom's: 1 for a prism, 0 or less where it folds. 1 for
/// a triangle without area.
pub fn area_ratio<T: Real>(bottom: [[T; 3]; 3], top: [[T; 3]; 3]) -> T {
    let area = |[p, q, r]: [[T; 3]; 3]| cross(sub(q, p), sub(r, p));
    let below = area(bottom);
    let square = dot(below, below);
    if square < T::of(1e-24) {
        return T::one();
    }
    dot(below, area(top)) / square
}

fn ratio(vertices: &[ShellVertex], triangle: &[u32; 3]) -> f64 {
    let bottom = triangle.map(|v| vertices[v as usize].position.map(f64::from));
    let top = triangle.map(|v| {
        let vertex = &vertices[v as usize];
        let rise = scale(vertex.normal.map(f64::from), f64::from(vertex.height));
        add(vertex.position.map(f64::from), rise)
    });
    area_ratio(bottom, top)
}

/// Lowers the vertices of unsafe triangles, pass by pass; the unsafe ones that are left.
fn shrink(vertices: &mut [ShellVertex], triangles: &[[u32; 3]]) -> usize {
    let mut unsafe_triangles = 0;
    for _ in 0..=PASSES {
        let bad = triangles
            .iter()
            .filter(|t| ratio(vertices, t) < LOWEST_RATIO)
            .copied()
            .collect::<Vec<_>>();
        unsafe_triangles = bad.len();
        let mut touched = bad.into_iter().flatten().collect::<Vec<_>>();
        if touched.is_empty() {
            break;
        }
        touched.sort_unstable();
        touched.dedup();
        for v in touched {
            vertices[v as usize].height *= SHRINK;
        }
    }
    unsafe_triangles
}

/// Limits the heights so that no triangle folds: shrinks, smooths once (never upwards), shrinks what that upset.
pub(super) fn limit(
    vertices: &mut [ShellVertex],
    triangles: &[[u32; 3]],
    report: &mut ShellReport,
) {
    let wanted = vertices.iter().map(|v| v.height).collect::<Vec<_>>();
    let mut folded = shrink(vertices, triangles);
    if vertices.iter().zip(&wanted).any(|(v, h)| v.height < *h) {
        // Relative to what was wanted: a thickness map keeps its own edges.
        let share = |v: usize, height: f32| {
            if wanted[v] > 0.0 {
                height / wanted[v]
            } else {
                1.0
            }
        };
        let mut sums = vec![(0.0f32, 0.0f32); vertices.len()];
        for t in triangles {
            for (v, w) in [(0, 1), (1, 2), (2, 0)].map(|(i, k)| (t[i] as usize, t[k] as usize)) {
                let (s, r) = (share(v, vertices[v].height), share(w, vertices[w].height));
                sums[v] = (sums[v].0 + r, sums[v].1 + 1.0);
                sums[w] = (sums[w].0 + s, sums[w].1 + 1.0);
            }
        }
        for (v, (sum, n)) in sums.into_iter().enumerate() {
            if n > 0.0 {
                let own = share(v, vertices[v].height);
                vertices[v].height = wanted[v] * own.min(0.5 * (own + sum / n));
            }
        }
        folded = shrink(vertices, triangles);
    }
    report.folded = folded;
    report.lowered = vertices
        .iter()
        .zip(&wanted)
        .filter(|(v, h)| v.height < **h)
        .count();
}
