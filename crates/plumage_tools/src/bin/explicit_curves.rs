//! The plugin's picture of one feather beside the same feather with every fibre as a curve (Chen et al. 2026, Fig. 15).
//!
//! `cargo run -p plumage_tools --bin explicit_curves [folder]` (default `docs`) writes `curves.png` (rows: near, at the switch, far, oblique;
//! columns: plugin, curves, difference x 8) and `charts/curves_comparison.csv`, and prints both sides' memory.

use bevy_plumage::prelude::FeatherSettings;
use plumage_reference::curves::{CurveOptions, Curves, Field, Visibility};
use plumage_tests::curves::{
    Difference, Picture, Studio, View, distances, feather, lights, middle, references,
};
use std::{env, error::Error, fmt::Write, fs, path::Path, time::Instant};

/// Side of the pictures.
const SIZE: u32 = 128;
/// What a shade of grey in the third column stands for, relative to the range.
const GAIN: f64 = 8.0;
/// Feather of the comparison: a small covert, so that its fibres fit into memory many times over.
const FEATHER: &str = "macaw_lesser";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder.join("charts"))?;
    let feather = feather(FEATHER);
    let start = Instant::now();
    let curves = Curves::build(&feather);
    let built = start.elapsed().as_secs_f64();
    let settings = FeatherSettings {
        multiple_scattering: 0.0,
        shelter: 0.0,
        ..FeatherSettings::default()
    };
    let Some(mut studio) = Studio::new(feather.clone(), SIZE, settings) else {
        return Ok(());
    };

    let mut csv = String::from("distance,light,reference,rmse,rmse_of_mean,rmse_of_range,bias\n");
    let mut rows: Vec<[Picture; 3]> = Vec::new();
    for (distance, place) in distances(&feather, SIZE) {
        for (number, (light, towards)) in lights().into_iter().enumerate() {
            let view = View {
                light: towards,
                ..place
            };
            let shown = studio.picture(&view);
            for (name, options) in kinds() {
                if number > 0 && options.field == Field::Near {
                    continue;
                }
                let samples = if options == CurveOptions::default() {
                    8
                } else {
                    4
                };
                let truth = references(&feather, &curves, &view, options, samples);
                let d = Difference::of(&shown, &truth);
                writeln!(
                    csv,
                    "{distance},{light},{name},{:.6},{:.4},{:.4},{:+.4}",
                    d.rmse,
                    d.of_mean(),
                    d.of_range(),
                    d.bias
                )?;
                println!(
                    "{distance:8} {light:8} {name:18} RMSE {:.5} = {:5.2} % of the mean, {:5.2} % of the range, bias {:+.2} %",
                    d.rmse,
                    100.0 * d.of_mean(),
                    100.0 * d.of_range(),
                    100.0 * d.bias
                );
                if number == 0 && options == CurveOptions::default() {
                    let gain = GAIN / d.range.max(1e-9);
                    rows.push(pictures(&shown, &middle(&truth), d.range, gain));
                }
            }
        }
    }
    fs::write(folder.join("charts/curves_comparison.csv"), csv)?;
    save(&folder.join("curves.png"), &rows)?;

    let [barbs, barbules] = curves.counts();
    println!(
        "{FEATHER}: {barbs} barbs and {barbules} barbules, {:.1} MB as they lie here, {:.1} MB as plain curves (enumerated in {built:.2} s); the plugin: {:.1} kB with card, tables and albedo",
        curves.bytes() as f64 * 1e-6,
        curves.curve_bytes() as f64 * 1e-6,
        studio.bytes() as f64 * 1e-3,
    );
    let primary = plumage_tests::curves::feather("macaw_primary");
    let many = Curves::build(&primary);
    let [barbs, barbules] = many.counts();
    println!(
        "macaw_primary: {barbs} barbs and {barbules} barbules, {:.1} MB as they lie here, {:.1} MB as plain curves; the plugin: the same as above",
        many.bytes() as f64 * 1e-6,
        many.curve_bytes() as f64 * 1e-6,
    );
    // Nothing is left to save; the renderer need not be torn down.
    std::process::exit(0)
}

fn kinds() -> [(&'static str, CurveOptions); 3] {
    let plain = CurveOptions::default();
    [
        ("estimated shadows", plain),
        (
            "traced shadows",
            CurveOptions {
                visibility: Visibility::Traced,
                ..plain
            },
        ),
        (
            "near field",
            CurveOptions {
                field: Field::Near,
                ..plain
            },
        ),
    ]
}

/// Plugin, reference, their difference, scaled for showing.
fn pictures(shown: &Picture, truth: &Picture, range: f64, gain: f64) -> [Picture; 3] {
    let scale = 0.7 / range.max(1e-9);
    let bright = |p: &Picture| p.iter().map(|c| c.map(|x| x * scale)).collect();
    let difference = shown
        .iter()
        .zip(truth)
        .map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]).abs() * gain))
        .collect();
    [bright(shown), bright(truth), difference]
}

fn encoded(x: f64) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let s = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    (s * 255.0).round() as u8
}

/// All rows in one picture, each pixel doubled.
fn save(path: &Path, rows: &[[Picture; 3]]) -> Result<(), Box<dyn Error>> {
    const ZOOM: u32 = 2;
    const GAP: u32 = 4;
    let side = SIZE * ZOOM;
    let mut picture = image::RgbImage::from_pixel(
        3 * side + 2 * GAP,
        rows.len() as u32 * (side + GAP) - GAP,
        image::Rgb([90; 3]),
    );
    for (r, row) in rows.iter().enumerate() {
        for (c, cell) in row.iter().enumerate() {
            for y in 0..side {
                for x in 0..side {
                    let from = cell[(y / ZOOM * SIZE + x / ZOOM) as usize];
                    let at = (c as u32 * (side + GAP) + x, r as u32 * (side + GAP) + y);
                    picture.put_pixel(at.0, at.1, image::Rgb(from.map(encoded)));
                }
            }
        }
    }
    picture.save(path)?;
    println!("{}", path.display());
    Ok(())
}
