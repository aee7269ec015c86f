//! Scarlet macaw. Sizes, microstructure and colors: docs/book/birds.md#sources-of-the-data.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::Pattern;

const DOWN: u32 = 0xCFC4BC;
const GOLD: u32 = 0xE8A24A;
/// Base of the red feathers and what follows it, shaded by those above: white and gold would speckle the coat.
const BASE: u32 = 0xB8705E;
const AMBER: u32 = 0xC6502A;
const SCARLET: u32 = 0xC4231A;
/// Rims of the red feathers, by which one is told from the next: how soft they are, and on the body width, color and mottling.
const SOFT: f32 = 0.6;
const CRIMSON: (f32, u32, f32) = (0.3, 0xA62018, 0.29);
const YELLOW: u32 = 0xF2BC14;
const LIGHT_BLUE: u32 = 0x5DA9DC;
const BLUE: u32 = 0x1F3F9C;
const RED_GOLD: u32 = 0xA8431F;

const HEAD: Micro = Micro {
    pitch: [0.30; 2],
    angle: [32.0; 2],
    ramus: 18.0,
    spacing: [30.0, 38.0],
    barbule_angle: [38.0, 35.0],
    cover: HOOKED,
    shaft: [0.3, 0.18, 0.04],
    downy: 0.55,
};
const CONTOUR: Micro = Micro {
    pitch: [0.45; 2],
    angle: [40.0; 2],
    ramus: 28.0,
    spacing: [31.0, 38.0],
    barbule_angle: [40.0, 35.0],
    cover: HOOKED,
    shaft: [0.8, 0.45, 0.08],
    downy: 0.50,
};
const SOFT_MICRO: Micro = Micro {
    pitch: [0.55; 2],
    angle: [42.0; 2],
    ramus: 25.0,
    spacing: [33.0, 42.0],
    barbule_angle: [40.0, 40.0],
    cover: super::template::SOFT,
    shaft: [0.6, 0.3, 0.05],
    downy: 0.62,
};
const PRIMARY: Micro = Micro {
    pitch: [0.95, 0.45],
    angle: [14.0, 33.0],
    ramus: 60.0,
    spacing: [31.0, 38.0],
    barbule_angle: [45.0, 35.0],
    cover: HOOKED,
    shaft: [4.2, 1.3, 0.25],
    downy: 0.04,
};

/// Blue that the groom may shift: the color at the base, and along the feather where it is dark and where wholly blue.
fn blue(ground: u32, dark: f32, whole: f32) -> Pattern {
    Pattern {
        mottle: 0.1,
        ..stops(&[
            (0.0, ground, 0.0),
            (dark, 0x2A3550, 0.4),
            (whole, BLUE, 0.9),
            (1.0, 0x1B3688, 0.85),
        ])
    }
}

/// Dull red-gold, as the blue remiges are below.
fn red_gold(base: f32) -> Pattern {
    Pattern {
        mottle: 0.12,
        ..stops(&[
            (0.0, 0xB9A999, 0.0),
            (base, 0x8A3A20, 0.0),
            (0.5, RED_GOLD, 0.0),
            (1.0, 0x96401F, 0.0),
        ])
    }
}

/// The blue remiges.
fn blue_remex(base: f32) -> bevy_plumage::anatomy::Albedo {
    faces(blue(0xB9B4B0, base, 0.25), red_gold(base))
}

/// The alula: the coverts of the wrist, which are red, leave its lower half open here and there.
fn alula() -> bevy_plumage::anatomy::Albedo {
    let mut front = blue(SCARLET, 0.6, 0.75);
    let mut last = front.stops[0];
    last.v = 0.45;
    front.stops.insert(1, last);
    faces(front, red_gold(0.06))
}

/// A red body feather.
fn red(pattern: Pattern) -> bevy_plumage::anatomy::Albedo {
    let (width, rim, mottle) = CRIMSON;
    rimmed(Pattern { mottle, ..pattern }, width, SOFT, rim)
}

/// M1 to M14.
pub(super) fn all() -> Vec<Template> {
    let head = Template {
        name: "macaw_head",
        length_mm: 12.0,
        width_mm: 6.0,
        left_share: 0.5,
        bend: 0.02,
        start: 0.03,
        left: SCALE,
        right: SCALE,
        micro: HEAD,
        fringe: 0.22,
        gaps: gaps(3, 0.012, 0.3, 11),
        // Next to the naked face bases are seen: they are short there, and red.
        albedo: both(body(0.16, 0x8E3A2A, 0xA8321E, 0xC9241B)),
        structural: false,
        matte: false,
    };
    let contour = Template {
        name: "macaw_contour",
        length_mm: 38.0,
        width_mm: 22.8,
        left_share: 0.49,
        micro: CONTOUR,
        left: ROUND,
        right: ROUND,
        fringe: 0.08,
        gaps: gaps(3, 0.009, 0.4, 13),
        albedo: red(body(0.4, BASE, AMBER, SCARLET)),
        ..head.clone()
    };
    let primary = Template {
        name: "macaw_primary",
        length_mm: 318.0,
        width_mm: 38.0,
        left_share: 0.2,
        bend: 0.06,
        start: 0.03,
        left: POINTED_LEADING,
        right: POINTED_TRAILING,
        micro: PRIMARY,
        fringe: 0.02,
        gaps: gaps(2, 0.004, 0.3, 19),
        albedo: blue_remex(0.06),
        structural: true,
        matte: false,
    };
    let lesser_micro = Micro {
        pitch: [0.38; 2],
        angle: [38.0; 2],
        // A little more open than the others: so far the light that comes through it from behind is right from afar.
        cover: [0.742; 2],
        shaft: [0.6, 0.35, 0.08],
        downy: 0.44,
        ..CONTOUR
    };
    let greater = Template {
        name: "macaw_greater",
        length_mm: 68.0,
        width_mm: 27.0,
        left_share: 0.4,
        bend: 0.04,
        left: OBLONG,
        right: OBLONG_FULL,
        micro: Micro {
            pitch: [0.50, 0.42],
            angle: [28.0, 36.0],
            ramus: 40.0,
            barbule_angle: [42.0, 35.0],
            shaft: [1.6, 0.7, 0.12],
            downy: 0.25,
            ..CONTOUR
        },
        fringe: 0.02,
        gaps: gaps(2, 0.006, 0.35, 20),
        albedo: rimmed(
            Pattern {
                mottle: 0.16,
                ..stops(&[
                    (0.0, DOWN, 0.0),
                    (0.2, 0xCDB98A, 0.0),
                    (0.32, 0xE2AA12, 0.9),
                    (0.7, YELLOW, 1.0),
                    (0.93, YELLOW, 0.9),
                    (0.98, 0x7E9A2E, 0.15),
                    (1.0, 0x3F8A3A, 0.1),
                ])
            },
            0.22,
            SOFT,
            0xC6960E,
        ),
        ..contour.clone()
    };
    vec![
        head.clone(),
        Template {
            name: "macaw_face_line",
            length_mm: 3.0,
            width_mm: 1.4,
            start: 0.08,
            left: LANCEOLATE,
            right: LANCEOLATE,
            micro: Micro {
                shaft: [0.09, 0.05, 0.02],
                downy: 0.1,
                ..HEAD
            },
            gaps: gaps(0, 0.01, 0.3, 12),
            albedo: both(stops(&[(0.0, 0xF1E4D8, 1.0), (1.0, 0xF1E4D8, 1.0)])),
            ..head.clone()
        },
        Template {
            name: "macaw_neck",
            length_mm: 25.0,
            width_mm: 15.0,
            fringe: 0.12,
            gaps: gaps(3, 0.010, 0.35, 14),
            // As on the head, below whose naked skin it begins.
            albedo: red(body(0.2, 0x8E3A2A, 0xA8321E, SCARLET)),
            ..contour.clone()
        },
        contour.clone(),
        Template {
            name: "macaw_soft",
            width_mm: 23.0,
            left: super::profiles::SOFT,
            right: super::profiles::SOFT,
            micro: SOFT_MICRO,
            fringe: 0.35,
            gaps: gaps(6, 0.012, 0.45, 15),
            albedo: red(body(0.46, BASE, AMBER, 0xB8221A)),
            ..contour.clone()
        },
        Template {
            name: "macaw_blue",
            micro: Micro {
                pitch: [0.42; 2],
                ramus: 42.0,
                spacing: [33.0, 40.0],
                barbule_angle: [38.0, 35.0],
                downy: 0.45,
                ..CONTOUR
            },
            gaps: gaps(2, 0.009, 0.4, 16),
            albedo: both(body(0.45, DOWN, 0x8A7F86, LIGHT_BLUE)),
            structural: true,
            matte: false,
            ..contour.clone()
        },
        Template {
            name: "macaw_semiplume",
            length_mm: 18.0,
            width_mm: 11.7,
            left: TUFT,
            right: TUFT,
            micro: Micro {
                pitch: [0.60; 2],
                angle: [52.0; 2],
                ramus: 18.0,
                spacing: [25.0; 2],
                barbule_angle: [60.0; 2],
                cover: THREAD,
                shaft: [0.4, 0.2, 0.03],
                downy: 0.95,
            },
            fringe: 0.6,
            gaps: gaps(10, 0.015, 0.5, 17),
            albedo: both(stops(&[
                (0.0, DOWN, 0.0),
                (0.4, 0xC49A8E, 0.2),
                (0.75, 0xB86A5C, 0.6),
                (1.0, 0xB0584C, 0.8),
            ])),
            ..contour.clone()
        },
        Template {
            name: "macaw_lesser",
            length_mm: 22.0,
            width_mm: 13.2,
            left: BLUNT,
            right: BLUNT,
            micro: lesser_micro,
            fringe: 0.03,
            gaps: gaps(2, 0.008, 0.3, 18),
            // Narrower rims than on the body, and less dark: coverts lie close.
            albedo: {
                let pattern = Pattern {
                    mottle: 0.2,
                    ..body(0.36, BASE, AMBER, SCARLET)
                };
                rimmed(pattern, 0.12, SOFT, 0xA61F18)
            },
            ..contour.clone()
        },
        greater.clone(),
        Template {
            name: "macaw_primary_covert",
            gaps: gaps(2, 0.006, 0.35, 24),
            albedo: rimmed(blue(DOWN, 0.2, 0.32), 0.2, SOFT, 0x16285F),
            structural: true,
            ..greater
        },
        Template {
            name: "macaw_alula",
            albedo: alula(),
            ..primary.clone()
        },
        primary.clone(),
        Template {
            name: "macaw_secondary",
            length_mm: 175.0,
            width_mm: 48.0,
            left_share: 0.38,
            bend: 0.07,
            left: REMEX_LEADING,
            right: REMEX_TRAILING,
            micro: Micro {
                pitch: [0.75, 0.45],
                angle: [20.0, 34.0],
                ramus: 55.0,
                shaft: [3.6, 1.2, 0.25],
                downy: 0.05,
                ..PRIMARY
            },
            gaps: gaps(2, 0.004, 0.35, 21),
            albedo: blue_remex(0.07),
            ..primary.clone()
        },
        Template {
            name: "macaw_rectrix",
            length_mm: 460.0,
            width_mm: 32.0,
            left_share: 0.42,
            bend: 0.01,
            left: LANCE,
            right: LANCE,
            micro: Micro {
                pitch: [0.60, 0.50],
                angle: [24.0, 30.0],
                ramus: 55.0,
                shaft: [3.8, 1.5, 0.2],
                downy: 0.05,
                ..PRIMARY
            },
            gaps: gaps(3, 0.003, 0.35, 22),
            albedo: faces(
                Pattern {
                    mottle: 0.08,
                    ..stops(&[
                        (0.0, DOWN, 0.0),
                        (0.05, 0xB8221A, 0.3),
                        (0.45, SCARLET, 1.0),
                        (0.80, SCARLET, 1.0),
                        // Red and blue over one another are dark.
                        (0.83, 0x4A2018, 0.6),
                        (0.86, 0x1E2C48, 0.2),
                        (0.91, 0x2F55AC, 0.1),
                        (1.0, 0x1F46A6, 0.0),
                    ])
                },
                stops(&[
                    (0.0, 0xB9A999, 0.0),
                    (0.08, 0x96401F, 0.0),
                    (0.6, RED_GOLD, 0.0),
                    (1.0, 0x9A421F, 0.0),
                ]),
            ),
            ..primary
        },
        Template {
            name: "macaw_leg",
            length_mm: 24.0,
            width_mm: 13.2,
            left: super::profiles::SOFT,
            right: super::profiles::SOFT,
            micro: SOFT_MICRO,
            fringe: 0.4,
            gaps: gaps(7, 0.014, 0.45, 23),
            albedo: both(body(0.45, DOWN, GOLD, 0xB8221A)),
            ..contour
        },
    ]
}
