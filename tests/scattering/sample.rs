//! Importance sampling: density, weights and edges (docs/book/scattering.md#sampling).

use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use plumage_tests::fibres::*;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::f64::consts::PI;

const RINGS: usize = 20;
const SECTORS: usize = 24;

fn fibres() -> Vec<Fibre> {
    let flat = |aspect, fibre: Fibre| Fibre { aspect, ..fibre };
    vec![
        pigment(0.85, 2.0, 0.4),
        pigment(0.5, 6.0, 0.7),
        structural(0.8),
        structural(0.5),
        structural(0.0),
        flat(0.5, structural(0.6)),
        flat(0.3, pigment(0.85, 1.0, 0.2)),
    ]
}

fn prepare(fibre: &Fibre, albedo: [f64; 3], theta: f64, dark_back: f64) -> FibreShading<f64> {
    let table = FibreTable::build(fibre);
    let (p, row) = (table.fibre(), table.row(theta.cos()));
    fibre_shading(&p, &row, albedo, direction(theta, 0.64), dark_back, 8)
}

/// Standard normal deviate of a chi-square value (Wilson and Hilferty).
fn deviate(chi: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((chi / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Chi-square deviate, sum of the density, mean and largest weight of `count` samples.
fn judge(s: &FibreShading<f64>, count: usize, seed: u64) -> [f64; 4] {
    let mut random = Pcg64Mcg::new(seed.into());
    let mut seen = vec![0.0; RINGS * SECTORS];
    let (mut mean, mut largest) = (0.0, 0.0_f64);
    for _ in 0..count {
        let u = [0; 4].map(|_| uniform(&mut random));
        let Some(sample) = fibre_sample(s, u) else {
            continue;
        };
        let d = sample.direction;
        assert!((d.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9);
        assert!((fibre_pdf(s, d) - sample.pdf).abs() <= 1e-5 * sample.pdf);
        mean += sample.weight[1] / count as f64;
        largest = largest.max(sample.weight[1]);
        let ring = ((d[0] + 1.0) * 0.5 * RINGS as f64) as usize;
        let sector = ((d[1].atan2(d[2]) + PI) / (2.0 * PI) * SECTORS as f64) as usize;
        seen[ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1)] += 1.0;
    }
    let (mut chi, mut freedom, mut total) = (0.0, -1.0, 0.0);
    let fine = 12;
    let area = 4.0 * PI / (RINGS * SECTORS) as f64;
    for (at, seen) in seen.iter().enumerate() {
        let mut expected = 0.0;
        for k in 0..fine * fine {
            let x =
                ((at / SECTORS) as f64 + ((k % fine) as f64 + 0.5) / fine as f64) / RINGS as f64;
            let y =
                ((at % SECTORS) as f64 + ((k / fine) as f64 + 0.5) / fine as f64) / SECTORS as f64;
            expected += fibre_pdf(s, direction((2.0 * x - 1.0).asin(), PI * (2.0 * y - 1.0)));
        }
        let expected = expected / (fine * fine) as f64 * area;
        total += expected;
        let expected = expected * count as f64;
        if expected > 20.0 {
            chi += (seen - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    [deviate(chi, freedom), total, mean, largest]
}

#[test]
fn samples_have_the_density_they_claim() {
    let mut cases = Vec::new();
    for (i, fibre) in fibres().into_iter().enumerate() {
        for theta in [0.0, 0.7, 1.3_f64] {
            cases.push((i, fibre, theta, None));
        }
        // Each lobe alone.
        for lobe in 0..4 {
            cases.push((i, fibre, 0.7, Some(lobe)));
        }
    }
    cases.into_par_iter().for_each(|(i, fibre, theta, lobe)| {
        let mut s = prepare(&fibre, [0.7, 0.4, 0.2], theta, 0.0);
        if let Some(lobe) = lobe {
            if s.energy[lobe][1] < 1e-6 {
                return;
            }
            for other in (0..4).filter(|l| *l != lobe) {
                s.energy[other] = [0.0; 3];
            }
        }
        let albedo = fibre_albedo(&s)[1];
        let [chi, total, mean, _] = judge(&s, 60_000, 11 + i as u64);
        let name = format!("{fibre:?} theta {theta} lobe {lobe:?}");
        assert!(
            (total - 1.0).abs() <= 0.005,
            "{name}: the density sums to {total}"
        );
        assert!(
            (mean / albedo - 1.0).abs() <= 0.01,
            "{name}: {mean} of {albedo}"
        );
        assert!(chi < 3.72, "{name}: chi-square is {chi:.1} deviations high");
    });
}

#[test]
fn white_fibres_have_weight_one() {
    for fibre in fibres() {
        let table = FibreTable::build(&fibre);
        for theta in [0.0, 0.7, 1.3_f64] {
            let mut s = prepare(&fibre, [1.0; 3], theta, 0.0);
            let row = table.row(theta.cos());
            let entering = (1.0 - s.energy[0][0]) / (1.0 - row[0][0]);
            for (energy, row) in s.energy.iter_mut().zip(row[0]).skip(1) {
                *energy = [row * entering; 3];
            }
            s.dense = [0.0; 3];
            let [_, _, mean, largest] = judge(&s, 20_000, 5);
            assert!((mean - 1.0).abs() < 0.01, "{fibre:?}: {mean}");
            // R of a flat fibre is sampled from the blurred series and evaluated in closed form.
            let bound = if fibre.aspect < 1.0 { 2.5 } else { 1.001 };
            assert!(largest <= bound, "{fibre:?} {theta}: {largest}");
        }
    }
}

#[test]
fn a_dark_back_is_sampled_where_it_is_not_dark() {
    let table = FibreTable::build(&structural(0.8));
    let o = [0.0, 0.0, -1.0];
    let s = fibre_shading(&table.fibre(), &table.row(1.0), [0.8; 3], o, 1.0, 8);
    assert!(fibre_lobe_chances(&s)[3] < 0.4);
    let truth = furnace(&s, 0.0, 96)[0];
    let [_, _, mean, _] = judge(&s, 60_000, 3);
    assert!((mean / truth - 1.0).abs() < 0.02, "{mean} of {truth}");
}

#[test]
fn series_are_inverted() {
    let s = prepare(&structural(0.3), [0.5; 3], 0.4, 0.0);
    for series in s.series {
        for i in 0..=64 {
            let u = f64::from(i) / 64.0;
            let phi = fibre_invert_series(&series, u);
            let sum: f64 = (0..8)
                .map(|n| series[n] * ((n + 1) as f64 * phi).sin() / (n + 1) as f64)
                .sum();
            let back = 0.5 + (phi + sum) / (2.0 * PI);
            assert!((back - u).abs() < 1e-4, "{u}: {back}");
        }
    }
}

#[test]
fn sampling_survives_its_edges() {
    for fibre in fibres() {
        let table = FibreTable::build(&fibre);
        let albedo = [0.0, 1.0, f64::NAN];
        let s = fibre_shading(
            &table.fibre(),
            &table.row(0.0),
            albedo,
            [1.0, 0.0, 0.0],
            1.0,
            8,
        );
        let edge = 1.0 - 0.5_f64.powi(24);
        for a in [0.0, edge, 1.0] {
            for b in [0.0, edge, f64::NAN] {
                for u in [[a, b, a, b], [b, a, b, a], [a, a, b, b]] {
                    if let Some(sample) = fibre_sample(&s, u) {
                        let values = sample.direction.iter().chain(&sample.weight);
                        assert!(values.chain(&[sample.pdf]).all(|x| x.is_finite()));
                        assert!(sample.pdf > 0.0);
                    }
                }
            }
        }
    }
}
