//! Everything that makes one bird, as a table.

use bevy::math::Vec3;

use super::coat::{RowLook, TailCoverts, TractRow};
use super::face::{BareFace, Bill, Brow, Disc, EyeRim, Ledge, LoreArea, Naked};
use super::motion::Motion;
use super::tract::Tract;

/// One section of the trunk and neck: arc length, pitch, centre (z, y), depth, width, height of the widest line.
pub type TrunkStation = [f32; 7];
/// One section of the head: z, y, height, width.
pub type HeadStation = [f32; 4];

/// Angles of the wing: azimuth of the humerus from lateral towards the tail, inner angles at elbow and wrist, roll of the wing
/// plane about its tailward axis, its turn towards the body's middle, and how far the wing is pushed out along its own normal.
#[derive(Clone, Copy, Debug)]
pub struct WingPose {
    /// Humerus azimuth, degrees.
    pub azimuth: f32,
    /// Inner elbow angle, degrees.
    pub elbow: f32,
    /// Inner wrist angle, degrees.
    pub wrist: f32,
    /// Roll of the plane, degrees.
    pub roll: f32,
    /// Turn of the plane about its lateral axis, which takes its tail end towards the body's middle, degrees.
    pub toe: f32,
    /// Push along the normal, mm.
    pub push: f32,
    /// Dip of the hand below the plane, degrees: the folded primaries lie under the secondaries.
    pub tuck: f32,
}

impl WingPose {
    /// Blend towards another pose.
    pub fn mix(self, other: Self, t: f32) -> Self {
        let m = |a: f32, b: f32| a + (b - a) * t;
        Self {
            azimuth: m(self.azimuth, other.azimuth),
            elbow: m(self.elbow, other.elbow),
            wrist: m(self.wrist, other.wrist),
            roll: m(self.roll, other.roll),
            toe: m(self.toe, other.toe),
            push: m(self.push, other.push),
            tuck: m(self.tuck, other.tuck),
        }
    }
}

/// The body's plumage over the folded arm, in radii of the humerus: folded wings lie in the coat and not on it.
#[derive(Clone, Copy, Debug)]
pub struct Shoulder {
    /// Radius of the plumage.
    pub thickness: f32,
    /// How far its axis lies inwards of the bone's.
    pub buried: f32,
    /// Share of the way from the wrist to the shoulder at which it begins.
    pub before: f32,
    /// Share of the humerus that it covers.
    pub reach: f32,
    /// Over which it runs out into the trunk, mm on the macaw.
    pub blend: f32,
}

/// That of every bird, found on the macaw.
pub const SHOULDER: Shoulder = Shoulder {
    thickness: 1.6,
    buried: 1.0,
    before: 0.1,
    reach: 0.5,
    blend: 38.0,
};

/// Everything that makes one bird.
#[derive(Clone, Debug)]
pub struct Species {
    /// Short name, also the file name.
    pub name: &'static str,
    /// Prefix of its feather files.
    pub prefix: &'static str,
    /// Scale of skin details against the macaw.
    pub scale: f32,
    /// Edge of a polygonisation cell, mm.
    pub cell: f32,
    /// Trunk and neck sections.
    pub trunk: [TrunkStation; 13],
    /// Head sections.
    pub head: [HeadStation; 6],
    /// Joint positions in bind pose.
    pub joints: &'static [(&'static str, [f32; 3])],
    /// Lengths of humerus, ulna, carpometacarpus, digit.
    pub bones: [f32; 4],
    /// Wing folded at rest.
    pub fold: WingPose,
    /// Wing half open: the bind pose.
    pub bind: WingPose,
    /// Wing spread.
    pub spread: WingPose,
    /// Degrees by which the innermost feather of the folded arm points further up than the primaries: row tips run across the wing.
    pub fold_fan: f32,
    /// The swell of plumage before the folded hand, above and below: inward, before and down along the hand from the wrist, and its
    /// radius; mm on the macaw.
    pub swell: [[f32; 4]; 2],
    /// Tailward axis of the wing plane below horizontal, degrees.
    pub wing_slope: f32,
    /// How far the marginal coverts of the hand lie along its edge, 0 (across, as on the arm) to 1.
    pub hand_lay: f32,
    /// Radii of humerus, forearm, hand, half thickness of the patagium, width of the strip behind the ulna.
    pub arm: [f32; 5],
    /// Radii (start, end) of thigh, crus, tarsus.
    pub legs: [[f32; 2]; 3],
    /// The tarsus is feathered, so part of the body mesh.
    pub feathered_tarsus: bool,
    /// Smooth-union radii: head and legs, tarsus, wing.
    pub blend: [f32; 3],
    /// Lengths of toes I..IV without claw.
    pub toes: [f32; 4],
    /// Lengths of claws I..IV.
    pub claws: [f32; 4],
    /// Toe radii at the root and before the claw.
    pub toe_radius: [f32; 2],
    /// Sideways splay of the toes, mm at their tips.
    pub splay: [f32; 4],
    /// Toes I..IV point backward.
    pub backward: [bool; 4],
    /// Perch radius; its axis lies along x.
    pub perch: f32,
    /// Height of the perch's upper side.
    pub perch_top: f32,
    /// Eye radius, pupil radius.
    pub eye: [f32; 2],
    /// Colors: iris, bare face, feet, claws.
    pub bare_colors: [u32; 4],
    /// Trunk arcs at which the hips give way to the chest.
    pub rigid: [f32; 2],
    /// Arc limits of the trunk tracts.
    pub arcs: Arcs,
    /// Tail axis below horizontal, degrees; half fan at rest and fully spread.
    pub tail: [f32; 3],
    /// Name of its groom.
    pub title: &'static str,
    /// File of its down, from the groom's.
    pub down: &'static str,
    /// The cells are too coarse for the head, which gets four times the triangles.
    pub fine_head: bool,
    /// Scale of the swell against the macaw's.
    pub swell_scale: f32,
    /// Over which the swell runs out into the trunk, mm on the macaw.
    pub swell_blend: f32,
    /// Distance over which the skin of the shoulder changes from chest to wing, mm.
    pub shoulder_reach: f32,
    /// Share of the skin at the shoulder that the chest keeps.
    pub shoulder_hold: f32,
    /// Ridge above the eye.
    pub brow: Option<Brow>,
    /// The bill.
    pub bill: Bill,
    /// Direction the left eye looks.
    pub gaze: [f32; 3],
    /// Color of the lids.
    pub lids: u32,
    /// Colors of the lids next to the eye, and of their edge.
    pub lid_colors: [u32; 2],
    /// Half the angle under which the open eye is seen from its centre, radians.
    pub lid_edge: f32,
    /// How far the lids reach outwards, in radii of the eye.
    pub lid_reach: f32,
    /// Ledge above the eye.
    pub ledge: Option<Ledge>,
    /// Naked skin of the face.
    pub bare: BareFace,
    /// The sheet that carries the texture of the naked skin.
    pub naked: Option<Naked>,
    /// Naked rim of the eye.
    pub eye_rim: EyeRim,
    /// Bristles between eye and bill.
    pub lore: Option<LoreArea>,
    /// Facial disc.
    pub disc: Option<Disc>,
    /// Feather templates, in the order of their numbers.
    pub templates: &'static [&'static str],
    /// Scattered tracts.
    pub tracts: &'static [TractRow],
    /// Rows of flight feathers and their coverts.
    pub rows: &'static [RowLook],
    /// Lengths that are listed one by one: primaries P1..P10, secondaries then tertials, rectrices R1..R6.
    pub lengths: [Vec<f32>; 3],
    /// Tail coverts.
    pub tail_coverts: TailCoverts,
    /// Colors of the skin below the coat by tract, and of all other tracts.
    pub skin: &'static [(&'static [Tract], u32)],
    /// See `skin`.
    pub other_skin: u32,
    /// The idle clip.
    pub motion: Motion,
}

/// Limits of tracts along the spine (mm of arc) and on the head.
#[derive(Clone, Copy, Debug)]
pub struct Arcs {
    /// Tail coverts end, rump ends, back ends, mantle ends (and the neck starts).
    pub dorsal: [f32; 4],
    /// Vent ends, belly ends.
    pub ventral: [f32; 2],
    /// Angle from the dorsal line at which the hind neck gives way to the fore neck.
    pub neck: f32,
    /// Where the scapulars begin.
    pub scapulars: f32,
    /// Legs lie below this height.
    pub leg_top: f32,
    /// Height of the plane between head and neck at the skull joint.
    pub head_plane: f32,
    /// z offset from the head joint at which nape gives way to crown.
    pub nape: f32,
    /// Angles from the dorsal line that bound nape and crown.
    pub head_angles: [f32; 2],
}

impl Species {
    /// Bind position of a joint. Right-side names mirror the left.
    pub fn joint(&self, name: &str) -> Vec3 {
        if let Some(stem) = name.strip_suffix("_R") {
            let left = self.joint(&format!("{stem}_L"));
            return Vec3::new(-left.x, left.y, left.z);
        }
        self.joints
            .iter()
            .find(|(n, _)| *n == name)
            .map_or(Vec3::ZERO, |(_, p)| Vec3::from_array(*p))
    }

    /// Under-mesh color of a tract before darkening (sRGB hex): the color of the plumage above it.
    pub fn skin_color(&self, tract: Tract) -> u32 {
        self.skin
            .iter()
            .find(|(tracts, _)| tracts.contains(&tract))
            .map_or(self.other_skin, |(_, color)| *color)
    }
}
