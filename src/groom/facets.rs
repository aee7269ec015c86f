//! The triangles of feathers, four by four, and where places project to on them.

use super::carried::{Block, Spot};
use bevy::math::{Vec3, Vec4};
use std::ops::Range;

/// Four triangles, lane by lane. Those without an area, and lanes that are left over, have no normal and are never hit.
#[derive(Clone, Copy, Default)]
struct Facets {
    corner: [Vec4; 3],
    /// Unit normal.
    normal: [Vec4; 3],
    /// The shares of the second and of the third corner at a place, for its offset from the first.
    shares: [[Vec4; 3]; 2],
}

fn dot(a: &[Vec4; 3], b: &[Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn splat(v: Vec3) -> [Vec4; 3] {
    v.to_array().map(Vec4::splat)
}

impl Facets {
    fn set(&mut self, lane: usize, [p, q, r]: [Vec3; 3]) {
        let cross = (q - p).cross(r - p);
        let area = cross.length_squared();
        if area.is_nan() || area < 1.0e-30 {
            return;
        }
        let [v, w] = [p - r, q - p].map(|edge| cross.cross(edge) / area);
        let normal = cross / area.sqrt();
        let [own_v, own_w] = &mut self.shares;
        for (list, value) in [
            (&mut self.corner, p),
            (&mut self.normal, normal),
            (own_v, v),
            (own_w, w),
        ] {
            for (part, x) in list.iter_mut().zip(value.to_array()) {
                part[lane] = x;
            }
        }
    }
}

/// The triangles of all feathers of a coat.
pub struct Vanes<'a> {
    blocks: &'a [Block],
    /// Four triangles each: those of the quads between two rows of a feather, one after the other.
    facets: Vec<Facets>,
    /// First of each feather.
    firsts: Vec<u32>,
}

/// How many fours the triangles between two rows of vertices take.
fn fours(block: &Block) -> usize {
    (2 * (block.wide - 1)).div_ceil(4)
}

impl<'a> Vanes<'a> {
    /// Of feathers whose vertices are at these points.
    pub fn new(blocks: &'a [Block], points: &[Vec3]) -> Self {
        let (mut facets, mut firsts) = (Vec::new(), Vec::with_capacity(blocks.len()));
        for block in blocks {
            let first = facets.len();
            let last = block.rows.saturating_sub(1);
            firsts.push(first as u32);
            facets.resize(first + last * fours(block), Facets::default());
            for (i, j) in block.quads_in(0..last) {
                for (number, corners) in block.triangles(i, j).into_iter().enumerate() {
                    let at = 2 * j + number;
                    let corners = corners.map(|corner| points[corner as usize]);
                    facets[first + i * fours(block) + at / 4].set(at % 4, corners);
                }
            }
        }
        Self {
            blocks,
            facets,
            firsts,
        }
    }

    /// Where on a feather, between these rows of its vertices, a place projects to, and its height over it: the nearest of several, no
    /// further than `reach`. Only triangles that face the way of `normal`.
    pub fn project(
        &self,
        place: Vec3,
        normal: Vec3,
        leaf: u32,
        rows: Range<usize>,
        reach: f32,
    ) -> Option<(Spot, f32)> {
        let block = &self.blocks[leaf as usize];
        let fours = fours(block);
        let first = self.firsts[leaf as usize] as usize;
        let (point, normal) = (splat(place), splat(normal));
        let most = Vec4::splat(reach);
        let mut best: Option<(usize, [f32; 3], f32)> = None;
        for (four, facets) in self.facets[first + rows.start * fours..first + rows.end * fours]
            .iter()
            .enumerate()
        {
            let offset = [
                point[0] - facets.corner[0],
                point[1] - facets.corner[1],
                point[2] - facets.corner[2],
            ];
            let height = dot(&offset, &facets.normal);
            let near = height.abs().cmple(most) & dot(&facets.normal, &normal).cmpgt(Vec4::ZERO);
            if near.bitmask() == 0 {
                continue;
            }
            let v = dot(&facets.shares[0], &offset);
            let w = dot(&facets.shares[1], &offset);
            let u = Vec4::ONE - v - w;
            let within = u.cmpge(Vec4::ZERO) & v.cmpge(Vec4::ZERO) & w.cmpge(Vec4::ZERO);
            let mut hits = (near & within).bitmask();
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                if best.is_none_or(|(.., known)| height[lane].abs() < known.abs()) {
                    let shares = [u[lane], v[lane], w[lane]];
                    best = Some((4 * four + lane, shares, height[lane]));
                }
            }
        }
        let (at, [u, v, w], height) = best?;
        let (i, at) = (rows.start + at / (4 * fours), at % (4 * fours));
        let [p, q, r] = block.triangles(i, at / 2)[at % 2];
        Some(([(p, u), (q, v), (r, w)], height))
    }
}
