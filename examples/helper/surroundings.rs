//! Which twigs, leaves and shrubs of lichen stand around a perch in which scene. They keep to the borders of every shot's picture.

use super::{branch::axis, foliage::Growth, noise::Dice};
use bevy::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};

/// Where leaves turn their upper sides.
const SUNWARD: Vec3 = Vec3::new(0.35, 0.75, 0.8);

/// What grows around the perch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surroundings {
    /// Nothing.
    Bare,
    /// Twigs with leaves.
    Leaves,
    /// Dry twigs and a few old leaves.
    Dry,
    /// Dry twigs alone.
    Dead,
}

/// Twigs, and what light shines through.
pub struct Grown {
    /// Opaque.
    pub solid: Option<Mesh>,
    /// Thin.
    pub thin: Option<Mesh>,
}

/// Where a twig begins along the perch, in metres on one of two metres, and the offsets of its joints from there.
struct Course(f32, [Vec3; 3]);

const COURSES: [Course; 4] = [
    // Behind the left end, upwards: the far border of the front and the near one of the back.
    Course(
        -0.40,
        [
            Vec3::new(-0.03, 0.07, 0.012),
            Vec3::new(-0.075, 0.13, -0.004),
            Vec3::new(-0.085, 0.21, 0.012),
        ],
    ),
    Course(
        -0.47,
        [
            Vec3::new(-0.02, -0.045, 0.02),
            Vec3::new(-0.045, -0.10, 0.03),
            Vec3::new(-0.05, -0.15, 0.028),
        ],
    ),
    // From the right end, hanging: below the birds of the front, beside the tails of the side.
    Course(
        0.55,
        [
            Vec3::new(0.02, -0.03, -0.03),
            Vec3::new(0.06, -0.08, -0.07),
            Vec3::new(0.085, -0.13, -0.09),
        ],
    ),
    Course(
        0.66,
        [
            Vec3::new(0.03, 0.05, 0.0),
            Vec3::new(0.05, 0.11, 0.01),
            Vec3::new(0.09, 0.16, 0.03),
        ],
    ),
];

/// Everything around a perch of this radius and length that lies along x about the origin.
pub fn grow(what: Surroundings, radius: f32, length: f32) -> Grown {
    let (mut solid, mut thin) = (Growth::default(), Growth::default());
    let mut dice = Dice(11);
    if what == Surroundings::Bare {
        return Grown {
            solid: None,
            thin: None,
        };
    }
    // Shorter perches are for smaller birds, whose pictures end sooner.
    let spread = ((length - 1.1) / 1.1).clamp(0.3, 1.0);
    for (i, Course(x, joints)) in COURSES.iter().enumerate() {
        let foot = axis(spread * x, radius);
        let joints: Vec<Vec3> = [Vec3::ZERO]
            .iter()
            .chain(joints)
            .map(|joint| foot + *joint * (0.35 + 0.65 * spread))
            .collect();
        let thick = (0.14 * radius).clamp(0.0022, 0.0042);
        let bark = match what {
            Surroundings::Leaves => Vec3::new(0.085, 0.075, 0.040),
            _ => Vec3::new(0.17, 0.14, 0.11),
        };
        solid.twig(&joints, thick, bark);
        let size = 0.45 + 0.55 * spread;
        let leaves = match what {
            Surroundings::Leaves => 4,
            Surroundings::Dry => 2 - u32::from(i % 2 == 1),
            _ => 0,
        };
        let green = match what {
            Surroundings::Leaves => Vec3::new(0.070, 0.150, 0.026),
            _ => Vec3::new(0.17, 0.095, 0.035),
        };
        for k in 0..leaves {
            let at = (k + 2) as usize;
            let (a, b) = (joints[(at - 1).min(2)], joints[at.min(3)]);
            let foot = a.lerp(b, if k < 2 { 0.55 } else { 0.96 });
            leaf(
                &mut thin,
                foot,
                (b - a).normalize_or(Vec3::Y),
                k,
                size,
                green,
                &mut dice,
            );
        }
    }
    shrubs(&mut thin, radius, length, &mut dice);
    Grown {
        solid: solid.mesh(),
        thin: thin.mesh(),
    }
}

/// A leaf away from its twig, hanging by its own weight.
fn leaf(
    thin: &mut Growth,
    foot: Vec3,
    twig: Vec3,
    number: u32,
    size: f32,
    green: Vec3,
    dice: &mut Dice,
) {
    let turn = PI * number as f32 + FRAC_PI_2 * (dice.roll() - 0.5);
    let side = Quat::from_axis_angle(twig, turn) * twig.any_orthonormal_vector();
    let forward = (0.6 * twig + side - 0.45 * Vec3::Y).normalize_or(Vec3::NEG_Y);
    // Turned to the light, and so to who looks from there.
    let up = SUNWARD.reject_from(forward).normalize_or(Vec3::Z);
    let turned = Quat::from_mat3(&Mat3::from_cols(forward, up, forward.cross(up)));
    let place = Transform::from_translation(foot).with_rotation(turned);
    let tone = green * (0.75 + 0.6 * dice.roll());
    thin.leaf(place, size * (0.095 + 0.055 * dice.roll()), tone, dice);
}

/// Small shrubs of lichen on the upper side, clear of where feet stand.
fn shrubs(thin: &mut Growth, radius: f32, length: f32, dice: &mut Dice) {
    let pale = [Vec3::new(0.13, 0.14, 0.09), Vec3::new(0.33, 0.36, 0.27)];
    for _ in 0..26 {
        let side = if dice.roll() < 0.5 { -1.0 } else { 1.0 };
        let x = side * (0.24 + 0.25 * length * dice.roll());
        let angle = 2.6 * (dice.roll() - 0.5);
        let foot = axis(x, radius) + 0.9 * radius * Vec3::new(0.0, angle.cos(), angle.sin());
        thin.tuft(foot, [26.0, 1.3], [0.30 * radius, 0.0007], pale, dice);
    }
}
