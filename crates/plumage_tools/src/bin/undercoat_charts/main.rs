//! Charts of the marched undercoat, an SVG and its numbers as CSV each: steps of the march, models of the light, tiers, the walk through
//! the shell; error against dense references over processor time of the same run.
//!
//! `CARGO_PROFILE_DEV_OPT_LEVEL=3 cargo run -p plumage_tools --bin undercoat_charts [folder]` (default `docs/charts`)

use plumage_tools::plot;
mod walk;

use bevy_plumage::maths::undercoat::Density;
use bevy_plumage::maths::undercoat::density::{DownShape, TILE_SIZE, down_tile};
use bevy_plumage::maths::undercoat::march::DEPTH_CLIP;
use bevy_plumage::maths::undercoat::slab::{
    Coat, LightModel, SlabRay, SlabSettings, slab_radiance,
};
use plumage_reference::undercoat::reference::{Lit, Medium};
use plumage_tools::plot::{Curve, Labels, Result};
use std::{env, fs, path::Path, time::Instant};

const PIXELS: usize = 256;

/// A coat with its references.
pub struct Scene {
    density: Density,
    medium: Medium,
    lights: Vec<([f64; 3], Lit)>,
}

/// White fibres over a black skin: what is drawn is single scattering times 1/4.
const COAT: Coat<f64> = Coat {
    albedo: [1.0; 3],
    skin: [0.0; 3],
};

impl Scene {
    fn new() -> Option<Self> {
        let tile = down_tile(&DownShape::default(), TILE_SIZE, 2.0, 4.0)?;
        let medium = Medium::new(&tile);
        let lights = [30.0, 65.0f64].map(|angle| {
            let (s, c) = angle.to_radians().sin_cos();
            let light = [0.6 * s, 0.8 * s, c];
            (light, medium.lit(light))
        });
        Some(Self {
            density: Density::new(&tile),
            medium,
            lights: lights.into(),
        })
    }

    fn pixel(i: usize) -> [f64; 2] {
        [
            i as f64 / PIXELS as f64,
            (i as f64 * 0.618_033_988_749_895).fract(),
        ]
    }

    /// Root mean square error of a pixel over the mean, bias over the mean, and microseconds a ray.
    fn measure(&self, angle: f64, light: usize, settings: &SlabSettings<f64>) -> [f64; 3] {
        let (s, c) = angle.to_radians().sin_cos();
        let eye = [s, 0.0, c];
        let (direction, lit) = &self.lights[light];
        let ray = |i| SlabRay {
            place: Self::pixel(i),
            eye,
            light: *direction,
        };
        // The least of five: others use the processor too.
        let mut time = f64::MAX;
        let mut found = Vec::new();
        for _ in 0..5 {
            let start = Instant::now();
            found = (0..PIXELS)
                .map(|i| 4.0 * slab_radiance(&self.density, &COAT, &ray(i), settings)[0])
                .collect::<Vec<_>>();
            time = time.min(start.elapsed().as_secs_f64() * 1e6 / PIXELS as f64);
        }
        let (mut square, mut off, mut mean) = (0.0, 0.0, 0.0);
        for (i, found) in found.iter().enumerate() {
            let truth = self.medium.radiance(Self::pixel(i), eye, lit, 1024).0;
            square += (found - truth) * (found - truth);
            off += found - truth;
            mean += truth;
        }
        let n = PIXELS as f64;
        [(square / n).sqrt() / (mean / n), off / mean, time]
    }
}

fn settings(steps: f64, light: LightModel) -> SlabSettings<f64> {
    SlabSettings {
        steps,
        light,
        multiple: false,
        ..SlabSettings::near()
    }
}

const COUNTS: [f64; 6] = [4.0, 8.0, 16.0, 24.0, 32.0, 64.0];

/// Steps of the march, clipped and not, with 16 light steps so that the light is nearly exact.
fn steps(folder: &Path, scene: &Scene) -> Result<()> {
    for (name, clip) in [("clipped", DEPTH_CLIP), ("uniform", 1e9)] {
        let curves = [0.0, 45.0, 70.0, 82.0].map(|angle| -> Curve {
            let points = COUNTS.map(|n| {
                let settings = SlabSettings {
                    clip,
                    ..settings(n, LightModel::Steps(16))
                };
                (n, scene.measure(angle, 0, &settings)[0])
            });
            (format!("{angle} degrees"), points.to_vec())
        });
        let title = format!("Steps of the march, {name}: error of a pixel over the mean");
        let labels = Labels {
            title: &title,
            x: "steps",
            y: "RMS error",
        };
        plot::draw(
            &folder.join(format!("down_steps_{name}.svg")),
            &labels,
            [true, true],
            &curves,
        )?;
    }
    Ok(())
}

/// Models of the light, 64 steps to the eye, over the time of a ray.
fn lights(folder: &Path, scene: &Scene) -> Result<()> {
    for (light, angle) in [(0, 30), (1, 65)] {
        let measure = |model| {
            // Mean over four views.
            let mut sum = [0.0; 2];
            for eye in [0.0, 45.0, 70.0, 82.0] {
                let [rms, _, time] = scene.measure(eye, light, &settings(64.0, model));
                sum = [sum[0] + 0.25 * time, sum[1] + 0.25 * rms];
            }
            (sum[0], sum[1])
        };
        let curves: Vec<Curve> = vec![
            ("none".into(), vec![measure(LightModel::Open)]),
            ("mean column".into(), vec![measure(LightModel::MeanColumn)]),
            (
                "2, 4, 8, 16 quadratic steps".into(),
                [2, 4, 8, 16].map(|n| measure(LightModel::Steps(n))).into(),
            ),
            (
                "1, 2, 4 near steps and mean column".into(),
                [1, 2, 4].map(|n| measure(LightModel::Near(n))).into(),
            ),
        ];
        let title = format!("Models of a light at {angle} degrees, mean of four views");
        let labels = Labels {
            title: &title,
            x: "microseconds a ray",
            y: "RMS error",
        };
        plot::draw(
            &folder.join(format!("down_light_{angle}.svg")),
            &labels,
            [true, true],
            &curves,
        )?;
    }
    Ok(())
}

/// The tiers, each at its own settings.
fn tiers(folder: &Path, scene: &Scene) -> Result<()> {
    let single = |s: SlabSettings<f64>| SlabSettings {
        multiple: false,
        ..s
    };
    let tiers = [
        (
            "near: 16 steps, 4 light steps",
            single(SlabSettings::near()),
        ),
        (
            "middle: 14 steps, level 1, mean column",
            single(SlabSettings::middle()),
        ),
        (
            "8 steps, level 1, mean column",
            SlabSettings {
                steps: 8.0,
                ..single(SlabSettings::middle())
            },
        ),
        (
            "8 steps, level 1, 2 light steps",
            SlabSettings {
                steps: 8.0,
                light: LightModel::Steps(2),
                ..single(SlabSettings::middle())
            },
        ),
        (
            "64 steps, 16 light steps",
            settings(64.0, LightModel::Steps(16)),
        ),
    ];
    let curves = tiers.map(|(name, settings)| -> Curve {
        let points = [0.0, 45.0, 70.0, 82.0].map(|angle| {
            let [rms, bias, time] = scene.measure(angle, 0, &settings);
            println!("{name}, {angle} degrees: RMS {rms:.3}, bias {bias:+.3}, {time:.1} us");
            (time, rms)
        });
        (name.into(), points.to_vec())
    });
    let labels = Labels {
        title: "Tiers at 0, 45, 70, 82 degrees, light at 30",
        x: "microseconds a ray",
        y: "RMS error",
    };
    plot::draw(
        &folder.join("down_tiers.svg"),
        &labels,
        [true, true],
        &curves,
    )
}

fn main() -> Result<()> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    println!("timed on {}", plot::processor());
    let scene = Scene::new().ok_or("the tile is not sound")?;
    steps(folder, &scene)?;
    lights(folder, &scene)?;
    tiers(folder, &scene)?;
    walk::chart(folder)
}
