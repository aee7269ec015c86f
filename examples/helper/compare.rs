//! The same picture by every way to find coverage, in one run: what each costs, and how far it is from point supersampling.
//!
//! Only the coverage differs: cards, light, sheen and the order of the layers are the same, so the truth is the picture whose
//! footprints are answered by thousands of point queries each.

use super::headless::{capture, frame};
use bevy::{diagnostic::DiagnosticsStore, prelude::*, render::renderer::RenderAdapterInfo};
use bevy_plumage::{CoverageMethod, prelude::*};
use serde_json::{Value, json};
use std::path::Path;

const METHODS: [(&str, CoverageMethod); 3] = [
    ("supersampled", CoverageMethod::Supersampled),
    ("chosen", CoverageMethod::Chosen),
    ("published", CoverageMethod::Published),
];
/// Rounds of timed frames, the methods interleaved; the fastest counts.
const ROUNDS: usize = 1;
/// Frames until a timestamp has come back from the GPU.
const LAG: usize = 3;

fn choose(app: &mut App, method: CoverageMethod) {
    let mut qualities = app.world_mut().query::<&mut FeatherQuality>();
    for mut quality in qualities.iter_mut(app.world_mut()) {
        quality.settings.coverage_method = method;
    }
}

/// Milliseconds that the GPU spent in the pass with the feathers, of the last frame that has come back.
fn pass_ms(app: &App) -> Option<f64> {
    let store = app.world().resource::<DiagnosticsStore>();
    let path = "render/main_opaque_pass_3d/elapsed_gpu";
    store.iter().find(|d| d.path().as_str() == path)?.value()
}

/// Root mean square difference of two pictures, of 255 steps.
fn rmse(a: &[u8], b: &[u8]) -> f64 {
    let sum: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
        .sum();
    (sum / a.len().max(1) as f64).sqrt()
}

/// Renders, prints and writes the comparison; pictures go beside `file`, named after the methods.
pub fn run(app: &mut App, image: &Handle<Image>, file: &Path) -> Result<(), String> {
    let mut pictures = Vec::new();
    for (name, method) in METHODS {
        choose(app, method);
        frame(app);
        let picture = capture(app, image.clone())?.to_rgb8();
        let path = file.with_extension(format!("{name}.png"));
        picture
            .save(&path)
            .map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{}", path.display());
        pictures.push(picture.into_raw());
    }
    let mut best = [[f64::INFINITY; 2]; METHODS.len()];
    for _ in 0..ROUNDS {
        // The truth is not timed.
        for (slot, (_, method)) in best.iter_mut().zip(METHODS).skip(1) {
            choose(app, method);
            frame(app);
            for _ in 0..LAG {
                slot[0] = slot[0].min(frame(app).as_secs_f64() * 1e3);
            }
            slot[1] = slot[1].min(pass_ms(app).unwrap_or(f64::INFINITY));
        }
    }
    let adapter = app.world().resource::<RenderAdapterInfo>().name.clone();
    let rows: Vec<Value> = METHODS
        .iter()
        .zip(&best)
        .zip(&pictures)
        .skip(1)
        .map(|(((name, _), ms), picture)| {
            json!({
                "method": name,
                "frame_ms": ms[0],
                "pass_ms": ms[1].is_finite().then_some(ms[1]),
                "rmse": rmse(picture, &pictures[0]),
            })
        })
        .collect();
    let [_, ours, theirs] = best;
    let report = json!({
        "adapter": adapter,
        "methods": rows,
        "chosen_over_published_frame": ours[0] / theirs[0],
        "chosen_over_published_pass": ours[1] / theirs[1],
    });
    println!("{report:#}");
    std::fs::write(file, format!("{report:#}\n")).map_err(|e| format!("{}: {e}", file.display()))
}
