//! Feathers that shimmer: an eye of a peacock's train, a speculum feather of a mallard, neck and throat feathers of a pigeon and of
//! Anna's hummingbird. Their thin layers are those of `assets/stacks.ron` (docs/book/iridescence.md#presets); sizes are of ordinary
//! adults. Where a vane is painted dark its barbules carry the layers; pale parts have no melanin, and so none.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::Feather;
use bevy_plumage::maths::scattering::Sheen;
use plumage_tests::shipped;

/// Melanin under the layers.
const DARK: u32 = 0x241E1A;

/// Widest just below the end, then round: the eye at the end of a train feather.
const EYE: Profile = Profile::new(
    &[
        (0.0, 0.2),
        (0.3, 0.42),
        (0.62, 0.62),
        (0.82, 1.0),
        (1.0, 0.95),
    ],
    0.8,
    (2.2, 2.0),
);

fn shimmer(template: &Template, stack: &str) -> Feather {
    let mut feather = template.build();
    feather.iridescence = Some(shipped::stack(stack));
    // A pale bloom would fill the dark around the flash.
    feather.optics.sheen = Sheen {
        strength: 0.04,
        ..feather.optics.sheen
    };
    feather
}

/// Four feathers.
pub(super) fn all() -> Vec<Feather> {
    let neck = Template {
        name: "pigeon_neck",
        length_mm: 24.0,
        width_mm: 11.0,
        left_share: 0.5,
        bend: 0.02,
        start: 0.03,
        left: SPADE,
        right: SPADE,
        micro: Micro {
            pitch: [0.32; 2],
            angle: [32.0; 2],
            ramus: 18.0,
            spacing: [26.0, 30.0],
            barbule_angle: [34.0, 32.0],
            radius: [6.0, 5.5],
            shaft: [0.5, 0.26, 0.05],
            downy: 0.5,
        },
        fringe: 0.16,
        gaps: gaps(2, 0.01, 0.3, 71),
        albedo: both(stops(&[
            (0.0, 0xB8B4B0, 0.0),
            (0.24, 0x8C8A8A, 0.0),
            (0.42, 0x5A5A5E, 0.0),
            (0.55, DARK, 0.0),
            (1.0, DARK, 0.0),
        ])),
        structural: false,
    };
    let eye = Template {
        name: "peacock_eye",
        length_mm: 230.0,
        width_mm: 78.0,
        bend: 0.03,
        start: 0.02,
        left: EYE,
        right: EYE,
        micro: Micro {
            pitch: [0.95; 2],
            angle: [38.0; 2],
            ramus: 90.0,
            spacing: [34.0, 36.0],
            barbule_angle: [52.0, 50.0],
            radius: [10.5, 10.0],
            shaft: [2.0, 1.1, 0.3],
            downy: 0.0,
        },
        fringe: 0.3,
        gaps: gaps(5, 0.006, 0.3, 72),
        albedo: both(stops(&[
            (0.0, 0xB5A58C, 0.0),
            (0.08, 0x4A3C2C, 0.0),
            (0.16, DARK, 0.0),
            (1.0, DARK, 0.0),
        ])),
        ..neck.clone()
    };
    let speculum = Template {
        name: "mallard_speculum",
        length_mm: 104.0,
        width_mm: 27.0,
        left_share: 0.4,
        bend: 0.06,
        left: REMEX_LEADING,
        right: SQUARE,
        micro: Micro {
            pitch: [0.45, 0.36],
            angle: [26.0, 36.0],
            ramus: 40.0,
            spacing: [26.0, 32.0],
            barbule_angle: [42.0, 35.0],
            radius: [7.0, 6.0],
            shaft: [2.2, 1.0, 0.16],
            downy: 0.06,
        },
        fringe: 0.02,
        gaps: gaps(1, 0.004, 0.3, 73),
        albedo: both(stops(&[
            (0.0, 0xCFC8BE, 0.0),
            (0.08, 0x857A6E, 0.0),
            (0.38, 0x6E645A, 0.0),
            (0.46, DARK, 0.0),
            (0.88, DARK, 0.0),
            (0.9, 0xF2F0EA, 0.0),
            (1.0, 0xF6F4F0, 0.0),
        ])),
        ..neck.clone()
    };
    let gorget = Template {
        name: "hummingbird_gorget",
        length_mm: 7.0,
        width_mm: 4.6,
        bend: 0.0,
        left: SCALE,
        right: SCALE,
        micro: Micro {
            pitch: [0.16; 2],
            angle: [36.0; 2],
            ramus: 14.0,
            spacing: [34.0; 2],
            barbule_angle: [40.0; 2],
            radius: [8.5, 8.0],
            shaft: [0.16, 0.1, 0.03],
            downy: 0.4,
        },
        fringe: 0.06,
        gaps: gaps(1, 0.01, 0.2, 74),
        albedo: both(stops(&[
            (0.0, 0xA09A94, 0.0),
            (0.3, 0x78706A, 0.0),
            (0.48, 0x4A423C, 0.0),
            (0.56, DARK, 0.0),
            (1.0, DARK, 0.0),
        ])),
        ..neck.clone()
    };
    vec![
        shimmer(&eye, "peacock_green"),
        shimmer(&speculum, "mallard_speculum"),
        shimmer(&neck, "pigeon_green"),
        shimmer(&gorget, "anna_gorget"),
    ]
}
