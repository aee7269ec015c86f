//! Outline P in the barb-rooted form: conversion from a polyline, noise-driven splits, the table for the GPU.

use super::{Contour, Feather, Gaps, Side};
use noise::{NoiseFn, Perlin};

/// Rows of [`ShapeTable::contour`].
pub const CONTOUR_ROWS: usize = 256;
/// Rows of [`ShapeTable::rachis`].
pub const RACHIS_ROWS: usize = 64;

/// Shape of one feather as the GPU reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeTable {
    /// [`RACHIS_ROWS`] rows at equal steps of v from 0 to 1: F_P, F_P' (per v), r_r in feather lengths, 0.
    pub rachis: Vec<[f32; 4]>,
    /// [`CONTOUR_ROWS`] rows for barbs rooted at equal steps from `start` to 1: left reach, right reach, left d reach / d root,
    /// right d reach / d root. Splits and clumps are in it.
    pub contour: Vec<[f32; 4]>,
    /// Height of the lowest barb.
    pub start: f32,
}

/// First crossing of the ray from `origin` along `direction` with a closed polygon, as a distance; 0 if it never leaves.
fn first_crossing(polygon: &[[f32; 2]], origin: [f64; 2], direction: [f64; 2]) -> f64 {
    let mut first = f64::INFINITY;
    for (i, from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let from = from.map(f64::from);
        let edge = [f64::from(to[0]) - from[0], f64::from(to[1]) - from[1]];
        let cross = direction[0] * edge[1] - direction[1] * edge[0];
        if cross.abs() < 1e-12 {
            continue;
        }
        let offset = [from[0] - origin[0], from[1] - origin[1]];
        let along = (offset[0] * edge[1] - offset[1] * edge[0]) / cross;
        let share = (offset[0] * direction[1] - offset[1] * direction[0]) / cross;
        if along > 1e-7 && (0.0..=1.0).contains(&share) {
            first = first.min(along);
        }
    }
    if first.is_finite() { first } else { 0.0 }
}

/// Is the point inside the polygon (even-odd rule)?
fn contains(polygon: &[[f32; 2]], point: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in polygon.iter().enumerate() {
        let (a, b) = (
            a.map(f64::from),
            polygon[(i + 1) % polygon.len()].map(f64::from),
        );
        if (a[1] > point[1]) != (b[1] > point[1]) {
            let x = a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            inside ^= point[0] < x;
        }
    }
    inside
}

impl Contour {
    /// Outline from a closed polyline in canonical space (rachis on x = 0, feather lengths): each barb reaches to where it
    /// first leaves the polygon. `barb_angles` (left, right) in degrees, `start` the root of the lowest barb, `samples` values
    /// per side (2..1024). Points that are not finite are left out.
    pub fn from_polyline(
        points: &[[f32; 2]],
        barb_angles: [f32; 2],
        start: f32,
        samples: usize,
    ) -> Self {
        let points: Vec<_> = points
            .iter()
            .copied()
            .filter(|point| point.iter().all(|x| x.is_finite()))
            .collect();
        let start = if start.is_finite() {
            start.clamp(0.0, 0.9)
        } else {
            0.0
        };
        let samples = samples.clamp(2, 1024);
        let reach = |side: Side, angle: f32| -> Vec<f32> {
            let angle = f64::from(angle).clamp(5.0, 85.0).to_radians();
            let direction = [f64::from(side.sign()) * angle.sin(), angle.cos()];
            (0..samples)
                .map(|i| {
                    let root = start + (1.0 - start) * i as f32 / (samples - 1) as f32;
                    // A hair off the shaft: a root on the outline's own corner is neither in nor out.
                    let origin = [direction[0] * 1e-6, f64::from(root) + direction[1] * 1e-6];
                    if !contains(&points, origin) {
                        return 0.0;
                    }
                    let distance = first_crossing(&points, origin, direction);
                    (distance * angle.sin()).min(2.0) as f32
                })
                .collect()
        };
        Self {
            start,
            left: reach(Side::Left, barb_angles[0]),
            right: reach(Side::Right, barb_angles[1]),
        }
    }

    /// The values of one side.
    pub fn side(&self, side: Side) -> &[f32] {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }

    /// Reach of the barb rooted at `root`, linear between samples; 0 below the vane.
    pub fn reach(&self, side: Side, root: f32) -> f32 {
        let values = self.side(side);
        if root.is_nan() || root < self.start || values.is_empty() {
            return 0.0;
        }
        let last = values.len() - 1;
        let place = crate::maths::card::contour_row(root, self.start, values.len() as f32);
        let i = (place as usize).min(last);
        let next = values[(i + 1).min(last)];
        values[i] + (next - values[i]) * (place - i as f32)
    }

    /// The same outline with `samples` values a side.
    pub fn resampled(&self, samples: usize) -> Self {
        let samples = samples.clamp(2, 1024);
        let root = |i: usize| self.start + (1.0 - self.start) * i as f32 / (samples - 1) as f32;
        let side = |side| (0..samples).map(|i| self.reach(side, root(i))).collect();
        Self {
            start: self.start,
            left: side(Side::Left),
            right: side(Side::Right),
        }
    }

    /// Outline with splits (Eq. 3-5). Both sides form one closed contour of N_v samples, up the left and down the right; a
    /// Perlin noise over it weighs the samples, the K highest peaks become the middles of splits, and each split pulls the
    /// barbs around it in by `depth` times a Gaussian of deviation `width`. In this form a point moves along its own barb, so
    /// Eq. 5 is `reach *= 1 - A eps`. Peaks, and not the K highest samples: those would all sit on one peak. The short barbs
    /// at the tip and the base are spared.
    pub fn perturbed(&self, gaps: &Gaps) -> Self {
        let mut result = self.clone();
        let (left, right) = (self.left.len(), self.right.len());
        let count = left + right;
        if gaps.count == 0 || left < 2 || right < 2 {
            return result;
        }
        let perlin = Perlin::new(gaps.seed);
        // Eight samples a lattice cell leave some 30 peaks at 512 samples.
        let weight: Vec<f64> = (0..count)
            .map(|i| perlin.get([i as f64 / 8.0 + 0.37, f64::from(gaps.seed % 1024) + 0.5]))
            .collect();
        let mut peaks: Vec<usize> = (0..count)
            .filter(|&i| {
                weight[i] > weight[(i + count - 1) % count] && weight[i] >= weight[(i + 1) % count]
            })
            .collect();
        peaks.sort_by(|&a, &b| weight[b].total_cmp(&weight[a]));
        peaks.truncate(gaps.count as usize);
        // sigma_k in samples: half the contour's samples span the vane's height.
        let sigma = (gaps.width / (1.0 - self.start).max(0.1) * count as f32 / 2.0).max(0.3);
        let depth = gaps.depth.clamp(0.0, 1.0);
        for peak in peaks {
            for i in 0..count {
                let distance = i.abs_diff(peak).min(count - i.abs_diff(peak)) as f32;
                let epsilon = (-distance * distance / (2.0 * sigma * sigma)).exp();
                // A split belongs to one vane: it does not jump over the tip or the base.
                if epsilon <= 1e-3 || (i < left) != (peak < left) {
                    continue;
                }
                let value = if i < left {
                    &mut result.left[i]
                } else {
                    &mut result.right[count - 1 - i]
                };
                *value *= 1.0 - depth * epsilon;
            }
        }
        result
    }

    /// Outline as a closed polyline in canonical space, from the base up the left side and down the right.
    pub fn polyline(&self, barb_angles: [f32; 2]) -> Vec<[f32; 2]> {
        let point = |side: Side, angle: f32, values: &[f32], i: usize| {
            let steps = values.len().saturating_sub(1).max(1) as f32;
            let root = self.start + (1.0 - self.start) * i as f32 / steps;
            let cot = 1.0 / angle.clamp(5.0, 85.0).to_radians().tan();
            [side.sign() * values[i], root + values[i] * cot]
        };
        let left = (0..self.left.len()).map(|i| point(Side::Left, barb_angles[0], &self.left, i));
        let right = (0..self.right.len())
            .rev()
            .map(|i| point(Side::Right, barb_angles[1], &self.right, i));
        let base = std::iter::once([0.0, self.start]);
        base.chain(left).chain(right).collect()
    }
}

impl Feather {
    /// Curve, radius and outline (with splits and clumps) as tables.
    pub fn shape_table(&self) -> ShapeTable {
        let spline = self.rachis.spline();
        let rachis = (0..RACHIS_ROWS)
            .map(|i| {
                let v = i as f64 / (RACHIS_ROWS - 1) as f64;
                let (curve, slope) = spline.at(v);
                [curve as f32, slope as f32, self.r_r(v as f32), 0.0]
            })
            .collect();
        let outline = self
            .contour
            .resampled(CONTOUR_ROWS)
            .clumped(&self.clumps)
            .perturbed(&self.gaps);
        let step = (1.0 - outline.start).max(1e-3) / (CONTOUR_ROWS - 1) as f32;
        let slope = |values: &[f32], i: usize| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(CONTOUR_ROWS - 1));
            (values[high] - values[low]) / ((high - low).max(1) as f32 * step)
        };
        let contour = (0..CONTOUR_ROWS)
            .map(|i| {
                let (left, right) = (&outline.left, &outline.right);
                [left[i], right[i], slope(left, i), slope(right, i)]
            })
            .collect();
        ShapeTable {
            rachis,
            contour,
            start: outline.start,
        }
    }
}
