//! What is seen of a posed coat from all around, and what should be: contacts where a feather shows that another one should cover.
//!
//! Most of a coat lies buried under other feathers, and contacts there ask for as much as those that can be seen. Small pictures
//! from many sides find what is seen: at each pixel the feather of the highest rank among those that lie close to the nearest, and all
//! that it should cover.

use super::{
    carried::{Carried, Spot},
    contact::{Contact, GAP, Stands, raise},
    drawing::{Drawing, Fragment, HELD, Picture, REACH},
    leaf::Leaf,
};
use crate::maths::order::{WINDOW_MOST, WINDOW_STEPS, order_reach};
use bevy::{
    math::Vec3,
    tasks::{ComputeTaskPool, TaskPool},
};
use std::ops::Range;

/// Pictures at a time.
const EYES: usize = 16;
/// Feathers of a pixel that are looked at.
const PILE: usize = 12;
/// Feathers below each other that count as seen: where the coat moves a little, the next shows.
const DEPTH: usize = 3;

/// What is added to a window, widths.
const MARGIN: f32 = 0.02;
/// Window of what is seen and in order, widths, the smallest that is kept: where feathers touch, a little motion would bring the lower
/// through the upper, and back.
const IN_ORDER: f32 = 0.01;
/// Window of the upper of two that touch, widths.
const IN_TOUCH: f32 = 0.04;
/// Distance of two that touch, widths of the narrower, at most.
const TOUCH: f32 = 0.01;

/// Share in a place of a vertex below which its window is not asked for there.
const LITTLE: f32 = 0.12;
/// Share above which the window of a vertex leaves room for the body there.
const MOST: f32 = 0.4;
/// Pixels of a round or few that do not open the window of a vertex.
const FEW: usize = 0;

/// How much stiffer a feather is that holds another down.
const STIFFER: f32 = 0.25;

/// A coat and the body below it, in one pose.
pub struct Seen<'a> {
    /// Leaves.
    pub leaves: &'a [Leaf],
    /// The same, carried.
    pub carried: &'a Carried,
    /// Triangles of the skin as posed.
    pub body: &'a [[Vec3; 3]],
}

/// Direction to an eye of a round; over the rounds they fill the sphere.
fn eye(number: usize, round: usize) -> Vec3 {
    const GOLDEN: f32 = 0.618_034;
    let place = (number as f32 + (0.5 + GOLDEN * round as f32).fract()) / EYES as f32;
    let height = 1.0 - 2.0 * place;
    let angle = std::f32::consts::TAU * GOLDEN * (number as f32 + 0.37 * round as f32) + 0.5;
    let wide = (1.0 - height * height).max(0.0).sqrt();
    Vec3::new(wide * angle.cos(), height, wide * angle.sin())
}

impl Seen<'_> {
    fn drawing(&self, heights: &[f32]) -> Drawing {
        Drawing::new(self.leaves, self.carried, heights)
    }

    /// One round of pictures of the coat with these heights: what `find` makes of each.
    fn pictures<T: Send + 'static>(
        &self,
        drawing: &Drawing,
        rounds: Range<usize>,
        find: impl Fn(&Picture) -> T + Sync,
    ) -> Vec<T> {
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let eyes = rounds.flat_map(|round| (0..EYES).map(move |number| eye(number, round)));
        let find = &find;
        pool.scope(|scope| {
            for eye in eyes {
                scope.spawn(async move { find(&drawing.picture(eye, self.body)) });
            }
        })
    }

    /// Contacts of what should be seen in a round of pictures of the coat with these heights over all that it should cover, those of the
    /// lowest first.
    pub fn contacts(&self, heights: &[f32], round: usize) -> Vec<Contact> {
        let drawing = self.drawing(heights);
        let parts = self.pictures(&drawing, round..round + 1, |found| {
            let mut contacts = Vec::new();
            for list in found.seen.chunk_by(|a, b| a.pixel == b.pixel) {
                let list = &list[..list.len().min(PILE)];
                touch(list, &drawing.stands, heights, &mut contacts);
            }
            contacts
        });
        let mut contacts: Vec<(f32, Contact)> = parts.into_iter().flatten().collect();
        contacts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        contacts.into_iter().map(|(_, contact)| contact).collect()
    }

    /// For each vertex whether it lies uppermost somewhere in a round of pictures, or next to that.
    pub fn uppermost(&self, heights: &[f32], round: usize) -> Vec<bool> {
        let drawing = self.drawing(heights);
        let parts = self.pictures(&drawing, round..round + 1, |found| {
            let mut marks = Vec::new();
            for list in found.seen.chunk_by(|a, b| a.pixel == b.pixel) {
                mark(&list[..list.len().min(PILE)], &drawing.stands, &mut marks);
            }
            marks.sort_unstable();
            marks.dedup();
            marks
        });
        let mut marks = vec![false; heights.len()];
        for i in parts.into_iter().flatten() {
            marks[i as usize] = true;
        }
        marks
    }

    /// Windows, widths of the leaf, for each vertex: of what should be seen in these rounds of pictures and is not, as far as that
    /// takes; of what is seen and in order, enough to stay so where the coat moves a little. No wider than the room behind skin, bill and
    /// legs, which it would paint over.
    pub fn windows(&self, heights: &[f32], rounds: Range<usize>) -> Vec<f32> {
        let drawing = self.drawing(heights);
        let parts = self.pictures(&drawing, rounds, |found| {
            let pixels = found.seen.chunk_by(|a, b| a.pixel == b.pixel);
            let needs = pixels.filter_map(|list| self.need(list, &drawing.stands));
            let shows = found.behind.iter().filter(|own| own.facing > 0.0);
            let rooms = shows.map(|own| (own.spot(), kept_within(self.window(own, own.near))));
            (needs.collect::<Vec<_>>(), rooms.collect::<Vec<_>>())
        });
        let mut needs: Vec<(u32, f32)> = Vec::new();
        let mut rooms = vec![f32::INFINITY; heights.len()];
        for (of_picture, behind) in parts {
            for (spot, need) in of_picture {
                let near = spot.into_iter().filter(|(_, share)| *share > LITTLE);
                needs.extend(near.map(|(i, _)| (i, need)));
            }
            for (spot, room) in behind {
                for (i, _) in spot.into_iter().filter(|(_, share)| *share > MOST) {
                    rooms[i as usize] = rooms[i as usize].min(room);
                }
            }
        }
        needs.sort_unstable_by(|(i, a), (j, b)| i.cmp(j).then(b.total_cmp(a)));
        let mut windows = vec![0.0; heights.len()];
        for list in needs.chunk_by(|(i, _), (j, _)| i == j) {
            // A pixel or two are not worth it.
            if let Some((i, need)) = list.get(FEW) {
                windows[*i as usize] = need.min(rooms[*i as usize]);
            }
        }
        windows
    }

    /// How far, 0..1, stiffer leaves hold each down at a round of pictures: the share of it that they cover; all of it if it lies too deep
    /// to be seen.
    pub fn held(&self, heights: &[f32], round: usize, stiffness: &[f32]) -> Vec<f32> {
        let drawing = self.drawing(heights);
        let stands = &drawing.stands;
        let stiff = |leaf: u32| {
            let region = usize::from(self.leaves[leaf as usize].card.region);
            stiffness.get(region).copied().unwrap_or(0.0)
        };
        let parts = self.pictures(&drawing, round..round + 1, |found| {
            let mut covered = Vec::new();
            for list in found.seen.chunk_by(|a, b| a.pixel == b.pixel) {
                for own in list.iter().filter(|own| own.facing > 0.0) {
                    let over = |other: &Fragment| {
                        let (a, b) = (stands.of(own.leaf), stands.of(other.leaf));
                        other.facing > 0.0
                            && b.layer > a.layer
                            && stiff(other.leaf) > stiff(own.leaf) + STIFFER
                            && (other.near - own.near).abs() < REACH * a.width.min(b.width)
                            && stands.related(own.leaf, other.leaf)
                    };
                    covered.push((own.leaf, list.iter().any(over)));
                }
            }
            covered
        });
        let mut counts = vec![(0_u32, 0_u32); self.leaves.len()];
        for (leaf, covered) in parts.into_iter().flatten() {
            let (all, under) = &mut counts[leaf as usize];
            *all += 1;
            *under += u32::from(covered);
        }
        counts
            .iter()
            .map(|(all, under)| {
                if *all == 0 {
                    1.0
                } else {
                    *under as f32 / *all as f32
                }
            })
            .collect()
    }

    /// The place that should be seen at a pixel, and the window that this takes; none if no window brings it there.
    fn need(&self, list: &[Fragment], stands: &Stands) -> Option<(Spot, f32)> {
        let shown = list.first().filter(|shown| shown.facing > 0.0)?;
        let wanted = wanted(list, shown, stands);
        if wanted.leaf == shown.leaf {
            let own = stands.of(shown.leaf);
            let touches = |other: &Fragment| {
                let its = stands.of(other.leaf);
                other.facing > 0.0
                    && its.layer < own.layer
                    && shown.near - other.near < TOUCH * own.width.min(its.width)
                    && stands.related(shown.leaf, other.leaf)
            };
            let touches = list[1..].iter().any(touches);
            return Some((shown.spot(), if touches { IN_TOUCH } else { IN_ORDER }));
        }
        let need = self.window(wanted, shown.near - wanted.near) + MARGIN;
        (need <= WINDOW_MOST).then_some((wanted.spot(), need))
    }

    /// The window, widths of its leaf, that brings a fragment as far towards the eye, metres.
    fn window(&self, own: &Fragment, depth: f32) -> f32 {
        let block = &self.carried.blocks[own.leaf as usize];
        let last = (block.rows - 1) as f32;
        let width = self.leaves[own.leaf as usize].card.width;
        let reach = own.spot().map(|(i, share)| {
            let along = ((i as usize - block.first) / block.wide) as f32 / last;
            share * order_reach(width, own.facing, along)
        });
        depth / reach.iter().sum::<f32>()
    }
}

/// The widest window that is kept and no wider than `room`, widths.
fn kept_within(room: f32) -> f32 {
    let steps = f32::from(WINDOW_STEPS);
    let share = (steps * (room.max(0.0) / WINDOW_MOST).sqrt()).floor() / steps;
    // A little less, so that it is not rounded up to the next.
    0.999 * WINDOW_MOST * share * share
}

/// The feather that should cover the nearest one of a pixel.
fn wanted<'a>(list: &'a [Fragment], shown: &'a Fragment, stands: &Stands) -> &'a Fragment {
    let front = shown.facing > 0.0;
    let own = stands.of(shown.leaf);
    let mut wanted = shown;
    for other in list {
        let its = stands.of(other.leaf);
        if other.leaf != shown.leaf
            && (other.facing > 0.0) == front
            && (its.layer > stands.of(wanted.leaf).layer) == front
            && shown.near - other.near < REACH * own.width.min(its.width)
            && stands.related(shown.leaf, other.leaf)
        {
            wanted = other;
        }
    }
    wanted
}

/// Adds the vertices that lie uppermost at a pixel, or should, or next to that.
fn mark(list: &[Fragment], stands: &Stands, marks: &mut Vec<u32>) {
    let Some(shown) = list.first() else { return };
    let front = shown.facing > 0.0;
    let wanted = wanted(list, shown, stands);
    let own = stands.of(wanted.leaf);
    let mut pile: Vec<&Fragment> = list
        .iter()
        .filter(|other| {
            let width = own.width.min(stands.of(other.leaf).width);
            (other.facing > 0.0) == front
                && (other.leaf == wanted.leaf
                    || wanted.near - other.near < REACH * width
                        && stands.related(wanted.leaf, other.leaf))
        })
        .collect();
    pile.sort_by(|a, b| {
        let layer = stands.of(a.leaf).layer.total_cmp(&stands.of(b.leaf).layer);
        if front { layer.reverse() } else { layer }
    });
    for one in pile.iter().take(DEPTH) {
        marks.extend(one.corners);
    }
}

/// Adds the contacts of a pixel.
fn touch(list: &[Fragment], stands: &Stands, heights: &[f32], contacts: &mut Vec<(f32, Contact)>) {
    let Some(shown) = list.first() else { return };
    let front = shown.facing > 0.0;
    let wanted = wanted(list, shown, stands);
    let own = stands.of(wanted.leaf);
    for other in list {
        let its = stands.of(other.leaf);
        let width = own.width.min(its.width);
        if other.leaf == wanted.leaf
            || (other.facing > 0.0) != front
            || (own.layer > its.layer) != front
            || other.near < wanted.near - HELD * width
            || !stands.related(wanted.leaf, other.leaf)
        {
            continue;
        }
        let height = (wanted.near - other.near) * wanted.facing.abs();
        let (upper, lower) = if front {
            (wanted, other)
        } else {
            (other, wanted)
        };
        let rank = stands.of(lower.leaf).layer;
        let (upper, lower) = (upper.spot(), lower.spot());
        let contact = Contact {
            height: height - raise(&upper, heights) + raise(&lower, heights),
            upper,
            lower,
            gap: GAP * width,
            sign: -1.0,
        };
        contacts.push((rank, contact));
    }
}
