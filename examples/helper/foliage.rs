//! What grows around a perch, as meshes with colors: twigs, leaves, tufts.

use super::noise::{Dice, fractal, noise};
use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use std::f32::consts::TAU;

/// Rings of a leaf along it and points across it.
const LEAF: [u32; 2] = [64, 25];
/// Sides of a twig.
const SIDES: u32 = 12;

/// Surfaces that share a material.
#[derive(Default)]
pub struct Growth {
    positions: Vec<[f32; 3]>,
    colors: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl Growth {
    /// A sheet of `rows` by `columns` points, each with its color (linear RGB).
    fn sheet(
        &mut self,
        [rows, columns]: [u32; 2],
        mut point: impl FnMut(f32, f32) -> (Vec3, Vec3),
    ) {
        let first = self.positions.len() as u32;
        for i in 0..rows {
            for j in 0..columns {
                let (position, color) = point(
                    i as f32 / (rows - 1) as f32,
                    j as f32 / (columns - 1) as f32,
                );
                self.positions.push(position.to_array());
                self.colors
                    .push(color.max(Vec3::ZERO).extend(1.0).to_array());
            }
        }
        for i in 0..rows - 1 {
            for j in 0..columns - 1 {
                let a = first + i * columns + j;
                self.indices
                    .extend([a, a + 1, a + columns, a + 1, a + columns + 1, a + columns]);
            }
        }
    }

    /// The mesh; none of nothing.
    pub fn mesh(self) -> Option<Mesh> {
        if self.positions.is_empty() {
            return None;
        }
        let mesh = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, self.colors)
        .with_inserted_indices(Indices::U32(self.indices))
        .with_computed_smooth_normals();
        Some(mesh)
    }

    /// A leaf from its stalk at the origin of `place` along its x, its upper side towards y; metres.
    pub fn leaf(&mut self, place: Transform, length: f32, green: Vec3, dice: &mut Dice) {
        let [wide, bend, fold] = [
            0.19 + 0.04 * dice.roll(),
            0.14 + 0.22 * dice.roll(),
            0.25 + 0.25 * dice.roll(),
        ];
        let shift = 100.0 * dice.roll();
        let old = dice.roll().powi(3);
        self.sheet(LEAF, |t, u| {
            let s = 2.0 * u - 1.0;
            let half = wide * 1.95 * (t + 0.02).powf(0.65) * (1.0 - t).powf(0.75);
            let vein = vein(t, s.abs() * half);
            let wave = 0.012 * noise(Vec3::new(5.0 * t, 3.0 * s, shift)) * s.abs();
            let rise = fold * half * s.abs() - bend * t * t + wave + 0.0035 * vein;
            let along = t - 0.25 * bend * t * t;
            let position = place.transform_point(length * Vec3::new(along, rise, half * s));
            let patch = fractal(Vec3::new(6.0 * t, 9.0 * s * half, shift), 3);
            let mut color = green * (1.0 + 0.35 * patch);
            color = color.lerp(color * Vec3::new(1.9, 1.35, 1.2), 0.75 * vein);
            let dry = ((patch + 0.25 * old - 0.28 + 0.15 * t) / 0.06).clamp(0.0, 1.0) * old;
            (position, color.lerp(Vec3::new(0.16, 0.095, 0.035), dry))
        });
    }

    /// A twig through `joints`, thinner towards its end; metres.
    pub fn twig(&mut self, joints: &[Vec3], radius: f32, color: Vec3) {
        let rings = 24 * joints.len() as u32;
        self.sheet([rings, SIDES + 1], |t, u| {
            let centre = along(joints, t);
            let ahead = along(joints, (t + 0.01).min(1.0)) - along(joints, (t - 0.01).max(0.0));
            let ahead = ahead.normalize_or(Vec3::X);
            let side = ahead.any_orthonormal_vector();
            let up = ahead.cross(side);
            let turn = Vec2::from_angle(TAU * u);
            let around = side * turn.x + up * turn.y;
            let rough = fractal(centre * 260.0 + around * 2.0, 3);
            // Buds leave rings behind.
            let node = (-((12.0 * t).fract() - 0.5).powi(2) * 90.0).exp();
            let thin = (1.0 - 0.72 * t) * (1.0 + 0.16 * rough + 0.22 * node);
            (
                centre + around * radius * thin,
                color * (1.0 + 0.5 * rough) * (1.0 - 0.25 * node),
            )
        });
    }

    /// Thin blades out of one spot; metres.
    pub fn tuft(
        &mut self,
        foot: Vec3,
        [count, spread]: [f32; 2],
        [length, width]: [f32; 2],
        [low, tip]: [Vec3; 2],
        dice: &mut Dice,
    ) {
        for _ in 0..count as u32 {
            let turn = Vec2::from_angle(TAU * dice.roll());
            let out = Vec3::new(turn.x, 0.0, turn.y);
            let lean = spread * dice.roll().sqrt();
            let reach = length * (0.5 + 0.5 * dice.roll());
            let (droop, from) = (0.2 + 0.6 * dice.roll(), 0.12 * length * lean);
            let side = out.cross(Vec3::Y).lerp(out, 0.8 * dice.roll());
            let tone = 0.7 + 0.6 * dice.roll();
            self.sheet([9, 2], |t, u| {
                let way = out * (lean * t + droop * lean * t * t)
                    + Vec3::Y * (t - 0.5 * droop * lean * t * t);
                let half = width * (1.0 - t * t) * (2.0 * u - 1.0);
                let position = foot + out * from + way * reach + side * half;
                (position, low.lerp(tip, t) * tone)
            });
        }
    }
}

/// How much of a vein lies at a place of a leaf, 0..1: the rib, and side veins that leave it forwards. `off`: from the rib, in lengths of
/// the leaf.
fn vein(t: f32, off: f32) -> f32 {
    let rib = (-(off / (0.012 * (1.2 - t))).powi(2)).exp();
    let phase = 10.0 * (t - 0.75 * off + 1.6 * off * off);
    let near = (phase - phase.round()).abs() / 10.0;
    let side = (-(near / 0.0055).powi(2)).exp() * (1.0 - 2.0 * off).max(0.0);
    rib.max(0.6 * side)
}

/// A smooth curve through points, at a share of its length.
fn along(points: &[Vec3], t: f32) -> Vec3 {
    let last = points.len() - 1;
    let at = t * last as f32;
    let i = (at as usize).min(last.saturating_sub(1));
    let point = |k: usize| points[k.min(last)];
    let [a, b, c, d] = [
        point(i.saturating_sub(1)),
        point(i),
        point(i + 1),
        point(i + 2),
    ];
    let f = at - i as f32;
    0.5 * (2.0 * b
        + (c - a) * f
        + (2.0 * a - 5.0 * b + 4.0 * c - d) * f * f
        + (3.0 * b - a - 3.0 * c + d) * f * f * f)
}
