//! Charts of thin layers, an SVG and its numbers as CSV each: error of their color over cost, by representation; environment light.
//!
//! `cargo run -p plumage_tools --bin iridescence_charts [folder]` (default `docs/charts`). Errors are CIEDE2000 against the transfer
//! matrix, 0 to 80 degrees, every stack exposed to a luminance of 0.6.

mod environment;
mod film;

use bevy_plumage::maths::scattering::interference::*;
use plumage_reference::color_difference::{delta_e_2000, lab};
use plumage_tests::shipped::stacks;
use plumage_tools::plot::{Curve, Labels, Result, draw, processor};
use rayon::prelude::*;
use std::{env, fs, hint::black_box, path::Path, time::Instant};

/// Steps of an eightieth of the range, one degree.
const ANGLES: usize = 81;
/// Lookups that are timed.
const LOOKUPS: u32 = 200_000;

/// A stack, and the colors that it really has.
pub struct Truth {
    /// Of `assets/stacks.ron`.
    pub name: String,
    /// Its layers.
    pub layers: Iridescence,
    /// Colors at one-degree steps, with their sign.
    pub colors: Vec<[f64; 3]>,
    /// What a luminance of 0.6 is reached by.
    exposure: f64,
}

fn cosine(degree: usize) -> f64 {
    (degree as f64).to_radians().cos()
}

impl Truth {
    fn new(name: String, layers: Iridescence) -> Self {
        let cosines: Vec<f64> = (0..ANGLES).map(cosine).collect();
        let colors = stack_colors(&Stack::new(&layers), &cosines);
        let luminance = |c: &[f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let brightest = colors[..=60].iter().map(luminance).fold(0.0, f64::max);
        Self {
            name,
            layers,
            colors,
            exposure: 0.6 / brightest,
        }
    }

    /// CIEDE2000 of a form at every angle.
    fn errors(&self, form: impl Fn(f64) -> [f64; 3]) -> Vec<f64> {
        let seen = |c: [f64; 3]| lab(c.map(|x| x * self.exposure));
        let error = |(i, truth): (usize, &[f64; 3])| {
            delta_e_2000(seen(form(cosine(i))), seen(in_gamut(*truth)))
        };
        self.colors.iter().enumerate().map(error).collect()
    }
}

/// Mean and 95th percentile.
pub fn summary(mut errors: Vec<f64>) -> [f64; 2] {
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    [mean, errors[errors.len() * 95 / 100]]
}

/// Nanoseconds of one lookup, the best of many runs.
fn nanoseconds(form: impl Fn(f64) -> [f64; 3]) -> f64 {
    (0..10)
        .map(|_| {
            let start = Instant::now();
            for i in 0..LOOKUPS {
                let c = f64::from(i) * 0.618_033_988_75;
                black_box(form(black_box(c.fract())));
            }
            start.elapsed().as_secs_f64() * 1e9 / f64::from(LOOKUPS)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Chebyshev series of a degree in `2 c - 1`, least squares over the angles.
struct Polynomial(Vec<[f64; 3]>);

impl Polynomial {
    fn basis(degree: usize, cosine: f64) -> Vec<f64> {
        let x = 2.0 * cosine - 1.0;
        let mut list = vec![1.0, x];
        for k in 2..=degree {
            list.push(2.0 * x * list[k - 1] - list[k - 2]);
        }
        list.truncate(degree + 1);
        list
    }

    fn fit(truth: &Truth, degree: usize) -> Self {
        let n = degree + 1;
        let mut rows = vec![vec![0.0; n + 3]; n];
        for (i, color) in truth.colors.iter().enumerate() {
            let basis = Self::basis(degree, cosine(i));
            for (row, a) in rows.iter_mut().zip(&basis) {
                for (cell, b) in row.iter_mut().zip(&basis) {
                    *cell += a * b;
                }
                for (cell, c) in row[n..].iter_mut().zip(color) {
                    *cell += a * c;
                }
            }
        }
        // Gauss and Jordan; the system is small and positive definite.
        for k in 0..n {
            let pivot = rows[k].clone();
            for (i, row) in rows.iter_mut().enumerate() {
                let factor = row[k] / pivot[k];
                if i != k {
                    row.iter_mut()
                        .zip(&pivot)
                        .for_each(|(x, p)| *x -= factor * p);
                }
            }
        }
        let solved = rows.iter().enumerate();
        Self(
            solved
                .map(|(k, row)| [0, 1, 2].map(|c| row[n + c] / row[k]))
                .collect(),
        )
    }

    fn color(&self, cosine: f64) -> [f64; 3] {
        // Clenshaw 1955.
        let x = 2.0 * cosine - 1.0;
        let (mut b1, mut b2) = ([0.0; 3], [0.0; 3]);
        for k in self.0[1..].iter().rev() {
            let b = [0, 1, 2].map(|c| k[c] + 2.0 * x * b1[c] - b2[c]);
            (b2, b1) = (b1, b);
        }
        in_gamut([0, 1, 2].map(|c| self.0[0][c] + x * b1[c] - b2[c]))
    }
}

/// Mean and 95th percentile of a form over all stacks, and what a lookup costs.
fn judged<F: Fn(f64) -> [f64; 3]>(truths: &[Truth], make: impl Fn(&Truth) -> F + Sync) -> [f64; 3] {
    let errors: Vec<f64> = truths
        .par_iter()
        .flat_map(|truth| truth.errors(make(truth)))
        .collect();
    let [mean, high] = summary(errors);
    [nanoseconds(make(&truths[0])), mean, high]
}

/// Lightness, chroma and hue of the presets, exposed alike.
fn hues(truths: &[Truth]) {
    for truth in truths {
        let at = |degree: usize| {
            let color = in_gamut(truth.colors[degree]).map(|x| x * truth.exposure);
            let [l, a, b] = lab(color);
            let hue = b.atan2(a).to_degrees().rem_euclid(360.0);
            format!("{degree} degrees: L {l:.0} C {:.0} h {hue:.0}", a.hypot(b))
        };
        println!("{:17} {}", truth.name, [0, 30, 60].map(at).join(", "));
    }
}

fn forms(folder: &Path, truths: &[Truth]) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut add = |family: &str, points: Vec<(String, [f64; 3])>| {
        for (name, [cost, mean, high]) in &points {
            println!("{family} {name}: {cost:.1} ns, mean {mean:.3}, 95 % {high:.3}");
        }
        let line = |k: usize| points.iter().map(|(_, p)| (p[0], p[k].max(1e-3))).collect();
        curves.push((format!("{family}, mean"), line(1)));
        curves.push((format!("{family}, 95 %"), line(2)));
    };
    let table = |texels: usize| {
        let found = judged(truths, |truth| {
            let table = StackTable::with_texels(&truth.layers, texels);
            move |cosine: f64| table.color(cosine)
        });
        (format!("{texels} texels"), found)
    };
    add("table", [16, 32, 64, 128].map(table).to_vec());
    let polynomial = |degree: usize| {
        let found = judged(truths, |truth| {
            let fit = Polynomial::fit(truth, degree);
            move |cosine: f64| fit.color(cosine)
        });
        (format!("degree {degree}"), found)
    };
    add("polynomial", [5, 6, 8, 10].map(polynomial).to_vec());
    let film = judged(truths, |truth| {
        let film = film::Fitted::to(&truth.colors, cosine);
        move |cosine: f64| film.color(cosine)
    });
    add(
        "one film at three wavelengths",
        vec![("fitted".into(), film)],
    );
    draw(
        &folder.join("iridescence_forms.svg"),
        &Labels {
            title: "Color of thin layers: error over cost, 19 stacks, 0 to 80 degrees",
            x: "nanoseconds a lookup, one core, double precision",
            y: "CIEDE2000",
        },
        [true, true],
        &curves,
    )
}

/// Rows of a table over the thickness: what lies between them.
fn scales(folder: &Path) -> Result<()> {
    let names = ["peacock_green", "bronzewing"];
    let range: [f64; 2] = [0.8, 1.25];
    let mut curves: Vec<Curve> = Vec::new();
    for (name, layers) in stacks() {
        if !names.contains(&name.as_str()) {
            continue;
        }
        // Places between the rows of every table.
        let places: Vec<f64> = (0..12)
            .map(|i| range[0] * (range[1] / range[0]).powf((f64::from(i) + 0.37) / 12.0))
            .collect();
        let truths: Vec<Truth> = places
            .par_iter()
            .map(|scale| {
                let scale = *scale as f32;
                Truth::new(name.clone(), Iridescence { scale, ..layers })
            })
            .collect();
        let full = StackTable::scaled(&layers, range);
        let mut points = Vec::new();
        for every in [1, 2, 4] {
            let columns = full.columns();
            let rows = (0..full.rows).step_by(every);
            let texels = rows
                .clone()
                .flat_map(|r| full.texels[r * columns..][..columns].to_vec());
            let table = StackTable {
                texels: texels.collect(),
                rows: rows.len(),
                scales: range,
            };
            let errors = truths
                .iter()
                .zip(&places)
                .flat_map(|(truth, scale)| truth.errors(|c| table.look(c, *scale).color))
                .collect();
            let [mean, high] = summary(errors);
            println!(
                "{name}, {} rows: mean {mean:.3}, 95 % {high:.3}",
                table.rows
            );
            points.push((table.rows as f64, high));
        }
        curves.push((name, points));
    }
    draw(
        &folder.join("iridescence_rows.svg"),
        &Labels {
            title: "Thickness over a feather: 95th percentile of the error, factors 0.8 to 1.25",
            x: "rows of 32 texels",
            y: "CIEDE2000",
        },
        [false, true],
        &curves,
    )
}

fn main() -> Result<()> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    println!("timed on {}", processor());
    let truths: Vec<Truth> = stacks()
        .into_par_iter()
        .map(|(name, layers)| Truth::new(name, layers))
        .collect();
    hues(&truths);
    forms(folder, &truths)?;
    scales(folder)?;
    environment::chart(folder, &truths)
}
