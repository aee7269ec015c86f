//! Masking: how much wider a fibre looks, projected onto the feather's surface, from an inclined view.
//!
//! Chen et al. 2026, Eq. 26-29, in the form that has no division by the view's projection: with `T = |V.r| / |V.n|` (`r` the
//! unit bitangent of the fibre in the surface) a cylinder hides the strip from `-q` radii on the side away from the viewer to
//! `+1` radius on the viewer's side, `q = sqrt(1 + T^2)`. Eq. 28 gives the same width where it is finite; the shift of Eq. 29 is
//! replaced, it is right at one angle only. Agrees with ray-cast cylinders to 5e-4 radii. Twin of `masking.wgsl`.

use super::{
    math::{Real, wrap},
    vane::{Cell, Vane},
};

/// Least `|V.n|`: beyond it the feather is seen edge on and every family has closed up.
const LEAST_FACING: f64 = 1e-3;

/// Strip hidden by a fibre lying in the surface, as `[below, above]`: distances from its axis along `-r` and `+r`, both
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

/// Half width (at most half a period) and centre, in periods, of the strip `[-below, above]`.
fn strip_to_arc<T: Real>(strip: [T; 2], period: T) -> (T, T) {
    let half = T::of(0.5);
    let h = (half * (strip[0] + strip[1]) / period).min(half);
    let shift = wrap(half * (strip[1] - strip[0]) / period);
    (h, shift)
}

/// Where the rachis of radius `r_r` (feather lengths) ends on both sides of `x = 0`: `[lower x, upper x]`.
pub fn mask_rachis<T: Real>(r_r: T, view: [T; 3]) -> [T; 2] {
    let [below, above] = mask_strip(r_r, r_r, view[0], view[2]);
    [-below, above]
}

/// The pattern of the left vane seen along `view`, the vector towards the eye in the canonical frame (x, y, front normal), of
/// any length. Finite for every view: at grazing angles the families close up to full coverage.
pub fn mask_vane<T: Real>(vane: &Vane<T>, view: [T; 3]) -> Cell<T> {
    let zero = T::zero();
    let one = T::one();
    let clean = |x: T| if x.is_finite() { x } else { zero };
    let length = view
        .iter()
        .fold(zero, |sum, x| sum + clean(*x) * clean(*x))
        .sqrt();
    let [x, y, n] = if length > T::of(1e-12) {
        view.map(|x| clean(x) / length)
    } else {
        [zero, zero, one]
    };
    let view_s = x * vane.cos_b + y * vane.sin_b;
    let view_t = y * vane.cos_b - x * vane.sin_b;

    let barb = mask_strip(vane.r_b, vane.r_b, view_s, n);
    let total = (barb[0] + barb[1]).max(vane.p_b);
    let v0 = barb[1] / total;
    let v1 = (one - barb[0] / total).max(v0);

    // Normals of the barbules in (s, t): (cos, -sin) distal, (cos, sin) proximal. A shift along the distal normal
    // lowers tau, along the proximal one it raises it.
    let p_bl = vane.p_bl();
    let distal = mask_strip(
        vane.r_bd,
        vane.r_bd,
        view_s * vane.cos_bl - view_t * vane.sin_bl,
        n,
    );
    let proximal = mask_strip(
        vane.r_bp,
        vane.r_bp,
        view_s * vane.cos_bl + view_t * vane.sin_bl,
        n,
    );
    let (h_d, shift_d) = strip_to_arc(distal, p_bl);
    let (h_p, shift_p) = strip_to_arc(proximal, p_bl);
    let ratio = vane.p_b / vane.d_bl;
    let kappa = (vane.cos_bl / vane.sin_bl * ratio).max(T::of(0.01));
    let e0 = wrap(vane.cos_b / vane.sin_b * ratio);
    if n >= zero {
        Cell {
            kappa,
            e0,
            v0,
            v1,
            h_d,
            h_p,
            s_d: -shift_d,
            s_p: shift_p,
            side: one,
        }
    } else {
        Cell {
            kappa,
            e0: -e0,
            v0: one - v1,
            v1: one - v0,
            h_d: h_p,
            h_p: h_d,
            s_d: shift_p,
            s_p: -shift_d,
            side: -one,
        }
    }
}
