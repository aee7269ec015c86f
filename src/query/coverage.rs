//! Coverage of a footprint by one vane and by a whole feather.

use super::{
    choose::{ErrorBudget, Evaluator, PARTS_MARGIN, choose},
    footprint::Footprint,
    lattice::lattice,
    masking::{mask_rachis, mask_vane},
    math::{Real, clamp},
    mean, near,
    split::{Line, Outline, split_vane},
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

/// Whether the average serves not only a footprint but what a line leaves of it, too.
fn averages<T: Real>(local: &Local<T>, threshold: T) -> bool {
    local.variance.min(local.conditional) > T::of(PARTS_MARGIN) * threshold
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
    outlined_coverage(
        [left, right],
        rachis_radius,
        [None; 2],
        footprint,
        view,
        budget,
    )
}

/// The same where the vanes end at outlines, given over the left vane (the right one mirrored); `None` for a vane without end.
pub fn outlined_coverage<T: Real>(
    vanes: [&Vane<T>; 2],
    rachis_radius: T,
    outlines: [Option<Outline<T>>; 2],
    footprint: &Footprint<T>,
    view: [T; 3],
    budget: &ErrorBudget<T>,
) -> Coverage<T> {
    let (f, _) = footprint.widened();
    let [low, high] = mask_rachis(rachis_radius, view);
    let far = T::of(1e3);
    let edges = [low.min(high), -low.max(high)];
    let beside = |f: &Footprint<T>, edge: T| {
        Line {
            offset: clamp(edge, -far, far),
            gradient: [-T::one(), T::zero()],
        }
        .share(f)
    };
    let footprints = [f, f.mirrored()];
    let off = beside(&footprints[0], edges[0]) + beside(&footprints[1], edges[1]);
    let rachis = clamp(T::one() - off, T::zero(), T::one());
    let mut sum = [T::zero(); 3];
    for side in 0..2 {
        let vane = vanes[side];
        let f = &footprints[side];
        let mirror = if side == 0 { T::one() } else { -T::one() };
        let cell = mask_vane(vane, [mirror * view[0], view[1], view[2]]);
        let resolved = !averages(&reduce(&cell, vane, f), budget.threshold());
        let mut covered = [T::zero(); 3];
        let parts = split_vane(f, clamp(edges[side], -far, far), outlines[side], resolved);
        for part in parts.iter().filter(|part| part.mass != T::zero()) {
            let c = vane_coverage(&cell, vane, &part.footprint, budget);
            for (sum, w) in covered.iter_mut().zip([c.barb, c.distal, c.proximal]) {
                *sum = *sum + part.mass * w;
            }
        }
        for (sum, w) in sum.iter_mut().zip(covered) {
            *sum = *sum + w.max(T::zero());
        }
    }
    // Differences of parts may leave a little too much.
    let total = sum.iter().fold(rachis, |sum, w| sum + *w).max(T::one());
    let [barb, distal, proximal] = sum.map(|w| w / total);
    Coverage {
        rachis: rachis / total,
        barb,
        distal,
        proximal,
    }
}
