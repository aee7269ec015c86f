//! How far feathers poke through those that should cover them, measured on the posed card mesh.
//!
//! A judge that shares nothing with the settling of [`bevy_plumage::groom::layer`]: that one compares samples of shafts in bind pose, this one
//! takes the skinned vertices as they are drawn and asks, for points on the blade of one feather, on which side of the other's
//! triangles they lie (docs/book/birds.md#settling).

use bevy::math::{Vec2, Vec3};
use bevy_plumage::groom::{Card, CardGeometry, grid::PointGrid};

/// Places along the rachis that are looked at, as shares of the length.
const ALONG: [f32; 5] = [0.2, 0.4, 0.6, 0.8, 0.97];
/// Places across the vane, as shares of half its width there.
const ACROSS: [f32; 3] = [-0.7, 0.0, 0.7];
/// Two faces whose normals enclose more than this (cosine) do not cover each other.
const FACING: f32 = 0.3;
/// Feathers further apart than this share of the narrower one's width are not in touch.
const REACH: f32 = 0.5;

/// One pair of neighbors of which one covers a part of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Card with the higher layer.
    pub upper: u32,
    /// The other.
    pub lower: u32,
    /// Greatest depth by which the lower pokes through the upper, metres; negative: the smallest gap.
    pub depth: f32,
    /// Where that is.
    pub place: Vec3,
}

/// The overlaps of a coat in one pose.
#[derive(Clone, Debug, Default)]
pub struct Overlaps {
    /// Every pair in touch, in order of the cards.
    pub list: Vec<Overlap>,
}

impl Overlaps {
    /// Number of pairs that poke through by more than `limit` metres.
    pub fn deeper(&self, limit: f32) -> usize {
        self.list.iter().filter(|pair| pair.depth > limit).count()
    }

    /// Share of the pairs that poke through by more than `limit` metres, 0..1.
    pub fn share(&self, limit: f32) -> f32 {
        self.deeper(limit) as f32 / self.list.len().max(1) as f32
    }

    /// Depth that only `share` (0..1) of the pairs exceed, metres; 0 without pairs.
    pub fn quantile(&self, share: f32) -> f32 {
        let mut depths: Vec<f32> = self.list.iter().map(|pair| pair.depth).collect();
        depths.sort_by(|a, b| b.total_cmp(a));
        let at = (share.clamp(0.0, 1.0) * depths.len() as f32) as usize;
        depths
            .get(at.min(depths.len().saturating_sub(1)))
            .copied()
            .unwrap_or(0.0)
    }
}

/// Half the width of a feather's blade at share `v` of its length, as a share of half the card's width: a rounded blade.
pub fn blade(v: f32) -> f32 {
    let end = ((v - 0.62) / 0.38).max(0.0);
    (0.25 + 2.5 * v).min(1.0) * (1.0 - end * end).max(0.0).sqrt()
}

/// One posed card.
struct Sheet<'a> {
    points: &'a [Vec3],
    /// Vertices across.
    wide: usize,
    rows: usize,
}

impl Sheet<'_> {
    fn at(&self, row: usize, column: usize) -> Vec3 {
        self.points[row * self.wide + column]
    }

    /// Place at shares across (-1..1) and along (0..1), on the triangles.
    fn place(&self, across: f32, along: f32) -> Vec3 {
        let x = (0.5 + 0.5 * across).clamp(0.0, 1.0) * (self.wide - 1) as f32;
        let y = along.clamp(0.0, 1.0) * (self.rows - 1) as f32;
        let (j, i) = (
            (x as usize).min(self.wide - 2),
            (y as usize).min(self.rows - 2),
        );
        let (u, v) = (x - j as f32, y - i as f32);
        let [a, b, c, d] = [
            self.at(i, j),
            self.at(i, j + 1),
            self.at(i + 1, j),
            self.at(i + 1, j + 1),
        ];
        // The diagonal runs from (0, 0) to (1, 1), as in the mesh.
        if u > v {
            a + (b - a) * u + (d - b) * v
        } else {
            a + (d - c) * u + (c - a) * v
        }
    }

    /// Signed height of `p` over the blade, along the normal of the triangle that it projects into; the nearest such.
    fn height(&self, p: Vec3, normal: Vec3, reach: f32) -> Option<f32> {
        let mut best: Option<f32> = None;
        for i in 0..self.rows - 1 {
            for j in 0..self.wide - 1 {
                let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
                for corners in [[a, b, c], [a, c, d]] {
                    if let Some(height) = self.triangle(corners, p, normal, reach)
                        && best.is_none_or(|best| height.abs() < best.abs())
                    {
                        best = Some(height);
                    }
                }
            }
        }
        best
    }

    fn triangle(
        &self,
        corners: [(usize, usize); 3],
        p: Vec3,
        normal: Vec3,
        reach: f32,
    ) -> Option<f32> {
        let [a, b, c] = corners.map(|(i, j)| self.at(i, j));
        let cross = (b - a).cross(c - a);
        let area = cross.length_squared();
        let face = cross.try_normalize()?;
        let height = (p - a).dot(face);
        if height.abs() > reach || face.dot(normal) < FACING {
            return None;
        }
        let u = (c - b).cross(p - b).dot(cross) / area;
        let v = (a - c).cross(p - c).dot(cross) / area;
        let w = 1.0 - u - v;
        if u < 0.0 || v < 0.0 || w < 0.0 {
            return None;
        }
        let uv = corners
            .into_iter()
            .zip([u, v, w])
            .fold(Vec2::ZERO, |sum, ((i, j), share)| {
                sum + share
                    * Vec2::new(
                        2.0 * j as f32 / (self.wide - 1) as f32 - 1.0,
                        i as f32 / (self.rows - 1) as f32,
                    )
            });
        (uv.x.abs() <= blade(uv.y)).then_some(height)
    }
}

/// Measures one pose. `positions` are the skinned vertices of the card mesh, `uvs` its `UV_0`. Cards whose vertices are not
/// there are left out.
pub fn overlaps(
    cards: &[Card],
    geometry: &[CardGeometry],
    positions: &[Vec3],
    uvs: &[[f32; 2]],
) -> Overlaps {
    let sheets: Vec<Option<Sheet>> = geometry
        .iter()
        .map(|place| {
            let range =
                place.first_vertex as usize..(place.first_vertex + place.vertex_count) as usize;
            let points = positions.get(range.clone())?;
            let uvs = uvs.get(range)?;
            let wide = uvs.iter().take_while(|uv| uv[1] == 0.0).count();
            let rows = points.len() / wide.max(1);
            (wide >= 2 && rows >= 2).then_some(Sheet { points, wide, rows })
        })
        .collect();
    let mut samples: Vec<(u32, Vec3, Vec3)> = Vec::with_capacity(sheets.len() * 15);
    for (number, sheet) in sheets.iter().enumerate() {
        let Some(sheet) = sheet else { continue };
        for v in ALONG {
            let wide = blade(v);
            let (left, right) = (sheet.place(-wide, v), sheet.place(wide, v));
            let along = sheet.place(0.0, v + 0.03) - sheet.place(0.0, v - 0.03);
            let normal = (right - left).cross(along).normalize_or_zero();
            let across: &[f32] = if v > 0.9 { &[0.0] } else { &ACROSS };
            for x in across {
                samples.push((number as u32, sheet.place(x * wide, v), normal));
            }
        }
    }
    let places: Vec<Vec3> = samples.iter().map(|sample| sample.1).collect();
    let mut widths: Vec<f32> = cards.iter().map(|card| card.width).collect();
    widths.sort_by(f32::total_cmp);
    let median = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    let grid = PointGrid::of(&places, median);
    let mut list: Vec<Overlap> = Vec::new();
    let mut near: Vec<u32> = Vec::new();
    for (number, place, normal) in &samples {
        let Some(card) = cards.get(*number as usize) else {
            continue;
        };
        near.clear();
        // Samples stand a fifth of a length apart: another feather under this place has one within this distance.
        grid.near(*place, 0.75 * card.width.max(median), |j| {
            near.push(samples[j as usize].0)
        });
        near.sort_unstable();
        near.dedup();
        for &other in near.iter().filter(|other| *other != number) {
            let (Some(sheet), Some(under)) = (&sheets[other as usize], cards.get(other as usize))
            else {
                continue;
            };
            let reach = REACH * card.width.min(under.width);
            let Some(height) = sheet.height(*place, *normal, reach) else {
                continue;
            };
            let above = (card.layer, *number) > (under.layer, other);
            let (upper, lower, depth) = if above {
                (*number, other, -height)
            } else {
                (other, *number, height)
            };
            list.push(Overlap {
                upper,
                lower,
                depth,
                place: *place,
            });
        }
    }
    list.sort_by(|a, b| {
        (a.upper, a.lower)
            .cmp(&(b.upper, b.lower))
            .then(b.depth.total_cmp(&a.depth))
    });
    list.dedup_by_key(|pair| (pair.upper, pair.lower));
    Overlaps { list }
}
