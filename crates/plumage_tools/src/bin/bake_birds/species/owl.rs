//! The barn owl as numbers: millimetres, degrees, sRGB.

use super::coat::{self, RowLook, TailCoverts, TractRow, look, row};
use super::coat::{CONTOUR, HEAD, LESSER, TRUNK};
use super::face::{BareFace, Bill, Disc, EyeRim};
use super::motion::{Jaw, Motion};
use super::{Arcs, Species, WingPose};
use crate::tract::Tract::{self, *};

/// The bird.
pub fn species() -> Species {
    Species {
        name: "owl",
        prefix: "owl",
        scale: 0.92,
        cell: 4.0,
        trunk: [
            [0.0, 50.0, -54.0, 88.5, 25.2, 32.0, 0.5],
            [13.8, 51.0, -45.5, 99.0, 41.0, 48.0, 0.52],
            [27.6, 53.0, -37.0, 110.0, 56.0, 64.0, 0.56],
            [43.7, 55.0, -27.5, 123.0, 68.0, 67.0, 0.6],
            [59.8, 57.0, -19.0, 136.5, 75.0, 71.0, 0.62],
            [75.9, 59.0, -10.0, 150.0, 80.0, 74.0, 0.62],
            [92.0, 61.0, -2.3, 164.0, 82.0, 77.0, 0.6],
            [108.1, 63.0, 5.5, 178.0, 82.0, 80.0, 0.58],
            [124.2, 67.0, 12.0, 193.0, 78.0, 80.0, 0.56],
            [138.0, 73.0, 14.5, 206.0, 76.0, 75.0, 0.52],
            [151.8, 80.0, 16.0, 219.0, 72.0, 71.0, 0.5],
            [165.6, 86.0, 17.0, 233.0, 69.0, 68.0, 0.5],
            [177.1, 90.0, 17.5, 244.5, 66.0, 66.0, 0.5],
        ],
        head: [
            [-7., 250., 37., 38.],
            [0., 251., 51., 52.],
            [14., 252., 62., 62.],
            [30., 253., 66., 68.],
            [42., 253., 67., 69.],
            [50., 252., 61., 62.],
        ],
        joints: &[
            ("root", [0., 0., 0.]),
            ("hips", [0., 132.6, -21.6]),
            ("chest", [0., 168., 0.]),
            ("neck1", [0., 199., 14.7]),
            ("neck2", [0., 212.7, 18.4]),
            ("neck3", [0., 224.2, 20.7]),
            ("neck4", [0., 233.8, 21.6]),
            ("head", [0., 244.4, 22.]),
            ("jaw", [0., 237., 48.]),
            ("upper_bill", [0., 243., 50.]),
            ("eye_L", [15.5, 255., 52.5]),
            ("lid_up_L", [15.5, 255., 52.5]),
            ("lid_lo_L", [15.5, 255., 52.5]),
            ("tail", [0., 88.5, -54.]),
            ("tail_fan_L", [7.4, 84., -58.]),
            ("scap_L", [13.8, 201., 23.]),
            ("humerus_L", [27., 200.2, 14.7]),
            ("ulna_L", [86.4, 147.3, -12.2]),
            ("hand_L", [160.7, 202.9, 16.1]),
            ("digit_L", [201.4, 181.9, 5.4]),
            ("alula_L", [167.1, 204.8, 17.9]),
            ("propat_L", [94., 203.4, 17.2]),
            ("femur_L", [15., 135., -21.]),
            ("tibia_L", [19., 119., 10.]),
            ("tarsus_L", [20., 84., -27.]),
            ("foot_L", [20., 31., 0.]),
        ],
        bones: [84., 97., 47., 36.],
        fold: WingPose {
            azimuth: 116.,
            elbow: 20.,
            wrist: 45.,
            roll: 77.,
            toe: -5.,
            push: 14.5,
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
        fold_fan: 10.,
        swell: [[17., 3., 1., 11.], [18., 4., 38., 8.]],
        wing_slope: 63.,
        arm: [7.8, 7.8, 5.1, 2.8, 10.],
        legs: [[20., 20.], [20., 12.], [7., 6.]],
        feathered_tarsus: true,
        blend: [10., 4., 7.5],
        toes: [17., 27., 31., 25.],
        claws: [16., 17., 18., 15.],
        toe_radius: [4.6, 3.4],
        splay: [8., -8., 8., -9.],
        backward: [true, false, false, true],
        perch: 18.,
        perch_top: 24.,
        eye: [7.6, 5.6],
        bare_colors: [0x1C1512, 0xD8C0B0, 0xA99B8D, 0x2A2624],
        rigid: [55., 97.],
        arcs: Arcs {
            dorsal: [18.4, 62., 101., 138.],
            ventral: [51.5, 92.],
            neck: 125.,
            scapulars: 134.,
            leg_top: 146.,
            head_plane: 222.,
            nape: 2.,
            head_angles: [80., 62.],
        },
        tail: [64., 9., 45.],
        title: "Barn owl",
        down: "../downs/owl.down.ron",
        fine_head: true,
        swell_scale: 0.874,
        shoulder_reach: 26.,
        shoulder: None,
        brow: None,
        bill: BILL,
        gaze: [0.42, 0.0, 0.91],
        lids: 0x5A463E,
        bare: BareFace::Feathered,
        eye_rim: EyeRim::Round(0.95),
        lore: None,
        disc: Some(DISC),
        templates: &TEMPLATES,
        tracts: TRACTS,
        rows: ROWS,
        lengths: lengths(),
        tail_coverts: TAIL_COVERTS,
        skin: SKIN,
        other_skin: 0xC09A66,
        motion: MOTION,
    }
}

const BILL: Bill = Bill {
    upper_at: [241., 48.],
    upper_base: [12., 9.],
    upper_tip: [1.6, 1.6],
    upper_curve: [40., 8., 12., 70., 2.0],
    lower_at: [234., 47.],
    lower_base: [7., 7., 12.],
    lower_axis: [-7., -4.],
    colors: [0xE6D6C4, 0xD9C6B2, 0xDCCAB8, 0xD9BEB0],
    dark: [0.6, 0.4],
    cere: true,
    wedge: false,
    nostril: [0.3, 0.75],
    lower_taper: [0.8, 0.75],
    gape: &[],
};

const DISC: Disc = Disc {
    centre: [15.0, 253.0, 56.0],
    reach: [32.0, 33.0, 44.0],
    notch: 0.3,
    ruff: 0.22,
};

const MOTION: Motion = Motion {
    seconds: 6.0,
    stretched: 4.0,
    half_way: 4.5,
    swell: 0.022,
    bob: 0.8,
    counter: 1.0,
    rouse: [3.8, 6.0],
    flick: None,
    wings: [&[(3.6, 0.0), (4.0, 0.25), (4.2, 0.25), (4.8, 0.0)]; 2],
    fan: &[(3.5, 0.0), (4.0, 6.0), (4.3, 6.0), (4.9, 0.0)],
    yaw: &[
        (2.6, 0.0),
        (2.95, 65.0),
        (4.2, 65.0),
        (4.65, -35.0),
        (5.35, -35.0),
        (5.7, 0.0),
    ],
    pitch: &[(4.2, 0.0), (4.65, 10.0), (5.35, 10.0), (5.7, 0.0)],
    roll: &[(4.7, 0.0), (4.95, 15.0), (5.2, 15.0), (5.45, 0.0)],
    jaw: Jaw {
        pulses: &[[5.0, 5.2, 0.08], [5.3, 5.5, 0.08]],
        open: 8.0,
        lift: 0.0,
    },
    blinks: &[0.8, 2.65, 4.3],
    grip: None,
};

/// Feather templates, in the order of their numbers.
const TEMPLATES: [&str; 15] = [
    "head",
    "disc",
    "ruff",
    "mantle",
    "breast",
    "spot",
    "soft",
    "semiplume",
    "lesser",
    "greater",
    "primary",
    "secondary",
    "rectrix",
    "leg",
    "tarsal",
];

/// Color of the skin below the coat.
const SKIN: &[(&[Tract], u32)] = &[
    (&[Tract::Disc], 0xF6F0E8),
    (&[Ruff], 0xA87C48),
    (&[EyeRing], 0x8A6A58),
    (
        &[
            Breast,
            Belly,
            Flank,
            Side,
            Vent,
            TailUnder,
            NeckVentral,
            Femoral,
            Crural,
            Tarsal,
        ],
        0xE4DACB,
    ),
    (&[LesserUnder, MarginalUnder, CovertUnder], 0xE8E0D4),
];

/// Scattered tracts.
#[rustfmt::skip]
const TRACTS: &[TractRow] = &[
    row("crown", &[Crown], "head", 350, 0, (9., 16.), (5.5, 7.5), (10., 7.), (0.06, 10.), (0.1, 1800., HEAD), (0xB59368, 0xB0926D)),
    row("nape", &[Nape], "head", 240, 0, (16., 24.), (8., 11.), (8., 8.), (0.06, 12.), (0.15, 1700., HEAD), (0xB59368, 0xB59368)),
    row("cheek", &[Cheek], "head", 200, 0, (10., 20.), (6., 9.), (10., 8.), (0.05, 8.), (0.1, 1690., HEAD), (0xC4A277, 0xC9AF88)),
    row("disc", &[Tract::Disc], "disc", 640, 11, (9., 11.5), (4.4, 5.4), (11., 10.), (0.04, 4.), (0.2, 1900., HEAD), (0xEFE7DC, 0xF4EEE6)),
    row("eye_rays", &[Tract::Disc], "disc", 260, 0, (6., 9.), (3.6, 4.4), (8., 8.), (0.04, 4.), (0.2, 1880., HEAD), (0xCDB69C, 0xF0E8DC)),
    row("ruff", &[Ruff], "ruff", 420, 5, (10.5, 11.), (4., 5.), (24., 20.), (0.05, 10.), (0.5, 1950., HEAD), (0xC09866, 0x9A744D)),
    row("neck_dorsal", &[NeckDorsal], "mantle", 270, 0, (22., 32.), (12., 16.), (9., 9.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xBE9C71, 0xBE9C71)),
    row("neck_ventral", &[NeckVentral], "breast", 130, 0, (18., 28.), (11., 15.), (9., 9.), (0.07, 14.), (0.2, 1600., CONTOUR), (0xEDE3D4, 0xEFE7DA)),
    row("mantle", &[Mantle, ScapularMantle], "mantle", 100, 6, (30., 40.), (17., 21.), (8., 8.), (0.06, 10.), (0.25, 1400., CONTOUR), (0xBE9C71, 0xBE9C71)),
    row("back", &[Back], "mantle", 56, 5, (30., 38.), (17., 20.), (9., 9.), (0.06, 8.), (0.25, 1300., CONTOUR), (0xBE9C71, 0xC2A27A)),
    row("rump", &[Rump], "mantle", 64, 6, (28., 40.), (16., 20.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0xC4A67E, 0xC9AD87)),
    row("scapulars", &[ScapularMantle], "mantle", 90, 5, (44., 72.), (21., 26.), (9., 7.), (0.05, 8.), (0.25, 1200., (5, 2)), (0xBE9C71, 0xB8966D)),
    row("breast", &[Breast], "breast", 170, 11, (26., 34.), (14., 18.), (10., 6.), (0.07, 18.), (0.25, 1500., CONTOUR), (0xEFE6D8, 0xF2ECE2)),
    row("breast_spots", &[Breast], "spot", 34, 0, (26., 34.), (14., 18.), (10., 6.), (0.07, 18.), (0.25, 1510., CONTOUR), (0xEFE6D8, 0xF2ECE2)),
    row("belly", &[Belly], "soft", 100, 0, (30., 42.), (18., 23.), (7., 5.), (0.07, 22.), (0.05, 660., CONTOUR), (0xF2ECE2, 0xF4EFE6)),
    row("flanks", &[Flank], "soft", 150, 0, (28., 38.), (16., 21.), (4., 3.), (0.07, 22.), (0.05, 640., CONTOUR), (0xF0E9DE, 0xF2ECE2)),
    row("side", &[Side], "breast", 110, 0, (26., 30.), (15., 18.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0xEFE6D8, 0xEFE6D8)),
    row("vent", &[Vent], "soft", 40, 0, (26., 42.), (15., 20.), (12., 12.), (0.05, 10.), (0.25, 300., CONTOUR), (0xF4EFE6, 0xF4EFE6)),
    row("filler", TRUNK, "semiplume", 70, 0, (14., 22.), (14., 18.), (2., 2.), (0., 0.), (0., 0., LESSER), (0xCFC6BA, 0xCFC6BA)),
    row("lesser_upper", &[LesserUpper], "lesser", 540, 7, (15., 30.), (11., 16.), (8., 8.), (0.04, 14.), (0.5, 1000., LESSER), (0xC09C6E, 0xBE9C71)),
    row("elbow", &[Elbow], "lesser", 40, 0, (20., 24.), (14., 17.), (2., 2.), (0.04, 14.), (0.3, 960., LESSER), (0xBE9C71, 0xBE9C71)),
    row("marginal_upper", &[MarginalUpper], "lesser", 560, 0, (7., 14.), (5., 8.), (6., 6.), (0.05, 16.), (0.3, 1100., HEAD), (0xD2B287, 0xC4A277)),
    row("lesser_under", &[LesserUnder], "breast", 250, 6, (14., 28.), (11., 16.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0xF2ECE2, 0xF2ECE2)),
    row("marginal_under", &[MarginalUnder], "breast", 340, 0, (4.5, 9.), (4.5, 7.), (3., 4.), (0.06, 15.), (0.3, 1100., HEAD), (0xE2CDAE, 0xF2ECE2)),
    row("femoral", &[Femoral], "leg", 210, 0, (26., 36.), (13., 17.), (6., 5.), (0.07, 22.), (0.05, 600., CONTOUR), (0xF2ECE2, 0xF2ECE2)),
    row("crural", &[Crural], "leg", 420, 0, (34., 24.), (13., 10.), (6., 5.), (0.06, 14.), (0.15, 500., CONTOUR), (0xF2ECE2, 0xEFE7DA)),
    row("tarsal", &[Tarsal], "tarsal", 340, 0, (16., 9.), (8., 6.), (7., 6.), (0.06, 14.), (0.05, 480., LESSER), (0xEFE7DA, 0xE6DAC8)),
];

/// Rows.
#[rustfmt::skip]
const ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (38., 26.), (0., 0.06, 4.), (14, 4), (0xC4A277, 0xC4A277)),
    look("secondaries", "secondary", 13, (0., 0.), (38., 36.), (0., 0.09, 12.), (12, 4), (0xC4A277, 0xC4A277)),
    look("tertials", "greater", 4, (0., 0.), (35., 31.), (0., 0.07, 30.), (12, 4), (0xBE9C71, 0xBE9C71)),
    look("alula", "primary", 4, (42., 78.), (13., 18.), (3., 0.06, 8.), (6, 2), (0xC4A277, 0xC4A277)),
    look("primary_coverts", "greater", 10, (60., 88.), (20., 17.), (1.5, 0.07, 8.), (6, 2), (0xC09E72, 0xC09E72)),
    look("greater_coverts", "greater", 14, (66., 50.), (22., 27.), (2., 0.06, 16.), (6, 2), (0xBE9C71, 0xBE9C71)),
    look("median_primary", "greater", 10, (38., 31.), (20., 17.), (6., 0.06, 12.), (4, 2), (0xBE9C71, 0xBE9C71)),
    look("median_secondary", "greater", 15, (45., 34.), (19., 23.), (7., 0.06, 12.), (4, 2), (0xBE9C71, 0xBE9C71)),
    look("under_primary", "breast", 10, (56., 70.), (22., 17.), (3., 0.06, 6.), (5, 2), (0xF2ECE2, 0xF2ECE2)),
    look("under_secondary", "breast", 14, (60., 44.), (19., 22.), (3., 0.06, 6.), (5, 2), (0xF2ECE2, 0xF2ECE2)),
    look("under_median_primary", "breast", 11, (33., 26.), (16., 13.), (4., 0.06, 8.), (3, 2), (0xF2ECE2, 0xF2ECE2)),
    look("under_median_secondary", "breast", 15, (37., 28.), (16., 17.), (4., 0.06, 8.), (3, 2), (0xF2ECE2, 0xF2ECE2)),
    look("axillaries", "soft", 14, (42., 70.), (16., 21.), (5., 0.05, 5.), (4, 2), (0xF4EFE6, 0xF4EFE6)),
    look("rectrices", "rectrix", 6, (0., 0.), (32., 29.), (0., 0.10, 4.), (12, 4), (0xCFB189, 0xD6BE9B)),
];

/// Lengths that are listed one by one: primaries P1..P10, secondaries then tertials, rectrices R1..R6.
fn lengths() -> [Vec<f32>; 3] {
    let ramp = coat::ramp;
    [
        vec![154., 158., 164., 173., 184., 197., 210., 220., 224., 214.],
        ramp(155., 140., 13).chain([128., 112., 95., 80.]).collect(),
        vec![118., 118., 117., 115., 112., 107.],
    ]
}

const TAIL_COVERTS: TailCoverts = TailCoverts {
    rows: [&[6, 6, 6, 6], &[6, 6, 6, 5, 5]],
    length: [(66., 32.), (56., 32.)],
    width: (21., 16.),
    feather: ["mantle", "soft"],
    tint: [0xC9AD87, 0xF4EFE6],
};
