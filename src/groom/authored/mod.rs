//! What an artist has put into the file of the skin: masks on its vertices, curves along the lay, stations of rows.
//!
//! Masks are vertex attributes ([`SkinMasks`]), which Bevy's loader passes by: a glTF extension handler ([`attributes`]) keeps them on
//! the entity of the mesh. Curves are line lists and stations are nodes with extras ([`find`]); both are added to the groom.

mod attributes;
mod curves;
mod dress;
mod find;
mod masks;

pub(super) use attributes::read_attributes;
pub use curves::chains;
pub(super) use find::AuthoredParts;
pub use masks::SkinMasks;

use bevy::math::Vec3;

/// Guides and rows of a file, metres, in the model space of the skin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Authored {
    /// Curves along the lay.
    pub guides: Vec<AuthoredGuide>,
    /// Rows of feathers on bones.
    pub rows: Vec<AuthoredRow>,
}

/// A curve along the lay, root to tip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AuthoredGuide {
    /// Points, at least two.
    pub points: Vec<Vec3>,
    /// Extra `mirror`: repeat on the other side.
    pub mirror: bool,
    /// Extra `regions`: only for these (all when empty).
    pub regions: Vec<String>,
}

/// A row of feathers: nodes `row.NAME` (what all its feathers share) and `row.NAME.NUMBER` (its stations).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AuthoredRow {
    /// Its name.
    pub name: String,
    /// Extra `lengths`, metres; a row that the groom has already keeps its own without it.
    pub lengths: Vec<f32>,
    /// Extra `width` of the first and the last feather, metres.
    pub width: Option<[f32; 2]>,
    /// Extra `mirror`: repeat on the other side.
    pub mirror: Option<bool>,
    /// Extra `feather`: index into the groom's feathers.
    pub feather: Option<u16>,
    /// Stations in the order of `at`.
    pub stations: Vec<AuthoredStation>,
}

/// A station of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AuthoredStation {
    /// Extra `at`, place along the row 0..1; evenly by name without it.
    pub at: Option<f32>,
    /// Where the node is.
    pub root: Vec3,
    /// Its y axis (z in Blender): root to tip.
    pub direction: Vec3,
    /// Its z axis (-y in Blender): the normal of the front face.
    pub normal: Vec3,
    /// Extra `ride`: joints that carry the root, `hand_L:0.7, wing_L:0.3`.
    pub ride: Vec<(String, f32)>,
    /// Extra `follow`: joints whose rotation the feather follows.
    pub follow: Vec<(String, f32)>,
}
