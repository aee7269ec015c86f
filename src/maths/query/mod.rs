//! Coverage of a pixel footprint by rachis, barbs and barbules. Pure maths: no app, no GPU, and nothing of `scattering` or
//! `undercoat`.
//!
//! A *footprint* ([`Footprint`](super::Footprint)) is a Gaussian over the feather's canonical plane (unit: feather length, rachis on `x = 0`,
//! tip at `+y`). The *range query* asks which share of it each visible component covers ([`Coverage`]):
//!
//! 1. [`mask_vane`] turns a [`Vane`] and a view direction into a [`Cell`], the vane's pattern in units of its own two periods.
//! 2. [`reduce`] brings the footprint into that cell ([`Local`]).
//! 3. [`choose()`] picks an evaluator within an [`ErrorBudget`]: [`near_coverage`] resolves everything, [`stripe_coverage`] averages
//!    along the barb, [`lattice_coverage`] adds the few harmonics that this leaves out, [`mean_coverage`] is a constant of the cell.
//! 4. [`cover`] does all of it for both vanes as a card shows them, and cuts a footprint that lies across the rachis or an outline
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
//! Everything is generic over `f32` and `f64`. What is drawn has a twin of the same name in
//! `src/shaders/maths/{math,footprint,masking,query,query_far,query_near,query_split,query_map,query_feather,shadow}.wgsl`; a method is a
//! function of that name there.
//! Derivations, bounds and measurements are in `docs/book/range_queries.md`; equation numbers are those of
//! Chen et al. 2026.
//!
//! Conventions for the left vane (`x < 0`; the right one is its mirror image): barb normal `n_b = (cos a, sin a)`, barb
//! direction `v_b = (-sin a, cos a)`, `s = n_b.x`, `t = v_b.x`; barb `k` leaves the rachis at `y = k / N_b`. In the gap above
//! barb `k` the distal barbules hang on barb `k`, the proximal ones on barb `k + 1`. From the front, distal lies over proximal.

mod choose;
pub mod coverage;
pub mod feather;
mod lattice;
pub mod map;
mod masking;
mod mean;
mod near;
pub mod point;
mod shadow;
mod split;
mod stripe;
pub mod vane;

pub use choose::{Choice, ErrorBudget, Evaluator, Lod, Quality, choose, classify_bounds};
pub use coverage::{Coverage, cell_coverage, vane_coverage};
pub use feather::{
    CardFeather, CardVane, Outline, cover, cover_vane, feather_coverage, mean_stop, mean_vane,
};
pub use lattice::{MAX_COLUMNS, MAX_ROWS, lattice_coverage};
pub use map::{
    LAST_MAP_LEVEL, MAP_MARGIN, MAP_SIZE, MAX_MAP_LOOKS, MapSight, map_border, map_decided,
    map_place, map_share, map_sight, map_vanes,
};
pub use masking::{
    BarbStrip, Family, Storey, Storeys, VaneShape, barb_hidden, barb_strip, mask_rachis,
    mask_strip, mask_vane, storeys, vane_shape, vane_stop,
};
pub use mean::mean_coverage;
pub use near::{MAX_CELLS, MAX_GAPS, near_counted, near_coverage};
pub use point::{Component, PointHit, feather_point_query, point_query};
pub use shadow::{
    MirrorPlace, PartEye, VaneEye, VaneLight, VaneRay, barb_eye, barb_light, grating_frequency,
    lower_eye, lower_light, mirror_retreat, shaft_light, upper_eye, upper_light, vane_caught,
    vane_eye, vane_ray, vane_shadow,
};
pub use split::{
    Line, LineCut, MAX_OUTLINE_NODES, PARTS, Part, ended_share, line_part, line_parts, line_share,
    outline_share, split_line,
};
pub use stripe::stripe_coverage;
pub use vane::{Cell, Local, Vane, reduce};
