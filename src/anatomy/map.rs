//! The map M between a feather's UV rectangle and canonical space, pixel footprints, and what the outline leaves of them.
//!
//! Pure functions, generic over the float; `src/shaders/anatomy.wgsl` holds their twins under the same names.

use num_traits::Float;

fn c<T: Float>(value: f64) -> T {
    T::from(value).unwrap_or_else(T::zero)
}

/// Error function, Abramowitz and Stegun 7.1.26 (absolute error 1.5e-7). The GPU uses the same formula.
pub fn error_function<T: Float>(x: T) -> T {
    let t = T::one() / (T::one() + c::<T>(0.3275911) * x.abs());
    let p = ((((c::<T>(1.061405429) * t - c(1.453152027)) * t + c(1.421413741)) * t
        - c(0.284496736))
        * t
        + c(0.254829592))
        * t;
    let y = T::one() - p * (-x * x).exp();
    if x < T::zero() { -y } else { y }
}

/// Mass of a unit Gaussian below `x`: the step function as a Gaussian pixel sees it.
pub fn gaussian_step<T: Float>(x: T) -> T {
    c::<T>(0.5) + c::<T>(0.5) * error_function(x * c(std::f64::consts::FRAC_1_SQRT_2))
}

/// Canonical point of `uv`: `x = (u - F_P(v)) aspect`, `y = v` (map M of Table 1, with true angles and the rachis on 0).
/// `curve` is F_P at this v.
pub fn canonical<T: Float>(uv: [T; 2], curve: T, aspect: T) -> [T; 2] {
    [(uv[0] - curve) * aspect, uv[1]]
}

/// Inverse of [`canonical`]: the `uv` of a canonical point; `curve` is F_P at `v = y`.
pub fn uv<T: Float>(point: [T; 2], curve: T, aspect: T) -> [T; 2] {
    [point[0] / aspect.max(c(1e-6)) + curve, point[1]]
}

/// Jacobian of [`canonical`] as rows `[[dx/du, dx/dv], [dy/du, dy/dv]]`; `slope` is F_P'(v). Its determinant is `aspect`.
pub fn jacobian<T: Float>(slope: T, aspect: T) -> [[T; 2]; 2] {
    [[aspect, -slope * aspect], [T::zero(), T::one()]]
}

/// A pixel's Gaussian in canonical space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CanonicalFootprint<T> {
    /// Centre (x, y) in feather lengths.
    pub mean: [T; 2],
    /// Covariance (xx, xy, yy) in squared feather lengths.
    pub cov: [T; 3],
}

/// Footprint of a pixel: a Gaussian with a standard deviation of half a pixel along each screen axis, carried over by the
/// Jacobian J: with D = [duv_dx duv_dy], cov = J D (D^T J^T) / 4 (Sec. 5.2). `curve`, `slope` are F_P and F_P' at uv.y.
pub fn canonical_footprint<T: Float>(
    uv: [T; 2],
    duv_dx: [T; 2],
    duv_dy: [T; 2],
    curve: T,
    slope: T,
    aspect: T,
) -> CanonicalFootprint<T> {
    let j = jacobian(slope, aspect);
    let carry = |d: [T; 2]| [j[0][0] * d[0] + j[0][1] * d[1], d[1]];
    let (a, b) = (carry(duv_dx), carry(duv_dy));
    let quarter = c::<T>(0.25);
    CanonicalFootprint {
        mean: canonical(uv, curve, aspect),
        cov: [
            quarter * (a[0] * a[0] + b[0] * b[0]),
            quarter * (a[0] * a[1] + b[0] * b[1]),
            quarter * (a[1] * a[1] + b[1] * b[1]),
        ],
    }
}

/// Height on the rachis where the barb through a canonical point is rooted: `y - |x| cot(barb_angle)`, angle in radians.
pub fn barb_root<T: Float>(mean: [T; 2], barb_angle: T) -> T {
    mean[1] - mean[0].abs() * barb_angle.cos() / barb_angle.sin().max(c(1e-3))
}

/// Standard deviation of a linear function with gradient (gx, gy) under a covariance, floored away from 0.
fn deviation<T: Float>(gx: T, gy: T, cov: [T; 3]) -> T {
    let variance = gx * gx * cov[0] + c::<T>(2.0) * gx * gy * cov[1] + gy * gy * cov[2];
    variance.max(c(1e-14)).sqrt()
}

/// Share of a Gaussian footprint inside the outline, 0..1: the half plane of `f(x, y) = reach(y - |x| cot a) - |x|` to first
/// order. `reach` and `reach_slope` are the contour and its derivative at [`barb_root`]; `barb_angle` in radians.
pub fn contour_coverage<T: Float>(
    mean: [T; 2],
    cov: [T; 3],
    reach: T,
    reach_slope: T,
    barb_angle: T,
) -> T {
    let side = if mean[0] < T::zero() {
        -T::one()
    } else {
        T::one()
    };
    let cot = barb_angle.cos() / barb_angle.sin().max(c(1e-3));
    let gx = -(T::one() + reach_slope * cot) * side;
    let f = reach - mean[0].abs();
    gaussian_step(f / deviation(gx, reach_slope, cov))
}

/// Share of a Gaussian footprint above the lowest barb, which is rooted at `start`, 0..1. Multiply with
/// [`contour_coverage`]: below the vane there is only the calamus.
pub fn vane_start_coverage<T: Float>(mean: [T; 2], cov: [T; 3], start: T, barb_angle: T) -> T {
    let side = if mean[0] < T::zero() {
        -T::one()
    } else {
        T::one()
    };
    let cot = barb_angle.cos() / barb_angle.sin().max(c(1e-3));
    gaussian_step((barb_root(mean, barb_angle) - start) / deviation(-cot * side, T::one(), cov))
}

/// Hermite step from 0 at `low` to 1 at `high`; a plain step where they meet.
fn smooth_step<T: Float>(low: T, high: T, x: T) -> T {
    let t = ((x - low) / (high - low).max(c(1e-6)))
        .max(T::zero())
        .min(T::one());
    t * t * (c::<T>(3.0) - c::<T>(2.0) * t)
}

/// How far the barbules at a point hook into a closed vane, 0 (loose) to 1. They do not in the outer `fringe` share of a barb
/// and below the height `downy`; both fade over a tenth (of the barb, of the feather). `distance` is |x|, `height` is y: the barbs at
/// the border are downy at their root and hooked further out.
pub fn hooked<T: Float>(distance: T, height: T, reach: T, fringe: T, downy: T) -> T {
    let fade = c::<T>(0.1);
    let share = distance / reach.max(c(1e-5));
    let edge = T::one() - fringe;
    let rim = if fringe > T::zero() {
        T::one() - smooth_step(edge - fade, edge + fade, share)
    } else {
        T::one()
    };
    let down = if downy > T::zero() {
        smooth_step(downy - fade, downy + fade, height)
    } else {
        T::one()
    };
    rim * down
}

/// Barbule coverage that is left where nothing hooks: loose barbules twist out of the plane and stand on edge.
pub const LOOSE_BARBULES: f64 = 0.35;

/// Factor on barbule coverage for a value of [`hooked`].
pub fn barbule_factor<T: Float>(hooked: T) -> T {
    c::<T>(LOOSE_BARBULES) + (T::one() - c(LOOSE_BARBULES)) * hooked
}

/// Row of the contour table ([`ShapeTable::contour`](super::ShapeTable), `rows` of them) for a barb rooted at `root`:
/// a fractional index in 0..rows-1.
pub fn contour_row<T: Float>(root: T, start: T, rows: T) -> T {
    let last = (rows - T::one()).max(T::zero());
    ((root - start) / (T::one() - start).max(c(1e-3)) * last)
        .max(T::zero())
        .min(last)
}
