//! How good the extraction is, on synthetic photographs with known truth: tables, `extract_*.svg` and `extract_*.csv`.
//!
//! `cargo run -p plumage_tools --bin photo_charts [folder] [photographs]` (default `docs/charts`, 520; the least is 39).
//! `--corpus FOLDER PHOTOGRAPHS FIRST` judges photographs FIRST, FIRST + 1, ... alone, without the sweeps, and writes a line for each
//! to the error output as it is done: photographs that no parameter was tuned on. Each photograph has its line in `extract_cases.csv`,
//! each feather in `extract_summary.csv`. `--photograph PRESET FILE` writes one of them. The picture of 12 megapixels is extracted by a process of its own, whose time
//! and memory are printed; `--large [folder]` does that alone.

mod sweep;

use bevy_plumage::photo::{ExtractSettings, extract, load_photograph};
use plumage_reference::photograph::{Background, Photograph, Setting};
use plumage_tests::photographs::{Case, Report, random_case, run, settings};
use plumage_tools::{
    plot::{Curve, Labels, Result, draw},
    presets,
};
use rayon::prelude::*;
use std::{
    env,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

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
    if arguments.first().is_some_and(|flag| flag == "--large") {
        return large(Path::new(
            arguments.get(1).map_or("docs/charts", String::as_str),
        ));
    }
    if let [flag, folder, count, first] = arguments.as_slice()
        && flag == "--corpus"
    {
        fs::create_dir_all(folder)?;
        return corpus(Path::new(folder), first.parse()?, count.parse()?);
    }
    let folder = PathBuf::from(arguments.first().map_or("docs/charts", String::as_str));
    let count = arguments.get(1).map_or(Ok(520), |text| text.parse())?;
    fs::create_dir_all(&folder)?;
    corpus(&folder, 0, count)?;
    sweep::sweeps(&folder)?;
    large(&folder)
}

/// Photographs over the whole range, from number `first` on.
fn corpus(folder: &Path, first: u64, count: u64) -> Result<()> {
    let start = Instant::now();
    let mut cases: Vec<Case> = (first..first.saturating_add(count.max(39)))
        .into_par_iter()
        .map(|index| {
            let (feather, setting) = random_case(index);
            let case = run(index, &feather, &setting, &settings(&feather, &setting));
            eprintln!("{}", row(&case));
            case
        })
        .collect();
    println!(
        "{} photographs in {:.0} s on {} threads",
        cases.len(),
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads()
    );
    Report::of(&cases).print();
    println!("\n| background | photographs | Dice | rachis | albedo | lowest Dice |");
    println!("|---|---|---|---|---|---|");
    for background in Background::ALL {
        let part: Vec<Case> = cases
            .iter()
            .filter(|case| case.setting.background == background)
            .cloned()
            .collect();
        line(&format!("{background:?}"), &part);
    }
    println!("\n| feather | photographs | Dice | rachis | albedo | lowest Dice |");
    println!("|---|---|---|---|---|---|");
    let mut summary =
        String::from("feather,photographs,dice,lowest dice,rachis,largest rachis,albedo,refused\n");
    for feather in presets::all() {
        let part: Vec<Case> = cases
            .iter()
            .filter(|case| case.name == feather.name)
            .cloned()
            .collect();
        line(&feather.name, &part);
        summarise(&mut summary, &feather.name, &part)?;
    }
    summarise(&mut summary, "all", &cases)?;
    fs::write(folder.join("extract_summary.csv"), summary)?;
    let mut text = String::from(
        "seed,feather,width,height,background,contrast,pixels per length,rotation,blur,noise,jpeg,dice,asset dice,rachis,turned,\
         angle left,angle right,albedo,edges,confidence,seconds,refused,sure left,sure right\n",
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
    let least = cases.iter().map(Case::dice).fold(1.0, f64::min);
    println!(
        "| {name} | {} | {:.4} | {:.4} | {:.4} | {least:.4} |",
        cases.len(),
        report.dice.mean,
        report.rachis.mean,
        report.albedo.mean
    );
}

/// A line of the summary.
fn summarise(text: &mut String, name: &str, cases: &[Case]) -> Result<()> {
    let report = Report::of(cases);
    let lowest = cases.iter().map(Case::dice).fold(1.0, f64::min);
    let largest = cases.iter().map(Case::rachis).fold(0.0, f64::max);
    writeln!(
        text,
        "{name},{},{:.4},{lowest:.4},{:.5},{largest:.5},{:.4},{}",
        cases.len(),
        report.dice.mean,
        report.rachis.mean,
        report.albedo.mean,
        report.refused
    )?;
    Ok(())
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
            "{head},{:.4},{:.4},{:.5},{},{},{},{},{},{:.2},{:.2},,{},{}",
            found.dice,
            found.asset,
            found.rachis,
            found.turned,
            given(found.angle[0]),
            given(found.angle[1]),
            given(found.albedo.rms),
            given(found.albedo.edges),
            found.confidence,
            case.seconds,
            given(found.sure_angle[0]),
            given(found.sure_angle[1])
        ),
        Err(error) => format!("{head},0,0,1,,,,,,0,{:.2},{error:?},,", case.seconds),
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
        &Labels {
            title: &format!(
                "{} synthetic photographs: share up to an error",
                cases.len()
            ),
            x: "log10 of the error over its target (0 = target)",
            y: "share",
        },
        [false, false],
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

/// One photograph of a preset, as a file.
fn photograph(name: &str, file: &Path) -> Result<()> {
    let feather = presets::by_name(name).ok_or_else(|| format!("no preset is named `{name}`"))?;
    let setting = Setting {
        size: [640, 1000],
        background: Background::Color,
        ground: [0.60, 0.74, 0.78],
        rotation: 0.08,
        exposure: 1.0,
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
    // Linux only; elsewhere these lines are missing.
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: Vec<f64> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .skip(11)
        .take(2)
        .filter_map(|ticks| ticks.parse().ok())
        .collect();
    if ticks.len() == 2 {
        // User and system time of all threads; Linux counts in hundredths of a second.
        println!(
            "CPU time of the process: {:.2} s",
            ticks.iter().sum::<f64>() / 100.0
        );
    }
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
