//! Masking against rays cast at real cylinders.

use bevy_plumage::anatomy::Side;
use bevy_plumage::maths::query::{
    Vane, mask_strip, mask_vane, mean_coverage, storeys, vane_shape, vane_stop,
};

/// Whether the ray from the eye direction `view` to the surface point `x` along `r` (the fibre's bitangent; the third
/// component of `view` is the normal's, the second the fibre's own) meets one of the upper half cylinders with the given axes.
fn hidden(x: f64, view: [f64; 3], axes: &[f64], radius_r: f64, radius_n: f64) -> bool {
    axes.iter().any(|axis| {
        // Points (x, 0) + l (v_r, v_n), l >= 0, in the plane across the fibre, scaled to a unit circle.
        let p = (x - axis) / radius_r;
        let d = [view[0] / radius_r, view[2] / radius_n];
        let a = d[0] * d[0] + d[1] * d[1];
        if a < 1e-30 {
            return p.abs() < 1.0;
        }
        // Nearest approach of the half line to the axis.
        let l = (-p * d[0] / a).max(0.0);
        (p + l * d[0]).powi(2) + (l * d[1]).powi(2) < 1.0
    })
}

/// Views towards the eye: straight down, along the fibre, across it, up to 89.9 degrees.
fn views() -> Vec<[f64; 3]> {
    let mut views = Vec::new();
    for theta in [0.0f64, 5.0, 10.0, 30.0, 45.0, 60.0, 70.5, 80.0, 88.0, 89.9] {
        for azimuth in [
            0.0f64, 20.0, 45.0, 80.0, 89.0, 89.9, 90.0, 135.0, 180.0, 250.0, 270.0, 330.0,
        ] {
            let (sin, cos) = theta.to_radians().sin_cos();
            let (y, x) = azimuth.to_radians().sin_cos();
            views.push([sin * x, sin * y, cos]);
        }
    }
    views
}

/// End of the hidden interval around 0 on the side of `direction`, by bisection.
fn reach(direction: f64, view: [f64; 3], radius_r: f64, radius_n: f64) -> f64 {
    let (mut inside, mut outside) = (0.0, 1e5);
    for _ in 0..80 {
        let middle = 0.5 * (inside + outside);
        if hidden(direction * middle, view, &[0.0], radius_r, radius_n) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[test]
fn one_cylinder() {
    for view in views() {
        for (radius_r, radius_n) in [(1.0, 1.0), (1.0, 0.4), (0.5, 1.0)] {
            let [below, above] = mask_strip(radius_r, radius_n, view[0], view[2]);
            let cast = [
                reach(-1.0, view, radius_r, radius_n),
                reach(1.0, view, radius_r, radius_n),
            ];
            assert!(
                (below - cast[0]).abs() < 1e-6 * cast[0].max(1.0),
                "{view:?}: {below} against {cast:?}"
            );
            assert!(
                (above - cast[1]).abs() < 1e-6 * cast[1].max(1.0),
                "{view:?}: {above} against {cast:?}"
            );
        }
    }
}

/// A vane without end as round tubes: barbs along the second axis, two storeys of barbules that touch, cut at the flanks.
struct Tubes {
    vane: Vane<f64>,
}

impl Tubes {
    /// What the whole line through a point of the plane in direction `view` (across and along the barbs, up) meets first, counted
    /// from the eye: 0 barb, 1 distal, 2 proximal, 3 nothing.
    fn first(&self, point: [f64; 2], view: [f64; 3]) -> usize {
        let v = &self.vane;
        let lift = 0.5 * (v.r_bd + v.r_bp);
        let tall = v.r_b.max(lift + v.r_bd.max(v.r_bp));
        let slope = [view[0] / view[2].abs(), view[1] / view[2].abs()];
        let reach = [0, 1].map(|i| slope[i].abs() * tall + 1e-9);
        let (mut best, mut part) = (f64::NEG_INFINITY, 3);
        let root_step = v.p_b * v.cos_b / v.sin_b;
        let gaps = |x: f64| (x / v.p_b).floor() as i64;
        for k in gaps(point[0] - reach[0]) - 1..=gaps(point[0] + reach[0]) + 1 {
            let axis = k as f64 * v.p_b;
            if let Some(t) = last_within([point[0] - axis, 0.0], [view[0], view[2]], v.r_b)
                && t > best
            {
                (best, part) = (t, 0);
            }
            for (family, sign, r, z, owner) in
                [(1, 1.0, v.r_bd, lift, k), (2, -1.0, v.r_bp, -lift, k + 1)]
            {
                // Along and across the barbules of this gap; `across` counts their roots.
                let (sin, cos) = (sign * v.sin_bl, v.cos_bl);
                let off = point[0] - owner as f64 * v.p_b;
                let across = |x: f64, y: f64| y * sin.abs() - x * cos * sign;
                let here = across(off, point[1] - owner as f64 * root_step);
                let per_height = across(slope[0], slope[1]).abs();
                let period = v.p_bl();
                let span = per_height * tall + 2.0 * r;
                for j in
                    ((here - span) / period).floor() as i64..=((here + span) / period).ceil() as i64
                {
                    let section = [here - j as f64 * period, -z];
                    let Some(t) = last_within(section, [across(view[0], view[1]), view[2]], r)
                    else {
                        continue;
                    };
                    // Between the flanks; a line may enter through the cut.
                    let inside = |t: f64| {
                        let x = point[0] + t * view[0] - axis;
                        x >= v.r_b && x <= v.p_b - v.r_b
                    };
                    let enter = if inside(t) {
                        Some(t)
                    } else {
                        let x = [v.r_b, v.p_b - v.r_b].map(|x| (x + axis - point[0]) / view[0]);
                        let cut = x[0].max(x[1]);
                        let within = (section[0] + cut * across(view[0], view[1])).powi(2)
                            + (cut * view[2] - z).powi(2)
                            <= r * r;
                        (cut < t && within).then_some(cut)
                    };
                    if let Some(t) = enter
                        && t > best
                    {
                        (best, part) = (t, family);
                    }
                }
            }
        }
        part
    }

    fn shares(&self, view: [f64; 3]) -> [f64; 4] {
        const SIDE: usize = 90;
        let mut counts = [0.0; 4];
        let step = self.vane.p_b * self.vane.cos_b / self.vane.sin_b;
        for i in 0..SIDE {
            for j in 0..SIDE {
                let u = (i as f64 + 0.5) / SIDE as f64;
                // Every row begins elsewhere, lest the lattice beats with the barbules.
                let w = (j as f64 + (0.618_034 * i as f64).fract()) / SIDE as f64;
                let point = [u * self.vane.p_b, u * step + w * self.vane.d_bl];
                counts[self.first(point, view)] += 1.0;
            }
        }
        counts.map(|c| c / (SIDE * SIDE) as f64)
    }
}

/// Largest `t` for which `origin + t direction` is in a circle around 0.
fn last_within(origin: [f64; 2], direction: [f64; 2], radius: f64) -> Option<f64> {
    let a = direction[0] * direction[0] + direction[1] * direction[1];
    let b = origin[0] * direction[0] + origin[1] * direction[1];
    let c = origin[0] * origin[0] + origin[1] * origin[1] - radius * radius;
    let root = b * b - a * c;
    (root >= 0.0 && a > 1e-12).then(|| (-b + root.sqrt()) / a)
}

/// Vanes of three presets in micrometres: a macaw's covert and remex, an eagle's contour feather.
fn vanes() -> [Vane<f64>; 3] {
    [
        (380.0, 38.0, 14.0, 34.5, 37.5),
        (450.0, 33.0, 30.0, 34.5, 40.0),
        (550.0, 42.0, 17.5, 35.5, 37.5),
    ]
    .map(
        |(pitch, angle, barb, spacing, barbule): (f64, f64, f64, f64, f64)| {
            let angle = angle.to_radians();
            let period = pitch * angle.sin();
            Vane::new(period, spacing, angle, barbule.to_radians(), barb, 6.0, 5.5)
        },
    )
}

/// A direction across and along the barbs and up, in the canonical frame.
fn canonical(vane: &Vane<f64>, [s, t, n]: [f64; 3]) -> [f64; 3] {
    [
        s * vane.cos_b - t * vane.sin_b,
        s * vane.sin_b + t * vane.cos_b,
        n,
    ]
}

#[test]
fn coverage_is_that_of_whole_tubes() {
    let mut worst = 0.0_f64;
    for vane in vanes() {
        let tubes = Tubes { vane };
        for theta in [0.0_f64, 30.0, 45.0, 60.0, 75.0] {
            for azimuth in [0.0_f64, 45.0, 90.0, 135.0, 180.0] {
                for side in [1.0, -1.0] {
                    let (sin, cos) = theta.to_radians().sin_cos();
                    let (y, x) = azimuth.to_radians().sin_cos();
                    let view = [sin * x, sin * y, side * cos];
                    let cell = mask_vane(&vane, canonical(&vane, view));
                    let [barb, upper, lower] = mean_coverage(&cell);
                    let [distal, proximal] = if side > 0.0 {
                        [upper, lower]
                    } else {
                        [lower, upper]
                    };
                    let cast = tubes.shares(view);
                    let model = [barb, distal, proximal, 1.0 - barb - upper - lower];
                    for (a, b) in model.into_iter().zip(cast) {
                        worst = worst.max((a - b).abs());
                    }
                    let straight = azimuth.rem_euclid(90.0) == 0.0;
                    let limit = if straight { 0.01 } else { 0.03 };
                    assert!(
                        model
                            .into_iter()
                            .zip(cast)
                            .all(|(a, b)| (a - b).abs() < limit),
                        "{theta} {azimuth} {side}: {model:.4?}, tubes {cast:.4?}"
                    );
                }
            }
        }
    }
    println!("largest difference of coverage to explicit tubes: {worst:.4}");
}

#[test]
fn every_view_is_finite() {
    let vane = Vane::new(0.004f32, 0.0004, 0.6, 0.7, 4e-4, 5e-5, 5e-5);
    let odd = [
        0.0f32,
        -0.0,
        1.0,
        -1.0,
        1e-20,
        1e20,
        f32::INFINITY,
        f32::NAN,
        1e-7,
    ];
    for x in odd {
        for y in odd {
            for z in odd {
                let c = mask_vane(&vane, [x, y, z]);
                let all = [
                    c.kappa, c.e_root, c.v_low, c.v_high, c.h_d, c.h_p, c.s_d, c.s_p,
                ];
                assert!(all.iter().all(|v| v.is_finite()), "{x} {y} {z}: {c:?}");
                assert!(
                    c.v_low >= 0.0
                        && c.v_high >= c.v_low
                        && c.v_high <= 1.0
                        && c.h_d <= 0.5
                        && c.h_p <= 0.5,
                    "{c:?}"
                );
            }
        }
    }
}

/// How the families of a vane lie to each other matters little for what all of them stop.
#[test]
fn families_that_know_nothing_of_each_other_stop_as_much() {
    let mut largest = 0.0f64;
    for feather in plumage_tests::shipped::feathers() {
        for (side, loose) in [(Side::Left, 1.0), (Side::Right, 1.0), (Side::Left, 0.35)] {
            let vane = Vane {
                hooked: loose,
                ..feather.query_vane::<f64>(side)
            };
            let shape = vane_shape(&vane);
            for view in views() {
                for view in [view, view.map(|x| -x)] {
                    let stopped = vane_stop(&shape, &storeys(&shape, view));
                    let covered: f64 = mean_coverage(&mask_vane(&vane, view)).iter().sum();
                    largest = largest.max((stopped - covered).abs());
                }
            }
        }
    }
    println!("off by at most {largest:.4}");
    assert!(largest < 0.01, "{largest}");
}

#[test]
fn edge_on_closes_up() {
    let vane = Vane::new(0.004f64, 0.0004, 0.6, 0.7, 4e-4, 5e-5, 5e-5);
    let cell = mask_vane(&vane, [0.8, 0.6, 0.0]);
    assert!(cell.v_high - cell.v_low < 1e-12, "{cell:?}");
    let above = mask_vane(&vane, [0.0, 0.0, 1.0]);
    assert!(
        (above.v_low - 0.1).abs() < 1e-12 && (above.v_high - 0.9).abs() < 1e-12 && above.s_d == 0.0
    );
}
