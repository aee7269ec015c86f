//! Where feathers grow: the [`Groom`] asset, the [`Plumage`] component, and the cards they become.

mod asset;
mod card;
pub use asset::{Groom, Guide, Jitter, Placement, Region, Row, Select, Span, Station, Tint};
pub use card::{Card, CardGeometry};
