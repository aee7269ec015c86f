//! Where bent joints make the skin longer than in bind pose: more feathers grow there.

use super::skin::{SkinMesh, Weights};
use bevy::math::Vec3;

/// Most feathers over those of skin that does not stretch.
const MOST: f32 = 3.0;

/// Share of the weight that is on other joints at `b` than at `a`, and how far a place is from the nearest pivot of those joints, metres.
fn carried_apart(
    (a_joints, a_weights): &Weights,
    (b_joints, b_weights): &Weights,
    place: Vec3,
    pivots: &[Vec3],
) -> (f32, f32) {
    let weight = |joints: &[u16; 4], weights: &[f32; 4], joint: u16| {
        let own = joints.iter().zip(weights).filter(|(j, _)| **j == joint);
        own.map(|(_, weight)| weight).sum::<f32>()
    };
    let (mut apart, mut lever) = (0.0, f32::INFINITY);
    for (i, joint) in a_joints.iter().chain(b_joints).enumerate() {
        let all = if i < 4 { a_weights } else { b_weights };
        if all[i % 4] <= 0.0 || (i >= 4 && weight(a_joints, a_weights, *joint) > 0.0) {
            continue;
        }
        let change = weight(a_joints, a_weights, *joint) - weight(b_joints, b_weights, *joint);
        apart += 0.5 * change.abs();
        if change != 0.0
            && let Some(pivot) = pivots.get(usize::from(*joint))
        {
            lever = lever.min(place.distance(*pivot));
        }
    }
    (apart, lever)
}

impl SkinMesh {
    /// With more feathers where bent joints draw the skin apart: of an edge whose ends are carried by different joints, one end
    /// moves by `bend` (radians) times its distance from the joint. `pivots`: where each joint of the skin is, model space, metres.
    pub(super) fn with_stretch(mut self, pivots: &[Vec3], bend: f32) -> Self {
        if self.weights.is_empty() || pivots.is_empty() {
            return self;
        }
        let mut sums = vec![(0.0_f32, 0.0_f32); self.nodes.len()];
        for (triangle, area) in self.triangles.iter().zip(&self.areas) {
            let edge = |i: usize| {
                let [a, b] = [triangle[i] as usize, triangle[(i + 1) % 3] as usize];
                let (from, to) = (self.positions[a], self.positions[b]);
                let (apart, lever) = carried_apart(
                    &self.weights[a],
                    &self.weights[b],
                    from.midpoint(to),
                    pivots,
                );
                let longer = bend * apart * lever / from.distance(to);
                if longer.is_finite() {
                    1.0 + longer
                } else {
                    1.0
                }
            };
            let longest = [0, 1, 2].map(edge).into_iter().fold(1.0_f32, f32::max);
            for vertex in triangle {
                let sum = &mut sums[self.node_of[*vertex as usize] as usize];
                *sum = (sum.0 + area * longest, sum.1 + area);
            }
        }
        let own = |vertex: usize| self.masks.density.get(vertex).copied().unwrap_or(1.0);
        let density = (0..self.positions.len()).map(|vertex| {
            let (sum, area) = sums[self.node_of[vertex] as usize];
            let longer = if area > 0.0 { sum / area } else { 1.0 };
            own(vertex) * longer.min(MOST)
        });
        self.masks.density = density.collect();
        self
    }
}
