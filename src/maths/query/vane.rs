//! One vane, its pattern in units of its own periods, and a footprint brought into them.

use crate::maths::{
    footprint::Footprint,
    functions::{Real, wrap},
};

/// One vane in canonical units (feather lengths); Table 1 of Chen et al. 2026.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vane<T> {
    /// `p_b = sin(alpha_b) / N_b`: distance of neighboring barbs along their normal, feather lengths.
    pub p_b: T,
    /// `d_bl`: distance of neighboring barbules along the barb, feather lengths.
    pub d_bl: T,
    /// Cosine of alpha_b, the angle between barb and rachis.
    pub cos_b: T,
    /// Sine of alpha_b.
    pub sin_b: T,
    /// Cosine of alpha_bl, the angle between barbule and barb.
    pub cos_bl: T,
    /// Sine of alpha_bl.
    pub sin_bl: T,
    /// `r_b`, feather lengths.
    pub r_b: T,
    /// `r_bd`, feather lengths.
    pub r_bd: T,
    /// `r_bp`, feather lengths.
    pub r_bp: T,
    /// Breadth over height of the barbules, 0..1: 1 where they hook, less where loose ones stand on edge.
    pub hooked: T,
}

impl<T: Real> Vane<T> {
    /// A vane from periods and radii in feather lengths and angles in radians. Values out of range are moved into it:
    /// periods at least 1e-6, angles 0.05..1.52, radii at least 0.
    pub fn new(p_b: T, d_bl: T, alpha_b: T, alpha_bl: T, r_b: T, r_bd: T, r_bp: T) -> Self {
        let angle = |a: T| crate::maths::functions::clamp(a, T::of(0.05), T::of(1.52));
        let (sin_b, cos_b) = angle(alpha_b).sin_cos();
        let (sin_bl, cos_bl) = angle(alpha_bl).sin_cos();
        let least = T::of(1e-6);
        let z = T::zero();
        Self {
            p_b: p_b.max(least),
            d_bl: d_bl.max(least),
            cos_b,
            sin_b,
            cos_bl,
            sin_bl,
            r_b: r_b.max(z),
            r_bd: r_bd.max(z),
            r_bp: r_bp.max(z),
            hooked: T::one(),
        }
    }

    /// The same vane where its barbules show a share of their breadth only, 0..1.
    pub fn loosened(self, hooked: T) -> Self {
        Self { hooked, ..self }
    }

    /// A vane from the numbers an artist gives: barbs per feather length, angles in degrees, radii and barbule spacing in
    /// micrometres, length of the feather in millimetres.
    pub fn from_measures(
        barb_count: T,
        barb_angle: T,
        barb_radius_um: T,
        spacing_um: T,
        barbule_angle: T,
        distal_radius_um: T,
        proximal_radius_um: T,
        length_mm: T,
    ) -> Self {
        let unit = T::of(1e-3) / length_mm.max(T::of(1e-3));
        let alpha_b = barb_angle.to_radians();
        Self::new(
            alpha_b.sin() / barb_count.max(T::one()),
            spacing_um * unit,
            alpha_b,
            barbule_angle.to_radians(),
            barb_radius_um * unit,
            distal_radius_um * unit,
            proximal_radius_um * unit,
        )
    }

    /// `p_bl = d_bl sin(alpha_bl)`: distance of neighboring barbules along their normal, feather lengths.
    pub fn p_bl(&self) -> T {
        self.d_bl * self.sin_bl
    }
}

/// The pattern of a vane seen from one direction, in cell units: `u = s / p_b`, `tau = t / d_bl`.
///
/// Gap `k` is `u` in `[k + v_low, k + v_high]`. In it the distal arcs on the circle of `tau` are centred at
/// `kappa (u - k) + k e_root + s_d` with half width `h_d`, the proximal ones at `kappa (k + 1 - u) + (k + 1) e_root + s_p` with
/// half width `h_p`. The pattern repeats under `(u + 1, tau + e_root)` and `(u, tau + 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<T> {
    /// `cot(alpha_bl) p_b / d_bl`: barbule periods that a barbule climbs across a barb period.
    pub kappa: T,
    /// Phase from one barb root to the next, in [-1/2, 1/2].
    pub e_root: T,
    /// Lower end of the gap, in [0, 1].
    pub v_low: T,
    /// Upper end of the gap, in [v_low, 1].
    pub v_high: T,
    /// Half width of the upper (distal, seen from the front) family, in [0, 1/2].
    pub h_d: T,
    /// Half width of the lower family.
    pub h_p: T,
    /// Shift of the upper family by masking.
    pub s_d: T,
    /// Shift of the lower family by masking.
    pub s_p: T,
    /// 1 seen from the front. -1 from the back: there the proximal family lies over the distal one, which is the same
    /// pattern with `u` reversed and the families exchanged, so the cell holds that pattern and results are swapped back.
    pub side: T,
}

impl<T: Real> Cell<T> {
    /// The vane's pattern without masking.
    pub fn unmasked(vane: &Vane<T>) -> Self {
        super::mask_vane(vane, [T::zero(), T::zero(), T::one()])
    }

    /// Phase difference of the lower and the upper family at `v = u - k`.
    pub fn phase_difference(&self, v: T) -> T {
        self.kappa * (T::one() - v - v) + self.e_root + self.s_p - self.s_d
    }
}

/// A footprint in cell units, reduced to the cell around barb 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local<T> {
    /// Mean of `u`, in [0, 1).
    pub u: T,
    /// Mean of `tau`, in [-1/2, 1/2].
    pub tau: T,
    /// Variance of `u`, at least 1e-10.
    pub variance: T,
    /// Regression of `tau` on `u`.
    pub slope: T,
    /// Variance of `tau` at fixed `u`, at least 1e-8: the only damping that the edge of a gap cannot undo.
    pub conditional: T,
}

/// Brings a footprint over the left vane into cell units.
///
/// Phases are counted from the nearest barb root on the rachis, which is a point of the lattice: thousands of periods along the
/// feather cancel before anything is divided by the barbule spacing.
pub fn reduce<T: Real>(cell: &Cell<T>, vane: &Vane<T>, footprint: &Footprint<T>) -> Local<T> {
    let (f, determinant) = footprint.widened();
    let [x, y] = f.mean;
    let [xx, xy, yy] = f.covariance;
    let (c, s) = (vane.cos_b, vane.sin_b);
    let spacing = vane.p_b / s;
    let rest = y - (y / spacing + T::of(0.5)).floor() * spacing;
    let across = (x * c + rest * s) / vane.p_b * cell.side;
    let k = across.floor();
    let tau = wrap((rest * c - x * s) / vane.d_bl - k * cell.e_root);
    let two = T::of(2.0);
    let var_s = (xx * c * c + two * xy * c * s + yy * s * s)
        .max(T::of(crate::maths::footprint::LEAST_VARIANCE));
    let cov_st = (yy - xx) * c * s + xy * (c * c - s * s);
    Local {
        u: across - k,
        tau,
        variance: (var_s / (vane.p_b * vane.p_b)).max(T::of(1e-10)),
        slope: cell.side * cov_st / var_s * (vane.p_b / vane.d_bl),
        conditional: (determinant / var_s / (vane.d_bl * vane.d_bl)).max(T::of(1e-8)),
    }
}
