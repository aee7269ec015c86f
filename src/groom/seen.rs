//! What is seen of a posed coat from all around, and what should be: contacts where a feather shows that another one should cover.
//!
//! Most of a coat lies buried under other feathers, and contacts there ask for as much as those that can be seen. Small pictures
//! from many sides find what is seen: at each pixel the feather of the highest rank among those that lie close to the nearest, and all
//! that it should cover.

use super::{
    carried::Carried,
    contact::{Contact, GAP, Spot, Stands, blade, raise},
    leaf::Leaf,
};
use crate::maths::order::{WINDOW_MOST, order_reach};
use bevy::{
    math::{Vec2, Vec3},
    tasks::{ComputeTaskPool, TaskPool},
};
use std::ops::Range;

/// Pictures at a time.
const EYES: usize = 16;
/// Side of a pixel, median widths, and pixels along a side at most.
const PIXEL: f32 = 0.2;
const PIXELS: f32 = 400.0;
/// Cosine between a face and the eye, below which it is seen edge-on.
const STEEP: f32 = 0.12;
/// How far behind the nearest a feather may lie that should cover it, widths of the narrower.
const REACH: f32 = 0.5;
/// How far below its upper a feather is held there, widths of the narrower.
const HELD: f32 = 0.1;
/// Feathers of a pixel that are looked at.
const PILE: usize = 12;
/// Feathers below each other that count as seen: where the coat moves a little, the next shows.
const DEPTH: usize = 3;

/// What is added to a window, widths.
const MARGIN: f32 = 0.02;

/// Share in a place of a vertex below which its window is not asked for there.
const LITTLE: f32 = 0.12;
/// Pixels of a round or few that do not open the window of a vertex.
const FEW: usize = 0;

/// How much stiffer a feather is that holds another down.
const STIFFER: f32 = 0.25;

/// A feather at a pixel.
#[derive(Clone, Copy)]
struct Fragment {
    pixel: u32,
    /// Height towards the eye, metres.
    near: f32,
    leaf: u32,
    /// Normal of the front times the direction to the eye.
    facing: f32,
    /// Corners of the triangle and the shares of the first two.
    corners: [u32; 3],
    shares: [f32; 2],
}

impl Fragment {
    fn spot(&self) -> Spot {
        let ([a, b, c], [u, v]) = (self.corners, self.shares);
        [(a, u), (b, v), (c, 1.0 - u - v)]
    }
}

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

/// A picture's frame.
struct Frame {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    low: Vec2,
    pixel: f32,
    wide: usize,
    high: usize,
}

impl Frame {
    fn new(eye: Vec3, points: &[Vec3], median: f32) -> Self {
        let right = eye.any_orthonormal_vector();
        let up = eye.cross(right);
        let flat = |p: &Vec3| Vec2::new(p.dot(right), p.dot(up));
        let (low, high) = points
            .iter()
            .filter(|p| p.is_finite())
            .map(flat)
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(a, b), p| {
                (a.min(p), b.max(p))
            });
        let size = (high - low).max(Vec2::ZERO);
        let pixel = (PIXEL * median).max(size.max_element() / PIXELS);
        let pixel = pixel.max(f32::MIN_POSITIVE);
        let pixels = (size / pixel).ceil();
        Self {
            eye,
            right,
            up,
            low,
            pixel,
            wide: pixels.x as usize + 1,
            high: pixels.y as usize + 1,
        }
    }

    /// Column, row and height towards the eye.
    fn project(&self, p: Vec3) -> Vec3 {
        let flat = (Vec2::new(p.dot(self.right), p.dot(self.up)) - self.low) / self.pixel;
        flat.extend(p.dot(self.eye))
    }

    /// Visits the pixels of a triangle: pixel, height, shares of the first two corners.
    fn cover(&self, [a, b, c]: [Vec3; 3], mut visit: impl FnMut(usize, f32, [f32; 2])) {
        let low = a.min(b).min(c).truncate().max(Vec2::ZERO).ceil();
        let last = Vec2::new(self.wide as f32 - 1.0, self.high as f32 - 1.0);
        let high = a.max(b).max(c).truncate().min(last).floor();
        if !(low.x <= high.x && low.y <= high.y) {
            return;
        }
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area.abs() < 1.0e-9 || !area.is_finite() {
            return;
        }
        let over = 1.0 / area;
        let (of_u, of_v) = ((b - c).truncate() * over, (c - a).truncate() * over);
        // Half-open ranges: inclusive ones are slow here where little is inlined.
        for y in low.y as usize..high.y as usize + 1 {
            for x in low.x as usize..high.x as usize + 1 {
                let p = Vec2::new(x as f32, y as f32);
                let u = of_u.perp_dot(c.truncate() - p);
                let v = of_v.perp_dot(a.truncate() - p);
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    visit(y * self.wide + x, a.z * u + b.z * v + c.z * w, [u, v]);
                }
            }
        }
    }
}

impl Seen<'_> {
    /// One round of pictures of the coat with these heights: contacts of what should be seen over all that it should cover, those of
    /// the lowest first; and for each vertex whether it lies uppermost somewhere, or next to that.
    pub fn look(&self, heights: &[f32], round: usize) -> (Vec<Contact>, Vec<bool>) {
        let points = self.carried.raised(heights);
        let stands = Stands::new(self.carried, &points);
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let (points, stands) = (&points, &stands);
        let parts = pool.scope(|scope| {
            for number in 0..EYES {
                scope.spawn(async move {
                    let frame = Frame::new(eye(number, round), points, self.carried.median);
                    self.picture(&frame, points, stands, heights)
                });
            }
        });
        let mut contacts: Vec<(f32, Contact)> = Vec::new();
        let mut marks = vec![false; points.len()];
        for (part, seen) in parts {
            contacts.extend(part);
            seen.into_iter().for_each(|i| marks[i as usize] = true);
        }
        contacts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let contacts = contacts.into_iter().map(|(_, contact)| contact);
        (contacts.collect(), marks)
    }

    /// Visits all fragments of the blades.
    fn draw(
        &self,
        frame: &Frame,
        projected: &[Vec3],
        points: &[Vec3],
        mut visit: impl FnMut(Fragment),
    ) {
        for (leaf, block) in self.carried.blocks.iter().enumerate() {
            let last = (block.rows - 1) as f32;
            for (i, j) in block.quads() {
                for (corners, upper) in block.triangles(i, j).into_iter().zip([false, true]) {
                    let [p, q, r] = corners.map(|k| points[k as usize]);
                    let normal = (q - p).cross(r - p).normalize_or_zero();
                    let facing = normal.dot(frame.eye);
                    if facing.abs() < STEEP {
                        continue;
                    }
                    let at = corners.map(|k| projected[k as usize]);
                    frame.cover(at, |pixel, near, [u, v]| {
                        let w = 1.0 - u - v;
                        // Corners: (i, j), (i, j + 1), (i + 1, j + 1); and (i, j), (i + 1, j + 1), (i + 1, j).
                        let (x, y) = if upper { (v, v + w) } else { (v + w, w) };
                        let across = 2.0 * (j as f32 + x) / (block.wide - 1) as f32 - 1.0;
                        if across.abs() <= blade((i as f32 + y) / last) {
                            visit(Fragment {
                                pixel: pixel as u32,
                                near,
                                leaf: leaf as u32,
                                facing,
                                corners,
                                shares: [u, v],
                            });
                        }
                    });
                }
            }
        }
    }

    /// Fragments of a picture that lie near the nearest of their pixel, pixel by pixel, the nearest first.
    fn fragments(&self, frame: &Frame, points: &[Vec3]) -> Vec<Fragment> {
        let count = frame.wide * frame.high;
        let mut nearest = vec![f32::NEG_INFINITY; count];
        for triangle in self.body {
            frame.cover(triangle.map(|p| frame.project(p)), |pixel, near, _| {
                nearest[pixel] = nearest[pixel].max(near);
            });
        }
        let wall = nearest.clone();
        let projected: Vec<Vec3> = points.iter().map(|p| frame.project(*p)).collect();
        let mut found = Vec::new();
        self.draw(frame, &projected, points, |fragment| {
            let pixel = fragment.pixel as usize;
            if fragment.near > wall[pixel] {
                nearest[pixel] = nearest[pixel].max(fragment.near);
                found.push(fragment);
            }
        });
        found.retain(|fragment: &Fragment| {
            let reach = (REACH + HELD) * self.leaves[fragment.leaf as usize].card.width;
            nearest[fragment.pixel as usize] - fragment.near < reach
        });
        found.sort_unstable_by(|a: &Fragment, b| {
            let pixel = a.pixel.cmp(&b.pixel);
            pixel
                .then(b.near.total_cmp(&a.near))
                .then(a.leaf.cmp(&b.leaf))
        });
        found
    }

    /// Windows, widths of the leaf, for each vertex: of what should be seen in these rounds of pictures and is not, as far as that
    /// takes.
    pub fn windows(&self, heights: &[f32], rounds: Range<usize>) -> Vec<f32> {
        let points = &self.carried.raised(heights);
        let stands = &Stands::new(self.carried, points);
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let eyes = rounds.flat_map(|round| (0..EYES).map(move |number| eye(number, round)));
        let parts = pool.scope(|scope| {
            for eye in eyes {
                scope.spawn(async move {
                    let frame = Frame::new(eye, points, self.carried.median);
                    let found = self.fragments(&frame, points);
                    let pixels = found.chunk_by(|a, b| a.pixel == b.pixel);
                    let needs = pixels.filter_map(|list| self.need(list, stands));
                    needs.collect::<Vec<_>>()
                });
            }
        });
        let mut needs: Vec<(u32, f32)> = Vec::new();
        for (spot, need) in parts.into_iter().flatten() {
            let near = spot.into_iter().filter(|(_, share)| *share > LITTLE);
            needs.extend(near.map(|(i, _)| (i, need)));
        }
        needs.sort_unstable_by(|(i, a), (j, b)| i.cmp(j).then(b.total_cmp(a)));
        let mut windows = vec![0.0; points.len()];
        for list in needs.chunk_by(|(i, _), (j, _)| i == j) {
            // A pixel or two are not worth it.
            if let Some((i, need)) = list.get(FEW) {
                windows[*i as usize] = *need;
            }
        }
        windows
    }

    /// How far, 0..1, stiffer leaves hold each down at a round of pictures: the share of it that they cover; all of it if it lies too deep
    /// to be seen.
    pub fn held(&self, heights: &[f32], round: usize, stiffness: &[f32]) -> Vec<f32> {
        let points = &self.carried.raised(heights);
        let stands = &Stands::new(self.carried, points);
        let stiff = &|leaf: u32| {
            let region = usize::from(self.leaves[leaf as usize].card.region);
            stiffness.get(region).copied().unwrap_or(0.0)
        };
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let parts = pool.scope(|scope| {
            for number in 0..EYES {
                scope.spawn(async move {
                    let frame = Frame::new(eye(number, round), points, self.carried.median);
                    let found = self.fragments(&frame, points);
                    let mut covered = Vec::new();
                    for list in found.chunk_by(|a, b| a.pixel == b.pixel) {
                        for own in list.iter().filter(|own| own.facing > 0.0) {
                            let over = |other: &&Fragment| {
                                let [a, b] =
                                    [own, *other].map(|f| &self.leaves[f.leaf as usize].card);
                                other.facing > 0.0
                                    && b.layer > a.layer
                                    && stiff(other.leaf) > stiff(own.leaf) + STIFFER
                                    && (other.near - own.near).abs() < REACH * a.width.min(b.width)
                                    && stands.related(self.leaves, own.leaf, other.leaf)
                            };
                            covered.push((own.leaf, list.iter().any(|other| over(&other))));
                        }
                    }
                    covered
                });
            }
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

    /// The place that should be seen at a pixel, and the window that this takes; none if it is seen without, or never.
    fn need(&self, list: &[Fragment], stands: &Stands) -> Option<(Spot, f32)> {
        let shown = list.first().filter(|shown| shown.facing > 0.0)?;
        let wanted = self.wanted(list, shown, stands);
        if wanted.leaf == shown.leaf {
            return None;
        }
        let block = &self.carried.blocks[wanted.leaf as usize];
        let last = (block.rows - 1) as f32;
        let width = self.leaves[wanted.leaf as usize].card.width;
        let reach = wanted.spot().map(|(i, share)| {
            let along = ((i as usize - block.first) / block.wide) as f32 / last;
            share * order_reach(width, wanted.facing, along)
        });
        let unit: f32 = reach.iter().sum();
        let need = (shown.near - wanted.near) / unit + MARGIN;
        (need <= WINDOW_MOST).then_some((wanted.spot(), need))
    }

    /// The feather that should cover the nearest one of a pixel.
    fn wanted<'b>(
        &self,
        list: &'b [Fragment],
        shown: &'b Fragment,
        stands: &Stands,
    ) -> &'b Fragment {
        let card = |fragment: &Fragment| &self.leaves[fragment.leaf as usize].card;
        let front = shown.facing > 0.0;
        let mut wanted = shown;
        for other in list {
            let width = card(shown).width.min(card(other).width);
            if other.leaf != shown.leaf
                && (other.facing > 0.0) == front
                && (card(other).layer > card(wanted).layer) == front
                && shown.near - other.near < REACH * width
                && stands.related(self.leaves, shown.leaf, other.leaf)
            {
                wanted = other;
            }
        }
        wanted
    }

    fn picture(
        &self,
        frame: &Frame,
        points: &[Vec3],
        stands: &Stands,
        heights: &[f32],
    ) -> (Vec<(f32, Contact)>, Vec<u32>) {
        let found = self.fragments(frame, points);
        let (mut contacts, mut marks) = (Vec::new(), Vec::new());
        for list in found.chunk_by(|a, b| a.pixel == b.pixel) {
            self.part(
                &list[..list.len().min(PILE)],
                stands,
                heights,
                &mut contacts,
                &mut marks,
            );
        }
        marks.sort_unstable();
        marks.dedup();
        (contacts, marks)
    }

    /// Adds the contacts of a pixel.
    fn part(
        &self,
        list: &[Fragment],
        stands: &Stands,
        heights: &[f32],
        contacts: &mut Vec<(f32, Contact)>,
        marks: &mut Vec<u32>,
    ) {
        let Some(shown) = list.first() else { return };
        let card = |fragment: &Fragment| &self.leaves[fragment.leaf as usize].card;
        let front = shown.facing > 0.0;
        let over = |a: &Fragment, b: &Fragment| (card(a).layer > card(b).layer) == front;
        let wanted = self.wanted(list, shown, stands);
        let mut pile: Vec<&Fragment> = list
            .iter()
            .filter(|other| {
                (other.facing > 0.0) == front
                    && (other.leaf == wanted.leaf
                        || wanted.near - other.near
                            < REACH * card(wanted).width.min(card(other).width)
                            && stands.related(self.leaves, wanted.leaf, other.leaf))
            })
            .collect();
        pile.sort_by(|a, b| {
            let layer = card(a).layer.total_cmp(&card(b).layer);
            if front { layer.reverse() } else { layer }
        });
        for one in pile.iter().take(DEPTH) {
            marks.extend(one.corners);
        }
        for other in list {
            let width = card(wanted).width.min(card(other).width);
            if other.leaf == wanted.leaf
                || (other.facing > 0.0) != front
                || !over(wanted, other)
                || other.near < wanted.near - HELD * width
                || !stands.related(self.leaves, wanted.leaf, other.leaf)
            {
                continue;
            }
            let height = (wanted.near - other.near) * wanted.facing.abs();
            let (upper, lower) = if front {
                (wanted, other)
            } else {
                (other, wanted)
            };
            let rank = card(lower).layer;
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
}
