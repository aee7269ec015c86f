//! Down and fur as a volume of fibres, as shells and as strands.
//!
//! Two systems share one periodic [`Tile`] of fibres: a prismatic shell over the skin whose volume is marched (Andersen et al.,
//! *Hybrid fur rendering*), and shells lit by precomputed radiance transfer.
//! What belongs to an asset, an entity or a material is in the room `undercoat`.

pub mod coverage;
pub mod density;
pub mod harmonics;
pub mod light;
pub mod march;
pub mod shell;
pub mod slab;
pub mod strands;
pub mod texture;
pub mod tier;
pub mod tile;
pub mod transfer;
pub mod walk;

pub use density::Density;
pub use tile::Tile;
