//! Paths of footprints that change slowly, and what an evaluator's error does along them.

use bevy_plumage::maths::query::{Cell, ErrorBudget, Evaluator, Local, Lod, cell_coverage, choose};
use plotters::prelude::*;
use plumage_reference::coverage;
use std::path::{Path, PathBuf};

use super::sweep;

/// One step of a path.
pub struct Step {
    /// The parameter that changes, in the unit of the path's label.
    pub at: f64,
    /// `[barb, distal, proximal]` in single precision, as the shader has it.
    pub value: [f64; 3],
    /// The reference.
    pub truth: [f64; 3],
    /// What the chooser said.
    pub kind: (Evaluator, bool),
}

impl Step {
    /// Evaluates a footprint with the default budget.
    pub fn new(at: f64, cell: &Cell<f64>, local: &Local<f64>) -> Self {
        Self {
            at,
            value: value(cell, local),
            truth: coverage::coverage(cell, local),
            kind: kind(cell, local),
        }
    }
}

/// The coverage that the shader would find.
pub fn value(cell: &Cell<f64>, local: &Local<f64>) -> [f64; 3] {
    let budget = ErrorBudget::<f32>::default();
    cell_coverage(
        &sweep::cell_f32(cell),
        &sweep::local_f32(local),
        Lod::Mixed,
        &budget,
    )
    .map(f64::from)
}

/// What the chooser says of a footprint, in single precision, and whether NEAR has to be finer.
pub fn kind(cell: &Cell<f64>, local: &Local<f64>) -> (Evaluator, bool) {
    let threshold = ErrorBudget::<f32>::default().threshold();
    let choice = choose(&sweep::cell_f32(cell), &sweep::local_f32(local), threshold);
    (choice.evaluator, choice.beside_switch)
}

/// Change of the error from one step to the next: largest component, and of the sum.
pub fn jump(a: &Step, b: &Step) -> [f64; 2] {
    let change: Vec<f64> = (0..3)
        .map(|i| (b.value[i] - b.truth[i]) - (a.value[i] - a.truth[i]))
        .collect();
    let component = change.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
    [component, change.iter().sum::<f64>().abs()]
}

/// Where the pictures of failed tests go.
pub fn failure_file(name: &str) -> PathBuf {
    crate::failure(&format!("{name}.svg"))
}

/// Draws a path: coverages with the reference behind them, and below the error of each, with a bound.
pub fn draw(file: &Path, title: &str, label: &str, path: &[Step], bound: f64) {
    if let Err(error) = try_draw(file, title, label, path, bound) {
        eprintln!("{}: {error}", file.display());
    }
}

const NAMES: [&str; 3] = ["barb", "distal", "proximal"];
const COLORS: [RGBColor; 3] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
];

/// A line, piece by piece: some viewers fill what a longer one encloses.
fn segments(
    line: impl Iterator<Item = (f64, f64)>,
    style: ShapeStyle,
) -> Vec<PathElement<(f64, f64)>> {
    let points: Vec<(f64, f64)> = line.collect();
    points
        .windows(2)
        .map(|pair| PathElement::new(pair.to_vec(), style))
        .collect()
}

fn try_draw(
    file: &Path,
    title: &str,
    label: &str,
    path: &[Step],
    bound: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let (Some(first), Some(last)) = (path.first(), path.last()) else {
        return Ok(());
    };
    let root = SVGBackend::new(file, (760, 560)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, ("sans-serif", 17))?;
    let (top, bottom) = root.split_vertically(270);
    let mut chart = ChartBuilder::on(&top)
        .margin(8)
        .x_label_area_size(8)
        .y_label_area_size(64)
        .build_cartesian_2d(first.at..last.at, 0.0..1.0)?;
    chart
        .configure_mesh()
        .y_desc("coverage (grey: reference)")
        .x_labels(0)
        .light_line_style(WHITE)
        .draw()?;
    for i in 0..3 {
        let truth = path.iter().map(|s| (s.at, s.truth[i]));
        chart.draw_series(segments(truth, RGBColor(200, 200, 200).stroke_width(5)))?;
        let color = COLORS[i];
        let value = path.iter().map(|s| (s.at, s.value[i]));
        chart
            .draw_series(segments(value, color.stroke_width(2)))?
            .label(NAMES[i])
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    let errors = path
        .iter()
        .flat_map(|s| (0..3).map(|i| (s.value[i] - s.truth[i]).abs()));
    let most = errors.fold(bound, f64::max) * 1.1;
    let mut chart = ChartBuilder::on(&bottom)
        .margin(8)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(first.at..last.at, -most..most)?;
    chart
        .configure_mesh()
        .x_desc(label)
        .y_desc("error (dashes: bound of a jump)")
        .light_line_style(WHITE)
        .draw()?;
    for side in [-bound, bound] {
        let ends = [(first.at, side), (last.at, side)];
        chart.draw_series(DashedLineSeries::new(
            ends,
            6,
            5,
            RGBColor(120, 120, 120).into(),
        ))?;
    }
    for (i, color) in COLORS.iter().enumerate() {
        let error = path.iter().map(|s| (s.at, s.value[i] - s.truth[i]));
        chart.draw_series(segments(error, color.stroke_width(1)))?;
    }
    root.present()?;
    Ok(())
}
