//! The skin as a signed distance: lofts, limb cones and the wing arm, smoothly united.

use bevy::math::Vec3;

use crate::loft::{Head, Hit, Trunk};
use crate::species::{SHOULDER, Species};
use crate::wing::WingPlane;

/// Radius of the hollow in which the folded forearm lies, in the forearm's own.
const BED: f32 = 1.3;
/// Radius at the wrist of the plumage that buries the folded arm, in that at the shoulder.
const FRONT: f32 = 0.7;
/// Over which the swells of the two sides meet, mm on the macaw.
const MEETING_BLEND: f32 = 30.0;

/// Parts of the signed distance at one point.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    /// Trunk and neck.
    pub trunk: Hit,
    /// Head.
    pub head: Hit,
    /// Thigh, crus, tarsus: distance and share along the limb.
    pub legs: [(f32, f32); 3],
    /// Wing arm.
    pub wing: f32,
}

/// Distance to a cone with round ends, and the share along its axis.
pub fn cone(p: Vec3, a: Vec3, b: Vec3, radii: [f32; 2]) -> (f32, f32) {
    let axis = b - a;
    let t = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    (
        (p - a - axis * t).length() - radii[0] - (radii[1] - radii[0]) * t,
        t,
    )
}

/// Minimum of two distances, rounded over `k`.
pub fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let h = (0.5 + 0.5 * (b - a) / k).clamp(0.0, 1.0);
    b * (1.0 - h) + a * h - k * h * (1.0 - h)
}

/// Distance to a triangle.
fn triangle(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let n = (b - a).cross(c - a);
    let side = |u: Vec3, v: Vec3| n.cross(v - u).dot(p - u) >= 0.0;
    if side(a, b) && side(b, c) && side(c, a) {
        return ((p - a).dot(n) / n.length()).abs();
    }
    [(a, b), (b, c), (c, a)]
        .iter()
        .map(|(u, v)| cone(p, *u, *v, [0.0, 0.0]).0)
        .fold(f32::MAX, f32::min)
}

/// The skin of one bird in bind pose, symmetric in x.
pub struct Body<'a> {
    /// Numbers of the bird.
    pub species: &'a Species,
    /// Trunk and neck loft.
    pub trunk: Trunk,
    /// Head loft.
    pub head: Head,
    /// Bind frame of the left wing.
    pub wing: WingPlane,
    joints: [Vec3; 4],
    /// The folded wing: shoulder, elbow, wrist, knuckle, tip.
    folded: [Vec3; 5],
}

impl<'a> Body<'a> {
    /// Prepares the lofts.
    pub fn new(species: &'a Species) -> Self {
        Self {
            species,
            trunk: Trunk::new(species),
            head: Head::new(species),
            wing: WingPlane::bind(species),
            folded: WingPlane::new(species, species.fold).points,
            joints: ["femur_L", "tibia_L", "tarsus_L", "foot_L"].map(|n| species.joint(n)),
        }
    }

    /// How far a point lies before the front edge of the folded wing (shoulder, wrist, tip), seen from the side, mm.
    pub fn before_wing(&self, p: Vec3) -> f32 {
        let [shoulder, _, wrist, _, tip] = self.folded;
        [(shoulder, wrist), (wrist, tip)]
            .map(|(a, b)| (p - wrist).dot(self.forward(a, b)))
            .into_iter()
            .fold(f32::MIN, f32::max)
    }

    /// Forward across an edge of the folded wing, from the side.
    fn forward(&self, from: Vec3, to: Vec3) -> Vec3 {
        Vec3::X.cross(from - to).normalize()
    }

    /// Forward across the front edge of the folded hand.
    pub fn before(&self) -> Vec3 {
        let [_, _, wrist, _, tip] = self.folded;
        self.forward(wrist, tip)
    }

    /// Distances to the plumage that buries the folded arm: along the humerus, and from the shoulder down to the wrist.
    pub fn shoulder(&self, p: Vec3) -> [f32; 2] {
        let radius = SHOULDER.thickness * self.species.arm[0];
        let inward = Vec3::X * (SHOULDER.buried * self.species.arm[0]);
        let [top, elbow, wrist, ..] = self.folded.map(|point| point - inward);
        let p = Vec3::new(p.x.abs(), p.y, p.z);
        // Thinner towards the wrist, which breast and flank cover.
        let ends = [
            (top.lerp(elbow, SHOULDER.reach), radius),
            (wrist.lerp(top, SHOULDER.before), FRONT * radius),
        ];
        ends.map(|(end, narrow)| cone(p, top, end, [radius, narrow]).0)
    }

    /// Distances to each part.
    pub fn parts(&self, p: Vec3) -> Parts {
        let p = Vec3::new(p.x.abs(), p.y, p.z);
        let j = self.joints;
        let r = self.species.legs;
        Parts {
            trunk: self.trunk.hit(p),
            head: self.head.hit(p),
            legs: [
                cone(p, j[0], j[1], r[0]),
                cone(p, j[1], j[2], r[1]),
                cone(p, j[2], j[3], r[2]),
            ],
            wing: self.wing_distance(p),
        }
    }

    fn wing_distance(&self, p: Vec3) -> f32 {
        let w = &self.wing;
        let [humerus, forearm, hand, sheet, _] = self.species.arm;
        let [shoulder, elbow, wrist, knuckle, tip] = w.points;
        let k = 0.7 * forearm;
        let mut d = cone(p, shoulder, elbow, [humerus, forearm]).0;
        d = smooth_min(d, cone(p, elbow, wrist, [forearm, 0.85 * forearm]).0, k);
        d = smooth_min(d, cone(p, wrist, knuckle, [0.95 * hand, hand]).0, k);
        d = smooth_min(d, cone(p, knuckle, tip, [hand, 0.6 * hand]).0, k);
        d = smooth_min(d, triangle(p, shoulder, elbow, wrist) - sheet, k);
        let [e, wr] = w.strip;
        let strip = triangle(p, elbow, wrist, wr).min(triangle(p, elbow, wr, e)) - sheet;
        smooth_min(d, strip, 0.5 * k)
    }

    /// Distance to the trunk with the plumage that swells before the folded wing and buries its arm. `p.x` is not negative; `bare`:
    /// distance to the loft there.
    pub fn trunk_in_plumage(&self, p: Vec3, bare: f32) -> f32 {
        let [shoulder, elbow, wrist, _, tip] = self.folded;
        // The feathers of the breast's sides swell before the folded hand, whose front edge they cover.
        let s = self.species.swell_scale;
        let forward = self.before();
        let [top, low] = self.species.swell.map(|[inward, before, down, _]| {
            let along = (tip - wrist).normalize();
            wrist + (forward * before + along * down - Vec3::X * inward) * s
        });
        let [wide, narrow] = self.species.swell.map(|point| point[3] * s);
        // Above the folded wing it runs on to the shoulder.
        let [inward, above, ..] = self.species.swell[0];
        let back = shoulder + (self.forward(shoulder, wrist) * above - Vec3::X * inward) * s;
        let swell = |p: Vec3| {
            smooth_min(
                cone(p, top, low, [wide, narrow]).0,
                cone(p, top, back, [wide, wide]).0,
                8.0 * s,
            )
        };
        // Left and right meet on the breast without a crease.
        let swell = smooth_min(
            swell(p),
            swell(Vec3::new(-p.x, p.y, p.z)),
            MEETING_BLEND * s,
        );
        let trunk = smooth_min(bare, swell, self.species.swell_blend * s);
        // Those of the flank lie flat below the folded forearm, which they bed.
        let radius = BED * self.species.arm[1];
        let bed = cone(p, elbow, wrist, [radius; 2]).0;
        let trunk = -smooth_min(-trunk, bed, radius);
        let [arm, front] = self.shoulder(p);
        smooth_min(trunk, arm.min(front), SHOULDER.blend * s)
    }

    /// Signed distance, approximate away from the surface.
    pub fn distance(&self, p: Vec3) -> f32 {
        let p = Vec3::new(p.x.abs(), p.y, p.z);
        let parts = self.parts(p);
        let [k, k_tarsus, k_wing] = self.species.blend;
        let trunk = self.trunk_in_plumage(p, parts.trunk.distance);
        let mut d = smooth_min(trunk, parts.head.distance, 1.15 * k);
        if let Some(brow) = self.species.brow {
            let eye = self.species.joint("eye_L");
            let [from, to] = [brow.from, brow.to].map(|end| eye + Vec3::from_array(end));
            d = smooth_min(d, cone(p, from, to, brow.radii).0, brow.blend);
        }
        // The plumage of thigh and belly runs on without a crease.
        d = smooth_min(
            d,
            smooth_min(parts.legs[0].0, parts.legs[1].0, 1.6 * k),
            3.0 * k,
        );
        if self.species.feathered_tarsus {
            d = smooth_min(d, parts.legs[2].0, k_tarsus);
        }
        smooth_min(d, parts.wing, k_wing)
    }

    /// Gradient of the distance, not normalised.
    pub fn gradient(&self, p: Vec3) -> Vec3 {
        let h = 0.2 * self.species.cell;
        Vec3::from_array(
            [Vec3::X, Vec3::Y, Vec3::Z]
                .map(|e| (self.distance(p + e * h) - self.distance(p - e * h)) / (2.0 * h)),
        )
    }

    /// Outward normal.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        self.gradient(p).normalize_or(Vec3::Y)
    }

    /// Moves a point onto the surface.
    pub fn project(&self, mut p: Vec3, steps: usize) -> Vec3 {
        for _ in 0..steps {
            let g = self.gradient(p);
            let limit = self.species.cell;
            p -= g * (self.distance(p) / g.length_squared().max(0.25)).clamp(-limit, limit);
        }
        p
    }
}
