//! Where feathers grow: the [`Groom`] asset, the [`Plumage`] component, and the cards they become.
//!
//! The way from a groom to cards, each step a module: the skin is taken from the bird's meshes ([`skin`]) and divided into
//! regions ([`select`]); guides give it a lay ([`lay`]); follicles are placed ([`scatter`], [`lattice`]); each feather's shaft is
//! draped over the skin ([`drape`]), put in order ([`order`]) and settled among its neighbours ([`layer`], [`press`]); rows of flight feathers get joints of their
//! own ([`rows`], moved by [`fan`]); all become one mesh ([`mesh`]). [`groom_bird`] runs these without an app;
//! [`GroomPlugin`] runs it for every entity with a [`Plumage`], off the main thread.

mod asset;
mod build;
mod card;
pub mod crossing;
pub mod drape;
mod error;
mod fallback;
pub mod fan;
mod grid;
pub mod lattice;
pub mod lay;
pub mod layer;
mod leaf;
mod loader;
pub mod mesh;
pub mod order;
mod plumage;
pub mod press;
pub mod rows;
pub mod scatter;
pub mod seed;
pub mod select;
pub mod skin;
mod validate;

pub use asset::{
    Dab, Groom, Guide, Jitter, Placement, Region, Row, Select, Span, Station, Tint, painted,
};
pub use build::{Bird, Coat, Ground, groom_bird};
pub use card::{Card, CardGeometry};
pub use error::GroomError;
pub use fan::{FanJoints, fan_rows, fan_transform};
pub use layer::Crossings;
pub use leaf::Leaf;
pub use loader::{GroomLoader, GroomSaver};
pub use plumage::{
    GroomPlugin, GroomSystems, Plumage, PlumageCards, PlumageGround, PlumageOutput, PlumageRepeat,
    PlumageState,
};
pub use rows::FanJoint;
pub use skin::SkinMesh;
