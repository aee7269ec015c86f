//! The golden eagle as numbers: millimetres, degrees, sRGB.

use super::bird::{Arcs, Species, WingPose};
use super::coat::{self, RowLook, TailCoverts, TractRow, look, row};
use super::coat::{CONTOUR, HEAD, LESSER, TRUNK};
use super::face::{BareFace, Bill, Brow, Cere, EyeRim, Ledge, LoreArea, Naked};
use super::motion::{Jaw, Motion};
use super::tract::Tract::{self, *};

/// The bird.
pub fn species() -> Species {
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
            [130.0, 57.0, -41.0, 265.0, 171.0, 170.5, 0.62],
            [165.0, 59.0, -20.0, 294.0, 191.0, 175.5, 0.62],
            [200.0, 61.0, -3.0, 324.0, 197.0, 180.5, 0.6],
            [235.0, 63.0, 13.0, 355.5, 190.0, 189.7, 0.58],
            [270.0, 67.0, 27.0, 388.0, 181.0, 204.0, 0.56],
            [300.0, 73.0, 37.0, 416.0, 164.0, 194.0, 0.52],
            [330.0, 80.0, 44.0, 445.0, 130.0, 154.0, 0.5],
            [360.0, 86.0, 48.0, 475.0, 108.0, 110.0, 0.5],
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
            ("lid_up_L", [32.8, 523., 76.3]),
            ("lid_lo_L", [32.8, 523., 76.3]),
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
            ("tibia_L", [44., 234., 13.]),
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
        swell: [[20., -3., 1., 17.], [23., 3., 58., 11.]],
        wing_slope: 63.,
        hand_lay: 0.0,
        arm: [17., 17., 11., 11.5, 22.],
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
        bare_colors: [0x6E4A1E, 0xB48E36, 0x98782E, 0x1B1919],
        rigid: [120., 210.],
        arcs: Arcs {
            dorsal: [40., 135., 220., 300.],
            ventral: [112., 200.],
            neck: 100.,
            scapulars: 292.,
            leg_top: 287.,
            head_plane: 487.,
            nape: 2.,
            head_angles: [80., 62.],
        },
        tail: [64., 12., 65.],
        title: "Golden eagle",
        down: "../downs/eagle.down.ron",
        fine_head: true,
        swell_scale: 1.9,
        swell_blend: 45.,
        shoulder_reach: 80.,
        shoulder_hold: 0.9,
        brow: Some(BROW),
        bill: BILL,
        gaze: [0.84, 0.02, 0.54],
        lids: 0x3A2C20,
        lid_colors: [0x6B5A3A, 0x14100D],
        lid_edge: 0.95,
        lid_reach: 1.55,
        ledge: Some(LEDGE),
        bare: BareFace::Cere(CERE),
        naked: Some(NAKED),
        eye_rim: EyeRim::Oval {
            half: [9.5, 12.0],
            ahead: 2.5,
            beyond: 20.0,
        },
        lore: Some(LoreArea {
            ahead: 7.0,
            low: 16.0,
            high: 4.0,
            beyond: 8.0,
        }),
        disc: None,
        templates: &TEMPLATES,
        tracts: TRACTS,
        rows: ROWS,
        lengths: lengths(),
        tail_coverts: TAIL_COVERTS,
        skin: SKIN,
        other_skin: 0x43382D,
        motion: MOTION,
    }
}

#[rustfmt::skip]
const BILL: Bill = Bill {
    upper_at: [514., 90.],
    upper: &[
        [88.0, 530.5, 86.0, 499.5, 28.0],
        [95.0, 531.0, 92.0, 499.5, 29.0],
        [102.0, 530.0, 98.0, 499.5, 29.5],
        [109.0, 527.0, 104.0, 499.0, 27.5],
        [117.0, 523.0, 108.5, 498.0, 24.0],
        [124.0, 516.5, 112.0, 496.5, 20.5],
        [128.5, 508.0, 115.0, 494.0, 16.5],
        [130.5, 499.0, 118.0, 490.5, 12.5],
        [129.5, 490.0, 121.0, 486.0, 8.0],
        [125.5, 480.5, 123.5, 480.0, 2.5],
    ],
    lower: &[
        [80.0, 504.0, 80.0, 493.0, 16.0],
        [88.0, 504.0, 88.0, 490.5, 23.0],
        [96.0, 503.5, 96.0, 490.0, 22.5],
        [104.0, 502.5, 104.0, 491.0, 19.0],
        [110.5, 500.0, 110.5, 492.5, 13.5],
        [115.0, 497.5, 115.0, 494.5, 5.5],
    ],
    ridge: 0.35,
    colors: [0x6C767D, 0x1B1C1F, 0x454C51, 0xB48E36],
    dark: [0.36, 0.3],
    cere: [0.36, 0.45],
    wedge: [0.0, 0.0],
    nostril: [0.25, 56.0, 2.6, 1.4],
    rings: [5.0, 0.05],
    // From the cere back to below the eye.
    gape: &[
        [13.5, 502.5, 104.0],
        [21.0, 499.5, 98.0],
        [27.5, 496.5, 91.0],
        [32.0, 494.0, 83.5],
    ],
    gape_size: [1.6, 3.2],
};

/// The ridge that gives the eagle its scowl.
const BROW: Brow = Brow {
    from: [-4.0, 10.0, 15.0],
    to: [-3.0, 11.0, -14.0],
    radii: [6.0, 6.0],
    blend: 9.0,
};

const CERE: Cere = Cere {
    at: [108.0, 517.0],
    radius: 19.5,
    taper: 0.05,
    ahead: 94.0,
};

/// Skin round the cere.
const NAKED: Naked = Naked {
    axis: 80.0,
    turn: 90.0,
    height: [540.0, 494.0],
    fringe: 2.5,
    wrinkle: 3.2,
    blush: 0x8E6E22,
    edge: 1.5,
    coat: 0x6E5226,
    lines: None,
};

/// The bony edge of the brow.
const LEDGE: Ledge = Ledge {
    path: [[-6.0, 4.0, 18.0], [3.6, 7.6, 5.0], [0.0, 7.0, -14.0]],
    half: [5.0, 1.9],
    droop: 0.7,
    color: 0x281E16,
};

const MOTION: Motion = Motion {
    seconds: 6.0,
    stretched: 4.0,
    half_way: 4.5,
    breaths: 1.0,
    swell: 0.018,
    bob: 1.0,
    counter: 1.0,
    rouse: [3.8, 5.0],
    flick: None,
    wings: [&[(3.6, 0.0), (4.0, 0.25), (4.2, 0.25), (4.8, 0.0)]; 2],
    fan: &[(3.5, 0.0), (4.0, 6.0), (4.3, 6.0), (4.9, 0.0)],
    yaw: &[
        (0.68, 0.0),
        (0.8, 35.0),
        (2.6, 35.0),
        (2.74, -28.0),
        (4.6, -28.0),
        (4.74, 0.0),
    ],
    pitch: &[(2.6, 0.0), (2.74, 8.0), (4.6, 8.0), (4.74, 0.0)],
    roll: &[],
    jaw: Jaw {
        pulses: &[[5.0, 5.4, 0.15]],
        open: 4.0,
        lift: 0.0,
    },
    blinks: &[0.7, 2.7, 4.7],
    grip: None,
};

/// Feather templates, in the order of their numbers.
const TEMPLATES: [&str; 14] = [
    "head",
    "bristle",
    "hackle",
    "contour",
    "body",
    "soft",
    "semiplume",
    "lesser",
    "greater",
    "primary",
    "secondary",
    "rectrix",
    "trouser",
    "tarsal",
];

/// Color of the skin below the coat.
const SKIN: &[(&[Tract], u32)] = &[
    (&[Bare], 0xE8B62C),
    (&[Crown], 0x7A6650),
    (&[Nape, NeckDorsal], 0xA9875F),
    (&[Cheek, NeckVentral], 0x58493C),
    (&[Lore], 0x473D34),
    (&[EyeRing], 0x3A2E22),
    (&[Rump], 0x56493F),
    (&[Vent, TailUpper, TailUnder], 0x675749),
    (&[Femoral], 0x514239),
    (&[Crural], 0x756354),
    (&[Tarsal], 0x9A8369),
    (&[LesserUpper, MarginalUpper, CovertUpper, Elbow], 0x5A4D40),
    (&[LesserUnder, MarginalUnder, CovertUnder], 0x493D33),
];

/// Scattered tracts.
#[rustfmt::skip]
const TRACTS: &[TractRow] = &[
    row("crown", &[Crown], "head", 480, 0, (12., 26.), (6., 9.), (10., 7.), (0.06, 10.), (0.1, 1800., HEAD), (0x54422F, 0x9E7A50)).varied(0.15),
    row("nape", &[Nape], "hackle", 150, 0, (35., 60.), (10., 14.), (9., 9.), (0.12, 10.), (0.15, 1700., CONTOUR), (0xB88F5B, 0xB88F5B)),
    row("face", &[Cheek, Lore], "head", 956, 0, (8., 24.), (5.5, 9.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0x463A2E, 0x6E573C)).varied(0.18),
    row("lore", &[Lore], "bristle", 70, 0, (6., 12.), (1., 1.5), (25., 25.), (0., 0.), (0.5, 1950., (2, 1)), (0x382F27, 0x382F27)),
    row("neck_dorsal", &[NeckDorsal], "hackle", 280, 0, (40., 62.), (13., 19.), (9., 9.), (0.08, 12.), (0.2, 1600., CONTOUR), (0x745A3C, 0x463A2F)),
    row("neck_ventral", &[NeckVentral], "body", 300, 0, (26., 56.), (14., 24.), (9., 9.), (0.08, 14.), (0.2, 1600., CONTOUR), (0x4C3D2E, 0x745C47)).varied(0.15),
    row("mantle", &[Mantle, ScapularMantle], "contour", 88, 6, (55., 80.), (32., 42.), (8., 8.), (0.06, 10.), (0.25, 1400., CONTOUR), (0x594B39, 0x473B30)),
    row("back", &[Back], "contour", 50, 5, (55., 75.), (32., 40.), (9., 9.), (0.06, 8.), (0.25, 1300., CONTOUR), (0x473B30, 0x473B30)),
    row("rump", &[Rump], "contour", 60, 6, (50., 80.), (30., 40.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x4F4237, 0x4F4237)),
    row("scapulars", &[ScapularMantle], "contour", 104, 5, (84., 140.), (41., 52.), (9., 7.), (0.05, 8.), (0.25, 1200., (5, 2)), (0x4E4338, 0x4A3F35)),
    row("shoulder", &[Shoulder], "contour", 110, 0, (40., 54.), (28., 34.), (4., 3.), (0.07, 14.), (0.25, 0.6, CONTOUR), (0x544739, 0x52463B)),
    row("shoulder_side", &[Shoulder], "contour", 50, 0, (28., 36.), (24., 30.), (1., 1.), (0.06, 8.), (0., 0.5, LESSER), (0x45392E, 0x45392E)),
    row("breast", &[Breast], "body", 168, 11, (46., 62.), (27., 34.), (10., 6.), (0.07, 18.), (0.25, 1500., CONTOUR), (0x7D6350, 0x765E4C)).varied(0.25),
    row("belly", &[Belly], "soft", 94, 0, (55., 78.), (34., 44.), (7., 5.), (0.07, 22.), (0.05, 660., CONTOUR), (0x725A43, 0x725A43)).varied(0.15),
    row("flanks", &[Flank], "soft", 140, 0, (52., 70.), (30., 40.), (4., 3.), (0.07, 22.), (0.05, 640., CONTOUR), (0x705A42, 0x725B44)).varied(0.15),
    row("side", &[Side], "body", 98, 0, (50., 58.), (28., 34.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0x6E5A47, 0x685443)).varied(0.23),
    row("vent", &[Vent], "soft", 36, 0, (50., 80.), (28., 38.), (12., 12.), (0.05, 10.), (0.25, 300., CONTOUR), (0x765E47, 0x765E47)),
    row("filler", TRUNK, "semiplume", 60, 0, (26., 42.), (28., 36.), (2., 2.), (0., 0.), (0., 0., LESSER), (0x756A5E, 0x756A5E)),
    row("lesser_upper", &[LesserUpper], "lesser", 380, 0, (38., 28.), (24., 25.), (1., 1.), (0.04, 6.), (0.1, 0.5, LESSER), (0x56493E, 0x52463B)),
    row("elbow", &[Elbow], "lesser", 60, 0, (30., 38.), (24., 30.), (1., 1.), (0.04, 6.), (0.1, 0.5, LESSER), (0x52463B, 0x52463B)),
    row("marginal_upper", &[MarginalUpper], "head", 580, 0, (16., 30.), (12., 17.), (0.5, 0.5), (0.05, 14.), (0.3, 1100., HEAD), (0x4A3E34, 0x52463B)),
    row("lesser_under", &[LesserUnder], "lesser", 246, 6, (28., 44.), (22., 32.), (1., 1.), (0.06, 4.), (0.1, 1000., LESSER), (0x52463B, 0x52463B)),
    row("marginal_under", &[MarginalUnder], "head", 430, 0, (10., 26.), (8., 15.), (1., 1.), (0.08, 8.), (0.1, 1100., HEAD), (0x4F4237, 0x4F4237)),
    row("femoral", &[Femoral], "trouser", 210, 0, (50., 72.), (26., 34.), (6., 5.), (0.07, 22.), (0.05, 600., CONTOUR), (0x735B44, 0x745D45)),
    row("crural", &[Crural], "trouser", 430, 0, (72., 56.), (27., 22.), (6., 5.), (0.06, 14.), (0.15, 500., CONTOUR), (0x755D45, 0x786048)),
    row("tarsal", &[Tarsal], "tarsal", 300, 0, (34., 20.), (20., 14.), (7., 6.), (0.06, 14.), (0.05, 480., LESSER), (0x6A5641, 0x8A745A)).varied(0.25),
];

/// Rows.
#[rustfmt::skip]
const ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (72., 42.), (0., 0.06, 4.), (16, 4), (0x312A26, 0x312A26)),
    look("secondaries", "secondary", 13, (0., 0.), (75., 68.), (0., 0.09, 9.), (12, 4), (0x3C342F, 0x3C342F)),
    look("tertials", "greater", 4, (0., 0.), (70., 62.), (0., 0.07, 30.), (12, 4), (0x463B33, 0x4C4036)),
    look("alula", "primary", 4, (90., 170.), (26., 36.), (3., 0.06, 8.), (6, 2), (0x3A322C, 0x3A322C)),
    look("primary_coverts", "greater", 10, (130., 190.), (38., 32.), (1.5, 0.07, 8.), (6, 2), (0x382F29, 0x382F29)),
    look("greater_coverts", "greater", 14, (140., 108.), (50., 58.), (2., 0.06, 16.), (6, 2), (0x4B4036, 0x4B4036)),
    look("median_primary", "greater", 10, (80., 65.), (40., 34.), (6., 0.06, 12.), (4, 2), (0x54483D, 0x4E4238)),
    look("median_secondary", "greater", 15, (98., 74.), (42., 50.), (5., 0.06, 12.), (4, 2), (0x574A3F, 0x483D34)),
    look("lesser_1", "lesser", 15, (72., 54.), (38., 48.), (4., 0.05, 12.), (4, 2), (0x52463B, 0x4E4238)),
    look("lesser_2", "lesser", 15, (64., 62.), (35., 47.), (4., 0.05, 12.), (4, 2), (0x54483D, 0x504439)),
    look("lesser_3", "lesser", 15, (57., 80.), (32., 46.), (4., 0.05, 12.), (4, 2), (0x54483D, 0x504439)),
    look("lesser_4", "lesser", 15, (50., 76.), (30., 45.), (4., 0.05, 12.), (4, 2), (0x56493E, 0x52463B)),
    look("lesser_5", "lesser", 15, (43., 72.), (28., 43.), (4., 0.05, 12.), (4, 2), (0x56493E, 0x52463B)),
    look("under_primary", "greater", 10, (120., 150.), (46., 36.), (3., 0.06, 6.), (5, 2), (0x5B554E, 0x5B554E)),
    look("under_secondary", "greater", 14, (130., 95.), (40., 46.), (3., 0.06, 6.), (5, 2), (0x5B554E, 0x5B554E)),
    look("under_median_primary", "lesser", 11, (70., 55.), (34., 28.), (4., 0.06, 8.), (3, 2), (0x473D34, 0x473D34)),
    look("under_median_secondary", "lesser", 15, (80., 60.), (34., 36.), (4., 0.06, 8.), (3, 2), (0x473D34, 0x473D34)),
    look("axillaries", "soft", 14, (90., 150.), (34., 44.), (3., 0.05, 5.), (4, 2), (0x605448, 0x605448)),
    look("rectrices", "rectrix", 6, (0., 0.), (62., 58.), (0., 0.10, 4.), (12, 4), (0x514B45, 0x514B45)),
];

/// Lengths that are listed one by one: primaries P1..P10, secondaries then tertials, rectrices R1..R6.
fn lengths() -> [Vec<f32>; 3] {
    let ramp = coat::ramp;
    [
        vec![310., 325., 343., 371., 418., 465., 493., 489., 451., 362.],
        ramp(325., 289., 13)
            .chain([280., 240., 200., 165.])
            .collect(),
        vec![345., 350., 350., 345., 338., 325.],
    ]
}

const TAIL_COVERTS: TailCoverts = TailCoverts {
    rows: [&[6, 6, 6, 6], &[6, 6, 6, 5, 5]],
    length: [(160., 70.), (170., 70.)],
    width: (42., 32.),
    feather: ["contour", "soft"],
    tint: [0x54473B, 0x786048],
};
