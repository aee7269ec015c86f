//! Small pictures of a posed coat: every feather at a pixel that lies near the nearest.

use super::{
    carried::{Carried, Spot},
    contact::{Stands, blade},
    leaf::Leaf,
};
use bevy::math::{Vec2, Vec3, Vec4};

/// How far behind the nearest a feather may lie that should cover it, widths of the narrower.
pub const REACH: f32 = 0.5;
/// How far below its upper a feather is held there, widths of the narrower.
pub const HELD: f32 = 0.1;
/// Side of a pixel, median widths, and pixels along a side at most.
const PIXEL: f32 = 0.2;
const PIXELS: f32 = 400.0;
/// Cosine between a face and the eye, below which it is seen edge-on.
const STEEP: f32 = 0.12;

/// A feather at a pixel.
#[derive(Clone, Copy)]
pub struct Fragment {
    /// Number of the pixel.
    pub pixel: u32,
    /// Height towards the eye, metres.
    pub near: f32,
    /// Which feather.
    pub leaf: u32,
    /// Normal of the front times the direction to the eye.
    pub facing: f32,
    /// Corners of the triangle and the shares of the first two.
    pub corners: [u32; 3],
    shares: [f32; 2],
}

impl Fragment {
    /// The place.
    pub fn spot(&self) -> Spot {
        let ([a, b, c], [u, v]) = (self.corners, self.shares);
        [(a, u), (b, v), (c, 1.0 - u - v)]
    }
}

/// A triangle of a feather, in the square of the mesh that begins at row and column `at`.
struct Triangle {
    corners: [u32; 3],
    leaf: u32,
    normal: Vec3,
    at: [f32; 2],
    /// Squares of the feather along and across.
    squares: [f32; 2],
    /// Whether its corners are (i, j), (i + 1, j + 1), (i + 1, j); else (i, j), (i, j + 1), (i + 1, j + 1).
    upper: bool,
}

impl Triangle {
    /// Whether a place of it lies within the blade.
    fn has(&self, u: f32, v: f32) -> bool {
        let w = 1.0 - u - v;
        let (x, y) = if self.upper { (v, v + w) } else { (v + w, w) };
        let across = 2.0 * (self.at[1] + x) / self.squares[1] - 1.0;
        across.abs() <= blade((self.at[0] + y) / self.squares[0])
    }
}

/// A place on a triangle, at a pixel.
struct Hit {
    pixel: u32,
    near: f32,
    triangle: u32,
    shares: [f32; 2],
}

/// What a picture shows.
pub struct Picture {
    /// Fragments that lie near the nearest of their pixel, pixel by pixel, the nearest first.
    pub seen: Vec<Fragment>,
    /// Fragments not far behind the body at pixels that show it; `near`: how far behind.
    pub behind: Vec<Fragment>,
}

/// A coat that pictures are taken of.
pub struct Drawing {
    /// How its feathers stand.
    pub stands: Stands,
    points: Vec<Vec3>,
    triangles: Vec<Triangle>,
    median: f32,
}

impl Drawing {
    /// Of leaves with these heights.
    pub fn new(leaves: &[Leaf], carried: &Carried, heights: &[f32]) -> Self {
        let points = carried.raised(heights);
        let mut triangles = Vec::with_capacity(2 * points.len());
        for (leaf, block) in carried.blocks.iter().enumerate() {
            let squares = [(block.rows - 1) as f32, (block.wide - 1) as f32];
            for (i, j) in block.quads() {
                for (corners, upper) in block.triangles(i, j).into_iter().zip([false, true]) {
                    let [p, q, r] = corners.map(|k| points[k as usize]);
                    triangles.push(Triangle {
                        corners,
                        leaf: leaf as u32,
                        normal: (q - p).cross(r - p).normalize_or_zero(),
                        at: [i as f32, j as f32],
                        squares,
                        upper,
                    });
                }
            }
        }
        Self {
            stands: Stands::new(leaves, carried, &points),
            points,
            triangles,
            median: carried.median,
        }
    }

    /// A picture. `eye`: direction to it; `body`: triangles that hide what lies behind them.
    pub fn picture(&self, eye: Vec3, body: &[[Vec3; 3]]) -> Picture {
        let frame = Frame::new(eye, &self.points, self.median);
        let count = frame.wide * frame.high;
        let mut wall = vec![f32::NEG_INFINITY; count];
        for corners in body {
            let at = corners.map(|p| frame.project(p));
            frame.cover(&at, |pixel, near, _| {
                wall[pixel] = wall[pixel].max(near);
            });
        }
        let mut nearest = wall.clone();
        let projected: Vec<Vec3> = self.points.iter().map(|p| frame.project(*p)).collect();
        let (mut hits, mut behind) = (Vec::new(), Vec::new());
        for (number, triangle) in self.triangles.iter().enumerate() {
            if triangle.normal.dot(eye).abs() < STEEP {
                continue;
            }
            let [a, b, c] = triangle.corners;
            let at = [
                projected[a as usize],
                projected[b as usize],
                projected[c as usize],
            ];
            let reach = self.reach(triangle.leaf);
            frame.cover(&at, |pixel, near, [u, v]| {
                // The nearest of all is no further away than the nearest so far.
                if nearest[pixel] - near < reach && triangle.has(u, v) {
                    let hit = Hit {
                        pixel: pixel as u32,
                        near,
                        triangle: number as u32,
                        shares: [u, v],
                    };
                    if near > wall[pixel] {
                        nearest[pixel] = nearest[pixel].max(near);
                        hits.push(hit);
                    } else {
                        behind.push(hit);
                    }
                }
            });
        }
        let shows_body = |hit: &&Hit| nearest[hit.pixel as usize] == wall[hit.pixel as usize];
        let behind = behind.iter().filter(shows_body).map(|hit| Fragment {
            near: wall[hit.pixel as usize] - hit.near,
            ..self.fragment(hit, eye)
        });
        Picture {
            behind: behind.collect(),
            seen: self.sorted(hits, eye, &nearest),
        }
    }

    fn fragment(&self, hit: &Hit, eye: Vec3) -> Fragment {
        let triangle = &self.triangles[hit.triangle as usize];
        Fragment {
            pixel: hit.pixel,
            near: hit.near,
            leaf: triangle.leaf,
            facing: triangle.normal.dot(eye),
            corners: triangle.corners,
            shares: hit.shares,
        }
    }

    /// How far behind the nearest a feather is kept.
    fn reach(&self, leaf: u32) -> f32 {
        (REACH + HELD) * self.stands.of(leaf).width
    }

    fn sorted(&self, mut hits: Vec<Hit>, eye: Vec3, nearest: &[f32]) -> Vec<Fragment> {
        hits.retain(|hit| {
            let leaf = self.triangles[hit.triangle as usize].leaf;
            nearest[hit.pixel as usize] - hit.near < self.reach(leaf)
        });
        let mut ends = vec![0_u32; nearest.len()];
        for hit in &hits {
            ends[hit.pixel as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            // Where the pixel begins; once all its hits are in, where it ends.
            sum += std::mem::replace(end, sum);
        }
        let mut order = vec![0_u32; hits.len()];
        for (number, hit) in hits.iter().enumerate() {
            let end = &mut ends[hit.pixel as usize];
            order[*end as usize] = number as u32;
            *end += 1;
        }
        let mut fragments: Vec<Fragment> = Vec::with_capacity(hits.len());
        for number in order {
            let fragment = self.fragment(&hits[number as usize], eye);
            // Pixels hold few: each fragment sinks to its place.
            let mut to = fragments.len();
            fragments.push(fragment);
            while to > 0 && before(&fragment, &fragments[to - 1]) {
                fragments[to] = fragments[to - 1];
                to -= 1;
            }
            fragments[to] = fragment;
        }
        fragments
    }
}

/// Whether a fragment comes before the other: nearer, or of a lower number.
fn before(a: &Fragment, b: &Fragment) -> bool {
    a.pixel == b.pixel && b.near.total_cmp(&a.near).then(a.leaf.cmp(&b.leaf)).is_lt()
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
    fn cover(&self, [a, b, c]: &[Vec3; 3], mut visit: impl FnMut(usize, f32, [f32; 2])) {
        let (a, b, c) = (*a, *b, *c);
        let low = a.min(b).min(c).max(Vec3::ZERO);
        let last = Vec3::new(
            self.wide as f32 - 1.0,
            self.high as f32 - 1.0,
            f32::INFINITY,
        );
        let high = a.max(b).max(c).min(last);
        // Not `!(low <= high)` alone: columns and rows are not to be looked for beside the picture.
        if !(low.x <= high.x && low.y <= high.y) {
            return;
        }
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area.abs() < 1.0e-9 || !area.is_finite() {
            return;
        }
        let over = 1.0 / area;
        let (of_u, of_v) = ((b - c).truncate() * over, (c - a).truncate() * over);
        let (from, end) = (up(low.x), high.x as usize + 1);
        let (mut y, bottom) = (up(low.y), high.y as usize + 1);
        let lanes = Vec4::new(0.0, 1.0, 2.0, 3.0);
        let right = Vec4::splat(high.x);
        let [u_y, v_y] = [of_u.y, of_v.y].map(Vec4::splat);
        let [cx, ax] = [c.x, a.x].map(Vec4::splat);
        // Loops without iterators: this is most of what settling does.
        while y < bottom {
            let row = y as f32;
            let u_x = Vec4::splat(of_u.x * (c.y - row));
            let v_x = Vec4::splat(of_v.x * (a.y - row));
            let mut x = from;
            while x < end {
                let column = Vec4::splat(x as f32) + lanes;
                let u = u_x - u_y * (cx - column);
                let v = v_x - v_y * (ax - column);
                let w = Vec4::ONE - u - v;
                let within = u.min(v).min(w).cmpge(Vec4::ZERO) & column.cmple(right);
                let mut hits = within.bitmask();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    let (u, v, w) = (u[lane], v[lane], w[lane]);
                    let near = a.z * u + b.z * v + c.z * w;
                    visit(y * self.wide + x + lane, near, [u, v]);
                }
                x += 4;
            }
            y += 1;
        }
    }
}

/// The next whole number, of a number not below 0.
fn up(x: f32) -> usize {
    let whole = x as usize;
    whole + usize::from((whole as f32) < x)
}
