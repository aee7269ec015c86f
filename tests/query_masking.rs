//! Masking against rays cast at real cylinders.
mod common;

use bevy_plumage::query::{Vane, mask_strip, mask_vane};

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

#[test]
fn row_of_barbs() {
    // Barbs along y (alpha_b close to upright makes n_b almost x): rays are cast in the plane across them.
    let (sin, cos) = 0.4f64.sin_cos();
    for view in views() {
        for radius in [0.05, 0.2, 0.4] {
            let vane = Vane::new(1.0, 0.2, 0.4, 0.7, radius, 0.02, 0.02);
            // n_b = (cos, sin), v_b = (-sin, cos): `view` is given along n_b, v_b, n.
            let canonical = [
                view[0] * cos - view[1] * sin,
                view[0] * sin + view[1] * cos,
                view[2],
            ];
            let cell = mask_vane(&vane, canonical);
            let axes: Vec<f64> = (-1200..=1200).map(f64::from).collect();
            let near: Vec<f64> = if view[2] > 0.1 {
                axes[1150..1251].to_vec()
            } else {
                axes
            };
            let steps = 500;
            let covered = (0..steps)
                .filter(|i| {
                    hidden(
                        (f64::from(*i) + 0.5) / f64::from(steps),
                        view,
                        &near,
                        radius,
                        radius,
                    )
                })
                .count() as f64
                / f64::from(steps);
            let open = cell.v_high - cell.v_low;
            assert!(
                (1.0 - open - covered).abs() < 3.0 / f64::from(steps),
                "{view:?} {radius}: {} against {covered}",
                1.0 - open
            );
            for i in 0..steps {
                let u = (f64::from(i) + 0.5) / f64::from(steps);
                let inside = u > cell.v_low + 2e-3 && u < cell.v_high - 2e-3;
                assert!(
                    !(inside && hidden(u, view, &near, radius, radius)),
                    "{view:?}: {u} is hidden, {cell:?}"
                );
            }
        }
    }
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
