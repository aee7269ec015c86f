//! Where feathers of a posed coat touch: samples of one over or under the triangles of another.

use super::{
    carried::{Block, Carried, Spot},
    cells::Cells,
    facets::Vanes,
    leaf::Leaf,
};
use bevy::{
    math::Vec3,
    tasks::{ComputeTaskPool, TaskPool},
};

/// Samples that must lie on the right side: shares of the length,
const ALONG: [f32; 8] = [0.12, 0.2, 0.3, 0.4, 0.5, 0.62, 0.8, 0.97];
/// and of half the blade's width, taken in turn.
const ACROSS: [[f32; 3]; 2] = [[-0.9, 0.0, 0.9], [-0.75, 0.0, 0.75]];
/// The same at the tip.
const ACROSS_TIP: [f32; 3] = [-0.6, 0.0, 0.6];
/// Clear height between two feathers, in widths of the narrower.
pub const GAP: f32 = 0.02;
/// Deepest crossing that is looked for, in widths of the narrower.
const REACH: f32 = 0.3;
/// Cosine between the normals of two feathers that cover each other, at least.
const FACING: f32 = 0.2;
/// Cosine between the normals of two feathers that lie back to back, at most.
const BACK: f32 = -0.3;
/// Feathers next in rank that a sample is kept on the right side of.
const NEXT: usize = 14;
/// Feathers of the other face that it is kept away from.
const BEHIND: usize = 8;
/// Side of the cubes that samples are sorted into, in median widths.
const CUBE: f32 = 0.25;
/// Samples that one task takes.
const CHUNK: usize = 2048;

/// Two places, one over the other.
pub struct Contact {
    /// The upper.
    pub upper: Spot,
    /// The lower.
    pub lower: Spot,
    /// Height of the upper over the lower where no vertex is raised.
    pub height: f32,
    /// The same as it should be, at least.
    pub gap: f32,
    /// What a unit of height of the lower adds: -1, or 1 back to back, where both move away from each other.
    pub sign: f32,
}

/// What the heights of the vertices make of a place.
#[inline]
pub fn raise(spot: &Spot, heights: &[f32]) -> f32 {
    let [(a, u), (b, v), (c, w)] = *spot;
    heights[a as usize] * u + heights[b as usize] * v + heights[c as usize] * w
}

/// Half the width of the blade at share `v`, in half widths of the card: a rounded feather.
#[inline]
pub fn blade(v: f32) -> f32 {
    let end = ((v - 0.62) / 0.38).max(0.0);
    (0.25 + 2.5 * v).min(1.0) * (1.0 - end * end).max(0.0).sqrt()
}

fn at(spot: &Spot, points: &[Vec3]) -> Vec3 {
    spot.iter().fold(Vec3::ZERO, |sum, (i, share)| {
        sum + points[*i as usize] * *share
    })
}

/// A place on a feather as others see it.
#[derive(Clone, Copy)]
struct Seen {
    normal: Vec3,
    leaf: u32,
    along: f32,
}

struct Sample {
    place: Vec3,
    seen: Seen,
    spot: Spot,
}

/// How a whole feather stands, and what else is asked of it for every place where it meets another.
pub struct Stand {
    root: Vec3,
    /// In the middle.
    normal: Vec3,
    length: f32,
    /// Width, metres.
    pub width: f32,
    /// Rank.
    pub layer: f32,
}

/// How all feathers stand.
pub struct Stands(Vec<Stand>);

impl Stands {
    /// Of leaves whose vertices are at these points.
    pub fn new(leaves: &[Leaf], carried: &Carried, points: &[Vec3]) -> Self {
        let stand = |(leaf, block): (&Leaf, &Block)| {
            let middle = block.first + block.rows / 2 * block.wide + block.wide / 2;
            Stand {
                root: points[block.first + block.wide / 2],
                normal: carried.normals[middle],
                length: leaf.card.length,
                width: leaf.card.width,
                layer: leaf.card.layer,
            }
        };
        Self(leaves.iter().zip(&carried.blocks).map(stand).collect())
    }

    /// One of them.
    #[inline]
    pub fn of(&self, leaf: u32) -> &Stand {
        &self.0[leaf as usize]
    }

    /// Whether two feathers that face the same way can cover each other: rooted within a length and a width.
    #[inline]
    pub fn related(&self, a: u32, b: u32) -> bool {
        let (s, t) = (self.of(a), self.of(b));
        let reach = s.length.max(t.length) + s.width.max(t.width);
        s.normal.dot(t.normal) > 0.0 && s.root.distance_squared(t.root) < reach * reach
    }
}

/// Middle of a shaft in bind pose, and its normal.
fn middle(leaf: &Leaf) -> (Vec3, Vec3) {
    let middle = leaf.shaft.points.len() / 2;
    (leaf.shaft.points[middle], leaf.shaft.normals[middle])
}

/// Looks for the contacts of a coat as it now stands.
pub struct Finder<'a> {
    /// Middle of each shaft in bind pose, and its normal.
    middles: Vec<(Vec3, Vec3)>,
    blocks: &'a [Block],
    vanes: Vanes<'a>,
    heights: &'a [f32],
    samples: Vec<Sample>,
    stands: Stands,
    median: f32,
}

/// A feather near a sample, through the nearest of its own.
#[derive(Clone, Copy)]
struct Near {
    leaf: u32,
    distance: f32,
    along: f32,
    /// Ranks between the two.
    apart: f32,
}

impl<'a> Finder<'a> {
    /// Takes samples of all leaves, those of the lowest first.
    pub fn new(leaves: &'a [Leaf], carried: &'a Carried, heights: &'a [f32]) -> Self {
        let blocks = &carried.blocks;
        let points = carried.raised(heights);
        let mut samples = Vec::with_capacity(blocks.len() * ALONG.len() * 3);
        let stands = Stands::new(leaves, carried, &points);
        // From the lowest up: what is raised off the skin raises all that lies over it in one round of the projection.
        let mut rising: Vec<usize> = (0..leaves.len()).collect();
        rising.sort_by(|&a, &b| {
            let layer = leaves[a].card.layer.total_cmp(&leaves[b].card.layer);
            layer.then(a.cmp(&b))
        });
        for number in rising {
            let block = &blocks[number];
            let mut shares = ALONG.to_vec();
            // No fewer places than the mesh has segments.
            if block.rows > ALONG.len() {
                let last = (block.rows - 1) as f32;
                shares = (1..block.rows).map(|i| 0.985 * i as f32 / last).collect();
            }
            for (turn, v) in shares.into_iter().enumerate() {
                let wide = blade(v);
                let across = at(&block.spot(wide, v), &points) - at(&block.spot(-wide, v), &points);
                let along = at(&block.spot(0.0, v + 0.02), &points)
                    - at(&block.spot(0.0, v - 0.02), &points);
                let normal = across.cross(along).normalize_or_zero();
                let list = if v > 0.9 {
                    ACROSS_TIP
                } else {
                    ACROSS[turn % 2]
                };
                for x in list {
                    let spot = block.spot(x * wide, v);
                    let seen = Seen {
                        normal,
                        leaf: number as u32,
                        along: v,
                    };
                    samples.push(Sample {
                        place: at(&spot, &points),
                        seen,
                        spot,
                    });
                }
            }
        }
        Self {
            middles: leaves.iter().map(middle).collect(),
            blocks,
            vanes: Vanes::new(blocks, &points),
            heights,
            samples,
            stands,
            median: carried.median,
        }
    }

    /// Contacts, in order of the samples: those whose upper is seen (`seen`: which vertices are), and all back to back.
    pub fn find(&self, seen: &[bool]) -> Vec<Contact> {
        let places = self.samples.iter();
        let places: Vec<(Vec3, Seen)> = places.map(|sample| (sample.place, sample.seen)).collect();
        let around = &Cells::new(&places, CUBE * self.median);
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let parts = pool.scope(|scope| {
            for (number, chunk) in self.samples.chunks(CHUNK).enumerate() {
                scope.spawn(async move {
                    // Sample for which a leaf was last found, and where it then stands in its list.
                    let mut slots = vec![(u32::MAX, 0); self.middles.len()];
                    let (mut near, mut behind) = (Vec::new(), Vec::new());
                    let mut contacts = Vec::new();
                    for (i, sample) in chunk.iter().enumerate() {
                        near.clear();
                        behind.clear();
                        let mark = (number * CHUNK + i) as u32;
                        self.look(sample, around, mark, &mut slots, [&mut near, &mut behind]);
                        self.touch(sample, &near, seen, &mut contacts);
                        self.avoid(sample, &behind, &mut contacts);
                    }
                    contacts
                });
            }
        });
        parts.into_iter().flatten().collect()
    }

    /// Whether two feathers belong to the two faces of one part of the body: in bind pose they lie near each other and their fronts
    /// look apart.
    fn back_to_back(&self, a: u32, b: u32) -> bool {
        let ((p, m), (q, n)) = (self.middles[a as usize], self.middles[b as usize]);
        let (x, y) = (self.stands.of(a), self.stands.of(b));
        let reach = x.length.max(y.length) + x.width.max(y.width);
        m.dot(n) < BACK
            && p.distance_squared(q) < reach * reach
            && (p - q).dot(m - n) > -0.5 * self.median
    }

    /// Looks around a sample: feathers that face the same way, those next in rank first, and those of the other face, the nearest
    /// first.
    fn look(
        &self,
        sample: &Sample,
        around: &Cells<Seen>,
        mark: u32,
        slots: &mut [(u32, u32)],
        [near, behind]: [&mut Vec<Near>; 2],
    ) {
        let Seen { normal, leaf, .. } = sample.seen;
        let own = self.stands.of(leaf);
        let radius = 0.5 * own.width.max(0.6 * self.median);
        around.near(sample.place, radius, |distance, other| {
            if other.leaf == leaf {
                return;
            }
            let facing = other.normal.dot(normal);
            if facing < FACING && facing > BACK {
                return;
            }
            let list = if facing > 0.0 {
                &mut *near
            } else {
                &mut *behind
            };
            let slot = &mut slots[other.leaf as usize];
            match list.get_mut(slot.1 as usize) {
                Some(entry) if slot.0 == mark && entry.leaf == other.leaf => {
                    if distance < entry.distance {
                        entry.distance = distance;
                        entry.along = other.along;
                    }
                }
                _ => {
                    *slot = (mark, list.len() as u32);
                    list.push(Near {
                        leaf: other.leaf,
                        distance,
                        along: other.along,
                        apart: 0.0,
                    });
                }
            }
        });
        behind.retain(|other| self.back_to_back(leaf, other.leaf));
        behind.sort_unstable_by(|a, b| {
            let distance = a.distance.total_cmp(&b.distance);
            distance.then(a.leaf.cmp(&b.leaf))
        });
        near.retain(|other| self.stands.related(leaf, other.leaf));
        // What lies right above and right below passes the order on to the rest.
        for other in near.iter_mut() {
            other.apart = (self.stands.of(other.leaf).layer - own.layer).abs();
        }
        near.sort_unstable_by(|a, b| a.apart.total_cmp(&b.apart).then(a.leaf.cmp(&b.leaf)));
    }

    /// Adds the contacts of a sample with feathers that face the same way.
    fn touch(&self, sample: &Sample, near: &[Near], seen: &[bool], contacts: &mut Vec<Contact>) {
        let own = self.stands.of(sample.seen.leaf);
        let mut found = 0;
        for other in near {
            if found == NEXT {
                break;
            }
            let card = self.stands.of(other.leaf);
            let width = own.width.min(card.width);
            let Some((spot, height)) = self.over(sample, 1.0, other, width) else {
                continue;
            };
            found += 1;
            let (upper, lower, height) = if own.layer > card.layer {
                (sample.spot, spot, height)
            } else {
                (spot, sample.spot, -height)
            };
            let height = height - raise(&upper, self.heights) + raise(&lower, self.heights);
            if upper.iter().all(|(i, _)| !seen[*i as usize]) {
                continue;
            }
            contacts.push(Contact {
                height,
                upper,
                lower,
                gap: GAP * width,
                sign: -1.0,
            });
        }
    }

    /// Adds those with feathers behind it.
    fn avoid(&self, sample: &Sample, behind: &[Near], contacts: &mut Vec<Contact>) {
        let own = self.stands.of(sample.seen.leaf);
        for other in behind.iter().take(BEHIND) {
            let width = own.width.min(self.stands.of(other.leaf).width);
            let Some((spot, height)) = self.over(sample, -1.0, other, width) else {
                continue;
            };
            let raised = raise(&sample.spot, self.heights) + raise(&spot, self.heights);
            contacts.push(Contact {
                upper: sample.spot,
                lower: spot,
                height: -height - raised,
                gap: GAP * width,
                sign: 1.0,
            });
        }
    }

    /// Where on a feather a sample projects to, and its height over it. `facing`: 1 if the feather must face as the sample does, -1 if
    /// the other way.
    fn over(&self, sample: &Sample, facing: f32, other: &Near, width: f32) -> Option<(Spot, f32)> {
        let last = self.blocks[other.leaf as usize].rows - 1;
        let middle = other.along * last as f32;
        let from = (middle - 1.3).max(0.0) as usize;
        let to = ((middle + 1.3).ceil() as usize).min(last);
        let normal = sample.seen.normal * facing;
        let reach = REACH * width;
        self.vanes
            .project(sample.place, normal, other.leaf, from..to, reach)
    }
}
