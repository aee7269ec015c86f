//! Coverage of a footprint by the barbs and barbules of one vane. Twin of `query.wgsl`.

use super::{
    choose::{Choice, ErrorBudget, Evaluator, Lod, choose},
    lattice::lattice_coverage,
    mean::mean_coverage,
    near::near_coverage,
    stripe::stripe_coverage,
    vane::{Cell, Local, Vane, reduce},
};
use crate::maths::{
    footprint::Footprint,
    functions::{Real, clamp},
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

/// Coverage in cell units by the evaluator that the budget asks for: `[barb, distal, proximal]`. `lod`: what is known of the card.
pub fn cell_coverage<T: Real>(
    cell: &Cell<T>,
    local: &Local<T>,
    lod: Lod,
    budget: &ErrorBudget<T>,
) -> [T; 3] {
    let fixed = |evaluator| Choice {
        evaluator,
        beside_switch: false,
        row_budget: T::zero(),
    };
    let choice = match lod {
        Lod::Far => fixed(Evaluator::Stripe),
        Lod::Mean => fixed(Evaluator::Mean),
        // A card of near pixels still asks whether one has to be finer.
        Lod::Near | Lod::Mixed => choose(cell, local, budget.threshold()),
    };
    let raw = match choice.evaluator {
        Evaluator::Mean => mean_coverage(cell),
        Evaluator::Stripe => stripe_coverage(cell, local),
        Evaluator::Lattice => lattice_coverage(cell, local, choice.row_budget),
        Evaluator::Near => near_coverage(
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
pub fn shares<T: Real>(cell: &Cell<T>, [barb, upper, lower]: [T; 3]) -> [T; 3] {
    let barb = clamp(barb, T::zero(), T::one());
    let upper = clamp(upper, T::zero(), T::one() - barb);
    let lower = clamp(lower, T::zero(), T::one() - barb - upper);
    if cell.side < T::zero() {
        [barb, lower, upper]
    } else {
        [barb, upper, lower]
    }
}

/// Coverage of a footprint over the left vane by barbs, distal and proximal barbules. `lod`: what is known of the card.
pub fn vane_coverage<T: Real>(
    cell: &Cell<T>,
    vane: &Vane<T>,
    footprint: &Footprint<T>,
    lod: Lod,
    budget: &ErrorBudget<T>,
) -> [T; 3] {
    if lod == Lod::Mean {
        return shares(cell, mean_coverage(cell));
    }
    cell_coverage(cell, &reduce(cell, vane, footprint), lod, budget)
}
