//! Coverage of a pixel footprint by rachis, barbs and barbules. Pure maths: no app, no GPU.
//!
//! A *footprint* ([`Footprint`]) is a Gaussian over the feather's canonical plane (unit: feather length, rachis on `x = 0`,
//! tip at `+y`). The *range query* asks which share of it each visible component covers ([`Coverage`]):
//!
//! 1. [`mask_vane`] turns a [`Vane`] and a view direction into a [`Cell`], the vane's pattern in units of its own two periods.
//! 2. [`reduce`] brings the footprint into that cell ([`Local`]).
//! 3. [`choose`] picks an evaluator within an [`ErrorBudget`]: [`near()`] resolves everything, [`stripe()`] averages along the
//!    barb, [`lattice()`] adds the few harmonics that this leaves out, [`mean()`] is a constant of the cell.
//! 4. [`feather_coverage`] does all of it for both vanes and cuts a footprint that lies across the rachis or an outline
//!    ([`split_line`]).
//!
//! The light looks through the same fibres: [`vane_shadow`] is masking seen from a light.
//!
//! | evaluator | differs from the exact coverage by at most ([`ErrorBudget::bound`]) | cost |
//! |---|---|---|
//! | MEAN | 1.5 budgets | nothing: a constant of the card |
//! | STRIPE | 2 budgets | a closed form |
//! | LATTICE | 2 budgets | a closed form and up to a few dozen harmonics |
//! | NEAR | 0.03 at the default budget | closed forms, or up to 144 cells |
//!
//! Everything is generic over `f32` and `f64` and has a twin of the same name in
//! `src/shaders/{math,masking,query,query_far,query_near,query_split,shadow}.wgsl`.
//! The derivations, bounds and measurements are those of the range query study; equation numbers are those of
//! Chen et al. 2026. [`mod@reference`] judges the evaluators and shares no code with them.
//!
//! Conventions for the left vane (`x < 0`; the right one is its mirror image): barb normal `n_b = (cos a, sin a)`, barb
//! direction `v_b = (-sin a, cos a)`, `s = n_b.x`, `t = v_b.x`; barb `k` leaves the rachis at `y = k / N_b`. In the gap above
//! barb `k` the distal barbules hang on barb `k`, the proximal ones on barb `k + 1`. From the front, distal lies over proximal.

mod choose;
mod coverage;
mod error;
mod footprint;
mod lattice;
mod masking;
pub mod math;
mod mean;
mod near;
mod point;
pub mod published;
pub mod reference;
mod shadow;
mod split;
mod stripe;
mod vane;

pub use choose::{Choice, ErrorBudget, Evaluator, Lod, Quality, choose, classify_bounds};
pub use coverage::{Coverage, cell_coverage, feather_coverage, outlined_coverage, vane_coverage};
pub use error::QueryError;
pub use footprint::Footprint;
pub use lattice::{MAX_COLUMNS, MAX_ROWS, lattice};
pub use masking::{mask_rachis, mask_strip, mask_vane};
pub use math::Real;
pub use mean::mean;
pub use near::{MAX_CELLS, MAX_GAPS, near, near_counted};
pub use point::{Component, PointHit, feather_point_query, point_query};
pub use shadow::{VaneSight, mean_shadow, vane_shadow, vane_sight};
pub use split::{
    Line, MAX_OUTLINE_NODES, Outline, PARTS, Part, outline_share, split_line, split_vane,
};
pub use stripe::stripe;
pub use vane::{Cell, Local, Vane, reduce};
