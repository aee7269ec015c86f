//! Time of one range query by each evaluator, and by the published methods: the spatial one at comparable error and as few nodes
//! as are printed, the frequency domain, the hard switch, point samples.
//!
//! The footprints are those for which the chooser picks the evaluator, over the sweep of docs/book/range_queries.md#the-sweep.
#![allow(missing_docs)]

use bevy_plumage::maths::query::{
    Cell, ErrorBudget, Evaluator, Local, Lod, cell_coverage, choose, mask_vane, mean_coverage,
    near_coverage, stripe_coverage,
};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use plumage_reference::query_published;
use plumage_tests::sweep;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::hint::black_box;

fn queries(c: &mut Criterion) {
    let budget = ErrorBudget::<f32>::default();
    let cases: Vec<(Cell<f32>, Local<f32>)> =
        sweep::cases(&mut Pcg64Mcg::seed_from_u64(101), 4000, true)
            .iter()
            .map(|case| (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local)))
            .collect();
    let nodes: Vec<(f32, f32)> = bevy_plumage::maths::gauss_legendre(64)
        .into_iter()
        .map(|(x, w)| (x as f32, w as f32))
        .collect();
    let chosen = |kind: Evaluator| -> Vec<(Cell<f32>, Local<f32>)> {
        cases
            .iter()
            .filter(|(cell, local)| choose(cell, local, budget.threshold()).evaluator == kind)
            .copied()
            .collect()
    };
    let mut group = c.benchmark_group("query");
    let mut bench = |name: &str,
                     set: &[(Cell<f32>, Local<f32>)],
                     f: &dyn Fn(&Cell<f32>, &Local<f32>) -> [f32; 3]| {
        let mut next = (0..set.len()).cycle();
        group.bench_function(name, |b| {
            b.iter_batched(
                || set[next.next().unwrap_or(0)],
                |(cell, local)| black_box(f(&cell, &local)),
                BatchSize::SmallInput,
            );
        });
    };
    let near_set = chosen(Evaluator::Near);
    let stripe_set = chosen(Evaluator::Stripe);
    let mean_set = chosen(Evaluator::Mean);
    bench("near", &near_set, &|c, l| {
        near_coverage(c, l, &budget.quality)
    });
    bench("stripe", &stripe_set, &stripe_coverage);
    bench("mean", &mean_set, &|c, _| mean_coverage(c));
    bench("chosen", &cases, &|c, l| {
        cell_coverage(c, l, Lod::Mixed, &budget)
    });
    bench("published spatial 64, where near", &near_set, &|c, l| {
        query_published::spatial(c, l, &nodes)
    });
    bench(
        "published spatial 64, where stripe",
        &stripe_set,
        &|c, l| query_published::spatial(c, l, &nodes),
    );
    let orders = query_published::Orders {
        stripes: 1,
        window: 2,
    };
    let sixteen = query_published::Method::nodes(16);
    bench("published hard switch 16", &cases, &|c, l| {
        query_published::hard_switch(c, l, &sixteen, orders)
    });
    bench("published spatial 16, where near", &near_set, &|c, l| {
        query_published::spatial(c, l, &sixteen)
    });
    bench(
        "published frequency 1 and 2, where mean",
        &mean_set,
        &|c, l| query_published::frequency(c, l, orders),
    );
    bench("point samples 64", &cases, &|c, l| {
        query_published::points(c, l, 64)
    });
    group.finish();
    let vane = bevy_plumage::maths::query::Vane::new(0.004f32, 0.0004, 0.6, 0.7, 4e-4, 5e-5, 5e-5);
    c.bench_function("mask_vane", |b| {
        b.iter(|| mask_vane(black_box(&vane), black_box([0.3, 0.4, 0.8])))
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2));
    targets = queries
}
criterion_main!(benches);
