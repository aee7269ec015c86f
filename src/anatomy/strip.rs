//! How much of its card a feather needs: a strip that holds its outline.

use super::{CONTOUR_ROWS, Feather, ShapeTable, Side, outline::between};
use crate::maths::card::barb_cotangent;

/// Widths of the card that are left around the outline.
const MARGIN: f32 = 0.01;
/// Points of the lowest barb.
const LOWEST: usize = 8;
/// Times that all rows are moved a half of what is possible, before the last time.
const SWEEPS: usize = 4;

/// A line through points, so dense that every segment has at least two of it where it passes.
fn dense(line: &[[f32; 2]], segments: usize) -> impl Iterator<Item = [f32; 2]> {
    line.windows(2).flat_map(move |pair| {
        let [from, to] = [pair[0], pair[1]];
        let steps = ((to[1] - from[1]).abs() * 2.0 * segments as f32)
            .ceil()
            .max(1.0);
        (0..=steps as usize).map(move |i| {
            let share = i as f32 / steps;
            std::array::from_fn(|k| from[k] + (to[k] - from[k]) * share)
        })
    })
}

/// The most that an edge may be at each of `segments + 1` equal steps of height, so that lines between them stay below every point (place
/// of the edge, height); rows share what is left to them. At every height there is a point.
fn tight(points: &[[f32; 2]], segments: usize) -> Vec<f32> {
    let steps = segments as f32;
    // Segment and place in it.
    let places: Vec<(usize, f32, f32)> = points
        .iter()
        .map(|[u, v]| {
            let place = v.clamp(0.0, 1.0) * steps;
            let segment = (place as usize).min(segments - 1);
            (segment, place - segment as f32, u - MARGIN)
        })
        .collect();
    let mut edge = vec![f32::INFINITY; segments + 1];
    for (segment, _, u) in &places {
        for row in [*segment, segment + 1] {
            edge[row] = edge[row].min(*u);
        }
    }
    for sweep in 0..=SWEEPS {
        for row in 0..=segments {
            let mut most = 1.0_f32;
            for (segment, place, u) in &places {
                let (own, other) = match row.checked_sub(*segment) {
                    Some(0) => (1.0 - place, row + 1),
                    Some(1) => (*place, *segment),
                    _ => continue,
                };
                if own > 1.0e-3 {
                    most = most.min((u - (1.0 - own) * edge[other]) / own);
                }
            }
            let share = if sweep < SWEEPS { 0.5 } else { 1.0 };
            edge[row] += share * (most - edge[row]).max(0.0);
        }
    }
    edge.iter().map(|u| u.clamp(0.0, 1.0)).collect()
}

impl Feather {
    /// Points on the outline of one vane and of the shaft beside it, for a card of so many segments: u and v.
    fn outline_points(&self, table: &ShapeTable, side: Side, segments: usize) -> Vec<[f32; 2]> {
        let column = usize::from(side == Side::Right);
        let vane = self.query_vane::<f32>(side);
        let cotangent = barb_cotangent(vane.sin_b, vane.cos_b);
        // Water and wear draw barbs together and part them, never farther out than they reach alone.
        let root =
            |row: usize| table.start + (1.0 - table.start) * row as f32 / (CONTOUR_ROWS - 1) as f32;
        let reach = |row: usize| {
            let alone = self.contour.reach(side, root(row));
            table.contour[row][column].max(alone)
        };
        let last = table.rachis.len() - 1;
        let point = |x: f32, y: f32| {
            let v = y.clamp(0.0, 1.0);
            let curve = between(&table.rachis, v * last as f32, 0);
            [curve + side.sign() * x / self.aspect, v]
        };
        // Up to where the barb leaves the card.
        let end = |row: usize| {
            let [edge, _] = point(0.0, root(row));
            let across = if side == Side::Left { edge } else { 1.0 - edge };
            let above = (1.0 - root(row)) / cotangent.max(1.0e-3);
            reach(row).min(across.max(0.0) * self.aspect).min(above)
        };
        let barb = |row: usize, share: f32| {
            let x = share * end(row);
            point(x, root(row) + x * cotangent)
        };
        let lowest = (0..LOWEST).map(|i| barb(0, i as f32 / LOWEST as f32));
        let outline = (0..CONTOUR_ROWS).map(|row| barb(row, 1.0));
        let shaft = table.rachis.iter().enumerate();
        let shaft = shaft.map(|(row, rachis)| point(rachis[2], row as f32 / last as f32));
        let vane: Vec<[f32; 2]> = lowest.chain(outline).collect();
        let shaft: Vec<[f32; 2]> = shaft.collect();
        dense(&vane, segments)
            .chain(dense(&shaft, segments))
            .collect()
    }

    /// The strip of the card that holds the whole feather, whatever the weather: left and right edge (u) at the root, the tip and equal
    /// steps between, of which there are `segments` (1 at least).
    pub fn card_strip(&self, segments: usize) -> Vec<[f32; 2]> {
        let segments = segments.max(1);
        let table = self.shape_table();
        let left = tight(&self.outline_points(&table, Side::Left, segments), segments);
        let right = self.outline_points(&table, Side::Right, segments);
        let right: Vec<[f32; 2]> = right.iter().map(|[u, v]| [1.0 - u, *v]).collect();
        let right = tight(&right, segments);
        let pairs = left.iter().zip(&right);
        pairs.map(|(left, right)| [*left, 1.0 - right]).collect()
    }
}
