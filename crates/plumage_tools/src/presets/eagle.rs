//! Golden eagle. Sizes, microstructure and colors: docs/book/birds.md#sources-of-the-data.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::{Albedo, Bars, Pattern, Rim, Spot};

const DOWN: u32 = 0xD8D2C8;
/// Down at the base of the coat's feathers, shaded by those above: white would speckle it.
const BASE: u32 = 0x8C8378;
const DARK: u32 = 0x33271F;
const BROWN: u32 = 0x4A3524;
/// Pale rim of scapulars.
const RIM: u32 = 0x6C5C4D;
/// Paler sides of the body's feathers, between which the dark middle is a streak.
const SIDES: u32 = 0x8A6C53;
/// The same of belly and thighs.
const BELLY: u32 = 0x806549;
/// That streak.
const STREAK: u32 = 0x0F0A06;

const HEAD: Micro = Micro {
    pitch: [0.35; 2],
    angle: [32.0; 2],
    ramus: 20.0,
    spacing: [30.0, 40.0],
    barbule_angle: [38.0, 35.0],
    cover: HOOKED,
    shaft: [0.4, 0.22, 0.05],
    downy: 0.50,
};
const CONTOUR: Micro = Micro {
    pitch: [0.55; 2],
    angle: [42.0; 2],
    ramus: 35.0,
    spacing: [29.0, 42.0],
    barbule_angle: [40.0, 35.0],
    cover: HOOKED,
    shaft: [1.3, 0.75, 0.12],
    downy: 0.48,
};
const SOFT_MICRO: Micro = Micro {
    pitch: [0.65; 2],
    angle: [44.0; 2],
    ramus: 28.0,
    spacing: [32.0, 44.0],
    barbule_angle: [45.0; 2],
    cover: super::template::SOFT,
    shaft: [0.8, 0.4, 0.06],
    downy: 0.62,
};
const PRIMARY: Micro = Micro {
    pitch: [0.95, 0.53],
    angle: [17.0, 36.0],
    ramus: 80.0,
    spacing: [29.0, 44.0],
    barbule_angle: [45.0, 35.0],
    cover: HOOKED,
    shaft: [6.8, 2.3, 0.4],
    downy: 0.04,
};

/// A grey ground that ends in a dark tip, with dark wavy bars over it: over the tip they vanish. Paler below.
fn barred(count: f32, share: f32, waviness: f32, tip: f32, dark: u32) -> Albedo {
    let pattern = |ground: u32, dark: u32| Pattern {
        bars: Some(Bars {
            count,
            color: hex(dark),
            share,
            waviness,
        }),
        mottle: 0.28,
        ..stops(&[
            (0.0, DOWN, 0.0),
            (0.05, ground, 0.0),
            (tip - 0.06, ground, 0.0),
            (tip + 0.03, dark, 0.5),
            (1.0, dark, 0.5),
        ])
    };
    faces(pattern(0x554C44, dark), pattern(0x6B625A, 0x40372F))
}

/// A dark streak along the shaft, to the tip, that runs out into pale sides, down below: what streaks breast and belly of photographs.
/// `downy`: share of the length that is down, `tint`: share of the groom's color in the sides, `mottle`: how uneven streak and sides are.
fn streaked(downy: f32, sides: u32, tint: f32, mottle: f32) -> Albedo {
    let downy = downy * DOWN_SHOWN;
    both(Pattern {
        rim: Some(Rim {
            width: 0.34,
            softness: 0.5,
            color: hex(sides),
            tint,
        }),
        // Through the rim of the tip, so that the streak runs on over the next feather's: enclosed ones would form a net.
        spots: vec![Spot {
            v: 0.92,
            across: 0.0,
            half_width: 0.24,
            half_length: 0.24,
            color: hex(STREAK),
            tint: 0.1,
        }],
        mottle,
        ..stops(&[
            (0.0, BASE, 0.0),
            (downy - 0.1, BASE, 0.0),
            (downy, 0x38302A, 0.0),
            (0.7, STREAK, 0.1),
            (1.0, 0x20170F, 0.15),
        ])
    })
}

/// The eagle's feathers.
pub(super) fn all() -> Vec<Template> {
    let head = Template {
        name: "eagle_head",
        length_mm: 15.0,
        width_mm: 7.5,
        left_share: 0.5,
        bend: 0.02,
        start: 0.03,
        left: LANCET,
        right: LANCET,
        micro: HEAD,
        fringe: 0.18,
        gaps: gaps(3, 0.012, 0.3, 31),
        // Next to the eye and the cere bases are seen: they are short there, and dark. A pointed tip is paler than the streak before it.
        albedo: both(Pattern {
            rim: Some(Rim {
                width: 0.5,
                softness: Rim::SOFTNESS,
                color: hex(0x6E5842),
                tint: 0.6,
            }),
            mottle: 0.2,
            ..stops(&[
                (0.0, 0x5C4E40, 0.0),
                (0.12, 0x46382C, 0.0),
                (0.3, 0x3A2E24, 0.45),
                (0.7, 0x3A2E24, 0.55),
                (1.0, 0x66523C, 0.8),
            ])
        }),
        structural: false,
        matte: true,
    };
    let contour = Template {
        name: "eagle_contour",
        length_mm: 65.0,
        width_mm: 36.0,
        left_share: 0.49,
        micro: CONTOUR,
        left: BLUNT,
        right: ROUND,
        fringe: 0.08,
        gaps: gaps(4, 0.008, 0.4, 33),
        albedo: rimmed(body(0.46, BASE, 0x3A2A1E, BROWN), 0.2, Rim::SOFTNESS, RIM),
        matte: false,
        ..head.clone()
    };
    let primary = Template {
        name: "eagle_primary",
        length_mm: 489.0,
        width_mm: 64.0,
        left_share: 0.24,
        bend: 0.07,
        start: 0.025,
        left: FINGER_LEADING,
        right: FINGER_TRAILING,
        micro: PRIMARY,
        fringe: 0.02,
        gaps: gaps(3, 0.003, 0.3, 38),
        albedo: {
            let pattern = |base: u32, ground: u32, dark: u32| Pattern {
                bars: Some(Bars {
                    count: 13.0,
                    color: hex(dark),
                    share: 0.34,
                    waviness: 0.9,
                }),
                mottle: 0.3,
                ..stops(&[
                    (0.0, DOWN, 0.0),
                    (0.05, base, 0.0),
                    (0.36, ground, 0.0),
                    (0.5, dark, 0.5),
                    (1.0, dark, 0.5),
                ])
            };
            faces(
                pattern(0x5C534A, 0x554B43, DARK),
                pattern(0x726960, 0x625A51, 0x3C342D),
            )
        },
        structural: false,
        matte: false,
    };
    vec![
        head.clone(),
        Template {
            name: "eagle_bristle",
            length_mm: 9.0,
            width_mm: 0.9,
            start: 0.03,
            left: BRISTLE,
            right: BRISTLE,
            micro: Micro {
                pitch: [0.4; 2],
                shaft: [0.3, 0.14, 0.03],
                downy: 0.3,
                ..HEAD
            },
            gaps: gaps(0, 0.01, 0.3, 30),
            albedo: both(stops(&[(0.0, 0x3A2A1C, 1.0), (1.0, 0x2A1E14, 1.0)])),
            ..head.clone()
        },
        Template {
            name: "eagle_hackle",
            length_mm: 50.0,
            width_mm: 13.0,
            left: LANCEOLATE,
            right: LANCEOLATE,
            micro: Micro {
                pitch: [0.50; 2],
                angle: [24.0; 2],
                ramus: 30.0,
                spacing: [30.0, 42.0],
                barbule_angle: [38.0, 35.0],
                shaft: [0.9, 0.5, 0.08],
                downy: 0.40,
                ..CONTOUR
            },
            fringe: 0.35,
            gaps: gaps(4, 0.008, 0.35, 32),
            albedo: both(Pattern {
                mottle: 0.12,
                ..stops(&[
                    (0.0, BASE, 0.0),
                    (0.25, BASE, 0.0),
                    (0.4, 0x46392E, 0.0),
                    (0.55, 0x46392E, 0.3),
                    (0.75, 0xB38B58, 1.0),
                    (1.0, 0xB38B58, 0.9),
                ])
            }),
            matte: true,
            ..contour.clone()
        },
        contour.clone(),
        // What covers the body runs together in streaks: only scapulars and coverts have narrow rims.
        Template {
            name: "eagle_body",
            left: LANCET,
            right: LANCET,
            fringe: 0.3,
            gaps: gaps(12, 0.012, 0.7, 43),
            albedo: streaked(0.46, SIDES, 0.92, 1.0),
            matte: true,
            ..contour.clone()
        },
        Template {
            name: "eagle_soft",
            width_mm: 37.0,
            left: super::profiles::SOFT,
            right: super::profiles::SOFT,
            micro: SOFT_MICRO,
            fringe: 0.34,
            gaps: gaps(7, 0.010, 0.45, 34),
            albedo: streaked(0.58, BELLY, 0.7, 0.85),
            matte: true,
            ..contour.clone()
        },
        Template {
            name: "eagle_semiplume",
            length_mm: 34.0,
            width_mm: 22.0,
            left: TUFT,
            right: TUFT,
            micro: Micro {
                pitch: [0.75; 2],
                angle: [55.0; 2],
                ramus: 20.0,
                spacing: [25.0; 2],
                barbule_angle: [60.0; 2],
                cover: THREAD,
                shaft: [0.5, 0.25, 0.04],
                downy: 0.95,
            },
            fringe: 0.6,
            gaps: gaps(10, 0.014, 0.5, 35),
            albedo: both(stops(&[
                (0.0, DOWN, 0.0),
                (0.75, DOWN, 0.1),
                (1.0, 0xA89A88, 0.6),
            ])),
            ..contour.clone()
        },
        Template {
            name: "eagle_lesser",
            length_mm: 45.0,
            width_mm: 27.0,
            left: SPADE,
            right: SPADE,
            micro: Micro {
                pitch: [0.48; 2],
                angle: [40.0; 2],
                shaft: [1.1, 0.6, 0.1],
                downy: 0.42,
                ..CONTOUR
            },
            fringe: 0.04,
            gaps: gaps(3, 0.007, 0.35, 36),
            albedo: rimmed(
                body(0.42, BASE, 0x302822, 0x4C3F35),
                0.26,
                Rim::SOFTNESS,
                0x665646,
            ),
            ..contour.clone()
        },
        Template {
            name: "eagle_greater",
            length_mm: 122.0,
            width_mm: 46.0,
            left_share: 0.4,
            bend: 0.04,
            left: OBLONG,
            right: OBLONG_FULL,
            micro: Micro {
                pitch: [0.60, 0.50],
                angle: [30.0, 38.0],
                ramus: 50.0,
                barbule_angle: [42.0, 35.0],
                shaft: [2.6, 1.2, 0.2],
                downy: 0.22,
                ..CONTOUR
            },
            fringe: 0.03,
            gaps: gaps(3, 0.005, 0.35, 37),
            albedo: rimmed(
                body(0.22, DOWN, 0x463D36, 0x473D33),
                0.12,
                Rim::SOFTNESS,
                0x62554A,
            ),
            ..contour.clone()
        },
        primary.clone(),
        Template {
            name: "eagle_secondary",
            length_mm: 312.0,
            width_mm: 75.0,
            left_share: 0.38,
            bend: 0.07,
            left: REMEX_LEADING,
            right: REMEX_TRAILING,
            micro: Micro {
                pitch: [0.80, 0.52],
                angle: [22.0, 36.0],
                ramus: 75.0,
                shaft: [6.0, 2.2, 0.4],
                downy: 0.05,
                ..PRIMARY
            },
            gaps: gaps(3, 0.004, 0.35, 39),
            albedo: barred(6.0, 0.56, 0.5, 0.86, 0x3B2E25),
            ..primary.clone()
        },
        Template {
            name: "eagle_rectrix",
            length_mm: 345.0,
            width_mm: 62.0,
            left_share: 0.46,
            bend: 0.03,
            left: SQUARE,
            right: SQUARE,
            micro: Micro {
                pitch: [0.70, 0.55],
                angle: [26.0, 34.0],
                ramus: 75.0,
                shaft: [6.0, 2.2, 0.4],
                downy: 0.05,
                ..PRIMARY
            },
            gaps: gaps(3, 0.004, 0.35, 40),
            albedo: barred(6.5, 0.46, 0.6, 0.78, 0x2A201A),
            ..primary
        },
        Template {
            name: "eagle_trouser",
            length_mm: 62.0,
            width_mm: 25.0,
            bend: 0.05,
            left: super::profiles::SOFT,
            right: super::profiles::SOFT,
            micro: SOFT_MICRO,
            fringe: 0.5,
            gaps: gaps(8, 0.010, 0.5, 41),
            albedo: streaked(0.55, BELLY, 0.7, 0.85),
            matte: true,
            ..contour.clone()
        },
        Template {
            name: "eagle_tarsal",
            length_mm: 28.0,
            width_mm: 16.8,
            left: super::profiles::SOFT,
            right: TUFT,
            micro: SOFT_MICRO,
            fringe: 0.6,
            gaps: gaps(9, 0.013, 0.5, 42),
            albedo: both(body(0.5, DOWN, 0xAE9B84, 0x98826A)),
            ..contour
        },
    ]
}
