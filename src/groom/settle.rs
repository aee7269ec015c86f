//! The last step of layering: feathers are pressed over each other as sheets, vertex by vertex, in the poses that the bird wears.
//!
//! Turning and bending whole feathers ([`super::layer`]) parts most of them in bind pose. A folded wing crosses them anew, and
//! brings together feathers that were no neighbors. Here every vertex may rise or sink along its carried normal until the upper
//! feather lies above: projection of one contact after the other (position-based dynamics; Müller et al. 2007), half by the upper
//! and half by the lower. Lifting only the upper would part each pair at once, but where feathers overlap from head to tail the
//! lifts add up without end. The skin is the floor.
//!
//! What can be seen comes first. Small pictures from many sides (module `seen`) say which vertices lie uppermost or next to it; of
//! feathers that are buried only those are kept apart that something seen lies over, so that a pile where the wing folds does not
//! grow thicker than it must. Then the coat is looked at again, a few times, and what should be seen is drawn over all that hides it.
//!
//! Every pose has heights of its own ([`super::WornPoses`] says which a bird wears): feathers that lie upon each other in the folded wing
//! are drawn apart by the open one, and lie upon others. Those of later poses begin at those of the first.

use super::{
    carried::{Block, Carried},
    contact::{Contact, Finder, raise},
    leaf::Leaf,
    pose::blend,
    seen::Seen,
    skin::SkinMesh,
    worn::MAX_POSES,
};
use bevy::math::{Affine3A, Vec3};

/// Times that contacts are looked for in the first pose, and in each further one, which begins near its end.
const SEARCHES: [usize; 2] = [3, 2];
/// Rounds of projection after each.
const ROUNDS: usize = 25;
/// Times that the coat is looked at from all around after that.
const LOOKS: usize = 3;
/// Rounds of projection after each.
const LOOK_ROUNDS: usize = 15;
/// Times that it is looked at for what is still out of order.
const WINDOW_LOOKS: usize = 3;
/// Furthest that a vertex moves, in distances from the root: down, up.
const RANGE: (f32, f32) = (-0.5, 0.6);
/// What is added to both at the root and elsewhere, in median widths.
const FREE: f32 = 0.5;
/// Furthest that any vertex moves: over the root of the skin's area (parrot 14 mm, eagle 25 mm), and in median widths.
const MOST: (f32, f32) = (0.0353, 1.9);
/// Clear height over the skin, in median widths.
const CLEAR: f32 = 0.035;
/// How far a vertex goes towards the mean of those around it after each round.
const SMOOTH: f32 = 0.05;
/// Steepest rise between vertices side by side.
const SLOPE: f32 = 0.45;
/// Last rounds that are not smoothed.
const ROUGH: usize = 5;

/// What settling makes of the vertices of all leaves in one pose.
pub struct Settled {
    /// How much further each rises along its normal, metres.
    pub heights: Vec<f32>,
    /// How far behind the nearest each may lie and still be seen, widths of its leaf.
    pub windows: Vec<f32>,
    /// In the first pose: how far, 0..1, each leaf is held down by stiffer ones over it.
    pub held: Vec<f32>,
}

/// Brings leaves into order in a pose (what every joint, those of rows included, does to bind pose; empty: bind pose). `stiffness`: of
/// the regions and rows. The same arguments give the same bytes.
pub fn settle(leaves: &[Leaf], skin: &SkinMesh, pose: &[Affine3A], stiffness: &[f32]) -> Settled {
    let carried = Carried::new(leaves, pose);
    let before: Vec<f32> = leaves.iter().flat_map(raised).collect();
    let (lows, highs) = limits(leaves, skin, &carried, &before);
    let mut heights = vec![0.0_f32; carried.places.len()];
    let body = posed(skin, pose);
    let seen = Seen {
        leaves,
        carried: &carried,
        body: &body,
    };
    let marks = seen.uppermost(&heights, LOOKS);
    let further = leaves.iter().any(|leaf| !leaf.raised.is_empty());
    let searches = SEARCHES[usize::from(further)];
    let round = |contacts: &[&[Contact]], rough: bool, heights: &mut Vec<f32>| {
        for contacts in contacts {
            project(contacts, heights, &lows, &highs);
        }
        if !rough {
            smooth(&carried.blocks, heights, &lows, &highs);
        }
        flatten(leaves, &carried.blocks, &before, heights);
    };
    // All contacts that were found last, and over them, so that they count most, what was seen since.
    let mut all: Vec<Vec<Contact>> = Vec::new();
    for _ in 0..searches {
        all = vec![Finder::new(leaves, &carried, &heights).find(&marks)];
        for _ in 0..ROUNDS {
            round(&[&all[0]], false, &mut heights);
        }
    }
    for look in 0..LOOKS {
        all.push(seen.contacts(&heights, look));
        let lists: Vec<&[Contact]> = all.iter().map(Vec::as_slice).collect();
        for number in 0..LOOK_ROUNDS {
            let rough = look + 1 == LOOKS && number + ROUGH >= LOOK_ROUNDS;
            round(&lists, rough, &mut heights);
        }
    }
    let windows = seen.windows(&heights, LOOKS..LOOKS + WINDOW_LOOKS);
    let held = match further {
        true => Vec::new(),
        false => seen.held(&heights, LOOKS, stiffness),
    };
    Settled {
        heights,
        windows,
        held,
    }
}

/// Windows for what is out of order in a pose between those that the leaves were settled in. `shares`: of those in it; `round`: of
/// the sides that it is looked at from.
pub fn open_windows(
    leaves: &[Leaf],
    skin: &SkinMesh,
    pose: &[Affine3A],
    shares: &[f32; MAX_POSES],
    round: usize,
) -> Vec<f32> {
    let carried = Carried::new(leaves, pose);
    let mut heights = Vec::with_capacity(carried.places.len());
    for leaf in leaves {
        for at in 0..leaf.vertex_count() {
            let further = leaf.raised_further.iter().zip(&shares[1..]);
            heights.push(further.map(|(list, share)| list[at] * share).sum());
        }
    }
    let body = posed(skin, pose);
    let seen = Seen {
        leaves,
        carried: &carried,
        body: &body,
    };
    seen.windows(&heights, round..round + 1)
}

/// Triangles of the skin in a pose.
fn posed(skin: &SkinMesh, pose: &[Affine3A]) -> Vec<[Vec3; 3]> {
    let place = |(i, place): (usize, &Vec3)| {
        let weights = skin.weights.get(i).copied().unwrap_or_default();
        blend(&weights, pose).transform_point3(*place)
    };
    let places: Vec<Vec3> = skin.positions.iter().enumerate().map(place).collect();
    let triangles = skin.triangles.iter();
    triangles
        .map(|corners| corners.map(|i| places[i as usize]))
        .collect()
}

/// Heights that a leaf has already.
fn raised(leaf: &Leaf) -> impl Iterator<Item = f32> {
    let count = leaf.shaft.points.len() * (leaf.columns + 1);
    (0..count).map(|at| leaf.raised.get(at).copied().unwrap_or(0.0))
}

/// Parts every contact in turn.
fn project(contacts: &[Contact], heights: &mut [f32], lows: &[f32], highs: &[f32]) {
    for contact in contacts {
        let depth = contact.gap
            - (contact.height
                + raise(&contact.upper, heights)
                + contact.sign * raise(&contact.lower, heights));
        if depth <= 0.0 {
            continue;
        }
        // Vertices at their limit leave the way to the others.
        let mut total = 0.0;
        for (i, share) in &contact.upper {
            if heights[*i as usize] < highs[*i as usize] {
                total += share * share;
            }
        }
        let mut lower = 0.0;
        for (i, share) in &contact.lower {
            let i = *i as usize;
            let free = match contact.sign > 0.0 {
                true => heights[i] < highs[i],
                false => heights[i] > lows[i],
            };
            if free {
                lower += share * share;
            }
        }
        total += lower;
        let by = depth / total.max(0.05);
        for (spot, sign) in [(&contact.upper, 1.0), (&contact.lower, contact.sign)] {
            for (i, share) in spot {
                let i = *i as usize;
                heights[i] = (heights[i] + sign * by * share).clamp(lows[i], highs[i]);
            }
        }
    }
}

/// How far each vertex may still sink and rise.
fn limits(
    leaves: &[Leaf],
    skin: &SkinMesh,
    carried: &Carried,
    before: &[f32],
) -> (Vec<f32>, Vec<f32>) {
    let [free, clear, most] = [FREE, CLEAR, MOST.1].map(|share| share * carried.median);
    let most = most.min(MOST.0 * skin.areas.iter().sum::<f32>().sqrt());
    let count = carried.places.len();
    let (mut lows, mut highs) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (leaf, block) in leaves.iter().zip(&carried.blocks) {
        let step = leaf.card.length / (block.rows - 1).max(1) as f32;
        for i in 0..block.rows {
            let lever = step * i as f32;
            // The skin that a feather grows on is carried by the same joints: its height over it is that of bind pose.
            let room = leaf.shaft.heights.get(i).copied().unwrap_or(f32::INFINITY);
            let low = (RANGE.0 * lever - free).max(-most);
            let low = low.max(-(room - clear).max(0.0));
            let high = (RANGE.1 * lever + free).min(most);
            for already in &before[block.first + i * block.wide..][..block.wide] {
                lows.push((low - already).min(0.0));
                highs.push((high - already).max(0.0));
            }
        }
    }
    (lows, highs)
}

/// Keeps the vane from folding about the shaft: from the middle outwards, no vertex stands further from the next than [`SLOPE`]
/// allows. The limits of all vertices across are the same, so none is broken.
fn flatten(leaves: &[Leaf], blocks: &[Block], before: &[f32], heights: &mut [f32]) {
    for (leaf, block) in leaves.iter().zip(blocks) {
        let most = SLOPE * leaf.card.width / (block.wide - 1).max(1) as f32;
        let middle = block.wide / 2;
        for i in 0..block.rows {
            let row = block.first + i * block.wide;
            let (row, before) = (
                &mut heights[row..][..block.wide],
                &before[row..][..block.wide],
            );
            let mut hold = |j: usize, next: usize| {
                let level = row[next] + before[next];
                row[j] = (row[j] + before[j]).clamp(level - most, level + most) - before[j];
            };
            (middle + 1..block.wide).for_each(|j| hold(j, j - 1));
            (0..middle).rev().for_each(|j| hold(j, j + 1));
        }
    }
}

/// Takes the edge off the heights of each feather.
fn smooth(blocks: &[Block], heights: &mut [f32], lows: &[f32], highs: &[f32]) {
    let mut old = Vec::new();
    for block in blocks {
        let count = block.rows * block.wide;
        let part = &mut heights[block.first..block.first + count];
        if part.iter().all(|height| *height == 0.0) {
            continue;
        }
        old.clear();
        old.extend_from_slice(part);
        for i in 1..block.rows {
            for j in 0..block.wide {
                let (mut sum, mut number) = (0.0, 0.0_f32);
                for (k, l) in [
                    (i.wrapping_sub(1), j),
                    (i + 1, j),
                    (i, j.wrapping_sub(1)),
                    (i, j + 1),
                ] {
                    if k < block.rows && l < block.wide {
                        sum += old[k * block.wide + l];
                        number += 1.0;
                    }
                }
                let at = i * block.wide + j;
                let eased = old[at] + SMOOTH * (sum / number.max(1.0) - old[at]);
                part[at] = eased.clamp(lows[block.first + at], highs[block.first + at]);
            }
        }
    }
}
