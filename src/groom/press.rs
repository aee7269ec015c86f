//! Presses the feathers over each other in the poses that the bird wears.

use super::{
    asset::Groom,
    bird::Bird,
    fan::{fan_transform, rotation},
    leaf::Leaf,
    rows::FanJoint,
    settle::{Settled, open_windows, settle},
    worn::{MAX_POSES, WornPoses},
};
use crate::maths::order::UNSETTLED_WINDOW;
use bevy::{
    math::{Affine3A, Quat, Vec3},
    tasks::{ComputeTaskPool, TaskPool},
};
use std::ops::Range;

/// Places on the way between two poses that are looked at.
const BETWEEN: [f32; 2] = [0.35, 0.65];
/// Sine of half a turn below which it is none.
const STRAIGHT: f32 = 1.0e-3;

/// Presses the feathers over each other in each of the poses that the groom says are worn, or in bind pose. Without `settling` they
/// stay as they are, with the windows of meshes that were not settled.
pub fn press(
    bird: &Bird,
    groom: &Groom,
    skinned: bool,
    fans: &[FanJoint],
    leaves: &mut [Leaf],
    settling: bool,
) -> (WornPoses, f32) {
    let poses = groom.poses.iter().filter(|_| skinned).take(MAX_POSES);
    let mut worn: Vec<Vec<Affine3A>> = poses
        .map(|pose| pose.skinning(&bird.joints, groom.unit))
        .collect();
    if worn.is_empty() {
        worn.push(Vec::new());
    }
    if !settling {
        for leaf in leaves {
            leaf.windows = vec![vec![UNSETTLED_WINDOW; leaf.vertex_count()]; MAX_POSES + 1];
        }
        return (WornPoses::new(&worn, 0.0, &[]), 0.0);
    }
    let mut count = 0;
    let range = |leaf: &Leaf| {
        let first = count;
        count += leaf.vertex_count();
        first..count
    };
    let ranges: Vec<Range<usize>> = leaves.iter().map(range).collect();
    let regions = groom.regions.iter().map(|region| region.stiffness);
    let stiffness: Vec<f32> = regions.chain(groom.rows.iter().map(|_| 1.0)).collect();
    let (mut reach, mut moved) = (0.0_f32, 0.0_f32);
    let mut keep = |number: usize, settled: Settled, leaves: &mut [Leaf]| {
        let Settled {
            heights,
            windows,
            held,
        } = settled;
        for (leaf, held) in leaves.iter_mut().zip(held) {
            leaf.held = held;
        }
        for (leaf, range) in leaves.iter_mut().zip(&ranges) {
            leaf.windows.push(windows[range.clone()].to_vec());
            let own = &heights[range.clone()];
            let first = leaf.raised.iter().copied().chain(std::iter::repeat(0.0));
            let all = own
                .iter()
                .zip(first)
                .map(|(height, first)| (height + first).abs());
            moved = all.fold(moved, f32::max);
            match number {
                0 => leaf.raised = own.to_vec(),
                _ => leaf.raised_further.push(own.to_vec()),
            }
        }
        if number > 0 {
            reach = heights
                .iter()
                .fold(reach, |most, height| most.max(height.abs()));
        }
    };
    let settled = |leaves: &[Leaf], body: &[Affine3A]| {
        settle(leaves, &bird.skin, &with_rows(body, fans), &stiffness)
    };
    keep(0, settled(leaves, &worn[0]), leaves);
    // The further ones begin at the first alone, so that they need not wait for each other.
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    let further = pool.scope(|scope| {
        let (settled, leaves) = (&settled, &*leaves);
        for body in &worn[1..] {
            scope.spawn(async move { settled(leaves, body) });
        }
    });
    for (number, settled) in further.into_iter().enumerate() {
        keep(number + 1, settled, leaves);
    }
    let asked = asked(bird.joints.len(), fans, leaves);
    let poses = if worn[0].is_empty() && skinned {
        // Bind pose, which the bird may leave.
        let bind = vec![Affine3A::IDENTITY; bird.joints.len()];
        WornPoses::new(&[bind], reach, &[])
    } else {
        WornPoses::new(&worn, reach, &asked)
    };
    open_between(bird, fans, leaves, &worn, &poses);
    (poses, moved)
}

/// What every joint, those of rows included, does to bind pose.
fn with_rows(body: &[Affine3A], fans: &[FanJoint]) -> Vec<Affine3A> {
    let rows = fans
        .iter()
        .map(|fan| fan_transform(fan, body) * Affine3A::from_mat4(fan.inverse_bind()));
    body.iter().copied().chain(rows).collect()
}

/// Opens windows for what is out of order on the way from one pose to another, where heights are blended, or away from the only pose. They
/// come behind those of the poses, of which there are then [`MAX_POSES`].
fn open_between(
    bird: &Bird,
    fans: &[FanJoint],
    leaves: &mut [Leaf],
    worn: &[Vec<Affine3A>],
    poses: &WornPoses,
) {
    let count = leaves.iter().map(Leaf::vertex_count).sum();
    // Whoever leaves the only pose is out of order anywhere.
    let open = match worn.len() {
        1 => UNSETTLED_WINDOW,
        _ => 0.0,
    };
    let mut windows = vec![open; count];
    let pairs = (0..worn.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let pairs = pairs.filter(|(a, b)| poses.adjacent(*a, *b));
    let ways = pairs.flat_map(|(a, b)| BETWEEN.map(|share| (a, b, share)));
    for (round, (a, b, share)) in ways.enumerate() {
        let parts = worn[a].iter().zip(&worn[b]);
        let body: Vec<Affine3A> = parts.map(|(a, b)| between(a, b, share)).collect();
        let wear = poses.wear(&body);
        let skinning = with_rows(&body, fans);
        let own = open_windows(leaves, &bird.skin, &skinning, &wear.shares, round);
        let pairs = windows.iter_mut().zip(own);
        pairs.for_each(|(window, own)| *window = window.max(own));
    }
    let mut rest = windows.as_slice();
    for leaf in leaves {
        let (own, others) = rest.split_at(leaf.vertex_count());
        rest = others;
        leaf.windows.resize(MAX_POSES, vec![0.0; own.len()]);
        leaf.windows.push(own.to_vec());
    }
}

/// What a joint does on the way from one pose to another, along the screw that leads there.
fn between(a: &Affine3A, b: &Affine3A, share: f32) -> Affine3A {
    let way = *b * a.inverse();
    let turn = rotation(way.matrix3);
    // The shorter way round.
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let (axis, angle) = turn.to_axis_angle();
    let step = Vec3::from(way.translation);
    // The point of the axis nearest to the origin, and how far the joint goes along it.
    let slide = axis * axis.dot(step);
    let aside = step - slide;
    let half = 0.5 * angle;
    let matrix = if half.sin().abs() < STRAIGHT {
        Affine3A::from_rotation_translation(
            Quat::from_axis_angle(axis, angle * share),
            step * share,
        )
    } else {
        let pivot = 0.5 * (aside + axis.cross(aside) * (half.cos() / half.sin()));
        let turn = Quat::from_axis_angle(axis, angle * share);
        Affine3A::from_rotation_translation(turn, pivot - turn * pivot + slide * share)
    };
    matrix * *a
}

/// For each joint of the body: squares of how far the heights of what it carries, alone or through rows, differ between the poses.
fn asked(joints: usize, fans: &[FanJoint], leaves: &[Leaf]) -> Vec<f32> {
    let mut sums = vec![0.0_f32; joints];
    let mut add = |joint: u16, amount: f32| {
        if let Some(sum) = sums.get_mut(usize::from(joint)) {
            *sum += amount;
        }
    };
    for leaf in leaves {
        let wide = leaf.columns + 1;
        for i in 0..leaf.shaft.points.len() {
            let of_pose =
                |heights: &Vec<f32>| heights[i * wide..][..wide].iter().map(|h| h * h).sum();
            let square = leaf.raised_further.iter().map(of_pose).fold(0.0, f32::max);
            let (own, weights) = leaf.weights_at(i);
            for (joint, weight) in own.into_iter().zip(weights) {
                let Some(fan) = usize::from(joint).checked_sub(joints) else {
                    add(joint, weight * square);
                    continue;
                };
                let Some(fan) = fans.get(fan) else { continue };
                let follows = if fan.follow.is_empty() {
                    &fan.ride
                } else {
                    &fan.follow
                };
                for (joint, share) in follows {
                    add(*joint, weight * share * square);
                }
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_between_two_poses_is_a_screw() {
        let a = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(0.3),
            Vec3::new(0.1, 0.0, 0.2),
        );
        let pivot = Vec3::new(0.4, -0.2, 0.1);
        let turned = |angle: f32, slide: f32| {
            let turn = Quat::from_rotation_z(angle);
            Affine3A::from_rotation_translation(turn, pivot - turn * pivot + Vec3::Z * slide) * a
        };
        for angle in [0.0, 1.0e-4, 1.2, -2.8] {
            let b = turned(angle, 0.07);
            for share in [0.0, 0.35, 1.0] {
                let found = between(&a, &b, share);
                let wanted = turned(angle * share, 0.07 * share);
                assert!(
                    found.abs_diff_eq(wanted, 1.0e-4),
                    "{angle}, {share}: {found} {wanted}"
                );
            }
        }
    }
}
