//! The card record: what the renderer knows of one feather on one bird.

use bevy::math::Vec3;

/// One feather card in bind pose, as groomed. The renderer packs it for the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Card {
    /// Root on the skin, metres, model space of the skinned mesh.
    pub root: Vec3,
    /// Unit direction of the rachis at the root.
    pub along: Vec3,
    /// Unit normal of the front face at the root.
    pub normal: Vec3,
    /// Centre of a sphere that holds every vertex of the card, metres.
    pub center: Vec3,
    /// Radius of that sphere, metres.
    pub radius: f32,
    /// Length from root to tip, metres.
    pub length: f32,
    /// Width of the card, metres.
    pub width: f32,
    /// Joints that carry the root, indices into the card mesh's skin.
    pub joints: [u16; 4],
    /// Their weights; sum 1.
    pub weights: [f32; 4],
    /// Index into [`super::Groom::feathers`].
    pub feather: u16,
    /// Index of the region, then of the row (regions first).
    pub region: u16,
    /// Layer: a higher one lies over a lower one.
    pub layer: f32,
    /// Color the groom gives to the tintable parts of the albedo, linear RGB.
    pub tint: [f32; 3],
    /// Hash of bird seed, region name and place: stays with the feather when others are added.
    pub seed: u32,
    /// Largest angle between the normals of neighboring vertices, radians.
    pub turn: f32,
    /// The feather's left vane becomes its right one (the other side of the bird).
    pub mirrored: bool,
}

/// Where the card's vertices are in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CardGeometry {
    /// First vertex.
    pub first_vertex: u32,
    /// Number of vertices.
    pub vertex_count: u32,
}
