//! Staggered rows across the lay: follicles on lines of equal phi.

use super::{
    asset::Region,
    field::{Field, Follicle},
    skin::SurfacePoint,
};
use crate::maths::seed::Stream;
use bevy::math::Vec3;
use std::collections::HashMap;

/// One piece of a line of equal phi, inside one triangle.
#[derive(Clone, Copy)]
struct Piece {
    triangle: u32,
    ends: [(u64, Vec3); 2],
    length: f32,
}

/// Follicles on `rows` lines, `count` in all, shared out by the length of the lines over the width of a feather there. Every
/// second row is shifted by half a pitch. Empty if no line crosses the region.
pub fn rows(field: &Field, region: &Region, rows: usize, count: usize, seed: u64) -> Vec<Follicle> {
    let rows = rows.clamp(1, count.max(1));
    let (low, high) = field.phi_range();
    let level = |row: usize| low + (high - low) * (row as f32 + 0.5) / rows as f32;
    let lines: Vec<Vec<Piece>> = (0..rows).map(|row| line(field, level(row))).collect();
    let wishes: Vec<f64> = lines
        .iter()
        .enumerate()
        .map(|(row, line)| {
            let length: f64 = line.iter().map(|piece| f64::from(piece.length)).sum();
            length / f64::from(region.width.at(level(row)).max(f32::MIN_POSITIVE))
        })
        .collect();
    let mut stream = Stream::new(seed);
    let mut follicles = Vec::with_capacity(count);
    for (row, (line, share)) in lines.iter().zip(shares(&wishes, count)).enumerate() {
        let total: f32 = line.iter().map(|piece| piece.length).sum();
        let pitch = total / share.max(1) as f32;
        let stagger = if row % 2 == 0 { 0.25 } else { 0.75 };
        let (mut piece, mut start) = (0, 0.0);
        for i in 0..share {
            let noise = 0.08 * (2.0 * stream.uniform() - 1.0);
            let s = ((i as f32 + stagger + noise) * pitch).clamp(0.0, total);
            while piece + 1 < line.len() && s > start + line[piece].length {
                start += line[piece].length;
                piece += 1;
            }
            let t = if line[piece].length > 0.0 {
                ((s - start) / line[piece].length).clamp(0.0, 1.0)
            } else {
                0.5
            };
            let bary = line[piece].ends[0].1.lerp(line[piece].ends[1].1, t);
            follicles.push(field.follicle(SurfacePoint {
                triangle: line[piece].triangle,
                bary,
            }));
        }
    }
    follicles
}

/// Shares `count` out in proportion to the wishes, by largest remainders; all zero if nothing is wished for.
fn shares(wishes: &[f64], count: usize) -> Vec<usize> {
    let total: f64 = wishes.iter().sum();
    if total <= 0.0 || !total.is_finite() {
        return vec![0; wishes.len()];
    }
    let exact: Vec<f64> = wishes
        .iter()
        .map(|wish| wish / total * count as f64)
        .collect();
    let mut shares: Vec<usize> = exact.iter().map(|x| x.floor() as usize).collect();
    let mut order: Vec<usize> = (0..wishes.len()).filter(|&i| wishes[i] > 0.0).collect();
    order.sort_by(|&a, &b| {
        exact[b]
            .fract()
            .total_cmp(&exact[a].fract())
            .then(a.cmp(&b))
    });
    let missing = count.saturating_sub(shares.iter().sum());
    order
        .iter()
        .cycle()
        .take(missing)
        .for_each(|&i| shares[i] += 1);
    shares
}

/// The pieces of the line phi = `level`, chained end to end where they touch.
fn line(field: &Field, level: f32) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for &triangle in field.triangles {
        let nodes = field.skin.corner_nodes(triangle);
        let corners = [Vec3::X, Vec3::Y, Vec3::Z];
        let values = corners.map(|bary| field.phi(SurfacePoint { triangle, bary }) - level);
        let mut ends = Vec::with_capacity(2);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            // Half-open: a corner on the line counts as above it, so that a line crosses two sides or none.
            if (values[a] < 0.0) != (values[b] < 0.0) {
                let t = values[a] / (values[a] - values[b]);
                let (low, high) = (nodes[a].min(nodes[b]) as u64, nodes[a].max(nodes[b]) as u64);
                ends.push((
                    low << 32 | high,
                    corners[a].lerp(corners[b], t.clamp(0.0, 1.0)),
                ));
            }
        }
        if let [a, b] = ends[..] {
            let place = |bary| field.skin.position(SurfacePoint { triangle, bary });
            pieces.push(Piece {
                triangle,
                ends: [a, b],
                length: place(a.1).distance(place(b.1)),
            });
        }
    }
    chain(pieces)
}

fn chain(pieces: Vec<Piece>) -> Vec<Piece> {
    let mut by_side: HashMap<u64, Vec<usize>> = HashMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        piece
            .ends
            .iter()
            .for_each(|end| by_side.entry(end.0).or_default().push(i));
    }
    let mut used = vec![false; pieces.len()];
    let mut chained = Vec::with_capacity(pieces.len());
    // Open chains first, from their free ends; then closed ones.
    for closed in [false, true] {
        for first in 0..pieces.len() {
            let free = |end: usize| by_side[&pieces[first].ends[end].0].len() == 1;
            if used[first] || !(closed || free(0) || free(1)) {
                continue;
            }
            let (mut current, mut entry) = (first, usize::from(!closed && !free(0)));
            loop {
                used[current] = true;
                let mut piece = pieces[current];
                if entry == 1 {
                    piece.ends.swap(0, 1);
                }
                chained.push(piece);
                let side = piece.ends[1].0;
                let Some(&next) = by_side[&side].iter().find(|&&other| !used[other]) else {
                    break;
                };
                entry = usize::from(pieces[next].ends[0].0 != side);
                current = next;
            }
        }
    }
    chained
}
