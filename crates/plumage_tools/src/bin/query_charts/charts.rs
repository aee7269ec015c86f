//! Draws error over cost.

use crate::{
    measure::{Measured, Part, Row},
    methods::Family,
};
use bevy_plumage::maths::query::Evaluator;
use plotters::{
    coord::types::RangedCoordf64,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};
use std::{error::Error, path::Path};

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type LogChart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type LogCoord<T> = plotters::coord::combinators::LogCoord<T>;

/// Whose time is the cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    Cpu,
    Gpu,
}

impl Cost {
    pub fn of(self, row: &Row) -> Option<f64> {
        match self {
            Self::Cpu => Some(row.cpu),
            Self::Gpu => row.gpu,
        }
        .filter(|ns| ns.is_finite())
        // Less than the clock can tell.
        .map(|ns| ns.max(0.05))
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Cpu => "time per query on the CPU (one thread)",
            Self::Gpu => "time per pixel on the GPU (8x8 tiles)",
        }
    }
}

/// Which error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Rms = 0,
    P99 = 1,
    Max = 2,
}

impl Measure {
    pub fn name(self) -> &'static str {
        match self {
            Self::Rms => "RMS error",
            Self::P99 => "99th percentile of the error",
            Self::Max => "largest error",
        }
    }
}

/// Opaque, because some viewers fill half transparent lines.
const FRONT: RGBColor = RGBColor(190, 190, 190);
const GRID: RGBColor = RGBColor(228, 228, 228);

fn color(family: Family) -> RGBColor {
    match family {
        Family::Chosen => RGBColor(0, 90, 181),
        Family::Forced(_) => RGBColor(0, 158, 115),
        Family::Points => RGBColor(130, 130, 130),
        Family::Spatial => RGBColor(213, 94, 0),
        Family::Frequency => RGBColor(204, 121, 167),
        Family::Switch => RGBColor(150, 60, 20),
    }
}

/// A point of a chart.
struct Mark {
    family: Family,
    setting: String,
    cost: f64,
    error: f64,
    front: bool,
}

/// Marks the points that no other beats in both.
fn pareto(marks: &mut [Mark]) {
    let all: Vec<(f64, f64)> = marks.iter().map(|m| (m.cost, m.error)).collect();
    for mark in marks.iter_mut() {
        mark.front = !all.iter().any(|(cost, error)| {
            *cost <= mark.cost && *error <= mark.error && (*cost < mark.cost || *error < mark.error)
        });
    }
}

/// Whether a method is on the Pareto front of a part.
pub fn on_front(measured: &Measured, method: usize, part: Part, cost: Cost) -> bool {
    marks(measured, part, cost, Measure::Rms).iter().any(|m| {
        m.front
            && m.family == measured.methods[method].family
            && m.setting == measured.methods[method].setting
    })
}

fn marks(measured: &Measured, part: Part, cost: Cost, measure: Measure) -> Vec<Mark> {
    let mut marks: Vec<Mark> = measured
        .methods
        .iter()
        .enumerate()
        .filter_map(|(i, method)| {
            // One evaluator alone is no method for a mixed part.
            if matches!(method.family, Family::Forced(_)) && !matches!(part, Part::Kind(_)) {
                return None;
            }
            let row = measured.row(i, part)?;
            Some(Mark {
                family: method.family,
                setting: method.setting.clone(),
                cost: cost.of(&row)?,
                error: row.error[measure as usize].max(1e-7),
                front: false,
            })
        })
        .collect();
    pareto(&mut marks);
    marks
}

/// The decades around some values.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
    if !low.is_finite() {
        return (1.0, 10.0);
    }
    // A third of a decade of room.
    (low / 2.0, high * 3.0)
}

fn families(marks: &[Mark]) -> Vec<Family> {
    let mut families: Vec<Family> = Vec::new();
    for mark in marks {
        if !families.contains(&mark.family) {
            families.push(mark.family);
        }
    }
    families
}

fn number(x: &f64) -> String {
    match *x {
        x if x >= 1e6 => format!("{} ms", x / 1e6),
        x if x >= 1e3 => format!("{} us", x / 1e3),
        x => format!("{x} ns"),
    }
}

fn share(x: &f64) -> String {
    if *x >= 5e-4 {
        format!("{}", (x * 1e6).round() / 1e6)
    } else {
        format!("{x:.0e}")
    }
}

/// A line, piece by piece: some viewers fill what a longer one encloses.
fn segments(line: &[(f64, f64)], style: ShapeStyle) -> Vec<PathElement<(f64, f64)>> {
    line.windows(2)
        .map(|pair| PathElement::new(pair.to_vec(), style))
        .collect()
}

/// One panel.
fn panel(
    area: &Area,
    title: &str,
    marks: &[Mark],
    ranges: [(f64, f64); 2],
    labels: Option<[&str; 2]>,
    names: bool,
) -> Result<(), Box<dyn Error>> {
    let [x, y] = ranges;
    let small = if names { 13 } else { 11 };
    let mut chart: LogChart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", small + 2))
        .margin(8)
        .margin_right(16)
        .x_label_area_size(if labels.is_some() { 46 } else { 26 })
        .y_label_area_size(if labels.is_some() { 62 } else { 46 })
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(WHITE)
        .bold_line_style(GRID)
        .label_style(("sans-serif", small))
        .x_label_formatter(&number)
        .y_label_formatter(&share)
        .x_labels(if names { 8 } else { 4 })
        .y_labels(if names { 8 } else { 5 });
    if let Some([x_label, y_label]) = labels {
        mesh.x_desc(x_label).y_desc(y_label);
    }
    mesh.draw()?;
    let mut front: Vec<(f64, f64)> = marks
        .iter()
        .filter(|m| m.front)
        .map(|m| (m.cost, m.error))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart.draw_series(segments(&front, FRONT.stroke_width(6)))?;
    for family in families(marks) {
        let color = color(family);
        let of: Vec<&Mark> = marks.iter().filter(|m| m.family == family).collect();
        let line: Vec<(f64, f64)> = of.iter().map(|m| (m.cost, m.error)).collect();
        if family != Family::Chosen {
            chart.draw_series(segments(&line, color.stroke_width(1)))?;
        }
        let radius = if names { 5 } else { 3 };
        chart.draw_series(
            of.iter()
                .map(|m| Circle::new((m.cost, m.error), radius, color.filled())),
        )?;
        if names {
            let style = ("sans-serif", 11)
                .into_font()
                .color(&color)
                .pos(Pos::new(HPos::Left, VPos::Center));
            // Names of neighbors one below the other.
            chart.draw_series(of.iter().enumerate().map(|(i, m)| {
                let down = if family == Family::Chosen {
                    12 * i as i32 - 24
                } else {
                    -8
                };
                EmptyElement::at((m.cost, m.error))
                    + Text::new(m.setting.clone(), (9, down), style.clone())
            }))?;
        }
    }
    Ok(())
}

/// Title, subtitle and a row of names with their colors; returns what is left.
fn header<'a>(
    area: &Area<'a>,
    title: &str,
    subtitle: &str,
    families: &[Family],
) -> Result<Area<'a>, Box<dyn Error>> {
    area.fill(&WHITE)?;
    let (top, rest) = area.split_vertically(84);
    top.draw_text(
        title,
        &("sans-serif", 18).into_font().color(&BLACK),
        (12, 12),
    )?;
    top.draw_text(
        subtitle,
        &("sans-serif", 12)
            .into_font()
            .color(&RGBColor(110, 110, 110)),
        (12, 38),
    )?;
    let mut x = 14;
    for family in families {
        let name = match family {
            Family::Forced(_) => "that evaluator alone".into(),
            _ => family.name(),
        };
        top.draw(&Circle::new((x, 70), 5, color(*family).filled()))?;
        top.draw_text(
            &name,
            &("sans-serif", 12).into_font().color(&BLACK),
            (x + 9, 64),
        )?;
        x += 28 + 7 * name.len() as i32;
    }
    top.draw(&PathElement::new(
        [(x, 70), (x + 22, 70)],
        FRONT.stroke_width(6),
    ))?;
    top.draw_text(
        "Pareto front",
        &("sans-serif", 12).into_font().color(&BLACK),
        (x + 28, 64),
    )?;
    Ok(rest)
}

/// One large chart of one error.
pub fn single(
    file: &Path,
    title: &str,
    subtitle: &str,
    measured: &Measured,
    cost: Cost,
    measure: Measure,
) -> Result<(), Box<dyn Error>> {
    let marks = marks(measured, Part::All, cost, measure);
    let root = SVGBackend::new(file, (860, 560)).into_drawing_area();
    let area = header(&root, title, subtitle, &families(&marks))?;
    let mut x = decades(marks.iter().map(|m| m.cost));
    // Room for the last name.
    x.1 *= 2.0;
    let y = decades(marks.iter().map(|m| m.error));
    let labels = [cost.axis(), measure.name()];
    panel(&area, "", &marks, [x, y], Some(labels), true)?;
    root.present()?;
    println!("{}", file.display());
    Ok(())
}

/// A panel per part on the same axes.
pub fn panels(
    file: &Path,
    title: &str,
    subtitle: &str,
    measured: &Measured,
    cost: Cost,
    parts: &[(Part, Measure, String)],
    columns: usize,
) -> Result<(), Box<dyn Error>> {
    let all: Vec<Vec<Mark>> = parts
        .iter()
        .map(|(part, measure, _)| marks(measured, *part, cost, *measure))
        .collect();
    let rows = parts.len().div_ceil(columns);
    let size = ((260 * columns as u32 + 20).max(900), 88 + 230 * rows as u32);
    let root = SVGBackend::new(file, size).into_drawing_area();
    let mut names: Vec<Family> = Vec::new();
    for family in all.iter().flat_map(|m| families(m)) {
        if !names.contains(&family) && !matches!(family, Family::Forced(_)) {
            names.push(family);
        }
    }
    if all
        .iter()
        .flatten()
        .any(|m| matches!(m.family, Family::Forced(_)))
    {
        names.push(Family::Forced(Evaluator::Near));
    }
    let area = header(&root, title, subtitle, &names)?;
    let x = decades(all.iter().flatten().map(|m| m.cost));
    let y = decades(all.iter().flatten().map(|m| m.error));
    for ((area, marks), (_, _, name)) in area
        .split_evenly((rows, columns))
        .iter()
        .zip(&all)
        .zip(parts)
    {
        panel(area, name, marks, [x, y], None, false)?;
    }
    root.present()?;
    println!("{}", file.display());
    Ok(())
}

/// Bars: a name and a value each.
pub fn bars(
    file: &Path,
    title: &str,
    subtitle: &str,
    label: &str,
    bars: &[(String, f64, RGBColor)],
) -> Result<(), Box<dyn Error>> {
    let height = 130 + 26 * bars.len() as u32;
    let root = SVGBackend::new(file, (760, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let (top, area) = root.split_vertically(58);
    top.draw_text(
        title,
        &("sans-serif", 17).into_font().color(&BLACK),
        (12, 12),
    )?;
    top.draw_text(
        subtitle,
        &("sans-serif", 12)
            .into_font()
            .color(&RGBColor(110, 110, 110)),
        (12, 38),
    )?;
    let most = bars.iter().fold(0.0f64, |m, b| m.max(b.1)) * 1.15;
    let mut chart: ChartContext<SVGBackend, Cartesian2d<RangedCoordf64, RangedCoordf64>> =
        ChartBuilder::on(&area)
            .margin(8)
            .set_label_area_size(LabelAreaPosition::Left, 250)
            .x_label_area_size(48)
            .build_cartesian_2d(0.0..most, 0.0..bars.len() as f64)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .bold_line_style(GRID)
        .light_line_style(WHITE)
        .x_desc(label)
        .draw()?;
    for (i, (name, value, color)) in bars.iter().enumerate() {
        let y = (bars.len() - 1 - i) as f64;
        chart.draw_series([Rectangle::new(
            [(0.0, y + 0.2), (*value, y + 0.8)],
            color.filled(),
        )])?;
        let right = ("sans-serif", 12)
            .into_font()
            .color(&BLACK)
            .pos(Pos::new(HPos::Right, VPos::Center));
        let left = right.clone().pos(Pos::new(HPos::Left, VPos::Center));
        chart.draw_series([
            EmptyElement::at((0.0, y + 0.5)) + Text::new(name.clone(), (-8, 0), right)
        ])?;
        chart
            .draw_series([EmptyElement::at((*value, y + 0.5))
                + Text::new(format!("{value:.2}"), (5, 0), left)])?;
    }
    root.present()?;
    println!("{}", file.display());
    Ok(())
}
