//! The range query as published (Chen et al. 2026, Sec. 5.1-5.3), kept so that every chart compares with it.
//!
//! | method | what | source |
//! |---|---|---|
//! | [`points`] | point queries at samples of the footprint | Sec. 5.1 |
//! | [`spatial`] | Gauss-Legendre nodes across the barbs, a sum over barbules at each | Eq. 12-19 |
//! | [`spatial_whole_gap`] | the same with the nodes spread over the whole gap, as Eq. 15 is printed | Eq. 15 |
//! | [`frequency`] | harmonics of barbs, barbules and their overlap | Eq. 20-25 |
//! | [`hard_switch`] | [`frequency`] from `sigma_s >= 2 p_b` on, [`spatial`] below | Sec. 5.3 |
//!
//! What they share with the rest of the crate is the pattern ([`Cell`], masking included) and the footprint in its units
//! ([`Local`]); none of our closed forms is in them. Twin: `query_published.wgsl`.

mod frequency;
mod points;
mod spatial;

pub use frequency::{Orders, frequency};
pub use points::{points, sample};
pub use spatial::{MAX_BARBULES, MAX_PUBLISHED_GAPS, spatial, spatial_whole_gap};

use bevy_plumage::maths::gauss_legendre;
use bevy_plumage::maths::{
    Footprint, Real,
    query::{Cell, Coverage, Local, Vane, coverage::shares, reduce},
};

/// One of the published methods with its settings.
#[derive(Clone, Debug, PartialEq)]
pub enum Method<T> {
    /// [`points`] with this many samples.
    Points(u32),
    /// [`spatial`] with these nodes, see [`gauss_legendre`].
    Spatial(Vec<(T, T)>),
    /// [`spatial_whole_gap`] with these nodes.
    WholeGap(Vec<(T, T)>),
    /// [`frequency`] up to these orders.
    Frequency(Orders),
    /// [`hard_switch`] between the two.
    HardSwitch(Vec<(T, T)>, Orders),
}

impl<T: Real> Method<T> {
    /// Nodes of [`gauss_legendre`] in this precision.
    pub fn nodes(count: usize) -> Vec<(T, T)> {
        gauss_legendre(count)
            .into_iter()
            .map(|(x, w)| (T::of(x), T::of(w)))
            .collect()
    }

    /// `[barb, upper, lower]` in cell units, as the method gives it: not clamped.
    pub fn evaluate(&self, cell: &Cell<T>, local: &Local<T>) -> [T; 3] {
        match self {
            Self::Points(count) => points(cell, local, *count),
            Self::Spatial(nodes) => spatial(cell, local, nodes),
            Self::WholeGap(nodes) => spatial_whole_gap(cell, local, nodes),
            Self::Frequency(orders) => frequency(cell, local, *orders),
            Self::HardSwitch(nodes, orders) => hard_switch(cell, local, nodes, *orders),
        }
    }
}

/// The published switch: the frequency domain where the footprint's deviation across the barbs is two barb periods or more.
pub fn hard_switch<T: Real>(
    cell: &Cell<T>,
    local: &Local<T>,
    nodes: &[(T, T)],
    orders: Orders,
) -> [T; 3] {
    if local.variance >= T::of(4.0) {
        frequency(cell, local, orders)
    } else {
        spatial(cell, local, nodes)
    }
}

/// Coverage of a footprint over the left vane by a published method, clamped to shares as [`vane_coverage`](bevy_plumage::maths::query::vane_coverage) is.
pub fn published_vane_coverage<T: Real>(
    cell: &Cell<T>,
    vane: &Vane<T>,
    footprint: &Footprint<T>,
    method: &Method<T>,
) -> Coverage<T> {
    let [barb, distal, proximal] =
        shares(cell, method.evaluate(cell, &reduce(cell, vane, footprint)));
    Coverage {
        rachis: T::zero(),
        barb,
        distal,
        proximal,
    }
}
