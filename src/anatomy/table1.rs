//! Derived quantities under the names of Table 1, in feather lengths.

use super::{Feather, Vane};
use crate::maths::{Real, card, query};

/// One of the two vanes, seen from the front, tip up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// `x < 0`; in the presets the leading, narrower vane of a flight feather.
    Left,
    /// `x > 0`.
    Right,
}

impl Side {
    /// Both, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// Sign of x on this side.
    pub const fn sign(self) -> f32 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}

impl Vane {
    /// alpha_b in radians.
    pub fn alpha_b(&self) -> f32 {
        self.barb_angle.to_radians()
    }

    /// alpha_bl in radians.
    pub fn alpha_bl(&self) -> f32 {
        self.barbules.angle.to_radians()
    }

    /// Cotangent of alpha_b.
    pub fn cotangent(&self) -> f32 {
        let (sin, cos) = self.alpha_b().sin_cos();
        card::barb_cotangent(sin, cos)
    }

    /// p_b: distance between neighboring barbs across them, `sin(alpha_b) / N_b`.
    pub fn p_b(&self) -> f32 {
        self.alpha_b().sin() / self.barb_count
    }
}

/// Unit vector at `angle` from the normal (cos, sin) of the left vane, mirrored to `side`.
fn normal(side: Side, angle: f32) -> [f32; 2] {
    [-side.sign() * angle.cos(), angle.sin()]
}

impl Feather {
    /// The vane on a side.
    pub fn vane(&self, side: Side) -> &Vane {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }

    /// The vane on a side as the range query takes it.
    pub fn query_vane<T: Real>(&self, side: Side) -> query::Vane<T> {
        let of = |x: f32| T::of(f64::from(x));
        let vane = self.vane(side);
        query::Vane::from_measures(
            of(vane.barb_count),
            of(vane.barb_angle),
            of(vane.barb_radius_um),
            of(vane.barbules.spacing_um),
            of(vane.barbules.angle),
            of(vane.barbules.distal_radius_um),
            of(vane.barbules.proximal_radius_um),
            of(self.length_mm),
        )
    }

    /// The same with where its barbules hook.
    pub fn card_vane<T: Real>(&self, side: Side) -> query::CardVane<T> {
        let vane = self.vane(side);
        query::CardVane {
            vane: self.query_vane(side),
            fringe: T::of(f64::from(vane.fringe)),
            downy: T::of(f64::from(vane.downy)),
        }
    }

    /// Micrometres as feather lengths.
    pub fn from_um(&self, micrometres: f32) -> f32 {
        micrometres * 1e-3 / self.length_mm
    }

    /// Millimetres as feather lengths.
    pub fn from_mm(&self, millimetres: f32) -> f32 {
        millimetres / self.length_mm
    }

    /// p_b: barb period across the barbs.
    pub fn p_b(&self, side: Side) -> f32 {
        self.query_vane(side).p_b
    }

    /// d_bl: barbule spacing along the barb.
    pub fn d_bl(&self, side: Side) -> f32 {
        self.query_vane(side).d_bl
    }

    /// p_bl: barbule period across the barbules, `d_bl sin(alpha_bl)`.
    pub fn p_bl(&self, side: Side) -> f32 {
        self.query_vane(side).p_bl()
    }

    /// r_b.
    pub fn r_b(&self, side: Side) -> f32 {
        self.query_vane(side).r_b
    }

    /// r_bd.
    pub fn r_bd(&self, side: Side) -> f32 {
        self.query_vane(side).r_bd
    }

    /// r_bp.
    pub fn r_bp(&self, side: Side) -> f32 {
        self.query_vane(side).r_bp
    }

    /// r_r at v: the parabola through base, middle and tip, never below 0.
    pub fn r_r(&self, v: f32) -> f32 {
        let [base, middle, tip] = self.rachis.radius_mm;
        let v = v.clamp(0.0, 1.0);
        let radius = base * (1.0 - v) * (1.0 - 2.0 * v)
            + middle * 4.0 * v * (1.0 - v)
            + tip * v * (2.0 * v - 1.0);
        self.from_mm(radius.max(0.0))
    }

    /// n_b: unit normal of the barbs; on the left (cos alpha_b, sin alpha_b), on the right mirrored in x.
    pub fn n_b(&self, side: Side) -> [f32; 2] {
        normal(side, self.vane(side).alpha_b())
    }

    /// v_b: unit direction of the barbs, root to end; on the left (-sin alpha_b, cos alpha_b).
    pub fn v_b(&self, side: Side) -> [f32; 2] {
        let angle = self.vane(side).alpha_b();
        [side.sign() * angle.sin(), angle.cos()]
    }

    /// n_bd: unit normal of the distal barbules, n_b turned by -alpha_bl.
    pub fn n_bd(&self, side: Side) -> [f32; 2] {
        let vane = self.vane(side);
        normal(side, vane.alpha_b() - vane.alpha_bl())
    }

    /// n_bp: unit normal of the proximal barbules, n_b turned by +alpha_bl.
    pub fn n_bp(&self, side: Side) -> [f32; 2] {
        let vane = self.vane(side);
        normal(side, vane.alpha_b() + vane.alpha_bl())
    }
}
