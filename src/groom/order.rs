//! Which feather lies over which: one rank per feather, a total order, so that no feathers can cover each other in a ring.
//!
//! A bird's coat is a pile of sheets, from the filler below to the head and the mantle above ([`Sheet`]). Feathers of rows keep the
//! order that their row gives them: side by side on a bone, their roots say nothing. Scattered feathers of one sheet grow out of the
//! skin in front of those that they cover: of two neighbors the one rooted further up the lay is the upper, whatever tract
//! either belongs to. Neither the phi of a tract nor the order of tracts says so everywhere (phi may run across the lay, and
//! tracts meet in more than one direction), so the feathers' own roots are asked.

use super::{grid::PointGrid, leaf::Leaf};
use bevy::math::Vec3;

/// Pairs further apart than this, in lengths along the lay, do not meet.
const ALONG: f32 = 0.9;
/// The same across the lay, in mean widths.
const ACROSS: f32 = 0.9;
/// Lead, in lengths, that the tract with the higher layer key has over its neighbors.
const KEY_LEAD: f32 = 0.12;
/// Most neighbors that one feather is compared with.
const NEIGHBOURS: usize = 64;
/// Steps of the solver.
const STEPS: usize = 120;

/// Sheets of a coat from the lowest to the highest. The layer key of a region or row says which it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sheet {
    /// Regions up to key 0: what fills gaps.
    Filler,
    /// Rows below key 300: the tail and its coverts.
    Tail,
    /// Regions below key 700: belly, flanks, legs.
    Low,
    /// All other rows: wings.
    Wing,
    /// Regions below key 1150: the small coverts, which lie over the rows of the wing.
    Coverts,
    /// All other regions: back, scapulars, breast, neck, head.
    High,
}

impl Sheet {
    /// The sheet of a layer key.
    pub fn of(key: f32, in_row: bool) -> Self {
        match (in_row, key) {
            (true, key) if key < 300.0 => Self::Tail,
            (true, _) => Self::Wing,
            (false, key) if key < 1.0 => Self::Filler,
            (false, key) if key < 700.0 => Self::Low,
            (false, key) if key < 1150.0 => Self::Coverts,
            (false, _) => Self::High,
        }
    }
}

/// One pair: how far the first is rooted up the lay from the second, metres.
struct Edge {
    first: u32,
    second: u32,
    lead: f32,
}

/// Replaces the layers of the leaves (their tract's key and phi) by their ranks: 0 lies below all others, and no two are equal. The
/// first `scattered` leaves are those of regions, the rest those of rows.
///
/// Within a sheet, scattered feathers are ordered by the function whose differences over all pairs of neighbors come closest to the
/// distances of the roots along the feathers (least squares, by conjugate gradients); where two tracts grow side by side the key
/// decides.
pub fn order(leaves: &mut [Leaf], scattered: usize) {
    let scattered = scattered.min(leaves.len());
    let sheets: Vec<Sheet> = leaves
        .iter()
        .enumerate()
        .map(|(number, leaf)| Sheet::of(leaf.card.layer, number >= scattered))
        .collect();
    let leads = leads(&edges(&leaves[..scattered], &sheets), scattered);
    let keys: Vec<f32> = leaves
        .iter()
        .enumerate()
        .map(|(number, leaf)| leads.get(number).copied().unwrap_or(leaf.card.layer))
        .collect();
    let mut sorted: Vec<usize> = (0..leaves.len()).collect();
    sorted.sort_by(|&a, &b| {
        let sheet = sheets[a].cmp(&sheets[b]);
        sheet.then(keys[a].total_cmp(&keys[b])).then(a.cmp(&b))
    });
    for (rank, number) in sorted.into_iter().enumerate() {
        leaves[number].card.layer = rank as f32;
    }
}

/// Solves for the place of each feather up the lay, metres.
fn leads(edges: &[Edge], count: usize) -> Vec<f32> {
    let mut degree = vec![0.0_f32; count];
    let mut residual = vec![0.0_f32; count];
    for edge in edges {
        let (a, b) = (edge.first as usize, edge.second as usize);
        degree[a] += 1.0;
        degree[b] += 1.0;
        residual[a] += edge.lead;
        residual[b] -= edge.lead;
    }
    let apply = |x: &[f32]| {
        let mut y = vec![0.0_f32; count];
        for edge in edges {
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
    layer
        .iter_mut()
        .filter(|x| !x.is_finite())
        .for_each(|x| *x = 0.0);
    layer
}

/// Neighbors of one sheet.
fn edges(leaves: &[Leaf], sheets: &[Sheet]) -> Vec<Edge> {
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
                || sheets[second as usize] != sheets[first]
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
