//! Where the shaft must run, roughly: the best stiff curve through an upright view.

use super::{color::Lab, raster::Plane, raster::median, score::Score};
use bevy::math::Vec2;

/// Stretches of the curve from end to end.
const KNOTS: usize = 12;
/// Places across at which a knot may lie.
const COLUMNS: usize = 60;
/// Rows of the view that are looked at per stretch.
const SAMPLES: usize = 14;
/// What a whole turn by one radian, spread over the length, costs against a perfect ridge along all of it.
const BEND: f32 = 0.09;
/// Cost of leaving the mask, in the same unit.
const OUTSIDE: f32 = 0.35;
/// Weight of the barbs' change of direction against the ridge.
const CUSP: f32 = 0.5;
/// Gradient of lightness per pixel that noise reaches.
const NOISE: f32 = 0.004;

/// Where barbs and bars, which slope one way on the left vane and the other way on the right, change direction.
pub(super) struct Cusp {
    /// How well a vertical cut through each pixel parts the two directions in its row, -1..1; 0 where nothing slopes.
    pub map: Plane,
}

/// Parts the slopes of an upright view. `distance` is that to the outline, `main` the feather's direction in each row.
pub(super) fn cusp(lab: &Lab, distance: &Plane, main: &[Vec2]) -> Cusp {
    let light = lab.planes[0].blur(0.8);
    let (width, height) = (light.width, light.height);
    let mut slope = Plane::new(width, height, 0.0);
    let mut weight = Plane::new(width, height, 0.0);
    for (y, main) in main.iter().enumerate().take(height) {
        for x in 0..width {
            let i = y * width + x;
            // The outline's own gradient says nothing about barbs.
            if distance.data[i] <= 3.5 {
                continue;
            }
            let g = light.gradient(x, y);
            let size = g.length();
            slope.data[i] = 2.0 * g.dot(main.perp()) * g.dot(*main) / (size + NOISE);
            weight.data[i] = size * size / (size + NOISE) + 0.5 * NOISE;
        }
    }
    let sigma = (0.015 * height as f32).max(2.0);
    let (slope, weight) = (slope.blur_down(sigma), weight.blur_down(sigma));
    let mut map = Plane::new(width, height, 0.0);
    let mut best = [0.0f32; 2];
    for y in 0..height {
        let row = y * width..(y + 1) * width;
        let total: f32 = slope.data[row.clone()].iter().sum();
        let all: f32 = weight.data[row.clone()].iter().sum();
        if all < 1e-6 {
            continue;
        }
        let mut left = 0.0;
        let (mut low, mut high) = (0.0f32, 0.0f32);
        for i in row {
            left += 0.5 * slope.data[i];
            let value = (2.0 * left - total) / all;
            left += 0.5 * slope.data[i];
            (low, high) = (low.min(value), high.max(value));
            map.data[i] = value;
        }
        best = [best[0] - low, best[1] + high];
    }
    let sign = if best[0] > best[1] { -1.0 } else { 1.0 };
    Cusp {
        map: map.map(|value| value * sign),
    }
}

/// The stiff curve: x in each row of the view, and the rows in which it lies on the feather.
pub(super) struct Axis {
    pub x: Vec<f32>,
    pub rows: (usize, usize),
}

/// Ridge and slopes averaged over the cells between the knots' columns and the rows looked at; outside the mask negative.
struct Cells {
    first: f32,
    /// Rows of the view per sample.
    step: f32,
    low: f32,
    /// Columns of the view per place of a knot.
    pitch: f32,
    value: Vec<[f32; COLUMNS]>,
}

impl Cells {
    fn new(map: &Score, cusp: &Cusp, rows: (usize, usize)) -> Self {
        let score = &map.score;
        let (first, last) = rows;
        let span = map.span[first..=last].iter().flatten();
        let (low, high) = span.fold((f32::MAX, 0.0f32), |(a, b), s| (a.min(s.0), b.max(s.1)));
        let pitch = (high - low).max(1.0) / COLUMNS as f32;
        let step = (last - first) as f32 / (KNOTS * SAMPLES) as f32;
        let mut best: Vec<f32> = score
            .data
            .chunks_exact(score.width)
            .map(|row| row.iter().copied().fold(0.0, f32::max))
            .collect();
        let typical = median(&mut best[first..=last].to_vec());
        let around = Plane {
            width: 1,
            height: best.len(),
            data: std::mem::take(&mut best),
        }
        .blur((0.02 * score.height as f32).max(1.0));
        let value = (0..=KNOTS * SAMPLES)
            .map(|k| {
                let y = ((first as f32 + k as f32 * step) as usize).min(last);
                let full = 0.4 * around.data[y] + 0.35 * typical + 0.08;
                std::array::from_fn(|c| {
                    let x = low + (c as f32 + 0.5) * pitch;
                    // Ridges are thinner than a cell: the best of it counts.
                    let from = (x - 0.7 * pitch).max(0.0) as usize;
                    let to = ((x + 0.7 * pitch).ceil() as usize).min(score.width - 1);
                    let rows = y.saturating_sub((0.5 * step) as usize)
                        ..=(y + (0.5 * step) as usize).min(last);
                    let count = rows.clone().count() as f32;
                    let ridge: f32 = rows
                        .map(|y| {
                            let row = &score.data[y * score.width + from..=y * score.width + to];
                            (row.iter().copied().fold(0.0, f32::max) / full).min(1.0)
                        })
                        .sum::<f32>()
                        / count;
                    let i = y * score.width + (x as usize).min(score.width - 1);
                    if map.distance.data[i] <= 0.0 {
                        ridge - OUTSIDE
                    } else {
                        ridge + CUSP * cusp.map.data[i]
                    }
                })
            })
            .collect();
        Self {
            first: first as f32,
            step,
            low,
            pitch,
            value,
        }
    }

    /// Mean along a stretch from one knot to the next.
    fn stretch(&self, knot: usize, from: usize, to: usize) -> f32 {
        let (from, to) = (from as f32, to as f32);
        let sum: f32 = (0..SAMPLES)
            .map(|k| {
                let t = (k as f32 + 0.5) / SAMPLES as f32;
                let x = (from + (to - from) * t).clamp(0.0, COLUMNS as f32 - 1.0);
                let (i, s) = (x as usize, x.fract());
                let row = &self.value[knot * SAMPLES + k];
                row[i] * (1.0 - s) + row[(i + 1).min(COLUMNS - 1)] * s
            })
            .sum();
        sum / SAMPLES as f32
    }

    /// Directions of a stretch that crosses 1 - [`COLUMNS`].. [`COLUMNS`] - 1 places, radians from upright.
    fn slants(&self) -> Vec<f32> {
        let rise = self.step * SAMPLES as f32;
        (0..2 * COLUMNS)
            .map(|d| ((d as f32 - COLUMNS as f32) * self.pitch / rise).atan())
            .collect()
    }
}

/// The curve of least cost over all that have [`KNOTS`] stretches: ridge and slopes along it against its bending, found by
/// dynamic programming over pairs of neighboring knots (Amini et al. 1990). It may leave the mask at either end, where
/// the outline ends askew.
pub(super) fn axis(map: &Score, cusp: &Cusp) -> Option<Axis> {
    let first = map.span.iter().position(Option::is_some)?;
    let last = map.span.iter().rposition(Option::is_some)?;
    if last < first + 2 * KNOTS {
        return None;
    }
    let cells = Cells::new(map, cusp, (first, last));
    let bend = BEND * (KNOTS * KNOTS) as f32;
    let slants = cells.slants();
    let gain = |knot: usize, from: usize, to: usize| cells.stretch(knot, from, to);
    // Best total of curves that end in (column before, column).
    let mut total: Vec<f32> = (0..COLUMNS * COLUMNS)
        .map(|i| gain(0, i / COLUMNS, i % COLUMNS))
        .collect();
    let mut before: Vec<Vec<u8>> = Vec::new();
    for knot in 1..KNOTS {
        let mut next = vec![f32::MIN; COLUMNS * COLUMNS];
        let mut from = vec![0u8; COLUMNS * COLUMNS];
        for b in 0..COLUMNS {
            for c in 0..COLUMNS {
                let here = gain(knot, b, c);
                let slant = slants[COLUMNS + c - b];
                for a in 0..COLUMNS {
                    let turn = slant - slants[COLUMNS + b - a];
                    let value = total[a * COLUMNS + b] + here - bend * turn * turn;
                    if value > next[b * COLUMNS + c] {
                        next[b * COLUMNS + c] = value;
                        from[b * COLUMNS + c] = a as u8;
                    }
                }
            }
        }
        total = next;
        before.push(from);
    }
    let end = (0..total.len()).max_by(|&a, &b| total[a].total_cmp(&total[b]))?;
    let mut columns = vec![end % COLUMNS, end / COLUMNS];
    for from in before.iter().rev() {
        let (b, c) = (columns[columns.len() - 1], columns[columns.len() - 2]);
        columns.push(usize::from(from[b * COLUMNS + c]));
    }
    columns.reverse();
    let knots: Vec<f32> = columns
        .iter()
        .map(|&c| cells.low + (c as f32 + 0.5) * cells.pitch)
        .collect();
    let line: Vec<f32> = (0..map.score.height)
        .map(|y| {
            let at = (y as f32 - cells.first) / (cells.step * SAMPLES as f32);
            let at = at.clamp(0.0, KNOTS as f32);
            let i = (at as usize).min(KNOTS - 1);
            knots[i] + (knots[i + 1] - knots[i]) * (at - i as f32)
        })
        .collect();
    let line = Plane {
        width: 1,
        height: line.len(),
        data: line,
    };
    let x = line
        .blur((0.4 * (last - first) as f32 / KNOTS as f32).max(1.0))
        .data;
    let on = |y: usize| {
        let i = (x[y].max(0.0) as usize).min(map.score.width - 1);
        map.distance.data[y * map.score.width + i] > 0.0
    };
    let top = (first..=last).find(|&y| on(y))?;
    let bottom = (first..=last).rev().find(|&y| on(y))?;
    // Hardly on the feather at all: no axis.
    (bottom > top + (last - first) / 2).then_some(Axis {
        x,
        rows: (top, bottom),
    })
}
