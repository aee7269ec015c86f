//! Which of the poses that a coat was settled in a bird wears, frame by frame.

use super::fan::rotation;
use bevy::{
    asset::Assets,
    ecs::{component::Component, system::Query, system::Res},
    math::{Affine3A, Quat},
    mesh::{
        MeshVertexAttribute, VertexFormat,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    transform::components::GlobalTransform,
};
use std::sync::Arc;

/// Poses that a coat is settled in at most.
pub const MAX_POSES: usize = 5;

/// Heights of a vertex in the poses after the first over that in the first, along its normal, in units of [`WornPoses::reach`], and how
/// far behind the nearest it is seen in each pose ([`crate::maths::order::raised_pack`]).
pub const ATTRIBUTE_RAISED: MeshVertexAttribute =
    MeshVertexAttribute::new("Plumage_Raised", 0x91b3_6c5e_d2a7, VertexFormat::Uint16x4);

/// Share of the way from one pose to the other before which only the one counts, and after which only the other.
const BLEND: (f32, f32) = (0.375, 0.625);
/// Rotation between two poses that is none, radians.
const STILL: f32 = 1.0e-3;
/// Share of the most that any joint asks of the heights, below which one is not asked for.
const LITTLE: f32 = 1.0e-3;

/// Distance from the nearest pose over the sum of that and the one from the next, up to which a bird is in the pose, and from which it
/// is on the way.
const WAY: (f32, f32) = (0.05, 0.2);

/// Widest turn of a joint from the only pose, radians, up to which a bird is in the pose, and from which it has left it.
const LEFT: (f32, f32) = (0.05, 0.25);

/// What a bird wears of the poses of its coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear {
    /// Share of each pose; sum 1.
    pub shares: [f32; MAX_POSES],
    /// How far the bird is on the way from one pose to another, or away from the only one, 0..1.
    pub between: f32,
}

/// The poses of a coat as the joints tell them apart: by the rotations relative to the skeleton's first joint of all joints that
/// turn between them, or of all joints if there is one pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WornPoses {
    /// Furthest that a vertex of any further pose is from where it is in the first, metres.
    pub reach: f32,
    /// Joints that turn, each with its weight: the square of the widest angle between two poses times what it asks of the heights.
    joints: Vec<(usize, f32)>,
    /// For each pose: the rotation of each of those joints.
    rotations: Vec<Vec<Quat>>,
}

/// Rotation of a joint relative to the first.
fn turn(skinning: &[Affine3A], joint: usize) -> Quat {
    let (Some(first), Some(own)) = (skinning.first(), skinning.get(joint)) else {
        return Quat::IDENTITY;
    };
    rotation(first.matrix3.inverse() * own.matrix3)
}

/// Angle between two rotations, radians; 0 where one of them is no rotation.
fn angle(a: Quat, b: Quat) -> f32 {
    let angle = a.angle_between(b);
    if angle.is_finite() { angle } else { 0.0 }
}

impl WornPoses {
    /// Poses: for each, what every joint of the body does to bind pose. `asked`: for each joint, how much the heights of what it carries
    /// differ between the poses, in any unit; empty: alike for all. A turned head, with all the joints of neck, bill and eyes, must not
    /// outweigh a wing.
    pub fn new(poses: &[Vec<Affine3A>], reach: f32, asked: &[f32]) -> Self {
        let most = asked.iter().copied().fold(0.0_f32, f32::max);
        let share = |joint: usize| match asked.get(joint) {
            Some(asked) if most > 0.0 => asked / most,
            _ => 1.0,
        };
        let joints = poses.first().map_or(0, Vec::len);
        let turns = |joint: usize| poses.iter().map(move |pose| turn(pose, joint));
        let widest = |joint: usize| {
            let pairs = turns(joint).flat_map(|a| turns(joint).map(move |b| angle(a, b)));
            pairs.fold(0.0_f32, f32::max)
        };
        let joints: Vec<(usize, f32)> = (1..joints)
            .map(|joint| (joint, widest(joint)))
            // One pose is left by whatever joint turns.
            .filter(|(joint, angle)| poses.len() == 1 || *angle > STILL && share(*joint) > LITTLE)
            .map(|(joint, angle)| (joint, angle.powi(2) * share(joint)))
            .collect();
        let of_pose = |pose: &Vec<Affine3A>| joints.iter().map(|(j, _)| turn(pose, *j)).collect();
        Self {
            reach,
            rotations: poses.iter().map(of_pose).collect(),
            joints,
        }
    }

    /// Number of poses.
    pub fn count(&self) -> usize {
        self.rotations.len()
    }

    /// Number of joints that it takes to tell the poses apart, counted from the first.
    fn joints(&self) -> usize {
        self.joints.last().map_or(0, |(joint, _)| joint + 1)
    }

    /// What a bird wears whose joints do this to bind pose: only the first pose if all are alike.
    ///
    /// The nearest pose counts alone unless another is almost as near: feathers settled in one pose are in order, those half-way
    /// between two need not be. One set of shares for the whole bird, so that neighbors agree.
    pub fn wear(&self, skinning: &[Affine3A]) -> Wear {
        let now: Vec<Quat> = self
            .joints
            .iter()
            .map(|(joint, _)| turn(skinning, *joint))
            .collect();
        let poses = self.rotations.iter().take(MAX_POSES);
        let away: Vec<f32> = poses.map(|pose| self.distance(pose, &now)).collect();
        let mut shares = [0.0; MAX_POSES];
        for (k, own) in away.iter().enumerate() {
            let others = away.iter().enumerate().filter(|(l, _)| *l != k);
            let against = |(_, other): (usize, &f32)| {
                ease(BLEND, other / (own + other).max(f32::MIN_POSITIVE))
            };
            shares[k] = others.map(against).product();
        }
        let sum: f32 = shares.iter().sum();
        if sum > 0.0 {
            shares = shares.map(|share| share / sum);
        } else {
            shares[0] = 1.0;
        }
        let mut sorted = away;
        sorted.sort_by(f32::total_cmp);
        let between = match sorted[..] {
            [own, next, ..] => ease(WAY, own / (own + next).max(f32::MIN_POSITIVE)),
            _ => ease(LEFT, self.widest(&now)),
        };
        Wear { shares, between }
    }

    /// Widest angle between a joint's rotation and that in the first pose, radians.
    fn widest(&self, now: &[Quat]) -> f32 {
        let first = self.rotations.first().into_iter().flatten();
        let angles = first.zip(now).map(|(a, b)| angle(*a, *b));
        angles.fold(0.0, f32::max)
    }

    /// Whether it matters how the joints are turned.
    pub fn follows(&self) -> bool {
        !self.joints.is_empty()
    }

    /// How far two sets of rotations of the joints are from each other.
    fn distance(&self, a: &[Quat], b: &[Quat]) -> f32 {
        let parts = self.joints.iter().zip(a.iter().zip(b));
        let sum: f32 = parts
            .map(|((_, weight), (a, b))| weight * angle(*a, *b).powi(2))
            .sum();
        sum.sqrt()
    }

    /// Whether a bird on the way from one pose to another passes no third one: none is nearer to both than they are to each other.
    pub fn adjacent(&self, a: usize, b: usize) -> bool {
        let far = |a: usize, b: usize| self.distance(&self.rotations[a], &self.rotations[b]);
        let way = far(a, b);
        let mut others = (0..self.count()).filter(|c| *c != a && *c != b);
        others.all(|c| far(a, c).max(far(c, b)) >= way)
    }
}

/// 0 below the first, 1 above the second, smooth between.
fn ease((low, high): (f32, f32), x: f32) -> f32 {
    let x = ((x - low) / (high - low)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// On the card mesh: the poses of its coat, and what the bird wears of them.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct Worn {
    /// The poses.
    pub poses: Arc<WornPoses>,
    /// What the bird wears of them now.
    pub wear: Wear,
}

impl Worn {
    /// In the first pose.
    pub fn new(poses: Arc<WornPoses>) -> Self {
        let mut shares = [0.0; MAX_POSES];
        shares[0] = 1.0;
        let between = 0.0;
        let wear = Wear { shares, between };
        Self { poses, wear }
    }
}

/// Finds the poses that each bird wears. Runs in `PostUpdate` after transforms are propagated.
pub fn find_worn(
    mut coats: Query<(&mut Worn, &SkinnedMesh)>,
    poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    transforms: Query<&GlobalTransform>,
) {
    for (mut worn, skin) in &mut coats {
        let Some(bind) = poses.get(&skin.inverse_bindposes) else {
            continue;
        };
        let skinning: Vec<Affine3A> = skin
            .joints
            .iter()
            .zip(bind.iter())
            .take(worn.poses.joints())
            .map(|(joint, inverse)| {
                let world = transforms.get(*joint).map(GlobalTransform::affine);
                world.unwrap_or(Affine3A::IDENTITY) * Affine3A::from_mat4(*inverse)
            })
            .collect();
        let wear = worn.poses.wear(&skinning);
        if worn.wear != wear {
            worn.wear = wear;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    fn pose(angles: [f32; 3]) -> Vec<Affine3A> {
        angles
            .map(|angle| {
                Affine3A::from_rotation_translation(Quat::from_rotation_x(angle), Vec3::Y * angle)
            })
            .into()
    }

    #[test]
    fn whoever_leaves_the_only_pose_is_on_the_way() {
        let poses = WornPoses::new(&[pose([0.2, 0.3, 0.1])], 0.0, &[0.0; 3]);
        let between = |angles: [f32; 3]| {
            let wear = poses.wear(&pose(angles));
            assert_eq!(wear.shares[0], 1.0);
            wear.between
        };
        assert_eq!(between([0.2, 0.3, 0.1]), 0.0);
        assert!(between([1.2, 1.3, 1.1]) < 1.0e-4, "the whole bird turns");
        let part = between([0.2, 0.3, 0.25]);
        assert!(part > 0.1 && part < 0.9, "{part}");
        assert_eq!(between([0.2, 1.3, 0.1]), 1.0);
        let stiff = WornPoses::new(&[Vec::new()], 0.0, &[]);
        assert!(!stiff.follows());
        assert_eq!(stiff.wear(&[]).between, 0.0);
    }

    #[test]
    fn the_nearest_pose_counts_alone_and_the_way_between_is_steady() {
        let poses = WornPoses::new(
            &[pose([0.0; 3]), pose([0.0, 1.0, 0.0]), pose([0.0, 1.0, 1.4])],
            0.01,
            &[],
        );
        assert_eq!(
            poses.joints.len(),
            2,
            "the first joint and still ones tell nothing"
        );
        let mut before = poses.wear(&pose([0.0; 3])).shares;
        assert_eq!(before[..3], [1.0, 0.0, 0.0]);
        let mut most = 0.0_f32;
        for step in 1..=400 {
            let t = step as f32 / 200.0;
            let (elbow, wrist) = (t.min(1.0), 1.4 * (t - 1.0).max(0.0));
            let now = poses.wear(&pose([0.0, elbow, wrist])).shares;
            assert!((now.iter().sum::<f32>() - 1.0).abs() < 1.0e-5);
            let parts = now.iter().zip(&before).map(|(a, b)| (a - b).abs());
            most = parts.fold(most, f32::max);
            before = now;
        }
        assert_eq!(before[..3], [0.0, 0.0, 1.0]);
        assert!(most < 0.05, "shares jump by {most}");
    }

    #[test]
    fn what_carries_no_feathers_does_not_choose_the_pose() {
        let poses = [pose([0.0; 3]), pose([0.0, 1.0, 1.4])];
        let head_turned = pose([0.0, 0.0, 1.4]);
        let alike = WornPoses::new(&poses, 0.01, &[]).wear(&head_turned).shares;
        assert!(alike[1] > 0.5, "{alike:?}");
        let by_wing = WornPoses::new(&poses, 0.01, &[0.0, 1.0, 0.01])
            .wear(&head_turned)
            .shares;
        assert_eq!(by_wing[..2], [1.0, 0.0]);
    }

    #[test]
    fn where_the_bird_stands_does_not_matter_and_a_mirror_does_not_either() {
        let poses = WornPoses::new(&[pose([0.0; 3]), pose([0.0, 1.0, 0.5])], 0.01, &[]);
        let stretched = pose([0.0, 0.95, 0.5]);
        for world in [
            Affine3A::from_rotation_translation(Quat::from_rotation_y(2.0), Vec3::splat(7.0)),
            Affine3A::from_scale(Vec3::new(-0.01, 0.01, 0.01)),
        ] {
            let placed: Vec<Affine3A> = stretched.iter().map(|joint| world * *joint).collect();
            assert_eq!(poses.wear(&placed).shares[..2], [0.0, 1.0]);
        }
    }

    #[test]
    fn without_poses_and_with_damaged_joints_there_are_shares() {
        assert_eq!(
            WornPoses::default().wear(&[]).shares,
            [1.0, 0.0, 0.0, 0.0, 0.0]
        );
        let poses = WornPoses::new(&[pose([0.0; 3]), pose([0.0, 1.0, 0.5])], 0.01, &[]);
        let damaged = vec![Affine3A::from_scale(Vec3::splat(f32::NAN)); 3];
        for shares in [poses.wear(&damaged).shares, poses.wear(&[]).shares] {
            assert!(shares.iter().all(|x| x.is_finite()), "{shares:?}");
        }
    }
}
