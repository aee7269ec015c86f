//! How good the extraction is, on synthetic photographs with known truth: tables, `extract_*.svg` and `extract_*.csv`.
//!
//! `cargo run --features extract --example extract_charts [folder] [photographs]` (default `docs/charts`, 520; the least is 39).
//! `--photograph PRESET FILE` writes one of them. The picture of 12 megapixels is extracted by a process of its own, whose time and memory are printed.

#[path = "../tests/extract_common/mod.rs"]
mod extract_common;

use bevy_plumage::{
    anatomy::{Feather, presets},
    extract::{
        ExtractSettings, extract, load_photograph,
        photograph::{Background, Photograph, Setting},
    },
};
use extract_common::{Case, Report, random_case, run, settings};
use plotters::prelude::*;
use rayon::prelude::*;
use std::{
    env,
    error::Error,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const COLOURS: [RGBColor; 5] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(120, 120, 120),
];

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

/// What is to be reached, and the errors are drawn over: 1 - Dice, shaft, albedo, barb angle, pattern edges.
const TARGETS: [(&str, f64); 5] = [
    ("1 - Dice of the mask, over 0.015", 0.015),
    ("rachis distance over 0.003", 0.003),
    ("albedo RMS over 0.03", 0.03),
    ("barb angle over 4 degrees", 4.0),
    ("pattern edges over 2 pixels", 2.0),
];

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [flag, file] = arguments.as_slice()
        && flag == "--extract"
    {
        return extract_alone(Path::new(file));
    }
    if let [flag, name, file] = arguments.as_slice()
        && flag == "--photograph"
    {
        return photograph(name, Path::new(file));
    }
    let folder = PathBuf::from(arguments.first().map_or("docs/charts", String::as_str));
    let count = arguments.get(1).map_or(Ok(520), |text| text.parse())?;
    fs::create_dir_all(&folder)?;
    corpus(&folder, count)?;
    sweeps(&folder)?;
    large(&folder)
}

/// The photographs over the whole range.
fn corpus(folder: &Path, count: u64) -> Result<()> {
    let start = Instant::now();
    let mut cases: Vec<Case> = (0..count.max(39))
        .into_par_iter()
        .map(|index| {
            let (feather, setting) = random_case(index);
            run(index, &feather, &setting, &settings(&feather, &setting))
        })
        .collect();
    println!(
        "{} photographs in {:.0} s on {} threads",
        cases.len(),
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads()
    );
    Report::of(&cases).print();
    println!("\n| background | photographs | Dice | rachis | albedo |");
    println!("|---|---|---|---|---|");
    for background in Background::ALL {
        let part: Vec<Case> = cases
            .iter()
            .filter(|case| case.setting.background == background)
            .cloned()
            .collect();
        line(&format!("{background:?}"), &part);
    }
    println!("\n| feather | photographs | Dice | rachis | albedo |");
    println!("|---|---|---|---|---|");
    for feather in presets::all() {
        let part: Vec<Case> = cases
            .iter()
            .filter(|case| case.name == feather.name)
            .cloned()
            .collect();
        line(&feather.name, &part);
    }
    let mut text = String::from(
        "seed,feather,width,height,background,contrast,pixels per length,rotation,blur,noise,jpeg,dice,asset dice,rachis,turned,\
         angle left,angle right,albedo,edges,confidence,seconds,refused\n",
    );
    for case in &cases {
        writeln!(text, "{}", row(case))?;
    }
    fs::write(folder.join("extract_cases.csv"), text)?;
    cases.sort_by(|a, b| a.dice().total_cmp(&b.dice()));
    println!("\nlowest Dice:");
    cases.iter().take(12).for_each(describe);
    cases.sort_by(|a, b| b.rachis().total_cmp(&a.rachis()));
    println!("\nlargest distance of the rachis:");
    cases.iter().take(12).for_each(describe);
    histogram(folder, &cases)
}

fn line(name: &str, cases: &[Case]) {
    let report = Report::of(cases);
    println!(
        "| {name} | {} | {:.4} | {:.4} | {:.4} |",
        cases.len(),
        report.dice.mean,
        report.rachis.mean,
        report.albedo.mean
    );
}

fn row(case: &Case) -> String {
    let s = &case.setting;
    let given = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.4}"));
    let head = format!(
        "{},{},{},{},{:?},{:.3},{:.0},{:.3},{:.2},{:.4},{}",
        case.index,
        case.name,
        s.size[0],
        s.size[1],
        s.background,
        case.contrast,
        case.scale,
        s.rotation,
        s.blur,
        s.noise,
        s.jpeg.unwrap_or(0)
    );
    match &case.scores {
        Ok(found) => format!(
            "{head},{:.4},{:.4},{:.5},{},{},{},{},{},{:.2},{:.2},",
            found.dice,
            found.asset,
            found.rachis,
            found.turned,
            given(found.angle[0]),
            given(found.angle[1]),
            given(found.albedo.rms),
            given(found.albedo.edges),
            found.confidence,
            case.seconds
        ),
        Err(error) => format!("{head},0,0,1,,,,,,0,{:.2},{error:?}", case.seconds),
    }
}

fn describe(case: &Case) {
    let s = &case.setting;
    let note = match &case.scores {
        Ok(found) => format!("confidence {:.2}", found.confidence),
        Err(error) => error.clone(),
    };
    println!(
        "  Dice {:.3}, rachis {:.4}: seed {} {} {}x{} {:?} contrast {:.2} noise {:.3} blur {:.1}; {note}",
        case.dice(),
        case.rachis(),
        case.index,
        case.name,
        s.size[0],
        s.size[1],
        s.background,
        case.contrast,
        s.noise,
        s.blur
    );
}

/// Share of photographs up to each error over its target.
fn histogram(folder: &Path, cases: &[Case]) -> Result<()> {
    let errors = |measure: usize| -> Vec<f64> {
        let mut errors: Vec<f64> = cases
            .iter()
            .flat_map(|case| over_target(case, measure))
            .collect();
        errors.sort_by(f64::total_cmp);
        errors
    };
    let curves: Vec<Curve> = (0..TARGETS.len())
        .map(|measure| {
            let errors = errors(measure);
            let last = errors.len().max(1) as f64;
            let points = errors
                .iter()
                .enumerate()
                .map(|(i, &error)| (error.clamp(0.02, 20.0).log10(), (i as f64 + 1.0) / last))
                .collect();
            (TARGETS[measure].0.to_owned(), points)
        })
        .collect();
    draw(
        &folder.join("extract_errors.svg"),
        &format!(
            "{} synthetic photographs: share up to an error",
            cases.len()
        ),
        ["log10 of the error over its target (0 = target)", "share"],
        (-1.7, 1.3),
        (0.0, 1.0),
        &curves,
    )
}

/// Errors of one photograph over the target of a measure: none, one, or one per vane.
fn over_target(case: &Case, measure: usize) -> Vec<f64> {
    let target = TARGETS[measure].1;
    let errors: Vec<f64> = match (measure, &case.scores) {
        (0, _) => vec![1.0 - case.dice()],
        (1, _) => vec![case.rachis()],
        (_, Err(_)) => Vec::new(),
        (2, Ok(scores)) => scores.albedo.rms.into_iter().collect(),
        (3, Ok(scores)) => scores.angle.into_iter().flatten().collect(),
        (_, Ok(scores)) => scores.albedo.edges.into_iter().collect(),
    };
    errors.into_iter().map(|error| error / target).collect()
}

/// A named curve.
type Curve = (String, Vec<(f64, f64)>);

/// One sweep: file name, title, axis, its values, and what a value does to the setting and to the extraction.
struct Sweep {
    name: &'static str,
    axis: &'static str,
    values: Vec<f64>,
    apply: fn(f64, &mut Setting, &mut ExtractSettings),
}

fn sweeps(folder: &Path) -> Result<()> {
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
            axis: "contrast of the feather's colour and a grey background, Oklab",
            values: vec![0.02, 0.04, 0.07, 0.10, 0.14, 0.2, 0.3],
            // The colours are set below: they depend on the feather.
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
        let xs = || {
            curves
                .iter()
                .flat_map(|(_, points)| points.iter().map(|p| p.0))
        };
        let (low, high) = (
            xs().fold(f64::INFINITY, f64::min),
            xs().fold(f64::NEG_INFINITY, f64::max),
        );
        draw(
            &folder.join(format!("extract_{}.svg", sweep.name)),
            &format!("Extraction: mean error over {}", sweep.name),
            [sweep.axis, "error over its target (1 = target; cut at 4)"],
            (low, high.max(low + 1e-6)),
            (0.0, 4.0),
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

/// One photograph of a preset, as a file.
fn photograph(name: &str, file: &Path) -> Result<()> {
    let feather = presets::by_name(name).ok_or_else(|| format!("no preset is named `{name}`"))?;
    let setting = Setting {
        size: [640, 1000],
        background: Background::Wood,
        ground: [0.80, 0.74, 0.64],
        rotation: 0.08,
        ..Setting::default()
    };
    fs::write(file, Photograph::take(&feather, &setting).file())?;
    Ok(())
}

/// A picture of 12 megapixels, extracted by a process of its own.
fn large(folder: &Path) -> Result<()> {
    let feather = presets::by_name("eagle_secondary").ok_or("no such feather")?;
    let setting = Setting {
        size: [3000, 4000],
        rotation: 0.2,
        ..Setting::default()
    };
    let start = Instant::now();
    let photograph = Photograph::take(&feather, &setting);
    println!(
        "\n3000 x 4000 pixels rendered in {:.1} s",
        start.elapsed().as_secs_f64()
    );
    let file = env::temp_dir().join(format!("bevy_plumage_{}.jpg", std::process::id()));
    fs::write(&file, photograph.file())?;
    drop(photograph);
    let output = Command::new(env::current_exe()?)
        .arg("--extract")
        .arg(&file)
        .output();
    fs::remove_file(&file)?;
    let output = output?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    print!("{text}");
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    fs::write(folder.join("extract_large.txt"), text)?;
    Ok(())
}

/// Extracts one file and prints time and peak memory of this process.
fn extract_alone(file: &Path) -> Result<()> {
    let start = Instant::now();
    let picture = load_photograph(file)?;
    let loaded = start.elapsed().as_secs_f64();
    let found = extract(&picture, &ExtractSettings::default(), &mut |_| ())?;
    println!(
        "{} x {} pixels: file read in {loaded:.2} s, all in {:.2} s on {} threads, confidence {:.2}",
        picture.width(),
        picture.height(),
        start.elapsed().as_secs_f64(),
        std::thread::available_parallelism()?,
        found.confidence.overall()
    );
    // Linux only; elsewhere the line is missing.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|rest| {
            rest.trim()
                .trim_end_matches(" kB")
                .trim()
                .parse::<f64>()
                .ok()
        });
    if let Some(kilobytes) = peak {
        println!(
            "peak memory of the process: {:.0} MB",
            kilobytes * 1024.0 / 1e6
        );
    }
    Ok(())
}

fn draw(
    file: &Path,
    title: &str,
    labels: [&str; 2],
    x: (f64, f64),
    y: (f64, f64),
    curves: &[Curve],
) -> Result<()> {
    let root = SVGBackend::new(file, (720, 440)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(48)
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    chart
        .configure_mesh()
        .x_desc(labels[0])
        .y_desc(labels[1])
        .light_line_style(WHITE)
        .draw()?;
    for (i, (name, points)) in curves.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        chart
            .draw_series(LineSeries::new(
                points.iter().copied(),
                colour.stroke_width(2),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    println!("{}", file.display());
    Ok(())
}
