//! The meshes that a coat is to cover.

use super::refine::refined;
use crate::groom::{NotSkin, PlumageCards};
use bevy::{
    ecs::system::SystemParam,
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
};

/// One mesh as the worker gets it.
pub(super) struct Input {
    pub mesh: Mesh,
    pub world_scale: f32,
    pub colors: Option<Vec<[f32; 3]>>,
}

/// The meshes below an entity.
#[derive(SystemParam)]
pub(super) struct Meshes<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    meshes: Query<
        'w,
        's,
        (
            &'static Mesh3d,
            Option<&'static SkinnedMesh>,
            &'static GlobalTransform,
            Option<&'static MeshMaterial3d<StandardMaterial>>,
        ),
        (Without<PlumageCards>, Without<NotSkin>),
    >,
    transforms: Query<'w, 's, &'static GlobalTransform>,
    assets: Res<'w, Assets<Mesh>>,
    poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
    materials: Res<'w, Assets<StandardMaterial>>,
}

fn scale_of(matrix: Mat4) -> f32 {
    let scale = Mat3::from_mat4(matrix).determinant().abs().cbrt();
    if scale.is_finite() && scale > 1e-9 {
        scale
    } else {
        1.0
    }
}

/// Color of every vertex in a picture laid over the mesh.
fn vertex_colors(mesh: &Mesh, image: &Image, base: LinearRgba) -> Option<Vec<[f32; 3]>> {
    let Ok(Some(bevy::mesh::VertexAttributeValues::Float32x2(uvs))) =
        mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0)
    else {
        return None;
    };
    let size = image.size();
    let texel = |share: f32, count: u32| {
        ((share - share.floor()) * count as f32).min(count.saturating_sub(1) as f32) as u32
    };
    uvs.iter()
        .map(|[u, v]| {
            let color = image.get_color_at(texel(*u, size.x), texel(*v, size.y));
            let linear = color.ok()?.to_linear();
            Some([
                linear.red * base.red,
                linear.green * base.green,
                linear.blue * base.blue,
            ])
        })
        .collect()
}

impl Meshes<'_, '_> {
    /// The meshes to cover, once all of them are loaded.
    pub(super) fn find(
        &self,
        owner: Entity,
        images: &Assets<Image>,
        rounds: u32,
    ) -> Option<Vec<(Entity, Input)>> {
        let mut found = Vec::new();
        for entity in std::iter::once(owner).chain(self.children.iter_descendants(owner)) {
            let Ok((handle, skin, transform, material)) = self.meshes.get(entity) else {
                continue;
            };
            let mesh = self.assets.get(&handle.0)?;
            let matrix = match skin {
                Some(skin) => {
                    let bind = self.poses.get(&skin.inverse_bindposes)?;
                    let joint = skin.joints.first()?;
                    let first = bind.first().copied().unwrap_or(Mat4::IDENTITY);
                    self.transforms.get(*joint).ok()?.to_matrix() * first
                }
                None => transform.to_matrix(),
            };
            let mesh = refined(mesh, rounds);
            let standard = material.and_then(|material| self.materials.get(material.id()));
            let colors = standard.and_then(|material| {
                let image = images.get(material.base_color_texture.as_ref()?)?;
                vertex_colors(&mesh, image, material.base_color.to_linear())
            });
            found.push((
                entity,
                Input {
                    mesh,
                    world_scale: scale_of(matrix),
                    colors,
                },
            ));
        }
        (!found.is_empty()).then_some(found)
    }
}
