//! A whole feather where one vane alone is not enough: across the rachis, across the contour and its splits, on a card seen at
//! a slant. The judge is dense float64 sampling of the plain geometry.

use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{
    CardFeather, Component, Coverage, ErrorBudget, Lod, cover, feather_coverage,
};
use plumage_tests::{
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
    for i in 0..300 {
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

/// Error of the whole query on one footprint, given in canonical space or as a place function of a standard normal.
fn worst_weight(c: &Coverage<f64>, truth: &[f64; 5]) -> f64 {
    [c.rachis, c.barb, c.distal, c.proximal]
        .iter()
        .zip(&truth[1..])
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// The whole query on a feather of two equal vanes within a contour (reach and derivative by root) and no rachis, and the truth.
fn outlined(
    vane: PlainVane,
    reach: &dyn Fn(f64) -> [f64; 2],
    f: &Footprint<f64>,
    view: [f64; 3],
) -> (Coverage<f64>, [f64; 5]) {
    let feather = PlainFeather {
        vanes: [vane, vane],
        rachis_radius: 0.0,
        reach: &|_, root| reach(root)[0],
    };
    let l = covariance_root(f.covariance);
    let truth = dense_shares(
        SAMPLES,
        |[a, b]| [f.mean[0] + l[0] * a, f.mean[1] + l[1] * a + l[2] * b],
        |point| feather.hit(point, view),
    );
    let card = CardFeather {
        vanes: [vane.vane().into(); 2],
        rachis_radius: 0.0,
        start: -1.0,
        reach: |_, root| reach(root),
        spacing: 1.0 / 255.0,
    };
    let c = cover(&card, f, 0.5, view, Lod::Mixed, &ErrorBudget::default());
    (c, truth)
}

/// Error of the whole query across a contour (reach and derivative by root) on `count` footprints whose mean lies up to
/// `depth` inside it, of deviations `exp(low)..exp(high)` barb periods.
fn contour_error(
    name: &str,
    seed: u64,
    count: usize,
    [low, high]: [f64; 2],
    contour: impl Fn(&mut Pcg64Mcg) -> (f64, Box<dyn Fn(f64) -> [f64; 2]>),
) -> [f64; 3] {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut errors = Vec::new();
    for i in 0..count {
        let vane = PlainVane::random(&mut random);
        let view = random_view(&mut random);
        let p_b = vane.alpha_b.sin() / vane.barb_count;
        let cot = 1.0 / vane.alpha_b.tan();
        let major = p_b * between(&mut random, low, high).exp();
        let aspect = 2f64.powf(between(&mut random, 0.0, 4.0));
        let (depth, reach) = contour(&mut random);
        // A point near the contour, on a barb rooted near 0.5.
        let root = 0.5 + between(&mut random, -2.0, 2.0) * major;
        let x = -reach(root)[0]
            + between(&mut random, -2.0, 2.0) * major
            + between(&mut random, 0.0, depth);
        let x = x.min(-4.0 * major);
        let f = Footprint {
            mean: [x, root - x * cot],
            covariance: covariance(major, aspect, between(&mut random, 0.0, 3.2)),
        };
        let (c, truth) = outlined(vane, &reach, &f, view);
        let error = worst_weight(&c, &truth);
        if error > 0.02 {
            eprintln!(
                "{i}: {error:.4} slope {:.2} major {:.3} aspect {aspect:.1} {c:?} {truth:.4?}",
                reach(root)[1],
                major / p_b
            );
        }
        errors.push(error);
    }
    let [rms, p99, max] = statistics(&errors);
    eprintln!("{name}: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}");
    [rms, p99, max]
}

#[test]
fn across_the_contour() {
    let [.., max] = contour_error("across the contour", 62, 300, [-4.0, 2.0], |random| {
        let slope = between(random, -1.5, 1.5);
        (
            0.0,
            Box::new(move |root| [0.2 + slope * (root - 0.5), slope]),
        )
    });
    assert!(max <= 0.03, "{max}");
}

#[test]
fn across_a_split() {
    // Eq. 5 of Chen et al. 2026: a Gaussian notch in the reach.
    let [.., max] = contour_error("across a split", 64, 300, [-3.0, 3.0], |random| {
        let (depth, width) = (between(random, 0.1, 0.6), between(random, 0.01, 0.03));
        let contour = move |root: f64| {
            let t = (root - 0.5) / width;
            let notch = depth * (-0.5 * t * t).exp();
            [0.2 * (1.0 - notch), 0.2 * notch * t / width]
        };
        (0.1 * depth, Box::new(contour))
    });
    assert!(max <= 0.03, "{max}");
}

#[test]
fn across_both_vanes_at_the_tip() {
    // Seen from the side a pixel spans all of a feather's width: near the tip most of that is beside both vanes.
    let mut random = Pcg64Mcg::seed_from_u64(65);
    let mut errors = Vec::new();
    for i in 0..300 {
        let vane = PlainVane::random(&mut random);
        let view = random_view(&mut random);
        let slope = between(&mut random, 0.2, 1.5);
        let reach = move |root: f64| {
            let end = slope * (1.0 - root);
            if (0.0..0.12).contains(&end) {
                [end, -slope]
            } else {
                [end.clamp(0.0, 0.12), 0.0]
            }
        };
        let f = Footprint {
            mean: [
                between(&mut random, -0.12, 0.12),
                between(&mut random, 0.9, 1.01),
            ],
            covariance: covariance(
                between(&mut random, 0.02, 0.1),
                2f64.powf(between(&mut random, 2.0, 6.0)),
                between(&mut random, -0.5, 0.5),
            ),
        };
        let (c, truth) = outlined(vane, &reach, &f, view);
        let sum = c.rachis + c.barb + c.distal + c.proximal;
        let error = (sum - truth[1..].iter().sum::<f64>()).abs();
        if error > 0.02 {
            eprintln!("{i}: {error:.4} slope {slope:.2} {f:?} {c:?} {truth:.4?}");
        }
        errors.push(error);
    }
    let [rms, p99, max] = statistics(&errors);
    eprintln!("across both vanes at the tip: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}");
    assert!(rms <= 0.01 && max <= 0.06, "{rms}, {max}");
}

#[test]
fn on_a_foreshortened_card() {
    // A pinhole camera looks at a card tilted by up to 80 degrees: the Jacobian varies over the pixel, the query sees it at the
    // middle only.
    let mut random = Pcg64Mcg::seed_from_u64(63);
    let mut errors = Vec::new();
    for i in 0..300 {
        let vanes = [
            PlainVane::random(&mut random),
            PlainVane::random(&mut random),
        ];
        let p_b = vanes[0].alpha_b.sin() / vanes[0].barb_count;
        let (sin, cos) = between(&mut random, 0.0, 80f64).to_radians().sin_cos();
        let (spin_y, spin_x) = between(&mut random, 0.0, 7.0).sin_cos();
        // The view direction in the card's frame, and the image plane's axes: across the tilt, and along it.
        let view = [sin * spin_x, sin * spin_y, cos];
        let across = [-spin_y, spin_x, 0.0];
        let up = [-cos * spin_x, -cos * spin_y, sin];
        let middle = [
            between(&mut random, -3.0, 3.0) * p_b,
            between(&mut random, 0.3, 0.7),
        ];
        // Distance of the eye in feather lengths, and half a pixel's angle.
        let distance = between(&mut random, 0.7, 3.0).exp() * 0.5;
        let sigma = p_b * between(&mut random, -3.5, 1.0).exp() * cos.max(0.2);
        let place = |[a, b]: [f64; 2]| {
            let toward = |k: usize| -distance * view[k] + sigma * (a * across[k] + b * up[k]);
            let eye = [0, 1, 2].map(|k| distance * view[k]);
            let t = -eye[2] / toward(2);
            [
                middle[0] + eye[0] + t * toward(0),
                middle[1] + eye[1] + t * toward(1),
            ]
        };
        let h = 1e-4;
        let column = |d: [f64; 2]| {
            let (p, q) = (place([h * d[0], h * d[1]]), place([-h * d[0], -h * d[1]]));
            [(p[0] - q[0]) / (2.0 * h), (p[1] - q[1]) / (2.0 * h)]
        };
        let (u, v) = (column([1.0, 0.0]), column([0.0, 1.0]));
        let f = Footprint {
            mean: middle,
            covariance: [
                u[0] * u[0] + v[0] * v[0],
                u[0] * u[1] + v[0] * v[1],
                u[1] * u[1] + v[1] * v[1],
            ],
        };
        let radius = 0.5 * p_b;
        let feather = PlainFeather {
            vanes,
            rachis_radius: radius,
            reach: &|_, _| 10.0,
        };
        let truth = dense_shares(SAMPLES, place, |point| feather.hit(point, view));
        let [left, right] = [vanes[0].vane(), vanes[1].vane()];
        let c = feather_coverage(&left, &right, radius, &f, view, &ErrorBudget::default());
        let error = worst_weight(&c, &truth);
        if error > 0.02 {
            eprintln!(
                "{i}: {error:.4} cos {cos:.2} distance {distance:.2} sigma {:.3} {c:?} {truth:.4?}",
                sigma / p_b
            );
        }
        errors.push(error);
    }
    let [rms, p99, max] = statistics(&errors);
    eprintln!("on a foreshortened card: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}");
    assert!(max <= 0.016, "{max}");
}

/// Height at which half of the rachis is left.
const END: f64 = 0.995;

/// A feather of a rachis alone, which ends where the card does.
#[test]
fn where_the_rachis_ends() {
    let mut random = Pcg64Mcg::seed_from_u64(71);
    let bare = PlainVane::random(&mut random);
    let mut errors = Vec::new();
    let mut beyond = 0.0_f64;
    for _ in 0..400 {
        let radius = between(&mut random, 0.002, 0.01);
        let major = radius * between(&mut random, 1.0, 20.0);
        let aspect = 2f64.powf(between(&mut random, 2.0, 5.0));
        let x = between(&mut random, -2.0, 2.0) * major;
        let y = between(&mut random, 0.8, 1.1);
        let f = Footprint {
            mean: [x, y],
            covariance: covariance(major, aspect, between(&mut random, 0.0, 3.2)),
        };
        let l = covariance_root(f.covariance);
        let [_, truth, _, _, _] = dense_shares(
            SAMPLES,
            |[a, b]| [x + l[0] * a, y + l[1] * a + l[2] * b],
            |[x, y]| {
                if x.abs() > radius || y > END {
                    Component::None
                } else {
                    Component::Rachis
                }
            },
        );
        let card = CardFeather {
            vanes: [bare.vane().into(); 2],
            rachis_radius: radius,
            start: -1.0,
            reach: |_, _| [0.0; 2],
            spacing: 1.0 / 255.0,
        };
        let budget = ErrorBudget::default();
        let c = cover(&card, &f, y, [0.0, 0.0, 1.0], Lod::Mixed, &budget);
        if truth == 0.0 {
            beyond = beyond.max(c.rachis);
        }
        errors.push((c.rachis - truth).abs());
    }
    let [rms, p99, max] = statistics(&errors);
    eprintln!("end of the rachis: RMS {rms:.4}, P99 {p99:.4}, max {max:.4}, beyond it {beyond:.4}");
    assert!(rms <= 0.015, "{rms}");
    assert!(beyond <= 0.004, "{beyond}");
}
