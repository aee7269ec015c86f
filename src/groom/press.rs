//! The last step of layering: feathers are pressed over each other as sheets, vertex by vertex.
//!
//! Turning and bending whole feathers ([`super::layer`]) parts most of them. What is left crosses in places: an edge of one pokes
//! through the middle of another. Here every vertex may rise or sink along its normal until the upper lies above: projection of
//! one contact after the other (position-based dynamics; Müller et al. 2007).

use super::{grid::PointGrid, leaf::Leaf};
use bevy::math::Vec3;

/// Times that contacts are looked for.
const SEARCHES: usize = 3;
/// Rounds of projection after each.
const ROUNDS: usize = 8;
/// Samples that must lie on the right side: shares of the length,
const ALONG: [f32; 5] = [0.2, 0.4, 0.6, 0.8, 0.97];
/// and of half the blade's width.
const ACROSS: [f32; 3] = [-0.8, 0.0, 0.8];
/// Clear height between two sheets, in widths of the narrower.
const GAP: f32 = 0.006;
/// Deepest crossing that is looked for, in widths of the narrower.
const REACH: f32 = 0.6;
/// Furthest that a vertex moves, in distances from the root: down, up. Further up parts more pairs, but long scapulars then stand
/// off the folded wing.
const RANGE: (f32, f32) = (-0.06, 0.08);
/// Share of its height over the skin that a vertex may lose.
const SINK: f32 = 0.9;

/// Sheets next in order to a sample that are looked at.
const CANDIDATES: usize = 12;
/// Those of them that it is kept on the right side of.
const NEXT: usize = 6;

struct Sheet {
    first: usize,
    wide: usize,
    rows: usize,
    mobile: bool,
}

/// A place on a sheet: three vertices and their shares.
type Spot = [(u32, f32); 3];

struct Contact {
    upper: Spot,
    lower: Spot,
    /// Height of the upper over the lower where both are at rest.
    height: f32,
    gap: f32,
}

/// Half the width of the blade at share `v`, in half widths of the card: a rounded feather.
fn blade(v: f32) -> f32 {
    let end = ((v - 0.6) / 0.4).max(0.0);
    (0.3 + 2.5 * v).min(1.0) * (1.0 - end * end).max(0.0).sqrt()
}

impl Sheet {
    fn vertex(&self, i: usize, j: usize) -> u32 {
        (self.first + i * self.wide + j) as u32
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
        sum + points[*i as usize] * share
    })
}

/// Presses the leaves in bind pose. The first `mobile` of them may move; the rest (the rows, which turn with their bones) push.
pub fn press(leaves: &mut [Leaf], mobile: usize) {
    let mut sheets = Vec::with_capacity(leaves.len());
    let (mut rest, mut normals, mut lows, mut highs) = (vec![], vec![], vec![], vec![]);
    for (number, leaf) in leaves.iter().enumerate() {
        let mobile = number < mobile;
        let rows = leaf.shaft.points.len();
        let wide = leaf.columns + 1;
        sheets.push(Sheet {
            first: rest.len(),
            wide,
            rows,
            mobile,
        });
        let step = leaf.card.length / (rows - 1) as f32;
        for i in 0..rows {
            let lever = if mobile { step * i as f32 } else { 0.0 };
            let room = leaf.shaft.heights.get(i).copied().unwrap_or(0.0);
            for j in 0..wide {
                let x = 2.0 * j as f32 / leaf.columns as f32 - 1.0;
                rest.push(leaf.place(i, x));
                normals.push(leaf.normal(i, x));
                lows.push((RANGE.0 * lever).max(-SINK * room));
                highs.push(RANGE.1 * lever);
            }
        }
    }
    let mut heights = vec![0.0_f32; rest.len()];
    for search in 0..SEARCHES {
        let moved: Vec<Vec3> = rest
            .iter()
            .zip(&normals)
            .zip(&heights)
            .map(|((p, n), h)| *p + *n * *h)
            .collect();
        let mut contacts = Vec::new();
        find(leaves, &sheets, &moved, &heights, &mut contacts);
        let raise = |spot: &Spot, heights: &[f32]| {
            spot.iter()
                .map(|(i, share)| heights[*i as usize] * share)
                .sum::<f32>()
        };
        for round in 0..ROUNDS {
            for contact in &contacts {
                let depth = contact.gap
                    - (contact.height + raise(&contact.upper, &heights)
                        - raise(&contact.lower, &heights));
                if depth <= 0.0 {
                    continue;
                }
                let free = |spot: &Spot| {
                    spot.iter()
                        .filter(|(i, _)| highs[*i as usize] > 0.0)
                        .map(|(_, share)| share * share)
                        .sum::<f32>()
                };
                let total = free(&contact.upper) + free(&contact.lower);
                if total < 1.0e-4 {
                    continue;
                }
                let by = depth / total;
                for (spot, sign) in [(&contact.upper, 1.0), (&contact.lower, -1.0)] {
                    for (i, share) in spot {
                        let i = *i as usize;
                        heights[i] =
                            (heights[i] + sign * by * share).clamp(lows[i].min(0.0), highs[i]);
                    }
                }
            }
            if search + 1 < SEARCHES || round + 4 < ROUNDS {
                smooth(&sheets, &mut heights);
            }
        }
    }
    for (leaf, sheet) in leaves.iter_mut().zip(&sheets) {
        leaf.raised = heights[sheet.first..sheet.first + sheet.rows * sheet.wide].to_vec();
    }
}

/// Takes the edge off the heights of each sheet.
fn smooth(sheets: &[Sheet], heights: &mut [f32]) {
    let mut old = Vec::new();
    for sheet in sheets.iter().filter(|sheet| sheet.mobile) {
        let part = &mut heights[sheet.first..sheet.first + sheet.rows * sheet.wide];
        if part.iter().all(|h| *h == 0.0) {
            continue;
        }
        old.clear();
        old.extend_from_slice(part);
        for i in 1..sheet.rows {
            for j in 0..sheet.wide {
                let own = old[i * sheet.wide + j];
                let (mut sum, mut count) = (0.0, 0.0);
                for (k, l) in [
                    (i.wrapping_sub(1), j),
                    (i + 1, j),
                    (i, j.wrapping_sub(1)),
                    (i, j + 1),
                ] {
                    if k < sheet.rows && l < sheet.wide {
                        sum += old[k * sheet.wide + l];
                        count += 1.0;
                    }
                }
                part[i * sheet.wide + j] = own + 0.15 * (sum / count - own);
            }
        }
    }
}

struct Sample {
    leaf: u32,
    spot: Spot,
    place: Vec3,
    normal: Vec3,
    along: f32,
}

fn find(
    leaves: &[Leaf],
    sheets: &[Sheet],
    points: &[Vec3],
    heights: &[f32],
    contacts: &mut Vec<Contact>,
) {
    let mut samples = Vec::with_capacity(sheets.len() * ALONG.len() * ACROSS.len());
    for (number, sheet) in sheets.iter().enumerate() {
        for v in ALONG {
            let wide = blade(v);
            let across = at(&sheet.spot(wide, v), points) - at(&sheet.spot(-wide, v), points);
            let along =
                at(&sheet.spot(0.0, v + 0.02), points) - at(&sheet.spot(0.0, v - 0.02), points);
            let normal = across.cross(along).normalize_or_zero();
            let list: &[f32] = if v > 0.9 { &[0.0] } else { &ACROSS };
            for x in list {
                let spot = sheet.spot(x * wide, v);
                samples.push(Sample {
                    leaf: number as u32,
                    spot,
                    place: at(&spot, points),
                    normal,
                    along: v,
                });
            }
        }
    }
    let mut widths: Vec<f32> = leaves.iter().map(|leaf| leaf.card.width).collect();
    widths.sort_by(f32::total_cmp);
    let median = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    let places: Vec<Vec3> = samples.iter().map(|sample| sample.place).collect();
    let grid = PointGrid::of(&places, 0.4 * median);
    let mut near: Vec<(u32, f32, f32)> = Vec::new();
    // Where each leaf stands in `near`, and for which sample that holds.
    let mut slots = vec![(u32::MAX, 0_u32); leaves.len()];
    for (number, sample) in samples.iter().enumerate() {
        let own = &leaves[sample.leaf as usize];
        near.clear();
        let radius = 0.5 * own.card.width;
        grid.near(sample.place, radius, |j| {
            let other = &samples[j as usize];
            if other.leaf == sample.leaf || other.normal.dot(sample.normal) < 0.2 {
                return;
            }
            let distance = other.place.distance_squared(sample.place);
            if distance > radius * radius {
                return;
            }
            let slot = &mut slots[other.leaf as usize];
            if slot.0 != number as u32 {
                *slot = (number as u32, near.len() as u32);
                near.push((other.leaf, distance, other.along));
            } else if let Some(entry) = near.get_mut(slot.1 as usize)
                && distance < entry.1
            {
                *entry = (other.leaf, distance, other.along);
            }
        });
        // What lies right above and right below passes the order on to the rest.
        let apart = |leaf: u32| (leaves[leaf as usize].card.layer - own.card.layer).abs();
        near.sort_unstable_by(|a, b| apart(a.0).total_cmp(&apart(b.0)).then(a.0.cmp(&b.0)));
        let mut found = 0;
        for &(other, _, along) in near.iter().take(CANDIDATES) {
            let sheet = &sheets[other as usize];
            if found == NEXT {
                break;
            }
            if !sheet.mobile && !sheets[sample.leaf as usize].mobile {
                continue;
            }
            let card = &leaves[other as usize].card;
            let width = own.card.width.min(card.width);
            let Some((spot, height)) = below(sheet, points, sample, along, REACH * width) else {
                continue;
            };
            found += 1;
            let above = (own.card.layer, sample.leaf) > (card.layer, other);
            let raise = |spot: &Spot| {
                spot.iter()
                    .map(|(i, share)| heights[*i as usize] * share)
                    .sum::<f32>()
            };
            let gap = GAP * width;
            let (upper, lower, height) = if above {
                (sample.spot, spot, height)
            } else {
                (spot, sample.spot, -height)
            };
            contacts.push(Contact {
                height: height - raise(&upper) + raise(&lower),
                upper,
                lower,
                gap,
            });
        }
    }
}

/// Where on a sheet, near share `along`, the sample projects to, and its height over it.
fn below(
    sheet: &Sheet,
    points: &[Vec3],
    sample: &Sample,
    along: f32,
    reach: f32,
) -> Option<(Spot, f32)> {
    let last = sheet.rows - 1;
    let middle = along * last as f32;
    let from = (middle - 1.2).max(0.0) as usize;
    let to = ((middle + 1.2).ceil() as usize).min(last);
    let mut best: Option<(Spot, f32)> = None;
    for i in from..to {
        for j in 0..sheet.wide - 1 {
            let [a, b, c, d] = [
                sheet.vertex(i, j),
                sheet.vertex(i, j + 1),
                sheet.vertex(i + 1, j + 1),
                sheet.vertex(i + 1, j),
            ];
            for corners in [[a, b, c], [a, c, d]] {
                let [p, q, r] = corners.map(|k| points[k as usize]);
                let cross = (q - p).cross(r - p);
                let area = cross.length_squared();
                let delta = sample.place - p;
                let lift = delta.dot(cross);
                if area < 1.0e-30
                    || lift * lift > reach * reach * area
                    || cross.dot(sample.normal) <= 0.0
                {
                    continue;
                }
                let v = (p - r).cross(sample.place - r).dot(cross) / area;
                let w = (q - p).cross(delta).dot(cross) / area;
                let u = 1.0 - v - w;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let height = lift / area.sqrt();
                if best
                    .as_ref()
                    .is_none_or(|(_, other)| height.abs() < other.abs())
                {
                    best = Some(([(corners[0], u), (corners[1], v), (corners[2], w)], height));
                }
            }
        }
    }
    best
}
