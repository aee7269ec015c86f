//! Kinematics of the wing: bones in a plane, the plane rolled onto the flank when it folds.

use bevy::math::{Quat, Vec2, Vec3};

use crate::species::{Species, WingPose};

/// The left wing in one pose.
#[derive(Clone, Debug)]
pub struct WingPlane {
    /// Lateral axis.
    pub lateral: Vec3,
    /// Tailward axis.
    pub tailward: Vec3,
    /// Dorsal normal.
    pub normal: Vec3,
    /// Shoulder, elbow, wrist, knuckle, tip.
    pub points: [Vec3; 5],
    /// Trailing edge of the skin behind elbow and wrist.
    pub strip: [Vec3; 2],
    /// Azimuths of humerus, forearm and hand, degrees from lateral towards the tail.
    pub azimuths: [f32; 3],
    /// The pose's angles.
    pub pose: WingPose,
}

/// Azimuths of the three bones.
fn azimuths(pose: WingPose) -> [f32; 3] {
    let forearm = pose.azimuth - (180.0 - pose.elbow);
    [pose.azimuth, forearm, forearm + 180.0 - pose.wrist]
}

/// What rolling a plane and turning its tail end in does to the bind pose's axes.
fn turned(tailward: Vec3, roll: f32, toe: f32) -> Quat {
    Quat::from_axis_angle(tailward, roll.to_radians()) * Quat::from_rotation_x(-toe.to_radians())
}

impl WingPlane {
    /// The wing in a pose; bones as rigid as the bind pose's.
    pub fn new(species: &Species, pose: WingPose) -> Self {
        let slope = species.wing_slope.to_radians();
        let axis = Vec3::new(0.0, -slope.sin(), -slope.cos());
        let frame = turned(axis, pose.roll, pose.toe);
        let [lateral, tailward, normal] = [Vec3::X, axis, Vec3::X.cross(axis)].map(|v| frame * v);
        let azimuths = azimuths(pose);
        let direction = |degrees: f32| {
            let a = degrees.to_radians();
            lateral * a.cos() + tailward * a.sin()
        };
        let shoulder = species.joint("humerus_L") + normal * pose.push;
        let elbow = shoulder + direction(azimuths[0]) * species.bones[0];
        let wrist = elbow + direction(azimuths[1]) * species.bones[1];
        let knuckle = wrist + direction(azimuths[2]) * species.bones[2];
        let tip = knuckle + direction(azimuths[2]) * species.bones[3];
        let back = direction(azimuths[1] + 90.0) * (0.5 * species.arm[1] + species.arm[4]);
        let inset = direction(azimuths[1]) * (0.12 * species.bones[1]);
        Self {
            lateral,
            tailward,
            normal,
            points: [shoulder, elbow, wrist, knuckle, tip],
            strip: [elbow + back, wrist + back - inset],
            azimuths,
            pose,
        }
    }

    /// The bind pose.
    pub fn bind(species: &Species) -> Self {
        Self::new(species, species.bind)
    }

    /// Direction in the plane at an azimuth in degrees.
    pub fn direction(&self, degrees: f32) -> Vec3 {
        let a = degrees.to_radians();
        self.lateral * a.cos() + self.tailward * a.sin()
    }

    /// Coordinates (lateral, tailward) from the shoulder.
    pub fn flat(&self, p: Vec3) -> Vec2 {
        let r = p - self.points[0];
        Vec2::new(r.dot(self.lateral), r.dot(self.tailward))
    }

    /// Share of the chord from the leading edge (0) to the roots of the remiges (1) below a point.
    pub fn chord(&self, p: Vec3) -> f32 {
        let [s, e, w, _, t] = self.points.map(|q| self.flat(q));
        let [se, sw] = self.strip.map(|q| self.flat(q));
        let q = self.flat(p);
        let hand = Vec2::new((t - w).y, -(t - w).x).normalize_or_zero();
        let edge = 6.0 * (t - w).length() / 112.0;
        let lead = polyline(q, &[s, w - hand * -edge, t - hand * -edge]);
        let behind = (se - e) * 0.8;
        let trail = polyline(
            q,
            &[
                s + behind,
                e + behind,
                se,
                sw,
                w - hand * edge,
                t - hand * edge,
            ],
        );
        lead / (lead + trail).max(1e-3)
    }

    /// Azimuth of primary 1..10 in degrees.
    pub fn primary(&self, number: f32) -> f32 {
        let r = self.pose.wrist - 40.0;
        let (first, last) = (14.0 + 0.432 * r, 3.0 + 0.04 * r);
        let t = ((10.0 - number) / 9.0).max(0.0).powf(0.9);
        self.azimuths[2] + last + (first - last) * t
    }

    /// Azimuth of a secondary or tertial at share 0 (next to the wrist) to 1 (innermost), and its roll.
    pub fn secondary(&self, share: f32, species: &Species) -> (f32, f32) {
        let p1 = self.primary(1.0);
        let tertial = self.azimuths[1] + 105.0 + 0.47 * (150.0 - self.pose.elbow);
        let open = p1 + 3.0 + (tertial - p1 - 3.0) * share;
        let closed = p1 + 1.0 - species.fold_fan * share;
        let folded = (self.pose.roll / species.fold.roll).clamp(0.0, 1.0);
        // The plane wraps round the back: the roll falls towards the innermost feather.
        let roll = self.pose.roll * (1.0 - (48.0 / 70.0) * share.powf(0.8));
        (open + (closed - open) * folded, roll)
    }

    /// Rotation since bind of a secondary at an azimuth and a roll, from the azimuth at rest; degrees. It dips with the hand.
    pub fn feather(&self, bind: &Self, azimuth: f32, rest: f32, roll: f32) -> Quat {
        turned(bind.tailward, roll, self.pose.toe + self.pose.tuck)
            * Quat::from_axis_angle(bind.normal, (azimuth - rest).to_radians())
    }

    /// Rotation of the plane since bind pose, whatever its bones do in it.
    pub fn frame(&self, bind: &Self) -> Quat {
        turned(bind.tailward, self.pose.roll, self.pose.toe)
    }

    /// Global rotations since bind of humerus, ulna and hand.
    pub fn rotations(&self, bind: &Self) -> [Quat; 3] {
        let frame = self.frame(bind);
        let dip = Quat::from_axis_angle(
            bind.direction(bind.azimuths[2] + 90.0),
            self.pose.tuck.to_radians(),
        );
        [0, 1, 2].map(|i| {
            let turn = Quat::from_axis_angle(
                bind.normal,
                (self.azimuths[i] - bind.azimuths[i]).to_radians(),
            );
            if i == 2 {
                frame * turn * dip
            } else {
                frame * turn
            }
        })
    }
}

fn polyline(p: Vec2, points: &[Vec2]) -> f32 {
    points
        .windows(2)
        .map(|s| {
            let axis = s[1] - s[0];
            let t = ((p - s[0]).dot(axis) / axis.length_squared().max(1e-6)).clamp(0.0, 1.0);
            (p - s[0] - axis * t).length()
        })
        .fold(f32::MAX, f32::min)
}
