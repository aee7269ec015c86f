//! What is baked, taken from the world: cards, their mesh, their feathers, and the joints that carry them.

use bevy::{
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_plumage::{
    BakedFeather, Card, CardGeometry, FanJoints, Feather, PlumageCards, PlumageParts,
};

/// A joint in the pose of the file.
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Joint above it; none: the root.
    pub parent: Option<usize>,
    /// Place in the scene.
    pub global: Mat4,
    /// From the model to the joint in bind pose.
    pub inverse_bind: Mat4,
}

/// A bird's cards and what they need.
pub struct Bird {
    /// One record per feather.
    pub cards: Vec<Card>,
    /// Where its vertices are.
    pub geometry: Vec<CardGeometry>,
    /// Vertices in bind pose, metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Place on the card: u, v.
    pub uvs: Vec<[f32; 2]>,
    /// Joints of each vertex; empty without a skeleton.
    pub joint_indices: Vec<[u16; 4]>,
    /// Their weights.
    pub joint_weights: Vec<[f32; 4]>,
    /// Corners of the triangles.
    pub indices: Vec<u32>,
    /// Skeleton, those of rows last.
    pub joints: Vec<Joint>,
    /// Place of the mesh in the scene, for a bird without a skeleton.
    pub place: Mat4,
    /// Feathers worn: name, and a way to bake each.
    pub feathers: Vec<Feather>,
    images: Vec<(AssetId<Image>, Image)>,
}

impl Bird {
    /// A feather as a picture.
    pub fn baked(&self, feather: usize, width: usize) -> Option<BakedFeather> {
        let mut images = Assets::<Image>::default();
        for (id, image) in &self.images {
            // Photographs that the feathers have.
            let _ = images.insert(*id, image.clone());
        }
        let feather = self.feathers.get(feather)?;
        Some(feather.bake_picture(&images, width, 4 * width))
    }

    /// Vertices where the joints carry them in the pose of the file.
    pub fn posed(&self) -> (Vec<Vec3>, Vec<Vec3>) {
        let matrices: Vec<Mat4> = self
            .joints
            .iter()
            .map(|joint| joint.global * joint.inverse_bind)
            .collect();
        let carried = |i: usize| match self.joint_weights.get(i) {
            None => self.place,
            Some(weights) => (0..4)
                .map(|k| {
                    let joint = usize::from(self.joint_indices[i][k]);
                    matrices[joint] * weights[k]
                })
                .fold(Mat4::ZERO, |sum, matrix| sum + matrix),
        };
        let vertices = self.positions.iter().zip(&self.normals).enumerate();
        vertices
            .map(|(i, (position, normal))| {
                let matrix = carried(i);
                let normal = matrix.transform_vector3(Vec3::from_array(*normal));
                let position = matrix.transform_point3(Vec3::from_array(*position));
                (position, normal.normalize_or(Vec3::Y))
            })
            .unzip()
    }
}

/// Takes the feathers of an entity.
pub fn gather(world: &World, owner: Entity) -> Result<Bird, String> {
    let entity = world
        .get::<PlumageParts>(owner)
        .and_then(|parts| parts.first().copied())
        .ok_or("no feathers have grown")?;
    let cards = world.get::<PlumageCards>(entity).ok_or("no cards")?;
    let mesh = world.get::<Mesh3d>(entity).ok_or("not a single feather")?;
    let mesh = world.resource::<Assets<Mesh>>().get(&mesh.0);
    let mesh = mesh.ok_or("the mesh of the cards is gone")?;
    let feathers = world.resource::<Assets<Feather>>();
    let feathers: Vec<Feather> = cards
        .feathers
        .iter()
        .filter_map(|handle| feathers.get(handle).cloned())
        .collect();
    let images = world.resource::<Assets<Image>>();
    let pictures = feathers.iter().filter_map(|feather| feather.image.as_ref());
    let images = pictures
        .filter_map(|handle| Some((handle.id(), images.get(handle)?.clone())))
        .collect();
    let three = |attribute| match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(list)) => list.clone(),
        _ => Vec::new(),
    };
    let uvs = match mesh.attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(list)) => list.clone(),
        _ => Vec::new(),
    };
    let joint_indices = match mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Some(VertexAttributeValues::Uint16x4(list)) => list.clone(),
        _ => Vec::new(),
    };
    let joint_weights = match mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT) {
        Some(VertexAttributeValues::Float32x4(list)) => list.clone(),
        _ => Vec::new(),
    };
    let place = world.get::<GlobalTransform>(entity);
    Ok(Bird {
        cards: cards.cards.to_vec(),
        geometry: cards.geometry.to_vec(),
        positions: three(Mesh::ATTRIBUTE_POSITION),
        normals: three(Mesh::ATTRIBUTE_NORMAL),
        uvs,
        joint_indices,
        joint_weights,
        indices: mesh
            .indices()
            .map(|list| list.iter().map(|i| i as u32).collect())
            .unwrap_or_default(),
        joints: joints(world, entity),
        place: place.map_or(Mat4::IDENTITY, GlobalTransform::to_matrix),
        feathers,
        images,
    })
}

fn joints(world: &World, entity: Entity) -> Vec<Joint> {
    let Some(skin) = world.get::<SkinnedMesh>(entity) else {
        return Vec::new();
    };
    let poses = world.resource::<Assets<SkinnedMeshInverseBindposes>>();
    let bind = poses.get(&skin.inverse_bindposes);
    let fans = world.get::<FanJoints>(entity);
    let fan_of = |joint: Entity| {
        let fans = fans?;
        let at = fans.entities.iter().position(|fan| *fan == joint)?;
        fans.joints.get(at)
    };
    let index = |joint: Entity| skin.joints.iter().position(|other| *other == joint);
    let parent = |joint: Entity| match fan_of(joint) {
        // Without the fan: on the joint that carries it most.
        Some(fan) => {
            let most = fan.ride.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            most.map(|(joint, _)| usize::from(*joint))
        }
        None => {
            let mut above = world.get::<ChildOf>(joint).map(ChildOf::parent);
            while let Some(entity) = above {
                if let Some(found) = index(entity) {
                    return Some(found);
                }
                above = world.get::<ChildOf>(entity).map(ChildOf::parent);
            }
            None
        }
    };
    let joint = |(number, joint): (usize, &Entity)| {
        let name = world.get::<Name>(*joint).map(|name| name.as_str());
        let place = world.get::<GlobalTransform>(*joint);
        Joint {
            name: name.unwrap_or("joint").to_owned(),
            parent: parent(*joint),
            global: place.map_or(Mat4::IDENTITY, GlobalTransform::to_matrix),
            inverse_bind: bind
                .and_then(|bind| bind.get(number).copied())
                .unwrap_or(Mat4::IDENTITY),
        }
    };
    skin.joints.iter().enumerate().map(joint).collect()
}
