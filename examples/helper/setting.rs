//! The scenes that `--scene` chooses from, as data: light, what is behind, perch, and how the film answers.

use super::{
    Args, args::Scene, backdrop::Backdrop, foreground::Blade, sky, surroundings::Surroundings,
};
use bevy::{core_pipeline::tonemapping::Tonemapping, prelude::*};

/// A sun-like lamp.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Direction towards it; its length does not matter.
    pub toward: Vec3,
    /// Illuminance, lux.
    pub lux: f32,
    /// Color, sRGB.
    pub color: [f32; 3],
}

/// One scene.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Setting {
    /// The light that models the subject.
    pub key: Lamp,
    /// Light from behind, which parts the subject from what is behind it.
    pub rim: Option<Lamp>,
    /// Radiance from a direction, relative units: what fills the shadows.
    pub radiance: fn(Vec3) -> Vec3,
    /// Luminance of radiance 1, cd/m²: as light, and as background where no backdrop is.
    pub fill: [f32; 2],
    /// What is behind; the sky when absent.
    pub backdrop: Option<Backdrop>,
    /// Exposure value at ISO 100.
    pub ev100: f32,
    /// Curve of the film.
    pub tone: Tonemapping,
    /// Factor on the saturation of what it shows.
    pub saturation: f32,
    /// The perch is a branch with bark; else a smooth cylinder.
    pub bark: bool,
    /// What grows around it.
    pub surroundings: Surroundings,
    /// What stands out of focus before the subject.
    pub blades: &'static [Blade],
    /// Shadow maps fit the subject; else they reach eight metres.
    pub fitted_shadows: bool,
    /// Radius of the lens, metres: what is out of focus when frames are accumulated.
    pub aperture: f32,
}

/// Radiance below the edge of a wood: leaves around, a wide gap above and before the subject.
fn wood(direction: Vec3) -> Vec3 {
    let leaf = Vec3::new(0.18, 0.22, 0.10).lerp(
        Vec3::new(0.34, 0.38, 0.22),
        (0.5 + 0.5 * direction.y).clamp(0.0, 1.0),
    );
    let ground = Vec3::new(0.15, 0.12, 0.08);
    let low = ((-0.2 - direction.y) / 0.5).clamp(0.0, 1.0);
    let gaps = [
        (
            Vec3::new(0.35, 0.85, 0.55),
            0.45,
            Vec3::new(1.75, 1.85, 1.95),
        ),
        (Vec3::new(-0.8, 0.45, -0.5), 0.25, Vec3::new(1.5, 1.5, 1.4)),
        (Vec3::new(1.0, 0.25, 0.2), 0.3, Vec3::new(0.95, 0.95, 0.92)),
    ];
    gaps.iter()
        .fold(leaf.lerp(ground, low), |sum, (toward, size, color)| {
            let d = direction.dot(toward.normalize());
            let t = ((d - (1.0 - size)) / (0.6 * size)).clamp(0.0, 1.0);
            sum + *color * t * t
        })
}

/// Radiance on a cliff: a veiled sky, brighter where the sun stands, and pale rock in the sun below.
fn cliff(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let base = if up >= 0.0 {
        Vec3::new(0.72, 0.75, 0.78).lerp(Vec3::new(0.42, 0.50, 0.60), up.powf(0.6))
    } else {
        Vec3::new(0.72, 0.75, 0.78).lerp(Vec3::new(0.62, 0.53, 0.42), (-3.0 * up).min(1.0))
    };
    let veil = direction.dot(Vec3::new(0.3, 0.55, 0.75).normalize());
    base + Vec3::new(0.9, 0.85, 0.75) * ((veil - 0.4) / 0.6).max(0.0).powi(2)
}

/// Radiance after sunset: blue above, a warm rim where the sun went, dark ground.
fn evening(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let base = if up >= 0.0 {
        Vec3::new(0.50, 0.47, 0.47).lerp(Vec3::new(0.28, 0.36, 0.52), up.powf(0.5))
    } else {
        Vec3::new(0.50, 0.47, 0.47).lerp(Vec3::new(0.14, 0.12, 0.10), (-3.0 * up).min(1.0))
    };
    let sun = direction.dot(Vec3::new(0.95, 0.2, 0.85).normalize());
    base + Vec3::new(1.3, 0.85, 0.5) * ((sun - 0.4) / 0.6).max(0.0).powi(2)
}

/// A leaf in the lower left corner.
const LEAF: [Blade; 1] = [Blade {
    ends: [Vec2::new(-0.74, -0.42), Vec2::new(-0.36, -0.33)],
    bend_width: Vec2::new(0.05, 0.085),
    blur: 0.035,
    colors: [
        Vec3::new(0.035, 0.085, 0.016),
        Vec3::new(0.075, 0.135, 0.028),
    ],
}];

/// A blade of straw from below.
const fn straw(foot: f32, tip: [f32; 2], bend: f32) -> Blade {
    Blade {
        ends: [Vec2::new(foot, -0.62), Vec2::from_array(tip)],
        bend_width: Vec2::new(bend, 0.009),
        blur: 0.026,
        colors: [Vec3::new(0.08, 0.075, 0.035), Vec3::new(0.21, 0.17, 0.09)],
    }
}

/// Straw along the lower border, at both sides.
const STRAW: [Blade; 8] = [
    straw(-0.66, [-0.52, -0.17], 0.02),
    straw(-0.60, [-0.62, -0.11], -0.02),
    straw(-0.56, [-0.43, -0.24], 0.03),
    straw(-0.63, [-0.70, -0.21], -0.03),
    straw(-0.52, [-0.47, -0.20], 0.01),
    straw(0.60, [0.53, -0.23], -0.02),
    straw(0.63, [0.70, -0.17], 0.02),
    straw(0.57, [0.60, -0.28], 0.0),
];

impl Setting {
    /// What the command line asks for; without a wish whole birds sit where they live, everything else is in the studio.
    pub fn chosen(args: &Args, example: &str) -> Self {
        let usual = match example {
            "parrot" => Scene::Forest,
            "eagle" => Scene::Cliff,
            "owl" => Scene::Dusk,
            _ => Scene::Studio,
        };
        if args.backlight {
            Self::backlit()
        } else {
            Self::of(args.scene.unwrap_or(usual))
        }
    }

    /// The scene of this name.
    fn of(scene: Scene) -> Self {
        match scene {
            Scene::Studio => Self::studio(),
            Scene::Forest => Self::forest(),
            Scene::Cliff => Self::ledge(),
            Scene::Dusk => Self::dusk(),
        }
    }

    /// One sun under an even sky: the light in which methods are compared.
    fn studio() -> Self {
        Self {
            key: Lamp {
                toward: Vec3::new(0.7, 1.9, 1.9),
                lux: 23_000.0,
                color: [1.0, 0.95, 0.87],
            },
            rim: None,
            radiance: sky::radiance,
            fill: [2100.0, 2600.0],
            backdrop: None,
            ev100: 11.4,
            tone: Tonemapping::AcesFitted,
            saturation: 1.0,
            bark: false,
            surroundings: Surroundings::Bare,
            blades: &[],
            fitted_shadows: false,
            aperture: 0.0,
        }
    }

    /// The studio, its sun behind the subject: it is evening, and the rim is brighter than the sky.
    fn backlit() -> Self {
        let studio = Self::studio();
        Self {
            key: Lamp {
                toward: Vec3::new(1.0, 0.9, -2.2),
                lux: 60_000.0,
                ..studio.key
            },
            fill: studio.fill.map(|luminance| 0.1 * luminance),
            ..studio
        }
    }

    /// A branch at the edge of a wood.
    fn forest() -> Self {
        Self {
            key: Lamp {
                toward: Vec3::new(0.6, 1.0, 0.75),
                lux: 24_000.0,
                color: [1.0, 0.93, 0.83],
            },
            rim: Some(Lamp {
                toward: Vec3::new(-0.14, 0.9, -1.1),
                lux: 15_000.0,
                color: [1.0, 0.95, 0.86],
            }),
            radiance: wood,
            fill: [1500.0, 1500.0],
            backdrop: Some(Backdrop {
                colors: [
                    Vec3::new(0.010, 0.022, 0.008),
                    Vec3::new(0.034, 0.064, 0.020),
                    Vec3::new(0.105, 0.150, 0.050),
                ],
                discs: (300, 0.42),
                gaps: true,
                ridges: 0,
            }),
            ev100: 11.6,
            tone: Tonemapping::KhronosPbrNeutral,
            saturation: 0.955,
            bark: true,
            surroundings: Surroundings::Leaves,
            blades: &LEAF,
            fitted_shadows: true,
            aperture: 0.006,
        }
    }

    /// A dead branch in the morning, hills behind and straw before it.
    fn ledge() -> Self {
        Self {
            key: Lamp {
                toward: Vec3::new(0.85, 0.70, 0.9),
                lux: 29_000.0,
                color: [1.0, 0.87, 0.70],
            },
            rim: Some(Lamp {
                toward: Vec3::new(-0.3, 0.9, -1.0),
                lux: 17_000.0,
                color: [1.0, 0.97, 0.92],
            }),
            radiance: cliff,
            fill: [1700.0, 1700.0],
            backdrop: Some(Backdrop {
                colors: [
                    Vec3::new(0.045, 0.047, 0.037),
                    Vec3::new(0.069, 0.083, 0.099),
                    Vec3::new(0.132, 0.115, 0.094),
                ],
                discs: (0, 0.0),
                gaps: false,
                ridges: 4,
            }),
            ev100: 11.25,
            tone: Tonemapping::KhronosPbrNeutral,
            saturation: 0.95,
            bark: true,
            surroundings: Surroundings::Dead,
            blades: &STRAW,
            fitted_shadows: true,
            aperture: 0.008,
        }
    }

    /// An old branch at dusk: the last light from the side, a blue sky above.
    fn dusk() -> Self {
        Self {
            key: Lamp {
                toward: Vec3::new(0.95, 0.55, 0.85),
                lux: 15_000.0,
                color: [1.0, 0.82, 0.60],
            },
            rim: Some(Lamp {
                toward: Vec3::new(-0.5, 0.8, -1.0),
                lux: 8_000.0,
                color: [0.78, 0.88, 1.0],
            }),
            radiance: evening,
            fill: [1500.0, 1500.0],
            backdrop: Some(Backdrop {
                colors: [
                    Vec3::new(0.044, 0.047, 0.056),
                    Vec3::new(0.074, 0.088, 0.122),
                    Vec3::new(0.168, 0.134, 0.114),
                ],
                discs: (60, 0.12),
                gaps: false,
                ridges: 3,
            }),
            ev100: 11.2,
            tone: Tonemapping::KhronosPbrNeutral,
            saturation: 0.98,
            bark: true,
            surroundings: Surroundings::Dry,
            blades: &[],
            fitted_shadows: true,
            aperture: 0.005,
        }
    }
}
