//! Down and fur: the undercoat below contour feathers, and stand-alone fur on any skinned mesh.
//!
//! Two systems share one periodic tile of fibres: a prismatic shell over the skin whose volume is marched (Andersen et al.,
//! *Hybrid fur rendering*), and shells lit by precomputed radiance transfer. Assets, components and materials live here; their
//! maths is in `maths::undercoat`. It may use `groom` for the tracts of a bird and `render` for how far they are ruffled;
//! neither may use it.
//!
//! An app adds [`UndercoatPlugin`] (it is one of the `PlumagePlugins`) and puts an [`Undercoat`] with the handle of a [`Down`]
//! (`*.down.ron`) on any mesh or glTF scene, and [`GuardStrands`] beside it for single hairs.
//!
//! | file | what |
//! |---|---|
//! | `component` | what apps put on entities |
//! | `bake` | the tile, its transfer and its tables, once for each down |
//! | `meshes`, `refine`, `grow`, `pack`, `hairs`, `spawn` | shells and strands over meshes |
//! | `tract` | down below the feathers of a bird, and when it is drawn |
//! | `material`, `extrude`, `plugin` | what a frame draws |

mod bake;
mod component;
mod error;
mod extrude;
mod grow;
mod hairs;
#[cfg(feature = "internals")]
pub mod layout;
mod material;
mod meshes;
mod pack;
mod plugin;
mod refine;
mod spawn;
mod tract;

pub use crate::anatomy::{Coat, Down, Interval, Specular, Spread, Transfer};
pub use component::{
    GuardStrands, Undercoat, UndercoatFailed, UndercoatMode, UndercoatOf, UndercoatParts,
    UndercoatQuality, UndercoatReady, UndercoatSettings, UndercoatState, UndercoatSystems,
    UndercoatTier, UndercoatView,
};
pub use error::UndercoatError;
pub use material::{StrandMaterial, StrandUniform, UndercoatMaterial, UndercoatUniform};
pub use plugin::UndercoatPlugin;
pub use spawn::UndercoatShell;
pub use tract::draws_down;
