//! Interference colors of barbules: thin layers of keratin, melanin and air (docs/book/iridescence.md).
//!
//! [`Iridescence`] describes the layers, [`Stack`] is made of it, [`StackTable`] holds the stack's color over the angle, and the facet
//! lobe ([`facet_evaluate`]) takes its color from there at the half vector. The shader module `interference.wgsl` holds the lobe and the
//! table's lookup under the same names.

mod complex;
mod facet;
mod observer;
mod scale;
mod seen;
mod stack;
mod structure;
mod table;
mod transfer;

pub use complex::Complex;
pub use facet::{
    FacetEye, FacetSample, FacetView, Facets, facet_color, facet_density, facet_evaluate,
    facet_eye, facet_let_in, facet_node, facet_pdf, facet_sample, facet_share, facet_turn,
    facet_view,
};
pub use observer::{FIRST_WAVELENGTH, WAVELENGTH_STEP, WAVELENGTHS, rgb_weights, wavelengths};
pub use scale::{ScaleMap, ScalePlace, scale_mix, scale_place};
pub use seen::{
    FacetSeen, SEEN_STEPS, SeenPlace, SeenTable, facet_area, facet_constants, seen_place,
};
pub use stack::{Layer, MIXING, Material, REALIZATIONS, Stack, keratin_index, melanin_index};
pub use structure::{Base, Iridescence, Structure};
pub use table::{
    SCALE_RATIO, SCALED_TEXELS, STACK_TEXELS, Simplex, StackLook, StackTable, bare, cell_simplex,
    cell_triangle, in_gamut, scale_rows, scaled_row, stack_colors, stack_reflectance,
};
pub use transfer::{Film, Flow, Polarization, film_flow};
