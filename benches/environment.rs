//! Time of one feather that fills a third of a 1920 x 1080 picture, under an environment map: prefiltered, and with samples.
#![allow(missing_docs)]

use bevy::{diagnostic::DiagnosticsStore, prelude::*};
use bevy_plumage::prelude::*;
use plumage_tests::{app::Stage, feather_card as feather, gpu};
use std::time::{Duration, Instant};

fn main() {
    // `cargo test --benches` asks for a quick look only.
    let size = if std::env::args().any(|a| a == "--bench") {
        (1920, 1080)
    } else {
        (96, 54)
    };
    let Some(mut stage) = Stage::sized(size.0, size.1) else {
        return;
    };
    let name = gpu::adapter_name().unwrap_or("no adapter");
    // Software needs seconds a frame: fewer of everything. The median counts.
    let software = name.contains("(Cpu)");
    let frames = if software { 1 } else { 9 };
    let settings: &[u32] = if software { &[0, 16] } else { &[0, 4, 16, 64] };
    let card = feather::spawn_filling(&mut stage, "feathers/macaw_contour.feather.ron");
    stage.settle();
    let mut first = None;
    for &samples in settings {
        if let Some(mut quality) = stage.app.world_mut().get_mut::<FeatherQuality>(card) {
            quality.settings.environment_samples = samples;
        }
        for _ in 0..2 {
            stage.frame();
        }
        let mut times: Vec<Duration> = (0..frames)
            .map(|_| {
                let start = Instant::now();
                stage.frame();
                start.elapsed()
            })
            .collect();
        times.sort_unstable();
        let frame = times[frames / 2].as_secs_f64() * 1e3;
        // The diagnostics lag a few frames behind: of no use with one frame.
        let pass = pass_time(&stage).filter(|_| !software);
        let base = *first.get_or_insert(frame);
        println!(
            "{name}: {} x {}, {} % covered, {samples} environment samples: frame {frame:.2} ms ({:.2} of prefiltered), \
             feather pass {} on the GPU",
            size.0,
            size.1,
            (100.0 * feather::covered_share(&stage.picture())).round(),
            frame / base,
            pass.map_or("not measured".into(), |ms| format!("{ms:.2} ms")),
        );
    }
}

/// Latest GPU time of the transparent pass, milliseconds.
fn pass_time(stage: &Stage) -> Option<f64> {
    stage
        .app
        .world()
        .resource::<DiagnosticsStore>()
        .iter()
        .find(|d| {
            let path = d.path().as_str();
            path.contains("transparent_pass_3d") && path.ends_with("elapsed_gpu")
        })?
        .value()
}
