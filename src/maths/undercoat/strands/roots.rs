//! Where strands grow.

use crate::maths::seed::{Stream, mix};
use bevy::math::Vec3;

/// Most candidate roots of one mesh; a denser coat is thinned to this.
pub const MOST_STRANDS: usize = 1 << 22;

/// The root of a strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandRoot {
    /// Triangle that it grows on.
    pub triangle: u32,
    /// Weights of the triangle's corners; their sum is 1.
    pub barycentric: [f32; 3],
    /// Random bits of the strand, for its length, lay and color. Sorting by them is the shuffled order.
    pub seed: u32,
}

impl StrandRoot {
    /// A value mixed from those of the triangle's corners.
    pub fn mix(&self, corners: [Vec3; 3]) -> Vec3 {
        let [a, b, c] = self.barycentric;
        corners[0] * a + corners[1] * b + corners[2] * c
    }
}

/// Grows roots on a mesh: `densest` per square unit of the mesh times `density` (0 to 1) at the root.
///
/// Every triangle draws as many candidates as its area holds at the *densest*, and each candidate keeps its own threshold, so that
/// a changed density map adds or removes strands and moves none. The order is shuffled: any prefix is a fair thinning. Triangles
/// with an index out of range or without area grow nothing.
pub fn strand_roots(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    densest: f32,
    seed: u64,
    density: impl Fn(&StrandRoot) -> f32,
) -> Vec<StrandRoot> {
    let area = |t: &[u32; 3]| -> Option<f32> {
        let [a, b, c] = t.map(|i| positions.get(i as usize).copied());
        let (a, b, c) = (a?, b?, c?);
        let area = 0.5 * (b - a).cross(c - a).length();
        area.is_finite().then_some(area)
    };
    let areas: Vec<f32> = triangles
        .iter()
        .map(|t| area(t).unwrap_or_default())
        .collect();
    let total: f64 = areas.iter().map(|a| f64::from(*a)).sum();
    let densest = f64::from(densest.max(0.0)).min(MOST_STRANDS as f64 / total.max(1e-30));
    let mut roots = Vec::new();
    for (triangle, area) in areas.iter().enumerate() {
        let mut stream = Stream::new(mix(seed, triangle as u64));
        let count = (f64::from(*area) * densest + f64::from(stream.uniform())).floor() as u64;
        if *area <= 0.0 {
            continue;
        }
        for k in 0..count {
            let key = mix(mix(seed, triangle as u64), k + 1);
            let mut own = Stream::new(key);
            // Uniform over the triangle.
            let (u, v) = (own.uniform().sqrt(), own.uniform());
            let root = StrandRoot {
                triangle: triangle as u32,
                barycentric: [1.0 - u, u * (1.0 - v), u * v],
                seed: (key >> 32) as u32,
            };
            if own.uniform() < density(&root) {
                roots.push(root);
            }
        }
    }
    roots.sort_by_key(|root| (root.seed, root.triangle));
    roots
}
