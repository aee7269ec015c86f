//! A feather that turns, comes nearer and slides past at once, its shaft through the pixel: coverage follows the truth smoothly.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{
    Component, ErrorBudget, Vane, feather_coverage, feather_point_query,
};
use plumage_tests::{
    stability::{self, Step},
    sweep::between,
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

const PATHS: usize = 6;
const STEPS: usize = 80;
/// Points of the truth (in double precision); the same in every step, so that their noise moves slowly.
const POINTS: usize = 4096;

fn vane<T: bevy_plumage::maths::Real>(m: [f64; 8]) -> Vane<T> {
    let [a, b, c, d, e, f, g, h] = m.map(T::of);
    Vane::from_measures(a, b, c, d, e, f, g, h)
}

/// One pose: footprint, view, and the axes of the footprint.
struct Pose {
    mean: [f64; 2],
    basis: [[f64; 2]; 2],
    view: [f64; 3],
}

impl Pose {
    fn footprint(&self) -> Footprint<f32> {
        let [a, b] = self.basis;
        Footprint {
            mean: self.mean.map(|x| x as f32),
            covariance: [
                a[0] * a[0] + b[0] * b[0],
                a[0] * a[1] + b[0] * b[1],
                a[1] * a[1] + b[1] * b[1],
            ]
            .map(|x| x as f32),
        }
    }
}

/// Rachis, barb, distal and proximal coverage; the last two summed so that a [`Step`] holds all.
fn fold(w: [f64; 4]) -> [f64; 3] {
    [w[0] + w[1], w[2], w[3]]
}

#[test]
fn a_moving_feather_does_not_jump() {
    let points: Vec<[f64; 2]> = (0..POINTS)
        .map(|i| {
            let i = i as f64 + 0.5;
            let radius = (-2.0 * (1.0 - i / POINTS as f64).ln()).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * i * 0.618_033_988_749_894_8).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect();
    let mut random = Pcg64Mcg::seed_from_u64(601);
    let mut worst = (0.0, 0.0, Vec::new());
    let mut largest_error: f64 = 0.0;
    for _ in 0..PATHS {
        let measures = [(); 2].map(|()| {
            [
                between(&mut random, 150.0, 400.0),
                between(&mut random, 30.0, 60.0),
                between(&mut random, 10.0, 40.0),
                between(&mut random, 20.0, 60.0),
                between(&mut random, 25.0, 60.0),
                between(&mut random, 3.0, 12.0),
                between(&mut random, 3.0, 12.0),
                100.0,
            ]
        });
        let [left, right] = measures.map(vane::<f64>);
        let [left32, right32] = measures.map(vane::<f32>);
        let radius = between(&mut random, 0.002, 0.008);
        let near = between(&mut random, 0.2, 0.5) * left.p_b;
        let far = between(&mut random, 0.8, 4.0) * left.p_b;
        let spin = between(&mut random, -1.5, 1.5);
        let turn = between(&mut random, 0.0, 6.3);
        let y = between(&mut random, 0.3, 0.6);
        let pose = |x: f64| {
            let sigma = near * (far / near).powf(x);
            let flap = 1.3 * (5.0 * x + turn).sin();
            let (s, c) = (turn + spin * x).sin_cos();
            // The feather flaps about its shaft: foreshortened across it.
            let wide = 1.0 / flap.cos();
            Pose {
                mean: [0.03 * (x - 0.5), y + 0.02 * x],
                basis: [
                    [sigma * c * wide, sigma * s],
                    [-sigma * s * wide, sigma * c],
                ],
                view: [flap.sin(), 0.0, flap.cos()],
            }
        };
        let ours = |p: &Pose| {
            let c = feather_coverage(
                &left32,
                &right32,
                radius as f32,
                &p.footprint(),
                p.view.map(|x| x as f32),
                &ErrorBudget::default(),
            );
            fold([c.rachis, c.barb, c.distal, c.proximal].map(f64::from))
        };
        let truth = |p: &Pose| {
            let mut sum = [0.0; 4];
            let [a, b] = p.basis;
            for [x, y] in &points {
                let point = [
                    p.mean[0] + x * a[0] + y * b[0],
                    p.mean[1] + x * a[1] + y * b[1],
                ];
                let hit = feather_point_query(&left, &right, radius, point, p.view);
                match hit.component {
                    Component::Rachis => sum[0] += 1.0,
                    Component::Barb => sum[1] += 1.0,
                    Component::Distal => sum[2] += 1.0,
                    Component::Proximal => sum[3] += 1.0,
                    Component::None => {}
                }
            }
            fold(sum.map(|s| s / POINTS as f64))
        };
        let steps: Vec<Step> = (0..=STEPS)
            .map(|i| {
                let at = i as f64 / STEPS as f64;
                let p = pose(at);
                Step {
                    at,
                    value: ours(&p),
                    truth: truth(&p),
                    kind: (bevy_plumage::maths::query::Evaluator::Near, false),
                }
            })
            .collect();
        // A jump stays one however short the steps are.
        let mut jump: (f64, f64) = (0.0, 0.0);
        let parts = STEPS * 256;
        let mut last = ours(&pose(0.0));
        for i in 1..=parts {
            let at = i as f64 / parts as f64;
            let next = ours(&pose(at));
            let change = (0..3)
                .map(|k| (next[k] - last[k]).abs())
                .fold(0.0, f64::max);
            if change > jump.0 {
                jump = (change, at);
            }
            last = next;
        }
        for s in &steps {
            for i in 0..3 {
                largest_error = largest_error.max((s.value[i] - s.truth[i]).abs());
            }
        }
        if jump.0 > worst.0 {
            worst = (jump.0, jump.1, steps);
        }
    }
    let (jump, at, steps) = worst;
    eprintln!(
        "moving feather: largest jump {jump:.4} at {at:.3}, largest error {largest_error:.4}"
    );
    let bound = 2.0 / 255.0;
    if jump > bound || largest_error > 0.03 {
        let file = stability::failure_file("stability_moving");
        let title = format!("Moving feather: jump of {jump:.4} at {at:.3}");
        stability::draw(&file, &title, "time", &steps, bound);
        panic!(
            "{title}, largest error {largest_error}, picture {}",
            file.display()
        );
    }
}
