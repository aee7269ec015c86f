//! Masking: which strip of the feather's surface a fibre hides from an inclined view.
//!
//! A ray that passes the plane of the vane beside a fibre's axis still meets its lower half, so a barbule hides its whole
//! silhouette, `2 r sqrt(1 + T^2)` with `T = |V.r| / |V.n|` (`r` the bitangent of the fibre in the surface), about the projection
//! of its axis, which lies above or below the plane by half the distance of the two storeys of barbules. A barb hides its
//! silhouette less what its own barbules hide of the flank towards the viewer ([`BarbStrip`]). The half silhouette of
//! Chen et al. 2026, Eq. 26-29 (far half whole, near half as seen from above), is right for a fibre that lies on a table, and
//! serves for the shaft, whose lower half the vane hides ([`mask_strip`]). Twin of `masking.wgsl`.

use super::vane::{Cell, Vane};
use crate::maths::functions::{Real, clamp, wrap};

/// Least `|V.n|`: beyond it the feather is seen edge on and every family has closed up.
const LEAST_FACING: f64 = 1e-3;

/// Strip hidden by a fibre that lies on the surface, as `[below, above]`: distances from its axis along `-r` and `+r`, both
/// positive. `radius_r`, `radius_n`: semi-axes along `r` and along the normal; `view_r`, `view_n`: the view vector's
/// components (towards the eye). Only their ratio matters, so the component along the fibre cancels.
pub fn mask_strip<T: Real>(radius_r: T, radius_n: T, view_r: T, view_n: T) -> [T; 2] {
    let t = view_r.abs() / view_n.abs().max(T::of(LEAST_FACING));
    let far = (radius_r * radius_r + radius_n * radius_n * t * t).sqrt();
    // The reach towards the viewer is the radius itself: the axis lies in the surface and the lower half is below it.
    if view_r > T::zero() {
        [far, radius_r]
    } else {
        [radius_r, far]
    }
}

/// Where the rachis of radius `r_r` (feather lengths) ends on both sides of `x = 0`: `[lower x, upper x]`.
pub fn mask_rachis<T: Real>(r_r: T, view: [T; 3]) -> [T; 2] {
    let [below, above] = mask_strip(r_r, r_r, view[0], view[2]);
    [-below, above]
}

/// What every direction to a vane shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaneShape<T> {
    /// The vane.
    pub vane: Vane<T>,
    /// One over the period of the barbs.
    pub per_barb: T,
    /// One over the period of the barbules along their normal.
    pub per_barbule: T,
    /// Radius of the barbs, at most a period.
    pub barb: T,
    /// Distal and proximal barbules.
    pub families: [Family<T>; 2],
    /// Distance of the storeys' axes from the middle of the vane, feather lengths.
    pub lift: T,
    /// See [`Cell::kappa`].
    pub kappa: T,
    /// Seen from the front, see [`Cell::e_root`].
    pub e_root: T,
}

/// Sizes of a family of barbules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Family<T> {
    /// Half its height, feather lengths; at most a period.
    pub radius: T,
    /// One over it.
    pub inverse: T,
    /// Radius over period.
    pub ratio: T,
}

/// A family of barbules as one direction sees it: a storey of the vane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storey<T> {
    /// Its sizes.
    pub family: Family<T>,
    /// Component of the direction across the family over that along the normal (counted towards the direction), signed.
    pub slope: T,
    /// Width of the silhouettes over their period, at the vane; above 1 they hide each other.
    pub wide: T,
    /// Half the silhouette in radii.
    pub root: T,
}

impl<T: Real> Storey<T> {
    fn new(family: Family<T>, hooked: T, slope: T) -> Self {
        let root = (hooked * hooked + slope * slope).sqrt();
        Self {
            family,
            slope,
            wide: family.ratio * (root + root),
            root,
        }
    }

    /// Share of light along the direction that the storey keeps off a flank at which it is cut, mean over its height: Simpson's
    /// rule over quarters of it, the top being free.
    fn on_flank(&self, hooked: T) -> T {
        let half = T::of(0.5);
        let off_axis = self.blocks(-half, hooked) + self.blocks(half, hooked);
        let even = self.wide.min(T::one()) + T::of(2.0) * self.blocks(T::zero(), hooked);
        (even + T::of(4.0) * off_axis) * T::of(1.0 / 12.0)
    }

    /// Share of light along the direction that the storey keeps off a point of the flank, `height` above the axes in radii.
    pub fn blocks(&self, height: T, hooked: T) -> T {
        let (zero, one) = (T::zero(), T::one());
        if height >= one {
            return zero;
        }
        let h = height.max(-one);
        let over = hooked * (one - h * h).max(zero).sqrt() + self.root - self.slope.abs() * h;
        (self.family.ratio * over).min(self.wide).min(one)
    }
}

/// The fibres of a vane as one direction sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storeys<T> {
    /// Component of the direction across the barbs over that along the normal, signed.
    pub slope: T,
    /// Half the silhouette of a barb over its radius.
    pub root: T,
    /// One over it.
    pub per_root: T,
    /// Half the silhouette of a barb, feather lengths.
    pub silhouette: T,
    /// Storeys of barbules: the one that the direction meets first, and the other.
    pub layers: [Storey<T>; 2],
}

/// What a barb shows to a direction between the barbules that grow on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarbStrip<T> {
    /// Width of the strip on the surface, feather lengths. It begins half a silhouette beyond the axis.
    pub width: T,
    /// Of what the barbules cover, share of the storey that the direction meets first.
    pub first: T,
    /// Of what that leaves, share of the other.
    pub second: T,
}

/// What every direction to `vane` shares.
pub fn vane_shape<T: Real>(vane: &Vane<T>) -> VaneShape<T> {
    let (one, least) = (T::one(), T::of(1e-9));
    let period = vane.p_bl().max(least);
    let per_barbule = one / period;
    // Beyond a period a fibre is no wider: its neighbors are there.
    let families = [vane.r_bd, vane.r_bp].map(|radius| {
        let radius = radius.min(period);
        Family {
            radius,
            inverse: one / radius.max(least),
            ratio: radius * per_barbule,
        }
    });
    let ratio = vane.p_b / vane.d_bl;
    VaneShape {
        vane: *vane,
        per_barb: one / vane.p_b,
        per_barbule,
        barb: vane.r_b.min(vane.p_b),
        families,
        lift: T::of(0.5) * (families[0].radius + families[1].radius),
        kappa: (vane.cos_bl / vane.sin_bl * ratio).max(T::of(0.01)),
        e_root: wrap(vane.cos_b / vane.sin_b * ratio),
    }
}

/// The storeys of the left vane along `direction` (canonical frame, unit), towards the eye or a light. Storeys are named from the
/// side of the direction.
pub fn storeys<T: Real>(shape: &VaneShape<T>, [x, y, facing]: [T; 3]) -> Storeys<T> {
    let vane = &shape.vane;
    let per_facing = T::one() / facing.abs().max(T::of(LEAST_FACING));
    let (slope, t) = (
        (x * vane.cos_b + y * vane.sin_b) * per_facing,
        (y * vane.cos_b - x * vane.sin_b) * per_facing,
    );
    // Normals of the barbules in (s, t): (cos, -sin) distal, (cos, sin) proximal.
    let (along, across) = (slope * vane.cos_bl, t * vane.sin_bl);
    let [distal, proximal] = shape.families;
    let distal = Storey::new(distal, vane.hooked, along - across);
    let proximal = Storey::new(proximal, vane.hooked, along + across);
    let root = (T::one() + slope * slope).sqrt();
    Storeys {
        slope,
        root,
        per_root: T::one() / root,
        silhouette: shape.barb * root,
        layers: if facing >= T::zero() {
            [distal, proximal]
        } else {
            [proximal, distal]
        },
    }
}

/// What barbules hide of the silhouettes of the barbs at which they end: the storey that the direction meets first, and the other
/// one; feather lengths. The direction's foot on the flank towards it runs from the top of the storeys, where all of the barb shows,
/// down to where the silhouette ends; in between every storey hides its share.
pub fn barb_hidden<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> [T; 2] {
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    let [upper, lower] = storeys.layers;
    let slope = storeys.slope.abs();
    // Heights: the top and the seam of the storeys, their bottom, and how far the lowest foot is below the middle.
    let (radius, rest) = (upper.family.radius, two * lower.family.radius);
    let (top, seam) = (shape.lift + radius, shape.lift - radius);
    let bottom = seam - rest;
    let down = shape.barb * slope / (one + storeys.root);
    // Lengths of the foot's way through the storeys and below them.
    let first = clamp(top + down, zero, two * radius) * slope;
    let second = clamp(seam + down, zero, rest) * slope;
    let below = (bottom + down).max(zero) * slope;
    let [hides, hidden] = [upper, lower].map(|storey| storey.on_flank(shape.vane.hooked));
    let wide = [upper.wide.min(one), lower.wide.min(one)];
    [
        first * hides + (second + below) * wide[0],
        (one - wide[0]) * (second * hidden + below * wide[1]),
    ]
}

/// What a barb shows between its barbules, which end at its flanks ([`barb_hidden`]).
pub fn barb_strip<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> BarbStrip<T> {
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    let [by_upper, by_lower] = barb_hidden(shape, storeys);
    let [upper, lower] = storeys.layers;
    let wide = [upper.wide.min(one), lower.wide.min(one)];
    let (long, period) = (storeys.silhouette, shape.vane.p_b);
    let width = (long + long - by_upper - by_lower).max(zero).min(period);
    // Beyond the barb the families cover as if there were none.
    let free = (period - two * long).max(zero);
    let rest = (free + by_upper + by_lower).max(T::of(1e-9));
    let share = ((wide[0] * free + by_upper) / rest).min(one);
    let second = (one - wide[0]) * wide[1] * free + by_lower;
    BarbStrip {
        width,
        first: share,
        second: (second / (rest * (one - share)).max(T::of(1e-9))).min(one),
    }
}

/// Share of what comes along a direction that a vane stops, 0..1, its families taken to know nothing of each other: within 0.01 of the sum
/// of [`mean_coverage`](super::mean_coverage), which knows how they lie. What barbules hide of barbs they stop themselves.
pub fn vane_stop<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> T {
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    let [upper, lower] = storeys.layers;
    let gap = (one - two * storeys.silhouette * shape.per_barb).max(zero);
    one - gap * (one - upper.wide).max(zero) * (one - lower.wide).max(zero)
}

/// The pattern of the left vane seen along `view`, the vector towards the eye in the canonical frame (x, y, front normal), of
/// any length. Finite for every view: at grazing angles the families close up to full coverage.
pub fn mask_vane<T: Real>(vane: &Vane<T>, view: [T; 3]) -> Cell<T> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let clean = |x: T| if x.is_finite() { x } else { zero };
    let length = view
        .iter()
        .fold(zero, |sum, x| sum + clean(*x) * clean(*x))
        .sqrt();
    let view = if length > T::of(1e-12) {
        view.map(|x| clean(x) / length)
    } else {
        [zero, zero, one]
    };
    let shape = vane_shape(vane);
    let storeys = storeys(&shape, view);
    let strip = barb_strip(&shape, &storeys);
    // The strip reaches half a silhouette away from the viewer; where it does not reach back to the axis, it is moved there.
    let width = strip.width * shape.per_barb;
    let far = (storeys.silhouette * shape.per_barb).min(one).min(width);
    let (below, above) = if storeys.slope > zero {
        (far, width - far)
    } else {
        (width - far, far)
    };
    let v_low = above.min(one);
    let v_high = (one - below).max(v_low);

    // Half widths at most half a period. The projection of a storey's axis lies away from the viewer, that of the other one
    // towards it; a shift along the distal normal lowers tau, along the proximal one it raises it.
    let [upper, lower] = storeys.layers;
    let (h_d, h_p) = (half * strip.first, half * strip.second);
    let shift = |storey: &Storey<T>| wrap(shape.lift * storey.slope * shape.per_barbule);
    let VaneShape { kappa, e_root, .. } = shape;
    if view[2] >= zero {
        Cell {
            kappa,
            e_root,
            v_low,
            v_high,
            h_d,
            h_p,
            s_d: shift(&upper),
            s_p: shift(&lower),
            side: one,
        }
    } else {
        // From the back proximal lies over distal: the same pattern, u reversed and the families exchanged.
        Cell {
            kappa,
            e_root: -e_root,
            v_low: one - v_high,
            v_high: one - v_low,
            h_d,
            h_p,
            s_d: -shift(&upper),
            s_p: -shift(&lower),
            side: -one,
        }
    }
}
