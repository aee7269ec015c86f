//! One fibre against dense quadrature.

use bevy_plumage::maths::gauss_legendre;
use bevy_plumage::maths::scattering::*;
use plumage_tests::fibres::*;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn white_fibres_scatter_exactly_what_they_receive() {
    let mut worst: f64 = 0.0;
    for beta in [0.05, 0.15, 0.3] {
        for tilt in [-0.1, 0.0, 0.1] {
            let kinds = [0.0, 0.3, 0.5, 0.65, 0.8, 0.95].map(structural).into_iter();
            for fibre in kinds.chain([0.5, 2.0, 8.0].map(|tau| pigment(0.85, tau, 0.4))) {
                let table = FibreTable::build(&Fibre {
                    longitudinal_roughness: beta,
                    tilt,
                    azimuthal_roughness: 0.3,
                    ..fibre
                });
                for theta in ANGLES {
                    let o = direction(theta, 0.7);
                    let mut s = shade(&table, 0.9, o, 0.0);
                    whiten(&mut s, &table.row(theta.cos()));
                    let sum = furnace(&s, theta, 32)[0];
                    worst = worst.max((sum - 1.0).abs());
                    assert!(
                        (sum - 1.0).abs() <= 3.8e-4,
                        "{fibre:?} beta {beta} tilt {tilt} theta {theta}: {sum}"
                    );
                }
            }
        }
    }
    println!("white furnace of fibres: worst {worst:.2e}");
}

#[test]
fn colored_fibres_never_gain_energy() {
    let fibres = [
        structural(0.0),
        structural(0.4),
        structural(0.65),
        structural(0.9),
        pigment(0.4, 0.3, 0.8),
        pigment(0.95, 8.0, 0.0),
    ];
    for fibre in fibres {
        for aspect in [0.2, 0.6, 1.0] {
            let table = FibreTable::build(&Fibre {
                aspect,
                azimuthal_roughness: 0.3,
                ..fibre
            });
            for theta in ANGLES {
                for (phi, dark) in [(0.0, 0.0), (1.3, 1.0), (3.0, 1.0)] {
                    let s = shade(&table, 1.0, direction(theta, phi), dark);
                    for a in furnace(&s, theta, 96) {
                        assert!(
                            a <= 1.001 && a > 0.0,
                            "{fibre:?} aspect {aspect} theta {theta} phi {phi}: {a}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn longitudinal_lobe_is_normalised() {
    for beta in [0.01, 0.05, 0.2, 0.6, 1.0] {
        for theta_o in ANGLES {
            let eye = fold(theta_o + 0.1).sin_cos();
            let nodes = gauss_legendre(400);
            let centre = -fold(theta_o + 0.1);
            let mut sum = 0.0;
            let mut edges = vec![-FRAC_PI_2, FRAC_PI_2];
            for k in [-12.0, -4.0, 0.0, 4.0, 12.0] {
                edges.push((centre + k * beta).clamp(-FRAC_PI_2, FRAC_PI_2));
            }
            edges.sort_by(f64::total_cmp);
            for w in edges.windows(2) {
                let half = 0.5 * (w[1] - w[0]);
                for &(x, weight) in &nodes {
                    let t: f64 = w[0] + half * (x + 1.0);
                    let light = t.sin_cos();
                    let m = longitudinal(eye, light, beta);
                    sum += m * t.cos() * weight * half;
                    // The same rounded numbers for both.
                    let (e, l) = (
                        (eye.0 as f32, eye.1 as f32),
                        (light.0 as f32, light.1 as f32),
                    );
                    let wide = |x: (f32, f32)| (f64::from(x.0), f64::from(x.1));
                    let exact = longitudinal(wide(e), wide(l), f64::from(beta as f32));
                    let single = longitudinal(e, l, beta as f32);
                    let peak = 1.0 / ((2.0 * PI).sqrt() * beta);
                    assert!(
                        (f64::from(single) - exact).abs() <= 1e-5 * peak.max(exact),
                        "beta {beta}: {single} {exact}"
                    );
                }
            }
            assert!(
                (sum - 1.0).abs() < 1e-5,
                "beta {beta} theta_o {theta_o}: {sum}"
            );
        }
    }
}

#[test]
fn scaled_bessel_function_is_accurate() {
    for i in 0..400 {
        let x = 1e-3 * 1.035_f64.powi(i);
        // Bessel's integral, exp(-x) I0(x) = mean of exp(x (cos t - 1)).
        let n = 20_000;
        let exact = (0..n)
            .map(|k| (x * ((PI * (f64::from(k) + 0.5) / f64::from(n)).cos() - 1.0)).exp())
            .sum::<f64>()
            / f64::from(n);
        assert!(
            (i0e(x) / exact - 1.0).abs() < 1e-6,
            "{x}: {} {exact}",
            i0e(x)
        );
    }
}

/// Density over phi by dense quadrature with a wrapped Gaussian: shares nothing with the series but the lobes themselves.
fn dense_azimuth(core: f64, cos_theta: f64, absorption: f64, beta: f64, phi: f64) -> [f64; 4] {
    let n = 3000;
    let mut sum = [0.0; 4];
    for i in 0..n {
        let gamma = -FRAC_PI_2 + PI * (i as f64 + 0.5) / n as f64;
        let c = crossing(1.55, cos_theta, gamma.sin());
        let a = attenuation(&c, Some((core, 1.0)), (0.0, 0.0), absorption);
        for (lobe, kind) in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT]
            .into_iter()
            .enumerate()
        {
            if a[lobe] == 0.0 {
                continue;
            }
            let x = (phi - exit_angle(kind, &c, core)).rem_euclid(2.0 * PI);
            let d: f64 = (-2..=2)
                .map(|k| (-((x + 2.0 * PI * f64::from(k)) / beta).powi(2) / 2.0).exp())
                .sum();
            sum[lobe] +=
                a[lobe] * d / ((2.0 * PI).sqrt() * beta) * 0.5 * gamma.cos() * PI / n as f64;
        }
    }
    sum
}

#[test]
fn series_agrees_with_dense_quadrature() {
    let (mut errors, mut threes) = (Vec::new(), Vec::new());
    for (core, theta) in [
        (0.0, 0.1),
        (0.0, 1.0),
        (0.3, 0.5),
        (0.5, 0.9),
        (0.65, 0.3),
        (0.8, 1.2),
        (0.95, 0.0_f64),
    ] {
        for (beta, sigma) in [(0.2, 0.0), (0.3, 0.5), (0.45, 2.0), (0.4, 0.2)] {
            let table = FibreTable::build(&Fibre {
                azimuthal_roughness: beta as f32,
                ..structural(core as f32)
            });
            let row = table.row(theta.cos());
            for terms in [8, MEAN_TERMS] {
                let o = direction(theta, 0.0);
                let mut s = fibre_shading(&table.fibre(), &row, [0.5; 3], o, 0.0, terms);
                s.dense = [(2.0 * sigma / (2.0 + sigma)); 3];
                let scale = |lobe: usize| {
                    row[0][lobe]
                        * gamma_transmittance(row[1][2 * lobe - 2], row[1][2 * lobe - 1], sigma)
                };
                let (energy_tt, energy_trt) = (scale(1), scale(2));
                let steps = 90;
                let mut error = 0.0;
                for i in 0..steps {
                    let phi = PI * (f64::from(i) + 0.5) / f64::from(steps);
                    let truth = dense_azimuth(core, theta.cos(), sigma, beta, phi);
                    let (clear, dense) = (
                        azimuthal(&s.series[1], phi.cos()),
                        azimuthal(&s.series[2], phi.cos()),
                    );
                    let model = row[0][0] * azimuthal(&s.series[0], phi.cos())
                        + energy_tt * (clear + (dense - clear) * s.dense[0])
                        + energy_trt * azimuthal(&s.series[3], phi.cos());
                    let mut judged = truth[0] + truth[1] + truth[2];
                    let mut model = model / (2.0 * PI);
                    // TRcT gets its color from the core, not from the cortex: compare it clear.
                    if sigma == 0.0 {
                        judged += truth[3];
                        model += row[0][3] * azimuthal(&s.series[4], phi.cos()) / (2.0 * PI);
                    }
                    error += 2.0 * (model - judged).abs() * PI / f64::from(steps);
                }
                if terms == MEAN_TERMS {
                    threes.push(error);
                    continue;
                }
                errors.push(error);
                // A thin core at the least roughness is the worst: eight terms leave 0.018.
                let bound = if beta > 0.2 { 0.012 } else { 0.02 };
                assert!(
                    error <= bound,
                    "core {core} theta {theta} beta {beta} sigma {sigma}: L1 {error}"
                );
            }
        }
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    println!(
        "series: L1 mean {mean:.4}, worst {:.4}",
        errors.iter().fold(0.0, |a: f64, &b| a.max(b))
    );
    assert!(mean <= 0.0048, "{mean}");
    let three = threes.iter().sum::<f64>() / threes.len() as f64;
    println!("three terms: L1 mean {three:.4}");
    assert!(three <= 0.07, "{three}");
    // Four fibre kinds of a feather, as the GPU holds them.
    let bytes = 4 * 16 * FIBRE_ROWS * FIBRE_ROW_VEC4S;
    println!("tables of a feather: {bytes} bytes");
    assert!(bytes <= 24 * 1024);
}

#[test]
fn albedo_comes_back_from_the_furnace() {
    let mut worst = [0.0_f64; 2];
    for fibre in [
        structural(0.3),
        structural(0.65),
        structural(0.8),
        structural(0.95),
        pigment(0.85, 2.0, 0.4),
        pigment(0.85, 6.0, 0.4),
        pigment(0.6, 1.0, 0.3),
        pigment(0.95, 1.0, 0.5),
        pigment(0.4, 2.0, 0.4),
    ] {
        let table = FibreTable::build(&fibre);
        let mirror =
            matches!(fibre.kind, FibreKind::Structural { core_radius } if core_radius > 0.6);
        let mut before = 0.0;
        for a in [0.085, 0.1, 0.2, 0.3, 0.4, 0.55, 0.7, 0.9, 0.99] {
            let s = shade(&table, a, [0.0, 0.0, 1.0], 0.0);
            let got = furnace(&s, 0.0, 48)[0];
            let kind = usize::from(!mirror);
            worst[kind] = worst[kind].max((got - a).abs());
            assert!(
                (got - a).abs() <= [0.0002, 0.0086][kind],
                "{fibre:?}: {a} gives {got}"
            );
            assert!(got > before);
            before = got;
        }
    }
    println!(
        "albedo round trip: mirror cores {:.4}, absorbing fibres {:.4}",
        worst[0], worst[1]
    );
}

/// Shape of R and TRcT, each to unit energy: the warp keeps a round fibre's energy, the surface of an ellipse reflects up to 1.5
/// times less when broadside and 2 times more edge on.
#[test]
fn flat_fibres_scatter_the_energy_they_claim() {
    let mut worst: f64 = 0.0;
    for aspect in [0.2, 0.4, 0.6, 0.9985, 1.0] {
        for eye in [0.0, 0.5, 1.2, FRAC_PI_2, 2.5] {
            for theta in [0.0, 0.4, 1.2] {
                let table = FibreTable::build(&Fibre {
                    aspect,
                    ..structural(0.5)
                });
                let s = shade(&table, 0.9, direction(theta, eye), 0.0);
                let (sum, claimed) = (furnace(&s, theta, 360)[0], fibre_albedo(&s)[0]);
                worst = worst.max((sum - claimed).abs());
                assert!(
                    (sum - claimed).abs() < 0.001,
                    "aspect {aspect} eye {eye}: {sum} against {claimed}"
                );
            }
        }
    }
    println!("flat fibres: energy off by {worst:.4} at most");
}

#[test]
fn the_back_of_a_one_sided_core_is_dark() {
    let table = FibreTable::build(&structural(0.8));
    let front = furnace(&shade(&table, 0.8, [0.0, 0.0, 1.0], 1.0), 0.0, 96)[0];
    let back = furnace(&shade(&table, 0.8, [0.0, 0.0, -1.0], 1.0), 0.0, 96)[0];
    println!("one-sided core: front {front:.3}, back {back:.3}");
    assert!(front > 0.7 && back < 0.12);
}

#[test]
fn energy_split_sums_to_the_albedo() {
    for fibre in [
        structural(0.5),
        structural(0.8),
        pigment(0.85, 2.0, 0.4),
        pigment(0.5, 1.0, 0.8),
    ] {
        let table = FibreTable::build(&fibre);
        for theta in ANGLES {
            let s = shade(&table, 0.6, direction(theta, 0.0), 0.0);
            let split = fibre_energy_split(&s);
            let sum = furnace(&s, theta, 48);
            for (c, sum) in sum.iter().enumerate() {
                assert!((split.specular + split.front[c] + split.back[c] - sum).abs() < 0.004);
            }
        }
    }
}

#[test]
fn nothing_is_nan_at_the_edges() {
    let angles = [-FRAC_PI_2, -1.0, 0.0, 1e-8, 1.0, FRAC_PI_2];
    let turns = [-PI, -FRAC_PI_2, 0.0, 1e-9, FRAC_PI_2, PI];
    let mut fibres = Vec::new();
    for core in [
        0.0,
        0.3,
        1.0 / 1.55,
        1.0 / 1.55 - 1e-7,
        0.999_999,
        1.0,
        f32::NAN,
    ] {
        fibres.push(structural(core));
    }
    fibres.extend([
        pigment(0.0, 0.0, 0.0),
        pigment(1.0, 1e9, 1.0),
        pigment(f32::NAN, f32::NAN, f32::NAN),
    ]);
    for fibre in fibres {
        for (beta, aspect) in [(0.01, 1.0), (1.0, 0.2), (0.2, 0.6), (f32::NAN, f32::NAN)] {
            let table = FibreTable::build(&Fibre {
                longitudinal_roughness: beta,
                azimuthal_roughness: beta,
                aspect,
                ..fibre
            });
            for albedo in [0.0, 1.0, 1e9, f64::NAN] {
                for theta_o in angles {
                    for phi_o in turns {
                        let s = shade(&table, albedo, direction(theta_o, phi_o), 1.0);
                        for theta_i in angles {
                            for phi_i in turns {
                                let k = fibre_evaluate(&s, direction(theta_i, phi_i));
                                assert!(
                                    k.iter().all(|k| k.is_finite() && *k >= 0.0),
                                    "{fibre:?} {beta} {theta_o} {phi_o} {k:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    for h in [-1.0, 1.0, 0.0] {
        for cos in [0.0, 1e-9, 1.0] {
            let c = crossing(1.55, cos, h);
            for core in [None, Some((0.0, 1.0)), Some((1.0, 1.0)), Some((0.6, 0.0))] {
                for sigma in [0.0, 100.0] {
                    assert!(
                        attenuation(&c, core, (0.5, 1.0), sigma)
                            .iter()
                            .all(|a| (0.0..=1.0).contains(a))
                    );
                }
            }
        }
    }
    assert!(
        fibre_local([0.0; 3], [0.0; 3], [0.0, 0.0, 1.0])
            .iter()
            .all(|x: &f64| x.is_finite())
    );
    assert!(
        fibre_local([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0])
            .iter()
            .all(|x: &f64| x.is_finite())
    );
}

#[test]
fn clear_longitudinal_part_is_reciprocal() {
    for (a, b) in [(0.3, -0.8), (1.2, 0.1), (-0.5, -0.6)] {
        let (i, o): ((f64, f64), (f64, f64)) = (f64::sin_cos(a), f64::sin_cos(b));
        assert!((longitudinal(o, i, 0.2) - longitudinal(i, o, 0.2)).abs() < 1e-12);
    }
}

#[test]
fn one_number_picks_the_tier() {
    // 1/255: the chooser's 0.275.
    assert_eq!(fibre_terms(0.275, 0.2), 8);
    assert_eq!(fibre_terms(0.275, 0.4), 5);
    assert_eq!(fibre_terms(0.275, 2.0), MEAN_TERMS);
    assert!(fibre_terms(0.275, 0.4) < fibre_terms(0.38, 0.4));
    assert_eq!(fibre_terms(f64::NAN, f64::NAN), fibre_terms(0.0, 0.05));
    let limit = near_limit(0.275_f64);
    assert!((limit - 2.098).abs() < 0.01);
    assert_eq!(near_deviation(0.2, 0.275_f64), Some(0.2));
    assert!(near_deviation(0.99 * limit, 0.275).is_some_and(|d| d > 10.0));
    assert_eq!(near_deviation(limit, 0.275), None);
    assert_eq!(near_deviation(f64::NAN, 0.275), None);
}

#[test]
fn a_table_builds_quickly() {
    // The fastest of many: what else the machine does only adds.
    let fastest = (0..20)
        .map(|i| {
            let start = std::time::Instant::now();
            std::hint::black_box(FibreTable::build(&structural(0.3 + 0.03 * i as f32)));
            start.elapsed().as_secs_f64()
        })
        .fold(f64::MAX, f64::min);
    println!("table: {:.2} ms", fastest * 1e3);
    // Generous: any machine, opt-level 1. An optimised build takes about a millisecond.
    assert!(fastest < 0.05);
}
