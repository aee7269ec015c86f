//! The point query (Chen et al. 2026, Eq. 6-8): which fibre lies at a point, and where on it.

use super::{
    masking::{mask_rachis, mask_vane},
    vane::{Cell, Vane, reduce},
};
use crate::maths::{
    footprint::Footprint,
    functions::{Real, wrap},
};

/// What a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Component {
    /// Nothing: one looks through.
    None,
    /// The shaft.
    Rachis,
    /// A barb.
    Barb,
    /// A distal barbule.
    Distal,
    /// A proximal barbule.
    Proximal,
}

/// Result of a point query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointHit<T> {
    /// The visible component.
    pub component: Component,
    /// Signed offset from its centre line along its normal (`+x` rachis, `n_b` barb, `n_bl` barbule), in [-1, 1]; 0 for none.
    pub offset: T,
}

/// The point query in cell units, at `(u, tau)` with `u` in [0, 1).
pub fn cell_point<T: Real>(cell: &Cell<T>, u: T, tau: T) -> PointHit<T> {
    let one = T::one();
    let half = T::of(0.5);
    let back = cell.side < T::zero();
    let hit = |component, offset: T| PointHit {
        component,
        offset: crate::maths::functions::clamp(offset, -one, one),
    };
    let lower_reach = one - cell.v_high;
    if u < cell.v_low || u > cell.v_high {
        let from_barb = if u > cell.v_high { u - one } else { u };
        let h = (half * (cell.v_low + lower_reach)).max(T::of(1e-9));
        let centre = half * (cell.v_low - lower_reach);
        return hit(Component::Barb, cell.side * (from_barb - centre) / h);
    }
    let d = wrap(tau - cell.kappa * u - cell.s_d);
    // Along n_bl the phase falls for the family on barb k and rises for the one on barb k + 1.
    if d.abs() < cell.h_d {
        return if back {
            hit(Component::Proximal, d / cell.h_d)
        } else {
            hit(Component::Distal, -d / cell.h_d)
        };
    }
    let p = wrap(tau - cell.kappa * (one - u) - cell.e_root - cell.s_p);
    if p.abs() < cell.h_p {
        return if back {
            hit(Component::Distal, -p / cell.h_p)
        } else {
            hit(Component::Proximal, p / cell.h_p)
        };
    }
    hit(Component::None, T::zero())
}

/// The point query on the left vane, rachis left out. `point` in feather lengths.
pub fn point_query<T: Real>(cell: &Cell<T>, vane: &Vane<T>, point: [T; 2]) -> PointHit<T> {
    let local = reduce(cell, vane, &Footprint::round(point, T::zero()));
    cell_point(cell, local.u, local.tau)
}

/// The point query on a whole feather seen along `view` (towards the eye; x, y, front normal).
pub fn feather_point_query<T: Real>(
    left: &Vane<T>,
    right: &Vane<T>,
    rachis_radius: T,
    point: [T; 2],
    view: [T; 3],
) -> PointHit<T> {
    let [low, high] = mask_rachis(rachis_radius, view);
    let [x, y] = point;
    if x >= low && x <= high && high > low {
        let offset = (x + x - low - high) / (high - low);
        return PointHit {
            component: Component::Rachis,
            offset,
        };
    }
    if x < low {
        point_query(&mask_vane(left, view), left, point)
    } else {
        point_query(
            &mask_vane(right, [-view[0], view[1], view[2]]),
            right,
            [-x, y],
        )
    }
}
