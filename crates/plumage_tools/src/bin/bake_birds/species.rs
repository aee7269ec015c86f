//! The two birds as numbers: millimetres, degrees, sRGB. Left side only where a table is one-sided.

use bevy::math::Vec3;

/// One section of the trunk and neck: arc length, pitch, centre (z, y), depth, width, height of the widest line.
pub type TrunkStation = [f32; 7];
/// One section of the head: z, y, height, width.
pub type HeadStation = [f32; 4];

/// Angles of the wing: azimuth of the humerus from lateral towards the tail, inner angles at elbow and wrist, roll of the wing
/// plane about its tailward axis, and how far the wing is pushed out along its own normal.
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
    /// Perch radius; its axis lies along x at y = -radius.
    pub perch: f32,
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
            [0., 48., -74., 53., 30., 38., 0.50],
            [20., 49., -61., 68., 46., 56., 0.52],
            [40., 50., -48., 83., 64., 76., 0.56],
            [65., 52., -33., 102., 86., 84., 0.60],
            [90., 54., -18., 123., 104., 91., 0.62],
            [115., 56., -3., 143., 115., 95., 0.62],
            [140., 58., 11., 164., 119., 99., 0.60],
            [165., 61., 23., 186., 115., 102., 0.58],
            [190., 65., 35., 208., 104., 100., 0.56],
            [212., 71., 43., 228., 88., 89., 0.52],
            [235., 78., 49., 250., 78., 76., 0.50],
            [258., 85., 52., 273., 72., 66., 0.50],
            [280., 90., 53., 295., 70., 62., 0.50],
        ],
        head: [
            [26., 311., 28., 28.],
            [38., 313., 54., 50.],
            [54., 314., 66., 60.],
            [72., 313., 66., 57.],
            [84., 310., 60., 47.],
            [96., 305., 55., 36.],
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
            ("scap_L", [20., 213., 29.]),
            ("humerus_L", [42., 215., 19.]),
            ("ulna_L", [100., 166., -12.]),
            ("hand_L", [175., 220., 21.]),
            ("digit_L", [230., 192., 5.]),
            ("alula_L", [183., 223., 24.]),
            ("propat_L", [110., 221., 23.]),
            ("femur_L", [28., 106., -8.]),
            ("tibia_L", [34., 92., 36.]),
            ("tarsus_L", [28., 30., -23.]),
            ("foot_L", [28., 8., 1.]),
        ],
        bones: [82., 98., 64., 48.],
        fold: WingPose {
            azimuth: 100.,
            elbow: 26.,
            wrist: 28.,
            roll: 84.,
            push: 10.,
            tuck: 2.2,
        },
        bind: WingPose {
            azimuth: 45.,
            elbow: 95.,
            wrist: 110.,
            roll: 0.,
            push: 0.,
            tuck: 0.,
        },
        spread: WingPose {
            azimuth: 12.,
            elbow: 150.,
            wrist: 165.,
            roll: 0.,
            push: 0.,
            tuck: 0.,
        },
        wing_slope: 58.,
        arm: [9.5, 9.5, 6.5, 3.5, 12.],
        legs: [[26., 20.], [20., 10.], [6.5, 6.5]],
        feathered_tarsus: false,
        blend: [12., 8., 9.],
        toes: [22., 36., 50., 45.],
        claws: [13., 16., 17., 16.],
        toe_radius: [5., 3.5],
        splay: [9., -9., 9., -9.],
        backward: [true, false, false, true],
        perch: 22.,
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
        tail: [53., 5., 38.],
        idle: 5.0,
        stretched: 3.3,
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
            [0., 50., -118., 161., 44., 58., 0.50],
            [30., 51., -99., 184., 72., 88., 0.52],
            [60., 53., -80., 208., 102., 120., 0.56],
            [95., 55., -60., 236., 130., 127., 0.60],
            [130., 57., -41., 265., 152., 136., 0.62],
            [165., 59., -22., 295., 165., 140., 0.62],
            [200., 61., -5., 325., 168., 144., 0.60],
            [235., 63., 12., 356., 160., 150., 0.58],
            [270., 67., 27., 388., 144., 150., 0.56],
            [300., 73., 37., 416., 122., 132., 0.52],
            [330., 80., 44., 445., 104., 108., 0.50],
            [360., 86., 48., 475., 95., 90., 0.50],
            [385., 90., 48., 500., 88., 82., 0.50],
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
            ("scap_L", [30., 398., 20.]),
            ("humerus_L", [62., 396., 2.]),
            ("ulna_L", [193., 285., -67.]),
            ("hand_L", [358., 402., 5.]),
            ("digit_L", [448., 357., -22.]),
            ("alula_L", [372., 406., 9.]),
            ("propat_L", [212., 403., 9.]),
            ("femur_L", [45., 257., -60.]),
            ("tibia_L", [62., 220., 36.]),
            ("tarsus_L", [52., 101., -61.]),
            ("foot_L", [48., 14., -3.]),
        ],
        bones: [185., 215., 105., 75.],
        fold: WingPose {
            azimuth: 98.,
            elbow: 22.,
            wrist: 24.,
            roll: 85.,
            push: 14.,
            tuck: 3.,
        },
        bind: WingPose {
            azimuth: 45.,
            elbow: 95.,
            wrist: 110.,
            roll: 0.,
            push: 0.,
            tuck: 0.,
        },
        spread: WingPose {
            azimuth: 12.,
            elbow: 150.,
            wrist: 165.,
            roll: 0.,
            push: 0.,
            tuck: 0.,
        },
        wing_slope: 58.,
        arm: [17., 17., 11., 6., 22.],
        legs: [[50., 30.], [34., 21.], [15., 13.]],
        feathered_tarsus: true,
        blend: [18., 8., 16.],
        toes: [38., 45., 68., 48.],
        claws: [51., 45., 38., 32.],
        toe_radius: [10., 7.],
        splay: [0., -22., 0., 22.],
        backward: [true, false, false, false],
        perch: 35.,
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
        tail: [53., 10., 65.],
        idle: 6.0,
        stretched: 4.0,
    }
}

impl Species {
    /// The bill.
    pub fn bill(&self) -> Bill {
        if self.is_parrot() {
            Bill {
                upper_at: [312., 92.],
                upper_base: [44., 34.],
                upper_tip: [4., 4.],
                upper_curve: [18., 0., 36., 88., 2.2],
                lower_at: [285., 86.],
                lower_base: [30., 36., 30.],
                lower_axis: [-6., 6.],
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
