//! A card before it becomes vertices: the record, its shaft, and what its cross-section needs.

use super::{
    asset::Tint,
    card::Card,
    drape::Shaft,
    pose::blend,
    skin::{Weights, blend_weights},
};
use bevy::{
    color::{Hsva, LinearRgba, Srgba},
    math::{Affine3A, Vec3},
};

/// Lengths over that of bind pose, between which joints may draw a feather; where they are narrower, feathers leave the order of their
/// neighbors.
const LENGTHS: std::ops::RangeInclusive<f32> = 0.3..=2.5;
/// Steps from points that go with the skin below them to a feather that goes with its root.
const TIES: u8 = 16;

/// One feather of the groom.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// The record; its sphere is filled in when the mesh is built.
    pub card: Card,
    /// Shaft.
    pub shaft: Shaft,
    /// Joint weights at each point of the shaft, or one set for all.
    pub weights: Vec<Weights>,
    /// Sagitta over width.
    pub camber: f32,
    /// Columns across.
    pub columns: usize,
    /// Height of each vertex over the card's own shape in the first pose, along its normal, metres, row by row; empty: none.
    pub raised: Vec<f32>,
    /// For each further pose: how much higher each vertex is there, along the normal of the raised card.
    pub raised_further: Vec<Vec<f32>>,
    /// How far behind the nearest each vertex may lie and still be seen, widths of the card: in each pose, and last on the ways between.
    pub windows: Vec<Vec<f32>>,
    /// How far, 0..1, stiffer feathers over it hold it down in the first pose.
    pub held: f32,
}

impl Leaf {
    /// Joint weights at a point of the shaft.
    pub fn weights_at(&self, i: usize) -> Weights {
        let weights = self.weights.get(i).or(self.weights.last());
        weights.copied().unwrap_or_default()
    }

    /// Length of the shaft as joints carry it with these weights, over that of bind pose.
    fn drawn(&self, weights: &[Weights], skinning: &[Affine3A]) -> f32 {
        let points = self.shaft.points.iter().zip(weights);
        let carried: Vec<Vec3> = points
            .map(|(point, weights)| blend(weights, skinning).transform_point3(*point))
            .collect();
        let long = |points: &[Vec3]| -> f32 {
            let pairs = points.windows(2);
            pairs.map(|pair| pair[0].distance(pair[1])).sum()
        };
        long(&carried) / long(&self.shaft.points).max(f32::MIN_POSITIVE)
    }

    /// Weights of the shaft's points, each tied to the root by a share.
    fn tied(&self, share: f32) -> Vec<Weights> {
        let root = (self.card.joints, self.card.weights);
        let own = self.weights.iter();
        own.map(|own| blend_weights([(root, share), (*own, 1.0 - share)]))
            .collect()
    }

    /// The least share by which the shaft has to be tied to its root for its length to stay within [`LENGTHS`] in all poses, or the
    /// one that keeps it the best.
    pub fn needed_tie(&self, poses: &[Vec<Affine3A>]) -> f32 {
        if self.weights.len() < self.shaft.points.len() {
            return 0.0;
        }
        let mut best = (f32::INFINITY, 0.0);
        for step in 0..=TIES {
            let share = f32::from(step) / f32::from(TIES);
            let tied = self.tied(share);
            let off = poses.iter().map(|skinning| {
                let length = self.drawn(&tied, skinning);
                (length / LENGTHS.end()).max(LENGTHS.start() / length)
            });
            let off = off.fold(0.0, f32::max);
            if off < best.0 {
                best = (off, share);
            }
            if off <= 1.0 {
                break;
            }
        }
        best.1
    }

    /// Ties the points of the shaft to the joints of its root.
    pub fn tie(&mut self, share: f32) {
        if share > 0.0 {
            self.weights = self.tied(share);
        }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.shaft.points.len() * (self.columns + 1)
    }

    /// Place of a vertex: column `j` of those across at point `i` of the shaft.
    pub fn vertex(&self, i: usize, j: usize) -> Vec3 {
        let x = 2.0 * j as f32 / self.columns as f32 - 1.0;
        let raised = self.raised.get(i * (self.columns + 1) + j);
        self.place(i, x) + self.normal(i, x) * raised.copied().unwrap_or(0.0)
    }

    /// Places of all vertices, row by row.
    pub fn vertices(&self) -> Vec<Vec3> {
        let row = |i| (0..=self.columns).map(move |j| self.vertex(i, j));
        (0..self.shaft.points.len()).flat_map(row).collect()
    }

    /// Unit normals of the front face at all vertices, as the places around them have it.
    pub fn vertex_normals(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        let (rows, wide) = (self.shaft.points.len(), self.columns + 1);
        let at = |i: usize, j: usize| vertices[i * wide + j];
        let normal = |i: usize, j: usize| {
            let across = at(i, (j + 1).min(self.columns)) - at(i, j.saturating_sub(1));
            let down = at((i + 1).min(rows - 1), j) - at(i.saturating_sub(1), j);
            let normal = across.cross(down).try_normalize();
            normal.unwrap_or(self.shaft.normals[i])
        };
        let row = |i| (0..wide).map(move |j| (i, j));
        let all = (0..rows).flat_map(row);
        all.map(|(i, j)| normal(i, j)).collect()
    }

    /// Unit direction of the shaft at a point of it.
    pub fn along(&self, i: usize) -> Vec3 {
        let last = self.shaft.points.len() - 1;
        let span = self.shaft.points[(i + 1).min(last)] - self.shaft.points[i.saturating_sub(1)];
        span.try_normalize().unwrap_or(self.card.along)
    }

    /// How far the sides of the card lie below its middle, metres.
    fn fall(&self) -> f32 {
        let half = 0.5 * self.card.width;
        // With the feather's own camber, or with the skin below where that is rounder.
        (self.camber * self.card.width).max(0.5 * self.shaft.across * half * half)
    }

    /// Unit normal of the front face at a point of the shaft and `x` in -1..1 across.
    pub fn normal(&self, i: usize, x: f32) -> Vec3 {
        let normal = self.shaft.normals[i];
        let side = self.along(i).cross(normal);
        let slope = 4.0 * self.fall() * x / self.card.width.max(f32::MIN_POSITIVE);
        (normal + side * slope).normalize_or(normal)
    }

    /// Place of the card at a point of the shaft and `x` in -1..1 across (left to right seen from the front, tip up).
    pub fn place(&self, i: usize, x: f32) -> Vec3 {
        let normal = self.shaft.normals[i];
        let side = self.along(i).cross(normal);
        let half = 0.5 * self.card.width;
        let fall = self.fall();
        self.shaft.points[i] + side * (x * half) - normal * (fall * x * x)
    }
}

/// Color of a feather at phi, varied: linear RGB. `hue` in degrees, `value` relative.
pub fn vary(tint: Tint, phi: f32, hue: f32, value: f32) -> [f32; 3] {
    let mixed: [f32; 3] =
        std::array::from_fn(|i| tint.0[i] + (tint.1[i] - tint.0[i]) * phi.clamp(0.0, 1.0));
    let mut hsva = Hsva::from(Srgba::rgb(mixed[0], mixed[1], mixed[2]));
    hsva.hue = (hsva.hue + hue).rem_euclid(360.0);
    hsva.value = (hsva.value * (1.0 + value)).clamp(0.0, 1.0);
    let linear = LinearRgba::from(Srgba::from(hsva));
    [linear.red, linear.green, linear.blue].map(|x| if x.is_finite() { x } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shaft along x whose tip goes with the second joint.
    fn leaf() -> Leaf {
        let x = [0.0, 0.01, 0.02, 0.03];
        let card = Card {
            root: Vec3::ZERO,
            along: Vec3::X,
            normal: Vec3::Z,
            center: Vec3::ZERO,
            radius: 0.03,
            length: 0.03,
            width: 0.01,
            joints: [0; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            feather: 0,
            region: 0,
            layer: 0.0,
            tint: [0.5; 3],
            seed: 0,
            turn: 0.0,
            mirrored: false,
        };
        let weights = x.map(|x| ([0, 1, 0, 0], [1.0 - x / 0.03, x / 0.03, 0.0, 0.0]));
        Leaf {
            card,
            shaft: Shaft {
                points: x.map(|x| Vec3::X * x).to_vec(),
                normals: vec![Vec3::Z; 4],
                below: Vec::new(),
                heights: vec![0.0; 4],
                across: 0.0,
            },
            weights: weights.to_vec(),
            camber: 0.0,
            columns: 2,
            raised: Vec::new(),
            raised_further: Vec::new(),
            windows: Vec::new(),
            held: 0.0,
        }
    }

    #[test]
    fn joints_do_not_draw_a_feather_out_of_shape() {
        let moved = |x| vec![Affine3A::IDENTITY, Affine3A::from_translation(Vec3::X * x)];
        // Within bounds it goes with the skin.
        assert_eq!(leaf().needed_tie(&[moved(0.01)]), 0.0);
        // Five times as long, and next to nothing, if it did.
        for step in [0.12, -0.029] {
            let (mut tied, pose) = (leaf(), moved(step));
            let free = tied.drawn(&tied.weights, &pose);
            assert!(!LENGTHS.contains(&free), "{free}");
            let share = tied.needed_tie(std::slice::from_ref(&pose));
            tied.tie(share);
            let length = tied.drawn(&tied.weights, &pose);
            assert!(LENGTHS.contains(&length), "{share}: {length}");
            assert!(share > 0.0 && share < 1.0, "{share}");
        }
    }
}
