//! The idle clip: breathing, saccades, a stretch of the wing, tail, blinks, jaw. Frame 0 is the perched bird, wings folded.

use bevy::math::{Quat, Vec3};

use crate::eyes;
use crate::skeleton::{Pose, Skeleton};
use crate::species::{Species, WingPose};
use crate::wing::WingPlane;

/// Value of a track of (time, value) keys, eased between unequal keys; zero without keys.
fn track(keys: &[(f32, f32)], t: f32) -> f32 {
    let k = keys.partition_point(|(at, _)| *at <= t);
    if k == 0 || k == keys.len() {
        return keys.get(k.saturating_sub(1)).map_or(0.0, |key| key.1);
    }
    let ((t0, a), (t1, b)) = (keys[k - 1], keys[k]);
    let u = (t - t0) / (t1 - t0);
    a + (b - a) * u * u * (3.0 - 2.0 * u)
}

/// A pulse: 0, up to `value` within `ease`, down again before `end`.
fn pulse(t: f32, start: f32, end: f32, ease: f32, value: f32) -> f32 {
    track(
        &[
            (start, 0.0),
            (start + ease, value),
            (end - ease, value),
            (end, 0.0),
        ],
        t,
    )
}

/// Share of the way from folded to half open, for the left and the right wing.
fn wings(species: &Species, t: f32) -> [f32; 2] {
    species.motion.wings.map(|wing| track(wing, t))
}

/// Wing poses (left, right) at a time.
pub fn wing_poses(species: &Species, t: f32) -> [WingPose; 2] {
    wings(species, t).map(|w| species.fold.mix(species.bind, w))
}

fn mirror(q: Quat) -> Quat {
    Quat::from_xyzw(q.x, -q.y, -q.z, q.w)
}

/// Sets the joints of both wings.
pub fn set_wings(species: &Species, skeleton: &Skeleton, pose: &mut Pose, wings: [WingPose; 2]) {
    let bind = WingPlane::bind(species);
    for (side, wing) in ["L", "R"].iter().zip(wings) {
        let left = *side == "L";
        let plane = WingPlane::new(species, wing);
        let rotations = plane.rotations(&bind);
        let reflect = |q: Quat| if left { q } else { mirror(q) };
        let flip = |v: Vec3| if left { v } else { Vec3::new(-v.x, v.y, v.z) };
        let mut parent = Quat::IDENTITY;
        for (name, global) in ["humerus", "ulna", "hand"].iter().zip(rotations) {
            let j = skeleton.index(&format!("{name}_{side}"));
            pose.set_global(skeleton, j, parent, reflect(global));
            parent = reflect(global);
        }
        pose.offset[skeleton.index(&format!("scap_{side}"))] = flip(plane.normal * wing.push);
        // The helper joint of the patagium goes with the shoulder and turns with the wing's plane, whatever the bones do in it.
        let j = skeleton.index(&format!("propat_{side}"));
        let from_shoulder = skeleton.offset(j);
        let turned = rotations[0].inverse() * plane.frame(&bind);
        pose.offset[j] = reflect(turned) * from_shoulder - from_shoulder;
        pose.rotation[j] = reflect(turned);
    }
}

/// The perched pose of the clip at a time.
pub fn pose(species: &Species, skeleton: &Skeleton, t: f32) -> Pose {
    let motion = &species.motion;
    let mut p = skeleton.bind();
    let end = motion.seconds;
    let cycle = (t / end * motion.breaths).rem_euclid(1.0);
    // Inhaling takes 40 % of a breath.
    let breath = if cycle < 0.4 {
        0.5 - 0.5 * (std::f32::consts::PI * cycle / 0.4).cos()
    } else {
        0.5 + 0.5 * (std::f32::consts::PI * (cycle - 0.4) / 0.6).cos()
    };
    let at = |name: &str| skeleton.index(name);
    let s = 1.0 + motion.swell * breath;
    p.scale[at("chest")] = Vec3::new(s, s, 1.0);
    for name in ["neck1", "scap_L", "scap_R"] {
        p.scale[at(name)] = Vec3::new(1.0 / s, 1.0 / s, 1.0);
    }
    let lift = motion.bob * (breath - 0.5);
    p.offset[at("hips")].y = lift;
    // The head stays fixed in space while the body bobs.
    let chest_to_neck = skeleton.offset(at("neck1")).y;
    p.offset[at("neck1")].y = (chest_to_neck - lift) / s - chest_to_neck;
    for side in ["L", "R"] {
        // The feet keep their hold: the thigh takes up the bob.
        p.offset[at(&format!("femur_{side}"))].y = -lift;
    }
    let [rouse_at, rate] = motion.rouse;
    let since = t - rouse_at;
    let shimmy = if since > 0.0 {
        let fade = (-since / 0.5).exp() * (1.0 - (since / 1.2).min(1.0)).powi(2);
        2.0 * (std::f32::consts::TAU * rate * since).sin() * fade
    } else {
        0.0
    };
    let flick = motion.flick.map_or(0.0, |flick| {
        let [start, end] = flick.span;
        pulse(t, start, end, flick.ease, 1.0)
            * flick.degrees
            * (std::f32::consts::TAU * flick.rate * (t - start)).sin()
    });
    let turn = |x: f32, y: f32, z: f32| {
        Quat::from_rotation_y(y.to_radians())
            * Quat::from_rotation_x(x.to_radians())
            * Quat::from_rotation_z(z.to_radians())
    };
    p.rotation[at("chest")] = turn(0.0, 0.0, 0.4 * shimmy);
    let tail_axis = Vec3::new(
        0.0,
        -species.tail[0].to_radians().sin(),
        -species.tail[0].to_radians().cos(),
    );
    let tail_up = tail_axis.cross(Vec3::NEG_X).normalize();
    p.rotation[at("tail")] = turn(motion.counter * (breath - 0.5), 0.0, 0.0)
        * Quat::from_axis_angle(tail_up, flick.to_radians());
    let fan = track(motion.fan, t);
    p.rotation[at("tail_fan_L")] = fan_rotation(species, fan);
    p.rotation[at("tail_fan_R")] = fan_rotation(species, -fan);

    let [yaw, pitch, roll] = [motion.yaw, motion.pitch, motion.roll].map(|keys| track(keys, t));
    for (name, share) in [
        ("neck1", 0.1),
        ("neck2", 0.15),
        ("neck3", 0.2),
        ("neck4", 0.25),
        ("head", 0.3),
    ] {
        p.rotation[at(name)] = turn(pitch * share, yaw * share, roll * share);
    }
    let open: f32 = motion
        .jaw
        .pulses
        .iter()
        .map(|[start, end, ease]| pulse(t, *start, *end, *ease, 1.0))
        .sum();
    let (jaw, upper) = (motion.jaw.open * open, motion.jaw.lift * open);
    p.rotation[at("jaw")] = turn(jaw, 0.0, 0.0);
    p.rotation[at("upper_bill")] = turn(-upper, 0.0, 0.0);
    let shut: f32 = motion
        .blinks
        .iter()
        .map(|b| pulse(t, *b, *b + 0.16, 0.06, 1.0))
        .sum();
    let axis = eyes::lid_axis(species);
    for (side, left) in [("L", true), ("R", false)] {
        let lower = Quat::from_axis_angle(axis, (88.0 * shut).to_radians());
        let higher = Quat::from_axis_angle(axis, (-42.0 * shut).to_radians());
        let reflect = |q: Quat| if left { q } else { mirror(q) };
        p.rotation[at(&format!("lid_lo_{side}"))] = reflect(lower);
        p.rotation[at(&format!("lid_up_{side}"))] = reflect(higher);
    }
    if let Some(grip) = motion.grip {
        let [start, end] = grip.span;
        let turned = pulse(t, start, end, grip.ease, grip.degrees);
        p.rotation[at("toe3a_L")] = turn(turned, 0.0, 0.0);
        p.rotation[at("toe3b_L")] = turn(-0.4 * turned, 0.0, 0.0);
    }
    set_wings(species, skeleton, &mut p, wing_poses(species, t));
    p
}

/// Rotation of a tail-fan joint: `degrees` beyond the half fan at rest, positive to the bird's left.
pub fn fan_rotation(species: &Species, degrees: f32) -> Quat {
    let slope = species.tail[0].to_radians();
    let back = Vec3::new(0.0, -slope.sin(), -slope.cos());
    // Turning about this axis takes the tail's axis towards +x.
    Quat::from_axis_angle(back.cross(Vec3::X).normalize(), degrees.to_radians())
}
