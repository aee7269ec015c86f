//! Where feathers grow: the [`Groom`] asset, the [`Plumage`] component, and the cards they become.
//!
//! The way from a groom to cards, each step a module: the skin is taken from the bird's meshes ([`skin`]) and divided into
//! regions ([`select`]); guides give it a lay ([`lay`]); follicles are placed ([`scatter`], [`lattice`]); each feather's shaft is
//! draped over the skin ([`drape`]), put in order ([`order`]) and settled among its neighbors ([`layer`], [`settle`]) in each pose that the bird wears ([`WornPoses`]); rows of
//! flight feathers get joints of their own ([`rows`], moved by [`fan`]); all become one mesh ([`mesh`]), and each card is made as wide as its feather ([`fit_cards`]). [`groom_bird`] runs these without an app;
//! [`GroomPlugin`] runs it for every entity with a [`Plumage`], off the main thread.
//!
//! What decides where a feather grows and how it lies lives here. It may use `anatomy` and `maths`; it may not know materials,
//! shaders or the GPU.

mod asset;
mod authored;
mod bird;
mod build;
mod card;
mod carried;
mod cells;
mod coats;
mod component;
mod contact;
pub mod drape;
mod drawing;
mod error;
mod facets;
mod fallback;
pub mod fan;
mod field;
mod fit;
pub mod grid;
mod job;
pub mod lattice;
pub mod lay;
pub mod layer;
mod leaf;
mod mask_images;
mod mask_textures;
pub mod mesh;
mod nearest;
pub mod order;
mod plumage;
mod pose;
mod press;
pub mod rows;
pub mod scatter;
mod seen;
pub mod select;
pub mod settle;
pub mod skin;
mod skin_meshes;
mod skin_textures;
mod stretch;
mod v1;
mod validate;
mod worn;

pub use asset::{
    Dab, Groom, Guide, Jitter, JointWeight, Placement, Region, Row, Segments, Select, Span,
    Station, Tint, painted,
};
pub use authored::{Authored, AuthoredGuide, AuthoredRow, AuthoredStation, SkinMasks, chains};
pub use bird::Bird;
#[cfg(feature = "internals")]
pub use build::groom_with;
pub use build::{Coat, DownTract, groom_bird};
pub use card::{Card, CardGeometry};
pub use component::{
    CardRegion, CardRoots, DownTracts, FeathersOf, NotSkin, Plumage, PlumageCards, PlumageFailed,
    PlumageParts, PlumageReady, PlumageState, PlumageSystems, SkinColors,
};
pub use error::{GroomError, MaskFlaw, SkinFlaw};
pub use fan::{FanJoints, fan_rows, fan_transform};
pub use fit::{EDGE_MARK, fit_cards};
pub use layer::Crossings;
pub use leaf::Leaf;
pub use mask_textures::{Channel, MaskTexture, MaskValues, PlumageMasks, SkinTexture};
pub(crate) use mask_textures::{address_modes, texel};
#[cfg(any(feature = "inspector", feature = "internals"))]
pub use nearest::PointTree;
pub use plumage::GroomPlugin;
pub use pose::{JointPose, KeyPose};
pub use rows::FanJoint;
pub use skin::{SkinMesh, SurfacePoint};
pub use worn::{ATTRIBUTE_RAISED, Wear, WornPoses};
pub(crate) use worn::{Worn, find_worn};
