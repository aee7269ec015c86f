//! The explicit curves judged on their own and against the range query, with which they share no code.

use bevy_plumage::anatomy::{Feather, Side};
use bevy_plumage::maths::query::ErrorBudget;
use bevy_plumage::maths::scattering::{
    Fibre, FibreKind, FibreTable, fibre_albedo, fibre_evaluate, fibre_shading, kept_at, kept_light,
    multiple_scattering,
};
use bevy_plumage::maths::{Footprint, query};
use plumage_reference::curves::{
    CurveCamera, CurveHit, CurveOptions, CurveShader, Curves, Part, Ray, Visibility, furnace_path,
    near_field, normal_quantile,
};
use plumage_reference::fibre_traced::uniform;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// A small closed vane with a straight shaft.
fn vane() -> Feather {
    let mut feather = plumage_tests::shipped::feathers()
        .into_iter()
        .find(|f| f.name == "macaw_lesser")
        .unwrap();
    feather.rachis.curve = vec![0.5; 4];
    feather.gaps.count = 0;
    for vane in [&mut feather.left, &mut feather.right] {
        vane.fringe = 0.0;
        vane.downy = 0.0;
    }
    feather
}

/// The same with twice the barbs and closer barbules.
fn dense_vane() -> Feather {
    let mut feather = vane();
    for vane in [&mut feather.left, &mut feather.right] {
        vane.barb_count *= 2.0;
        vane.barbules.spacing_um *= 0.86;
    }
    feather
}

/// Rays towards a Gaussian of deviation `sigma` around a point of the card, seen along `direction`; share per part, last: none.
fn shares(curves: &Curves, at: [f64; 2], sigma: f64, direction: [f64; 3]) -> [f64; 5] {
    let n = 160;
    let counts = (0..n)
        .into_par_iter()
        .map(|i| {
            // Stratified: a plain grid would beat with the barbules.
            let mut random = Pcg64Mcg::new(u128::from(i) + 1);
            let mut place = |i: u32| {
                sigma * normal_quantile((f64::from(i) + uniform(&mut random)) / f64::from(n))
            };
            let mut row = [0.0; 5];
            for j in 0..n {
                let p = [at[0] + place(i), at[1] + place(j), 0.0];
                let ray = Ray {
                    origin: [0, 1, 2].map(|k| p[k] - 2.0 * direction[k]),
                    direction,
                };
                let part = curves
                    .hit(&ray, f64::NEG_INFINITY, None)
                    .map_or(4, |hit| hit.fibre.part as usize);
                row[part] += 1.0;
            }
            row
        })
        .reduce(|| [0.0; 5], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    counts.map(|c| c / f64::from(n * n))
}

#[test]
fn coverage_of_rays_is_that_of_the_range_query() {
    let feather = vane();
    let curves = Curves::build(&feather);
    let (left, right) = (
        feather.query_vane(Side::Left),
        feather.query_vane(Side::Right),
    );
    let budget = ErrorBudget::default();
    let mut largest = 0.0_f64;
    for at in [[-0.11, 0.5], [0.09, 0.55], [-0.1034, 0.6071], [0.0, 0.5]] {
        // From a third of a barbule's period to two barb periods.
        for sigma in [2e-4, 1e-3, 5e-3, 2e-2] {
            for side in [1.0, -1.0] {
                let view = [0.0, 0.0, side];
                let radius = f64::from(feather.r_r(at[1] as f32));
                let c = query::feather_coverage(
                    &left,
                    &right,
                    radius,
                    &Footprint::round(at, sigma),
                    view,
                    &budget,
                );
                let rays = shares(&curves, at, sigma, [0.0, 0.0, -side]);
                for (a, b) in [c.rachis, c.barb, c.distal, c.proximal]
                    .into_iter()
                    .zip(rays)
                {
                    largest = largest.max((a - b).abs());
                }
            }
        }
    }
    println!("largest difference of coverage to the range query: {largest:.4}");
    assert!(largest < 0.015, "{largest}");
}

#[test]
fn a_hit_lies_on_its_fibre() {
    let feather = vane();
    let curves = Curves::build(&feather);
    let direction = [0.3, -0.2, -0.93];
    let mut seen = [0; 4];
    let mut cut = 0;
    for i in 0..4000 {
        let p = [
            -0.2 + 0.4 * f64::from(i % 63) / 63.0,
            0.2 + 0.6 * f64::from(i) / 4000.0,
            0.0,
        ];
        let ray = Ray {
            origin: [0, 1, 2].map(|k| p[k] - direction[k]),
            direction,
        };
        let Some(hit) = curves.hit(&ray, f64::NEG_INFINITY, None) else {
            continue;
        };
        seen[hit.fibre.part as usize] += 1;
        let off: [f64; 3] = [0, 1, 2].map(|k| hit.point[k] - hit.axis[k]);
        let along: f64 = (0..3).map(|k| off[k] * hit.tangent[k]).sum();
        let across = (off[0] * hit.tangent[1] - off[1] * hit.tangent[0]) / hit.radius[0];
        let on = across.hypot(off[2] / hit.radius[1]);
        // Barbules are cut along the flanks of the barbs: a few rays meet the cut.
        cut += usize::from(on < 1.0 - 1e-6);
        assert!(
            along.abs() < 1e-9 && on < 1.0 + 1e-6,
            "{hit:?}: {along} {on}"
        );
        assert!(hit.offset.abs() <= 1.0 && hit.tangent[1] > 0.0);
        // Nothing lies before it.
        let again = curves
            .hit(&ray, hit.distance - 1e-9, None)
            .map(|h: CurveHit| h.fibre);
        assert_eq!(again, Some(hit.fibre));
    }
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
    assert!(cut < 40, "{cut}");
}

#[test]
fn front_and_back_show_their_own_barbules() {
    let feather = vane();
    let curves = Curves::build(&feather);
    let front = shares(&curves, [-0.1, 0.5], 0.01, [0.0, 0.0, -1.0]);
    let back = shares(&curves, [-0.1, 0.5], 0.01, [0.0, 0.0, 1.0]);
    assert!(front[Part::Distal as usize] > front[Part::Proximal as usize]);
    assert!(back[Part::Proximal as usize] > back[Part::Distal as usize]);
    assert!(
        (front[4] - back[4]).abs() < 0.002,
        "holes are the same from both sides"
    );
}

#[test]
fn the_mean_of_the_near_field_is_the_far_field() {
    let structural = Fibre {
        kind: FibreKind::Structural { core_radius: 0.8 },
        ..Fibre::default()
    };
    let mut worst = 0.0_f64;
    for fibre in [Fibre::default(), structural] {
        let table = FibreTable::build(&fibre);
        for (theta_o, theta_i, phi) in [
            (0.0_f64, 0.1_f64, 0.4_f64),
            (0.5, -0.4, 2.8),
            (-0.6, 0.7, -1.3),
        ] {
            let eye = [
                theta_o.sin(),
                0.3_f64.sin() * theta_o.cos(),
                0.3_f64.cos() * theta_o.cos(),
            ];
            let a = 0.3 + phi;
            let light = [
                theta_i.sin(),
                a.sin() * theta_i.cos(),
                a.cos() * theta_i.cos(),
            ];
            let albedo = [0.6, 0.3, 0.1];
            let s = fibre_shading(
                &table.fibre(),
                &table.row(theta_o.cos()),
                albedo,
                eye,
                1.0,
                8,
            );
            let far = fibre_evaluate(&s, light);
            let n = 2000;
            let mut near = [0.0; 3];
            for i in 0..n {
                let h = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                let k = near_field(&fibre, &table, albedo, eye, light, h, 1.0);
                (0..3).for_each(|c| near[c] += k[c] / f64::from(n));
            }
            for c in 0..3 {
                worst = worst.max((near[c] - far[c]).abs() / far[0]);
            }
        }
    }
    println!("mean of the near field against the far field: {worst:.4}");
    assert!(worst < 0.04, "{worst}");
}

#[test]
fn shadows_of_neighbors_fall_where_they_should() {
    let feather = vane();
    let curves = Curves::build(&feather);
    let options = CurveOptions {
        visibility: Visibility::Traced,
        ..CurveOptions::default()
    };
    let shader = CurveShader::new(&feather, [0.5; 3], options);
    // Mean over the visible fibres of the share that a light reaches.
    let lit = |light: [f64; 3]| {
        let l = light.iter().map(|x| x * x).sum::<f64>().sqrt();
        let light = light.map(|x| x / l);
        let mut random = Pcg64Mcg::new(3);
        let (mut sum, mut count) = (0.0, 0);
        for _ in 0..4000 {
            let p = [
                -0.1 + 0.02 * uniform(&mut random),
                0.5 + 0.02 * uniform(&mut random),
            ];
            let ray = Ray {
                origin: [p[0], p[1], 1.0],
                direction: [0.0, 0.0, -1.0],
            };
            if let Some(hit) = curves.hit(&ray, f64::NEG_INFINITY, None) {
                sum += shader
                    .reach(
                        &curves,
                        &hit,
                        [[0.0, 0.0, 1.0], light],
                        uniform(&mut random),
                        0.0,
                        false,
                    )
                    .even;
                count += 1;
            }
        }
        sum / f64::from(count)
    };
    let (above, slanted, low, behind) = (
        lit([0.0, 0.0, 1.0]),
        lit([1.0, 0.0, 0.6]),
        lit([1.0, 0.0, 0.15]),
        lit([0.0, 0.0, -1.0]),
    );
    println!("lit share: above {above:.3}, slanted {slanted:.3}, low {low:.3}, behind {behind:.3}");
    // The light at the eye sees what the eye sees, all but the parts of those fibres under others.
    assert!(above > 0.75 && above <= 1.0);
    assert!(slanted < above && low < slanted && behind < above);
}

/// Share of a white furnace's light that comes back from rays that hit, and its p in `a (1 - p) / (1 - p a)`.
fn furnace(curves: &Curves, shader: &CurveShader, albedo: f64, tilt: f64) -> (f64, f64) {
    let direction = [-0.8 * tilt.sin(), -0.6 * tilt.sin(), -tilt.cos()];
    let n = 120;
    let (sum, count) = (0..n)
        .into_par_iter()
        .map(|i| {
            let mut random = Pcg64Mcg::new(i as u128 + 1);
            let (mut sum, mut count) = (0.0, 0.0);
            for j in 0..n {
                let p = [
                    -0.1 + 0.05 * (f64::from(i) + 0.4) / f64::from(n),
                    0.55 + 0.05 * (f64::from(j) + 0.6) / f64::from(n),
                    0.0,
                ];
                let ray = Ray {
                    origin: [0, 1, 2].map(|k| p[k] - 2.0 * direction[k]),
                    direction,
                };
                if let Some(escape) = furnace_path(curves, shader, ray, [albedo; 3], 64, || {
                    uniform(&mut random)
                }) {
                    sum += escape.weight[0];
                    count += 1.0;
                }
            }
            (sum, count)
        })
        .reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let total = sum / count;
    (total, (albedo - total) / (albedo * (1.0 - total)))
}

#[test]
fn several_bounces_through_a_dense_vane_are_what_the_closed_form_says() {
    let feather = dense_vane();
    let curves = Curves::build(&feather);
    let shader = CurveShader::new(&feather, [0.5; 3], CurveOptions::default());
    // What fibres keep of light from all around, each by what shows of it. Paths leave a fibre anywhere.
    let optics = &feather.optics;
    let tables = [optics.rachis, optics.barb, optics.distal, optics.proximal]
        .map(|fibre| FibreTable::build(&fibre));
    let eye = [0.0, 0.0, 1.0];
    let light = kept_light(
        &feather.query_vane(Side::Left),
        tables.each_ref(),
        0.0,
        true,
    );
    let seen = shares(&curves, [-0.08, 0.58], 0.01, [0.0, 0.0, -1.0]);
    let kept: f64 = (1..4)
        .map(|i| {
            let energy = tables[i].row(1.0)[0];
            let sides = light[i].each_ref().map(|side| kept_at(side, eye));
            let share: f64 = (0..4)
                .map(|k| energy[k] * (sides[0][k] + sides[1][k]))
                .sum();
            seen[i] * share / energy.iter().sum::<f64>()
        })
        .sum();
    let meeting = 1.0 - kept / (1..4).map(|i| seen[i]).sum::<f64>();
    for albedo in [0.3, 0.9] {
        let (total, p) = furnace(&curves, &shader, albedo, 0.0);
        let table = FibreTable::build(&feather.optics.distal);
        let s = fibre_shading(
            &table.fibre(),
            &table.row(1.0),
            [albedo; 3],
            [0.0, 0.0, 1.0],
            0.0,
            8,
        );
        let a = fibre_albedo(&s);
        let model = (1.0 - meeting) * a[0] + multiple_scattering(a, [meeting; 3], 0.0).spread[0];
        println!(
            "fibre albedo {albedo}: traced {total:.4}, closed form at p = {meeting:.3} {model:.4}, fitted p {p:.3}"
        );
        assert!((model / total - 1.0).abs() < 0.04, "{model} {total}");
    }
}

#[test]
fn a_picture_is_deterministic_and_energy_is_bounded() {
    let feather = vane();
    let curves = Curves::build(&feather);
    let mut shader = CurveShader::new(
        &feather,
        [0.5; 3],
        CurveOptions {
            environment_samples: 4,
            ..CurveOptions::default()
        },
    );
    shader.environment = |_| [1.0; 3];
    let camera = CurveCamera::looking_at(
        [-0.1, 0.5, 1.0],
        [-0.1, 0.5, 0.0],
        [0.0, 1.0, 0.0],
        0.002,
        false,
        [8, 4],
    );
    let row = camera.row(&curves, &shader, 2, 4, 1);
    assert_eq!(row, camera.row(&curves, &shader, 2, 4, 1));
    for p in row {
        assert!(p[3] > 0.5 && p[3] <= 1.0);
        assert!(p[..3].iter().all(|c| (0.0..=1.0).contains(c)), "{p:?}");
    }
}

#[test]
fn quantiles_are_those_of_the_normal_distribution() {
    for (p, z) in [
        (0.5, 0.0),
        (0.975, 1.959_963_985),
        (0.001, -3.090_232_306),
        (0.8413447461, 1.0),
    ] {
        assert!((normal_quantile(p) - z).abs() < 1e-7, "{p}");
    }
    assert!(normal_quantile(0.0).is_finite() && normal_quantile(1.0).is_finite());
}

#[test]
fn memory_is_counted() {
    let curves = Curves::build(&vane());
    let [barbs, barbules] = curves.counts();
    assert!(barbs > 80 && barbules > 30_000, "{barbs} {barbules}");
    assert!(curves.bytes() > 24 * barbules && curves.curve_bytes() > curves.bytes());
}
