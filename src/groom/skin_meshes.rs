//! Which meshes of an entity are the skin that feathers grow on.

use super::component::{NotSkin, PlumageCards};
use bevy::{
    asset::{AssetId, Assets},
    ecs::{name::Name, prelude::*, system::SystemParam},
    math::{Mat4, Vec3},
    mesh::{
        Mesh, Mesh3d, PrimitiveTopology,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    platform::collections::HashMap,
};

/// Words in the name of a mesh or of its material that stand for parts without feathers.
const BARE_PARTS: [&str; 20] = [
    "beak", "bill", "cere", "claw", "cornea", "eye", "eyeball", "eyelid", "feet", "foot", "iris",
    "leg", "mouth", "nail", "pupil", "talon", "teeth", "toe", "tongue", "tooth",
];

/// Whether a name has one of these words in it, in the singular or the plural.
fn is_bare_part(name: &str) -> bool {
    let mut words = vec![String::new()];
    let mut lower_before = false;
    for c in name.chars() {
        // `LeftEye`, `left_eye`, `Left Eye.001`.
        if !c.is_alphabetic() || (c.is_uppercase() && lower_before) {
            words.push(String::new());
        }
        lower_before = c.is_lowercase();
        if c.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(c.to_lowercase());
        }
    }
    let bare = |word: &str| BARE_PARTS.contains(&word);
    words
        .iter()
        .any(|word| bare(word) || word.strip_suffix('s').is_some_and(bare))
}

/// A mesh, and its skeleton if it has one.
type Found<'m> = (
    Entity,
    &'m Mesh,
    Option<(&'m SkinnedMesh, &'m SkinnedMeshInverseBindposes)>,
);

/// The skin chosen, and its skeleton.
#[derive(Clone)]
pub(super) struct SkinTarget {
    /// What the cards hang on.
    pub mesh: Entity,
    /// Every mesh of the skin.
    pub meshes: Vec<Entity>,
    pub joints: Vec<Entity>,
    pub inverse_bind: Vec<Mat4>,
}

impl SkinTarget {
    /// Where each joint is in bind pose, model space.
    pub fn pivots(&self) -> impl Iterator<Item = Vec3> {
        let place = |bind: &Mat4| bind.inverse().w_axis.truncate();
        self.inverse_bind.iter().map(place)
    }
}

/// The meshes below an entity.
#[derive(SystemParam)]
pub(super) struct SkinMeshes<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    meshes: Query<
        'w,
        's,
        (
            &'static Mesh3d,
            Option<&'static SkinnedMesh>,
            Option<&'static ChildOf>,
        ),
        (Without<PlumageCards>, Without<NotSkin>),
    >,
    names: Query<'w, 's, &'static Name>,
    assets: Res<'w, Assets<Mesh>>,
    poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
}

/// What the worker thread gets.
pub(super) struct SkinInput {
    pub meshes: Vec<AssetId<Mesh>>,
    /// For each mesh: index into [`SkinTarget::joints`] of each of its joints.
    pub maps: Vec<Vec<u16>>,
    /// Names of the joints.
    pub joints: Vec<String>,
}

impl SkinMeshes<'_, '_> {
    /// The skin, once every mesh below the entity is loaded.
    pub(super) fn find(&self, owner: Entity) -> Option<(SkinTarget, SkinInput)> {
        let mut found: Vec<Found> = Vec::new();
        for entity in std::iter::once(owner).chain(self.children.iter_descendants(owner)) {
            let Ok((handle, skin, _)) = self.meshes.get(entity) else {
                continue;
            };
            let mesh = self.assets.get(&handle.0)?;
            let bind = match skin {
                Some(skin) => Some((skin, self.poses.get(&skin.inverse_bindposes)?)),
                None => None,
            };
            found.push((entity, mesh, bind));
        }
        // Curves along the lay may lie beside the skin.
        let is_skin = |mesh: &Mesh| mesh.primitive_topology() == PrimitiveTopology::TriangleList;
        if found.iter().any(|(_, mesh, _)| is_skin(mesh)) {
            found.retain(|(_, mesh, _)| is_skin(mesh));
        }
        let any_skinned = found.iter().any(|(_, _, bind)| bind.is_some());
        found.retain(|(_, _, bind)| bind.is_some() == any_skinned);
        let has_tracts = |mesh: &Mesh| {
            mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_1)
                .is_ok_and(|values| values.is_some())
        };
        if any_skinned && found.iter().any(|(_, mesh, _)| has_tracts(mesh)) {
            found.retain(|(_, mesh, _)| has_tracts(mesh));
        } else {
            found = self.largest_body(found)?;
        }
        let mesh = found.first()?.0;
        let mut target = SkinTarget {
            mesh,
            meshes: found.iter().map(|(entity, _, _)| *entity).collect(),
            joints: Vec::new(),
            inverse_bind: Vec::new(),
        };
        let mut known: HashMap<Entity, u16> = HashMap::default();
        let mut maps = Vec::new();
        for (_, _, bind) in &found {
            let Some((skin, bind)) = bind else { continue };
            let index = |(number, &joint): (usize, &Entity)| {
                *known.entry(joint).or_insert_with(|| {
                    target.joints.push(joint);
                    target
                        .inverse_bind
                        .push(bind.get(number).copied().unwrap_or(Mat4::IDENTITY));
                    (target.joints.len() - 1) as u16
                })
            };
            maps.push(skin.joints.iter().enumerate().map(index).collect());
        }
        let name = |joint: &Entity| {
            self.names
                .get(*joint)
                .map_or_else(|_| String::new(), |name| name.as_str().to_owned())
        };
        let joints = target.joints.iter().map(name).collect();
        let ids = found
            .iter()
            .filter_map(|(entity, _, _)| self.meshes.get(*entity).ok());
        let meshes = ids.map(|(handle, _, _)| handle.id()).collect();
        Some((
            target,
            SkinInput {
                meshes,
                maps,
                joints,
            },
        ))
    }

    /// The mesh with the most vertices first, then those that are of one body with it: carried by the same joints in the same bind
    /// pose, or primitives of the same glTF node where nothing is skinned. Without what is named like a bare part.
    fn largest_body<'m>(&self, mut found: Vec<Found<'m>>) -> Option<Vec<Found<'m>>> {
        let bare = |(entity, _, _): &Found| {
            let name = self.names.get(*entity);
            name.is_ok_and(|name| is_bare_part(name.as_str()))
        };
        if !found.iter().all(bare) {
            found.retain(|part| !bare(part));
        }
        let vertices = |mesh: &Mesh| {
            mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)
                .map_or(0, |values| values.len())
        };
        let largest = found.iter().map(|(_, mesh, _)| vertices(mesh)).max()?;
        let first = found
            .iter()
            .position(|(_, mesh, _)| vertices(mesh) == largest)?;
        let body = found.remove(first);
        let parent = |entity: Entity| Some(self.meshes.get(entity).ok()?.2?.parent());
        let of_body = |(entity, _, bind): &Found| match (&body.2, bind) {
            (Some((skin, pose)), Some((other, other_pose))) => {
                skin.joints == other.joints && pose.to_vec() == other_pose.to_vec()
            }
            (None, None) => parent(body.0).is_some() && parent(body.0) == parent(*entity),
            _ => false,
        };
        found.retain(of_body);
        found.insert(0, body);
        Some(found)
    }

    /// Copies for a worker thread.
    pub(super) fn copies(&self, ids: &[AssetId<Mesh>]) -> Vec<Mesh> {
        let meshes = ids.iter().filter_map(|id| self.assets.get(*id));
        meshes.cloned().collect()
    }
}
