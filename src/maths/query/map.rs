//! How distant footprints look at an outline: in a map of the card that is averaged beforehand. Twin of `query_map.wgsl`.
//!
//! Texels of the map hold the share of their square inside the outline; each further level averages four. A look between texels and
//! levels weighs what lies around by a kernel of a known width, and a footprint is a row of such looks along its longer axis.

use crate::maths::functions::{Real, clamp, real};

/// Texels of the map's first level, across and along the card.
pub const MAP_SIZE: [u32; 2] = [64, 128];
/// Last level of the map, 2 by 4 texels.
pub const LAST_MAP_LEVEL: u32 = 5;
/// Texels of them beyond each edge of the card.
pub const MAP_MARGIN: u32 = 4;
/// Most looks for one footprint.
pub const MAX_MAP_LOOKS: u32 = 16;
/// Least standard deviation of a footprint along its shorter axis, in texels, for which the map serves; finer ones see its squares.
pub const FINEST_MAP_SIGMA: f64 = 0.4;

/// Deviations of a footprint, from its middle, beyond which nothing of it counts.
const WHOLE_SIGMAS: f64 = 2.5;
/// Share from which on all of a look counts as inside: maps hold steps of a 255th.
const WHOLE_SHARE: f64 = 0.999;

/// How a footprint looks at the map: `count` times, `step` apart (in coordinates of the map, 0..1), on a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSight<T> {
    /// From one look to the next.
    pub step: [T; 2],
    /// Level, 0 or more; not an integer. Where the map does not serve, the level of the look that may decide ([`map_decided`]).
    pub level: T,
    /// Number of looks, 1..=[`MAX_MAP_LOOKS`].
    pub count: u32,
    /// The map serves.
    pub serves: bool,
}

/// Place on the map of a point of the card, both 0..1 over their own edges.
pub fn map_place<T: Real>(uv: [T; 2]) -> [T; 2] {
    [0, 1].map(|i| {
        let (size, margin) = (T::of(MAP_SIZE[i].into()), T::of(MAP_MARGIN.into()));
        (uv[i] * (size - margin - margin) + margin) / size
    })
}

/// The level on which one look, linear between four texels, sees all texels within [`WHOLE_SIGMAS`] of a footprint's middle: it sees half a
/// texel to every side at least. `major`: variance along the longer axis, squared texels of the first level. Beyond [`LAST_MAP_LEVEL`] none
/// does.
fn whole_level<T: Real>(major: T) -> T {
    (T::of(2.0 * WHOLE_SIGMAS).log2() + T::of(0.5) * major.log2())
        .ceil()
        .max(T::zero())
}

/// What one look on the level of a [`MapSight`] says of a footprint for which the map does not serve: 1 where all around is inside the
/// outline, 0 where nothing is, else -1: the outline itself has to be asked.
pub fn map_decided<T: Real>(share: T, level: T) -> T {
    if level > T::of(LAST_MAP_LEVEL.into()) {
        -T::one()
    } else if share >= T::of(WHOLE_SHARE) {
        T::one()
    } else if share <= T::zero() {
        T::zero()
    } else {
        -T::one()
    }
}

/// How a pixel looks at the map whose derivatives of `uv` along both axes of the screen are these: a Gaussian with a standard deviation
/// of half a pixel, as [`canonical_footprint`](crate::maths::card::canonical_footprint).
///
/// A look on level `l` sees a square of `2^l` texels spread over its neighbours: variance `4^l / 4`. Looks of binomial weights a step
/// `h` apart add `h^2 (count - 1) / 4` along it. They are close enough where `h` is 3 of a look's own deviations (the ripples of their
/// sum are below 0.015 of an edge); footprints longer than 5.9 times their width are taken for wider ones.
pub fn map_sight<T: Real>(duv_dx: [T; 2], duv_dy: [T; 2]) -> MapSight<T> {
    let texels = [0, 1].map(|i| T::of(f64::from(MAP_SIZE[i] - 2 * MAP_MARGIN)));
    let (half, quarter, one) = (T::of(0.5), real::<T>(0.25), T::one());
    let [a, b] = [duv_dx, duv_dy].map(|d| [d[0] * texels[0], d[1] * texels[1]]);
    let xx = quarter * (a[0] * a[0] + b[0] * b[0]);
    let xy = quarter * (a[0] * a[1] + b[0] * b[1]);
    let yy = quarter * (a[1] * a[1] + b[1] * b[1]);
    let mean = half * (xx + yy);
    let d = half * (xx - yy);
    let r = (d * d + xy * xy).sqrt();
    let most = T::of(1e8);
    let major = clamp(mean + r, T::of(1e-6), most);
    let narrow = mean - r;
    let looks = T::of(f64::from(MAX_MAP_LOOKS - 1));
    let minor = clamp(
        narrow.max(major / (one + looks / T::of(LOOKS_PER_VARIANCE))),
        T::of(1e-6),
        most,
    );
    // The first level's own variance is the least.
    let seen = minor.max(quarter);
    let rest = (major - seen).max(T::zero());
    let more = clamp(
        (T::of(LOOKS_PER_VARIANCE) * rest / seen).ceil(),
        T::zero(),
        looks,
    );
    // Direction of the longer axis, from the longer one of two expressions.
    let along = if d >= T::zero() {
        [r + d, xy]
    } else {
        [xy, r - d]
    };
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    let spread = (T::of(4.0) * rest / more.max(one)).sqrt() / length.max(T::of(1e-12));
    let serves = narrow >= T::of(FINEST_MAP_SIGMA * FINEST_MAP_SIGMA);
    MapSight {
        step: [0, 1].map(|i| along[i] * spread / T::of(f64::from(MAP_SIZE[i]))),
        level: if serves {
            map_level(seen)
        } else {
            whole_level(major)
        },
        count: 1 + more.to_u32().unwrap_or(0).min(MAX_MAP_LOOKS - 1),
        serves,
    }
}

/// The level of a look of this variance, in texels of the first level: a look on level `l` has `4^l / 4`, one between two levels a mean of
/// theirs.
fn map_level<T: Real>(variance: T) -> T {
    let times = T::of(4.0) * variance;
    let low = (T::of(0.5) * times.log2()).floor();
    let share = (times * T::of(0.25).powf(low) - T::one()) * T::of(1.0 / 3.0);
    (low + clamp(share, T::zero(), T::one())).min(T::of(LAST_MAP_LEVEL.into()))
}

/// Looks that a variance along a footprint of one look's variance needs, less one.
const LOOKS_PER_VARIANCE: f64 = 4.0 / 9.0;

/// Factor on a look: beyond the map nothing is inside, where a sampler holds on to its outermost texels.
pub fn map_border<T: Real>(place: [T; 2], level: T) -> T {
    let shrink = T::of(0.5).powf(level);
    let of = |i: usize| {
        let texels = T::of(MAP_SIZE[i].into()) * shrink;
        let within = place[i].min(T::one() - place[i]);
        clamp(T::of(0.5) + within * texels, T::zero(), T::one())
    };
    of(0) * of(1)
}

/// Share of a footprint inside an outline: `look` reads the map at a place and a level. A shader loops over the looks where the map is
/// bound (`feather_cover.wgsl`).
pub fn map_share<T: Real>(uv: [T; 2], sight: &MapSight<T>, look: impl Fn([T; 2], T) -> T) -> T {
    let count = T::of(f64::from(sight.count));
    let middle = map_place(uv);
    let mut weight = T::one();
    let [mut sum, mut total] = [T::zero(); 2];
    for i in 0..sight.count {
        let i = T::of(f64::from(i));
        let away = i - T::of(0.5) * (count - T::one());
        let place = [0, 1].map(|k| middle[k] + sight.step[k] * away);
        sum = sum + weight * map_border(place, sight.level) * look(place, sight.level);
        total = total + weight;
        weight = weight * (count - T::one() - i) / (i + T::one());
    }
    sum / total
}

/// What a rachis leaves of both vanes, left and right, where the share `inside` of a footprint is inside the outline, `rachis` of it is
/// hidden by the rachis, and the shares `beside` of it lie beside the rachis on both sides. Exact where only one of outline and
/// rachis cuts the footprint.
pub fn map_vanes<T: Real>(inside: T, rachis: T, beside: [T; 2]) -> [T; 2] {
    let all = (beside[0] + beside[1]).max(T::of(1e-6));
    let vanes = (inside - rachis).max(T::zero());
    beside.map(|share| vanes * share / all)
}
