//! The walk through the shell against the published one.

use bevy_plumage::maths::undercoat::shell::Shell;
use bevy_plumage::maths::undercoat::walk::{Walk, walk, walk_start};
use plumage_reference::undercoat::published::step_walk;
use plumage_tools::plot::{self, Labels, Result};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::TAU, path::Path, time::Instant};

fn torus() -> Result<Shell> {
    let (around, across) = (60u32, 28u32);
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for i in 0..around {
        for k in 0..across {
            let u = TAU * f64::from(i) / f64::from(around);
            let v = TAU * f64::from(k) / f64::from(across);
            let w = 1.0 + 0.4 * v.cos();
            positions.push([w * u.cos(), 0.4 * v.sin(), w * u.sin()].map(|x| x as f32));
            let at = |i: u32, k: u32| (i % around) * across + k % across;
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
            indices.extend([a, b, c, b, d, c]);
        }
    }
    let heights = vec![0.1; positions.len()];
    Ok(Shell::build(&positions, &indices, &heights)?)
}

/// What `f` gives, and the least of five times in microseconds a ray: others use the processor too.
fn timed(rays: usize, f: impl Fn() -> Vec<f64>) -> (f64, Vec<f64>) {
    let mut least = f64::MAX;
    let mut found = Vec::new();
    for _ in 0..5 {
        let start = Instant::now();
        found = f();
        least = least.min(start.elapsed().as_secs_f64() * 1e6 / rays as f64);
    }
    (least, found)
}

/// Share of the path that is off, over the time of a ray.
pub fn chart(folder: &Path) -> Result<()> {
    let shell = torus()?;
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    // Rays into the tops, from random directions above.
    let rays = (0..3000)
        .map(|_| {
            let prism = rng.random_range(0..shell.prisms.len());
            let corners = shell.corners::<f64>(prism);
            let (x, y): (f64, f64) = (rng.random_range(0.1..0.5), rng.random_range(0.1..0.4));
            let at = [0, 1, 2].map(|k| {
                let p = corners[3][k];
                p + x * (corners[4][k] - p) + y * (corners[5][k] - p)
            });
            let n = shell.vertices[shell.prisms[prism].corners[0] as usize].normal;
            let d: [f64; 3] = [0, 1, 2].map(|k| rng.random_range(-0.9..0.9) - f64::from(n[k]));
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            (prism as u32, at, d.map(|x| x / length))
        })
        .collect::<Vec<_>>();
    let (exact, lengths) = timed(rays.len(), || {
        let length = |(prism, at, d): &(u32, [f64; 3], [f64; 3])| {
            let begin: Walk<f64> = walk_start(&shell, prism * 16 + 3, *at, *d);
            let mut length = 0.0;
            walk(&shell, begin, *at, *d, |s| {
                length += s.t[1] - s.t[0];
                true
            });
            length
        };
        rays.iter().map(length).collect()
    });
    // The same in the precision of the shader, against double.
    let (single_time, single) = timed(rays.len(), || {
        let length = |(prism, at, d): &(u32, [f64; 3], [f64; 3])| {
            let (at, d) = (at.map(|x| x as f32), d.map(|x| x as f32));
            let begin: Walk<f32> = walk_start(&shell, prism * 16 + 3, at, d);
            let mut length = 0.0;
            walk(&shell, begin, at, d, |s| {
                length += f64::from(s.t[1] - s.t[0]);
                true
            });
            length
        };
        rays.iter().map(length).collect()
    });
    let whole: f64 = lengths.iter().sum();
    let off = |found: &[f64]| {
        let sum: f64 = found.iter().zip(&lengths).map(|(a, b)| (a - b).abs()).sum();
        sum / whole
    };
    // Mean edge of this torus.
    let edge = 0.105;
    let stepped = [0.025, 0.05, 0.1, 0.2, 0.5, 1.0].map(|share| {
        let step = share * edge;
        let (time, found) = timed(rays.len(), || {
            let steps = |(prism, at, d): &(u32, [f64; 3], [f64; 3])| {
                step * f64::from(step_walk(&shell, *prism, *at, *d, step, |_, _| ()))
            };
            rays.iter().map(steps).collect()
        });
        (time, off(&found))
    });
    println!(
        "tetrahedra {exact:.2} us a ray, in single precision {single_time:.2} us, off {:.1e}",
        off(&single)
    );
    let curves = [
        (
            "tetrahedra, single precision".to_owned(),
            vec![(single_time, off(&single))],
        ),
        (
            "published steps of 1/40 to 1 edge".to_owned(),
            stepped.to_vec(),
        ),
    ];
    let labels = Labels {
        title: "Walk through the shell of a torus: share of the path that is off",
        x: "microseconds a ray",
        y: "share of the path",
    };
    plot::draw(
        &folder.join("down_walk.svg"),
        &labels,
        [true, true],
        &curves,
    )
}
