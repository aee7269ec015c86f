//! Footprints cut by straight lines: at the rachis, at the outline.
//!
//! What a line leaves of a Gaussian is no Gaussian, and one of the same moments is off by up to 0.06 where barbs are resolved. The
//! smaller side, a tail of the Gaussian, is replaced by three Gaussians that grow with the distance from the line (their masses,
//! means and deviations were fitted to tails from 0 to 2.5 sigmas, docs/book/fits/tail_mixture.py; mean and variance are exact).
//! The larger side is the whole footprint less the smaller one, over the same pattern carried on beyond the line. Twin of
//! `query_split.wgsl`.

use super::{choose::PARTS_MARGIN, vane::Local};
use crate::maths::{
    footprint::Footprint,
    functions::{Real, clamp, normal_density, normal_distribution, normal_share},
};

/// A share of a footprint, as a Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part<T> {
    /// Its share; negative where it is taken away from a part before it.
    pub mass: T,
    /// Its shape.
    pub footprint: Footprint<T>,
}

/// Most parts on one side of a line.
pub const PARTS: usize = 4;
/// A line that cuts off less than what lies beyond this many sigmas leaves one part on either side.
const TAIL_SIGMAS: f64 = 2.5;
/// Beyond this many sigmas a line leaves all or nothing.
const FAR_SIGMAS: f64 = 4.0;

/// The three Gaussians of a tail beyond `z` (0..2.5 sigmas), whose mean distance from the line is `reach`: mass, mean and
/// deviation of each, the last two in units of `reach`.
fn tail<T: Real>(z: T, reach: T) -> [[T; 3]; 3] {
    let line = |a: f64, b: f64| T::of(a) + T::of(b) * z;
    let one = T::one();
    let (w0, w1) = (line(0.143, 0.01), line(0.366, 0.0125));
    let (m0, m1) = (line(0.16, -0.008), line(0.608, -0.0145));
    let (s0, s1) = (line(0.117, -0.004), line(0.331, -0.0015));
    let w2 = one - w0 - w1;
    let m2 = (one - w0 * m0 - w1 * m1) / w2;
    let square = (one - z * reach) / (reach * reach);
    let rest = (square - w0 * (m0 * m0 + s0 * s0) - w1 * (m1 * m1 + s1 * s1)) / w2 - m2 * m2;
    let s2 = clamp(rest, T::of(0.1), T::of(2.0)).sqrt();
    [[w0, m0, s0], [w1, m1, s1], [w2, m2, s2]]
}

/// The half plane `offset + gradient . x >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<T> {
    /// Value at the origin.
    pub offset: T,
    /// Its gradient, any length but 0.
    pub gradient: [T; 2],
}

/// A footprint and the line that cuts it, in sigmas from its mean along `carry`; `parts` of it are left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCut<T> {
    footprint: Footprint<T>,
    carry: [T; 2],
    line: T,
    /// How many parts [`line_part`] gives, 0..=[`PARTS`].
    pub parts: usize,
}

/// Value of a line at a point.
pub fn line_at<T: Real>(line: &Line<T>, [x, y]: [T; 2]) -> T {
    line.offset + (line.gradient[0] * x + line.gradient[1] * y)
}

fn covariance_times<T: Real>([xx, xy, yy]: [T; 3], [x, y]: [T; 2]) -> [T; 2] {
    [xx * x + xy * y, xy * x + yy * y]
}

/// Share of a footprint inside a line.
pub fn line_share<T: Real>(line: &Line<T>, f: &Footprint<T>) -> T {
    let along = covariance_times(f.covariance, line.gradient);
    let variance = line.gradient[0] * along[0] + line.gradient[1] * along[1];
    normal_share(line_at(line, f.mean) / variance.max(T::of(1e-30)).sqrt())
}

/// Prepares the parts of a footprint inside a line; their masses sum to its share. `resolved`: up to four of them, else one of the
/// same mean and covariance, which is enough where averages serve.
pub fn split_line<T: Real>(f: &Footprint<T>, line: &Line<T>, resolved: bool) -> LineCut<T> {
    let along = covariance_times(f.covariance, line.gradient);
    let variance = line.gradient[0] * along[0] + line.gradient[1] * along[1];
    let sigma = variance.max(T::of(1e-30)).sqrt();
    let far = T::of(FAR_SIGMAS);
    // What is kept lies above it.
    let at = clamp(-line_at(line, f.mean) / sigma, -far, far);
    let parts = if at >= far {
        0
    } else if at <= -far || !resolved || at.abs() > T::of(TAIL_SIGMAS) {
        1
    } else if at < T::zero() {
        PARTS
    } else {
        PARTS - 1
    };
    LineCut {
        footprint: *f,
        carry: along.map(|c| c / sigma),
        line: at,
        parts,
    }
}

/// The part with this mean and variance along the gradient, in sigmas.
fn moved_part<T: Real>(cut: &LineCut<T>, mass: T, mean: T, variance: T) -> Part<T> {
    let less = T::one() - variance;
    let f = &cut.footprint;
    let [xx, xy, yy] = f.covariance;
    let [x, y] = cut.carry;
    Part {
        mass,
        footprint: Footprint {
            mean: [f.mean[0] + x * mean, f.mean[1] + y * mean],
            covariance: [xx - x * x * less, xy - x * y * less, yy - y * y * less],
        },
    }
}

/// Part `index` of a cut footprint, below `parts`.
pub fn line_part<T: Real>(cut: &LineCut<T>, index: usize) -> Part<T> {
    let one = T::one();
    if cut.line <= -T::of(FAR_SIGMAS) || (cut.parts == PARTS && index == 0) {
        return Part {
            mass: one,
            footprint: cut.footprint,
        };
    }
    if cut.parts <= 1 {
        let mass = normal_share(-cut.line);
        let ratio = normal_density(cut.line) / mass.max(T::of(1e-6));
        let variance = clamp(one + cut.line * ratio - ratio * ratio, T::of(0.02), one);
        return moved_part(cut, mass, ratio, variance);
    }
    let z = cut.line.abs();
    let beyond = normal_distribution(-z);
    let reach = normal_density(z) / beyond - z;
    let inside_out = cut.parts == PARTS;
    let i = if inside_out { index - 1 } else { index };
    let [mass, mean, deviation] = tail(z, reach)[i.min(2)];
    let (mean, spread) = (z + mean * reach, deviation * reach);
    if inside_out {
        moved_part(cut, -mass * beyond, -mean, spread * spread)
    } else {
        moved_part(cut, mass * beyond, mean, spread * spread)
    }
}

/// All parts of a footprint inside a line.
pub fn line_parts<T: Real>(cut: &LineCut<T>) -> impl Iterator<Item = Part<T>> {
    (0..cut.parts).map(|index| line_part(cut, index))
}

/// The line of the rachis over the left vane: `x < edge`.
pub fn rachis_line<T: Real>(edge: T) -> Line<T> {
    Line {
        offset: edge,
        gradient: [-T::one(), T::zero()],
    }
}

/// Share of a footprint that the rachis hides; `edges` from [`mask_rachis`](super::mask_rachis).
pub fn rachis_share<T: Real>(f: &Footprint<T>, edges: [T; 2]) -> T {
    let left = line_share(&rachis_line(edges[0].min(edges[1])), f);
    let right = Line {
        offset: -edges[0].max(edges[1]),
        gradient: [T::one(), T::zero()],
    };
    clamp(T::one() - left - line_share(&right, f), T::zero(), T::one())
}

/// Whether the average serves not only a footprint but what a line leaves of it, too.
pub fn averages<T: Real>(local: &Local<T>, threshold: T) -> bool {
    local.variance.min(local.conditional) > T::of(PARTS_MARGIN) * threshold
}

/// The outline near a footprint over the left vane, to first order: `reach` is the contour and its derivative at the root of the
/// barb through `mean`, `cotangent` of the angle of the barbs.
pub fn outline_line<T: Real>(mean: [T; 2], reach: [T; 2], cotangent: T) -> Line<T> {
    let gradient = [T::one() + reach[1] * cotangent, reach[1]];
    Line {
        offset: reach[0] + mean[0] - (gradient[0] * mean[0] + gradient[1] * mean[1]),
        gradient,
    }
}

/// Most places at which the outline is looked up.
pub const MAX_OUTLINE_NODES: u32 = 16;

/// How a footprint sees an outline that is stored by the roots of the barbs: where to look it up, `count` times.
///
/// A split of the outline may be narrower than the footprint, so the outline is looked up along the roots, about every other
/// value, and is a line at each of them only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineSight<T> {
    /// Root through the mean.
    root: T,
    /// Deviation of the root.
    sigma: T,
    /// Distance from the rachis at the mean.
    inset: T,
    /// Slope of that distance on the root.
    slope: T,
    /// Variance that is left of it.
    rest: T,
    /// Number of nodes, 1 or 8..=[`MAX_OUTLINE_NODES`].
    pub count: u32,
}

/// `cotangent` of the angle of the barbs; `spacing` of the stored values.
pub fn outline_sight<T: Real>(f: &Footprint<T>, cotangent: T, spacing: T) -> OutlineSight<T> {
    let [xx, xy, yy] = f.covariance;
    let variance = (cotangent * (cotangent * xx + xy + xy) + yy).max(T::of(1e-20));
    let sigma = variance.sqrt();
    let slope = -(cotangent * xx + xy) / variance;
    let count = if sigma >= T::of(0.2) * spacing {
        let most = T::of(f64::from(MAX_OUTLINE_NODES));
        let count = clamp((T::of(3.3) * sigma / spacing).ceil(), T::of(8.0), most);
        count.to_u32().unwrap_or(MAX_OUTLINE_NODES)
    } else {
        1
    };
    OutlineSight {
        root: f.mean[1] + f.mean[0] * cotangent,
        sigma,
        inset: -f.mean[0],
        slope,
        rest: (xx - slope * slope * variance).max(T::of(1e-20)),
        count,
    }
}

/// Place of node `i` in sigmas of the root.
fn outline_place<T: Real>(sight: &OutlineSight<T>, i: u32) -> T {
    if sight.count == 1 {
        return T::zero();
    }
    let count = T::of(f64::from(sight.count));
    (T::of(f64::from(i)) + T::of(0.5)) * T::of(6.0) / count - T::of(3.0)
}

/// Root at which node `i` looks the outline up.
pub fn outline_root<T: Real>(sight: &OutlineSight<T>, i: u32) -> T {
    sight.root + outline_place(sight, i) * sight.sigma
}

/// Of node `i`: what of it lies on this vane's side of the shaft, and what of that lies inside, both weighted; `reach` and its
/// derivative there. The sum of the second over that of the first is the vane's share inside. A footprint may span both vanes, and the
/// barbs of this one, carried on beyond the shaft, have no end there.
pub fn outline_node<T: Real>(sight: &OutlineSight<T>, i: u32, reach: [T; 2]) -> [T; 2] {
    let t = outline_place(sight, i);
    let step = T::of(6.0) / T::of(f64::from(sight.count));
    let width = if sight.count == 1 {
        T::one()
    } else {
        step * step * T::of(1.0 / 12.0)
    };
    let distance = sight.inset + sight.slope * t * sight.sigma;
    let steep = (reach[1] - sight.slope) * sight.sigma;
    let deviation = (sight.rest + steep * steep * width).sqrt();
    let beyond = normal_share(-distance / deviation);
    let inside = (normal_share((reach[0] - distance) / deviation) - beyond).max(T::zero());
    let weight = normal_density(t);
    [weight * (T::one() - beyond), weight * inside]
}

/// Of a Gaussian, what lies beyond a line 1.75 deviations from its middle.
const BEYOND_END: f64 = 0.04;

/// Share of a pixel inside an outline, from that of its footprint: a Gaussian never ends, and where a feather is seen edge on, three of a
/// hundred parts of it, a pixel beyond the tip, are dots. So it ends 1.75 deviations, seven eighths of a pixel, from its middle. What is
/// lost outside of a straight outline is won inside. Shaders ask it of near feathers; queries on the processor see the whole Gaussian.
pub fn ended_share<T: Real>(share: T) -> T {
    let scale = T::of(1.0 / (1.0 - 2.0 * BEYOND_END));
    clamp((share - T::of(BEYOND_END)) * scale, T::zero(), T::one())
}

/// Share inside an outline of what of a footprint lies on the left vane's side of the shaft: `reach` gives how far the barb from a root
/// reaches along x, and the derivative. A shader, which has no closures, loops over the nodes where its table is bound (`feather_cover.wgsl`).
pub fn outline_share<T: Real>(
    f: &Footprint<T>,
    cotangent: T,
    spacing: T,
    reach: impl Fn(T) -> [T; 2],
) -> T {
    let sight = outline_sight(f, cotangent, spacing);
    let [mut total, mut sum] = [T::zero(); 2];
    for i in 0..sight.count {
        let [weight, share] = outline_node(&sight, i, reach(outline_root(&sight, i)));
        total = total + weight;
        sum = sum + share;
    }
    sum / total.max(T::of(1e-9))
}
