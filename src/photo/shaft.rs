//! The shaft: a minimum-cost path through the score map, refined below a pixel and smoothed.

use super::{
    axis::{self, Axis, Cusp},
    raster::Plane,
    score::Score,
};
use bevy::math::Vec2;
use pathfinding::directed::dijkstra::dijkstra;

/// Rows of the view per row of the path.
const STEP: usize = 2;
/// Cost of the best and the worst pixel.
const COST: (f32, f32) = (4.0, 100.0);
/// Cost off the mask.
const OUTSIDE: u32 = 300;
/// Cost of moving one column more than the row before asked for.
const BEND: u32 = 14;
/// Cost of being as far again from the axis as costs nothing.
const STRAY: f32 = 8.0;
/// Cost of being where the barbs' change of direction is as wrong as can be, halved.
const SLOPES: f32 = 12.0;
/// Weight of the axis in the final curve, where no ridge leads it.
const ANCHOR: f32 = 0.015;

/// The shaft in an upright view, tip at the top.
pub(super) struct Shaft {
    /// Position x in each row of the view.
    pub x: Vec<f32>,
    /// First and last row of the feather.
    pub rows: (usize, usize),
    /// Share of the rows where it is plainly the shaft, see [`evident`].
    pub clear: f32,
    /// Sharpest turn within a tenth of its length, radians.
    pub kink: f32,
}

/// Score of a row relative to the best around it: a shaft that fades towards the tip is still the best of its row.
fn relative(score: &Plane) -> Plane {
    let best: Vec<f32> = score
        .data
        .chunks_exact(score.width)
        .map(|row| row.iter().copied().fold(0.0, f32::max))
        .collect();
    let best = Plane {
        width: 1,
        height: best.len(),
        data: best,
    };
    let around = best.blur((0.02 * score.height as f32).max(1.0));
    Plane::from_fn(score.width, score.height, |x, y| {
        let full = 0.75 * around.data[y] + 0.08;
        (score.data[y * score.width + x] / full).min(1.0)
    })
}

/// Least-squares curve through `target` with weights and a penalty on its second difference (Whittaker 1923): a pentadiagonal
/// system, solved by factors.
pub(super) fn smooth(target: &[f32], weight: &[f32], penalty: f64) -> Vec<f32> {
    let n = target.len();
    if n < 5 {
        return target.to_vec();
    }
    // Bands of W + lambda D'D: diagonal, first, second.
    let mut d: Vec<f64> = weight.iter().map(|&w| f64::from(w) + 1e-9).collect();
    let (mut e, mut f) = (vec![0.0; n], vec![0.0; n]);
    for i in 0..n - 2 {
        d[i] += penalty;
        d[i + 1] += 4.0 * penalty;
        d[i + 2] += penalty;
        e[i] -= 2.0 * penalty;
        e[i + 1] -= 2.0 * penalty;
        f[i] += penalty;
    }
    // LDL' with the two lower bands l1, l2.
    let (mut l1, mut l2, mut pivot) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for i in 0..n {
        let mut p = d[i];
        if i >= 1 {
            p -= l1[i - 1] * l1[i - 1] * pivot[i - 1];
        }
        if i >= 2 {
            p -= l2[i - 2] * l2[i - 2] * pivot[i - 2];
        }
        pivot[i] = p.max(1e-12);
        let carried = if i >= 1 {
            l1[i - 1] * l2[i - 1] * pivot[i - 1]
        } else {
            0.0
        };
        l1[i] = (e[i] - carried) / pivot[i];
        l2[i] = f[i] / pivot[i];
    }
    let mut z: Vec<f64> = (0..n)
        .map(|i| f64::from(target[i]) * f64::from(weight[i]))
        .collect();
    for i in 0..n {
        if i >= 1 {
            z[i] -= l1[i - 1] * z[i - 1];
        }
        if i >= 2 {
            z[i] -= l2[i - 2] * z[i - 2];
        }
    }
    for i in 0..n {
        z[i] /= pivot[i];
    }
    for i in (0..n).rev() {
        if i + 1 < n {
            z[i] -= l1[i] * z[i + 1];
        }
        if i + 2 < n {
            z[i] -= l2[i] * z[i + 2];
        }
    }
    z.into_iter().map(|z| z as f32).collect()
}

/// Rows and columns of a score map where the shaft may run, and what each pixel costs.
struct Costs<'a> {
    map: &'a Score,
    cusp: &'a Cusp,
    relative: &'a Plane,
    axis: &'a Axis,
    /// Rows of the view from top to bottom, every [`STEP`]-th.
    rows: Vec<usize>,
    /// Distance to the axis that costs nothing, in pixels.
    free: f32,
}

impl Costs<'_> {
    fn at(&self, row: usize, x: i32) -> Option<u32> {
        let y = self.rows[row];
        if x < 0 || x as usize >= self.relative.width {
            return None;
        }
        let i = y * self.relative.width + x as usize;
        let off = (x as f32 + 0.5 - self.axis.x[y]).abs() / self.free;
        let stray = (STRAY * (off - 1.0).max(0.0).powi(2)).min(2.0 * COST.1);
        if self.map.distance.data[i] <= 0.0 {
            return Some(OUTSIDE + stray as u32);
        }
        let rest = 1.0 - self.relative.data[i];
        let slopes = SLOPES * (1.0 - self.cusp.map.data[i].clamp(-1.0, 1.0));
        Some((COST.0 + (COST.1 - COST.0) * rest * rest + slopes + stray) as u32)
    }
}

/// Finds the shaft: along the axis from where that enters the mask to where it leaves it.
pub(super) fn shaft(map: &Score, cusp: &Cusp) -> Option<Shaft> {
    let score = &map.score;
    let axis = axis::axis(map, cusp)?;
    let (first, last) = axis.rows;
    let relative = relative(score);
    let costs = Costs {
        map,
        cusp,
        relative: &relative,
        axis: &axis,
        rows: (first..=last).step_by(STEP).collect(),
        free: 0.006 * (last - first) as f32 + 1.0,
    };
    let rows = &costs.rows;
    // Up from the quill row by row, so that the curve is a function of the height; a node is (row, column, last move).
    type Node = (i32, i32, i8);
    let top = rows.len() as i32 - 1;
    let start: Node = (top + 1, 0, 0);
    let successors = |&(row, x, slant): &Node| -> Vec<(Node, u32)> {
        if row > top {
            return (0..score.width as i32)
                .filter_map(|x| Some(((top, x, 0), costs.at(top as usize, x)?)))
                .collect();
        }
        (-2i8..=2)
            .filter_map(|slant_next| {
                let x = x + i32::from(slant_next);
                let bend = u32::from(slant_next.abs_diff(slant)) * BEND
                    + u32::from(slant_next.unsigned_abs()) * 4;
                let row = row - 1;
                Some(((row, x, slant_next), costs.at(row as usize, x)? + bend))
            })
            .collect()
    };
    let (path, _) = dijkstra(&start, successors, |&(row, _, _)| row == 0)?;
    let mut columns: Vec<f32> = vec![0.0; rows.len()];
    for (row, x, _) in path.into_iter().skip(1) {
        columns[row as usize] = x as f32 + 0.5;
    }
    let mut x: Vec<f32> = (first..=last)
        .map(|y| {
            let at = (y - first) as f32 / STEP as f32;
            let i = (at as usize).min(columns.len() - 1);
            let next = columns[(i + 1).min(columns.len() - 1)];
            columns[i] + (next - columns[i]) * (at - i as f32)
        })
        .collect();
    let length = (last - first) as f64;

    // Peaks of the score near the curve, below a pixel; alternately smoothed.
    let soft = score.blur(0.8);
    for round in 0..4 {
        let reach = [5, 4, 3, 2][round] as f32 * (length as f32 / 1100.0).max(0.6);
        let mut target = x.clone();
        let mut weight = vec![0.0; x.len()];
        for (i, y) in (first..=last).enumerate() {
            let value = |t: f32| {
                let off = t / reach.max(1.0);
                soft.sample(Vec2::new(x[i] + t, y as f32 + 0.5)) * (1.0 - 0.3 * off * off)
            };
            let steps = (2.0 * reach).ceil() as i32;
            let best = (-steps..=steps)
                .map(|k| k as f32 * 0.5)
                .max_by(|a, b| value(*a).total_cmp(&value(*b)))
                .unwrap_or(0.0);
            let (a, b, c) = (value(best - 0.5), value(best), value(best + 0.5));
            let bend = a - 2.0 * b + c;
            let part = if bend < -1e-6 {
                (0.25 * (a - c) / bend).clamp(-0.5, 0.5)
            } else {
                0.0
            };
            target[i] = x[i] + best + part;
            weight[i] = relative.sample(Vec2::new(target[i], y as f32 + 0.5)) * b.max(0.02);
        }
        // Stiffness: bends shorter than about a tenth of the feather are noise.
        let scale = (length / [14.0, 16.0, 18.0, 20.0][round] / std::f64::consts::TAU).powi(4);
        let mean = weight.iter().sum::<f32>() / weight.len() as f32;
        for (i, y) in (first..=last).enumerate() {
            let both = weight[i] + ANCHOR;
            target[i] = (target[i] * weight[i] + axis.x[y] * ANCHOR) / both;
            weight[i] = both;
        }
        x = smooth(&target, &weight, scale * f64::from(mean.max(0.01)));
    }
    let clear = evident(&soft, cusp, &x, first);
    let kink = kink(&x);
    Some(Shaft {
        x,
        rows: (first, last),
        clear,
        kink,
    })
}

/// Share of the rows in which the curve `x` is plainly the shaft: on a ridge that has no rival in its row, or where the barbs
/// change direction.
fn evident(score: &Plane, cusp: &Cusp, x: &[f32], first: usize) -> f32 {
    let near = 0.012 * x.len() as f32 + 2.0;
    let rows = x.iter().enumerate().filter(|&(i, &x)| {
        let y = first + i;
        let row = y * score.width..(y + 1) * score.width;
        let (mut own, mut rival) = (0.0f32, 0.0f32);
        for (column, &value) in score.data[row.clone()].iter().enumerate() {
            let off = (column as f32 + 0.5 - x).abs();
            if off < near {
                own = own.max(value);
            } else if off > 1.5 * near {
                rival = rival.max(value);
            }
        }
        let parted = cusp.map.sample(Vec2::new(x, y as f32 + 0.5));
        let most = cusp.map.data[row].iter().copied().fold(0.0, f32::max);
        (own > 0.06 && own > 1.25 * rival) || (parted > 0.2 && parted > 0.85 * most)
    });
    rows.count() as f32 / x.len().max(1) as f32
}

/// Largest turn of the curve within a tenth of its length, in radians.
fn kink(x: &[f32]) -> f32 {
    let reach = x.len() / 20;
    let slant = |a: usize, b: usize| ((x[b] - x[a]) / (b - a).max(1) as f32).atan();
    (reach..x.len().saturating_sub(reach))
        .map(|i| (slant(i, i + reach) - slant(i - reach, i)).abs())
        .fold(0.0, f32::max)
}

impl Shaft {
    /// Position in a row, held beyond the ends.
    pub fn at(&self, y: f32) -> f32 {
        let place = (y - self.rows.0 as f32 - 0.5).clamp(0.0, self.x.len() as f32 - 1.0);
        let i = place as usize;
        let next = self.x[(i + 1).min(self.x.len() - 1)];
        self.x[i] + (next - self.x[i]) * (place - i as f32)
    }
}
