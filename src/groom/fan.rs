//! Moves the fan joints: each frame, after the skeleton, before it is drawn.

use super::rows::FanJoint;
use bevy::{
    asset::Assets,
    ecs::{
        component::Component,
        entity::Entity,
        system::{Query, Res},
    },
    math::{Affine3A, Mat3A, Mat4, Quat, Vec3, Vec3A},
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    transform::components::GlobalTransform,
};
use std::sync::Arc;

/// On the card mesh: its fan joints, which are the last joints of its [`SkinnedMesh`].
#[derive(Component, Clone, Debug)]
pub struct FanJoints {
    /// What moves each joint.
    pub joints: Arc<[FanJoint]>,
    /// Their entities. They have a `GlobalTransform` and no `Transform`: nothing but [`fan_rows`] moves them.
    pub entities: Vec<Entity>,
}

/// Rotation of an affine map whose axes may be scaled, skewed a little or mirrored.
pub(super) fn rotation(matrix: Mat3A) -> Quat {
    let x = matrix.x_axis.normalize_or(Vec3A::X);
    let y = (matrix.y_axis - x * matrix.y_axis.dot(x)).normalize_or(x.any_orthonormal_vector());
    Quat::from_mat3a(&Mat3A::from_cols(x, y, x.cross(y))).normalize()
}

/// Place of a fan joint in the world. `skinning[j]` maps model space in bind pose to the world by joint `j` (its global
/// transform times its inverse bind pose).
///
/// The root is skinned by the joints it rides on; the rotation is the normalised weighted sum of the rotations of those it
/// follows (all turned into one half-space, so that the shorter way is taken); the scale is the model's.
pub fn fan_transform(fan: &FanJoint, skinning: &[Affine3A]) -> Affine3A {
    let known = |list: &[(u16, f32)]| {
        list.iter()
            .filter(|(j, _)| usize::from(*j) < skinning.len())
            .copied()
            .collect::<Vec<_>>()
    };
    let (ride, follow) = (known(&fan.ride), known(&fan.follow));
    let mut matrix = Mat3A::ZERO;
    let mut position = Vec3::ZERO;
    let mut total = 0.0;
    for (joint, weight) in &ride {
        let map = skinning[usize::from(*joint)];
        position += map.transform_point3(fan.root) * *weight;
        matrix += map.matrix3 * *weight;
        total += weight;
    }
    if total <= 0.0 {
        return Affine3A::from_rotation_translation(fan.frame, fan.root);
    }
    position /= total;
    let scale = (matrix.determinant().abs().cbrt() / total).max(1.0e-9);
    let mut sum = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    for (joint, weight) in &follow {
        let turn = rotation(skinning[usize::from(*joint)].matrix3);
        let sign = if sum.dot(turn) < 0.0 { -1.0 } else { 1.0 };
        sum += turn * (*weight * sign);
    }
    let turn = if sum.length_squared() > 1.0e-12 {
        sum.normalize()
    } else {
        rotation(matrix)
    };
    Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn * fan.frame, position)
}

/// Writes the `GlobalTransform` of every fan joint. Runs in `PostUpdate` after transforms are propagated.
pub fn fan_rows(
    cards: Query<(&FanJoints, &SkinnedMesh)>,
    poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    mut transforms: Query<&mut GlobalTransform>,
) {
    for (fans, skin) in &cards {
        let Some(bind) = poses.get(&skin.inverse_bindposes) else {
            continue;
        };
        let body = skin.joints.len().saturating_sub(fans.entities.len());
        let skinning: Vec<Affine3A> = skin.joints[..body]
            .iter()
            .zip(bind.iter())
            .map(|(joint, inverse)| {
                let world = transforms
                    .get(*joint)
                    .map(|transform| transform.affine())
                    .unwrap_or(Affine3A::IDENTITY);
                world * Affine3A::from_mat4(*inverse)
            })
            .collect();
        for (fan, entity) in fans.joints.iter().zip(&fans.entities) {
            if let Ok(mut transform) = transforms.get_mut(*entity) {
                let moved = fan_transform(fan, &skinning);
                if moved.is_finite() && transform.affine() != moved {
                    *transform = GlobalTransform::from(Mat4::from(moved));
                }
            }
        }
    }
}
