//! Barn owl. Sizes, microstructure and colors: docs/book/birds.md#sources-of-the-data.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::{Albedo, Bars, Pattern, Spot};

const DOWN: u32 = 0xE8E2D8;
/// Down at the base of the coat's feathers, shaded by those above.
const BASE: u32 = 0xCCC2B6;
const WHITE: u32 = 0xF2ECE2;
const GOLD: u32 = 0xB8976C;
/// Grey of the veil that lies over the gold: vermiculated in life.
const VEIL: u32 = 0x96908C;
const DARK: u32 = 0x3A302A;
/// Drop at the end of a dark fleck.
const PEARL: u32 = 0xDCD6CC;
/// Bars of remiges and tail.
const BAR: u32 = 0x7A6450;

const HEAD: Micro = Micro {
    pitch: [0.35; 2],
    angle: [30.0; 2],
    ramus: 18.0,
    spacing: [31.0, 44.0],
    barbule_angle: [36.0, 34.0],
    cover: HOOKED,
    shaft: [0.35, 0.2, 0.04],
    downy: 0.5,
};
/// Open vanes: few barbs, barbules that run along them.
const OPEN: Micro = Micro {
    pitch: [0.55; 2],
    angle: [26.0; 2],
    ramus: 24.0,
    spacing: [45.0, 60.0],
    barbule_angle: [18.0; 2],
    cover: [0.74, 0.74],
    shaft: [0.45, 0.3, 0.08],
    downy: 0.2,
};
/// Dense and stiff.
const RUFF: Micro = Micro {
    pitch: [0.22; 2],
    angle: [24.0; 2],
    ramus: 26.0,
    spacing: [28.0, 40.0],
    barbule_angle: [36.0, 34.0],
    cover: HOOKED,
    shaft: [0.8, 0.55, 0.15],
    downy: 0.2,
};
const BODY: Micro = Micro {
    pitch: [0.5; 2],
    angle: [40.0; 2],
    ramus: 28.0,
    spacing: [32.0, 46.0],
    barbule_angle: [40.0, 36.0],
    cover: HOOKED,
    shaft: [0.8, 0.45, 0.07],
    downy: 0.55,
};
/// The vane of a remex: measured on two wood owls. Its barbules are twice as long as a hawk's.
const REMEX: Micro = Micro {
    pitch: [0.85, 0.4],
    angle: [14.9, 33.9],
    ramus: 60.0,
    spacing: [34.0, 46.5],
    barbule_angle: [45.0, 35.0],
    cover: HOOKED,
    shaft: [3.4, 1.2, 0.25],
    downy: 0.06,
};

/// Gold under a grey veil, which comes in between two heights and hides `grey` of the gold at the tip.
fn veiled_within([from, full]: [f32; 2], downy: f32, grey: f32) -> Pattern {
    let downy = downy * 0.5;
    Pattern {
        mottle: 0.3,
        ..stops(&[
            (0.0, BASE, 0.0),
            (downy - 0.05, BASE, 0.0),
            (downy + 0.08, GOLD, 0.9),
            (from, GOLD, 1.0),
            (full, VEIL, 1.1 - grey),
            (1.0, VEIL, 1.0 - grey),
        ])
    }
}

/// The same, veiled at the tip alone.
fn veiled(downy: f32, grey: f32) -> Pattern {
    veiled_within([0.72, 0.82], downy, grey)
}

/// A dark fleck along the shaft that ends in a pale pearl, at a height and a place across. `aspect`: half the width over the length.
fn pearl([v, across]: [f32; 2], half_width: f32, aspect: f32) -> Vec<Spot> {
    let spot = |v: f32, half_width: f32, roundness: f32, rgb: u32| Spot {
        v,
        across,
        half_width,
        half_length: (1000.0 * half_width * aspect * roundness).round() / 1000.0,
        color: hex(rgb),
        tint: 0.0,
    };
    vec![
        spot(v, 0.75 * half_width, 1.7, DARK),
        spot(v + 0.5 * half_width * aspect, 0.45 * half_width, 1.1, PEARL),
    ]
}

/// On the shaft a pearl near the end, further down a smaller one.
fn pearled(downy: f32, aspect: f32) -> Pattern {
    let mut spots = pearl([0.76, 0.0], 0.11, aspect);
    spots.extend(pearl([0.925, 0.0], 0.18, aspect));
    Pattern {
        spots,
        ..veiled(downy, 0.75)
    }
}

/// Gold with dark bars and a veiled tip; almost white below.
fn barred(count: f32, share: f32) -> Albedo {
    let pattern = |ground: u32, tint: f32, tip: u32, bar: u32| Pattern {
        bars: Some(Bars {
            count,
            color: hex(bar),
            share,
            waviness: 0.35,
        }),
        mottle: 0.25,
        ..stops(&[
            (0.0, DOWN, 0.0),
            (0.06, ground, tint),
            (0.8, ground, tint),
            (0.93, tip, 0.1),
            (1.0, tip, 0.1),
        ])
    };
    faces(
        pattern(GOLD, 0.9, VEIL, BAR),
        pattern(0xEDE5D8, 0.0, 0xD8D0C4, 0xC2B6A6),
    )
}

/// The owl's feathers. All of them end in long loose fringes.
pub(super) fn all() -> Vec<Template> {
    let head = Template {
        name: "owl_head",
        length_mm: 16.0,
        width_mm: 8.0,
        left_share: 0.5,
        bend: 0.02,
        start: 0.03,
        left: super::profiles::SOFT,
        right: super::profiles::SOFT,
        micro: HEAD,
        fringe: 0.4,
        gaps: gaps(3, 0.012, 0.3, 61),
        albedo: both(veiled(0.5, 0.55)),
        structural: false,
        matte: false,
    };
    let body_feather = Template {
        name: "owl_breast",
        length_mm: 32.0,
        width_mm: 17.0,
        micro: BODY,
        fringe: 0.4,
        gaps: gaps(4, 0.010, 0.4, 65),
        albedo: both(body(0.5, BASE, 0xD8CEC0, WHITE)),
        ..head.clone()
    };
    let lesser = Template {
        name: "owl_lesser",
        length_mm: 22.0,
        width_mm: 13.5,
        left: SPADE,
        right: SPADE,
        micro: Micro {
            pitch: [0.42; 2],
            angle: [38.0; 2],
            shaft: [0.6, 0.35, 0.07],
            downy: 0.42,
            ..BODY
        },
        fringe: 0.25,
        gaps: gaps(3, 0.007, 0.35, 69),
        albedo: both(Pattern {
            mottle: 0.4,
            ..veiled_within([0.6, 0.7], 0.42, 0.45)
        }),
        ..body_feather.clone()
    };
    let primary = Template {
        name: "owl_primary",
        length_mm: 227.0,
        width_mm: 36.0,
        left_share: 0.27,
        bend: 0.06,
        start: 0.03,
        left: REMEX_LEADING,
        right: REMEX_TRAILING,
        micro: REMEX,
        fringe: 0.16,
        gaps: gaps(2, 0.003, 0.3, 71),
        albedo: barred(5.0, 0.3),
        structural: false,
        matte: false,
    };
    vec![
        head.clone(),
        Template {
            name: "owl_disc",
            length_mm: 13.0,
            width_mm: 4.5,
            left: LANCEOLATE,
            right: LANCEOLATE,
            micro: OPEN,
            fringe: 0.5,
            gaps: gaps(2, 0.01, 0.3, 62),
            albedo: both(stops(&[
                (0.0, WHITE, 0.6),
                (0.8, WHITE, 1.0),
                (1.0, WHITE, 1.0),
            ])),
            ..head.clone()
        },
        Template {
            name: "owl_ruff",
            length_mm: 11.0,
            width_mm: 4.5,
            left: SCALE,
            right: SCALE,
            micro: RUFF,
            fringe: 0.15,
            gaps: gaps(1, 0.01, 0.2, 63),
            albedo: both(stops(&[
                (0.0, WHITE, 0.0),
                (0.3, WHITE, 0.2),
                (0.55, GOLD, 1.0),
                (0.8, GOLD, 1.0),
                (0.93, DARK, 0.45),
                (1.0, DARK, 0.35),
            ])),
            ..head.clone()
        },
        Template {
            name: "owl_mantle",
            length_mm: 36.0,
            width_mm: 20.0,
            left: ROUND,
            right: ROUND,
            fringe: 0.32,
            gaps: gaps(4, 0.008, 0.35, 64),
            albedo: both(pearled(0.5, 0.28)),
            ..body_feather.clone()
        },
        body_feather.clone(),
        Template {
            name: "owl_spot",
            gaps: gaps(4, 0.010, 0.4, 66),
            albedo: both(Pattern {
                spots: vec![Spot {
                    v: 0.925,
                    across: 0.0,
                    half_width: 0.17,
                    half_length: 0.045,
                    color: hex(DARK),
                    tint: 0.0,
                }],
                ..body(0.4, BASE, 0xD8CEC0, WHITE)
            }),
            ..body_feather.clone()
        },
        Template {
            name: "owl_soft",
            length_mm: 38.0,
            width_mm: 21.0,
            micro: Micro {
                pitch: [0.6; 2],
                angle: [43.0; 2],
                ramus: 24.0,
                shaft: [0.6, 0.3, 0.05],
                cover: super::template::SOFT,
                downy: 0.62,
                ..BODY
            },
            fringe: 0.5,
            gaps: gaps(7, 0.010, 0.45, 67),
            albedo: both(body(0.58, BASE, 0xDCD2C6, WHITE)),
            ..body_feather.clone()
        },
        Template {
            name: "owl_semiplume",
            length_mm: 24.0,
            width_mm: 15.0,
            left: TUFT,
            right: TUFT,
            micro: Micro {
                pitch: [0.7; 2],
                angle: [54.0; 2],
                ramus: 18.0,
                spacing: [25.0; 2],
                barbule_angle: [60.0; 2],
                cover: THREAD,
                shaft: [0.4, 0.2, 0.03],
                downy: 0.95,
            },
            fringe: 0.6,
            gaps: gaps(10, 0.014, 0.5, 68),
            albedo: both(stops(&[
                (0.0, DOWN, 0.0),
                (0.75, DOWN, 0.1),
                (1.0, DOWN, 0.5),
            ])),
            ..body_feather.clone()
        },
        lesser.clone(),
        Template {
            name: "owl_covert",
            length_mm: 36.0,
            width_mm: 19.0,
            micro: Micro {
                pitch: [0.45; 2],
                angle: [36.0; 2],
                shaft: [0.8, 0.45, 0.08],
                downy: 0.36,
                ..BODY
            },
            gaps: gaps(3, 0.006, 0.35, 76),
            albedo: both(Pattern {
                // Beside the shaft, where the next one in the row leaves it open.
                spots: pearl([0.86, -0.45], 0.15, 0.26),
                mottle: 0.45,
                ..veiled_within([0.52, 0.62], 0.36, 0.52)
            }),
            ..lesser
        },
        Template {
            name: "owl_greater",
            length_mm: 60.0,
            width_mm: 23.0,
            left_share: 0.42,
            bend: 0.04,
            left: OBLONG,
            right: OBLONG_FULL,
            micro: Micro {
                pitch: [0.60, 0.42],
                angle: [26.0, 35.0],
                ramus: 42.0,
                barbule_angle: [42.0, 35.0],
                shaft: [1.5, 0.7, 0.12],
                downy: 0.22,
                ..BODY
            },
            fringe: 0.22,
            gaps: gaps(3, 0.005, 0.35, 70),
            albedo: both(pearled(0.22, 0.19)),
            ..body_feather.clone()
        },
        primary.clone(),
        Template {
            name: "owl_secondary",
            length_mm: 150.0,
            width_mm: 38.0,
            left_share: 0.38,
            left: REMEX_LEADING,
            right: REMEX_TRAILING,
            micro: Micro {
                pitch: [0.75, 0.4],
                angle: [20.0, 34.0],
                shaft: [2.6, 1.0, 0.2],
                ..REMEX
            },
            fringe: 0.2,
            gaps: gaps(3, 0.004, 0.35, 72),
            albedo: barred(4.5, 0.28),
            ..primary.clone()
        },
        Template {
            name: "owl_rectrix",
            length_mm: 118.0,
            width_mm: 32.0,
            left_share: 0.46,
            bend: 0.03,
            left: SQUARE,
            right: SQUARE,
            micro: Micro {
                pitch: [0.65, 0.5],
                angle: [25.0, 32.0],
                shaft: [2.4, 1.0, 0.2],
                ..REMEX
            },
            fringe: 0.2,
            gaps: gaps(3, 0.004, 0.35, 73),
            albedo: barred(4.5, 0.24),
            ..primary
        },
        Template {
            name: "owl_leg",
            length_mm: 30.0,
            width_mm: 14.0,
            bend: 0.05,
            micro: Micro {
                pitch: [0.6; 2],
                angle: [40.0; 2],
                ramus: 24.0,
                cover: super::template::SOFT,
                shaft: [0.5, 0.25, 0.05],
                downy: 0.6,
                ..BODY
            },
            fringe: 0.55,
            gaps: gaps(8, 0.010, 0.5, 74),
            albedo: both(body(0.55, BASE, 0xE0D6C8, WHITE)),
            ..body_feather.clone()
        },
        Template {
            name: "owl_tarsal",
            length_mm: 13.0,
            width_mm: 7.0,
            right: TUFT,
            micro: Micro {
                pitch: [0.5; 2],
                ramus: 20.0,
                cover: super::template::SOFT,
                shaft: [0.35, 0.18, 0.04],
                downy: 0.5,
                ..BODY
            },
            fringe: 0.6,
            gaps: gaps(8, 0.013, 0.5, 75),
            albedo: both(body(0.5, DOWN, 0xE6DCCE, WHITE)),
            ..body_feather
        },
    ]
}
