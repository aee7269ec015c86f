//! The map of a card, what a pixel sees of it, and what the outline leaves of that.

use bevy_plumage::maths::{Footprint, card};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[test]
fn map_and_its_jacobian() {
    for name in ["macaw_primary", "eagle_rectrix", "down"] {
        let map = plumage_tests::shipped::feather(name).map();
        let h = 1e-6;
        for i in 0..400 {
            let uv = [
                f64::from(i % 20) / 19.0,
                0.01 + 0.98 * f64::from(i / 20) / 19.0,
            ];
            let back = map.uv(map.canonical(uv));
            assert!((back[0] - uv[0]).abs() < 1e-12 && (back[1] - uv[1]).abs() < 1e-12);
            let jacobian = map.jacobian(uv[1]);
            for k in 0..2 {
                let shifted = |d: f64| {
                    let mut moved = uv;
                    moved[k] += d;
                    map.canonical(moved)
                };
                let (a, b) = (shifted(-h), shifted(h));
                for row in 0..2 {
                    let slope = (b[row] - a[row]) / (2.0 * h);
                    approx::assert_abs_diff_eq!(jacobian[row][k], slope, epsilon = 1e-7);
                }
            }
        }
    }
}

#[test]
fn footprint_is_half_a_pixel() {
    // A straight rachis, 100 pixels up and 50 across a card twice as long as wide: the same pixel both ways.
    let footprint = card::canonical_footprint([0.5, 0.5], [0.02, 0.0], [0.0, 0.01], 0.5, 0.0, 0.5);
    assert_eq!(footprint.mean, [0.0, 0.5]);
    let expected: f64 = 0.25e-4;
    approx::assert_abs_diff_eq!(footprint.covariance[0], expected, epsilon = 1e-12);
    approx::assert_abs_diff_eq!(footprint.covariance[1], 0.0, epsilon = 1e-12);
    approx::assert_abs_diff_eq!(footprint.covariance[2], expected, epsilon = 1e-12);
}

/// Points of the footprint, drawn; cards turned on the screen, with the pixel's center on them or beside.
#[test]
fn the_card_has_its_share_of_a_footprint() {
    let mut random = Pcg64::seed_from_u64(31);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let mut span = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        // Pixels across and along the card.
        let sides = [span(1.0, 40.0), span(2.0, 80.0)];
        let (sin, cos) = span(0.0, std::f64::consts::TAU).sin_cos();
        let (dx, dy) = (
            [cos / sides[0], -sin / sides[1]],
            [sin / sides[0], cos / sides[1]],
        );
        let uv = [0, 1].map(|i| span(-0.5 / sides[i], 1.0 + 0.5 / sides[i]));
        let count = 20_000;
        let mut inside = 0;
        for _ in 0..count {
            // Box and Muller: standard deviation of half a pixel.
            let (radius, angle) = (
                (-2.0 * span(1e-12, 1.0).ln()).sqrt(),
                span(0.0, std::f64::consts::TAU),
            );
            let (x, y) = (0.5 * radius * angle.cos(), 0.5 * radius * angle.sin());
            let on = |i: usize| (0.0..1.0).contains(&(uv[i] + x * dx[i] + y * dy[i]));
            inside += usize::from(on(0) && on(1));
        }
        let share = card::card_share(uv, card::card_size(dx, dy));
        worst = worst.max((share - inside as f64 / f64::from(count)).abs());
    }
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn a_pixel_wider_than_a_side_of_its_card_sees_that_side() {
    // A card across a pixel, or any part of it: what is left of the footprint has the moments of the width of the card's side there.
    for width in [0.04, 0.2, 0.6, 2.0, 6.0, 20.0] {
        for place in [0.0, 0.2, 0.5, 0.9, 1.0] {
            // Canonical space with the card 0.4 wide: x is across, y along; the pixel leans.
            let deviation = 0.5 / width;
            let carry = [0.4 * deviation, 0.1 * deviation];
            let sight = card::CardSight {
                footprint: Footprint {
                    mean: [0.4 * (place - 0.5), 0.3],
                    covariance: [
                        carry[0] * carry[0],
                        carry[0] * carry[1],
                        carry[1] * carry[1] + 1e-4,
                    ],
                },
                place: [place, 0.3],
                size: [1.0 / deviation, 100.0],
            };
            let seen = card::narrowed(&sight, carry);
            // Truth by sums over the part of the Gaussian on that side.
            let left = if place > 0.5 { 0.5 } else { 0.0 };
            let [mut mass, mut mean, mut square] = [0.0; 3];
            for i in 0..1000 {
                let x = left + (f64::from(i) + 0.5) * 5e-4;
                let density = (-0.5 * ((x - place) / deviation).powi(2)).exp();
                mass += density;
                mean += density * x;
                square += density * x * x;
            }
            let variance = square / mass - (mean / mass).powi(2);
            let found = seen.size[0].powi(-2);
            if width <= 2.0 {
                assert!(
                    (found / variance - 1.0).abs() < 0.3,
                    "{width} {place}: {found} {variance}"
                );
                assert!(
                    (seen.place[0] - mean / mass).abs() < 0.06,
                    "{width} {place}: {seen:?}"
                );
            } else if width >= 20.0 {
                approx::assert_abs_diff_eq!(found, deviation * deviation, epsilon = 5e-6);
            }
            // It stays one Gaussian on one line: both frames tell the same.
            let f = seen.footprint;
            approx::assert_abs_diff_eq!(f.mean[0], 0.4 * (seen.place[0] - 0.5), epsilon = 1e-9);
            approx::assert_abs_diff_eq!(f.covariance[0], 0.16 * found, epsilon = 1e-9);
            approx::assert_abs_diff_eq!(f.covariance[1], 0.04 * found, epsilon = 1e-9);
            approx::assert_abs_diff_eq!(f.covariance[2], 0.01 * found + 1e-4, epsilon = 1e-9);
        }
    }
}

#[test]
fn coverage_of_a_part_is_of_the_part_and_no_more_than_all_of_it() {
    // Half of the footprint on the card, full there.
    assert_eq!(
        card::on_card([0.1, 0.2, 0.1, 0.1], 0.5),
        [0.2, 0.4, 0.2, 0.2]
    );
    let full: [f64; 4] = card::on_card([0.3, 0.2, 0.2, 0.1], 0.5);
    approx::assert_abs_diff_eq!(full.iter().sum::<f64>(), 1.0, epsilon = 1e-12);
    assert_eq!(card::on_card([0.0; 4], 0.02), [0.0; 4]);
}

// A sheet seen from the side, in a plane across its shaft: x from left to right, z along the normal.
const WIDTH: f64 = 20.0;
const THICKNESS: f64 = 0.3;

/// Width that the eye sees of a flat sheet, more than 0 where it sees the face that `front` says; `angle`: of the eye, from the normal.
fn seen_width(angle: f64, front: bool) -> f64 {
    let (aside, facing) = angle.sin_cos();
    let seen = |across: f64| {
        let shift = card::edge_shift(across, WIDTH, THICKNESS, facing, aside, front);
        (across - 0.5) * WIDTH * facing - shift * aside
    };
    // The middle stays.
    assert!(seen(0.5).abs() < 1e-12);
    (seen(1.0) - seen(0.0)) * if front { 1.0 } else { -1.0 }
}

#[test]
fn no_card_looks_narrower_than_its_barbs() {
    for (step, front) in (0..1440).flat_map(|step| [(step, true), (step, false)]) {
        let angle = (f64::from(step) + 0.5) * std::f64::consts::TAU / 1440.0;
        let bare = WIDTH * angle.cos() * if front { 1.0 } else { -1.0 };
        // What is turned over further shows its other face.
        let wanted = if bare > -0.1 * WIDTH {
            bare.max(THICKNESS)
        } else {
            bare
        };
        // Along the normal, what is moved is seen under the sine of its angle.
        let shown = seen_width(angle, front);
        assert!((shown - wanted).abs() < 0.03, "{angle}: {shown}, {wanted}");
    }
}

#[test]
fn the_edges_of_a_card_that_turns_over_do_not_cross() {
    // Between two rows of vertices each edge is a straight line. Bare ones would cross where the card stands edge on.
    let side = std::f64::consts::FRAC_PI_2;
    for thicknesses in [0.5, 2.0, 6.0] {
        let lean = thicknesses * THICKNESS / WIDTH;
        let rows = [side - lean, side + lean].map(|angle| seen_width(angle, true));
        for step in 0..=20 {
            let at = f64::from(step) / 20.0;
            let between = rows[0] + (rows[1] - rows[0]) * at;
            assert!(between > 0.95 * THICKNESS, "{thicknesses}: {rows:?}");
        }
    }
}

#[test]
fn an_arched_card_is_as_thick_as_its_barbs_too() {
    // Seen along its chord it shows the height of its arch, and its edges face the eye from both sides.
    for step in 0..40 {
        let height = 0.1 * f64::from(step) * THICKNESS;
        let seen = |across: f64| {
            let beside = across - 0.5;
            let slope = 8.0 * height * beside / WIDTH;
            let facing = slope / slope.hypot(1.0);
            let aside = 1.0 / slope.hypot(1.0);
            let shift = card::edge_shift(across, WIDTH, THICKNESS, facing, aside, true);
            -4.0 * height * beside * beside + shift * aside
        };
        let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(seen);
        let low = places.iter().copied().fold(f64::MAX, f64::min);
        let high = places.iter().copied().fold(f64::MIN, f64::max);
        assert!(high - low > 0.95 * THICKNESS, "{height}: {places:?}");
    }
}

/// The integral of the indicator of the half plane over the Gaussian, summed on a fine grid.
fn half_plane_by_sum(mean: [f64; 2], cov: [f64; 3], inside: impl Fn(f64, f64) -> bool) -> f64 {
    let a = cov[0].sqrt();
    let b = cov[1] / a;
    let c = (cov[2] - b * b).max(0.0).sqrt();
    let (mut sum, mut total, n) = (0.0, 0.0, 200);
    for i in 0..n {
        for j in 0..n {
            let p = (f64::from(i) + 0.5) / f64::from(n) * 10.0 - 5.0;
            let q = (f64::from(j) + 0.5) / f64::from(n) * 10.0 - 5.0;
            let weight = (-0.5 * (p * p + q * q)).exp();
            total += weight;
            if inside(mean[0] + a * p, mean[1] + b * p + c * q) {
                sum += weight;
            }
        }
    }
    sum / total
}

#[test]
fn contour_coverage_against_a_sum() {
    // A straight outline makes the half plane exact.
    let (reach_at_start, slope, angle) = (0.08, -0.05, 35f64.to_radians());
    let cot = 1.0 / angle.tan();
    let reach = |root: f64| reach_at_start + slope * root;
    for side in [-1.0, 1.0] {
        for (i, cov) in [[1e-4, 0.0, 1e-4], [2e-4, 1.2e-4, 1e-4], [1e-5, -2e-5, 2e-4]]
            .into_iter()
            .enumerate()
        {
            for k in 0..7 {
                let mean = [side * (0.03 + 0.012 * f64::from(k)), 0.4];
                let footprint = Footprint {
                    mean,
                    covariance: cov,
                };
                let there = reach(card::barb_root(mean, cot));
                let got = card::contour_coverage(&footprint, there, slope, cot);
                let want =
                    half_plane_by_sum(mean, cov, |x, y| side * x < reach(y - side * x * cot));
                assert!(
                    (got - want).abs() < 6e-3,
                    "side {side} cov {i} k {k}: {got} against {want}"
                );
                let got = card::vane_start_coverage(&footprint, 0.33, cot);
                let want = half_plane_by_sum(mean, cov, |x, y| y - side * x * cot > 0.33);
                assert!(
                    (got - want).abs() < 6e-3,
                    "start, side {side} cov {i} k {k}: {got} against {want}"
                );
            }
        }
    }
    for odd in [0.0f32, -0.0, 1e30, -1e30] {
        let point = Footprint {
            mean: [odd, 0.5],
            covariance: [0.0; 3],
        };
        let cotangent = card::barb_cotangent(0.0, 1.0);
        let coverage = card::contour_coverage(&point, 0.1, 3.0, cotangent);
        assert!((0.0..=1.0).contains(&coverage), "{odd}: {coverage}");
    }
}

#[test]
fn hooks_end_at_the_rim_and_in_the_down() {
    let at = |share: f64, root: f64| card::hooked(share * 0.1, root, 0.1, 0.3, 0.4);
    assert_eq!(at(0.5, 0.8), 1.0);
    assert_eq!(at(0.95, 0.8), 0.0);
    assert_eq!(at(0.5, 0.2), 0.0);
    approx::assert_abs_diff_eq!(at(0.7, 0.8), 0.5, epsilon = 1e-9);
    approx::assert_abs_diff_eq!(at(0.2, 0.4), 0.5, epsilon = 1e-9);
    assert_eq!(card::hooked(0.1, 0.0, 0.1, 0.0, 0.0), 1.0);
    assert_eq!(card::barbule_factor(1.0), 1.0);
    assert_eq!(card::barbule_factor(0.0), card::LOOSE_BARBULES);
}
