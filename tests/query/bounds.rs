//! The chooser's stated bounds over random footprints, and the two judges against each other.

use bevy_plumage::maths::query::{
    Component, ErrorBudget, Evaluator, Lod, cell_coverage, choose, mask_vane, near_counted, reduce,
};
use bevy_plumage::maths::{Footprint, QueryError};
use plumage_reference::coverage;
use plumage_tests::{
    geometry::{PlainVane, covariance_root, dense_shares},
    sweep::{self, between},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Evaluates `count` footprints of a seed in single precision; none may exceed what its evaluator states.
fn check(seed: u64, count: usize, masked: bool, epsilon: f32) -> Vec<(Evaluator, f64)> {
    let budget = ErrorBudget::<f32>::new(epsilon);
    sweep::cases(&mut Pcg64Mcg::seed_from_u64(seed), count, masked)
        .par_iter()
        .map(|case| {
            let (cell, local) = (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local));
            let kind = choose(&cell, &local, budget.threshold()).evaluator;
            let value = cell_coverage(&cell, &local, Lod::Mixed, &budget).map(f64::from);
            let error = sweep::difference(value, coverage::coverage(&case.cell, &case.local));
            assert!(
                error <= f64::from(budget.bound(kind)),
                "{error} of {kind:?} at {epsilon}: {:?} {:?}",
                case.cell,
                case.local
            );
            (kind, error)
        })
        .collect()
}

fn report(name: &str, errors: &[(Evaluator, f64)]) -> [f64; 3] {
    for kind in [
        Evaluator::Near,
        Evaluator::Lattice,
        Evaluator::Stripe,
        Evaluator::Mean,
    ] {
        let of: Vec<f64> = errors.iter().filter(|e| e.0 == kind).map(|e| e.1).collect();
        let [rms, p99, max] = sweep::statistics(&of);
        eprintln!(
            "{name} {kind:?}: {} footprints, RMS {rms:.5}, P99 {p99:.5}, max {max:.5}",
            of.len()
        );
    }
    sweep::statistics(&errors.iter().map(|e| e.1).collect::<Vec<_>>())
}

#[test]
fn stated_bounds_hold() {
    for (epsilon, seed) in [(0.01, 901), (1.0 / 510.0, 902), (0.001, 903), (3e-4, 904)] {
        let mut errors = check(seed, 1500, false, epsilon);
        errors.extend(check(seed + 10, 1500, true, epsilon));
        let [rms, p99, max] = report(&format!("budget {epsilon:.4}"), &errors);
        eprintln!("budget {epsilon:.4}: RMS {rms:.5}, P99 {p99:.5}, max {max:.5}");
        if epsilon < 0.005 {
            assert!(rms <= 0.001 && p99 <= 0.004 && max <= 0.03);
        }
    }
}

/// Minutes.
#[test]
#[ignore = "a million footprints: `make test-long`"]
fn stated_bounds_hold_a_million_times() {
    for masked in [false, true] {
        let mut errors = Vec::new();
        for batch in 0..10 {
            let seed = 70_000 + 2 * batch + u64::from(masked);
            errors.extend(check(seed, 50_000, masked, 1.0 / 510.0));
        }
        let [rms, p99, max] = report(if masked { "masked" } else { "unmasked" }, &errors);
        eprintln!("masked {masked}: RMS {rms:.5}, P99 {p99:.5}, max {max:.5}");
        assert!(rms <= 0.001 && p99 <= 0.004 && max <= 0.03);
    }
}

#[test]
fn near_takes_few_cells() {
    let budget = ErrorBudget::<f32>::default();
    let mut trips: Vec<u32> = [false, true]
        .iter()
        .flat_map(|masked| sweep::cases(&mut Pcg64Mcg::seed_from_u64(905), 4000, *masked))
        .filter_map(|case| {
            let (cell, local) = (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local));
            let choice = choose(&cell, &local, budget.threshold());
            (choice.evaluator == Evaluator::Near).then(|| {
                let quality = if choice.beside_switch {
                    budget.quality.beside_switch()
                } else {
                    budget.quality
                };
                near_counted(&cell, &local, &quality).1
            })
        })
        .collect();
    trips.sort_unstable();
    let n = trips.len();
    let mean = f64::from(trips.iter().sum::<u32>()) / n as f64;
    let [p50, p90, p99, max] = [n / 2, n * 9 / 10, n * 99 / 100, n - 1].map(|i| trips[i]);
    eprintln!(
        "cells of NEAR over {n} footprints: mean {mean:.1}, p50 {p50}, p90 {p90}, p99 {p99}, max {max}"
    );
    assert!(p50 == 0 && p90 <= 30 && p99 <= 50 && max <= 144);
}

#[test]
fn monte_carlo_and_quadrature_agree() {
    // Positions drawn from the footprint in canonical space, asked of the plain geometry: no cell units, no closed form.
    let mut random = Pcg64Mcg::seed_from_u64(64);
    let samples = 40_000;
    let mut errors = Vec::new();
    for _ in 0..80 {
        let plain = PlainVane::random(&mut random);
        let vane = plain.vane();
        let (sin, cos) = between(&mut random, 0.0, 70f64).to_radians().sin_cos();
        let (y, x) = between(&mut random, 0.0, 7.0).sin_cos();
        let view = [sin * x, sin * y, cos];
        let cell = mask_vane(&vane, view);
        let major = vane.p_b * between(&mut random, -5.0, 1.5).exp();
        let minor = major / 2f64.powf(between(&mut random, 0.0, 4.0));
        let (sin, cos) = between(&mut random, 0.0, 3.2).sin_cos();
        let (a, b) = (major * major, minor * minor);
        let f = Footprint {
            mean: [-0.1, between(&mut random, 0.3, 0.7)],
            covariance: [
                a * cos * cos + b * sin * sin,
                (a - b) * sin * cos,
                a * sin * sin + b * cos * cos,
            ],
        };
        let truth = coverage::coverage(&cell, &reduce(&cell, &vane, &f));
        let l = covariance_root(f.covariance);
        let shares = dense_shares(
            samples,
            |[a, b]| [f.mean[0] + l[0] * a, f.mean[1] + l[1] * a + l[2] * b],
            |point| plain.hit(point, view).0,
        );
        let sampled = [Component::Barb, Component::Distal, Component::Proximal]
            .map(|part| shares[part as usize]);
        errors.push(sweep::difference(truth, sampled));
    }
    let [rms, p99, max] = sweep::statistics(&errors);
    eprintln!("quadrature against {samples} points: RMS {rms:.5}, P99 {p99:.5}, max {max:.5}");
    // Independent samples would scatter by 0.0025; low-discrepancy ones do not by more.
    assert!(rms < 0.0025 && max < 0.009, "RMS {rms}, max {max}");
}

#[test]
fn what_is_no_footprint_is_refused() {
    assert!(Footprint::new([0.0, 0.5], [1e-6, 0.0, 1e-6]).is_ok());
    assert!(Footprint::new([0.0f32, 0.5], [0.0, 0.0, 0.0]).is_ok());
    assert!(Footprint::new([0.0f32, 0.5], [1e-40, 1e-42, 1e-40]).is_ok());
    for (mean, covariance) in [
        ([f32::NAN, 0.0], [1e-6, 0.0, 1e-6]),
        ([0.0, f32::INFINITY], [1e-6, 0.0, 1e-6]),
        ([0.0, 0.0], [f32::INFINITY, 0.0, 1e-6]),
        ([0.0, 0.0], [1e-6, f32::NEG_INFINITY, 1e-6]),
        ([0.0, 0.0], [1e-6, 0.0, f32::NAN]),
    ] {
        assert!(matches!(
            Footprint::new(mean, covariance),
            Err(QueryError::NotFinite { .. })
        ));
    }
    let error = Footprint::new([0.0, 0.0], [1e-6, 2e-6, 1e-6]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("covariance[1] is 0.000002; allowed are ")
    );
    assert!(Footprint::new([0.0, 0.0], [-1e-6, 0.0, 1e-6]).is_err());
    assert!(Footprint::new([100.0, 0.0], [1e-6, 0.0, 1e-6]).is_err());
}
