//! What simplifications cost: error against time or memory.

use super::{direction, energy::sphere, published, structural};
use bevy_plumage::maths::scattering::*;
use plumage_reference::curves::near_field;
use plumage_reference::fibre_published::published_evaluate;
use plumage_reference::fibre_traced::uniform;
use plumage_tools::plot::{Curve, Labels, Result, draw, processor};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, hint::black_box, path::Path, time::Instant};

/// Seconds per call, the best of many runs.
fn time(calls: u32, mut body: impl FnMut(u32) -> f64) -> f64 {
    (0..20)
        .map(|_| {
            let start = Instant::now();
            let sum: f64 = (0..calls).map(&mut body).sum();
            black_box(sum);
            start.elapsed().as_secs_f64() / f64::from(calls)
        })
        .fold(f64::INFINITY, f64::min)
}

const ALBEDO: [f64; 3] = [0.7, 0.3, 0.08];

/// The three fibres of the charts.
fn fibres() -> [(&'static str, Fibre); 3] {
    [
        (
            "structural, core 0.5",
            Fibre {
                azimuthal_roughness: 0.4,
                ..structural(0.5)
            },
        ),
        (
            "structural, core 0.8",
            Fibre {
                azimuthal_roughness: 0.4,
                ..structural(0.8)
            },
        ),
        (
            "pigment",
            Fibre {
                tilt: 0.0,
                ..Fibre::default()
            },
        ),
    ]
}

/// Directions at which far fields are compared: inclinations of the eye, and the lights for each.
fn places() -> Vec<(f64, f64, f64)> {
    let mut all = Vec::new();
    for theta_o in [0.05_f64, 0.5, 0.95, 1.25] {
        for shift in [-0.2, 0.1] {
            for k in 0..36 {
                all.push((
                    theta_o,
                    (shift - theta_o).clamp(-1.5, 1.5),
                    PI * (f64::from(k) + 0.5) / 36.0,
                ));
            }
        }
    }
    all
}

/// Far field by quadrature over the width, `nodes` midpoints, all colors.
fn quadrature(fibre: &Fibre, table: &FibreTable, place: (f64, f64, f64), nodes: u32) -> [f64; 3] {
    let (theta_o, theta_i, phi) = place;
    let mut sum = [0.0; 3];
    for i in 0..nodes {
        let h = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(nodes);
        let k = near_field(
            fibre,
            table,
            ALBEDO,
            direction(theta_o, 0.0),
            direction(theta_i, phi),
            h,
            0.0,
        );
        (0..3).for_each(|c| sum[c] += k[c] / f64::from(nodes));
    }
    sum
}

/// L1 distance of two far fields over the places, relative to the first.
fn distance(truth: &[[f64; 3]], other: impl Fn(usize) -> [f64; 3]) -> f64 {
    let (mut error, mut scale) = (0.0, 0.0);
    for (i, t) in truth.iter().enumerate() {
        let o = other(i);
        for c in 0..3 {
            error += (t[c] - o[c]).abs();
            scale += t[c];
        }
    }
    error / scale
}

/// A row of the table as a table of only `rows` rows would give it: every so manieth row of the sixteen.
fn thinned(table: &FibreTable, rows: usize, cos_theta: f64) -> FibreRow<f64> {
    let step = (FIBRE_ROWS - 1) / (rows - 1);
    let (i, f) = fibre_row_at(cos_theta);
    let at = i as f64 + f;
    let low = ((at / step as f64) as usize).min(rows - 2);
    let fraction = at / step as f64 - low as f64;
    fibre_row_mix(
        &table.rows[low * step],
        &table.rows[(low + 1) * step],
        fraction,
    )
}

/// Tiers (harmonics), table rows and quadrature orders of the far field.
pub fn far_field(folder: &Path) -> Result<()> {
    let places = places();
    let (mut tiers, mut rows, mut orders): (Vec<Curve>, Vec<Curve>, Vec<Curve>) =
        Default::default();
    for (name, fibre) in fibres() {
        let table = FibreTable::build(&fibre);
        let p = table.fibre();
        let truth: Vec<_> = places
            .iter()
            .map(|&at| quadrature(&fibre, &table, at, 1200))
            .collect();
        let series = |row: FibreRow<f64>, at: (f64, f64, f64), harmonics: u32| {
            let s = fibre_shading(&p, &row, ALBEDO, direction(at.0, 0.0), 0.0, harmonics);
            fibre_evaluate(&s, direction(at.1, at.2))
        };
        let mut points = Vec::new();
        for harmonics in [1, 2, 3, 4, 5, 6, 8] {
            let error = distance(&truth, |i| {
                series(table.row(places[i].0.cos()), places[i], harmonics)
            });
            println!("{name}: {harmonics} harmonics, L1 {error:.4}");
            points.push((f64::from(harmonics), error));
        }
        tiers.push((name.into(), points));
        let points = [2, 4, 6, 16].map(|n| {
            let error = distance(&truth, |i| {
                series(thinned(&table, n, places[i].0.cos()), places[i], 8)
            });
            (n as f64 * FIBRE_ROW_VEC4S as f64 * 16.0, error)
        });
        rows.push((name.into(), points.to_vec()));
        let mut points = Vec::new();
        for nodes in [4, 8, 16, 32, 64, 128] {
            let error = distance(&truth, |i| quadrature(&fibre, &table, places[i], nodes));
            let seconds = time(400, |i| {
                quadrature(&fibre, &table, places[i as usize % places.len()], nodes)[0]
            });
            points.push((seconds * 1e9, error));
        }
        orders.push((format!("midpoints over h, {name}"), points));
        let error = distance(&truth, |i| {
            series(table.row(places[i].0.cos()), places[i], 8)
        });
        let row = table.row(0.8);
        let s = fibre_shading(&p, &row, ALBEDO, direction(0.6, 0.0), 0.0, 8);
        let seconds = time(20_000, |i| {
            fibre_evaluate(black_box(&s), direction(0.3, f64::from(i) * 0.001))[0]
        });
        println!(
            "{name}: series of 8 terms L1 {error:.4}, {:.0} ns a light",
            seconds * 1e9
        );
        orders.push((format!("series, {name}"), vec![(seconds * 1e9, error)]));
    }
    let labels = Labels {
        title: "Far field: error by number of harmonics (truth: 1200 midpoints)",
        x: "harmonics",
        y: "relative L1 error",
    };
    draw(
        &folder.join("scattering_tiers.svg"),
        &labels,
        [false, true],
        &tiers,
    )?;
    let labels = Labels {
        title: "Far field: error by size of a fibre's table (2, 4, 6, 16 rows)",
        x: "bytes of one fibre's table",
        y: "relative L1 error",
    };
    draw(
        &folder.join("scattering_rows.svg"),
        &labels,
        [true, true],
        &rows,
    )?;
    let title = format!(
        "Far field, three channels, one light: error over time on {}",
        processor()
    );
    let labels = Labels {
        title: &title,
        x: "nanoseconds",
        y: "relative L1 error",
    };
    draw(
        &folder.join("scattering_orders.svg"),
        &labels,
        [true, true],
        &orders,
    )
}

/// The printed model by quadrature against the series: one channel against three.
pub fn published_cost(folder: &Path) -> Result<()> {
    let truth = published(0.8, 4000);
    let angle = |k: i32| f64::from(k) * PI / 90.0;
    let scale: f64 = (0..90)
        .map(|k| published_evaluate(&truth, 0.0, 0.0, angle(k)))
        .sum();
    let mut points = Vec::new();
    for nodes in [8, 16, 32, 64, 128] {
        let f = published(0.8, nodes);
        let difference = |k: i32| {
            let phi = angle(k);
            (published_evaluate(&f, 0.0, 0.0, phi) - published_evaluate(&truth, 0.0, 0.0, phi))
                .abs()
        };
        let error = (0..90).map(difference).sum::<f64>() / scale;
        let seconds = time(20_000, |i| {
            published_evaluate(&f, 0.3, 0.2, f64::from(i) * 0.001)
        });
        points.push((seconds * 1e9, error));
    }
    let title = format!(
        "The printed far field, one channel, one light, on {}",
        processor()
    );
    let labels = Labels {
        title: &title,
        x: "nanoseconds",
        y: "relative L1 error",
    };
    draw(
        &folder.join("scattering_cost.svg"),
        &labels,
        [true, true],
        &[("midpoints over h".into(), points)],
    )
}

/// A sky with a bright patch, brightest above.
fn sky(d: [f64; 3]) -> f64 {
    let l = (0.5_f64.powi(2) + 0.8 * 0.8 + 0.33 * 0.33).sqrt();
    let patch = (d[0] * 0.5 + d[1] * 0.8 + d[2] * 0.33) / l;
    0.3 + 0.7 * d[2].max(0.0) + 4.0 * ((patch - 1.0) / 0.03).exp()
}

/// Environment light on a fibre by samples: importance sampling with random numbers and with a lattice, and plain uniform directions.
pub fn environment(folder: &Path) -> Result<()> {
    let table = FibreTable::build(&structural(0.8));
    let counts = [1, 2, 4, 8, 16, 32, 64, 128];
    let mut sums = [[0.0; 8]; 3];
    let mut random = Pcg64Mcg::new(5);
    let eyes = [(0.1, 0.2), (0.6, 1.0), (1.2, -0.5), (-0.4, 2.5)];
    for (theta, phi) in eyes {
        let eye = direction(theta, phi);
        let s = fibre_shading(&table.fibre(), &table.row(theta.cos()), ALBEDO, eye, 0.0, 8);
        let truth = sphere(700, 700, |t, p| {
            let d = direction(t, p);
            fibre_evaluate(&s, d)[0] * sky(d)
        });
        for (k, &n) in counts.iter().enumerate() {
            let runs = 300;
            for _ in 0..runs {
                let shift: [f64; 4] = std::array::from_fn(|_| uniform(&mut random));
                let mut estimates = [0.0; 3];
                for i in 0..n {
                    let mut lattice = shift;
                    let mut step = 1.0;
                    for x in &mut lattice {
                        // Powers of the root of g^6 = g + 1.
                        step /= 1.134_724_138_401_519_4;
                        *x = (*x + f64::from(i) * step).fract();
                    }
                    // The lobe is drawn in equal steps.
                    lattice[0] = ((f64::from(i) + shift[0]) / f64::from(n)).fract();
                    let plain = std::array::from_fn(|_| uniform(&mut random));
                    for (e, u) in [plain, lattice].into_iter().enumerate() {
                        if let Some(sample) = fibre_sample(&s, u) {
                            estimates[e] += sample.weight[0] * sky(sample.direction) / f64::from(n);
                        }
                    }
                    let z: f64 = 2.0 * uniform(&mut random) - 1.0;
                    let a = 2.0 * PI * uniform(&mut random);
                    let r = (1.0 - z * z).sqrt();
                    let d = [r * a.cos(), r * a.sin(), z];
                    estimates[2] += fibre_evaluate(&s, d)[0] * sky(d) * 4.0 * PI / f64::from(n);
                }
                for (sum, e) in sums.iter_mut().zip(estimates) {
                    sum[k] += (e / truth - 1.0).powi(2) / f64::from(runs * eyes.len() as u32);
                }
            }
        }
    }
    let curve = |sum: [f64; 8]| {
        counts
            .iter()
            .zip(sum)
            .map(|(&n, s)| (f64::from(n), s.sqrt()))
            .collect()
    };
    let [random, lattice, plain] = sums.map(curve);
    let curves: Vec<Curve> = vec![
        ("K, random".into(), random),
        ("K, lattice".into(), lattice),
        ("uniform directions".into(), plain),
    ];
    let labels = Labels {
        title: "Environment light on a fibre, unfiltered: RMS error by samples",
        x: "samples",
        y: "relative RMS error",
    };
    draw(
        &folder.join("scattering_environment.svg"),
        &labels,
        [true, true],
        &curves,
    )
}

/// Sheen by the size of its table: every so manieth of the 32 cosines.
pub fn sheen_table_size(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    for alpha in [0.3, 0.5, 0.8] {
        let row = sheen_row(alpha);
        let mut list = Vec::new();
        for steps in [15_u32, 10, 6, 5, 3, 2, 1] {
            let count = SHEEN_TABLE_SIZE - 1;
            let mut error = 0.0_f64;
            for (i, full) in row.iter().enumerate() {
                let knots = f64::from(steps);
                let at = i as f64 / count as f64 * knots;
                let low = (at as u32).min(steps - 1);
                let knot = |k: u32| {
                    let x = f64::from(k) / knots;
                    sheen_lookup(x, f64::from(alpha))[2]
                };
                let f = at - f64::from(low);
                let r = knot(low) + (knot(low + 1) - knot(low)) * f;
                error = error.max((r - f64::from(full[2])).abs());
            }
            list.push((f64::from(steps + 1) * 16.0, error));
        }
        curves.push((format!("roughness {alpha}"), list));
    }
    let labels = Labels {
        title: "Sheen: largest error of its albedo by the size of its row (full: 512 bytes)",
        x: "bytes of one feather's row",
        y: "error of the albedo",
    };
    draw(
        &folder.join("scattering_sheen_rows.svg"),
        &labels,
        [true, true],
        &curves,
    )
}
