//! A card before it becomes vertices: the record, its shaft, and what its cross-section needs.

use super::{asset::Tint, card::Card, drape::Shaft, skin::Weights};
use bevy::{
    color::{Hsva, LinearRgba, Srgba},
    math::Vec3,
};

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
