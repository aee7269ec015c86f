//! Which feather lies over which, and the settling of those that cross.
//!
//! Draping alone orders feathers of one tract (see [`super::drape::rise`]). Where tracts meet, where the lay bends and where
//! chance lifts one feather and presses its neighbor, feathers can still poke through those that cover them. Here neighbors
//! turn about their roots, the upper up and the lower down, and then bend where they still touch, until they part
//! (docs/book/birds.md#settling).

use super::{grid::PointGrid, leaf::Leaf};
use bevy::math::{Vec2, Vec3};

/// Rounds of settling.
const ROUNDS: usize = 20;
/// Rounds of bending after that.
const BENDING_ROUNDS: usize = 20;
/// Furthest that bending moves a point, down and up, in distances from the root.
const BEND: (f32, f32) = (-0.05, 0.07);
/// Share of its height over the skin that a feather may lose.
const SINK: f32 = 0.6;
/// Stations along a feather that are compared.
const STATIONS: usize = 3;
/// Places across it.
const ACROSS: [f32; 3] = [-0.55, 0.0, 0.55];
/// Furthest turns down, about the root and about the shaft, radians.
const LOWEST: Vec2 = Vec2::new(-0.05, -0.2);
/// Furthest turns up.
const HIGHEST: Vec2 = Vec2::new(0.11, 0.2);
/// Depth, in widths, below which two feathers count as touching (0.2 mm on a contour feather).
const TOUCH: f32 = 0.01;

/// Pairs of neighboring feathers that were compared, and those that still cross.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of feathers of which one covers a part of the other.
    pub pairs: usize,
    /// Pairs that crossed before settling.
    pub before: usize,
    /// Pairs in which the lower still pokes through the upper.
    pub left: usize,
}

/// A point of a feather that is watched.
struct Sample {
    leaf: u32,
    /// Point of the shaft.
    point: u32,
    place: Vec3,
    normal: Vec3,
    /// Distance from the root along the shaft: the lever of a turn about the root.
    lever: f32,
    /// Distance from the shaft, to the right: the lever of a turn about the shaft.
    aside: f32,
}

/// A sample of one feather over the plane of another's nearest sample.
struct Contact {
    upper: u32,
    lower: u32,
    /// Points of their shafts.
    points: [u32; 2],
    /// Levers of the upper: about the root, about the shaft.
    upper_levers: Vec2,
    /// Levers of the lower.
    lower_levers: Vec2,
    /// Height of the upper over the lower before settling.
    gap: f32,
    touch: f32,
}

/// Turns feathers about their roots until those with the higher layer lie above, as far as they can.
///
/// Every contact in turn is parted half by the upper, half by the lower (projection, as in position-based dynamics). Lifting
/// only the upper would part each pair at once, but where the lay converges the lifts add up and run through the whole coat.
pub fn settle(leaves: &mut [Leaf]) -> Crossings {
    let mut contacts = contacts(leaves);
    let mut turns = vec![Vec2::ZERO; leaves.len()];
    let mut result = Crossings::default();
    (result.pairs, result.before) = crossing_pairs(&contacts, &turns);
    let key = |leaf: u32| leaves[leaf as usize].card.layer;
    contacts.sort_by(|a, b| {
        let layer = key(a.upper).total_cmp(&key(b.upper));
        layer
            .then(a.upper.cmp(&b.upper))
            .then(a.lower.cmp(&b.lower))
    });
    let lowest: Vec<Vec2> = leaves.iter().map(lowest).collect();
    for _ in 0..ROUNDS {
        for contact in &contacts {
            let depth = contact.touch - gap(contact, &turns);
            if depth > 0.0 {
                let (a, b) = (contact.upper_levers, contact.lower_levers);
                let share =
                    depth / (a.length_squared() + b.length_squared()).max(f32::MIN_POSITIVE);
                let (upper, lower) = (contact.upper as usize, contact.lower as usize);
                turns[upper] = (turns[upper] + a * share).clamp(lowest[upper], HIGHEST);
                turns[lower] = (turns[lower] - b * share).clamp(lowest[lower], HIGHEST);
            }
        }
    }
    let heights = bend(leaves, &mut contacts, &turns);
    // What is left of each gap is in the contacts now.
    let none = vec![Vec2::ZERO; leaves.len()];
    result.left = crossing_pairs(&contacts, &none).1;
    for ((leaf, turn), heights) in leaves.iter_mut().zip(turns).zip(heights) {
        turn_leaf(leaf, turn);
        bend_leaf(leaf, &heights);
    }
    result
}

/// How far a feather may turn down without sinking into the skin.
fn lowest(leaf: &Leaf) -> Vec2 {
    let step = leaf.card.length / (leaf.shaft.points.len() - 1) as f32;
    let levels = leaf.shaft.heights.iter().enumerate().skip(1);
    let room = levels
        .map(|(i, height)| SINK * height / (step * i as f32))
        .fold(f32::INFINITY, f32::min);
    Vec2::new(LOWEST.x.max(-room), LOWEST.y)
}

/// Heights by which the points of each shaft leave their places so that the contacts open further. Takes what the turns and the
/// heights give into the gaps of the contacts.
fn bend(leaves: &[Leaf], contacts: &mut [Contact], turns: &[Vec2]) -> Vec<Vec<f32>> {
    for contact in contacts.iter_mut() {
        contact.gap = gap(contact, turns);
    }
    let mut heights: Vec<Vec<f32>> = leaves
        .iter()
        .map(|leaf| vec![0.0; leaf.shaft.points.len()])
        .collect();
    let reach = |leaf: u32, point: usize| {
        let leaf = &leaves[leaf as usize];
        leaf.card.length * point as f32 / (leaf.shaft.points.len() - 1) as f32
    };
    let floors: Vec<Vec<f32>> = leaves
        .iter()
        .zip(turns)
        .map(|(leaf, turn)| {
            let step = leaf.card.length / (leaf.shaft.points.len() - 1) as f32;
            let floor = |i: usize| {
                let lever = step * i as f32;
                let height = leaf.shaft.heights.get(i).copied();
                let room = SINK * height.unwrap_or(f32::INFINITY) + turn.x.min(0.0) * lever;
                (BEND.0 * lever).max(-room.max(0.0))
            };
            (0..leaf.shaft.points.len()).map(floor).collect()
        })
        .collect();
    for _ in 0..BENDING_ROUNDS {
        for contact in contacts.iter() {
            let [a, b] = contact.points.map(|point| point as usize);
            let (upper, lower) = (contact.upper as usize, contact.lower as usize);
            let depth = contact.touch - (contact.gap + heights[upper][a] - heights[lower][b]);
            if depth <= 0.0 {
                continue;
            }
            let (far, near) = (reach(contact.upper, a), reach(contact.lower, b));
            let share = depth / (far + near).max(f32::MIN_POSITIVE);
            lift(&mut heights[upper], &floors[upper], a, far * share, far);
            lift(&mut heights[lower], &floors[lower], b, -near * share, near);
        }
    }
    for contact in contacts.iter_mut() {
        let [a, b] = contact.points.map(|point| point as usize);
        contact.gap += heights[contact.upper as usize][a] - heights[contact.lower as usize][b];
    }
    heights
}

/// Moves a point of a shaft up, its neighbors a third as far, within limits; the root stays.
fn lift(heights: &mut [f32], floors: &[f32], point: usize, by: f32, reach: f32) {
    let unit = reach / point.max(1) as f32;
    let last = (point + 1).min(heights.len() - 1);
    for (i, height) in heights.iter_mut().enumerate().take(last + 1).skip(1) {
        if i + 1 < point {
            continue;
        }
        let share = if i == point { by } else { by / 3.0 };
        let reach = unit * i as f32;
        *height = (*height + share).clamp(floors[i], BEND.1 * reach);
    }
}

/// Bends a feather by the heights of its points; its segments keep their lengths.
fn bend_leaf(leaf: &mut Leaf, heights: &[f32]) {
    if heights.iter().all(|height| *height == 0.0) {
        return;
    }
    let old = leaf.shaft.points.clone();
    let moved: Vec<Vec3> = old
        .iter()
        .zip(&leaf.shaft.normals)
        .zip(heights)
        .map(|((point, normal), height)| *point + *normal * *height)
        .collect();
    for i in 1..old.len() {
        let length = old[i].distance(old[i - 1]);
        let along = (moved[i] - moved[i - 1])
            .try_normalize()
            .unwrap_or(leaf.card.along);
        leaf.shaft.points[i] = leaf.shaft.points[i - 1] + along * length;
    }
    for i in 0..old.len() {
        let (along, normal) = (leaf.along(i), leaf.shaft.normals[i]);
        leaf.shaft.normals[i] = (normal - along * normal.dot(along))
            .try_normalize()
            .unwrap_or(normal);
    }
    let span = leaf.shaft.points[1] - leaf.shaft.points[0];
    leaf.card.along = span.try_normalize().unwrap_or(leaf.card.along);
    leaf.card.normal = leaf.shaft.normals[0];
}

fn gap(contact: &Contact, turns: &[Vec2]) -> f32 {
    let upper = turns[contact.upper as usize].dot(contact.upper_levers);
    contact.gap + upper - turns[contact.lower as usize].dot(contact.lower_levers)
}

/// Number of pairs in contact, and of those that cross.
fn crossing_pairs(contacts: &[Contact], turns: &[Vec2]) -> (usize, usize) {
    let mut pairs: Vec<(u64, bool)> = contacts
        .iter()
        .map(|contact| {
            (
                u64::from(contact.upper) << 32 | u64::from(contact.lower),
                gap(contact, turns) < -contact.touch,
            )
        })
        .collect();
    pairs.sort_unstable();
    let crossing = pairs
        .iter()
        .filter(|(_, crosses)| *crosses)
        .map(|(pair, _)| *pair);
    let mut crossing: Vec<u64> = crossing.collect();
    crossing.dedup();
    pairs.dedup_by_key(|(pair, _)| *pair);
    (pairs.len(), crossing.len())
}

fn contacts(leaves: &[Leaf]) -> Vec<Contact> {
    let mut samples = Vec::with_capacity(leaves.len() * STATIONS * ACROSS.len());
    for (number, leaf) in leaves.iter().enumerate() {
        let last = leaf.shaft.points.len() - 1;
        let mut done = 0;
        for station in 1..=STATIONS {
            let i = (station * last).div_ceil(STATIONS);
            if i == done {
                continue;
            }
            done = i;
            // The root has no lever and the tip is narrow: the middle of the last part stands for it.
            let lever = leaf.card.length * i as f32 / last as f32;
            let across: &[f32] = if i == last { &[0.0] } else { &ACROSS };
            samples.extend(across.iter().map(|&x| Sample {
                leaf: number as u32,
                point: i as u32,
                place: leaf.place(i, x),
                normal: leaf.normal(i, x),
                lever: lever.max(0.25 * leaf.card.length),
                aside: 0.5 * x * leaf.card.width,
            }));
        }
    }
    let mut widths: Vec<f32> = leaves.iter().map(|leaf| leaf.card.width).collect();
    widths.sort_by(f32::total_cmp);
    let Some(&median) = widths.get(widths.len() / 2) else {
        return Vec::new();
    };
    let places: Vec<Vec3> = samples.iter().map(|sample| sample.place).collect();
    let grid = PointGrid::of(&places, 0.5 * median);
    let mut contacts = Vec::new();
    let mut nearest: Vec<(u32, f32, u32)> = Vec::new();
    for sample in &samples {
        let leaf = &leaves[sample.leaf as usize];
        let radius = 0.45 * leaf.card.width;
        nearest.clear();
        grid.near(sample.place, radius, |j| {
            let other = &samples[j as usize];
            let distance = other.place.distance_squared(sample.place);
            if other.leaf == sample.leaf
                || distance > radius * radius
                || other.normal.dot(sample.normal) < 0.5
            {
                return;
            }
            match nearest.iter_mut().find(|(leaf, ..)| *leaf == other.leaf) {
                Some(entry) if entry.1 <= distance => {}
                Some(entry) => *entry = (other.leaf, distance, j),
                None => nearest.push((other.leaf, distance, j)),
            }
        });
        for &(other, _, j) in &nearest {
            let other_leaf = &leaves[other as usize];
            let under = &samples[j as usize];
            let delta = sample.place - under.place;
            let height = delta.dot(under.normal);
            // Beside the other's blade there is nothing to cross.
            if (delta - under.normal * height).length() > 0.22 * other_leaf.card.width {
                continue;
            }
            let above = (leaf.card.layer, sample.leaf) > (other_leaf.card.layer, other);
            let touch = TOUCH * leaf.card.width.min(other_leaf.card.width);
            let (upper, lower, gap) = if above {
                (sample, under, height)
            } else {
                (under, sample, -height)
            };
            contacts.push(Contact {
                upper: upper.leaf,
                lower: lower.leaf,
                points: [upper.point, lower.point],
                upper_levers: Vec2::new(upper.lever, upper.aside),
                lower_levers: Vec2::new(lower.lever, lower.aside),
                gap,
                touch,
            });
        }
    }
    contacts
}

/// Turns a feather by small angles: about its root, up if positive, and about its shaft, right side up if positive.
fn turn_leaf(leaf: &mut Leaf, turn: Vec2) {
    let last = leaf.shaft.points.len() - 1;
    let step = leaf.card.length / last as f32;
    let along: Vec<Vec3> = (0..=last).map(|i| leaf.along(i)).collect();
    for (i, along) in along.into_iter().enumerate() {
        let normal = leaf.shaft.normals[i];
        let side = along.cross(normal);
        leaf.shaft.points[i] += normal * (turn.x * step * i as f32);
        let turned = normal - along * turn.x - side * turn.y;
        leaf.shaft.normals[i] = turned.try_normalize().unwrap_or(normal);
    }
    let span = leaf.shaft.points[1] - leaf.shaft.points[0];
    leaf.card.along = span.try_normalize().unwrap_or(leaf.card.along);
    leaf.card.normal = leaf.shaft.normals[0];
}
