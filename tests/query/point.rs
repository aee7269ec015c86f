//! The point query against plain geometry, and the range query against points drawn from the footprint.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{
    ErrorBudget, Lod, feather_point_query, mask_vane, point_query, vane_coverage,
};
use plumage_tests::{
    geometry::{PlainFeather, PlainVane, covariance_root, dense_shares},
    sweep::between,
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

fn random_view(random: &mut Pcg64Mcg) -> [f64; 3] {
    loop {
        let v = [
            between(random, -1.0, 1.0),
            between(random, -1.0, 1.0),
            between(random, -1.0, 1.0),
        ];
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        if length > 0.1 && length <= 1.0 && v[2].abs() > 0.25 * length {
            return v;
        }
    }
}

#[test]
fn point_query_is_the_geometry() {
    let mut random = Pcg64Mcg::seed_from_u64(31);
    let mut counts = [0; 5];
    for _ in 0..200 {
        let plain = PlainVane::random(&mut random);
        let view = random_view(&mut random);
        // Where neighboring barbs have grown together the strips are cut instead of overlapping: not this test's business.
        let cell = mask_vane(&plain.vane(), view);
        if cell.v_high - cell.v_low < 0.02 {
            continue;
        }
        for _ in 0..100 {
            let point = [
                between(&mut random, -0.1, 0.0),
                between(&mut random, 0.0, 1.0),
            ];
            let hit = point_query(&cell, &plain.vane(), point);
            let (component, offset) = plain.hit(point, view);
            counts[component as usize] += 1;
            // The very edges may fall to either side.
            let edge = offset.abs() > 1.0 - 1e-6 || hit.offset.abs() > 1.0 - 1e-6;
            assert!(
                edge || hit.component == component,
                "{hit:?} against {component:?} {offset} at {point:?}"
            );
            assert!(
                edge || (hit.offset - offset).abs() < 1e-6,
                "{hit:?} against {offset}, {cell:?}"
            );
        }
    }
    assert!(
        counts[0] > 500 && counts[2..].iter().all(|c| *c > 500),
        "{counts:?}"
    );
}

#[test]
fn range_query_is_the_average_of_points() {
    let mut random = Pcg64Mcg::seed_from_u64(32);
    let samples = 20_000;
    let mut errors = Vec::new();
    for _ in 0..60 {
        let plain = PlainVane::random(&mut random);
        let view = random_view(&mut random);
        let cell = mask_vane(&plain.vane(), view);
        let sigma = plain.spacing * between(&mut random, -4.0, 3.0).exp();
        let aspect = between(&mut random, 0.3, 1.0);
        let tilt = between(&mut random, -0.8, 0.8) * aspect;
        let covariance = [
            sigma * sigma,
            sigma * sigma * tilt,
            sigma * sigma * aspect * aspect,
        ];
        let f = Footprint {
            mean: [
                between(&mut random, -0.1, -0.05),
                between(&mut random, 0.2, 0.8),
            ],
            covariance,
        };
        let shares = vane_coverage(
            &cell,
            &plain.vane(),
            &f,
            Lod::Mixed,
            &ErrorBudget::default(),
        );
        let l = covariance_root(covariance);
        let counts = dense_shares(
            samples,
            |[a, b]| [f.mean[0] + l[0] * a, f.mean[1] + l[1] * a + l[2] * b],
            |point| point_query(&cell, &plain.vane(), point).component,
        );
        for (value, share) in shares.iter().zip(&counts[2..]) {
            errors.push((value - share).abs());
        }
    }
    let [rms, _, max] = plumage_tests::sweep::statistics(&errors);
    eprintln!("range query against {samples} points: RMS {rms:.4}, max {max:.4}");
    // Noise alone: at most 0.0035 RMS, 4.5 of its standard deviations 0.016.
    assert!(rms < 0.004 && max < 0.02, "RMS {rms}, max {max}");
}

#[test]
fn the_whole_feather_is_the_geometry() {
    let mut random = Pcg64Mcg::seed_from_u64(33);
    let mut differ = 0;
    for _ in 0..100 {
        let vanes = [
            PlainVane::random(&mut random),
            PlainVane::random(&mut random),
        ];
        let view = random_view(&mut random);
        let open = |v: &PlainVane, view| {
            let cell = mask_vane(&v.vane(), view);
            cell.v_high - cell.v_low > 0.02
        };
        if !open(&vanes[0], view) || !open(&vanes[1], [-view[0], view[1], view[2]]) {
            continue;
        }
        let radius = between(&mut random, 0.001, 0.01);
        let feather = PlainFeather {
            vanes,
            rachis_radius: radius,
            reach: &|_, _| 1.0,
        };
        let [left, right] = [vanes[0].vane(), vanes[1].vane()];
        for _ in 0..100 {
            let point = [
                between(&mut random, -0.03, 0.03),
                between(&mut random, 0.0, 1.0),
            ];
            let hit = feather_point_query(&left, &right, radius, point, view);
            let on_edge = hit.offset.abs() > 1.0 - 1e-6;
            differ += u32::from(hit.component != feather.hit(point, view) && !on_edge);
        }
    }
    // Points on the very edge of a fibre above or below may fall to either side.
    assert!(differ <= 2, "{differ}");
}
