//! The lobe of a side that mirrors: energy, reciprocity, its sampler (docs/book/iridescence.md#lobe).

use bevy_plumage::maths::functions::Real;
use bevy_plumage::maths::scattering::interference::*;
use plumage_tests::shipped::{stack, stacks};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const FLATNESSES: [f64; 5] = [0.05, 0.1, 0.2, 0.5, 1.0];
const ANGLES: [f64; 7] = [0.0, 0.3, 0.7, 1.0, 1.3, 1.5, 1.57];

fn white() -> StackTable {
    StackTable::single(vec![[1.0; 3]; STACK_TEXELS])
}

/// Different in every channel and with the angle.
fn colored() -> StackTable {
    let texel = |i: usize| {
        let c = i as f64 / (STACK_TEXELS - 1) as f64;
        [
            0.2 + 0.7 * (1.0 - c),
            0.5 + 0.3 * (9.0 * c).sin(),
            0.1 + 0.8 * c * c,
        ]
    };
    StackTable::single((0..STACK_TEXELS).map(texel).collect())
}

/// An eye before facets of which nothing is tabled yet.
fn eye_at<T: Real>(facets: &Facets<T>, table: &StackTable, omega_o: [T; 3]) -> FacetEye<T> {
    let double = |x: T| x.to_f64().expect("a number");
    let whole = Facets {
        flatness: double(facets.flatness),
        slope: double(facets.slope),
        back: double(facets.back),
    };
    let seen = SeenTable::build(&whole, table);
    facet_eye(facets, &seen, table, T::one(), omega_o)
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [
        theta.sin(),
        theta.cos() * phi.sin(),
        theta.cos() * phi.cos(),
    ]
}

/// Directions of a low-discrepancy sequence.
fn sphere(i: usize) -> [f64; 3] {
    let (u, v) = (
        (i as f64 * 0.754_877_666).fract(),
        (i as f64 * 0.569_840_291).fract(),
    );
    direction((2.0 * u - 1.0).asin(), TAU * v)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Calls with every direction of the light that some normal mirrors into the eye, and the solid angle that it stands for.
fn for_each_mirror(
    eye: &FacetEye<f64>,
    (around, along): (usize, usize),
    mut call: impl FnMut([f64; 3], f64),
) {
    let (a, slope) = (eye.facets.flatness, eye.facets.slope);
    for i in 0..around {
        // Even steps of the ellipse's parameter crowd where its normals do.
        let (sin, cos) = ((i as f64 + 0.5) / around as f64 * TAU).sin_cos();
        let (y, z) = (a * sin, cos);
        let size = y.hypot(z);
        for j in 0..along {
            let l = slope * 12.0 * ((j as f64 + 0.5) / along as f64 - 0.5);
            let normal = [l.sin(), l.cos() * y / size, l.cos() * z / size];
            let facing = dot(normal, eye.omega);
            if l.abs() >= FRAC_PI_2 || facing <= 1e-9 {
                continue;
            }
            let light = std::array::from_fn(|k| 2.0 * facing * normal[k] - eye.omega[k]);
            let area =
                l.cos() * slope * 12.0 / along as f64 * a / (size * size) * TAU / around as f64;
            call(light, 4.0 * facing * area);
        }
    }
}

/// Integral of K over the light's directions.
fn furnace(eye: &FacetEye<f64>, table: &StackTable) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for_each_mirror(eye, (720, 161), |light, weight| {
        let k = facet_evaluate(eye, table, light);
        sum = std::array::from_fn(|c| sum[c] + k[c] * weight);
    });
    sum
}

#[test]
fn white_facets_return_what_arrives() {
    let white = white();
    let ends: Vec<[f64; 2]> = FLATNESSES
        .into_par_iter()
        .map(|flatness| {
            let mut ends = [9.0_f64, 0.0];
            for degrees in [2.0_f64, 5.0, 8.0, 12.0, 16.0, 20.0] {
                let facets = Facets {
                    flatness,
                    slope: degrees.to_radians(),
                    back: 1.0,
                };
                let seen = SeenTable::build(&facets, &white);
                for theta in ANGLES {
                    for phi in ANGLES {
                        let eye = facet_eye(&facets, &seen, &white, 1.0, direction(theta, phi));
                        assert!((eye.energy[0] - 1.0).abs() < 1e-12);
                        let found = furnace(&eye, &white)[1];
                        assert!(
                            (0.88..=1.01).contains(&found),
                            "{flatness} {degrees} {theta} {phi}: {found}"
                        );
                        ends = [ends[0].min(found), ends[1].max(found)];
                    }
                }
            }
            ends
        })
        .collect();
    let low = ends.iter().map(|e| e[0]).fold(9.0, f64::min);
    let high = ends.iter().map(|e| e[1]).fold(0.0, f64::max);
    println!("white furnace of facets: {low:.4} to {high:.4}");
}

/// Between its texels the table of what an eye sees is the rule that it was made by.
#[test]
fn what_an_eye_sees_is_tabled() {
    let worst = ["anna_gorget", "peacock_green", "pigeon_green"]
        .into_par_iter()
        .map(|name| {
            let table = StackTable::build(&stack(name));
            let mut worst = [0.0_f64; 2];
            for flatness in FLATNESSES {
                for slope in [0.035, 0.14, 0.34] {
                    let facets = Facets {
                        flatness,
                        slope,
                        back: 1.0,
                    };
                    let seen = SeenTable::build(&facets, &table);
                    for i in 0..600 {
                        let omega = sphere(i);
                        let view = facet_view(&facets, omega);
                        let (mut area, mut energy) = (0.0, [0.0; 3]);
                        for node in 0..200 {
                            let angle = (f64::from(node) + 0.5) / 200.0 * PI - FRAC_PI_2;
                            let [cosine, part] = facet_node(&facets, &view, angle.sin_cos());
                            let color = table.color(cosine);
                            area += part * FRAC_PI_2 / 200.0;
                            energy = std::array::from_fn(|c| {
                                energy[c] + part * color[c] * FRAC_PI_2 / 200.0
                            });
                        }
                        let eye = facet_eye(&facets, &seen, &table, 1.0, omega);
                        worst[0] = worst[0].max((eye.area / area - 1.0).abs());
                        for (found, wanted) in eye.energy.iter().zip(energy) {
                            worst[1] = worst[1].max((found - wanted / area).abs());
                        }
                    }
                }
            }
            worst
        })
        .reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
    println!(
        "tabled eyes: area within {:.4}, energy within {:.4}",
        worst[0], worst[1]
    );
    assert!(worst[0] < 0.02 && worst[1] < 0.04, "{worst:?}");
}

/// The energy that is kept out of the fibre is the one that the lobe gives back.
#[test]
fn the_energy_of_a_stack_is_its_lobes() {
    let mut worst = 0.0_f64;
    for name in ["anna_gorget", "peacock_green", "pigeon_green"] {
        let parameters = stack(name);
        let table = StackTable::build(&parameters);
        let facets = Facets {
            flatness: f64::from(parameters.flatness),
            slope: f64::from(parameters.slope).to_radians(),
            back: 1.0,
        };
        for theta in [0.0, 0.4, 0.8, 1.2] {
            for phi in [0.0, 0.5, 1.0, 1.4] {
                let eye = eye_at(&facets, &table, direction(theta, phi));
                let found = furnace(&eye, &table);
                for (found, energy) in found.iter().zip(eye.energy) {
                    worst = worst.max((found - energy).abs());
                }
            }
        }
    }
    println!("energy of stacks: off by at most {worst:.4}");
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn facets_are_reciprocal_and_take_their_color_half_way() {
    let (white, colored) = (white(), colored());
    let mut worst = [0.0_f64; 2];
    let slopes = [0.05, 0.09, 0.17, 0.34];
    let sides: Vec<_> = (0..20)
        .into_par_iter()
        .map(|i| {
            let facets = Facets {
                flatness: FLATNESSES[i % 5],
                slope: slopes[i / 5],
                back: 1.0,
            };
            let [white, colored] = [&white, &colored].map(|t| SeenTable::build(&facets, t));
            (facets, white, colored)
        })
        .collect();
    for i in 0..2_000 {
        let (side, seen_white, seen) = &sides[i / 3 % 20];
        let facets = Facets {
            back: [1.0, 0.3, 0.0][i % 3],
            ..*side
        };
        let (o, l) = (sphere(i + 1), sphere(3 * i + 7));
        let (there, back) = (
            facet_eye(&facets, seen, &colored, 1.0, o),
            facet_eye(&facets, seen, &colored, 1.0, l),
        );
        let one = facet_evaluate(&there, &colored, l).map(|k| k * there.area);
        let two = facet_evaluate(&back, &colored, o).map(|k| k * back.area);
        let off = (0..3)
            .map(|c| (one[c] - two[c]).abs() / one[c].max(1e-9))
            .fold(0.0, f64::max);
        // In single precision too, relative to a lobe's peak.
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let small = Facets {
            flatness: facets.flatness as f32,
            slope: facets.slope as f32,
            back: facets.back as f32,
        };
        let there32 = facet_eye(&small, seen, &colored, 1.0, single(o));
        let k32 = facet_evaluate(&there32, &colored, single(l));
        let k = facet_evaluate(&there, &colored, l);
        let peak = facet_density(&facets, [0.0, 0.0, 1.0]) / (4.0 * there.area);
        let coarse = (0..3)
            .map(|c| (f64::from(k32[c]) - k[c]).abs() / peak)
            .fold(0.0, f64::max);
        assert!(off < 1e-9 && coarse < 1e-4, "{i}: {off:e} {coarse:e}");
        worst = [worst[0].max(off), worst[1].max(coarse)];

        let full = Facets {
            back: 1.0,
            ..facets
        };
        let plain = facet_evaluate(&facet_eye(&full, seen_white, &white, 1.0, o), &white, l)[0];
        let tinted = facet_evaluate(&facet_eye(&full, seen, &colored, 1.0, o), &colored, l);
        let half = 0.5 * (0..3).map(|k| (o[k] + l[k]).powi(2)).sum::<f64>().sqrt();
        let color = colored.color(half);
        for c in 0..3 {
            assert!((tinted[c] - plain * color[c]).abs() <= 1e-6 * plain);
        }
    }
    println!(
        "reciprocity {:.1e}, single precision {:.1e} of the peak",
        worst[0], worst[1]
    );
}

/// Standard normal deviate of a chi-square value (Wilson and Hilferty 1931).
fn deviate(chi: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((chi / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[test]
fn samples_have_the_density_they_claim() {
    let (white, table) = (white(), colored());
    let cases: Vec<_> = FLATNESSES
        .into_iter()
        .flat_map(|a| [0.06, 0.15, 0.3].map(|s| (a, s)))
        .flat_map(|(a, s)| [0.0, 0.7, 1.2].map(|theta| (a, s, theta)))
        .collect();
    cases.into_par_iter().for_each(|(flatness, slope, theta)| {
        let facets = Facets {
            flatness,
            slope,
            back: 1.0,
        };
        let name = format!("{flatness} {slope} {theta}");
        let eye = eye_at(&facets, &table, direction(theta, 0.64));
        let (rings, sectors) = (16, 20);
        let bin = |d: [f64; 3]| {
            let ring = ((d[0] + 1.0) * 0.5 * rings as f64) as usize;
            let sector = ((d[1].atan2(d[2]) + PI) / TAU * sectors as f64) as usize;
            ring.min(rings - 1) * sectors + sector.min(sectors - 1)
        };
        let count = 60_000_u64;
        let mut seen = vec![0.0; rings * sectors];
        let mut mean = 0.0;
        let mut state = 0x2545_f491_4f6c_dd1d_u64 ^ (flatness * 1e6 + slope * 1e4 + theta) as u64;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..count {
            let Some(sample) = facet_sample(&eye, [uniform(), uniform(), uniform()]) else {
                continue;
            };
            let d = sample.direction;
            assert!((dot(d, d) - 1.0).abs() < 1e-9, "{name}");
            assert!(
                (facet_pdf(&eye, d) / sample.pdf - 1.0).abs() < 1e-5,
                "{name}"
            );
            mean += facet_evaluate(&eye, &white, d)[1] / sample.pdf / count as f64;
            seen[bin(d)] += 1.0;
        }
        // The density's own integral over every bin, over normals: there it has no pole.
        let mut wanted = vec![0.0; rings * sectors];
        for_each_mirror(&eye, (2_880, 600), |light, weight| {
            let at = bin(light);
            wanted[at] += facet_pdf(&eye, light) * weight;
        });
        let total: f64 = wanted.iter().sum();
        let (mut chi, mut freedom) = (0.0, -1.0);
        for (seen, wanted) in seen.iter().zip(&wanted) {
            let expected = wanted * count as f64;
            if expected > 20.0 {
                chi += (seen - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        let energy = furnace(&eye, &white)[1];
        let chi = deviate(chi, freedom);
        assert!(
            (total - 1.0).abs() < 0.005,
            "{name}: the density sums to {total}"
        );
        assert!(
            (mean / energy - 1.0).abs() < 0.02,
            "{name}: {mean} of {energy}"
        );
        assert!(chi < 3.72, "{name}: chi-square is {chi:.1} deviations high");
    });
}

#[test]
fn a_lean_turns_the_mirror() {
    let facets = Facets {
        flatness: 0.2,
        slope: 0.1,
        back: 1.0,
    };
    let table = white();
    for (rise, lean) in [(0.0_f64, 0.3_f64), (0.2, 0.0), (0.2, -0.4)] {
        let turn = |v: [f64; 3]| facet_turn(v, rise.sin_cos(), lean.sin_cos());
        // Angles stay, and the side's own normal comes to rest on its z.
        let (u, v) = (sphere(5), sphere(11));
        assert!((dot(turn(u), turn(v)) - dot(u, v)).abs() < 1e-12);
        let normal = [
            -rise.sin() * lean.cos(),
            lean.sin(),
            rise.cos() * lean.cos(),
        ];
        let found = turn(normal);
        assert!((found[2] - 1.0).abs() < 1e-12, "{found:?}");
        // The flash of an eye on the fibre's normal is where the mirrored eye is: twice the angle away.
        let o = [0.0, 0.0, 1.0];
        let eye = eye_at(&facets, &table, turn(o));
        let facing = dot(normal, o);
        let mirrored: [f64; 3] = std::array::from_fn(|k| 2.0 * facing * normal[k] - o[k]);
        let flash = facet_evaluate(&eye, &table, turn(mirrored))[1];
        for i in 0..2_000 {
            assert!(facet_evaluate(&eye, &table, sphere(i))[1] <= flash * (1.0 + 1e-9));
        }
    }
}

/// Light at the eye, the feather turned about its barbules: the flash of a gorget is narrow.
#[test]
fn a_gorget_flashes_in_a_narrow_cone() {
    let parameters = stack("anna_gorget");
    let table = StackTable::build(&parameters);
    let facets = Facets {
        flatness: f64::from(parameters.flatness),
        slope: f64::from(parameters.slope).to_radians(),
        back: 1.0,
    };
    let luminance = |degrees: f64| {
        let o = direction(0.0, degrees.to_radians());
        let eye = eye_at(&facets, &table, o);
        let k = facet_evaluate(&eye, &table, o);
        0.2126 * k[0] + 0.7152 * k[1] + 0.0722 * k[2]
    };
    let peak = luminance(0.0);
    let half = (0..300)
        .map(|i| f64::from(i) * 0.1)
        .find(|d| luminance(*d) < 0.5 * peak)
        .unwrap_or(99.0);
    let share = [10.0, 30.0, 60.0].map(|d| luminance(d) / peak);
    println!("gorget: half at {half:.1} degrees, {share:.3?} at 10, 30, 60");
    assert!((6.0..=8.0).contains(&half), "{half}");
    assert!((0.15..=0.4).contains(&share[0]) && share[1] <= 0.05 && share[2] <= 0.03);
}

#[test]
fn edges_are_finite() {
    let table = colored();
    let axes = [1.0, -1.0].into_iter().flat_map(|s| {
        [
            [s, 0.0, 0.0],
            [0.0, s, 0.0],
            [0.0, 0.0, s],
            [0.6 * s, 0.8, 0.0],
        ]
    });
    let axes: Vec<[f64; 3]> = axes.collect();
    for flatness in [0.05, 1.0] {
        for slope in [0.035, 0.349] {
            for back in [0.0, 1.0] {
                let facets = Facets {
                    flatness,
                    slope,
                    back,
                };
                for o in &axes {
                    let eye = eye_at(&facets, &table, *o);
                    assert!(eye.area > 0.0 && eye.energy.iter().all(|e| (0.0..=1.0).contains(e)));
                    for l in &axes {
                        let k = facet_evaluate(&eye, &table, *l);
                        assert!(
                            k.iter().all(|k| k.is_finite() && *k >= 0.0),
                            "{o:?} {l:?}: {k:?}"
                        );
                        assert!(facet_pdf(&eye, *l).is_finite());
                    }
                    for u in [[0.0; 3], [1.0; 3], [0.5, 0.0, 0.25], [0.0, 1.0, 0.5]] {
                        if let Some(sample) = facet_sample(&eye, u) {
                            assert!(sample.direction.iter().all(|x| x.is_finite()));
                        }
                    }
                }
            }
        }
    }
    // All presets lie in the lobe's range.
    assert_eq!(stacks().len(), 19);
    for (name, parameters) in stacks() {
        assert_eq!(parameters, parameters.limited(), "{name}");
    }
}
