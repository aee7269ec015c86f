//! The two birds as numbers: millimetres, degrees, sRGB. Left side only where a table is one-sided.

use bevy::math::Vec3;

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

/// A bill half: start (y, z), base height and width, end height and width.
#[derive(Clone, Copy, Debug)]
pub struct Bill {
    /// Upper: centre of its base (y, z).
    pub upper_at: [f32; 2],
    /// Upper: base height and width.
    pub upper_base: [f32; 2],
    /// Upper: height and width at the tip.
    pub upper_tip: [f32; 2],
    /// Upper: start direction below horizontal, degrees; straight length; arc radius; turn in degrees; taper exponent.
    pub upper_curve: [f32; 5],
    /// Lower: centre of its base (y, z).
    pub lower_at: [f32; 2],
    /// Lower: base height and width, length.
    pub lower_base: [f32; 3],
    /// Lower: linear and quadratic drop of the axis over its length.
    pub lower_axis: [f32; 2],
    /// Colors of base, tip, lower jaw and cere.
    pub colors: [u32; 4],
}

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
    /// Seconds of the idle clip.
    pub idle: f32,
    /// When in the idle clip the wing is stretched furthest, seconds.
    pub stretched: f32,
    /// When it is half-way there, seconds.
    pub half_way: f32,
}

/// Limits of tracts along the spine (mm of arc) and on the head.
#[derive(Clone, Copy, Debug)]
pub struct Arcs {
    /// Tail coverts end, rump ends, back ends, mantle ends (and the neck starts).
    pub dorsal: [f32; 4],
    /// Vent ends, belly ends.
    pub ventral: [f32; 2],
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

    /// True for the macaw's body plan: bare face, two toes back, bare tarsus.
    pub fn is_parrot(&self) -> bool {
        !self.feathered_tarsus
    }
}

/// Linear RGB of an sRGB hex color.
pub fn linear(hex: u32) -> [f32; 3] {
    srgb(hex).map(|c| {
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// sRGB components in 0..1 of a hex color.
pub fn srgb(hex: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| ((hex >> shift) & 255) as f32 / 255.0)
}

/// The scarlet macaw.
pub fn macaw() -> Species {
    Species {
        name: "parrot",
        prefix: "macaw",
        scale: 1.0,
        cell: 4.9,
        trunk: [
            [0.0, 48.0, -74.0, 53.0, 30.0, 38.0, 0.50],
            [20.0, 49.0, -61.0, 68.0, 46.0, 56.0, 0.52],
            [40.0, 50.0, -48.0, 83.0, 65.3, 76.0, 0.56],
            [65.0, 52.0, -33.0, 102.0, 97.0, 87.6, 0.616],
            [90.0, 54.0, -18.0, 123.0, 117.0, 95.0, 0.64],
            [115.0, 56.0, -3.0, 143.0, 126.5, 100.0, 0.64],
            [140.0, 58.0, 11.0, 164.0, 127.3, 103.5, 0.615],
            [165.0, 61.0, 23.0, 186.0, 124.2, 106.1, 0.58],
            [190.0, 65.0, 35.0, 208.0, 114.4, 110.0, 0.56],
            [212.0, 71.0, 43.0, 228.0, 99.4, 103.2, 0.52],
            [235.0, 78.0, 49.0, 250.0, 88.9, 89.7, 0.50],
            [258.0, 85.0, 52.0, 273.0, 80.6, 76.6, 0.50],
            [280.0, 90.0, 53.0, 295.0, 74.2, 68.2, 0.50],
        ],
        head: [
            [26., 311., 28., 28.],
            [38., 313., 54., 50.],
            [54., 314., 66., 60.],
            [72., 313., 66., 57.],
            [84., 311., 66., 50.],
            [99., 309., 62., 41.],
        ],
        joints: &[
            ("root", [0., 0., 0.]),
            ("hips", [0., 118., -21.]),
            ("chest", [0., 173., 16.]),
            ("neck1", [0., 217., 39.]),
            ("neck2", [0., 237., 46.]),
            ("neck3", [0., 260., 51.]),
            ("neck4", [0., 281., 52.]),
            ("head", [0., 295., 53.]),
            ("jaw", [0., 299., 80.]),
            ("upper_bill", [0., 325., 92.]),
            ("eye_L", [26.2, 319., 72.]),
            ("lid_up_L", [26., 319., 72.]),
            ("lid_lo_L", [26., 319., 72.]),
            ("tail", [0., 53., -74.]),
            ("tail_fan_L", [10., 46., -80.]),
            ("scap_L", [20., 215., 45.]),
            ("humerus_L", [42., 217., 35.]),
            ("ulna_L", [100., 168., 4.]),
            ("hand_L", [175., 222., 37.]),
            ("digit_L", [230., 194., 21.]),
            ("alula_L", [183., 225., 40.]),
            ("propat_L", [110., 223., 39.]),
            ("femur_L", [22., 112., -12.]),
            ("tibia_L", [26., 96., 26.]),
            ("tarsus_L", [26., 52., -20.]),
            ("foot_L", [26., 32., 1.]),
        ],
        bones: [82., 98., 64., 48.],
        fold: WingPose {
            azimuth: 115.,
            elbow: 25.,
            wrist: 46.,
            roll: 76.,
            toe: -4.,
            push: 17.,
            tuck: 8.,
        },
        bind: WingPose {
            azimuth: 45.,
            elbow: 95.,
            wrist: 110.,
            roll: 0.,
            toe: 0.,
            push: 0.,
            tuck: 0.,
        },
        spread: WingPose {
            azimuth: 12.,
            elbow: 150.,
            wrist: 165.,
            roll: 0.,
            toe: 0.,
            push: 0.,
            tuck: 0.,
        },
        fold_fan: 6.,
        swell: [[17., 3., -1., 11.], [23., 2., 62., 6.]],
        wing_slope: 58.,
        arm: [9.5, 9.5, 6.5, 3.5, 12.],
        legs: [[24., 22.], [22., 15.], [6.5, 6.5]],
        feathered_tarsus: false,
        blend: [15., 8., 9.],
        toes: [22., 36., 50., 45.],
        claws: [13., 16., 17., 16.],
        toe_radius: [5., 3.5],
        splay: [9., -9., 9., -9.],
        backward: [true, false, false, true],
        perch: 22.,
        perch_top: 24.,
        eye: [6.5, 2.5],
        bare_colors: [0xE8D98A, 0xF0E3D8, 0x3A3633, 0x1B1919],
        rigid: [85., 150.],
        arcs: Arcs {
            dorsal: [28., 95., 155., 212.],
            ventral: [78., 140.],
            scapulars: 205.,
            leg_top: 136.,
            head_plane: 283.,
            nape: 4.,
            head_angles: [100., 60.],
        },
        tail: [60., 7., 38.],
        idle: 5.0,
        stretched: 3.3,
        half_way: 2.73,
    }
}

/// The golden eagle.
pub fn eagle() -> Species {
    Species {
        name: "eagle",
        prefix: "eagle",
        scale: 2.0,
        cell: 8.2,
        trunk: [
            [0.0, 50.0, -118.0, 161.0, 54.7, 75.9, 0.5],
            [30.0, 51.0, -99.0, 184.0, 89.5, 115.1, 0.52],
            [60.0, 53.0, -80.0, 208.0, 122.5, 154.3, 0.56],
            [95.0, 55.0, -60.0, 236.0, 149.0, 160.6, 0.6],
            [130.0, 57.0, -41.0, 265.0, 165.0, 170.5, 0.62],
            [165.0, 59.0, -22.0, 295.0, 177.0, 175.5, 0.62],
            [200.0, 61.0, -5.0, 325.0, 182.0, 180.5, 0.6],
            [235.0, 63.0, 12.0, 356.0, 182.0, 189.7, 0.58],
            [270.0, 67.0, 27.0, 388.0, 175.0, 189.7, 0.56],
            [300.0, 73.0, 37.0, 416.0, 154.0, 165.3, 0.52],
            [330.0, 80.0, 44.0, 445.0, 118.9, 129.4, 0.5],
            [360.0, 86.0, 48.0, 475.0, 105.4, 101.3, 0.5],
            [385.0, 90.0, 48.0, 500.0, 91.5, 86.1, 0.5],
        ],
        head: [
            [14., 517., 38., 36.],
            [30., 519., 66., 58.],
            [50., 520., 76., 70.],
            [74., 519., 70., 64.],
            [86., 516., 56., 46.],
            [96., 512., 40., 33.],
        ],
        joints: &[
            ("root", [0., 0., 0.]),
            ("hips", [0., 257., -47.]),
            ("chest", [0., 334., 0.]),
            ("neck1", [0., 401., 32.]),
            ("neck2", [0., 431., 40.]),
            ("neck3", [0., 456., 45.]),
            ("neck4", [0., 477., 47.]),
            ("head", [0., 500., 48.]),
            ("jaw", [0., 504., 72.]),
            ("upper_bill", [0., 519., 94.]),
            ("eye_L", [31.5, 523., 75.5]),
            ("lid_up_L", [31.5, 523., 75.5]),
            ("lid_lo_L", [31.5, 523., 75.5]),
            ("tail", [0., 161., -118.]),
            ("tail_fan_L", [16., 151., -126.]),
            ("scap_L", [30., 406., 50.]),
            ("humerus_L", [62., 404., 32.]),
            ("ulna_L", [193., 293., -37.]),
            ("hand_L", [358., 410., 35.]),
            ("digit_L", [448., 365., 8.]),
            ("alula_L", [372., 414., 39.]),
            ("propat_L", [212., 411., 39.]),
            ("femur_L", [34., 262., -46.]),
            ("tibia_L", [44., 232., 22.]),
            ("tarsus_L", [48., 142., -62.]),
            ("foot_L", [48., 74., -3.]),
        ],
        bones: [185., 215., 105., 75.],
        fold: WingPose {
            azimuth: 116.,
            elbow: 20.,
            wrist: 45.,
            roll: 77.,
            toe: -5.,
            push: 35.,
            tuck: 10.,
        },
        bind: WingPose {
            azimuth: 45.,
            elbow: 95.,
            wrist: 110.,
            roll: 0.,
            toe: 0.,
            push: 0.,
            tuck: 0.,
        },
        spread: WingPose {
            azimuth: 12.,
            elbow: 150.,
            wrist: 165.,
            roll: 0.,
            toe: 0.,
            push: 0.,
            tuck: 0.,
        },
        fold_fan: 3.,
        swell: [[17., 3., 1., 11.], [18., 4., 38., 8.]],
        wing_slope: 63.,
        arm: [17., 17., 11., 6., 22.],
        legs: [[50., 50.], [54., 42.], [19., 16.]],
        feathered_tarsus: true,
        blend: [21., 8., 16.],
        toes: [38., 45., 68., 48.],
        claws: [51., 45., 38., 32.],
        toe_radius: [10., 7.],
        splay: [0., -22., 0., 22.],
        backward: [true, false, false, false],
        perch: 35.,
        perch_top: 60.,
        eye: [8.5, 3.6],
        bare_colors: [0x8C5A1E, 0xE8B62C, 0xE8B62C, 0x1B1919],
        rigid: [120., 210.],
        arcs: Arcs {
            dorsal: [40., 135., 220., 300.],
            ventral: [112., 200.],
            scapulars: 292.,
            leg_top: 287.,
            head_plane: 487.,
            nape: 2.,
            head_angles: [80., 62.],
        },
        tail: [64., 12., 65.],
        idle: 6.0,
        stretched: 4.0,
        half_way: 4.5,
    }
}

impl Species {
    /// The bill.
    pub fn bill(&self) -> Bill {
        if self.is_parrot() {
            Bill {
                upper_at: [297., 91.],
                upper_base: [49., 36.],
                upper_tip: [3., 3.],
                upper_curve: [24., 0., 37., 86., 2.3],
                lower_at: [279., 78.],
                lower_base: [34., 38., 36.],
                lower_axis: [-8., 10.],
                colors: [0xE9DCC3, 0x1F1C1A, 0x1C1A1A, 0xF0E3D8],
            }
        } else {
            Bill {
                upper_at: [514., 90.],
                upper_base: [30., 28.],
                upper_tip: [3.5, 3.5],
                upper_curve: [8., 14., 24., 92., 2.0],
                lower_at: [500., 86.],
                lower_base: [15., 22., 34.],
                lower_axis: [0., -2.],
                colors: [0x5E666C, 0x2A2B30, 0x4A5056, 0xE8B62C],
            }
        }
    }
}
