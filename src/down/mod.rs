//! Down and fur: the undercoat below contour feathers, and stand-alone fur on any skinned mesh.
//!
//! Two systems share one periodic [`Tile`] of fibres: a prismatic shell over the skin whose volume is marched (Andersen et al.,
//! *Hybrid fur rendering*), and shells lit by precomputed radiance transfer. The maths is pure; each function that the GPU needs
//! has a WGSL twin of the same name in `shaders/down_*.wgsl`.
//!
//! An app adds [`UndercoatPlugin`] (it is one of the `PlumagePlugins`) and puts an [`Undercoat`] with the handle of a [`Down`]
//! (`*.down.ron`) on any mesh or glTF scene, and [`GuardStrands`] beside it for single hairs.
//!
//! | file | what |
//! |---|---|
//! | `asset`, `loader`, `error` | [`Down`] |
//! | `component` | what apps put on entities |
//! | `bake` | the tile, its transfer and its tables, once for each down |
//! | `meshes`, `refine`, `grow`, `pack`, `hairs`, `wear` | shells and strands over meshes |
//! | `tract` | down below the feathers of a bird, and when it is drawn |
//! | `material`, `extrude`, `plugin` | what a frame draws |

mod asset;
mod bake;
mod component;
pub mod coverage;
pub mod density;
mod error;
mod extrude;
pub mod fragments;
mod grow;
mod hairs;
pub mod harmonics;
pub mod light;
mod loader;
pub mod march;
mod material;
mod meshes;
mod pack;
mod plugin;
pub mod prism;
pub mod published;
pub mod reference;
mod refine;
pub mod shell;
pub mod slab;
pub mod slabs;
pub mod strands;
pub mod texture;
pub mod tier;
pub mod tile;
mod tract;
pub mod transfer;
mod vector;
pub mod walk;
mod wear;

pub use asset::{Coat, Down, Transfer};
pub use component::{
    GuardStrands, Undercoat, UndercoatMode, UndercoatQuality, UndercoatSettings, UndercoatState,
    UndercoatTier, UndercoatView,
};
pub use density::Density;
pub use error::DownError;
pub use loader::DownLoader;
pub use material::{StrandMaterial, StrandUniform, UndercoatMaterial, UndercoatUniform};
pub use plugin::UndercoatPlugin;
pub use tile::Tile;
pub use tract::draws_down;
pub use wear::UndercoatShell;
