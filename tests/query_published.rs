//! The published spatial method, to which the charts compare, is itself right.
mod common;

use bevy_plumage::query::{Evaluator, choose, published, reference};
use common::sweep;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

#[test]
fn nodes_integrate_polynomials() {
    for count in [1usize, 2, 6, 64] {
        let nodes = published::gauss_legendre(count);
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
        let nodes = published::gauss_legendre(count);
        let errors: Vec<f64> = cases
            .iter()
            .filter(|c| choose(&c.cell, &c.local, 0.2753).0 == Evaluator::Near)
            .map(|c| {
                let value = published::spatial(&c.cell, &c.local, &nodes);
                sweep::difference(value, reference::coverage(&c.cell, &c.local))
            })
            .collect();
        sweep::statistics(&errors)
    };
    let mut last = f64::INFINITY;
    for count in [6, 16, 64] {
        let [rms, p99, max] = statistics(count);
        eprintln!(
            "published spatial, {count} nodes, where NEAR: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}"
        );
        assert!(rms < 0.6 * last);
        last = rms;
    }
    assert!(last < 0.01);
}
