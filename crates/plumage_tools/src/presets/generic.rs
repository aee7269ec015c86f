//! One neutral feather per type, for birds of one's own: grey-brown that the groom's color replaces.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::{Albedo, Pattern};

const DOWN: u32 = 0xD2CCC4;
const NEUTRAL: u32 = 0x6E655C;

const CONTOUR: Micro = Micro {
    pitch: [0.45; 2],
    angle: [40.0; 2],
    ramus: 30.0,
    spacing: [30.0, 38.0],
    barbule_angle: [40.0, 36.0],
    cover: HOOKED,
    shaft: [0.8, 0.45, 0.08],
    downy: 0.48,
};
/// Medians of 93 birds: 20 and 34 degrees, 1.9 and 3.0 barbs per mm, 38 and 29 barbules per mm.
const REMEX: Micro = Micro {
    pitch: [0.53, 0.33],
    angle: [20.0, 34.0],
    ramus: 50.0,
    spacing: [26.0, 34.0],
    barbule_angle: [45.0, 35.0],
    cover: HOOKED,
    shaft: [3.0, 1.1, 0.2],
    downy: 0.05,
};
const PLUMULE: Micro = Micro {
    pitch: [0.6; 2],
    angle: [58.0; 2],
    ramus: 16.0,
    spacing: [25.0; 2],
    barbule_angle: [60.0; 2],
    cover: THREAD,
    shaft: [0.35, 0.16, 0.02],
    downy: 1.0,
};

fn plain(base: f32) -> Albedo {
    both(Pattern {
        mottle: 0.1,
        ..stops(&[(0.0, DOWN, 0.0), (base, NEUTRAL, 0.8), (1.0, NEUTRAL, 1.0)])
    })
}

/// Thirteen types.
pub(super) fn all() -> Vec<Template> {
    let contour = Template {
        name: "contour",
        length_mm: 40.0,
        width_mm: 23.0,
        left_share: 0.49,
        bend: 0.02,
        start: 0.03,
        left: ROUND,
        right: ROUND,
        micro: CONTOUR,
        fringe: 0.08,
        gaps: gaps(3, 0.009, 0.4, 51),
        albedo: both(body(0.46, DOWN, 0x9A9086, NEUTRAL)),
        structural: false,
        matte: false,
    };
    let primary = Template {
        name: "primary",
        length_mm: 180.0,
        width_mm: 25.0,
        left_share: 0.22,
        bend: 0.06,
        left: POINTED_LEADING,
        right: POINTED_TRAILING,
        micro: REMEX,
        fringe: 0.02,
        gaps: gaps(2, 0.004, 0.3, 52),
        albedo: plain(0.1),
        ..contour.clone()
    };
    let covert_micro = Micro {
        pitch: [0.48, 0.42],
        angle: [28.0, 36.0],
        ramus: 38.0,
        shaft: [1.4, 0.65, 0.1],
        downy: 0.24,
        ..CONTOUR
    };
    let tuft = Template {
        name: "semiplume",
        length_mm: 24.0,
        width_mm: 16.0,
        left: TUFT,
        right: TUFT,
        micro: PLUMULE,
        fringe: 0.6,
        gaps: gaps(10, 0.014, 0.5, 53),
        albedo: both(stops(&[
            (0.0, DOWN, 0.0),
            (0.8, DOWN, 0.2),
            (1.0, DOWN, 0.6),
        ])),
        ..contour.clone()
    };
    vec![
        primary.clone(),
        Template {
            name: "secondary",
            length_mm: 130.0,
            width_mm: 33.0,
            left_share: 0.38,
            bend: 0.07,
            left: REMEX_LEADING,
            right: REMEX_TRAILING,
            gaps: gaps(2, 0.005, 0.35, 54),
            ..primary.clone()
        },
        Template {
            name: "rectrix",
            length_mm: 160.0,
            width_mm: 30.0,
            left_share: 0.42,
            bend: 0.03,
            left: SQUARE,
            right: SQUARE,
            gaps: gaps(3, 0.005, 0.35, 55),
            ..primary.clone()
        },
        Template {
            name: "alula",
            length_mm: 60.0,
            width_mm: 15.0,
            left_share: 0.3,
            bend: 0.08,
            left: REMEX_LEADING,
            right: POINTED_TRAILING,
            micro: Micro {
                shaft: [1.6, 0.7, 0.12],
                ..REMEX
            },
            gaps: gaps(1, 0.006, 0.3, 56),
            ..primary
        },
        Template {
            name: "greater_covert",
            length_mm: 70.0,
            width_mm: 26.0,
            left_share: 0.4,
            bend: 0.04,
            left: OBLONG,
            right: OBLONG_FULL,
            micro: covert_micro,
            fringe: 0.03,
            gaps: gaps(2, 0.006, 0.35, 57),
            albedo: both(body(0.24, DOWN, 0x9A9086, NEUTRAL)),
            ..contour.clone()
        },
        Template {
            name: "median_covert",
            length_mm: 42.0,
            width_mm: 21.0,
            left_share: 0.44,
            bend: 0.03,
            left: OBLONG,
            right: BLUNT,
            micro: Micro {
                angle: [34.0, 38.0],
                shaft: [1.0, 0.5, 0.1],
                downy: 0.33,
                ..covert_micro
            },
            fringe: 0.04,
            gaps: gaps(2, 0.007, 0.35, 58),
            albedo: both(body(0.33, DOWN, 0x9A9086, NEUTRAL)),
            ..contour.clone()
        },
        Template {
            name: "lesser_covert",
            length_mm: 26.0,
            width_mm: 15.5,
            left: SPADE,
            right: SPADE,
            micro: Micro {
                pitch: [0.40; 2],
                angle: [38.0; 2],
                shaft: [0.65, 0.35, 0.08],
                downy: 0.43,
                ..CONTOUR
            },
            fringe: 0.04,
            gaps: gaps(2, 0.008, 0.3, 59),
            albedo: both(body(0.43, DOWN, 0x9A9086, NEUTRAL)),
            ..contour.clone()
        },
        contour.clone(),
        tuft.clone(),
        Template {
            name: "down",
            length_mm: 14.0,
            width_mm: 14.0,
            start: 0.01,
            micro: Micro {
                pitch: [0.35; 2],
                angle: [52.0; 2],
                shaft: [0.25, 0.06, 0.01],
                ..PLUMULE
            },
            gaps: gaps(16, 0.016, 0.55, 60),
            ..tuft
        },
        Template {
            name: "hackle",
            length_mm: 45.0,
            width_mm: 12.0,
            left: LANCEOLATE,
            right: LANCEOLATE,
            micro: Micro {
                angle: [24.0; 2],
                downy: 0.4,
                ..CONTOUR
            },
            fringe: 0.35,
            gaps: gaps(4, 0.008, 0.35, 61),
            albedo: both(body(0.4, DOWN, 0x6A5F55, NEUTRAL)),
            ..contour.clone()
        },
        Template {
            name: "bristle",
            length_mm: 10.0,
            width_mm: 1.0,
            left: BRISTLE,
            right: BRISTLE,
            micro: Micro {
                angle: [30.0; 2],
                shaft: [0.3, 0.14, 0.03],
                downy: 0.3,
                ..CONTOUR
            },
            gaps: gaps(0, 0.01, 0.3, 62),
            albedo: both(stops(&[(0.0, 0x4A4038, 1.0), (1.0, 0x2A241E, 1.0)])),
            ..contour.clone()
        },
        Template {
            name: "filoplume",
            length_mm: 20.0,
            width_mm: 2.4,
            start: 0.78,
            left: BRUSH,
            right: BRUSH,
            micro: Micro {
                pitch: [0.5; 2],
                angle: [26.0; 2],
                ramus: 12.0,
                shaft: [0.12, 0.08, 0.03],
                downy: 0.0,
                ..PLUMULE
            },
            fringe: 0.5,
            gaps: gaps(0, 0.01, 0.3, 63),
            albedo: both(stops(&[(0.0, 0x8A8078, 0.5), (1.0, 0xA89E94, 0.5)])),
            ..contour
        },
    ]
}
