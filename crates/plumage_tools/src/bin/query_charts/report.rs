//! The figures behind the charts: CSV, and the table of `docs/accuracy.md`.

use crate::{
    charts::{self, Cost},
    divergence::Divergence,
    measure::{ASPECTS, Measured, Part, SCALES},
    methods::Family,
    statements,
};
use bevy_plumage::maths::query::Evaluator;
use plotters::style::RGBColor;
use std::{error::Error, fmt::Write, fs, path::Path, time::SystemTime};

/// Today as year-month-day (the civil calendar from days since 1970).
pub fn date() -> String {
    let days = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .map_or(0, |d| d.as_secs() as i64 / 86_400)
        + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year + era * 400 + i64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

/// Name of the processor, where the system tells.
pub fn processor() -> String {
    fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        })
        .unwrap_or_else(|| std::env::consts::ARCH.into())
}

/// Range of the major axis of a stratum.
pub fn scale_name(i: usize) -> String {
    // From 0.01 p_bl, which is 0.0002 to 0.004 p_b (0.0009 in the middle), to 10 p_b.
    let middle = (i as f64 + 0.5) / SCALES as f64;
    let barbs = 0.0009 * (10f64 / 0.0009).powf(middle);
    if barbs < 0.1 {
        format!("major axis about {barbs:.3} barbs")
    } else {
        format!("major axis about {barbs:.1} barbs")
    }
}

/// Range of the aspect ratio of a stratum.
pub fn aspect_name(i: usize) -> String {
    match i {
        0 => "round".into(),
        _ => format!("{} to {} times longer", 1 << (i - 1), 1 << i),
    }
}

/// Evaluators that occur, dearest first.
pub fn kinds(measured: &Measured) -> Vec<Evaluator> {
    let mut kinds = Vec::new();
    for method in &measured.methods {
        if let Family::Forced(kind) = method.family
            && !kinds.contains(&kind)
            && measured.groups.iter().any(|g| g.kind == kind)
        {
            kinds.push(kind);
        }
    }
    kinds
}

fn part_name(part: Part) -> String {
    match part {
        Part::All => "all".into(),
        Part::Scale(i) => format!("scale {i}"),
        Part::Aspect(i) => format!("aspect {i}"),
        Part::Kind(kind) => format!("{kind:?}").to_lowercase(),
    }
}

fn nanoseconds(ns: Option<f64>) -> String {
    ns.map_or_else(String::new, |ns| format!("{ns:.2}"))
}

/// Writes `query.csv`, `query_divergence.csv` and `query_table.md`, and prints what was found.
pub fn write(
    folder: &Path,
    subtitle: &str,
    measured: &Measured,
    divergence: &[Divergence],
) -> Result<(), Box<dyn Error>> {
    let mut parts = vec![Part::All];
    parts.extend((0..SCALES).map(Part::Scale));
    parts.extend((0..ASPECTS).map(Part::Aspect));
    parts.extend(kinds(measured).into_iter().map(Part::Kind));
    let mut csv = format!(
        "# {subtitle}\npart,method,setting,footprints,rms,p99,max,cpu_ns,gpu_ns,front_cpu,front_gpu\n"
    );
    for part in &parts {
        for (i, method) in measured.methods.iter().enumerate() {
            let Some(row) = measured.row(i, *part) else {
                continue;
            };
            let [rms, p99, max] = row.error;
            writeln!(
                csv,
                "{},\"{}\",\"{}\",{},{rms:.6},{p99:.6},{max:.6},{:.2},{},{},{}",
                part_name(*part),
                method.family.name(),
                method.setting,
                row.count,
                row.cpu,
                nanoseconds(row.gpu),
                charts::on_front(measured, i, *part, Cost::Cpu),
                charts::on_front(measured, i, *part, Cost::Gpu),
            )?;
        }
    }
    fs::write(folder.join("query.csv"), csv)?;

    let mut table = format!("{subtitle}\n\n");
    table += "| method | setting | RMS error | 99th percentile | largest | CPU, ns | GPU, ns |\n|---|---|---|---|---|---|---|\n";
    for (i, method) in measured.methods.iter().enumerate() {
        let part = match method.family {
            Family::Forced(kind) => Part::Kind(kind),
            _ => Part::All,
        };
        let Some(row) = measured.row(i, part) else {
            continue;
        };
        let [rms, p99, max] = row.error;
        writeln!(
            table,
            "| {} | {} | {rms:.5} | {p99:.4} | {max:.4} | {:.0} | {} |",
            method.family.name(),
            method.setting,
            row.cpu,
            row.gpu.map_or_else(String::new, |ns| format!("{ns:.1}")),
        )?;
    }
    table += "\n";
    for line in statements::statements(measured) {
        writeln!(table, "- {line}")?;
    }
    if !divergence.is_empty() {
        table += "\n| picture | trips per pixel | most | 8x8 tile's most over the mean | 8x4 | 8x1 | time, shuffled over in order |\n|---|---|---|---|---|---|---|\n";
        let mut csv = format!(
            "# {subtitle}\npicture,trips,most,tile_over_mean,half_over_mean,row_over_mean,seconds,shuffled_over_ordered\n"
        );
        for d in divergence {
            writeln!(
                table,
                "| {} | {:.2} | {:.0} | {:.2} | {:.2} | {:.2} | {:.2} |",
                d.name, d.mean, d.most, d.tile, d.half, d.row, d.shuffled
            )?;
            writeln!(
                csv,
                "\"{}\",{:.3},{:.0},{:.3},{:.3},{:.3},{:.6},{:.3}",
                d.name, d.mean, d.most, d.tile, d.half, d.row, d.seconds, d.shuffled
            )?;
        }
        fs::write(folder.join("query_divergence.csv"), csv)?;
        let bars: Vec<_> = divergence
            .iter()
            .flat_map(|d| {
                [
                    (d.name.clone(), d.tile, RGBColor(0, 90, 181)),
                    ("row of eight".into(), d.row, RGBColor(120, 170, 220)),
                ]
            })
            .collect();
        charts::bars(
            &folder.join("query_divergence.svg"),
            "Divergence: what the slowest pixel of a tile costs its neighbors",
            subtitle,
            "most loop trips in an 8x8 tile (pale: in a row of 8) over the mean per pixel",
            &bars,
        )?;
    }
    println!("\n{table}");
    fs::write(folder.join("query_table.md"), table)?;
    Ok(())
}
