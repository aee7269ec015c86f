//! The map M between a feather's UV rectangle and canonical space, pixel footprints, and what the outline leaves of them.
//!
//! Pure functions, generic over the float; `anatomy.wgsl` holds their twins under the same names.

use super::{
    footprint::Footprint,
    functions::{Real, normal_distribution, normal_share, real, smooth_step},
};

/// Canonical point of `uv`: `x = (u - F_P(v)) aspect`, `y = v` (map M of Table 1, with true angles and the rachis on 0).
/// `curve` is F_P at this v.
pub fn canonical<T: Real>(uv: [T; 2], curve: T, aspect: T) -> [T; 2] {
    [(uv[0] - curve) * aspect, uv[1]]
}

/// Inverse of [`canonical`]: the `uv` of a canonical point; `curve` is F_P at `v = y`.
pub fn uv<T: Real>(point: [T; 2], curve: T, aspect: T) -> [T; 2] {
    [point[0] / aspect.max(real(1e-6)) + curve, point[1]]
}

/// Jacobian of [`canonical`] as rows `[[dx/du, dx/dv], [dy/du, dy/dv]]`; `slope` is F_P'(v). Its determinant is `aspect`.
pub fn jacobian<T: Real>(slope: T, aspect: T) -> [[T; 2]; 2] {
    [[aspect, -slope * aspect], [T::zero(), T::one()]]
}

/// Footprint of a pixel: a Gaussian with a standard deviation of half a pixel along each screen axis, carried over by the
/// Jacobian J: with D = [duv_dx duv_dy], covariance = J D (D^T J^T) / 4 (Sec. 5.2). `curve`, `slope` are F_P and F_P' at uv.y.
pub fn canonical_footprint<T: Real>(
    uv: [T; 2],
    duv_dx: [T; 2],
    duv_dy: [T; 2],
    curve: T,
    slope: T,
    aspect: T,
) -> Footprint<T> {
    let j = jacobian(slope, aspect);
    let carry = |d: [T; 2]| [j[0][0] * d[0] + j[0][1] * d[1], d[1]];
    let (a, b) = (carry(duv_dx), carry(duv_dy));
    let quarter = real::<T>(0.25);
    Footprint {
        mean: canonical(uv, curve, aspect),
        covariance: [
            quarter * (a[0] * a[0] + b[0] * b[0]),
            quarter * (a[0] * a[1] + b[0] * b[1]),
            quarter * (a[1] * a[1] + b[1] * b[1]),
        ],
    }
}

/// What a pixel sees of a card.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardSight<T> {
    /// In canonical space.
    pub footprint: Footprint<T>,
    /// Where its middle lies, 0..1 from the left edge to the right one and from root to tip.
    pub place: [T; 2],
    /// How many standard deviations of that place the card is wide and long, over 0.
    pub size: [T; 2],
}

/// How many standard deviations of a place within a pixel the card is wide and long, from the place's derivatives along both axes of the
/// screen: a deviation is half of their length.
pub fn card_size<T: Real>(dplace_dx: [T; 2], dplace_dy: [T; 2]) -> [T; 2] {
    [0, 1].map(|i| {
        let square = dplace_dx[i] * dplace_dx[i] + dplace_dy[i] * dplace_dy[i];
        (real::<T>(0.25) * square).max(real(1e-14)).sqrt().recip()
    })
}

/// The same where the pixel is wider than one side of the card, left or right of the shaft: no more of it than that side has, as a Gaussian
/// with about the variance of its width. `carry`: way in canonical space of one deviation across the card. Otherwise a feather seen edge on, a
/// twentieth of a pixel wide, is so small a share of what the footprint spans that errors of the outline are as large; and where a card is
/// folded, one side is seen edge on and the other is not.
pub fn narrowed<T: Real>(sight: &CardSight<T>, carry: [T; 2]) -> CardSight<T> {
    let one = T::one();
    let square = sight.size[0] * sight.size[0];
    let root = (square * square + real(EVEN_SIDE * EVEN_SIDE))
        .sqrt()
        .recip();
    // Of the variance; a side of 5 pixels loses less than 0.01.
    let lost = one - square * root;
    let [across, along] = sight.place;
    let left = real(if across > real(0.5) { 0.5 } else { 0.0 });
    let moved = (real::<T>(0.25) - (across - left)) * lost;
    let way = moved * sight.size[0];
    let [x, y] = sight.footprint.mean;
    let [xx, xy, yy] = sight.footprint.covariance;
    let less = |i: usize, j: usize| carry[i] * carry[j] * lost;
    CardSight {
        footprint: Footprint {
            mean: [x + carry[0] * way, y + carry[1] * way],
            covariance: [xx - less(0, 0), xy - less(0, 1), yy - less(1, 1)],
        },
        place: [across + moved, along],
        size: [root.sqrt().recip(), sight.size[1]],
    }
}

/// Share of a footprint that lies on the card, 0.02 to 1 along each side: a Gaussian ([`CardSight`]) between the edges across times that
/// between root and tip. The rasterizer leaves out what of a pixel lies beside the card, so coverage of the whole footprint would count that
/// twice; coverage of the part on the card is [`on_card`].
pub fn card_share<T: Real>(place: [T; 2], size: [T; 2]) -> T {
    let of = |i: usize| {
        let low = place[i] * size[i];
        let within = normal_share(low) + normal_share(size[i] - low);
        (within - T::one()).max(real(LEAST_CARD_SHARE))
    };
    of(0) * of(1)
}

/// Least share of a footprint between two edges of its card: a pixel whose center is beside the card by the half of its diagonal has 0.08.
const LEAST_CARD_SHARE: f64 = 0.02;

/// Square of a card's width in deviations of an even density over one of its sides.
const EVEN_SIDE: f64 = 48.0;

/// Coverages of the part of a footprint on the card, from those of the whole one and its [`card_share`]. Their sum is 1 at most.
pub fn on_card<T: Real>(weights: [T; 4], share: T) -> [T; 4] {
    let sum = weights[0] + weights[1] + weights[2] + weights[3];
    weights.map(|weight| weight / share.max(sum))
}

/// How far a place at share `across` of a card (0..1, left to right) moves along the card's normal, so that the card never looks narrower than
/// `thickness`: the edges move apart where the eye sees less of `width` (both in one unit, 0 or more). `facing` and `aside` are the eye's
/// components along the normal and from left to right. `front`: whether the card shows its front face at its root; places that are turned
/// away by less than 6 degrees show it, too, or the edges would cross between them. What faces the eye by more than that does not move.
/// A sheet without thickness would leave dots between pixels where it stands edge on.
pub fn edge_shift<T: Real>(
    across: T,
    width: T,
    thickness: T,
    facing: T,
    aside: T,
    front: bool,
) -> T {
    let side = if front { T::one() } else { -T::one() };
    let shown = width * facing * side;
    let lacking = if facing.abs() < real(EDGE_FACING) {
        (thickness - shown).max(T::zero())
    } else {
        T::zero()
    };
    let outward = if aside * side > T::zero() {
        -T::one()
    } else {
        T::one()
    };
    (across - real(0.5)) * lacking * outward
}

/// Cosine between normal and eye from which on a place does not count as edge on.
const EDGE_FACING: f64 = 0.1;

/// Cotangent of the angle between barb and rachis from its sine and cosine, finite.
pub fn barb_cotangent<T: Real>(sin_b: T, cos_b: T) -> T {
    cos_b / sin_b.max(real(1e-3))
}

/// Height on the rachis where the barb through a canonical point is rooted: `y - |x| cotangent` ([`barb_cotangent`]).
pub fn barb_root<T: Real>(mean: [T; 2], cotangent: T) -> T {
    mean[1] - mean[0].abs() * cotangent
}

/// Standard deviation of a linear function with gradient (gx, gy) under a covariance, floored away from 0.
fn footprint_deviation<T: Real>(gx: T, gy: T, [xx, xy, yy]: [T; 3]) -> T {
    let variance = gx * gx * xx + real::<T>(2.0) * gx * gy * xy + gy * gy * yy;
    variance.max(real(1e-14)).sqrt()
}

/// Share of a Gaussian footprint inside the outline, 0..1: the half plane of `f(x, y) = reach(y - |x| cotangent) - |x|` to first
/// order. `reach` and `reach_slope` are the contour and its derivative at [`barb_root`]; `cotangent`: [`barb_cotangent`].
pub fn contour_coverage<T: Real>(
    footprint: &Footprint<T>,
    reach: T,
    reach_slope: T,
    cotangent: T,
) -> T {
    let mean = footprint.mean;
    let side = if mean[0] < T::zero() {
        -T::one()
    } else {
        T::one()
    };
    let gx = -(T::one() + reach_slope * cotangent) * side;
    let f = reach - mean[0].abs();
    normal_distribution(f / footprint_deviation(gx, reach_slope, footprint.covariance))
}

/// Share of a Gaussian footprint above the lowest barb, which is rooted at `start`, 0..1. Multiply with
/// [`contour_coverage`]: below the vane there is only the calamus.
pub fn vane_start_coverage<T: Real>(footprint: &Footprint<T>, start: T, cotangent: T) -> T {
    let mean = footprint.mean;
    let side = if mean[0] < T::zero() {
        -T::one()
    } else {
        T::one()
    };
    let deviation = footprint_deviation(-cotangent * side, T::one(), footprint.covariance);
    normal_share((barb_root(mean, cotangent) - start) / deviation)
}

/// How far the barbules at a point hook into a closed vane, 0 (loose) to 1. They do not in the outer `fringe` share of a barb
/// and below the height `downy`; both fade over a tenth (of the barb, of the feather). `distance` is |x|, `height` is y: the barbs at
/// the border are downy at their root and hooked further out.
pub fn hooked<T: Real>(distance: T, height: T, reach: T, fringe: T, downy: T) -> T {
    let fade = real::<T>(0.1);
    let share = distance / reach.max(real(1e-5));
    let edge = T::one() - fringe;
    let rim = if fringe > T::zero() {
        T::one() - smooth_step(-fade, fade, share - edge)
    } else {
        T::one()
    };
    let down = if downy > T::zero() {
        smooth_step(-fade, fade, height - downy)
    } else {
        T::one()
    };
    rim * down
}

/// Barbule coverage that is left where nothing hooks: loose barbules twist out of the plane and stand on edge.
pub const LOOSE_BARBULES: f64 = 0.35;

/// Factor on barbule coverage for a value of [`hooked`].
pub fn barbule_factor<T: Real>(hooked: T) -> T {
    real::<T>(LOOSE_BARBULES) + (T::one() - real(LOOSE_BARBULES)) * hooked
}

/// Row of the contour table (`ShapeTable::contour`, `rows` of them) for a barb rooted at `root`:
/// a fractional index in 0..rows-1.
pub fn contour_row<T: Real>(root: T, start: T, rows: T) -> T {
    let last = (rows - T::one()).max(T::zero());
    ((root - start) / (T::one() - start).max(real(1e-3)) * last)
        .max(T::zero())
        .min(last)
}
