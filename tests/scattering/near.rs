//! The near field against dense quadrature over the window, and against the far field.

use bevy_plumage::maths::scattering::*;
use plumage_tests::fibres::*;
use std::f64::consts::PI;

fn near(fibre: &Fibre, albedo: f64, omega_o: [f64; 3], window: (f64, f64)) -> FibreNear<f64> {
    let table = FibreTable::build(fibre);
    let cos = (omega_o[1] * omega_o[1] + omega_o[2] * omega_o[2]).sqrt();
    fibre_near(
        &table.fibre(),
        &table.row(cos),
        [albedo; 3],
        omega_o,
        0.0,
        8,
        FibreWindow::even(window.0, window.1),
    )
}

/// Density over phi of the four lobes for a window of h, 6000 heights and a wrapped Gaussian.
fn dense_window(core: f64, cos_theta: f64, beta: f64, phi: f64, window: (f64, f64)) -> f64 {
    let n = 6000;
    let mut sum = 0.0;
    for i in 0..n {
        let h = window.0 + (window.1 - window.0) * (f64::from(i) + 0.5) / f64::from(n);
        let c = crossing(1.55, cos_theta, h);
        let a = attenuation(&c, Some((core, 1.0)), (0.0, 0.0), 0.0);
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
            sum += a[lobe] * d / ((2.0 * PI).sqrt() * beta) / f64::from(n);
        }
    }
    sum
}

#[test]
fn windows_agree_with_dense_quadrature() {
    let (mut worst, mut total, mut count) = (0.0_f64, 0.0, 0.0);
    for (core, theta) in [
        (0.0, 0.1),
        (0.3, 0.5),
        (0.5, 0.9),
        (0.65, 0.3),
        (0.8, 1.2_f64),
    ] {
        for window in [
            (-0.1, 0.1),
            (0.2, 0.4),
            (0.3, 0.9),
            (-0.95, -0.55),
            (0.9, 0.999),
            (-1.0, 1.0),
        ] {
            let beta = 0.3;
            let mut n = near(
                &Fibre {
                    azimuthal_roughness: beta as f32,
                    ..structural(core as f32)
                },
                0.5,
                direction(theta, 0.0),
                window,
            );
            // White: the energies of the window without absorption.
            let white = window_energies(core, theta.cos(), window);
            n.shading.energy = white.map(|e| [e; 3]);
            n.shading.dense = [0.0; 3];
            let steps = 120;
            let (mut error, mut sum) = (0.0, 0.0);
            for i in 0..steps {
                let phi = -PI + 2.0 * PI * (f64::from(i) + 0.5) / f64::from(steps);
                let truth = dense_window(core, theta.cos(), beta, phi, window);
                let s = &n.shading;
                // The light in the cross-section: divide every lobe's own M out.
                let mut model = 0.0;
                for lobe in 0..4 {
                    let mut one = n;
                    one.shading.energy = [[0.0; 3]; 4];
                    one.shading.energy[lobe] = s.energy[lobe];
                    let m = longitudinal_with(s.eye[lobe], (0.0, 1.0), s.spread[lobe]);
                    model += fibre_near_evaluate(&one, direction(0.0, phi))[0] / m.max(1e-300);
                }
                error += (model - truth).abs() * 2.0 * PI / f64::from(steps);
                sum += truth * 2.0 * PI / f64::from(steps);
            }
            total += error;
            count += 1.0;
            worst = worst.max(error);
            assert!((sum - 1.0).abs() < 0.07, "{sum}");
            assert!(
                error <= 0.06,
                "core {core} theta {theta} window {window:?}: L1 {error:.4}"
            );
        }
    }
    println!("near field: L1 mean {:.4}, worst {worst:.4}", total / count);
    assert!(total / count <= 0.02);
}

fn window_energies(core: f64, cos_theta: f64, window: (f64, f64)) -> [f64; 4] {
    let n = 6000;
    let mut out = [0.0; 4];
    for i in 0..n {
        let h = window.0 + (window.1 - window.0) * (f64::from(i) + 0.5) / f64::from(n);
        let c = crossing(1.55, cos_theta, h);
        let a = attenuation(&c, Some((core, 1.0)), (0.0, 0.0), 0.0);
        for (o, a) in out.iter_mut().zip(a) {
            *o += a / f64::from(n);
        }
    }
    out
}

#[test]
fn the_mean_over_the_width_is_the_far_field() {
    let mut worst = [0.0_f64; 2];
    let fibres = [
        structural(0.3),
        structural(0.8),
        pigment(0.85, 2.0, 0.4),
        Fibre {
            aspect: 0.5,
            ..structural(0.6)
        },
    ];
    for fibre in fibres {
        for (theta, phi) in [(0.0, 0.0), (0.8, 1.0), (1.3, -2.4)] {
            let o = direction(theta, phi);
            let far = shade(&FibreTable::build(&fibre), 0.98, o, 0.0);
            let slices = 13;
            let edges: Vec<f64> = (0..=slices)
                .map(|i| -1.0 + 2.0 * f64::from(i) / f64::from(slices))
                .collect();
            let parts: Vec<_> = edges
                .windows(2)
                .map(|w| near(&fibre, 0.98, o, (w[0], w[1])))
                .collect();
            let (mut error, mut sum) = (0.0, 0.0);
            for k in 0..36 {
                for tilt in [-0.2, 0.0, 0.2] {
                    let light = direction(-theta + tilt, f64::from(k) * PI / 18.0);
                    let want = fibre_evaluate(&far, light)[1];
                    let got = parts
                        .iter()
                        .map(|n| fibre_near_evaluate(n, light)[1])
                        .sum::<f64>()
                        / f64::from(slices);
                    error += (got - want).abs();
                    sum += want;
                }
            }
            // R of a flat fibre is not blurred in the far field.
            let flat = usize::from(fibre.aspect < 1.0);
            worst[flat] = worst[flat].max(error / sum);
            assert!(
                error / sum < [0.02, 0.04][flat],
                "{fibre:?} theta {theta}: {:.4}",
                error / sum
            );
        }
    }
    println!(
        "mean over the width against the far field: L1 {:.4}, flat fibres {:.4}",
        worst[0], worst[1]
    );
}

#[test]
fn the_whole_furnace_holds_far_and_near() {
    let (mut far_worst, mut near_worst) = (0.0_f64, 0.0_f64);
    for (longitudinal_roughness, azimuthal_roughness) in [(0.05, 0.2), (0.2, 0.4), (0.6, 1.0)] {
        for aspect in [0.2, 0.5, 1.0] {
            for fibre in [structural(0.5), structural(0.8), pigment(0.85, 2.0, 0.4)] {
                let fibre = Fibre {
                    longitudinal_roughness,
                    azimuthal_roughness,
                    aspect,
                    ..fibre
                };
                let table = FibreTable::build(&fibre);
                for theta in [0.0, 0.8, 1.45] {
                    let o = direction(theta, 0.7);
                    let row = table.row(theta.cos());
                    let mut s = shade(&table, 1.0, o, 0.0);
                    // White: nothing is absorbed.
                    let entering = (1.0 - s.energy[0][0]) / (1.0 - row[0][0]);
                    for (energy, row) in s.energy.iter_mut().zip(row[0]).skip(1) {
                        *energy = [row * entering; 3];
                    }
                    s.dense = [0.0; 3];
                    let sum = furnace(&s, theta, 96)[0];
                    far_worst = far_worst.max((sum - 1.0).abs());
                    assert!((sum - 1.0).abs() < 0.01, "far {fibre:?} {theta}: {sum}");
                    for window in [(-0.6, -0.4), (-0.1, 0.3), (0.7, 0.9)] {
                        let n = near(&fibre, 0.6, o, window);
                        let sum = near_furnace(&n, theta, 96);
                        let energy: f64 = n.shading.energy.iter().map(|e| e[0]).sum();
                        near_worst = near_worst.max((sum - energy).abs());
                        assert!(
                            (sum - energy).abs() < 0.01 && energy <= 1.001,
                            "near {fibre:?} {theta} {window:?}: {sum} of {energy}"
                        );
                    }
                }
            }
        }
    }
    println!("furnace on the grid: far field off by {far_worst:.4}, near field by {near_worst:.4}");
}

/// As `furnace`, for a window.
fn near_furnace(n: &FibreNear<f64>, theta_o: f64, phi_steps: usize) -> f64 {
    let mut sum = 0.0;
    lit_sphere(theta_o, phi_steps, |light, solid| {
        sum += fibre_near_evaluate(n, light)[0] * solid
    });
    sum
}

#[test]
fn footprints_side_by_side_see_the_whole_fibre() {
    let fibre = structural(0.7);
    let table = FibreTable::build(&fibre);
    let o = direction(0.4, 0.3);
    let far = shade(&table, 0.5, o, 0.0);
    for deviation in [0.05, 0.3, 1.0, 30.0] {
        let (mut error, mut sum) = (0.0, 0.0);
        let mut windows = Vec::new();
        let reach = 1.0 + 4.0 * deviation;
        for i in 0..=240 {
            let mean = reach * (f64::from(i) / 120.0 - 1.0);
            // Share of the footprint that lies on the fibre.
            let share: f64 = (0..200)
                .map(|k| -1.0 + (f64::from(k) + 0.5) * 0.01)
                .map(|h| (-0.5 * ((h - mean) / deviation).powi(2)).exp())
                .sum();
            let (p, row) = (table.fibre(), table.row(0.4_f64.cos()));
            let window = fibre_window(mean, deviation);
            windows.push((share, fibre_near(&p, &row, [0.5; 3], o, 0.0, 8, window)));
        }
        let mass: f64 = windows.iter().map(|w| w.0).sum();
        for k in 0..24 {
            let light = direction(-0.4, f64::from(k) * PI / 12.0);
            let want = fibre_evaluate(&far, light)[1];
            let got: f64 = windows
                .iter()
                .map(|(share, n)| share * fibre_near_evaluate(n, light)[1])
                .sum();
            error += (got / mass - want).abs();
            sum += want;
        }
        println!("deviation {deviation}: L1 {:.4}", error / sum);
        assert!(error / sum < 0.03, "{deviation}: {}", error / sum);
    }
    for mean in [f64::NAN, -1e9, 0.0, 1e9] {
        for deviation in [f64::NAN, 0.0, 1e-9, 1e9] {
            let w = fibre_window(mean, deviation);
            assert!(
                w.low >= -1.0 && w.high <= 1.0 && w.high - w.low > 0.0,
                "{w:?}"
            );
            assert!(w.mean.is_finite() && w.sharpness.is_finite());
        }
    }
}

#[test]
fn near_field_is_finite_at_the_edges() {
    let angles = [-0.5 * PI, -1.0, 0.0, 1.0, 0.5 * PI];
    for fibre in [
        structural(0.0),
        structural(1.0 / 1.55),
        structural(1.0),
        pigment(0.3, 9.0, 0.0),
        Fibre {
            aspect: 0.2,
            longitudinal_roughness: 0.01,
            azimuthal_roughness: 0.01,
            ..structural(0.65)
        },
    ] {
        for window in [(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (f64::NAN, f64::NAN)] {
            for albedo in [0.0, 1.0, f64::NAN] {
                for theta_o in angles {
                    let n = near(&fibre, albedo, direction(theta_o, 0.5 * PI), window);
                    for theta_i in angles {
                        for phi in [-PI, -1.0, 0.0, 0.5 * PI, PI] {
                            let k = fibre_near_evaluate(&n, direction(theta_i, phi));
                            assert!(k.iter().all(|k| k.is_finite() && *k >= 0.0), "{k:?}");
                        }
                    }
                }
            }
        }
    }
}
