//! Which evaluator is good enough, per pixel or for a whole card.

use super::vane::{Cell, Local, Vane};
use crate::maths::functions::Real;

/// What averages over whole footprints averages over the parts that a line leaves of them, if it does so with this much to spare.
pub(super) const PARTS_MARGIN: f64 = 4.0;

/// The four evaluators, dearest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Evaluator {
    /// Everything resolved: [`super::near_coverage`].
    Near,
    /// Barbs resolved, the few harmonics of the barbules that are left added: [`super::lattice_coverage`].
    Lattice,
    /// Barbs resolved, barbules averaged along the barb: [`super::stripe_coverage`].
    Stripe,
    /// A constant of the cell: [`super::mean_coverage`].
    Mean,
}

/// What is known of all pixels of a card. The discriminants are the shader's `LOD_` constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Lod {
    /// Every pixel wants [`Evaluator::Near`].
    Near = 1,
    /// [`Evaluator::Stripe`] is good enough for every pixel.
    Far = 2,
    /// [`Evaluator::Mean`] is good enough for every pixel.
    Mean = 3,
    /// Decide per pixel.
    Mixed = 4,
}

/// How finely NEAR cuts (docs/book/range_queries.md#the-chooser).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality<T> {
    /// `z`: sigmas of the footprint that are looked at, 2..5.
    pub reach: T,
    /// `rho`: largest cell in barbule periods, 0.05..1.
    pub cell_phase: T,
    /// `zw`: largest cell in sigmas of the footprint, 0.1..1.5.
    pub cell_sigmas: T,
    /// `sharp`: a cut segment shorter than this many conditional sigmas is one cell.
    pub single_sigmas: T,
    /// `pz`: squared sigmas from which an edge counts as out of reach.
    pub edge_sigmas_squared: T,
    /// `kr`: largest cell as a multiple of the narrowest arc.
    pub least_arc: T,
    /// How far below `cell_sigmas` cells shrink where the edges are sharp, as a factor, 0.1..1.
    pub least_sigmas: T,
}

impl<T: Real> Quality<T> {
    fn of(values: [f64; 7]) -> Self {
        let [
            reach,
            cell_phase,
            cell_sigmas,
            single_sigmas,
            edge_sigmas_squared,
            least_arc,
            least_sigmas,
        ] = values.map(T::of);
        Self {
            reach,
            cell_phase,
            cell_sigmas,
            single_sigmas,
            edge_sigmas_squared,
            least_arc,
            least_sigmas,
        }
    }

    /// RMS error about 0.001.
    pub fn draft() -> Self {
        Self::of([3.0, 0.5, 1.0, 1.5, 7.5, 0.8, 0.35])
    }

    /// RMS error about 0.0003.
    pub fn standard() -> Self {
        Self::of([3.0, 0.4, 0.75, 1.5, 9.0, 0.8, 0.18])
    }

    /// RMS error about 0.0002.
    pub fn tight() -> Self {
        Self::of([3.2, 0.3, 0.6, 1.5, 9.0, 0.8, 0.15])
    }

    /// RMS error about 0.0001.
    pub fn high() -> Self {
        Self::of([3.5, 0.15, 0.4, 0.8, 10.0, 0.8, 0.15])
    }

    /// RMS error below 0.0001, at twice the cost of [`Self::tight`].
    pub fn strict() -> Self {
        Self::of([3.5, 0.1, 0.3, 0.8, 12.0, 0.6, 0.12])
    }

    /// The cheapest of the five whose error is that of the switches at [`ErrorBudget::threshold`]: the numbers are the thresholds
    /// of the budgets 0.0075, 0.0015, 0.00075 and 0.0004 (docs/book/fits/chooser.py).
    pub fn for_threshold(threshold: T) -> Self {
        if threshold < T::of(0.2425) {
            Self::draft()
        } else if threshold < T::of(0.324) {
            Self::standard()
        } else if threshold < T::of(0.359) {
            Self::tight()
        } else if threshold < T::of(0.391) {
            Self::high()
        } else {
            Self::strict()
        }
    }

    /// As close as it needs to be to LATTICE and STRIPE just before the switch.
    pub fn beside_switch(&self) -> Self {
        Self {
            cell_phase: self.cell_phase.min(T::of(0.2)),
            cell_sigmas: self.cell_sigmas.min(T::of(0.5)),
            ..*self
        }
    }
}

/// How wrong a coverage may be, and what follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBudget<T> {
    /// Largest error that a switch to a cheaper evaluator may bring, 1e-4..0.05.
    pub epsilon: T,
    /// How finely NEAR cuts.
    pub quality: Quality<T>,
}

impl<T: Real> Default for ErrorBudget<T> {
    /// Half a step of an 8-bit image.
    fn default() -> Self {
        Self::new(T::of(1.0 / 510.0))
    }
}

impl<T: Real> ErrorBudget<T> {
    /// The budget that one number asks for: `epsilon` is moved into 1e-4..0.05, and NEAR is as good as the switches.
    pub fn new(epsilon: T) -> Self {
        let budget = Self {
            epsilon: crate::maths::functions::clamp(epsilon, T::of(1e-4), T::of(0.05)),
            quality: Quality::standard(),
        };
        Self {
            quality: Quality::for_threshold(budget.threshold()),
            ..budget
        }
    }

    /// Largest error of one weight that is promised where [`choose`] picks this evaluator.
    ///
    /// MEAN and STRIPE: what the dropped harmonics may add up to (docs/book/range_queries.md#the-chooser). LATTICE and NEAR:
    /// measured, with a margin, over a million random footprints (`tests/query_bounds.rs`).
    pub fn bound(&self, evaluator: Evaluator) -> T {
        // What the approximations of one variable leave whatever the budget.
        let floor = T::of(3e-4);
        let promised = match evaluator {
            Evaluator::Mean => return T::of(1.5) * self.epsilon + floor,
            Evaluator::Stripe | Evaluator::Lattice => return T::of(2.0) * self.epsilon + floor,
            Evaluator::Near => self.quality,
        };
        if promised.cell_sigmas > T::of(0.9) {
            T::of(0.06)
        } else {
            T::of(0.03)
        }
    }

    /// Variance, in periods squared, from which a pattern may be replaced by its average: dropping every harmonic costs at most
    /// `(2 / pi) exp(-2 pi^2 v)` per direction. 0.275 for 1/255. This is the shader's `threshold`.
    pub fn threshold(&self) -> T {
        (T::of(0.9) / crate::maths::functions::clamp(self.epsilon, T::of(1e-6), T::of(0.5))).ln()
            / T::of(19.739_208_8)
    }
}

/// Exponent budget of the first row of harmonics along the barb: below the conditional variance, none of them shows.
/// Weighs the density of the harmonics and what a train that crosses the gap leaves of them (constants:
/// docs/book/range_queries.md#the-chooser, docs/book/fits/chooser.py and row_budget.py).
pub(crate) fn row_budget<T: Real>(cell: &Cell<T>, local: &Local<T>, threshold: T) -> T {
    let sigma = local.variance.sqrt();
    let one = T::one();
    let density = (T::of(0.16) / (local.variance * local.conditional).sqrt()).max(one);
    let slowest = (cell.kappa - local.slope)
        .abs()
        .min((cell.kappa + local.slope).abs());
    let x = (slowest - T::of(0.47) / sigma).max(T::of(0.32));
    let window = (one.max((one + T::of(0.4) / sigma).min(T::of(3.2) * x))
        / (T::of(core::f64::consts::PI) * x))
        .min(one);
    threshold + (window * density).ln() / T::of(19.739_208_8)
}

/// What the chooser picked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice<T> {
    /// The cheapest evaluator within the budget.
    pub evaluator: Evaluator,
    /// NEAR has to be finer, because it is close to a switch.
    pub beside_switch: bool,
    /// Exponents that LATTICE keeps.
    pub row_budget: T,
}

/// The cheapest evaluator within the budget (docs/book/range_queries.md#the-chooser); `threshold` of [`ErrorBudget::threshold`].
pub fn choose<T: Real>(cell: &Cell<T>, local: &Local<T>, threshold: T) -> Choice<T> {
    let pick = |evaluator, beside_switch, row_budget| Choice {
        evaluator,
        beside_switch,
        row_budget,
    };
    let zero = T::zero();
    // What STRIPE leaves out of the teeth inside a gap is below half the budget from here on (docs/book/fits/chooser.py).
    let least_teeth = (threshold - T::of(0.041)).max(T::of(0.05));
    let teeth = T::of(4.0) * cell.kappa * cell.kappa * local.variance;
    if local.conditional > threshold {
        if local.variance > threshold {
            return pick(Evaluator::Mean, false, zero);
        }
        if teeth > least_teeth {
            return pick(Evaluator::Stripe, false, zero);
        }
    }
    if teeth <= T::of(0.0625) {
        return pick(Evaluator::Near, false, zero);
    }
    let budget = row_budget(cell, local, threshold);
    if teeth > least_teeth && local.conditional > budget {
        return pick(Evaluator::Stripe, false, budget);
    }
    let sigma = local.variance.sqrt();
    let limit = T::of(f64::from(super::lattice::MAX_ROWS));
    let rows = (budget.max(zero) / local.conditional).sqrt().floor();
    // Sum over the rows of their lengths, an ellipse's area and one node a row for the rounding.
    let nodes = rows
        + T::of(core::f64::consts::FRAC_PI_2) * budget.max(zero)
            / (local.conditional * local.variance).sqrt();
    let open = cell.v_high - cell.v_low;
    let climb = climb(cell, local);
    let cells = T::of(6.0) * sigma * open.max(T::one() - open) * climb / T::of(0.4) + T::one();
    let many = local.variance > T::of(25.0);
    if teeth > least_teeth && (many || (rows <= limit && T::of(1.2) * nodes <= cells)) {
        return pick(Evaluator::Lattice, false, budget);
    }
    let beside_switch = T::of(6.0) * nodes < T::of(7.0) * cells;
    pick(Evaluator::Near, beside_switch, budget)
}

/// Barbule periods that the edges climb across the footprint per barb period.
pub(crate) fn climb<T: Real>(cell: &Cell<T>, local: &Local<T>) -> T {
    if local.conditional < T::of(0.2) {
        cell.kappa + local.slope.abs()
    } else {
        cell.kappa
    }
}

/// What can be said of every footprint whose minor axis is at least `sigma_minor_min` and whose major one at most
/// `sigma_major_max` (standard deviations, feather lengths). `Far` and `Mean` are promised for each of them; `Near` too.
pub fn classify_bounds<T: Real>(
    vane: &Vane<T>,
    sigma_minor_min: T,
    sigma_major_max: T,
    threshold: T,
) -> Lod {
    let least_teeth = (threshold - T::of(0.041)).max(T::of(0.05));
    let square = |x: T| x * x;
    let across = square(sigma_minor_min / vane.p_b);
    let along = square(sigma_minor_min / vane.d_bl);
    let kappa = (vane.cos_bl / vane.sin_bl * vane.p_b / vane.d_bl).max(T::of(0.01));
    let teeth = T::of(4.0) * kappa * kappa;
    // A footprint contains the disc of its minor axis, so neither variance (not even the conditional one) falls below it.
    if along > threshold && across > threshold {
        return Lod::Mean;
    }
    // Stripes serve what the rachis or the outline leave of a footprint, too.
    if along > T::of(PARTS_MARGIN) * threshold && teeth * across > least_teeth {
        return Lod::Far;
    }
    let across_max = square(sigma_major_max / vane.p_b);
    let along_max = square(sigma_major_max / vane.d_bl);
    if teeth * across_max <= least_teeth && (along_max <= threshold || across_max <= threshold) {
        return Lod::Near;
    }
    Lod::Mixed
}
