//! The feather as explicit curves: a slow reference for tests and charts, not used by the plugin.
//!
//! [`Curves`] enumerates every barb and barbule of a [`Feather`](bevy_plumage::anatomy::Feather) as an elliptic cylinder, the
//! comparison of Chen et al. 2026, Fig. 15. [`Curves::hit`] casts a ray at them; [`CurveShader`] lights the hit with the same
//! fibre scattering K that the plugin uses; [`CurveCamera`] makes pixels of it with the plugin's Gaussian footprint. Nothing
//! here shares code with the range query ([`bevy_plumage::maths::query`]) or its masking: coverage, masking and shadows come out of rays.
//!
//! Space. *Card space* is the feather's flat card in units of its length: `x = (u - 0.5) aspect`, `y = v`, z out of the front
//! face. A ray is carried into canonical space (rachis on `x = 0`, see [`bevy_plumage::anatomy`]) by the shaft curve's tangent where it
//! meets the card, which is exact for a straight shaft and off by the curve's bend over a barb's thickness otherwise.
//!
//! Layout. Barb axes lie in the card's plane; distal barbules lie above the plane and proximal ones below it by half their
//! radius, so that distal covers proximal from the front and the other way from behind. A barbule spans the gap between the
//! flanks of two barbs and is cut at the outline; barbules beside the shaft grow from the shaft.

mod build;
mod camera;
mod near;
mod path;
mod shade;
mod trace;

pub use build::{Barb, Barbule, Curves};
pub use camera::{CurveCamera, normal_quantile};
pub use near::{near_field, near_field_lobes};
pub use path::{Escape, furnace_path};
pub use shade::{CurveOptions, CurveShader, Field, Visibility};
pub use trace::{CurveHit, FibreId, Part, Ray};
