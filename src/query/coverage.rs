//! Coverage of a footprint by one vane and by a whole feather.

use super::{
    choose::{ErrorBudget, Evaluator, choose},
    footprint::Footprint,
    lattice::lattice,
    masking::{mask_rachis, mask_vane},
    math::{Real, clamp, normal_density, normal_distribution},
    mean, near, stripe,
    vane::{Cell, Local, Vane, reduce},
};

/// Shares of a footprint that each visible component covers. Disjoint: their sum is at most 1, the rest is what lies behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage<T> {
    /// `w_r`.
    pub rachis: T,
    /// `w_b`.
    pub barb: T,
    /// `w_bd`.
    pub distal: T,
    /// `w_bp`.
    pub proximal: T,
}

impl<T: Real> Coverage<T> {
    /// `w_t = 1 - sum`: the share through which one sees what is behind, in [0, 1].
    pub fn transmission(&self) -> T {
        clamp(
            T::one() - self.rachis - self.barb - self.distal - self.proximal,
            T::zero(),
            T::one(),
        )
    }
}

/// Coverage in cell units by the evaluator that the budget asks for: `[barb, distal, proximal]`.
pub fn cell_coverage<T: Real>(cell: &Cell<T>, local: &Local<T>, budget: &ErrorBudget<T>) -> [T; 3] {
    let choice = choose(cell, local, budget.threshold());
    let raw = match choice.evaluator {
        Evaluator::Mean => mean(cell),
        Evaluator::Stripe => stripe(cell, local),
        Evaluator::Lattice => lattice(cell, local, choice.row_budget),
        Evaluator::Near => near(
            cell,
            local,
            &if choice.beside_switch {
                budget.quality.beside_switch()
            } else {
                budget.quality
            },
        ),
    };
    shares(cell, raw)
}

/// `[barb, upper, lower]` as an evaluator gives it, clamped to disjoint shares and named: `[barb, distal, proximal]`.
pub(crate) fn shares<T: Real>(cell: &Cell<T>, [barb, upper, lower]: [T; 3]) -> [T; 3] {
    let barb = clamp(barb, T::zero(), T::one());
    let upper = clamp(upper, T::zero(), T::one() - barb);
    let lower = clamp(lower, T::zero(), T::one() - barb - upper);
    if cell.side < T::zero() {
        [barb, lower, upper]
    } else {
        [barb, upper, lower]
    }
}

/// Coverage of a footprint over the left vane: barbs, distal and proximal barbules (no rachis).
pub fn vane_coverage<T: Real>(
    cell: &Cell<T>,
    vane: &Vane<T>,
    footprint: &Footprint<T>,
    budget: &ErrorBudget<T>,
) -> Coverage<T> {
    let [barb, distal, proximal] = cell_coverage(cell, &reduce(cell, vane, footprint), budget);
    Coverage {
        rachis: T::zero(),
        barb,
        distal,
        proximal,
    }
}

/// A footprint cut at both sides of the rachis. Masses sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RachisSplit<T> {
    /// Share on the rachis.
    pub rachis: T,
    /// Share left of it.
    pub left_mass: T,
    /// What is left of it, moment-matched.
    pub left: Footprint<T>,
    /// Share right of it.
    pub right_mass: T,
    /// What is right of it, moment-matched, still with `x > 0`.
    pub right: Footprint<T>,
}

/// The part of a footprint below `edge` along x, as a Gaussian of the same mass, mean and covariance.
fn part_below<T: Real>(f: &Footprint<T>, edge: T) -> (T, Footprint<T>) {
    let one = T::one();
    let [xx, xy, yy] = f.covariance;
    let sigma = xx.sqrt();
    let z = (edge - f.mean[0]) / sigma;
    if z > T::of(4.0) {
        return (one, *f);
    }
    let mass = normal_distribution(z);
    if mass < T::of(1e-4) {
        return (T::zero(), *f);
    }
    let ratio = normal_density(z) / mass;
    let shrink = clamp(one - z * ratio - ratio * ratio, T::of(0.02), one);
    let slope = xy / xx;
    let mean = [f.mean[0] - sigma * ratio, f.mean[1] - slope * sigma * ratio];
    let covariance = [xx * shrink, xy * shrink, yy - slope * xy * (one - shrink)];
    (mass, Footprint { mean, covariance })
}

/// Splits a footprint at the rachis, whose edges along x are `edges` (see [`mask_rachis`]).
pub fn split_rachis<T: Real>(footprint: &Footprint<T>, edges: [T; 2]) -> RachisSplit<T> {
    let (f, _) = footprint.widened();
    let (left_mass, left) = part_below(&f, edges[0].min(edges[1]));
    let (right_mass, mirrored) = part_below(&f.mirrored(), -edges[1].max(edges[0]));
    let right = mirrored.mirrored();
    let rachis = clamp(T::one() - left_mass - right_mass, T::zero(), T::one());
    RachisSplit {
        rachis,
        left_mass,
        left,
        right_mass,
        right,
    }
}

/// Coverage of a footprint anywhere on the feather, from the view vector `view` (towards the eye; x, y, front normal).
/// `rachis_radius` in feather lengths.
pub fn feather_coverage<T: Real>(
    left: &Vane<T>,
    right: &Vane<T>,
    rachis_radius: T,
    footprint: &Footprint<T>,
    view: [T; 3],
    budget: &ErrorBudget<T>,
) -> Coverage<T> {
    let split = split_rachis(footprint, mask_rachis(rachis_radius, view));
    let mut sum = Coverage {
        rachis: split.rachis,
        barb: T::zero(),
        distal: T::zero(),
        proximal: T::zero(),
    };
    let mut add = |mass: T, vane: &Vane<T>, f: &Footprint<T>, view: [T; 3]| {
        if mass > T::zero() {
            let c = vane_coverage(&mask_vane(vane, view), vane, f, budget);
            sum.barb = sum.barb + mass * c.barb;
            sum.distal = sum.distal + mass * c.distal;
            sum.proximal = sum.proximal + mass * c.proximal;
        }
    };
    add(split.left_mass, left, &split.left, view);
    add(
        split.right_mass,
        right,
        &split.right.mirrored(),
        [-view[0], view[1], view[2]],
    );
    sum
}
