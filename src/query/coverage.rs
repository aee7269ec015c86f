//! Coverage of a footprint by one vane and by a whole feather.

use super::{
    choose::{ErrorBudget, Evaluator, choose},
    footprint::Footprint,
    lattice::lattice,
    masking::{mask_rachis, mask_vane},
    math::{Real, clamp},
    mean, near,
    split::split_rachis,
    stripe,
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
    let cells = [
        mask_vane(left, view),
        mask_vane(right, [-view[0], view[1], view[2]]),
    ];
    // Where the average serves the whole footprint, it serves its parts.
    let resolved = [(left, *footprint), (right, footprint.mirrored())]
        .iter()
        .zip(&cells)
        .any(|((vane, f), cell)| {
            let choice = choose(cell, &reduce(cell, vane, f), budget.threshold());
            choice.evaluator != Evaluator::Mean
        });
    let split = split_rachis(footprint, mask_rachis(rachis_radius, view), resolved);
    let mut sum = [T::zero(); 3];
    for (vane, cell, parts) in [
        (left, &cells[0], split.left),
        (right, &cells[1], split.right),
    ] {
        let mut side = [T::zero(); 3];
        for part in parts.iter().filter(|part| part.mass != T::zero()) {
            let c = vane_coverage(cell, vane, &part.footprint, budget);
            for (sum, w) in side.iter_mut().zip([c.barb, c.distal, c.proximal]) {
                *sum = *sum + part.mass * w;
            }
        }
        for (sum, w) in sum.iter_mut().zip(side) {
            *sum = *sum + w.max(T::zero());
        }
    }
    // Differences of parts may leave a little too much.
    let total = sum.iter().fold(split.rachis, |sum, w| sum + *w);
    let [barb, distal, proximal] = sum.map(|w| w / total.max(T::one()));
    Coverage {
        rachis: split.rachis / total.max(T::one()),
        barb,
        distal,
        proximal,
    }
}
