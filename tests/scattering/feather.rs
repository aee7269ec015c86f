//! The whole feather, importance sampling and sheen.

use bevy_plumage::maths::scattering::*;
use std::f64::consts::PI;

fn fibres() -> [Fibre; 4] {
    let structural = |core_radius| Fibre {
        kind: FibreKind::Structural { core_radius },
        ..Fibre::default()
    };
    [
        Fibre::default(),
        structural(0.8),
        structural(0.5),
        Fibre {
            longitudinal_roughness: 0.4,
            ..structural(0.0)
        },
    ]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let l = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / l)
}

fn prepare(
    fibre: &Fibre,
    tangent: [f64; 3],
    normal: [f64; 3],
    omega_o: [f64; 3],
    albedo: [f64; 3],
) -> FibreShading<f64> {
    let table = FibreTable::build(fibre);
    let o = fibre_local(tangent, normal, omega_o);
    let cos = (o[1] * o[1] + o[2] * o[2]).sqrt();
    fibre_shading(&table.fibre(), &table.row(cos), albedo, o, 0.0, 8)
}

/// The four parts on a card whose normal is +z, tangents fanned out in its plane.
fn parts(
    omega_o: [f64; 3],
    weights: [f64; 4],
    reached: [f64; 4],
    white: bool,
) -> [FeatherPart<f64>; 4] {
    let normal = [0.0, 0.0, 1.0];
    let list = fibres();
    std::array::from_fn(|i| {
        let turn = 0.8 * i as f64;
        let tangent = [turn.sin(), turn.cos(), 0.0];
        let mut shading = prepare(&list[i], tangent, normal, omega_o, [0.995; 3]);
        if white {
            let table = FibreTable::build(&list[i]);
            let o = fibre_local(tangent, normal, omega_o);
            let row = table.row((o[1] * o[1] + o[2] * o[2]).sqrt());
            shading.energy = row[0].map(|e| [e; 3]);
            shading.dense = [0.0; 3];
        }
        FeatherPart {
            weight: weights[i],
            reached: reached[i],
            tangent,
            shading,
        }
    })
}

/// Evenly spread directions on the sphere.
fn sphere(count: usize) -> impl Iterator<Item = [f64; 3]> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let r = (1.0 - z * z).sqrt();
        let (s, c) = (golden * i as f64).sin_cos();
        [r * c, r * s, z]
    })
}

#[test]
fn a_white_feather_passes_the_furnace() {
    let mut worst: f64 = 0.0;
    for (weights, through) in [([0.1, 0.3, 0.4, 0.2], 0.0), ([0.0, 0.25, 0.25, 0.1], 0.4)] {
        for o in [
            [0.0, 0.0, 1.0],
            [0.5, 0.1, 0.6],
            [-0.9, 0.3, 0.15],
            [0.3, 0.3, -0.8],
        ] {
            let p = parts(unit(o), weights, [1.0; 4], true);
            let n = 60_000;
            let sum: f64 = sphere(n)
                .map(|i| feather_bsdf(&p, [0.0, 0.0, 1.0], i)[1])
                .sum::<f64>()
                * 4.0
                * PI
                / n as f64;
            worst = worst.max((sum + through - 1.0).abs());
            assert!(
                (sum + through - 1.0).abs() < 0.02,
                "{o:?}: {}",
                sum + through
            );
        }
    }
    println!("white furnace of the feather: worst {worst:.4}");
}

#[test]
fn light_from_behind_comes_through() {
    let o = [0.0, 0.0, 1.0];
    let normal = [0.0, 0.0, 1.0];
    let i = unit([0.2, 0.0, -0.9]);
    let p = parts(o, [0.0, 0.0, 0.0, 1.0], [1.0; 4], false);
    assert!(feather_bsdf(&p, normal, i)[0] > 0.05);
    let p = parts(o, [f64::NAN, -1.0, 0.0, 0.0], [1.0; 4], false);
    assert_eq!(feather_bsdf(&p, normal, i), [0.0; 3]);
}

#[test]
fn the_sheen_table_is_read_the_right_way_round() {
    let at = |i: usize, j: usize| sheen_table()[i * SHEEN_TABLE_SIZE + j];
    assert!((at(1, 2)[0] - 0.018_95).abs() < 1e-5 && (at(1, 2)[1] + 0.002_18).abs() < 1e-5);
    assert!((at(1, 2)[2] - 0.097_68).abs() < 1e-5);
    assert!((at(0, 31)[2] - 0.749_73).abs() < 1e-5 && (at(31, 31)[2] - 0.341_875).abs() < 1e-6);
    let mut before = f64::INFINITY;
    for k in 0..32 {
        let r = sheen_lookup(f64::from(k) / 31.0, 0.5)[2];
        assert!(r < before, "sheen must fall from grazing to head on");
        before = r;
    }
    assert!((sheen_lookup(0.25, 0.5_f64)[2] - 0.368).abs() < 0.004);
    assert_eq!(sheen_row(0.5)[31][2], sheen_lookup(1.0_f32, 0.5)[2]);
}

#[test]
fn sheen_scatters_exactly_its_albedo() {
    let n = [0.0, 0.0, 1.0];
    for alpha in [0.1, 0.2, 0.5, 1.0_f64] {
        for cos in [0.02, 0.1, 0.3, 0.7, 1.0_f64] {
            let ltc = sheen_lookup(cos, alpha);
            if ltc[2] < 1e-4 {
                continue;
            }
            let o = [(1.0 - cos * cos).sqrt(), 0.0, cos];
            // Squares in z crowd samples at the horizon, where the lobe is.
            let (rings, sectors) = (3000, 900);
            let mut sum = 0.0;
            for i in 0..rings {
                let t = (f64::from(i) + 0.5) / f64::from(rings);
                let (z, dz) = (t.powi(3), 3.0 * t * t / f64::from(rings));
                let r = (1.0 - z * z).sqrt();
                for k in 0..sectors {
                    // Crowd around azimuth 0, where a narrow lobe is too.
                    let v = -1.0 + 2.0 * (f64::from(k) + 0.5) / f64::from(sectors);
                    let (phi, dphi) = (PI * v.powi(3), PI * 3.0 * v * v * 2.0 / f64::from(sectors));
                    sum += sheen_evaluate(ltc, n, o, [r * phi.cos(), r * phi.sin(), z]) * dz * dphi;
                }
            }
            assert!(
                (sum / ltc[2] - 1.0).abs() < 2e-3,
                "alpha {alpha} cos {cos}: {sum} against {}",
                ltc[2]
            );
            assert!(sheen_albedo(ltc, 0.3) <= 0.3 && sheen_albedo(ltc, f64::NAN) == 0.0);
            // A white base under the sheen of any color.
            for tint in [sheen_tint([1.0; 3]), sheen_tint([0.0, 0.5, 1.0])] {
                let base = 1.0 - sheen_albedo(ltc, 1.0) * tint[2];
                assert!(
                    tint.iter()
                        .all(|t| base + sheen_albedo(ltc, 1.0) * t <= 1.0 + 1e-12)
                );
            }
        }
    }
    let ltc = sheen_lookup(0.5, 0.5_f64);
    assert_eq!(
        sheen_evaluate(ltc, n, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
        0.0
    );
    assert_eq!(
        sheen_evaluate(ltc, n, [0.0, 0.0, f64::NAN], [0.0, 0.0, 1.0]),
        0.0
    );
    assert!(sheen_evaluate(ltc, n, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]).is_finite());
}

#[test]
fn multiple_scattering_returns_the_wanted_albedo() {
    for p in [0.0, 0.3, 0.5, 0.9] {
        for a in [0.0, 0.1, 0.5, 1.0_f64] {
            let one = single_scattering_albedo([a; 3], p);
            assert!((shown_albedo(one[0], p) - a).abs() < 1e-12);
            for parallel in [0.0, PARALLEL_MEETINGS] {
                let more = multiple_scattering(one, [p; 3], parallel);
                let all = more.cone[0] * (1.0 - p) * one[0] + more.spread[0];
                assert!((all - a).abs() < 1e-12);
                assert!(more.spread[0] >= 0.0 && more.cone[0] >= 1.0);
            }
        }
    }
    assert!(single_scattering_albedo([f64::NAN; 3], f64::NAN)[0].is_finite());
    assert!(multiple_scattering([1.0_f64; 3], [1.0; 3], 1.0).spread[0].is_finite());
}

#[test]
fn the_printed_model_loses_energy_as_the_book_says() {
    use plumage_reference::fibre_published::{PublishedFibre, published_evaluate};
    let fibre = PublishedFibre {
        eta: 1.55,
        core: 0.8,
        reflectance: 1.0,
        absorption: 0.0,
        longitudinal_roughness: 0.1,
        azimuthal_roughness: 0.3,
        tilt: 0.0,
        nodes: 32,
    };
    let furnace = |theta_o: f64| {
        let (n, m) = (600, 24);
        let mut sum = 0.0;
        for i in 0..n {
            let t = -0.5 * PI + PI * (f64::from(i) + 0.5) / f64::from(n);
            for k in 0..m {
                let phi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(m);
                sum += published_evaluate(&fibre, t, theta_o, phi) * t.cos() * PI / f64::from(n)
                    * 2.0
                    * PI
                    / f64::from(m);
            }
        }
        sum
    };
    let (head_on, grazing) = (furnace(0.0), furnace(1.5));
    println!("printed model, white furnace: {head_on:.3} head on, {grazing:.3} at 1.5");
    assert!((head_on - 0.937).abs() < 0.01 && (grazing - 0.58).abs() < 0.01);
}
