//! Which meshes of an entity are the skin that feathers grow on.

use super::component::{NotSkin, PlumageCards};
use bevy::{
    asset::{AssetId, Assets},
    ecs::{name::Name, prelude::*, system::SystemParam},
    math::Mat4,
    mesh::{
        Mesh, Mesh3d,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    platform::collections::HashMap,
};

/// The skin chosen, and its skeleton.
#[derive(Clone)]
pub(super) struct SkinTarget {
    pub mesh: Entity,
    pub joints: Vec<Entity>,
    pub inverse_bind: Vec<Mat4>,
}

/// The meshes below an entity.
#[derive(SystemParam)]
pub(super) struct SkinMeshes<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    meshes: Query<
        'w,
        's,
        (&'static Mesh3d, Option<&'static SkinnedMesh>),
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
        let mut found = Vec::new();
        for entity in std::iter::once(owner).chain(self.children.iter_descendants(owner)) {
            let Ok((handle, skin)) = self.meshes.get(entity) else {
                continue;
            };
            let mesh = self.assets.get(&handle.0)?;
            let bind = match skin {
                Some(skin) => Some((skin, self.poses.get(&skin.inverse_bindposes)?)),
                None => None,
            };
            found.push((entity, mesh, bind));
        }
        let any_skinned = found.iter().any(|(_, _, bind)| bind.is_some());
        found.retain(|(_, _, bind)| bind.is_some() == any_skinned);
        let has_tracts = |mesh: &Mesh| {
            mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_1)
                .is_ok_and(|values| values.is_some())
        };
        let vertices = |mesh: &Mesh| {
            mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)
                .map_or(0, |values| values.len())
        };
        if any_skinned && found.iter().any(|(_, mesh, _)| has_tracts(mesh)) {
            found.retain(|(_, mesh, _)| has_tracts(mesh));
        } else {
            let largest = found.iter().map(|(_, mesh, _)| vertices(mesh)).max()?;
            let first = found
                .iter()
                .position(|(_, mesh, _)| vertices(mesh) == largest)?;
            found = vec![found.swap_remove(first)];
        }
        let mesh = found.first()?.0;
        let mut target = SkinTarget {
            mesh,
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
        let meshes = ids.map(|(handle, _)| handle.id()).collect();
        Some((
            target,
            SkinInput {
                meshes,
                maps,
                joints,
            },
        ))
    }

    /// Copies for a worker thread.
    pub(super) fn copies(&self, ids: &[AssetId<Mesh>]) -> Vec<Mesh> {
        let meshes = ids.iter().filter_map(|id| self.assets.get(*id));
        meshes.cloned().collect()
    }
}
