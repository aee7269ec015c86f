//! Which feather is under the pointer.

use super::skin::{Pose, Vertices, ray_triangle, skinning_matrices, triangles};
use crate::{
    anatomy::{Feather, Side},
    groom::{Card, Groom, PlumageCards},
};
use bevy::{
    camera::NormalizedRenderTarget,
    mesh::{
        Mesh, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    window::PrimaryWindow,
};
use bevy_egui::input::EguiWantsInput;

/// A feather picked on a bird.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// The bird: the entity with the `Plumage`.
    pub bird: Entity,
    /// Index of the card.
    pub card: usize,
    /// Place on the card.
    pub uv: Vec2,
    /// The feather asset.
    pub feather: AssetId<Feather>,
    /// Region or row, feather, and what the groom made of them, as lines for people.
    pub text: Vec<String>,
}

/// The card that a ray meets first where it has feather: (index, uv, distance in metres).
///
/// `feathers` are the assets worn, in the groom's order; a card whose feather is not there counts as a full rectangle.
pub fn pick_card(
    ray: Ray3d,
    worn: &PlumageCards,
    mesh: &Mesh,
    pose: &Pose,
    feathers: &[Option<&Feather>],
) -> Option<(usize, Vec2, f32)> {
    let vertices = Vertices::of(mesh)?;
    let Ok(Some(VertexAttributeValues::Float32x2(uvs))) =
        mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0)
    else {
        return None;
    };
    let near = near_cards(ray, worn, pose);
    let card_of = |vertex: u32| {
        let after = worn
            .geometry
            .partition_point(|geometry| geometry.first_vertex <= vertex);
        after.checked_sub(1)
    };
    let mut best: Option<(usize, Vec2, f32)> = None;
    for corner in triangles(mesh) {
        let Some(card) = card_of(corner[0]).filter(|card| near.get(*card) == Some(&true)) else {
            continue;
        };
        let posed = corner.map(|i| vertices.posed(pose, i));
        let Some((distance, bary)) = ray_triangle(ray, posed) else {
            continue;
        };
        let uv = corner
            .into_iter()
            .zip(bary.to_array())
            .fold(Vec2::ZERO, |sum, (i, weight)| {
                sum + uvs
                    .get(i as usize)
                    .map_or(Vec2::ZERO, |uv| Vec2::from_array(*uv))
                    * weight
            });
        let there = worn.cards.get(card).is_some_and(|record| {
            feathers
                .get(usize::from(record.feather))
                .copied()
                .flatten()
                .is_none_or(|feather| is_inside(feather, uv))
        });
        if there && best.is_none_or(|(_, _, nearest)| distance < nearest) {
            best = Some((card, uv, distance));
        }
    }
    best
}

/// Which cards have their sphere on the ray.
fn near_cards(ray: Ray3d, worn: &PlumageCards, pose: &Pose) -> Vec<bool> {
    let near = |card: &Card| {
        let map = pose.map(card.joints, card.weights);
        let center = map.transform_point3(card.center);
        let scale = map.matrix3.determinant().abs().cbrt();
        let along = (center - ray.origin).dot(*ray.direction);
        let off = center - ray.origin - *ray.direction * along;
        // Feathers bend a little beyond the sphere of the bind pose.
        off.length() <= card.radius * scale * 1.5
    };
    worn.cards.iter().map(near).collect()
}

/// Whether a place of the card lies on the vane or the shaft.
fn is_inside(feather: &Feather, uv: Vec2) -> bool {
    let point = feather.rachis.spline().at(f64::from(uv.y));
    let x = (uv.x - point.0 as f32) * feather.aspect;
    let side = if x < 0.0 { Side::Left } else { Side::Right };
    if x.abs() <= feather.r_r(uv.y) {
        return true;
    }
    let angle = feather.vane(side).alpha_b();
    let root = uv.y - x.abs() / angle.tan().max(1e-3);
    root >= feather.contour.start && x.abs() <= feather.contour.reach(side, root)
}

/// What to say of a card.
pub(super) fn describe(
    card: &Card,
    index: usize,
    groom: Option<&Groom>,
    feather: &str,
) -> Vec<String> {
    let region = usize::from(card.region);
    let place = groom.map_or_else(
        || format!("region {region}"),
        |groom| {
            let regions = groom.regions.len();
            if region < regions {
                format!("region {}", groom.regions[region].name)
            } else {
                groom
                    .rows
                    .get(region - regions)
                    .map_or_else(String::new, |row| format!("row {}", row.name))
            }
        },
    );
    vec![
        format!("card {index}, {place}"),
        format!("feather {feather}"),
        format!(
            "{:.1} x {:.1} mm, layer {:.2}, seed {:08x}{}",
            card.length * 1e3,
            card.width * 1e3,
            card.layer,
            card.seed,
            if card.mirrored { ", mirrored" } else { "" }
        ),
    ]
}

/// What a ray from the pointer needs.
#[derive(bevy::ecs::system::SystemParam)]
pub struct Pointer<'w, 's> {
    windows: Query<'w, 's, &'static Window, With<PrimaryWindow>>,
    cameras: Query<
        'w,
        's,
        (
            &'static Camera,
            &'static GlobalTransform,
            &'static bevy::camera::RenderTarget,
        ),
    >,
    wants: Option<Res<'w, EguiWantsInput>>,
}

impl Pointer<'_, '_> {
    /// The pointer in the window, unless a panel has it.
    pub fn place(&self) -> Option<Vec2> {
        if self
            .wants
            .as_ref()
            .is_some_and(|wants| wants.wants_any_pointer_input())
        {
            return None;
        }
        self.windows.single().ok()?.cursor_position()
    }

    /// The ray under the pointer, unless a panel has the pointer.
    pub fn ray(&self) -> Option<Ray3d> {
        let (camera, transform) = self.view()?;
        camera.viewport_to_world(transform, self.place()?).ok()
    }

    /// The camera that the window shows, and where it stands.
    pub fn view(&self) -> Option<(&Camera, &GlobalTransform)> {
        self.cameras
            .iter()
            .filter(|(camera, _, target)| {
                camera.is_active
                    && matches!(
                        target.normalize(None),
                        Some(NormalizedRenderTarget::Window(_)) | None
                    )
            })
            .max_by_key(|(camera, _, _)| camera.order)
            .map(|(camera, transform, _)| (camera, transform))
    }
}

/// Meshes in their present pose.
#[derive(bevy::ecs::system::SystemParam)]
pub struct Posed<'w, 's> {
    /// Meshes.
    pub meshes: Res<'w, Assets<Mesh>>,
    poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
    transforms: Query<'w, 's, &'static GlobalTransform>,
    skins: Query<'w, 's, &'static SkinnedMesh>,
}

impl Posed<'_, '_> {
    /// How the vertices of an entity's mesh get to the world.
    pub fn pose(&self, entity: Entity) -> Option<Pose> {
        match self.skins.get(entity) {
            Ok(skin) => skinning_matrices(skin, &self.poses, &self.transforms).map(Pose::Skinned),
            Err(_) => Some(Pose::Rigid(self.transforms.get(entity).ok()?.affine())),
        }
    }
}
