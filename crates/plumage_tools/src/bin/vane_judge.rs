//! What Mitsuba 3 says of a vane's light, and what the crate makes of it: tables and a chart.
//!
//! `cargo run -p plumage_tools --bin vane_judge -- [TABLE.csv] [FOLDER] [RESULTS.md]`: a table that `judge/judge.py` wrote (that of
//! the repository by default), the folder of the chart (`docs/charts`), and where the tables go (standard output).

use plumage_reference::judged::{Judged, TABLE, Verdict, judge};
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::{env, fmt::Write, fs, path::Path};

const COLORS: [(&str, &str); 8] = [
    ("covert 0 ", "pigment covert, white"),
    ("covert 0.2 ", "pigment covert, albedo 0.51"),
    ("covert 1 ", "pigment covert, albedo 0.16"),
    ("eagle 0 ", "eagle's contour feather, white"),
    ("eagle 0.2 ", "eagle's contour feather, albedo 0.51"),
    ("eagle 1 ", "eagle's contour feather, albedo 0.16"),
    ("remex 1 ", "structural remex, white"),
    ("remex 0.5 ", "structural remex, core 0.5"),
];

/// Number, root mean square, mean and largest error of the figures that are at least a share of the brightest.
fn line(list: &[Judged], name: &str, share: f64) -> String {
    let all: Vec<_> = list.iter().filter(|j| j.name.starts_with(name)).collect();
    let peak = all.iter().map(|j| j.traced).fold(0.0, f64::max);
    let chosen: Vec<_> = all
        .into_iter()
        .filter(|j| j.traced > share * peak && j.traced > 8.0 * j.deviation)
        .collect();
    let count = chosen.len().max(1) as f64;
    let mean = chosen.iter().map(|j| j.error()).sum::<f64>() / count;
    let square = chosen.iter().map(|j| j.error().powi(2)).sum::<f64>() / count;
    let noise = chosen
        .iter()
        .map(|j| (j.deviation / j.traced).powi(2))
        .sum::<f64>()
        / count;
    let worst = chosen
        .iter()
        .max_by(|a, b| a.error().abs().total_cmp(&b.error().abs()));
    let worst = worst.map_or(String::new(), |j| {
        let pair = j.name.rsplit(' ').next().unwrap_or_default();
        format!("{:+.1} at {pair}", 100.0 * j.error())
    });
    format!(
        "{} | {:.1} | {:+.1} | {worst} | {:.1}",
        chosen.len(),
        100.0 * square.sqrt(),
        100.0 * mean,
        100.0 * noise.sqrt()
    )
}

fn largest(list: &[Judged]) -> (f64, &str) {
    list.iter().fold((0.0, ""), |best, j| {
        let off = (j.model - j.traced).abs();
        if off > best.0 { (off, &j.name) } else { best }
    })
}

fn tables(verdict: &Verdict) -> std::result::Result<String, std::fmt::Error> {
    let mut out = String::new();
    let (off, name) = largest(&verdict.fibres);
    writeln!(
        out,
        "Energies of one fibre: {} figures, largest difference {off:.4} ({name}).\n",
        verdict.fibres.len()
    )?;
    let (off, name) = largest(&verdict.coverage);
    writeln!(
        out,
        "Coverage and open area, 0 to 80 degrees across and along, both faces: {} figures, largest difference {off:.4} ({name}).\n",
        verdict.coverage.len()
    )?;
    for (what, list) in [
        ("Light that met one fibre", &verdict.one),
        ("All light", &verdict.all),
    ] {
        for (share, which) in [
            (0.1, "at least a tenth of the brightest"),
            (0.0, "all pairs"),
        ] {
            writeln!(out, "{what}, {which}, per cent:\n")?;
            writeln!(
                out,
                "| vane | pairs | RMS | mean | largest | noise, RMS |\n|---|---|---|---|---|---|"
            )?;
            for (name, label) in COLORS {
                writeln!(out, "| {label} | {} |", line(list, name, share))?;
            }
            writeln!(out)?;
        }
    }
    writeln!(
        out,
        "Furnace, per covered area:\n\n| vane, color, eye | Mitsuba | crate |\n|---|---|---|"
    )?;
    for j in &verdict.furnace {
        writeln!(out, "| {} | {:.3} | {:.3} |", j.name, j.traced, j.model)?;
    }
    writeln!(
        out,
        "\nPairs of eye and light (x across, y along the barbs, b from behind):\n"
    )?;
    writeln!(
        out,
        "| pair | one fibre | error, % | all | error, % |\n|---|---|---|---|---|"
    )?;
    for (one, all) in verdict.one.iter().zip(&verdict.all) {
        writeln!(
            out,
            "| {} | {:.5} | {:+.1} | {:.5} | {:+.1} |",
            one.name,
            one.traced,
            100.0 * one.error(),
            all.traced,
            100.0 * all.error()
        )?;
    }
    Ok(out)
}

fn main() -> Result<()> {
    let mut arguments = env::args().skip(1);
    let table = match arguments.next() {
        Some(file) => fs::read_to_string(file)?,
        None => TABLE.to_owned(),
    };
    let folder = arguments.next().unwrap_or_else(|| "docs/charts".into());
    let verdict = judge(&table);
    let text = tables(&verdict)?;
    match arguments.next() {
        Some(file) => fs::write(file, &text)?,
        None => print!("{text}"),
    }
    // Radiance of both, every pair.
    let curves: Vec<Curve> = COLORS
        .iter()
        .map(|(name, label)| {
            let mut points: Vec<(f64, f64)> = verdict
                .all
                .iter()
                .filter(|j| j.name.starts_with(name) && j.traced > 1e-5)
                .map(|j| (j.traced, j.model / j.traced))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            ((*label).to_owned(), points)
        })
        .collect();
    let labels = Labels {
        title: "All light of a vane: the crate over Mitsuba, by how bright the pair of eye and light is",
        x: "share of light into 15 degrees, Mitsuba",
        y: "crate over Mitsuba",
    };
    draw(
        &Path::new(&folder).join("judge_vane.svg"),
        &labels,
        [true, false],
        &curves,
    )
}
