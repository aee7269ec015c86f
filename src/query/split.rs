//! Footprints cut by straight lines: at the rachis, at the outline.
//!
//! What a line leaves of a Gaussian is no Gaussian, and one of the same moments is off by up to 0.06 where barbs are resolved. The
//! smaller side, a tail of the Gaussian, is replaced by three Gaussians that grow with the distance from the line (their masses,
//! means and deviations were fitted to tails from 0 to 2.5 sigmas; mean and variance are exact). The larger side is the whole
//! footprint less the smaller one, over the same pattern carried on beyond the line.

use super::{
    footprint::Footprint,
    math::{Real, clamp, normal_density, normal_distribution},
};

/// A share of a footprint, as a Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part<T> {
    /// Its share; negative where it is taken away from a part before it, 0 for none.
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

/// What of a footprint lies on the positive side of the line `distance + gradient . (x - mean) = 0`. The masses sum to its share.
/// `resolved`: in up to four parts; else in one of the same mean and covariance, which is enough where averages serve.
pub fn split_line<T: Real>(
    f: &Footprint<T>,
    distance: T,
    gradient: [T; 2],
    resolved: bool,
) -> [Part<T>; PARTS] {
    let [xx, xy, yy] = f.covariance;
    let [gx, gy] = gradient;
    let one = T::one();
    let along = [xx * gx + xy * gy, xy * gx + yy * gy];
    let sigma = (gx * along[0] + gy * along[1]).max(T::of(1e-30)).sqrt();
    let [cx, cy] = along.map(|c| c / sigma);
    let whole = Part {
        mass: one,
        footprint: *f,
    };
    let none = Part {
        mass: T::zero(),
        ..whole
    };
    // The part with this mean and variance along the gradient, in sigmas.
    let part = |mass: T, mean: T, variance: T| {
        let less = one - variance;
        Part {
            mass,
            footprint: Footprint {
                mean: [f.mean[0] + cx * mean, f.mean[1] + cy * mean],
                covariance: [
                    xx - cx * cx * less,
                    xy - cx * cy * less,
                    yy - cy * cy * less,
                ],
            },
        }
    };
    let far = T::of(FAR_SIGMAS);
    // The line in sigmas from the mean; what is kept lies above it.
    let line = clamp(-distance / sigma, -far, far);
    if line <= -far {
        return [whole, none, none, none];
    }
    if line >= far {
        return [none; PARTS];
    }
    let z = line.abs();
    let cut = normal_distribution(-z);
    if z > T::of(TAIL_SIGMAS) || !resolved {
        let mass = normal_distribution(-line);
        let ratio = normal_density(line) / mass.max(T::of(1e-6));
        let variance = clamp(one + line * ratio - ratio * ratio, T::of(0.02), one);
        return [part(mass, ratio, variance), none, none, none];
    }
    let reach = normal_density(z) / cut - z;
    let [a, b, c] = tail(z, reach).map(|[mass, mean, deviation]| {
        let (at, spread) = (z + mean * reach, deviation * reach);
        if line < T::zero() {
            part(-mass * cut, -at, spread * spread)
        } else {
            part(mass * cut, at, spread * spread)
        }
    });
    if line < T::zero() {
        [whole, a, b, c]
    } else {
        [a, b, c, none]
    }
}

/// The half plane `offset + gradient . x >= 0`, to which a vane is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<T> {
    /// Value at the origin.
    pub offset: T,
    /// Its gradient, any length but 0.
    pub gradient: [T; 2],
}

impl<T: Real> Line<T> {
    /// Value at a point.
    pub fn at(&self, [x, y]: [T; 2]) -> T {
        self.offset + self.gradient[0] * x + self.gradient[1] * y
    }

    /// Share of a footprint inside.
    pub fn share(&self, f: &Footprint<T>) -> T {
        let [gx, gy] = self.gradient;
        let [xx, xy, yy] = f.covariance;
        let variance = gx * gx * xx + T::of(2.0) * gx * gy * xy + gy * gy * yy;
        normal_distribution(self.at(f.mean) / variance.max(T::of(1e-30)).sqrt())
    }
}

/// Where a vane ends, as a footprint sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline<T> {
    /// Tangent at the root of the barb through the footprint's mean.
    pub line: Line<T>,
    /// Share of the footprint inside, see [`outline_share`].
    pub share: T,
}

/// Most places at which the outline is looked up.
pub const MAX_OUTLINE_NODES: i32 = 16;

/// Share of a footprint over the left vane inside an outline that is stored by the roots of the barbs: `reach` gives how far the
/// barb from a root reaches along x, and the derivative. `cotangent` of the barbs' angle; `spacing` of the stored values.
///
/// A split of the outline may be narrower than the footprint, so the outline is looked up along the roots, about every other
/// value, and is a line at each of them only.
pub fn outline_share<T: Real>(
    f: &Footprint<T>,
    cotangent: T,
    spacing: T,
    reach: impl Fn(T) -> [T; 2],
) -> T {
    let [xx, xy, yy] = f.covariance;
    let [x, y] = f.mean;
    let variance = (cotangent * (cotangent * xx + xy + xy) + yy).max(T::of(1e-20));
    let sigma = variance.sqrt();
    // Of the distance from the rachis on the root, and what is left of its variance.
    let slope = -(cotangent * xx + xy) / variance;
    let rest = (xx - slope * slope * variance).max(T::of(1e-20));
    let root = y + x * cotangent;
    let share = |t: T, width: T| {
        let [reach, steepness] = reach(root + t * sigma);
        let spread = rest + (steepness - slope) * (steepness - slope) * width * variance;
        normal_distribution((reach + x - slope * t * sigma) / spread.sqrt())
    };
    if sigma < T::of(0.2) * spacing {
        return share(T::zero(), T::one());
    }
    let most = T::of(f64::from(MAX_OUTLINE_NODES));
    let count = clamp((T::of(3.3) * sigma / spacing).ceil(), T::of(8.0), most);
    let step = T::of(6.0) / count;
    let (mut sum, mut total) = (T::zero(), T::zero());
    for i in 0..count.to_i32().unwrap_or(1) {
        let t = (T::of(f64::from(i)) + T::of(0.5)) * step - T::of(3.0);
        let weight = normal_density(t);
        sum = sum + weight * share(t, step * step * T::of(1.0 / 12.0));
        total = total + weight;
    }
    sum / total
}

/// What of a footprint over the left vane lies at `x < edge` (the rachis) and, if given, inside the outline. The one of the
/// two lines that takes more of it cuts it into parts, the other scales them.
pub fn split_vane<T: Real>(
    f: &Footprint<T>,
    edge: T,
    outline: Option<Outline<T>>,
    resolved: bool,
) -> [Part<T>; PARTS] {
    let rachis = Line {
        offset: edge,
        gradient: [-T::one(), T::zero()],
    };
    let Some(Outline { line, share }) = outline else {
        return split_line(f, rachis.at(f.mean), rachis.gradient, resolved);
    };
    let straight = line.share(f);
    // Scaled to the true share; where the tangent tells too little of it, the outline scales the whole.
    let scale = share / straight.max(T::of(1e-6));
    if scale > T::of(2.0) || scale < T::of(0.5) {
        return split_line(f, rachis.at(f.mean), rachis.gradient, resolved).map(|part| Part {
            mass: part.mass * share,
            ..part
        });
    }
    let (first, second) = if straight < rachis.share(f) {
        (line, rachis)
    } else {
        (rachis, line)
    };
    split_line(f, first.at(f.mean), first.gradient, resolved).map(|part| Part {
        mass: part.mass * scale * second.share(&part.footprint),
        ..part
    })
}
