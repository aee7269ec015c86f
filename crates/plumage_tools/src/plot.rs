//! One SVG and one CSV per chart.

use plotters::prelude::*;
use std::{error::Error, fmt::Write, fs, path::Path};

/// What drawing may fail with.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A named curve.
pub type Curve = (String, Vec<(f64, f64)>);

const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(120, 120, 120),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(170, 140, 0),
];

/// What a chart says beside its curves.
pub struct Labels<'a> {
    /// Above the chart.
    pub title: &'a str,
    /// Along x.
    pub x: &'a str,
    /// Along y.
    pub y: &'a str,
}

/// The processor that timings come from.
pub fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = name.map(|n| n.trim_start_matches([' ', '\t', ':']).trim());
    name.unwrap_or(std::env::consts::ARCH).to_owned()
}

fn table(file: &Path, labels: &Labels, curves: &[Curve]) -> Result<()> {
    let mut text = format!("# {}\ncurve,{},{}\n", labels.title, labels.x, labels.y);
    for (name, points) in curves {
        for (x, y) in points {
            writeln!(text, "\"{name}\",{x:.6e},{y:.6e}")?;
        }
    }
    fs::write(file.with_extension("csv"), text)?;
    println!("{}", file.display());
    Ok(())
}

/// Smallest and largest of the values, a little wider; powers of ten when `log`.
fn range(values: impl Iterator<Item = f64>, log: bool) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite() && (!log || *v > 0.0))
        .fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return (0.1, 1.0);
    }
    if log {
        return (low * 0.7, high * 1.5);
    }
    let margin = 0.06 * (high - low).max(1e-9);
    (low - margin, high + margin)
}

/// Draws curves with marks, on logarithmic axes where asked for, and writes their numbers.
pub fn draw(file: &Path, labels: &Labels, log: [bool; 2], curves: &[Curve]) -> Result<()> {
    table(file, labels, curves)?;
    let all = || curves.iter().flat_map(|(_, points)| points);
    let x = range(all().map(|p| p.0), log[0]);
    let y = range(all().map(|p| p.1), log[1]);
    let root = SVGBackend::new(file, (760, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut builder = ChartBuilder::on(&root);
    builder
        .caption(labels.title, ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(38)
        .y_label_area_size(64);
    macro_rules! with {
        ($x:expr, $y:expr) => {{
            let mut chart = builder.build_cartesian_2d($x, $y)?;
            chart
                .configure_mesh()
                .x_desc(labels.x)
                .y_desc(labels.y)
                .light_line_style(WHITE)
                .y_label_formatter(&|v| number(*v))
                .x_label_formatter(&|v| number(*v))
                .draw()?;
            for (i, (name, points)) in curves.iter().enumerate() {
                let color = COLORS[i % COLORS.len()];
                chart
                    .draw_series(LineSeries::new(
                        points.iter().copied(),
                        color.stroke_width(2),
                    ))?
                    .label(name)
                    .legend(move |(x, y)| {
                        PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                    });
                if points.len() <= 24 {
                    chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, color.filled())))?;
                }
            }
            chart
                .configure_series_labels()
                .position(corner(curves, x, y, log))
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK.mix(0.3))
                .draw()?;
        }};
    }
    match log {
        [false, false] => with!(x.0..x.1, y.0..y.1),
        [true, false] => with!((x.0..x.1).log_scale(), y.0..y.1),
        [false, true] => with!(x.0..x.1, (y.0..y.1).log_scale()),
        [true, true] => with!((x.0..x.1).log_scale(), (y.0..y.1).log_scale()),
    }
    root.present()?;
    Ok(())
}

fn number(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e4).contains(&v.abs()) {
        return format!("{v:.0e}");
    }
    let text = format!("{v:.5}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The corner with the fewest points in it, for the legend.
fn corner(curves: &[Curve], x: (f64, f64), y: (f64, f64), log: [bool; 2]) -> SeriesLabelPosition {
    let place = |v: f64, (low, high): (f64, f64), log: bool| {
        let f = |v: f64| if log { v.max(1e-300).ln() } else { v };
        (f(v) - f(low)) / (f(high) - f(low))
    };
    let mut counts = [0; 4];
    for (_, points) in curves {
        for p in points {
            let (a, b) = (place(p.0, x, log[0]), place(p.1, y, log[1]));
            for (k, corner) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
                .into_iter()
                .enumerate()
            {
                if (a - corner.0).abs() < 0.45
                    && (b - corner.1).abs() < 0.05 + 0.055 * curves.len() as f64
                {
                    counts[k] += 1;
                }
            }
        }
    }
    let best = (0..4).min_by_key(|&k| counts[k]).unwrap_or(1);
    [
        SeriesLabelPosition::LowerLeft,
        SeriesLabelPosition::UpperLeft,
        SeriesLabelPosition::LowerRight,
        SeriesLabelPosition::UpperRight,
    ][best]
        .clone()
}

/// Curves around a circle, four panels: the point (angle, radius) of each curve, angle 0 to the right, counter-clockwise.
pub fn polar(file: &Path, labels: &Labels, panels: &[(String, Vec<Curve>)]) -> Result<()> {
    let flat: Vec<Curve> = panels
        .iter()
        .flat_map(|(panel, curves)| {
            curves
                .iter()
                .map(move |(name, points)| (format!("{panel}: {name}"), points.clone()))
        })
        .collect();
    table(file, labels, &flat)?;
    let root = SVGBackend::new(file, (920, 900)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(labels.title, ("sans-serif", 18))?;
    let areas = root.split_evenly((2, 2));
    for (area, (panel, curves)) in areas.iter().zip(panels) {
        let largest = curves
            .iter()
            .flat_map(|(_, p)| p)
            .map(|p| p.1)
            .fold(1e-9, f64::max)
            * 1.08;
        let mut chart = ChartBuilder::on(area)
            .caption(panel, ("sans-serif", 15))
            .margin(10)
            .build_cartesian_2d(-largest..largest, -largest..largest)?;
        for ring in [0.25, 0.5, 0.75, 1.0] {
            let r = ring * largest / 1.08;
            let circle = (0..=180).map(|i| {
                let a = f64::from(i) * std::f64::consts::PI / 90.0;
                (r * a.cos(), r * a.sin())
            });
            chart.draw_series(LineSeries::new(circle, BLACK.mix(0.12)))?;
            let text = Text::new(
                number(r),
                (0.02 * largest, r),
                ("sans-serif", 11).into_font().color(&BLACK.mix(0.5)),
            );
            chart.draw_series([text])?;
        }
        let axis = |a: [(f64, f64); 2]| LineSeries::new(a, BLACK.mix(0.25));
        chart.draw_series(axis([(-largest, 0.0), (largest, 0.0)]))?;
        chart.draw_series(axis([(0.0, -largest), (0.0, largest)]))?;
        for (i, (name, points)) in curves.iter().enumerate() {
            let color = COLORS[i % COLORS.len()];
            let line = points.iter().map(|&(a, r)| (r * a.cos(), r * a.sin()));
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))?
                .label(name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                });
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    root.present()?;
    Ok(())
}
