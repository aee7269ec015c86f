//! The scenes that `--scene` chooses from, as data: light, what is behind, perch, and how the film answers.

use super::{Args, args::Scene, backdrop::Backdrop, sky};
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

/// Radiance on a cliff: a veiled sky, brighter where the sun stands, and warm rock below.
fn cliff(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let base = if up >= 0.0 {
        Vec3::new(0.72, 0.75, 0.78).lerp(Vec3::new(0.42, 0.50, 0.60), up.powf(0.6))
    } else {
        Vec3::new(0.72, 0.75, 0.78).lerp(Vec3::new(0.32, 0.27, 0.21), (-3.0 * up).min(1.0))
    };
    let veil = direction.dot(Vec3::new(0.3, 0.55, 0.75).normalize());
    base + Vec3::new(0.9, 0.85, 0.75) * ((veil - 0.4) / 0.6).max(0.0).powi(2)
}

impl Setting {
    /// What the command line asks for; without a wish whole birds sit where they live, everything else is in the studio.
    pub fn chosen(args: &Args, example: &str) -> Self {
        let usual = match example {
            "parrot" | "owl" => Scene::Forest,
            "eagle" => Scene::Cliff,
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
            }),
            ev100: 11.6,
            tone: Tonemapping::KhronosPbrNeutral,
            saturation: 1.0,
            bark: true,
            fitted_shadows: true,
            aperture: 0.006,
        }
    }

    /// A dead branch before a misty cliff in the morning.
    fn ledge() -> Self {
        Self {
            key: Lamp {
                toward: Vec3::new(0.75, 0.85, 0.9),
                lux: 26_000.0,
                color: [1.0, 0.91, 0.79],
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
                    Vec3::new(0.075, 0.085, 0.090),
                    Vec3::new(0.130, 0.140, 0.145),
                    Vec3::new(0.210, 0.215, 0.210),
                ],
                discs: (60, 0.14),
                gaps: false,
            }),
            ev100: 11.25,
            tone: Tonemapping::KhronosPbrNeutral,
            saturation: 0.95,
            bark: true,
            fitted_shadows: true,
            aperture: 0.008,
        }
    }
}
