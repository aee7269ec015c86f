//! Mean errors over one setting of the photograph or of the extraction at a time.

use super::{TARGETS, over_target};
use bevy_plumage::anatomy::Feather;
use bevy_plumage::photo::ExtractSettings;
use plumage_reference::photograph::{Background, Setting};
use plumage_tests::photographs::{Case, Report, run, settings};
use plumage_tools::{
    plot::{Curve, Labels, Result, draw},
    presets,
};
use rayon::prelude::*;
use std::{fmt::Write as _, fs, path::Path};

/// Feathers of the sweeps: flight, tail, covert and body feathers, plain and barred.
const SWEPT: [&str; 10] = [
    "macaw_primary",
    "macaw_contour",
    "macaw_greater",
    "eagle_primary",
    "eagle_secondary",
    "eagle_contour",
    "eagle_rectrix",
    "rectrix",
    "median_covert",
    "contour",
];

/// One sweep: file name, title, axis, its values, and what a value does to the setting and to the extraction.
struct Sweep {
    name: &'static str,
    axis: &'static str,
    values: Vec<f64>,
    apply: fn(f64, &mut Setting, &mut ExtractSettings),
}

/// Every sweep: a chart each, and one table.
pub fn sweeps(folder: &Path) -> Result<()> {
    let sweeps = [
        Sweep {
            name: "resolution",
            axis: "height of the picture, pixels",
            values: vec![200.0, 280.0, 400.0, 560.0, 800.0, 1120.0, 1600.0],
            apply: |value, setting, _| setting.size = [(value / 1.5) as u32, value as u32],
        },
        Sweep {
            name: "noise",
            axis: "standard deviation of the noise, sRGB",
            values: vec![0.0, 0.01, 0.02, 0.03, 0.045, 0.06, 0.08],
            apply: |value, setting, _| setting.noise = value as f32,
        },
        Sweep {
            name: "contrast",
            axis: "contrast of the feather's color and a grey background, Oklab",
            values: vec![0.02, 0.04, 0.07, 0.10, 0.14, 0.2, 0.3],
            // The colors are set below: they depend on the feather.
            apply: |_, _, _| (),
        },
        Sweep {
            name: "rotation",
            axis: "direction of the tip, degrees clockwise",
            values: (0..12).map(|i| f64::from(i) * 30.0).collect(),
            apply: |value, setting, _| {
                setting.rotation = value.to_radians();
                setting.size = [800, 800];
            },
        },
        Sweep {
            name: "time",
            axis: "mean seconds for a picture",
            values: vec![256.0, 384.0, 512.0, 768.0, 1200.0, 1800.0],
            apply: |value, setting, settings| {
                setting.size = [1200, 1800];
                settings.resolution = value as u32;
            },
        },
    ];
    let mut text =
        String::from("sweep,value,dice,asset dice,rachis,albedo,angle,edges,seconds,refused\n");
    for sweep in &sweeps {
        let mut curves: Vec<Curve> = TARGETS
            .iter()
            .map(|(name, _)| ((*name).to_owned(), Vec::new()))
            .collect();
        for &value in &sweep.values {
            let cases = swept(sweep, value);
            let report = Report::of(&cases);
            writeln!(
                text,
                "{},{value},{:.4},{:.4},{:.5},{:.4},{:.2},{:.2},{:.3},{}",
                sweep.name,
                report.dice.mean,
                report.asset.mean,
                report.rachis.mean,
                report.albedo.mean,
                report.angle.mean,
                report.edges.mean,
                report.seconds.mean,
                report.refused
            )?;
            let x = if sweep.name == "time" {
                report.seconds.mean
            } else {
                value
            };
            for (measure, (_, points)) in curves.iter_mut().enumerate() {
                let errors: Vec<f64> = cases
                    .iter()
                    .flat_map(|case| over_target(case, measure))
                    .collect();
                if !errors.is_empty() {
                    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
                    points.push((x, mean.min(4.0)));
                }
            }
        }
        draw(
            &folder.join(format!("extract_{}.svg", sweep.name)),
            &Labels {
                title: &format!("Extraction: mean error over {}", sweep.name),
                x: sweep.axis,
                y: "error over its target (1 = target; cut at 4)",
            },
            [false, false],
            &curves,
        )?;
    }
    fs::write(folder.join("extract_sweeps.csv"), text)?;
    Ok(())
}

/// The feathers of the sweeps at one value, on a grey background unless the sweep says otherwise.
fn swept(sweep: &Sweep, value: f64) -> Vec<Case> {
    // Two threads fight for the cores and for the cache: what is timed runs alone.
    let one = |(i, name): (usize, &&str)| {
        let feather = presets::by_name(name)?;
        let mut setting = Setting {
            background: Background::Grey,
            rotation: 0.1,
            seed: 100 + i as u64,
            ..Setting::default()
        };
        clear(&feather, &mut setting);
        if sweep.name == "contrast" {
            contrast(&feather, value as f32, &mut setting);
        }
        let mut options = settings(&feather, &setting);
        (sweep.apply)(value, &mut setting, &mut options);
        Some(run(i as u64, &feather, &setting, &options))
    };
    if sweep.name == "time" {
        SWEPT.iter().enumerate().filter_map(one).collect()
    } else {
        SWEPT.par_iter().enumerate().filter_map(one).collect()
    }
}

/// The grey from which the feather stands out best.
fn clear(feather: &Feather, setting: &mut Setting) {
    let mut best = (0.0, 0.5);
    for i in 1..20 {
        let grey = i as f32 * 0.05;
        setting.ground = [grey; 3];
        let contrast = setting.contrast(feather);
        if contrast > best.0 {
            best = (contrast, grey);
        }
    }
    setting.ground = [best.1; 3];
}

/// The grey whose contrast is nearest to `wanted`.
fn contrast(feather: &Feather, wanted: f32, setting: &mut Setting) {
    let mut best = (f32::INFINITY, 0.5);
    for i in 1..200 {
        let grey = i as f32 * 0.005;
        setting.ground = [grey; 3];
        let off = (setting.contrast(feather) - wanted).abs();
        if off < best.0 {
            best = (off, grey);
        }
    }
    setting.ground = [best.1; 3];
}
