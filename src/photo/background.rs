//! What the background would look like under the feather.

use super::{
    color::{hsv_cone, srgb},
    raster::quantile,
};
use bevy::math::{Vec2, Vec3};

/// Largest distance to the background that still counts; beyond it all is equally feather.
pub(super) const FAR: f32 = 0.6;

/// Color weighs more than lightness: a background's shading and grain are mostly light.
const CHROMA_WEIGHT: f32 = 2.5;
/// Terms of a quadratic in two variables.
const TERMS: usize = 6;

/// A background with smooth shading: each channel of Oklab a quadratic over the picture, fitted robustly.
#[derive(Clone, Debug)]
pub(super) struct Background {
    terms: [[f64; TERMS]; 3],
    /// Half of the ring's distances to the fit lie below.
    pub typical: f32,
    /// Nearly all (0.97) do.
    pub most: f32,
    /// As [`Self::most`] for the smooth fit alone, where the ground was then found rough.
    pub noise: f32,
    /// The same for [`hsv_distance`].
    pub most_hsv: f32,
    /// Color of lines that run from one side of the frame to the other (a grid, the joint of two planks).
    pub line: Option<[f32; 3]>,
    /// Rough ground: one material from its own shadow to its brightest; factors on the color fitted.
    pub light: Option<[f32; 2]>,
}

fn basis(p: Vec2) -> [f64; TERMS] {
    let (x, y) = (f64::from(p.x), f64::from(p.y));
    [1.0, x, y, x * x, x * y, y * y]
}

/// Solves `m x = r` by elimination with pivots; `m` is made regular by its caller.
fn solve<const N: usize>(mut m: [[f64; N]; N], mut r: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let pivot = (i..N).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()));
        let pivot = pivot.unwrap_or(i);
        m.swap(i, pivot);
        r.swap(i, pivot);
        if m[i][i].abs() < 1e-12 {
            continue;
        }
        let upper = m[i];
        for j in i + 1..N {
            let factor = m[j][i] / upper[i];
            for (value, above) in m[j].iter_mut().zip(upper).skip(i) {
                *value -= factor * above;
            }
            r[j] -= factor * r[i];
        }
    }
    let mut x = [0.0; N];
    for i in (0..N).rev() {
        let rest: f64 = (i + 1..N).map(|k| m[i][k] * x[k]).sum();
        x[i] = if m[i][i].abs() < 1e-12 {
            0.0
        } else {
            (r[i] - rest) / m[i][i]
        };
    }
    x
}

/// Oklab's cube root stretches the noise of near black; a toe takes that back.
fn toe(lab: [f32; 3]) -> [f32; 3] {
    const KNEE: f32 = 0.35;
    let [light, a, b] = lab;
    if light >= KNEE {
        return lab;
    }
    let share = (light / KNEE).max(0.0);
    [KNEE * 0.5 * (share * share + 1.0), a * share, b * share]
}

/// Difference of two colors of Oklab, color weighed over lightness, near black damped.
pub(super) fn difference(a: [f32; 3], b: [f32; 3]) -> Vec3 {
    let (a, b) = (toe(a), toe(b));
    Vec3::from_array([0, 1, 2].map(|c| a[c] - b[c])) * Vec3::new(1.0, CHROMA_WEIGHT, CHROMA_WEIGHT)
}

/// Length of the [`difference`].
pub(super) fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    difference(a, b).length()
}

/// Distance of two colors of Oklab in HSV's cone.
pub(super) fn hsv_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (a, b) = (hsv_cone(srgb(a)), hsv_cone(srgb(b)));
    (a[0] - b[0]).hypot((a[1] - b[1]).hypot(a[2] - b[2]) * 1.5)
}

/// How many times as light a color is as another (in Oklab, whose values scale by the cube root of the light).
fn light(color: [f32; 3], behind: [f32; 3]) -> f32 {
    let weights = [1.0, CHROMA_WEIGHT.powi(2), CHROMA_WEIGHT.powi(2)];
    let dot = |a: [f32; 3], b: [f32; 3]| (0..3).map(|c| weights[c] * a[c] * b[c]).sum::<f32>();
    dot(color, behind) / dot(behind, behind).max(1e-4)
}

impl Background {
    /// Fits samples (place -1..1 over the photograph, color) by reweighted least squares: what lies far from the fit, as a
    /// feather that reaches the frame, loses its vote. `start` is a fit to begin with.
    pub fn fit(samples: &[(Vec2, [f32; 3])], start: Option<&Self>) -> Self {
        let mut fit = start.cloned().unwrap_or_else(|| {
            let middle = [0, 1, 2].map(|c| {
                let mut values: Vec<f32> = samples.iter().map(|s| s.1[c]).collect();
                f64::from(super::raster::median(&mut values))
            });
            Self {
                terms: middle.map(|m| [m, 0.0, 0.0, 0.0, 0.0, 0.0]),
                typical: 0.0,
                most: 0.0,
                noise: 0.0,
                most_hsv: 0.0,
                line: None,
                light: None,
            }
        });
        for _ in 0..8 {
            let mut distances: Vec<f32> =
                samples.iter().map(|s| distance(s.1, fit.at(s.0))).collect();
            let raw = distances.clone();
            let scale = quantile(&mut distances, 0.5).max(0.006) * 2.5;
            let mut matrix = [[0.0; TERMS]; TERMS];
            let mut right = [[0.0; TERMS]; 3];
            for ((place, color), d) in samples.iter().zip(&raw) {
                let t = f64::from(d / scale);
                if t >= 1.0 {
                    continue;
                }
                let weight = (1.0 - t * t).powi(2);
                let b = basis(*place);
                for i in 0..TERMS {
                    for j in 0..TERMS {
                        matrix[i][j] += weight * b[i] * b[j];
                    }
                    for c in 0..3 {
                        right[c][i] += weight * b[i] * f64::from(color[c]);
                    }
                }
            }
            // A ridge on all but the constant: corners without samples must not run away.
            let ridge = 1e-3 * matrix[0][0] + 1e-9;
            for (i, row) in matrix.iter_mut().enumerate().skip(1) {
                row[i] += ridge;
            }
            if matrix[0][0] < 6.0 {
                break;
            }
            fit.terms = right.map(|r| solve(matrix, r));
        }
        let mut distances: Vec<f32> = samples.iter().map(|s| distance(s.1, fit.at(s.0))).collect();
        fit.typical = quantile(&mut distances, 0.5);
        // Part of the samples may be feather after all: the noise is read off the nearer half (2.6 medians are the 0.99
        // quantile of a Rayleigh distribution).
        fit.most = (2.6 * fit.typical).min(quantile(&mut distances, 0.97));
        fit.noise = fit.most;
        let mut cone: Vec<f32> = samples
            .iter()
            .step_by((samples.len() / 2000).max(1))
            .map(|s| hsv_distance(s.1, fit.at(s.0)))
            .collect();
        fit.most_hsv = (2.6 * quantile(&mut cone, 0.5)).min(quantile(&mut cone, 0.97));
        fit
    }

    /// Takes a rough ground for one material in any light from its own shadow to its brightest: what was noise is no more.
    pub fn roughen(&mut self, samples: &[(Vec2, [f32; 3])]) {
        let mut lights: Vec<f32> = samples
            .iter()
            .map(|(place, color)| light(*color, self.at(*place)))
            .collect();
        self.light = Some([quantile(&mut lights, 0.01), quantile(&mut lights, 0.99)]);
        let off = |hsv: bool| {
            let mut values: Vec<f32> = samples
                .iter()
                .map(|(place, color)| {
                    let behind = self.behind(*place, *color);
                    if hsv {
                        hsv_distance(*color, behind)
                    } else {
                        distance(*color, behind)
                    }
                })
                .collect();
            [quantile(&mut values, 0.5), quantile(&mut values, 0.97)]
        };
        let ([typical, most], [_, most_hsv]) = (off(false), off(true));
        (self.typical, self.most, self.most_hsv) = (typical, most, most_hsv);
    }

    /// Color of the background that comes nearest to a color at a place.
    pub fn behind(&self, place: Vec2, color: [f32; 3]) -> [f32; 3] {
        let behind = self.at(place);
        self.light.map_or(behind, |[low, high]| {
            let light = light(color, behind).clamp(low, high);
            behind.map(|value| value * light)
        })
    }

    /// Looks for lines: colors off the background that opposite sides of the frame have in common. `ring` are samples
    /// along the frame.
    pub fn find_lines(&mut self, ring: &[(Vec2, [f32; 3])]) {
        let limit = (1.5 * self.most).max(0.06);
        // What lies off the background on each side, and how much of the side that is.
        let sides = [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].map(|side| {
            let on = ring
                .iter()
                .filter(|(place, _)| place.dot(side) >= place.abs().max_element());
            let count = on.clone().count();
            let off: Vec<[f32; 3]> = on
                .filter(|(place, color)| distance(*color, self.at(*place)) > limit)
                .map(|(_, color)| *color)
                .collect();
            (off, count)
        });
        let color = |(off, count): &(Vec<[f32; 3]>, usize)| {
            let share = off.len() as f32 / (*count).max(1) as f32;
            (0.01..0.4).contains(&share).then(|| {
                [0, 1, 2].map(|c| {
                    let mut values: Vec<f32> = off.iter().map(|color| color[c]).collect();
                    super::raster::median(&mut values)
                })
            })
        };
        // A side that the feather reaches too still has the line's color.
        let has = |(off, count): &(Vec<[f32; 3]>, usize), line: [f32; 3]| {
            let near = off.iter().filter(|&&o| distance(o, line) < 0.1).count();
            near * 50 > *count
        };
        let pair = |a: usize, b: usize| {
            let colors = [color(&sides[a]), color(&sides[b])];
            if let [Some(a), Some(b)] = colors
                && distance(a, b) < 0.15
            {
                return Some([0, 1, 2].map(|c| 0.5 * (a[c] + b[c])));
            }
            let [first, second] = colors;
            first
                .filter(|&line| has(&sides[b], line))
                .or_else(|| second.filter(|&line| has(&sides[a], line)))
        };
        self.line = pair(0, 1).or_else(|| pair(2, 3));
    }

    /// Distance of a color to the background `behind` it and to what lies between that and the color of lines.
    pub fn distance(&self, color: [f32; 3], behind: [f32; 3]) -> f32 {
        let plain = distance(color, behind);
        let Some(line) = self.line else {
            return plain;
        };
        // Median and peak of a thin line differ: the stretch goes on a bit.
        let edge = [0, 1, 2].map(|c| (line[c] - behind[c]) * 1.4);
        let from = [0, 1, 2].map(|c| color[c] - behind[c]);
        let square: f32 = edge.iter().map(|e| e * e).sum();
        let dot: f32 = edge.iter().zip(from).map(|(e, f)| e * f).sum();
        let t = (dot / square.max(1e-6)).clamp(0.0, 1.0);
        plain.min(distance(color, [0, 1, 2].map(|c| behind[c] + edge[c] * t)))
    }

    /// Color at a place, -1..1 over the photograph.
    pub fn at(&self, place: Vec2) -> [f32; 3] {
        let b = basis(place);
        self.terms
            .map(|terms| terms.iter().zip(b).map(|(t, b)| t * b).sum::<f64>() as f32)
    }
}

/// Could this pixel be background in shadow? Darker (to a third of the light) and else of the same color.
pub(super) fn shadow_color(color: [f32; 3], background: [f32; 3]) -> bool {
    let ratio = color[0] / background[0].max(0.05);
    // Oklab scales by the cube root of the light.
    if !(0.69..0.985).contains(&ratio) {
        return false;
    }
    let (da, db) = (
        color[1] - background[1] * ratio,
        color[2] - background[2] * ratio,
    );
    da.hypot(db) < 0.014
}
