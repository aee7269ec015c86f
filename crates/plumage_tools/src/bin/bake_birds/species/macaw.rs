//! The scarlet macaw as numbers: millimetres, degrees, sRGB.

use super::coat::{self, RowLook, TailCoverts, TractRow, look, row};
use super::coat::{CONTOUR, HEAD, LESSER, TRUNK};
use super::face::{BareFace, Bill, EyeRim, Patch, Rounded};
use super::motion::{Flick, Grip, Jaw, Motion};
use super::{Arcs, Shoulder, Species, WingPose};
use crate::tract::Tract::{self, *};

/// The bird.
pub fn species() -> Species {
    Species {
        name: "parrot",
        prefix: "macaw",
        scale: 1.0,
        cell: 4.9,
        trunk: [
            [0.0, 48.0, -74.0, 53.0, 30.0, 38.0, 0.50],
            [20.0, 49.0, -61.0, 68.0, 46.0, 56.0, 0.52],
            [40.0, 50.0, -48.0, 83.0, 65.3, 76.0, 0.56],
            [65.0, 52.0, -33.0, 102.0, 99.0, 88.0, 0.616],
            [90.0, 54.0, -18.0, 123.0, 121.0, 97.0, 0.64],
            [115.0, 56.0, -3.0, 143.0, 131.0, 103.0, 0.64],
            [140.0, 58.0, 11.0, 164.0, 131.0, 106.0, 0.615],
            [165.0, 61.0, 23.0, 186.0, 124.2, 106.1, 0.58],
            [190.0, 65.0, 35.0, 208.0, 117.0, 117.0, 0.56],
            [212.0, 71.0, 43.0, 228.0, 106.0, 115.0, 0.52],
            [235.0, 78.0, 49.0, 250.0, 95.0, 101.0, 0.50],
            [258.0, 85.0, 52.0, 273.0, 83.0, 82.0, 0.50],
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
            ("tibia_L", [26., 98., 14.]),
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
        swell: [[18., 2., 2., 16.], [24., 4., 64., 15.]],
        wing_slope: 58.,
        arm: [9.5, 9.5, 6.5, 3.5, 12.],
        legs: [[22., 20.], [20., 14.], [6.5, 6.5]],
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
            neck: 92.,
            scapulars: 205.,
            leg_top: 136.,
            head_plane: 283.,
            nape: 4.,
            head_angles: [100., 60.],
        },
        tail: [60., 7., 38.],
        title: "Scarlet macaw",
        down: "../downs/parrot.down.ron",
        fine_head: false,
        swell_scale: 1.0,
        shoulder_reach: 30.,
        shoulder: Some(Shoulder {
            thickness: 1.6,
            buried: 1.0,
            before: 0.1,
            reach: 0.5,
            blend: 25.,
        }),
        brow: None,
        bill: BILL,
        gaze: [0.93, 0.05, 0.36],
        lids: 0xD9C8BC,
        bare: BareFace::Patch(PATCH),
        eye_rim: EyeRim::OnBareSkin(1.5),
        lore: None,
        disc: None,
        templates: &TEMPLATES,
        tracts: TRACTS,
        rows: ROWS,
        lengths: lengths(),
        tail_coverts: TAIL_COVERTS,
        skin: SKIN,
        other_skin: 0xC8361D,
        motion: MOTION,
    }
}

const BILL: Bill = Bill {
    upper_at: [297., 91.],
    upper_base: [49., 36.],
    upper_tip: [3., 3.],
    upper_curve: [24., 0., 37., 86., 2.3],
    lower_at: [279., 78.],
    lower_base: [34., 38., 36.],
    lower_axis: [-8., 10.],
    colors: [0xE9DCC3, 0x1F1C1A, 0x1C1A1A, 0xF0E3D8],
    dark: [0.84, 0.1],
    cere: false,
    wedge: true,
    nostril: [0.05, 0.62],
    lower_taper: [0.75, 0.45],
    gape: &[],
};

const PATCH: Patch = Patch {
    patch: Rounded {
        at: [84.5, 309.0],
        half: [25.0, 20.0],
        radius: 15.0,
    },
    slant: [0.25, 312.0],
    droop: [0.5, 84.0],
    rim: Rounded {
        at: [112.0, 286.0],
        half: [21.0, 26.0],
        radius: 8.0,
    },
    blend: 10.0,
};

const MOTION: Motion = Motion {
    seconds: 5.0,
    stretched: 3.3,
    half_way: 2.73,
    swell: 0.025,
    bob: 1.5,
    counter: 2.0,
    rouse: [2.2, 7.0],
    flick: Some(Flick {
        span: [2.7, 4.2],
        ease: 0.1,
        degrees: 4.0,
        rate: 2.0,
    }),
    wings: [&[(2.4, 0.0), (3.2, 0.72), (3.5, 0.72), (4.4, 0.0)], &[]],
    fan: &[(2.4, 0.0), (3.2, 9.0), (3.5, 9.0), (4.3, 0.0)],
    yaw: &[
        (0.5, 0.0),
        (0.62, 22.0),
        (1.88, 22.0),
        (2.0, -40.0),
        (2.36, -40.0),
        (2.5, -15.0),
        (3.4, -15.0),
        (3.54, 8.0),
        (4.5, 8.0),
        (4.62, 0.0),
    ],
    pitch: &[
        (2.0, 0.0),
        (2.14, -6.0),
        (3.4, -6.0),
        (3.54, 4.0),
        (4.5, 4.0),
        (4.62, 0.0),
    ],
    roll: &[(3.4, 0.0), (3.54, 18.0), (4.3, 18.0), (4.6, 0.0)],
    jaw: Jaw {
        pulses: &[[4.0, 4.22, 0.1], [4.26, 4.5, 0.1]],
        open: 6.0,
        lift: 2.0,
    },
    blinks: &[1.1, 3.45],
    grip: Some(Grip {
        span: [4.55, 4.9],
        ease: 0.12,
        degrees: -14.0,
    }),
};

/// Feather templates, in the order of their numbers.
const TEMPLATES: [&str; 13] = [
    "head",
    "face_line",
    "neck",
    "contour",
    "soft",
    "blue",
    "semiplume",
    "lesser",
    "greater",
    "primary",
    "secondary",
    "rectrix",
    "leg",
];

/// Color of the skin below the coat.
const SKIN: &[(&[Tract], u32)] = &[
    (&[Bare, EyeRing], 0xF0E3D8),
    (&[Rump, Vent, TailUpper, TailUnder], 0x5DA9DC),
    (&[Back], 0xB83A24),
    (&[CovertUpper, Elbow], 0xB08E24),
    (&[LesserUnder, MarginalUnder, CovertUnder], 0xB03020),
    (&[Belly, Flank, Side, Femoral, Crural], 0xC0301B),
];

/// Scattered tracts.
#[rustfmt::skip]
const TRACTS: &[TractRow] = &[
    row("crown", &[Crown], "head", 420, 0, (8., 17.), (4.5, 7.), (10., 6.), (0.05, 10.), (0.1, 1800., HEAD), (0xD23A1E, 0xD23A1E)),
    row("nape", &[Nape], "head", 180, 0, (16., 24.), (8., 10.), (8., 8.), (0.06, 15.), (0.1, 1700., HEAD), (0xD23A1E, 0xD23A1E)),
    row("cheek", &[Cheek], "head", 540, 0, (8., 20.), (5.5, 8.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0xCE381C, 0xCE381C)),
    row("face_lines", &[Bare], "face_line", 160, 5, (2., 4.), (1.2, 2.), (20., 20.), (0., 0.), (0.1, 1950., HEAD), (0xF1E4D8, 0xF1E4D8)),
    row("neck_dorsal", &[NeckDorsal], "neck", 230, 0, (20., 28.), (13., 17.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xD23A1E, 0xC8361D)),
    row("neck_ventral", &[NeckVentral], "neck", 340, 0, (16., 28.), (11., 16.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xCC361D, 0xCC361D)),
    row("mantle", &[Mantle, ScapularMantle], "contour", 108, 8, (32., 46.), (20., 26.), (9., 9.), (0.06, 10.), (0.25, 1400., CONTOUR), (0xC8361D, 0xC4381D)),
    row("back", &[Back], "contour", 70, 6, (34., 46.), (20., 25.), (9., 9.), (0.06, 8.), (0.25, 1300., CONTOUR), (0xC83A1E, 0xC4361C)),
    row("rump", &[Rump], "blue", 80, 8, (28., 42.), (18., 24.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x5DA9DC, 0x5DA9DC)),
    row("scapulars", &[ScapularMantle], "contour", 90, 5, (48., 86.), (24., 30.), (9., 7.), (0.05, 8.), (0.25, 1200., (5, 2)), (0xC8361D, 0xC4361C)),
    row("shoulder", &[Shoulder], "contour", 180, 0, (25., 36.), (16., 20.), (6., 5.), (0.06, 14.), (0.25, 1350., CONTOUR), (0xC8361D, 0xC6351C)),
    row("shoulder_side", &[Shoulder], "contour", 80, 0, (26., 32.), (18., 22.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0xC6341C, 0xC6341C)),
    row("breast", &[Breast], "contour", 125, 12, (30., 42.), (20., 25.), (10., 6.), (0.05, 18.), (0.25, 1500., CONTOUR), (0xCC361D, 0xCC361D)),
    row("belly", &[Belly], "soft", 90, 0, (32., 46.), (20., 26.), (7., 5.), (0.05, 22.), (0.05, 660., CONTOUR), (0xC0301B, 0xC0301B)),
    row("flanks", &[Flank], "soft", 170, 0, (32., 46.), (18., 24.), (4., 3.), (0.05, 22.), (0.05, 640., CONTOUR), (0xC0301B, 0xC0301B)),
    row("side", &[Side], "contour", 163, 0, (28., 34.), (16., 20.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0xC6341C, 0xC0301B)),
    row("vent", &[Vent], "blue", 46, 0, (24., 34.), (15., 20.), (5., 5.), (0.05, 10.), (0.25, 300., CONTOUR), (0x6BAFD8, 0x6BAFD8)),
    row("filler", TRUNK, "semiplume", 200, 0, (14., 22.), (14., 18.), (2., 2.), (0., 0.), (0., 0., LESSER), (0xB0584C, 0xB0584C)),
    row("lesser_upper", &[LesserUpper], "lesser", 540, 7, (14., 28.), (11., 16.), (6., 6.), (0.04, 14.), (0.5, 1000., LESSER), (0xC8361D, 0xC8361D)),
    row("elbow", &[Elbow], "lesser", 40, 0, (26., 34.), (15., 20.), (5., 4.), (0.04, 14.), (0.9, 960., LESSER), (0xEDB414, 0xF2BC14)),
    row("marginal_upper", &[MarginalUpper], "lesser", 670, 0, (7., 15.), (5., 9.), (6., 6.), (0.05, 16.), (0.3, 1100., HEAD), (0xC8361D, 0xC8361D)),
    row("lesser_under", &[LesserUnder], "lesser", 340, 7, (14., 28.), (11., 16.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0xB03020, 0xB03020)),
    row("marginal_under", &[MarginalUnder], "lesser", 466, 0, (6., 13.), (5., 8.), (8., 8.), (0.08, 15.), (0.3, 1100., HEAD), (0xB03020, 0xB03020)),
    row("femoral", &[Femoral], "leg", 230, 0, (26., 34.), (14., 19.), (6., 5.), (0.10, 22.), (0.05, 600., CONTOUR), (0xC0301B, 0xC0301B)),
    row("crural", &[Crural], "leg", 550, 0, (26., 15.), (13., 9.), (7., 6.), (0.08, 18.), (0.05, 500., LESSER), (0xC0301B, 0xB02C1C)),
];

/// Rows.
#[rustfmt::skip]
const ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (46., 28.), (0., 0.06, 3.), (14, 4), (0x1F3F9C, 0x1F3F9C)),
    look("secondaries", "secondary", 9, (0., 0.), (48., 47.), (0., 0.09, 10.), (12, 4), (0x2450AE, 0x2B6795)),
    look("tertials", "secondary", 3, (0., 0.), (46., 44.), (0., 0.08, 10.), (12, 4), (0x2D6C89, 0x2E6F86)),
    look("alula", "primary", 4, (45., 85.), (14., 20.), (3., 0.06, 8.), (6, 2), (0x1F46A6, 0x1F46A6)),
    look("primary_coverts", "greater", 10, (70., 110.), (24., 20.), (1.5, 0.07, 8.), (6, 2), (0x2450AE, 0x2450AE)),
    look("greater_coverts", "greater", 12, (98., 76.), (30., 36.), (5., 0.06, 10.), (6, 2), (0xF2BC14, 0xF2BC14)),
    look("median_primary", "greater", 9, (46., 34.), (24., 20.), (6., 0.06, 12.), (4, 2), (0x2A58AA, 0x2450AE)),
    look("median_secondary", "greater", 12, (62., 48.), (24., 30.), (6., 0.06, 12.), (4, 2), (0xF5C21A, 0xF5C21A)),
    look("under_primary", "greater", 10, (70., 95.), (28., 20.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_secondary", "greater", 12, (80., 55.), (24., 28.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_median_primary", "lesser", 10, (40., 28.), (20., 16.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("under_median_secondary", "lesser", 12, (45., 32.), (20., 22.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("axillaries", "soft", 9, (50., 80.), (20., 26.), (5., 0.05, 5.), (4, 2), (0xB03020, 0xB03020)),
    look("rectrices", "rectrix", 6, (0., 0.), (34., 30.), (0., 0.12, 4.), (18, 4), (0xB42A1C, 0xB0301E)),
];

/// Lengths that are listed one by one: primaries P1..P10, secondaries then tertials, rectrices R1..R6.
fn lengths() -> [Vec<f32>; 3] {
    let ramp = coat::ramp;
    [
        vec![195., 205., 218., 235., 256., 280., 303., 318., 325., 312.],
        ramp(185., 165., 9).chain([150., 135., 115.]).collect(),
        vec![460., 405., 340., 275., 225., 185.],
    ]
}

const TAIL_COVERTS: TailCoverts = TailCoverts {
    rows: [&[6, 6, 6, 5], &[7, 6, 6, 6]],
    length: [(120., 40.), (130., 40.)],
    width: (26., 18.),
    feather: ["blue", "blue"],
    tint: [0x5DA9DC, 0x6BAFD8],
};
