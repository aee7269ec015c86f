//! Draws what the ways of transparency cost: error against exact sorted compositing, over time and memory.
//! `docs/charts/transparency.svg` and `.csv`.

use bevy::{
    core_pipeline::oit::OrderIndependentTransparencySettings, prelude::*,
    render::renderer::RenderAdapterInfo,
};
use bevy_plumage::prelude::*;
use plotters::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage},
    stack::Stack,
    view::rms,
};
use std::{error::Error, path::Path, time::Instant};

/// Feathers one behind the other.
const FEATHERS: usize = 12;
/// Frames timed, the fastest of which counts.
const FRAMES: u32 = 12;

struct Measured {
    name: &'static str,
    milliseconds: f64,
    /// Bytes per pixel of the picture beyond an HDR target and a depth buffer of one sample.
    bytes: f64,
    rms: f32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut stage = Stage::new().ok_or("no graphics adapter")?;
    let mut stack = Stack::new(&mut stage, FEATHERS);
    let exact = stack.draw(&mut stage, Msaa::Off, FeatherTransparency::Blend, true);
    // An HDR sample has 8 bytes, its depth 4; a node of the list 12, its head 4.
    let (sample, node, head) = (12.0, 12.0, 4.0);
    let ways = [
        (
            "alpha to coverage, MSAA 4",
            Msaa::Sample4,
            FeatherTransparency::AlphaToCoverage,
            None,
            4.0 * sample,
        ),
        ("hashed", Msaa::Off, FeatherTransparency::Hashed, None, 0.0),
        (
            "hashed, MSAA 4",
            Msaa::Sample4,
            FeatherTransparency::Hashed,
            None,
            4.0 * sample,
        ),
        (
            "order independent, 8 sorted",
            Msaa::Off,
            FeatherTransparency::OrderIndependent,
            Some((8, 4.0)),
            4.0 * node + head,
        ),
        (
            "order independent, 16 sorted",
            Msaa::Off,
            FeatherTransparency::OrderIndependent,
            Some((16, 8.0)),
            8.0 * node + head,
        ),
        (
            "blend, unsorted",
            Msaa::Off,
            FeatherTransparency::Blend,
            None,
            0.0,
        ),
    ];
    let mut all = Vec::new();
    for (name, msaa, way, list, bytes) in ways {
        let camera = stage.camera;
        let mut entity = stage.app.world_mut().entity_mut(camera);
        entity.remove::<OrderIndependentTransparencySettings>();
        entity.insert(msaa);
        if let Some((sorted, average)) = list {
            entity.insert(OrderIndependentTransparencySettings {
                sorted_fragment_max_count: sorted,
                fragments_per_pixel_average: average,
                ..default()
            });
        }
        let picture = stack.draw(&mut stage, msaa, way, false);
        let mut milliseconds = f64::INFINITY;
        for _ in 0..FRAMES {
            let start = Instant::now();
            stage.frame();
            milliseconds = milliseconds.min(start.elapsed().as_secs_f64() * 1e3);
        }
        all.push(Measured {
            name,
            milliseconds,
            bytes,
            rms: rms(&picture, &exact),
        });
    }
    let adapter = stage
        .app
        .world()
        .resource::<RenderAdapterInfo>()
        .name
        .clone();
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("docs/charts");
    write_table(&folder.join("transparency.csv"), &all)?;
    draw(&folder.join("transparency.svg"), &all, &adapter)?;
    // Leaves without tearing the app down: nothing is left to save.
    std::process::exit(0);
}

/// Time relative to alpha to coverage.
fn relative(all: &[Measured], one: &Measured) -> f64 {
    one.milliseconds / all[0].milliseconds
}

fn write_table(path: &Path, all: &[Measured]) -> Result<(), Box<dyn Error>> {
    let mut text =
        String::from("way,rms error,frame time over alpha to coverage,extra bytes a pixel\n");
    for one in all {
        let line = format!(
            "\"{}\",{:.4},{:.2},{}\n",
            one.name,
            one.rms,
            relative(all, one),
            one.bytes
        );
        print!("{line}");
        text += &line;
    }
    Ok(std::fs::write(path, text)?)
}

fn draw(path: &Path, all: &[Measured], adapter: &str) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (960, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!("{FEATHERS} feathers behind each other, {SIZE} x {SIZE} pixels, {adapter}");
    let root = root.titled(&title, ("sans-serif", 17))?;
    let halves = root.split_evenly((1, 2));
    let largest = all.iter().map(|one| f64::from(one.rms)).fold(0.0, f64::max) * 1.15;
    for (area, label, value) in [
        (&halves[0], "frame time / alpha to coverage", 0),
        (&halves[1], "extra bytes a pixel", 1),
    ] {
        let at = |one: &Measured| {
            if value == 0 {
                relative(all, one)
            } else {
                one.bytes
            }
        };
        let most = all.iter().map(at).fold(0.0, f64::max) * 1.7;
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(52)
            .build_cartesian_2d(0.0..most, 0.0..largest)?;
        chart
            .configure_mesh()
            .x_desc(label)
            .y_desc("RMS error of linear color")
            .draw()?;
        for (i, one) in all.iter().enumerate() {
            let place = (at(one), f64::from(one.rms));
            let (r, g, b) = Palette99::COLORS[i % Palette99::COLORS.len()];
            let color = RGBColor(r, g, b);
            chart.draw_series([plotters::element::Circle::new(
                place,
                5,
                ShapeStyle::from(&color).filled(),
            )])?;
            let style = ("sans-serif", 12).into_font().color(&color);
            chart.draw_series([Text::new(
                one.name,
                (place.0 + 0.02 * most, place.1 + 0.012 * largest),
                style,
            )])?;
        }
    }
    root.present()?;
    Ok(())
}
