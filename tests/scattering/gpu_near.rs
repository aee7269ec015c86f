//! The shader twins of the near field and of sampling against the double-precision functions of the crate.

use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use plumage_tests::cases::*;
use plumage_tests::gpu::run;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

const FILES: [&str; 5] = [
    "math.wgsl",
    "scattering.wgsl",
    "scattering_azimuth.wgsl",
    "scattering_near.wgsl",
    "scattering_sample.wgsl",
];

const ENTRY: &str = "
#import bevy_plumage::scattering as scattering
#import bevy_plumage::scattering_near as near
#import bevy_plumage::scattering_sample as sample
const CASE_FLOATS: u32 = 18u;

fn evaluate(i: u32) {
    let at = u32(input[0]) * FIBRE_FLOATS + 4u + i * CASE_FLOATS;
    let fibre = 4u + u32(input[at]) * FIBRE_FLOATS;
    let albedo = vec3<f32>(input[at + 1u], input[at + 2u], input[at + 3u]);
    let omega_o = vec3<f32>(input[at + 4u], input[at + 5u], input[at + 6u]);
    let omega_i = vec3<f32>(input[at + 7u], input[at + 8u], input[at + 9u]);
    let p = scattering::fibre_parameters(load_parameters(fibre));
    let place = scattering::fibre_row_at(length(omega_o.yz));
    let low = fibre + 28u + place.index * 52u;
    let row = scattering::fibre_row_mix(load_row(low), load_row(low + 52u), place.fraction);
    let window = near::fibre_window(input[at + 12u], input[at + 13u]);
    let seen = near::fibre_near(p, row, albedo, omega_o, input[at + 10u], u32(input[at + 11u]), window);
    let k = near::fibre_near_evaluate(seen, omega_i);
    let s = scattering::fibre_shading(p, row, albedo, omega_o, input[at + 10u], u32(input[at + 11u]));
    let chooser = sample::fibre_sampler(s);
    let drawn = sample::fibre_sample(s, chooser, load(at + 14u));
    let out = i * 12u;
    output[out] = k.x;
    output[out + 1u] = k.y;
    output[out + 2u] = k.z;
    output[out + 3u] = sample::fibre_pdf(s, chooser, omega_i);
    output[out + 4u] = drawn.direction.x;
    output[out + 5u] = drawn.direction.y;
    output[out + 6u] = drawn.direction.z;
    output[out + 7u] = drawn.pdf;
    output[out + 8u] = drawn.weight.x;
    output[out + 9u] = drawn.weight.y;
    output[out + 10u] = drawn.weight.z;
    output[out + 11u] = dot(chooser.chances, vec4<f32>(1.0, 2.0, 4.0, 8.0));
}
";

/// A case, its footprint across the fibre and its random numbers.
struct Drawn {
    case: Case,
    footprint: [f32; 2],
    u: [f32; 4],
}

fn pack_drawn(tables: &[FibreTable], list: &[Drawn]) -> Vec<f32> {
    let mut input = pack(tables, &[]);
    for d in list {
        let c = &d.case;
        input.push(c.fibre as f32);
        input.extend(c.albedo.iter().chain(&c.omega_o).chain(&c.omega_i));
        input.extend([c.dark_back, c.harmonics as f32]);
        input.extend(d.footprint.iter().chain(&d.u));
    }
    input
}

/// 12 numbers a case, as `ENTRY` writes them; none where there is no adapter.
fn evaluated(tables: &[FibreTable], cases: &[Drawn]) -> Option<Vec<f32>> {
    let count = cases.len();
    run(
        &FILES,
        &[ENTRY, LOAD].concat(),
        &pack_drawn(tables, cases),
        count,
        count * 12,
    )
}

fn random_case(random: &mut Pcg64Mcg, fibre: usize, k: usize) -> Drawn {
    let omega_o = on_sphere(random);
    let mut omega_i = on_sphere(random);
    if k.is_multiple_of(2) {
        // Near the mirror cone, where narrow lobes are.
        let x = (-omega_o[0] + 0.1 * omega_i[0]).clamp(-1.0, 1.0);
        let across = omega_i[1].hypot(omega_i[2]).max(1e-6);
        let s = (1.0 - x * x).max(0.0).sqrt() / across;
        omega_i = [x, omega_i[1] * s, omega_i[2] * s];
    }
    Drawn {
        case: Case {
            fibre,
            albedo: [0; 3].map(|_| uniform(random) as f32),
            omega_o,
            omega_i,
            dark_back: (k / 2 % 2) as f32,
            harmonics: [8, 3][k / 4 % 2],
        },
        footprint: [
            (2.4 * uniform(random) - 1.2) as f32,
            (0.02 * 100.0_f64.powf(uniform(random))) as f32,
        ],
        u: [0; 4].map(|_| uniform(random) as f32),
    }
}

#[test]
fn near_field_and_sampling_agree_with_the_crate() {
    let list = fibres();
    let tables: Vec<FibreTable> = list.iter().map(FibreTable::build).collect();
    let mut random = Pcg64Mcg::new(77);
    let mut cases: Vec<Drawn> = (0..10_240)
        .map(|k| random_case(&mut random, k % list.len(), k / list.len()))
        .collect();
    let axes = [
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    for fibre in 0..list.len() {
        for omega_o in axes {
            for (u, mean) in [(0.0, -2.0), (1.0, 1e9), (0.999_999_94, 0.0)] {
                cases.push(Drawn {
                    case: Case {
                        fibre,
                        albedo: [u, 1e9, 0.0],
                        omega_o,
                        omega_i: axes[fibre % 4],
                        dark_back: 1.0,
                        harmonics: 8,
                    },
                    footprint: [mean, u * 1e3],
                    u: [u; 4],
                });
            }
        }
    }
    let Some(out) = evaluated(&tables, &cases) else {
        return;
    };
    let (mut worst, mut off, mut compared) = ([0.0_f64; 4], 0, 0);
    for (i, d) in cases.iter().enumerate() {
        let got: Vec<f64> = out[i * 12..i * 12 + 12]
            .iter()
            .map(|x| f64::from(*x))
            .collect();
        assert!(got.iter().all(|x| x.is_finite()), "{i}: {got:?}");
        assert!(got[..4].iter().all(|x| *x >= 0.0), "{i}: {got:?}");
        if i >= 10_240 {
            continue;
        }
        let c = &d.case;
        let table = &tables[c.fibre];
        let row = exact_row(table, c);
        let p = {
            let [p, q, r, ..] = table.pack_parameters().map(|v| v.map(f64::from));
            fibre_parameters(p, q, r)
        };
        let omega_i = c.omega_i.map(f64::from);
        let near = fibre_near(
            &p,
            &row,
            c.albedo.map(f64::from),
            c.omega_o.map(f64::from),
            f64::from(c.dark_back),
            c.harmonics,
            fibre_window(f64::from(d.footprint[0]), f64::from(d.footprint[1])),
        );
        let k = fibre_near_evaluate(&near, omega_i);
        let beta = p.longitudinal_roughness;
        let peak = (0.4 / (0.5 * beta)).max(1.0) / PI / p.aspect;
        for ch in 0..3 {
            worst[0] = worst[0].max((got[ch] - k[ch]).abs() / (k[ch] + peak));
        }
        let s = shade(table, c);
        let pdf = fibre_pdf(&s, omega_i);
        worst[1] = worst[1].max((got[3] - pdf).abs() / (pdf + peak));
        // Its own density at the direction it drew.
        let direction = [got[4], got[5], got[6]];
        let own = fibre_pdf(&s, direction);
        worst[2] = worst[2].max((got[7] - own).abs() / (own + peak));
        let u = d.u.map(f64::from);
        if let Some(wanted) = fibre_sample(&s, u) {
            compared += 1;
            let apart = (0..3)
                .map(|k| (wanted.direction[k] - direction[k]).powi(2))
                .sum::<f64>();
            // A number just beside the border of two lobes may fall on either side of it.
            if apart.sqrt() > 5e-3 {
                off += 1;
            } else if wanted.pdf > 1e-3 {
                for ch in 0..3 {
                    let e = (got[8 + ch] - wanted.weight[ch]).abs();
                    worst[3] = worst[3].max(e / (wanted.weight[ch] + 1.0));
                }
            }
        }
        let chances = fibre_lobe_chances(&s);
        let sum = chances[0] + 2.0 * chances[1] + 4.0 * chances[2] + 8.0 * chances[3];
        assert!((got[11] - sum).abs() < 1e-4, "{i}: {} {sum}", got[11]);
    }
    println!(
        "twins: near field {:.1e} of the peak, density {:.1e}, drawn density {:.1e}, weight {:.1e}, {off} of {compared} elsewhere",
        worst[0], worst[1], worst[2], worst[3]
    );
    assert!(
        worst[..3].iter().all(|w| *w < 5e-5) && worst[3] < 1e-3,
        "{worst:?}"
    );
    assert!(off * 200 < compared, "{off} of {compared} samples differ");
}

#[test]
fn the_shader_draws_what_the_density_says() {
    let list = fibres();
    let tables: Vec<FibreTable> = list.iter().map(FibreTable::build).collect();
    let mut random = Pcg64Mcg::new(8);
    let count = 16_384;
    for fibre in [0, 2, 4, 5] {
        let first = random_case(&mut random, fibre, 0).case;
        let cases: Vec<Drawn> = (0..count)
            .map(|_| Drawn {
                case: Case { ..first },
                footprint: [0.0, 1.0],
                u: [0; 4].map(|_| uniform(&mut random) as f32),
            })
            .collect();
        let Some(out) = evaluated(&tables, &cases) else {
            return;
        };
        let s = shade(&tables[fibre], &first);
        let (rings, sectors) = (10, 12);
        let (mut seen, mut expected) = (vec![0.0; rings * sectors], vec![0.0; rings * sectors]);
        let mut mean = 0.0;
        for sample in out.chunks_exact(12) {
            let [x, y, z] = [sample[4], sample[5], sample[6]].map(f64::from);
            let ring = ((x + 1.0) * 0.5 * rings as f64) as usize;
            let sector = ((y.atan2(z) + PI) / (2.0 * PI) * sectors as f64) as usize;
            seen[ring.min(rings - 1) * sectors + sector.min(sectors - 1)] += 1.0;
            mean += f64::from(sample[9]) / count as f64;
        }
        let fine = 24;
        for (at, e) in expected.iter_mut().enumerate() {
            for k in 0..fine * fine {
                let x = ((at / sectors) as f64 + ((k % fine) as f64 + 0.5) / fine as f64)
                    / rings as f64;
                let y = ((at % sectors) as f64 + ((k / fine) as f64 + 0.5) / fine as f64)
                    / sectors as f64;
                let light =
                    plumage_tests::fibres::direction((2.0 * x - 1.0).asin(), PI * (2.0 * y - 1.0));
                *e += fibre_pdf(&s, light) / (fine * fine) as f64;
            }
            *e *= 4.0 * PI / (rings * sectors) as f64 * count as f64;
        }
        let (mut chi, mut freedom) = (0.0, -1.0);
        for (s, e) in seen.iter().zip(&expected) {
            if *e > 20.0 {
                chi += (s - e).powi(2) / e;
                freedom += 1.0;
            }
        }
        let deviations = (chi - freedom) / f64::sqrt(2.0 * freedom);
        assert!(
            deviations < 4.0,
            "fibre {fibre}: chi-square {chi} of {freedom}"
        );
        let truth = plumage_tests::fibres::furnace(&s, f64::from(first.omega_o[0]).asin(), 96)[1];
        assert!(
            (mean / truth - 1.0).abs() < 0.03,
            "fibre {fibre}: {mean} of {truth}"
        );
    }
}

#[test]
fn tiers_and_tints_agree() {
    const TEXT: &str = "
#import bevy_plumage::scattering as scattering
#import bevy_plumage::scattering_near as near
#import bevy_plumage::sheen as sheen
fn evaluate(i: u32) {
    let x = input[2u * i];
    let y = input[2u * i + 1u];
    let window = near::fibre_window(x * 4.0 - 2.0, y * y * 10.0);
    output[8u * i] = scattering::i0e(8.0 * x);
    output[8u * i + 1u] = f32(scattering::fibre_terms(x, y));
    output[8u * i + 2u] = near::near_deviation(2.0 * y, x);
    output[8u * i + 3u] = sheen::sheen_tint(vec3<f32>(x)).y;
    output[8u * i + 4u] = window.x;
    output[8u * i + 5u] = window.y;
    output[8u * i + 6u] = window.z;
    output[8u * i + 7u] = window.w;
}
";
    let mut random = Pcg64Mcg::new(2);
    let count = 4096;
    let input: Vec<f32> = (0..2 * count)
        .map(|_| uniform(&mut random) as f32)
        .collect();
    let files = [FILES.as_slice(), &["sheen.wgsl"]].concat();
    let Some(out) = run(&files, TEXT, &input, count, 8 * count) else {
        return;
    };
    for i in 0..count {
        let (x, y) = (f64::from(input[2 * i]), f64::from(input[2 * i + 1]));
        let window = fibre_window(x * 4.0 - 2.0, y * y * 10.0);
        let terms = fibre_terms(x, y);
        let wanted = [
            i0e(8.0 * x),
            f64::from(terms),
            near_deviation(2.0 * y, x).unwrap_or(-1.0),
            sheen_tint([x; 3])[1],
            window.low,
            window.high,
            window.mean,
            window.sharpness,
        ];
        for (k, want) in wanted.into_iter().enumerate() {
            let got = f64::from(out[8 * i + k]);
            // Beside a step of the rounding up, either number of terms will do.
            let allowed = if k == 1 {
                1.0
            } else {
                1e-4 * want.abs().max(1.0)
            };
            assert!(
                (got - want).abs() <= allowed,
                "{k} at {x} {y}: {got} {want}"
            );
        }
    }
}
