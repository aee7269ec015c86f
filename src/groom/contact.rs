//! Where feathers of a posed coat touch: samples of one over or under the triangles of another.

use super::{
    carried::{Block, Carried},
    columns::Columns,
    leaf::Leaf,
};
use bevy::{
    math::Vec3,
    tasks::{ComputeTaskPool, TaskPool},
};
use std::ops::Range;

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
/// Side of the columns that samples are sorted into, in median widths.
const COLUMN: f32 = 0.25;
/// Samples that one task takes.
const CHUNK: usize = 2048;

/// A place on a feather: three vertices and their shares.
pub type Spot = [(u32, f32); 3];

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
pub fn raise(spot: &Spot, heights: &[f32]) -> f32 {
    spot.iter()
        .map(|(i, share)| heights[*i as usize] * share)
        .sum()
}

/// Half the width of the blade at share `v`, in half widths of the card: a rounded feather.
pub fn blade(v: f32) -> f32 {
    let end = ((v - 0.62) / 0.38).max(0.0);
    (0.25 + 2.5 * v).min(1.0) * (1.0 - end * end).max(0.0).sqrt()
}

impl Block {
    fn vertex(&self, i: usize, j: usize) -> u32 {
        (self.first + i * self.wide + j) as u32
    }

    /// The corners of the two triangles of a quad.
    pub fn triangles(&self, i: usize, j: usize) -> [[u32; 3]; 2] {
        let (a, b) = (self.vertex(i, j), self.vertex(i, j + 1));
        let (c, d) = (self.vertex(i + 1, j + 1), self.vertex(i + 1, j));
        [[a, b, c], [a, c, d]]
    }

    /// Rows and columns of the first vertices of all quads.
    pub fn quads(&self) -> impl Iterator<Item = (usize, usize)> {
        quads(self, 0..self.rows - 1)
    }

    /// The triangle of the mesh at shares across (-1..1) and along (0..1).
    fn spot(&self, across: f32, along: f32) -> Spot {
        let x = (0.5 + 0.5 * across).clamp(0.0, 1.0) * (self.wide - 1) as f32;
        let y = along.clamp(0.0, 1.0) * (self.rows - 1) as f32;
        let (j, i) = (
            (x as usize).min(self.wide - 2),
            (y as usize).min(self.rows - 2),
        );
        let (u, v) = (x - j as f32, y - i as f32);
        let (a, c) = (self.vertex(i, j), self.vertex(i + 1, j + 1));
        if u > v {
            [(a, 1.0 - u), (self.vertex(i, j + 1), u - v), (c, v)]
        } else {
            [(a, 1.0 - v), (self.vertex(i + 1, j), v - u), (c, u)]
        }
    }
}

fn at(spot: &Spot, points: &[Vec3]) -> Vec3 {
    spot.iter().fold(Vec3::ZERO, |sum, (i, share)| {
        sum + points[*i as usize] * *share
    })
}

/// A place on a feather as others see it.
#[derive(Clone, Copy)]
struct Seen {
    place: Vec3,
    normal: Vec3,
    leaf: u32,
    along: f32,
}

struct Sample {
    seen: Seen,
    spot: Spot,
}

/// How a whole feather stands: root, and normal in the middle.
struct Stand {
    root: Vec3,
    normal: Vec3,
}

/// How all feathers stand.
pub struct Stands(Vec<Stand>);

impl Stands {
    /// Of leaves whose vertices are at these points.
    pub fn new(carried: &Carried, points: &[Vec3]) -> Self {
        let stand = |block: &Block| {
            let middle = block.first + block.rows / 2 * block.wide + block.wide / 2;
            Stand {
                root: points[block.first + block.wide / 2],
                normal: carried.normals[middle],
            }
        };
        Self(carried.blocks.iter().map(stand).collect())
    }

    /// Whether two feathers that face the same way can cover each other: rooted within a length and a width.
    pub fn related(&self, leaves: &[Leaf], a: u32, b: u32) -> bool {
        let [x, y] = [a, b].map(|i| &leaves[i as usize].card);
        let [s, t] = [a, b].map(|i| &self.0[i as usize]);
        let reach = x.length.max(y.length) + x.width.max(y.width);
        s.normal.dot(t.normal) > 0.0 && s.root.distance_squared(t.root) < reach * reach
    }
}

/// A triangle of a feather.
#[derive(Clone, Copy, Default)]
struct Facet {
    corner: Vec3,
    /// Unit normal; zero if the triangle has no area.
    normal: Vec3,
    /// The shares of the second and of the third corner at a place, for its offset from the first.
    shares: [Vec3; 2],
}

impl Facet {
    fn new([p, q, r]: [Vec3; 3]) -> Self {
        let cross = (q - p).cross(r - p);
        let area = cross.length_squared();
        if area < 1.0e-30 {
            return Self::default();
        }
        Self {
            corner: p,
            normal: cross / area.sqrt(),
            shares: [p - r, q - p].map(|edge| cross.cross(edge) / area),
        }
    }
}

/// Looks for the contacts of a coat as it now stands.
pub struct Finder<'a> {
    leaves: &'a [Leaf],
    blocks: &'a [Block],
    /// Two for each vertex: the triangles of the quad that begins there.
    facets: Vec<[Facet; 2]>,
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
}

impl<'a> Finder<'a> {
    /// Takes samples of all leaves, those of the lowest first.
    pub fn new(leaves: &'a [Leaf], carried: &'a Carried, heights: &'a [f32]) -> Self {
        let blocks = &carried.blocks;
        let points = carried.raised(heights);
        let mut samples = Vec::with_capacity(blocks.len() * ALONG.len() * 3);
        let stands = Stands::new(carried, &points);
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
                        place: at(&spot, &points),
                        normal,
                        leaf: number as u32,
                        along: v,
                    };
                    samples.push(Sample { seen, spot });
                }
            }
        }
        let mut facets = vec![[Facet::default(); 2]; points.len()];
        for block in blocks {
            for (i, j) in quads(block, 0..block.rows.saturating_sub(1)) {
                facets[block.vertex(i, j) as usize] = block
                    .triangles(i, j)
                    .map(|corners| Facet::new(corners.map(|corner| points[corner as usize])));
            }
        }
        Self {
            leaves,
            blocks,
            facets,
            heights,
            samples,
            stands,
            median: carried.median,
        }
    }

    /// Contacts, in order of the samples: those whose upper is seen (`seen`: which vertices are), and all back to back.
    pub fn find(&self, seen: &[bool]) -> Vec<Contact> {
        let places = self.samples.iter();
        let places = places.map(|sample| (sample.seen.place, sample.seen));
        let around = &Columns::new(places, COLUMN * self.median);
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let parts = pool.scope(|scope| {
            for (number, chunk) in self.samples.chunks(CHUNK).enumerate() {
                scope.spawn(async move {
                    // Sample for which a leaf was last found, and where it then stands in its list.
                    let mut slots = vec![(u32::MAX, 0); self.leaves.len()];
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
        let [x, y] = [a, b].map(|i| &self.leaves[i as usize]);
        let [(p, m), (q, n)] = [x, y].map(|leaf| {
            let middle = leaf.shaft.points.len() / 2;
            (leaf.shaft.points[middle], leaf.shaft.normals[middle])
        });
        let (x, y) = (&x.card, &y.card);
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
        around: &Columns<Seen>,
        mark: u32,
        slots: &mut [(u32, u32)],
        [near, behind]: [&mut Vec<Near>; 2],
    ) {
        let Seen {
            place,
            normal,
            leaf,
            ..
        } = sample.seen;
        let own = &self.leaves[leaf as usize].card;
        let radius = 0.5 * own.width.max(0.6 * self.median);
        around.near(place, radius, |run| {
            for other in run {
                let distance = other.place.distance_squared(place);
                if distance > radius * radius || other.leaf == leaf {
                    continue;
                }
                let facing = other.normal.dot(normal);
                if facing < FACING && facing > BACK {
                    continue;
                }
                let list = if facing > 0.0 {
                    &mut *near
                } else {
                    &mut *behind
                };
                let slot = &mut slots[other.leaf as usize];
                let found = Near {
                    leaf: other.leaf,
                    distance,
                    along: other.along,
                };
                match list.get_mut(slot.1 as usize) {
                    Some(entry) if slot.0 == mark && entry.leaf == other.leaf => {
                        if distance < entry.distance {
                            *entry = found;
                        }
                    }
                    _ => {
                        *slot = (mark, list.len() as u32);
                        list.push(found);
                    }
                }
            }
        });
        behind.retain(|other| self.back_to_back(leaf, other.leaf));
        behind.sort_unstable_by(|a, b| {
            let distance = a.distance.total_cmp(&b.distance);
            distance.then(a.leaf.cmp(&b.leaf))
        });
        near.retain(|other| self.stands.related(self.leaves, leaf, other.leaf));
        // What lies right above and right below passes the order on to the rest.
        let apart = |other: &Near| (self.leaves[other.leaf as usize].card.layer - own.layer).abs();
        near.sort_unstable_by(|a, b| apart(a).total_cmp(&apart(b)).then(a.leaf.cmp(&b.leaf)));
    }

    /// Adds the contacts of a sample with feathers that face the same way.
    fn touch(&self, sample: &Sample, near: &[Near], seen: &[bool], contacts: &mut Vec<Contact>) {
        let own = &self.leaves[sample.seen.leaf as usize].card;
        let mut found = 0;
        for other in near {
            if found == NEXT {
                break;
            }
            let card = &self.leaves[other.leaf as usize].card;
            let width = own.width.min(card.width);
            let Some((spot, height)) = self.over(&sample.seen, 1.0, other, width) else {
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
        let own = &self.leaves[sample.seen.leaf as usize].card;
        for other in behind.iter().take(BEHIND) {
            let width = own.width.min(self.leaves[other.leaf as usize].card.width);
            let Some((spot, height)) = self.over(&sample.seen, -1.0, other, width) else {
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
    fn over(&self, seen: &Seen, facing: f32, other: &Near, width: f32) -> Option<(Spot, f32)> {
        let block = &self.blocks[other.leaf as usize];
        let (reach, normal) = (REACH * width, seen.normal * facing);
        let last = block.rows - 1;
        let middle = other.along * last as f32;
        let from = (middle - 1.3).max(0.0) as usize;
        let to = ((middle + 1.3).ceil() as usize).min(last);
        let mut best: Option<(Spot, f32)> = None;
        for (i, j) in quads(block, from..to) {
            let facets = &self.facets[block.vertex(i, j) as usize];
            for (facet, number) in facets.iter().zip(0..) {
                let offset = seen.place - facet.corner;
                let height = offset.dot(facet.normal);
                if height.abs() > reach || facet.normal.dot(normal) <= 0.0 {
                    continue;
                }
                let [v, w] = facet.shares.map(|share| share.dot(offset));
                let u = 1.0 - v - w;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                if best.is_none_or(|(_, known)| height.abs() < known.abs()) {
                    let [p, q, r] = block.triangles(i, j)[number];
                    best = Some(([(p, u), (q, v), (r, w)], height));
                }
            }
        }
        best
    }
}

/// The quads of a feather whose first vertices lie in these rows.
fn quads(block: &Block, rows: Range<usize>) -> impl Iterator<Item = (usize, usize)> + use<> {
    let wide = block.wide - 1;
    rows.flat_map(move |i| (0..wide).map(move |j| (i, j)))
}
