//! Draws what the example `parrot` has measured (`--cost-table`, `--light-cost`): cost over the number of feathers, the size of the picture
//! and the number of lights, and error over cost of light found at vertices, by root mean square and by FLIP.
//!
//! `cargo run -p plumage_tools --bin cost_charts -- FOLDER`, with `cost.csv` and `light_budget.csv` and its pictures in FOLDER; writes
//! `docs/charts/cost_*.svg`, `light_budget.csv` and `.svg`.

use plumage_tests::flip::{Difference, difference};
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::{fmt::Write, fs, path::Path};

/// Rows of a table without its head, split at commas.
fn rows(file: &Path) -> Result<Vec<Vec<String>>> {
    let text = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let line = |line: &str| line.split(',').map(str::to_owned).collect();
    Ok(text.lines().skip(1).map(line).collect())
}

fn cost(from: &Path, charts: &Path) -> Result<()> {
    let rows = rows(&from.join("cost.csv"))?;
    for (what, title) in [
        (
            "pixels",
            "Frame of two parrots over the size of the picture",
        ),
        ("lights", "Frame of two parrots over the number of lights"),
        (
            "feathers",
            "Frame of two parrots over the number of feathers",
        ),
    ] {
        let column = |at: usize| -> Result<Vec<(f64, f64)>> {
            let chosen = rows.iter().filter(|row| row[0] == what);
            chosen
                .map(|row| Ok((row[1].parse()?, row[at].parse()?)))
                .collect()
        };
        let curves: Vec<Curve> = vec![
            ("feathers".into(), column(2)?),
            ("StandardMaterial cards".into(), column(3)?),
        ];
        let labels = Labels {
            title,
            x: what,
            y: "processor time of a frame, ms",
        };
        draw(
            &charts.join(format!("cost_{what}.svg")),
            &labels,
            [true, true],
            &curves,
        )?;
    }
    Ok(())
}

fn light(from: &Path, charts: &Path) -> Result<()> {
    let rows = rows(&from.join("light_budget.csv"))?;
    let picture = |budget: &str| -> Result<image::RgbImage> {
        Ok(image::open(from.join(format!("light_budget.{budget}.png")))?.to_rgb8())
    };
    let truth = picture(&rows[0][0])?;
    let mut table = String::from(
        "light budget,lit cards,rms of 255,99th percentile,largest,frame over 0,rmse of the picture,mean of FLIP,99th percentile of FLIP\n",
    );
    let mut found = Vec::new();
    for row in &rows {
        let off = difference(&truth, &picture(&row[0])?, truth.dimensions());
        let Difference {
            flip,
            flip_99,
            rmse,
            ..
        } = off;
        writeln!(table, "{},{rmse:.2},{flip:.4},{flip_99:.3}", row.join(","))?;
        let budget: f64 = row[0].parse()?;
        if budget > 0.0 {
            found.push((budget, row[5].parse()?, off));
        }
    }
    print!("{table}");
    let curve = |of: &dyn Fn(&Difference, f64) -> f64| -> Vec<(f64, f64)> {
        let point = |(budget, time, off): &(f64, f64, Difference)| (*budget, of(off, *time));
        found.iter().map(point).collect()
    };
    let curves: Vec<Curve> = vec![
        (
            "RMSE of the picture, of 255".into(),
            curve(&|off, _| f64::from(off.rmse)),
        ),
        (
            "FLIP, 99th percentile, times 10".into(),
            curve(&|off, _| 10.0 * f64::from(off.flip_99)),
        ),
        (
            "FLIP, mean, times 100".into(),
            curve(&|off, _| 100.0 * f64::from(off.flip)),
        ),
        (
            "frame, over that with all light in fragments".into(),
            curve(&|_, time| time),
        ),
    ];
    let labels = Labels {
        title: "Light at vertices: error and time over the light budget",
        x: "light budget",
        y: "error, time",
    };
    draw(
        &charts.join("light_budget.svg"),
        &labels,
        [true, false],
        &curves,
    )?;
    // In the place of the curves' own table.
    fs::write(charts.join("light_budget.csv"), table)?;
    Ok(())
}

fn main() -> Result<()> {
    let from = std::env::args().nth(1).ok_or("cost_charts FOLDER")?;
    let from = Path::new(&from);
    let charts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/charts"));
    cost(from, charts)?;
    light(from, charts)
}
