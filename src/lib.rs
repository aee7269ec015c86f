//! Procedural, multiscale, real-time feathers for Bevy.
//!
//! A *groom* scatters feather cards over a skinned bird; a *material* resolves each card into rachis, barbs and barbules, by
//! range queries over the pixel's footprint when the camera is close and by their exact mean when it is far; fibre scattering
//! gives pigment and structural colour. The model follows Chen et al. 2026, *A Procedural, Multiscale and Real-time Feather
//! Appearance Model*, with the corrections that the module documentation names.
//!
//! # Workflow
//!
//! 1. Add [`PlumagePlugins`](prelude::PlumagePlugins) to the app, after `DefaultPlugins`.
//! 2. Spawn a bird: any skinned mesh, e.g. a glTF scene.
//! 3. Put a [`Plumage`](groom::Plumage) with the handle of a [`Groom`](groom::Groom) (`*.groom.ron`) on its root. The groom names the
//!    [`Feather`](anatomy::Feather)s (`*.feather.ron`) that grow in each of its tracts.
//! 4. The plugin grooms in the background; [`PlumageState::is_ready`](groom::PlumageState::is_ready) tells when the cards are there.
//! 5. Optionally put a [`FeatherQuality`](render::FeatherQuality) beside it: error budget, transparency, debug view.
//! 6. Optionally let the air move: [`Wind`](render::Wind) for the world, [`Ruffle`](render::Ruffle) for one bird.
//! 7. Read the counters: `render/feather_cards_*` and `render/feather_lod/elapsed_gpu` in Bevy's diagnostics, and
//!    [`PlumageMemory`](render::PlumageMemory).
//!
//! # Modules
//!
//! [`query`] and [`scattering`] are pure maths, each function with a WGSL twin of the same name in `shaders/`; [`anatomy`] is one
//! feather, [`groom`] puts feathers on a bird, [`render`] draws them; [`curves`] is the slow reference with explicit fibres;
//! `extract` (feature) turns a photograph into a feather, `inspector` (feature) edits everything.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod anatomy;
pub mod curves;
pub mod down;
#[cfg(feature = "extract")]
pub mod extract;
pub mod groom;
#[cfg(feature = "inspector")]
pub mod inspector;
pub mod parameter;
pub mod query;
pub mod render;
pub mod scattering;

mod modified;
mod plugin;
mod shaders;

/// Compiles the code in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// What an app needs.
pub mod prelude {
    pub use crate::{
        anatomy::Feather,
        down::{
            Down, GuardStrands, Undercoat, UndercoatMode, UndercoatPlugin, UndercoatQuality,
            UndercoatSettings, UndercoatState, UndercoatTier, UndercoatView,
        },
        groom::{Groom, Plumage, PlumageState},
        plugin::PlumagePlugins,
        render::{
            CARD_COUNTERS, DebugView, FeatherMaterial, FeatherPath, FeatherQuality,
            FeatherSettings, FeatherTransparency, PlumageMemory, Ruffle, Wind,
        },
    };
}
