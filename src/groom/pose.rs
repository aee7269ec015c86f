//! Poses that a bird wears, as a groom gives them, and what they do to vertices.

use super::skin::Weights;
use crate::parameter::{Length, Parameter};
use bevy::{
    math::{Affine3A, Quat, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};

/// A pose in which the coat shall lie in order: folded wings, not the spread ones of bind pose.
#[derive(Clone, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct KeyPose {
    /// Name, for people.
    pub name: String,
    /// What the joints do, at most 4096; those not named stay as they are in bind pose.
    #[reflect(@Length::new(0, 4096))]
    pub joints: Vec<JointPose>,
}

/// What one joint does to the bind pose, in model space: its global transform times its inverse bind pose.
#[derive(Clone, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct JointPose {
    /// Name of the joint.
    pub joint: String,
    /// Rotation as a quaternion x, y, z, w, each -1..1; zero turns nothing.
    #[reflect(@Parameter::new("", -1.0, 1.0))]
    pub rotation: [f32; 4],
    /// Translation after the rotation, in units of the groom.
    #[reflect(@Parameter::new("", -1.0e9, 1.0e9))]
    pub translation: [f32; 3],
}

impl KeyPose {
    /// The pose for a skeleton of these joints; `unit`: metres per unit of the groom. What is not finite counts as not moved.
    pub fn skinning(&self, joints: &[String], unit: f32) -> Vec<Affine3A> {
        let find = |name: &String| {
            let pose = self.joints.iter().find(|pose| pose.joint == *name)?;
            let turn = Quat::from_array(pose.rotation);
            let turn = Quat::from_vec4(bevy::math::Vec4::from(turn).try_normalize()?);
            let step = Vec3::from_array(pose.translation) * unit;
            let matrix = Affine3A::from_rotation_translation(turn, step);
            matrix.is_finite().then_some(matrix)
        };
        joints
            .iter()
            .map(|name| find(name).unwrap_or(Affine3A::IDENTITY))
            .collect()
    }
}

/// The blend of joints that carries a vertex; the identity if it has none.
pub fn blend((joints, weights): &Weights, skinning: &[Affine3A]) -> Affine3A {
    let mut blended = Affine3A::ZERO;
    let mut total = 0.0;
    for (joint, weight) in joints.iter().zip(weights) {
        if *weight > 0.0
            && let Some(matrix) = skinning.get(usize::from(*joint))
        {
            blended.matrix3 += matrix.matrix3 * *weight;
            blended.translation += matrix.translation * *weight;
            total += weight;
        }
    }
    if total > 0.0 {
        blended.matrix3 *= 1.0 / total;
        blended.translation /= total;
        blended
    } else {
        Affine3A::IDENTITY
    }
}
