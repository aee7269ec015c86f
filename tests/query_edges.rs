//! A whole feather where one vane alone is not enough: across the rachis, across the contour and its splits, on a card seen at
//! a slant. The judge is dense float64 sampling of the plain geometry.
mod common;

use bevy_plumage::query::{ErrorBudget, Footprint, feather_coverage};
use common::{
    geometry::{PlainFeather, PlainVane, covariance_root, dense_shares},
    sweep::{between, statistics},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

const SAMPLES: u32 = 30_000;

/// A view that is not edge on.
fn random_view(random: &mut Pcg64Mcg) -> [f64; 3] {
    let (sin, cos) = between(random, 0.0, 75f64).to_radians().sin_cos();
    let (y, x) = between(random, 0.0, 7.0).sin_cos();
    let front = if between(random, 0.0, 1.0) < 0.3 {
        -1.0
    } else {
        1.0
    };
    [sin * x, sin * y, front * cos]
}

/// A covariance of the given major deviation, aspect and direction.
fn covariance(major: f64, aspect: f64, angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let (a, b) = (major * major, (major / aspect).powi(2));
    [
        a * cos * cos + b * sin * sin,
        (a - b) * sin * cos,
        a * sin * sin + b * cos * cos,
    ]
}

#[test]
fn across_the_rachis() {
    let mut random = Pcg64Mcg::seed_from_u64(61);
    let mut errors = Vec::new();
    for i in 0..1000 {
        let vanes = [
            PlainVane::random(&mut random),
            PlainVane::random(&mut random),
        ];
        let view = random_view(&mut random);
        let p_b = vanes[0].alpha_b.sin() / vanes[0].barb_count;
        let radius = between(&mut random, 0.0, 2.0) * p_b;
        let major = p_b * between(&mut random, -4.0, 2.0).exp();
        let aspect = 2f64.powf(between(&mut random, 0.0, 4.0));
        let f = Footprint {
            mean: [
                between(&mut random, -1.0, 1.0) * (radius + 2.0 * major),
                between(&mut random, 0.3, 0.7),
            ],
            covariance: covariance(major, aspect, between(&mut random, 0.0, 3.2)),
        };
        let feather = PlainFeather {
            vanes,
            rachis_radius: radius,
            reach: &|_, _| 1.0,
        };
        let l = covariance_root(f.covariance);
        let truth = dense_shares(
            SAMPLES,
            |[a, b]| [f.mean[0] + l[0] * a, f.mean[1] + l[1] * a + l[2] * b],
            |point| feather.hit(point, view),
        );
        let c = feather_coverage(
            &vanes[0].vane(),
            &vanes[1].vane(),
            radius,
            &f,
            view,
            &ErrorBudget::default(),
        );
        let error = [c.rachis, c.barb, c.distal, c.proximal]
            .iter()
            .zip(&truth[1..])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        if error > 0.02 {
            eprintln!(
                "{i}: {error:.4} radius {:.2} major {:.3} aspect {aspect:.1} {c:?} {truth:.4?}",
                radius / p_b,
                major / p_b
            );
        }
        errors.push(error);
    }
    let [rms, p99, max] = statistics(&errors);
    eprintln!("across the rachis: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}");
    assert!(max <= 0.03, "{max}");
}
