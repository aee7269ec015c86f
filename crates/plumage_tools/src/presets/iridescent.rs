//! Feathers that shimmer: an eye of a peacock's train, a speculum feather of a mallard, neck and throat feathers of a pigeon and of
//! Anna's hummingbird. Their thin layers are those of `assets/stacks.ron` (docs/book/iridescence.md#presets); sizes are of ordinary
//! adults. Where a vane is painted dark its barbules carry the layers; pale parts have no melanin, and so none.

use super::profiles::*;
use super::template::*;
use bevy_plumage::anatomy::{Feather, Spline};
use bevy_plumage::maths::scattering::{Sheen, interference::ScaleMap};
use plumage_tests::shipped;

/// Melanin under the layers.
const DARK: u32 = 0x241E1A;

/// Long loose barbs on either side, round the eye a fan.
const EYE: Profile = Profile::new(
    &[
        (0.0, 0.5),
        (0.2, 0.8),
        (0.5, 0.98),
        (0.75, 1.0),
        (1.0, 0.92),
    ],
    0.7,
    (2.3, 2.0),
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

/// One zone of a peacock's eye: an ellipse about the shaft and the thickness of the layers inside.
struct Ring {
    /// Half axes across and along, mm.
    half: [f32; 2],
    /// Middle above that of the eye, mm.
    above: f32,
    /// Factor on the thickness.
    scale: f32,
}

const fn ring(half: [f32; 2], above: f32, scale: f32) -> Ring {
    Ring { half, above, scale }
}

/// From the outermost to the pupil; sizes of an eye of 45 mm, thicknesses so that the colors come out.
const RINGS: [Ring; 6] = [
    ring([34.0, 37.0], 4.0, 1.06),
    ring([30.5, 33.0], 4.0, 1.0),
    ring([27.0, 29.5], 3.5, 1.1),
    ring([24.5, 26.5], 3.0, 1.22),
    ring([15.0, 16.5], 0.5, 0.95),
    ring([9.5, 10.5], -1.5, 0.845),
];
/// Beyond all rings.
const LOOSE: f32 = 1.08;
/// Height, in lengths, up to which the barbules do not hook.
const LOOSE_BELOW: f32 = 0.56;
/// Over this distance one zone becomes the next, mm.
const SOFT_EDGE: f32 = 2.6;
/// Depth and width of the pupil's notch on the side of the shaft's root, as shares of its half axes.
const NOTCH: [f32; 2] = [0.7, 0.45];
/// Middle of the eye below the tip, mm.
const EYE_BELOW_TIP: f32 = 45.0;

/// Thickness of the layers at a point, mm from the middle of the eye.
fn eye_scale(x: f32, y: f32) -> f32 {
    RINGS.iter().enumerate().fold(LOOSE, |scale, (i, ring)| {
        let place = [x / ring.half[0], (y - ring.above) / ring.half[1]];
        let mut r = place[0].hypot(place[1]);
        if i + 1 == RINGS.len() && place[1] < 0.0 {
            r += NOTCH[0] * (-(place[0] / NOTCH[1]).powi(2)).exp();
        }
        let inside = (0.5 - (r - 1.0) * ring.half[0] / SOFT_EDGE).clamp(0.0, 1.0);
        scale + (ring.scale - scale) * inside
    })
}

/// The rings over the card of a feather.
fn eye_rings(feather: &Feather) -> ScaleMap {
    let [columns, rows] = [35, 51];
    let shaft = Spline::new(&feather.rachis.curve);
    let factor = |i: usize| {
        let u = (i % columns) as f32 / (columns - 1) as f32;
        let v = (i / columns) as f32 / (rows - 1) as f32;
        let x = (u - shaft.at(f64::from(v)).0 as f32) * feather.aspect * feather.length_mm;
        let y = v * feather.length_mm - (feather.length_mm - EYE_BELOW_TIP);
        (eye_scale(x, y) * 1000.0).round() / 1000.0
    };
    ScaleMap {
        columns: columns as u32,
        factors: (0..columns * rows).map(factor).collect(),
    }
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
            cover: HOOKED,
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
        matte: false,
    };
    let eye = Template {
        name: "peacock_eye",
        length_mm: 170.0,
        width_mm: 92.0,
        bend: 0.02,
        start: 0.02,
        left: EYE,
        right: EYE,
        micro: Micro {
            pitch: [1.7; 2],
            angle: [40.0; 2],
            ramus: 110.0,
            spacing: [40.0, 42.0],
            barbule_angle: [52.0, 50.0],
            cover: [0.66, 0.63],
            shaft: [1.8, 0.8, 0.12],
            downy: 0.0,
        },
        fringe: 0.45,
        gaps: gaps(64, 0.008, 0.72, 72),
        albedo: both(stops(&[(0.0, DARK, 0.0), (1.0, DARK, 0.0)])),
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
            cover: HOOKED,
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
            cover: [0.78, 0.75],
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
    let mut eye = shimmer(&eye, "peacock_green");
    // Below the eye nothing hooks.
    for vane in [&mut eye.left, &mut eye.right] {
        vane.downy = LOOSE_BELOW;
    }
    eye.iridescence_scale = Some(eye_rings(&eye));
    vec![
        eye,
        shimmer(&speculum, "mallard_speculum"),
        shimmer(&neck, "pigeon_green"),
        shimmer(&gorget, "anna_gorget"),
    ]
}
