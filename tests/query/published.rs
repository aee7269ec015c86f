//! The published spatial method, to which the charts compare, is itself right.

use bevy_plumage::maths::query::{Evaluator, choose};
use plumage_reference::{coverage, query_published};
use plumage_tests::sweep;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

#[test]
fn nodes_integrate_polynomials() {
    for count in [1usize, 2, 6, 64] {
        let nodes = bevy_plumage::maths::gauss_legendre(count);
        for power in 0..2 * count.min(10) {
            let sum: f64 = nodes.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
            let wanted = if power % 2 == 0 {
                2.0 / (power as f64 + 1.0)
            } else {
                0.0
            };
            assert!(
                (sum - wanted).abs() < 1e-12,
                "{count} nodes, x^{power}: {sum}"
            );
        }
    }
}

#[test]
fn spatial_converges_to_the_reference() {
    let cases = sweep::cases(&mut Pcg64Mcg::seed_from_u64(51), 800, true);
    let statistics = |count: usize| {
        let nodes = bevy_plumage::maths::gauss_legendre(count);
        let errors: Vec<f64> = cases
            .iter()
            .filter(|c| choose(&c.cell, &c.local, 0.2753).evaluator == Evaluator::Near)
            .map(|c| {
                let value = query_published::spatial(&c.cell, &c.local, &nodes);
                sweep::difference(value, coverage::coverage(&c.cell, &c.local))
            })
            .collect();
        sweep::statistics(&errors)
    };
    let mut last = f64::INFINITY;
    for (count, bound) in [(6, 0.106), (16, 0.024), (64, 0.0016)] {
        let [rms, p99, max] = statistics(count);
        eprintln!(
            "published spatial, {count} nodes, where NEAR: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}"
        );
        assert!(rms < 0.6 * last && rms < bound, "{count} nodes: {rms}");
        last = rms;
    }
}

/// Statistics of a method over footprints that `keep` picks.
fn errors(method: &query_published::Method<f64>, keep: impl Fn(&sweep::Case) -> bool) -> [f64; 3] {
    let errors: Vec<f64> = sweep::cases(&mut Pcg64Mcg::seed_from_u64(52), 800, true)
        .iter()
        .filter(|c| keep(c))
        .map(|c| {
            let value = method.evaluate(&c.cell, &c.local);
            sweep::difference(value, coverage::coverage(&c.cell, &c.local))
        })
        .collect();
    assert!(errors.len() > 20);
    sweep::statistics(&errors)
}

#[test]
fn points_converge_to_the_reference() {
    let mut last = f64::INFINITY;
    for count in [4, 64, 1024] {
        let [rms, p99, max] = errors(&query_published::Method::Points(count), |_| true);
        eprintln!("{count} points: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}");
        assert!(rms < 0.35 * last);
        last = rms;
    }
    assert!(last < 0.01);
}

#[test]
fn frequency_converges_where_it_serves() {
    let mut last = f64::INFINITY;
    for (stripes, window) in [(1, 2), (4, 8), (8, 24)] {
        let orders = query_published::Orders { stripes, window };
        let [rms, p99, max] = errors(&query_published::Method::Frequency(orders), |c| {
            c.local.variance >= 4.0 && c.local.conditional > 0.05
        });
        eprintln!("frequency {stripes} {window}: RMS {rms:.5}, P99 {p99:.5}, max {max:.5}");
        assert!(rms < 0.5 * last);
        last = rms;
    }
    assert!(last < 0.002);
}

#[test]
fn a_whole_gap_misses_a_narrow_footprint() {
    let nodes = query_published::Method::<f64>::nodes(6);
    let keep = |c: &sweep::Case| c.scale < 2;
    let whole = errors(&query_published::Method::WholeGap(nodes.clone()), keep)[2];
    let clipped = errors(&query_published::Method::Spatial(nodes), keep)[2];
    eprintln!("narrow footprints: whole gap {whole:.3}, clipped {clipped:.3}");
    assert!(whole > 0.9 && clipped < whole);
}
