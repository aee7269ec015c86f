//! Bounds, invariants and seams of the range query.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{
    Cell, Choice, ErrorBudget, Evaluator, Line, Local, Lod, Part, Vane, cell_coverage, choose,
    classify_bounds, feather_coverage, lattice_coverage, line_parts, mask_vane, mean_coverage,
    near_coverage, reduce, split_line, stripe_coverage,
};
use plumage_reference::coverage;
use plumage_tests::sweep::{self, between};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

#[test]
fn any_input_gives_shares() {
    (0..8u64)
        .into_par_iter()
        .for_each(|seed| any_inputs(41 + 100 * seed, 125_000));
}

fn any_inputs(seed: u64, count: u32) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let budget = ErrorBudget::<f32>::default();
    let odd = [
        0.0f32,
        -0.0,
        1.0,
        -1.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        1e-38,
        1e-42,
        -1e-20,
    ];
    for i in 0..count {
        let mut any = |scale: f64| {
            if random.random_range(0..40) == 0 {
                odd[random.random_range(0..odd.len())]
            } else {
                (between(&mut random, -1.0, 1.0) * scale) as f32
            }
        };
        let vane = if i % 4 == 0 {
            Vane::new(
                any(0.01),
                any(0.001),
                any(2.0),
                any(2.0),
                any(0.002),
                any(0.0003),
                any(0.0003),
            )
        } else {
            Vane::new(0.004f32, 0.0004, 0.6, 0.7, 3e-4, 6e-5, 8e-5)
        };
        let sigma = 10f64.powf(f64::from(any(1.0)).clamp(-1.0, 1.0) * 3.0 - 4.0);
        let covariance = match i % 5 {
            0 => [any(sigma * sigma), any(sigma * sigma), any(sigma * sigma)],
            1 => [0.0, 0.0, (sigma * sigma) as f32],
            2 => [(sigma * sigma) as f32, 0.0, 0.0],
            3 => [0.0; 3],
            _ => {
                let (a, b) = (any(sigma), any(sigma));
                [a * a, a * b, b * b]
            }
        };
        let f = Footprint {
            mean: [any(0.2), any(1.0)],
            covariance,
        };
        let view = [any(1.0), any(1.0), any(1.0)];
        let c = feather_coverage(&vane, &vane, any(0.01), &f, view, &budget);
        let all = [c.rachis, c.barb, c.distal, c.proximal];
        let sum: f32 = all.iter().sum();
        assert!(
            all.iter().all(|w| (0.0..=1.0 + 1e-6).contains(w)),
            "{c:?} from {vane:?} {f:?} {view:?}"
        );
        assert!(sum <= 1.0 + 2e-6, "{sum} from {vane:?} {f:?} {view:?}");
    }
}

#[test]
fn every_evaluator_stays_in_range() {
    let mut random = Pcg64Mcg::seed_from_u64(42);
    let budget = ErrorBudget::<f32>::default();
    for case in sweep::cases(&mut random, 4000, true) {
        let (cell, local) = (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local));
        for w in [
            near_coverage(&cell, &local, &budget.quality),
            mean_coverage(&cell),
        ] {
            assert!(
                w.iter().all(|x| (-1e-5..=1.0 + 1e-5).contains(x)),
                "{w:?} {case:?}",
                case = case.cell
            );
        }
    }
}

#[test]
fn averages_meet() {
    let mut random = Pcg64Mcg::seed_from_u64(43);
    for case in sweep::cases(&mut random, 300, true) {
        let local = Local {
            variance: 9.0,
            conditional: 9.0,
            slope: 0.0,
            ..case.local
        };
        let m = mean_coverage(&case.cell);
        assert!(sweep::difference(stripe_coverage(&case.cell, &local), m) < 1e-6);
        assert!(sweep::difference(coverage::coverage(&case.cell, &local), m) < 1e-6);
    }
}

#[test]
fn the_pattern_repeats() {
    let mut random = Pcg64Mcg::seed_from_u64(44);
    let budget = ErrorBudget::<f64>::default();
    for _ in 0..300 {
        let vane = Vane::new(
            between(&mut random, 1e-3, 1e-2),
            between(&mut random, 1e-4, 1e-3),
            between(&mut random, 0.3, 1.2),
            between(&mut random, 0.4, 1.1),
            2e-4,
            3e-5,
            4e-5,
        );
        let cell = mask_vane(
            &vane,
            [0.3, 0.2, if random.random::<bool>() { 1.0 } else { -1.0 }],
        );
        let sigma = vane.p_b * between(&mut random, -5.0, 0.0).exp();
        let f = Footprint::round([-0.05, 0.4], sigma);
        let at = |x: f64, y: f64| {
            let g = Footprint {
                mean: [f.mean[0] + x, f.mean[1] + y],
                ..f
            };
            cell_coverage(&cell, &reduce(&cell, &vane, &g), Lod::Mixed, &budget)
        };
        let here = at(0.0, 0.0);
        // One barbule along the barb, one barb along the rachis.
        let along = at(-vane.sin_b * vane.d_bl, vane.cos_b * vane.d_bl);
        let next = at(0.0, vane.p_b / vane.sin_b);
        assert!(
            sweep::difference(here, along) < 1e-6 && sweep::difference(here, next) < 1e-6,
            "{here:?} {along:?} {next:?}"
        );
    }
}

#[test]
fn worst_cases() {
    let budget = ErrorBudget::<f64>::default();
    for (kappa, beta, sigma, conditional, h_d, h_p, v_low, v_high) in [
        (29.6, 0.0, 0.048, 0.061, 0.12, 0.12, 0.1, 0.9),
        (9.9, 1.1, 0.068, 0.034, 0.24, 0.24, 0.1, 0.9),
        (5.45, 0.0, 0.075, 0.019, 0.46, 0.435, 0.33, 0.70),
    ] {
        let cell = Cell {
            kappa,
            e_root: 0.2,
            v_low,
            v_high,
            h_d,
            h_p,
            s_d: 0.0,
            s_p: 0.0,
            side: 1.0,
        };
        for i in 0..200 {
            let (u, tau) = (f64::from(i % 20) / 20.0, f64::from(i / 20) / 10.0 - 0.5);
            let local = Local {
                u,
                tau,
                variance: sigma * sigma,
                slope: beta,
                conditional: conditional * conditional,
            };
            let e = sweep::difference(
                cell_coverage(&cell, &local, Lod::Mixed, &budget),
                coverage::coverage(&cell, &local),
            );
            assert!(e < 0.03, "{e} at {local:?} in {cell:?}");
        }
    }
}

#[test]
fn switches_do_not_show() {
    let mut random = Pcg64Mcg::seed_from_u64(45);
    let budget = ErrorBudget::<f64>::default();
    let threshold = budget.threshold();
    let steps = 400;
    let (mut jump, mut jump_sum, mut step_change, mut switches) = (0f64, 0f64, 0f64, 0);
    let value = |cell: &Cell<f64>, local: &Local<f64>, choice: &Choice<f64>| match choice.evaluator
    {
        Evaluator::Mean => mean_coverage(cell),
        Evaluator::Stripe => stripe_coverage(cell, local),
        Evaluator::Lattice => lattice_coverage(cell, local, choice.row_budget),
        Evaluator::Near if choice.beside_switch => {
            near_coverage(cell, local, &budget.quality.beside_switch())
        }
        Evaluator::Near => near_coverage(cell, local, &budget.quality),
    };
    for scene in 0..200 {
        let (cell, spacing, sin_bl) = sweep::random_cell(&mut random, scene % 2 == 1);
        let (u, tau) = (random.random(), between(&mut random, -0.5, 0.5));
        let angle = between(&mut random, 0.0, std::f64::consts::PI);
        let aspect = 2f64.powf(between(&mut random, 0.0, 4.0));
        let (low, high) = ((0.01 * spacing * sin_bl).ln(), 10f64.ln());
        let mut before: Option<(Choice<f64>, f64)> = None;
        for i in 0..steps {
            let major = (low + (high - low) * f64::from(i) / f64::from(steps)).exp();
            let local = sweep::local(u, tau, major, major / aspect, angle, spacing);
            let choice = choose(&cell, &local, threshold);
            let now = value(&cell, &local, &choice);
            if let Some((last, _)) = before
                && last.evaluator != choice.evaluator
            {
                let other = value(&cell, &local, &last);
                switches += 1;
                jump = jump.max(sweep::difference(now, other));
                jump_sum =
                    jump_sum.max((now.iter().sum::<f64>() - other.iter().sum::<f64>()).abs());
            }
            let mut error = 0.0;
            if scene % 10 == 0 {
                error =
                    now.iter().sum::<f64>() - coverage::coverage(&cell, &local).iter().sum::<f64>();
                if let Some((_, e)) = before {
                    step_change = step_change.max((error - e).abs());
                }
            }
            before = Some((choice, error));
        }
    }
    eprintln!(
        "{switches} switches: largest jump {jump:.5} per component, {jump_sum:.5} summed; error change per step {step_change:.5}"
    );
    assert!(switches > 200);
    assert!(jump_sum <= 0.0022, "summed coverage jumps by {jump_sum}");
    assert!(jump <= 1.5 / 255.0, "a component jumps by {jump}");
    assert!(step_change <= 0.02, "{step_change}");
}

#[test]
fn bounds_of_a_card_hold_for_its_pixels() {
    let mut random = Pcg64Mcg::seed_from_u64(46);
    let threshold = ErrorBudget::<f64>::default().threshold();
    let mut seen = [0; 5];
    for _ in 0..20_000 {
        let vane = Vane::new(
            between(&mut random, 1e-3, 1e-2),
            between(&mut random, 1e-4, 2e-3),
            between(&mut random, 0.3, 1.2),
            between(&mut random, 0.4, 1.1),
            2e-4,
            3e-5,
            4e-5,
        );
        let minor_min = vane.p_b * between(&mut random, -6.0, 1.0).exp();
        let major_max = minor_min * between(&mut random, 1.0, 6.0);
        let lod = classify_bounds(&vane, minor_min, major_max, threshold);
        seen[lod as usize] += 1;
        let major = between(&mut random, minor_min, major_max);
        let minor = between(&mut random, minor_min, major);
        let (sin, cos) = between(&mut random, 0.0, 3.2).sin_cos();
        let (a, b) = (major * major, minor * minor);
        let covariance = [
            a * cos * cos + b * sin * sin,
            (a - b) * sin * cos,
            a * sin * sin + b * cos * cos,
        ];
        let f = Footprint {
            mean: [-0.1, between(&mut random, 0.0, 1.0)],
            covariance,
        };
        let cell = mask_vane(&vane, [0.2, 0.3, 1.0]);
        let kind = choose(&cell, &reduce(&cell, &vane, &f), threshold).evaluator;
        match lod {
            Lod::Mean => assert_eq!(kind, Evaluator::Mean),
            Lod::Far => assert!(
                matches!(kind, Evaluator::Stripe | Evaluator::Mean),
                "{vane:?} {f:?}"
            ),
            Lod::Near => assert_eq!(kind, Evaluator::Near),
            Lod::Mixed => {}
        }
    }
    assert!(seen[1..].iter().all(|n| *n > 200), "{seen:?}");
}

#[test]
fn parts_of_a_footprint_sum_to_it() {
    let mut random = Pcg64Mcg::seed_from_u64(47);
    for i in 0..10_000 {
        let sigma = between(&mut random, -9.0, -2.0).exp();
        let f = Footprint {
            mean: [between(&mut random, -0.02, 0.02), 0.5],
            covariance: [sigma * sigma, 0.3 * sigma * sigma, sigma * sigma],
        };
        let distance = between(&mut random, -3.0, 3.0) * sigma;
        let [kept, left] = [1.0, -1.0].map(|side| {
            let gradient = [side * 0.6, side * 0.8];
            let middle = gradient[0] * f.mean[0] + gradient[1] * f.mean[1];
            let line = Line {
                offset: side * distance - middle,
                gradient,
            };
            let cut = split_line(&f, &line, i % 2 == 0);
            line_parts(&cut).collect::<Vec<_>>()
        });
        let mass = |parts: &[Part<f64>]| parts.iter().map(|p| p.mass).sum::<f64>();
        assert!((mass(&kept) + mass(&left) - 1.0).abs() < 1e-5);
        // The means of both sides balance.
        for axis in 0..2 {
            let mean: f64 = kept
                .iter()
                .chain(&left)
                .map(|p| p.mass * (p.footprint.mean[axis] - f.mean[axis]))
                .sum();
            assert!(mean.abs() < 2e-3 * sigma, "{mean} of {sigma}");
        }
    }
}
