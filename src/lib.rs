//! Procedural, multiscale, real-time feathers for Bevy.
//!
//! A *groom* scatters feather cards over a skinned bird; a *material* resolves each card into rachis, barbs and barbules, by
//! range queries over the pixel's footprint when the camera is close and by their exact mean when it is far; fibre scattering
//! gives pigment and structural color. The model follows Chen et al. 2026, *A Procedural, Multiscale and Real-time Feather
//! Appearance Model*, with the corrections that the module documentation names.
//!
//! # Workflow
//!
//! 1. Add [`PlumagePlugins`] to the app, after `DefaultPlugins`.
//! 2. Spawn a bird: any skinned mesh, e.g. a glTF scene.
//! 3. Put a [`Plumage`] with the handle of a [`Groom`] (`*.groom.ron`) on its root. The groom names the
//!    [`Feather`]s (`*.feather.ron`) that grow in each of its tracts.
//! 4. The plugin grooms in the background; [`PlumageState::is_ready`] tells when the cards are there.
//! 5. Optionally put a [`FeatherQuality`] beside it: error budget, transparency, debug view.
//! 6. Optionally let the air move: [`Wind`] for the world, [`Ruffle`] for one bird.
//! 7. Read the counters: `render/feather_cards_*` and `render/feather_lod/elapsed_gpu` in Bevy's diagnostics, and
//!    [`PlumageMemory`].
//!
//! # What is where
//!
//! Everything an app needs is in the [`prelude`]; what the assets are made of is at the root of the crate. Feature `photo` turns a
//! photograph into a feather (`photo`), feature `inspector` edits everything (`inspector`), feature `comparison` adds the published
//! range query to [`CoverageMethod`]. Derivations and figures are in the repository's `docs/book`.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// Twins of shader functions and the like, which the workspace's own tests and tools alone call.
#![cfg_attr(not(feature = "internals"), allow(dead_code, unused_imports))]

// The rooms. Only the workspace's own tests and tools enter them directly (feature `internals`, no promise of stability); what a
// user needs of them is re-exported below.
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod anatomy;
#[cfg(not(feature = "internals"))]
mod anatomy;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod asset;
#[cfg(not(feature = "internals"))]
mod asset;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod groom;
#[cfg(not(feature = "internals"))]
mod groom;
#[cfg(feature = "inspector")]
pub mod inspector;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod maths;
#[cfg(not(feature = "internals"))]
mod maths;
mod modified;
mod parameter;
#[cfg(feature = "photo")]
pub mod photo;
mod plugin;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod render;
#[cfg(not(feature = "internals"))]
mod render;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod shaders;
#[cfg(not(feature = "internals"))]
mod shaders;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod skin_color;
#[cfg(not(feature = "internals"))]
mod skin_color;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod undercoat;
#[cfg(not(feature = "internals"))]
mod undercoat;
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod weathering;
#[cfg(not(feature = "internals"))]
mod weathering;

pub use anatomy::{
    Albedo, AnatomyPlugin, Barbules, Bars, Clumps, Coat, ColorShare, Contour, Down, Feather, Gaps,
    Interval, Pattern, Rachis, Rim, Specular, Spot, Spread, Stop, Transfer, Vane, Weather,
};
pub use asset::{AssetError, AssetLink, RonAsset, RonLoader, RonSaver};
pub use groom::{
    Card, CardGeometry, CardRegion, Channel, Dab, FanJoint, FanJoints, FeathersOf, Groom,
    GroomError, GroomPlugin, Guide, Jitter, JointPose, JointWeight, KeyPose, MaskFlaw, MaskTexture,
    MaskValues, NotSkin, Placement, Plumage, PlumageCards, PlumageFailed, PlumageMasks,
    PlumageParts, PlumageReady, PlumageState, PlumageSystems, Region, Row, Segments, Select,
    SkinFlaw, SkinMasks, Span, Station, Tint,
};
pub use maths::scattering::interference::{Base, Iridescence, ScaleMap, Structure};
pub use maths::scattering::{Fibre, FibreKind, Optics, Sheen};
pub use parameter::{Length, Parameter};
pub use plugin::PlumagePlugins;
pub use render::{
    ActiveFeatherPath, BakedFeather, CARD_COUNTERS, CoverageMethod, DebugView, FeatherMaterial,
    FeatherPath, FeatherQuality, FeatherRenderPlugin, FeatherSettings, FeatherTransparency,
    PlumageMemory, Ruffle, Wind, fit_cascades,
};
pub use skin_color::SkinColorPlugin;
pub use undercoat::{
    GuardStrands, Undercoat, UndercoatFailed, UndercoatMode, UndercoatOf, UndercoatParts,
    UndercoatPlugin, UndercoatQuality, UndercoatReady, UndercoatSettings, UndercoatState,
    UndercoatSystems, UndercoatTier, UndercoatView,
};
pub use weathering::{Weathering, WeatheringPlugin};

/// Compiles the code in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// What an app needs.
pub mod prelude {
    pub use crate::{
        CoverageMethod, DebugView, Down, Feather, FeatherMaterial, FeatherPath, FeatherQuality,
        FeatherRenderPlugin, FeatherSettings, FeatherTransparency, Groom, GuardStrands, Plumage,
        PlumageCards, PlumageFailed, PlumageMemory, PlumagePlugins, PlumageReady, PlumageState,
        PlumageSystems, RonAsset, Ruffle, Undercoat, UndercoatMode, UndercoatQuality,
        UndercoatSettings, UndercoatState, UndercoatTier, UndercoatView, Weather, Weathering, Wind,
        fit_cascades,
    };
}
