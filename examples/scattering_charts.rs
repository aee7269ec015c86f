//! Charts of the scattering model, one SVG each: energy kept, the lobes against traced rays, the cost.
//!
//! `cargo run --release --example scattering_charts [folder]` (default `docs/charts`)

use bevy_plumage::scattering::{
    published::{PublishedFibre, published_evaluate},
    reference::TracedFibre,
    *,
};
use plotters::prelude::*;
use rand_pcg::Pcg64Mcg;
use std::{env, error::Error, f64::consts::PI, fs, hint::black_box, path::Path, time::Instant};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A named curve.
type Curve = (String, Vec<(f64, f64)>);

const COLOURS: [RGBColor; 4] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(120, 120, 120),
];

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
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    println!("{}", file.display());
    Ok(())
}

fn structural(core_radius: f32) -> Fibre {
    Fibre {
        kind: FibreKind::Structural { core_radius },
        tilt: 0.0,
        azimuthal_roughness: 0.3,
        ..Fibre::default()
    }
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [
        theta.sin(),
        theta.cos() * phi.sin(),
        theta.cos() * phi.cos(),
    ]
}

fn shade(fibre: &Fibre, theta: f64) -> FibreShading<f64> {
    let table = FibreTable::build(fibre);
    let row = table.row(theta.cos());
    let mut s = fibre_shading(
        &table.fibre(),
        &row,
        [1.0; 3],
        direction(theta, 0.0),
        0.0,
        8,
    );
    // A perfectly white core; an albedo stops at 0.995.
    s.energy = row[0].map(|e| [e; 3]);
    s
}

/// Integral over the sphere of a density in (theta_i, phi).
fn sphere(density: impl Fn(f64, f64) -> f64) -> f64 {
    let (rings, sectors) = (1500, 32);
    let mut sum = 0.0;
    for i in 0..rings {
        let theta = PI * ((f64::from(i) + 0.5) / f64::from(rings) - 0.5);
        for k in 0..sectors {
            let phi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(sectors);
            sum += density(theta, phi) * theta.cos();
        }
    }
    sum * 2.0 * PI * PI / f64::from(rings * sectors)
}

fn furnace(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let angles: Vec<f64> = (0..32).map(|i| 1.55 * f64::from(i) / 31.0).collect();
    for core in [0.5, 0.8] {
        let ours = angles.iter().map(|&t| {
            let s = shade(&structural(core), t);
            (
                t,
                sphere(|theta, phi| fibre_evaluate(&s, direction(theta, phi))[0]),
            )
        });
        curves.push((format!("this crate, core {core}"), ours.collect()));
        let f = published(f64::from(core), 48);
        let printed = angles.iter().map(|&t| {
            (
                t,
                sphere(|theta, phi| published_evaluate(&f, theta, t, phi)),
            )
        });
        curves.push((format!("as printed, core {core}"), printed.collect()));
    }
    let title = "White fibre in a white furnace (1 = all light comes back)";
    draw(
        &folder.join("scattering_furnace.svg"),
        title,
        ["theta_o (radians)", "albedo"],
        (0.0, 1.6),
        (0.4, 1.1),
        &curves,
    )
}

fn published(core: f64, nodes: usize) -> PublishedFibre {
    PublishedFibre {
        eta: 1.55,
        core,
        reflectance: 1.0,
        absorption: 0.0,
        longitudinal_roughness: 0.2,
        azimuthal_roughness: 0.3,
        tilt: 0.0,
        nodes,
    }
}

fn azimuth(folder: &Path) -> Result<()> {
    let mut random = Pcg64Mcg::new(1);
    let bins = 120;
    for core in [0.5, 0.8] {
        let traced = TracedFibre {
            inner: core,
            mirror: Some(1.0),
            normal_spread: 0.15,
            ..TracedFibre::clear(1.55)
        };
        let histogram = traced.histogram(0.0, 0.0, 400_000, bins, &mut random);
        let s = shade(&structural(core as f32), 0.0);
        let row = FibreTable::build(&structural(core as f32)).row(1.0);
        let place = |i: usize| -PI + 2.0 * PI * (i as f64 + 0.5) / bins as f64;
        let truth = (0..bins)
            .map(|i| (place(i), histogram.iter().map(|lobe| lobe[i]).sum()))
            .collect();
        let model = |phi: f64| {
            [(0, 0), (1, 1), (2, 3), (3, 4)]
                .iter()
                .map(|&(lobe, series)| row[0][lobe] * azimuthal(&s.series[series], phi.cos()))
                .sum::<f64>()
                / (2.0 * PI)
        };
        let curves = [
            ("traced rays".into(), truth),
            (
                "cosine series, 8 terms".into(),
                (0..bins).map(|i| (place(i), model(place(i)))).collect(),
            ),
        ];
        let file = folder.join(format!(
            "scattering_azimuth_{:02}.svg",
            (core * 10.0_f64).round()
        ));
        let title = format!("Light around a white structural fibre, core {core}, broadside");
        draw(
            &file,
            &title,
            ["phi (radians)", "density per radian"],
            (-PI, PI),
            (0.0, 0.45),
            &curves,
        )?;
    }
    Ok(())
}

/// Seconds per call, the best of five runs.
fn time(calls: u32, mut body: impl FnMut(u32) -> f64) -> f64 {
    (0..5)
        .map(|_| {
            let start = Instant::now();
            let sum: f64 = (0..calls).map(&mut body).sum();
            black_box(sum);
            start.elapsed().as_secs_f64() / f64::from(calls)
        })
        .fold(f64::INFINITY, f64::min)
}

fn cost(folder: &Path) -> Result<()> {
    // Error of the far field against many nodes, and the time it takes, one colour channel each.
    let truth = published(0.8, 4000);
    let scale: f64 = (0..90)
        .map(|k| published_evaluate(&truth, 0.0, 0.0, f64::from(k) * PI / 90.0))
        .sum();
    let mut curve = Vec::new();
    for nodes in [8, 16, 32, 64, 128] {
        let f = published(0.8, nodes);
        let difference = |k: i32| {
            let phi = f64::from(k) * PI / 90.0;
            (published_evaluate(&f, 0.0, 0.0, phi) - published_evaluate(&truth, 0.0, 0.0, phi))
                .abs()
        };
        let error = (0..90).map(difference).sum::<f64>() / scale;
        let seconds = time(20_000, |i| {
            published_evaluate(&f, 0.3, 0.2, f64::from(i) * 0.001)
        });
        println!(
            "midpoints {nodes}: error {error:.4}, {:.0} ns",
            seconds * 1e9
        );
        curve.push((seconds.log10() + 9.0, error.log10()));
    }
    let table = FibreTable::build(&structural(0.8));
    let s = fibre_shading(
        &table.fibre(),
        &table.row(1.0),
        [0.5; 3],
        direction(0.2, 0.0),
        0.0,
        8,
    );
    let seconds = time(200_000, |i| {
        fibre_evaluate(black_box(&s), direction(0.3, f64::from(i) * 0.001))[0]
    });
    let row = table.row(1.0);
    let series = shade(&structural(0.8), 0.0);
    let dense = published(0.8, 4000);
    let mut error = 0.0;
    let mut total = 0.0;
    for k in 0..90 {
        let phi = f64::from(k) * PI / 90.0;
        let mut exact = 0.0;
        for i in 0..dense.nodes {
            let c = crossing(
                1.55,
                1.0,
                -1.0 + 2.0 * (i as f64 + 0.5) / dense.nodes as f64,
            );
            let a = attenuation(&c, Some((0.8, 1.0)), (0.0, 0.0), 0.0);
            for (lobe, kind) in [(0, Lobe::R), (3, Lobe::TRcT)] {
                let x = (phi - exit_angle(kind, &c, 0.8)).rem_euclid(2.0 * PI);
                let spread = |x: f64| (-0.5 * (x / 0.3).powi(2)).exp() / (0.3 * (2.0 * PI).sqrt());
                exact += a[lobe] * (spread(x) + spread(x - 2.0 * PI)) / dense.nodes as f64;
            }
        }
        let model = (row[0][0] * azimuthal(&series.series[0], phi.cos())
            + row[0][3] * azimuthal(&series.series[4], phi.cos()))
            / (2.0 * PI);
        error += (model - exact).abs();
        total += exact;
    }
    println!(
        "series: error {:.1e}, {:.0} ns for three channels",
        error / total,
        seconds * 1e9
    );
    let ours = (seconds.log10() + 9.0, (error / total).log10());
    let curves = [
        ("midpoints over h, one channel".to_owned(), curve),
        (
            "cosine series, three channels".to_owned(),
            vec![(ours.0 - 0.03, ours.1), (ours.0 + 0.03, ours.1)],
        ),
    ];
    let title = "Far field of one fibre, one light: error against time";
    let labels = ["log10 time (ns)", "log10 error (L1)"];
    draw(
        &folder.join("scattering_cost.svg"),
        title,
        labels,
        (1.5, 4.5),
        (-6.0, 0.0),
        &curves,
    )
}

fn main() -> Result<()> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    furnace(folder)?;
    azimuth(folder)?;
    cost(folder)
}
