//! Which feather lies over which: one number per feather, consistent with the lay wherever two of them meet.
//!
//! A feather grows out of the skin in front of those that it covers: of two neighbours the one rooted further up the lay is the
//! upper, whatever tract either belongs to. Neither the phi of a tract nor the order of tracts says so everywhere (phi may run
//! across the lay, and tracts meet in more than one direction), so the feathers' own roots are asked.

use super::{grid::PointGrid, leaf::Leaf};
use bevy::math::Vec3;

/// Pairs further apart than this, in lengths along the lay, do not meet.
const ALONG: f32 = 0.9;
/// The same across the lay, in mean widths.
const ACROSS: f32 = 0.9;
/// Lead, in lengths, that the tract with the higher layer key has over its neighbours.
const KEY_LEAD: f32 = 0.12;
/// Most neighbours that one feather is compared with.
const NEIGHBOURS: usize = 64;
/// Steps of the solver.
const STEPS: usize = 120;

/// One pair: how far the first is rooted up the lay from the second, metres.
struct Edge {
    first: u32,
    second: u32,
    lead: f32,
}

/// Replaces the layers of the leaves (their tract's key and phi) by their order along the lay, metres: the function whose
/// differences over all pairs of neighbours come closest to the distances of the roots along the feathers (least squares, by
/// conjugate gradients). Where two tracts grow side by side the key decides.
pub fn order(leaves: &mut [Leaf]) {
    let edges = edges(leaves);
    let count = leaves.len();
    let mut degree = vec![0.0_f32; count];
    let mut residual = vec![0.0_f32; count];
    for edge in &edges {
        let (a, b) = (edge.first as usize, edge.second as usize);
        degree[a] += 1.0;
        degree[b] += 1.0;
        residual[a] += edge.lead;
        residual[b] -= edge.lead;
    }
    let apply = |x: &[f32]| {
        let mut y = vec![0.0_f32; count];
        for edge in &edges {
            let (a, b) = (edge.first as usize, edge.second as usize);
            let difference = x[a] - x[b];
            y[a] += difference;
            y[b] -= difference;
        }
        y
    };
    let dot = |a: &[f32], b: &[f32]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(x, y)| f64::from(*x) * f64::from(*y))
            .sum()
    };
    let scaled =
        |r: &[f32]| -> Vec<f32> { r.iter().zip(&degree).map(|(r, d)| r / d.max(1.0)).collect() };
    let mut layer = vec![0.0_f32; count];
    let mut near = scaled(&residual);
    let mut search = near.clone();
    let mut energy = dot(&residual, &near);
    let enough = energy * 1.0e-8;
    for _ in 0..STEPS {
        if energy.is_nan() || energy <= enough {
            break;
        }
        let image = apply(&search);
        let curvature = dot(&search, &image);
        if curvature.is_nan() || curvature <= 0.0 {
            break;
        }
        let step = (energy / curvature) as f32;
        for i in 0..count {
            layer[i] += step * search[i];
            residual[i] -= step * image[i];
        }
        near = scaled(&residual);
        let next = dot(&residual, &near);
        let keep = (next / energy) as f32;
        energy = next;
        search
            .iter_mut()
            .zip(&near)
            .for_each(|(s, r)| *s = r + keep * *s);
    }
    for (leaf, layer) in leaves.iter_mut().zip(layer) {
        if layer.is_finite() {
            leaf.card.layer = layer;
        }
    }
}

fn edges(leaves: &[Leaf]) -> Vec<Edge> {
    let roots: Vec<Vec3> = leaves.iter().map(|leaf| leaf.card.root).collect();
    let mut lengths: Vec<f32> = leaves.iter().map(|leaf| leaf.card.length).collect();
    lengths.sort_by(f32::total_cmp);
    let grid = PointGrid::of(
        &roots,
        0.5 * lengths.get(lengths.len() / 2).copied().unwrap_or(1.0),
    );
    let mut edges = Vec::new();
    for (first, leaf) in leaves.iter().enumerate() {
        let card = &leaf.card;
        let before = edges.len();
        grid.near(card.root, card.length, |second| {
            let other = &leaves[second as usize].card;
            // Each pair once, from its longer feather.
            if edges.len() - before >= NEIGHBOURS
                || second as usize == first
                || (other.length, second as usize) > (card.length, first)
                || card.normal.dot(other.normal) < 0.3
            {
                return;
            }
            let Some(along) = (card.along + other.along).try_normalize() else {
                return;
            };
            let step = other.root - card.root;
            let lead = step.dot(along);
            let aside = step.dot(along.cross(card.normal + other.normal).normalize_or_zero());
            if lead.abs() > ALONG * card.length
                || aside.abs() > ACROSS * 0.5 * (card.width + other.width)
            {
                return;
            }
            let key = match card.layer.floor().total_cmp(&other.layer.floor()) {
                _ if card.region == other.region => 0.0,
                std::cmp::Ordering::Less => -1.0,
                std::cmp::Ordering::Equal => 0.0,
                std::cmp::Ordering::Greater => 1.0,
            };
            edges.push(Edge {
                first: first as u32,
                second,
                lead: lead + key * KEY_LEAD * other.length,
            });
        });
    }
    edges
}
