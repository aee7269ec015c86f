//! Footprints that slowly change scale, direction, shape, or are seen from a turning view: the error has to follow smoothly.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{Cell, Local, Vane, mask_vane, reduce};
use plumage_tests::{
    stability::{self, Step},
    sweep::{self, between},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Paths per test and steps per path.
const PATHS: usize = 20;
const STEPS: usize = 120;
/// Halvings of a step in the search for the place where the error jumps.
const HALVINGS: usize = 12;

type Place = Box<dyn Fn(f64) -> (f64, Cell<f64>, Local<f64>)>;

fn step(at: &Place, x: f64) -> Step {
    let (label, cell, local) = at(x);
    Step::new(label, &cell, &local)
}

/// What is left of a step's change of the error where the step becomes a four-thousandth of itself: a jump, not a slope.
fn close_in(at: &Place, mut low: f64, mut high: f64) -> f64 {
    let (mut a, mut b) = (step(at, low), step(at, high));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let m = step(at, middle);
        if stability::jump(&a, &m)[0] > stability::jump(&m, &b)[0] {
            (high, b) = (middle, m);
        } else {
            (low, a) = (middle, m);
        }
    }
    stability::jump(&a, &b)[0]
}

/// Walks random paths; prints the largest change of the error between neighboring steps and the largest jump, and holds the
/// jump and the 99th percentile of the changes against the bounds.
fn check(
    name: &str,
    label: &str,
    seed: u64,
    bounds: [f64; 2],
    mut path: impl FnMut(&mut Pcg64Mcg, usize) -> Place,
) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut worst = (0.0, 0.0, Vec::new());
    let mut changes = Vec::new();
    for i in 0..PATHS {
        let at = path(&mut random, i);
        let steps: Vec<Step> = (0..=STEPS)
            .map(|j| step(&at, j as f64 / STEPS as f64))
            .collect();
        for (j, pair) in steps.windows(2).enumerate() {
            let change = stability::jump(&pair[0], &pair[1])[0];
            changes.push(change);
            if change > 0.25 * bounds[0] && change > worst.0 {
                let jump = close_in(&at, j as f64 / STEPS as f64, (j + 1) as f64 / STEPS as f64);
                if jump > worst.0 {
                    worst = (jump, pair[0].at, Vec::new());
                }
            }
        }
        if worst.2.is_empty() {
            worst.2 = steps;
        }
    }
    changes.sort_by(f64::total_cmp);
    let high = changes[changes.len() * 99 / 100];
    let most = changes.last().copied().unwrap_or(0.0);
    let (jump, place, steps) = worst;
    eprintln!(
        "{name}: change of the error from step to step at most {most:.4}, 99th percentile {high:.5}; largest jump {jump:.4}"
    );
    if jump > bounds[0] || high > bounds[1] {
        let file = stability::failure_file(&format!("stability_{name}"));
        let title = format!("{name}: jump of {jump:.4} at {place:.3}");
        stability::draw(&file, &title, label, &steps, bounds[0]);
        panic!(
            "{title} (bound {}), 99th percentile {high} (bound {}), picture {}",
            bounds[0],
            bounds[1],
            file.display()
        );
    }
}

#[test]
fn scale() {
    check(
        "scale",
        "ln of the major axis in barb periods",
        301,
        [1.0 / 255.0, 1.0 / 255.0],
        |random, i| {
            let (cell, spacing, sin_bl) = sweep::random_cell(random, i % 2 == 1);
            let least = (0.01 * spacing * sin_bl).ln();
            let ratio = 2f64.powf(between(random, 0.0, 4.0));
            let angle = between(random, 0.0, std::f64::consts::PI);
            let (u, tau) = (between(random, 0.0, 1.0), between(random, -0.5, 0.5));
            Box::new(move |x| {
                let size = least + (10f64.ln() - least) * x;
                let major = size.exp();
                let local = sweep::local(u, tau, major, major / ratio, angle, spacing);
                (size, cell, local)
            })
        },
    );
}

#[test]
fn rotation() {
    check(
        "rotation",
        "direction of the major axis from the barb's normal, radians",
        302,
        [1.0 / 255.0, 1.0 / 255.0],
        |random, i| {
            let (cell, spacing, sin_bl) = sweep::random_cell(random, i % 2 == 1);
            let least = (0.1 * spacing * sin_bl).ln();
            let major = between(random, least, 4f64.ln()).exp();
            let ratio = 2f64.powf(between(random, 0.5, 4.0));
            let (u, tau) = (between(random, 0.0, 1.0), between(random, -0.5, 0.5));
            Box::new(move |x| {
                let angle = std::f64::consts::PI * x;
                let local = sweep::local(u, tau, major, major / ratio, angle, spacing);
                (angle, cell, local)
            })
        },
    );
}

#[test]
fn anisotropy() {
    check(
        "anisotropy",
        "major over minor axis",
        303,
        [1.0 / 255.0, 1.0 / 255.0],
        |random, i| {
            let (cell, spacing, sin_bl) = sweep::random_cell(random, i % 2 == 1);
            let least = (0.02 * spacing * sin_bl).ln();
            let minor = between(random, least, 1f64.ln()).exp();
            let angle = between(random, 0.0, std::f64::consts::PI);
            let (u, tau) = (between(random, 0.0, 1.0), between(random, -0.5, 0.5));
            Box::new(move |x| {
                let ratio = 1.0 + 15.0 * x;
                let local = sweep::local(u, tau, minor * ratio, minor, angle, spacing);
                (ratio, cell, local)
            })
        },
    );
}

#[test]
fn position() {
    // Small footprints meet every edge, corner and gap: each shortcut of NEAR begins and ends somewhere on the way.
    check(
        "position",
        "place across the barbs in periods",
        305,
        [1.0 / 255.0, 1.0 / 255.0],
        |random, i| {
            let (cell, spacing, sin_bl) = sweep::random_cell(random, i % 2 == 1);
            let least = (0.005 * spacing * sin_bl).ln();
            let minor = between(random, least, (0.3 * spacing * sin_bl).ln()).exp();
            let ratio = 2f64.powf(between(random, 0.0, 4.0));
            let angle = between(random, 0.0, std::f64::consts::PI);
            let (u, tau) = (between(random, 0.0, 1.0), between(random, -0.5, 0.5));
            // A few barbules' width at a time, so that no edge is passed in one step.
            let along = 4.0 * minor / (spacing * sin_bl);
            Box::new(move |x| {
                let (u, tau) = (u + 20.0 * minor * x, tau + 10.0 * along * x);
                let local = sweep::local(u, tau, minor * ratio, minor, angle, spacing);
                (u, cell, local)
            })
        },
    );
}

/// A vane of ordinary measures (100..600 barbs, 20..60 um between barbules; docs/book/range_queries.md#the-sweep).
pub fn random_vane(random: &mut Pcg64Mcg) -> Vane<f64> {
    Vane::from_measures(
        between(random, 100.0, 500.0),
        between(random, 25.0, 65.0),
        between(random, 10.0, 40.0),
        between(random, 20.0, 60.0),
        between(random, 25.0, 60.0),
        between(random, 3.0, 12.0),
        between(random, 3.0, 12.0),
        between(random, 40.0, 200.0),
    )
}

#[test]
fn view_angle() {
    // The card turns about an axis in its plane, so that the footprint grows across it and masking changes at once.
    check(
        "view_angle",
        "angle of the view from the front normal, degrees",
        304,
        [1.0 / 255.0, 1.0 / 255.0],
        |random, _| {
            let vane = random_vane(random);
            let least = (0.05 * vane.p_bl()).ln();
            let sigma = between(random, least, (2.0 * vane.p_b).ln()).exp();
            let direction = between(random, 0.0, std::f64::consts::TAU);
            let mean = [between(random, -0.1, -0.02), between(random, 0.2, 0.8)];
            Box::new(move |x| {
                let theta = (88.0 * (2.0 * x - 1.0)).to_radians();
                let (sin, cos) = direction.sin_cos();
                let view = [sin * theta.sin(), cos * theta.sin(), theta.cos()];
                // Foreshortened along the view's direction in the plane.
                let stretch = 1.0 / theta.cos().max(1.0 / 16.0);
                let more = sigma * sigma * (stretch * stretch - 1.0);
                let round = sigma * sigma;
                let covariance = [
                    round + more * sin * sin,
                    more * sin * cos,
                    round + more * cos * cos,
                ];
                let cell = mask_vane(&vane, view);
                let local = reduce(&cell, &vane, &Footprint { mean, covariance });
                (theta.to_degrees(), cell, local)
            })
        },
    );
}
