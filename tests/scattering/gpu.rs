//! The shader twins against the double-precision functions of the crate, on random and extreme input.

use bevy_plumage::maths::gauss_legendre;
use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use plumage_tests::cases::*;
use plumage_tests::gpu::{compose, run};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{FRAC_PI_2, PI};

const ENTRY: &str = "
#import bevy_plumage::scattering as scattering
#import bevy_plumage::scattering_multiple as multiple
const CASE_FLOATS: u32 = 12u;

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
    let s = scattering::fibre_shading(p, row, albedo, omega_o, input[at + 10u], u32(input[at + 11u]));
    let k = scattering::fibre_evaluate(s, omega_i);
    let split = scattering::fibre_energy_split(s);
    let out = i * 13u;
    output[out] = k.x;
    output[out + 1u] = k.y;
    output[out + 2u] = k.z;
    output[out + 3u] = split.specular;
    output[out + 4u] = split.front.x;
    output[out + 5u] = split.front.y;
    output[out + 6u] = split.front.z;
    output[out + 7u] = split.back.x;
    output[out + 8u] = split.back.y;
    output[out + 9u] = split.back.z;
    let along = scattering::fibre_along(p, row, s.absorption, 0.7);
    output[out + 10u] = along.x + 2.0 * along.y + 3.0 * along.z;
    let local = scattering::fibre_local(omega_o, omega_i, albedo);
    let total = scattering::fibre_albedo(s);
    let one = multiple::single_scattering_albedo(total, 0.4);
    let more = multiple::multiple_scattering(one, vec3<f32>(0.4), 0.25);
    output[out + 12u] = more.spread.y + more.cone.z;
    output[out + 11u] = local.x + 2.0 * local.y + 3.0 * local.z;
}
";

/// 13 numbers a case, as `ENTRY` writes them; none where there is no adapter.
fn evaluated(tables: &[FibreTable], cases: &[Case]) -> Option<Vec<f32>> {
    let count = cases.len();
    run(
        &["scattering.wgsl", "scattering_multiple.wgsl"],
        &[ENTRY, LOAD].concat(),
        &pack(tables, cases),
        count,
        count * 13,
    )
}

#[test]
fn shader_modules_compile() {
    compose(
        &["scattering.wgsl", "sheen.wgsl"],
        "@compute @workgroup_size(1) fn main() {}",
    );
}

#[test]
fn shader_and_crate_agree() {
    let list = fibres();
    let tables: Vec<FibreTable> = list.iter().map(FibreTable::build).collect();
    let mut random = Pcg64Mcg::new(21);
    let mut cases = Vec::new();
    for k in 0..16_384 {
        let omega_o = on_sphere(&mut random);
        let mut omega_i = on_sphere(&mut random);
        // Half of the lights near the mirror cone, where narrow lobes are.
        if k % 2 == 0 {
            let x = (-omega_o[0] + 0.1 * omega_i[0]).clamp(-1.0, 1.0);
            let s = (1.0 - x * x).max(0.0).sqrt()
                / (omega_i[1] * omega_i[1] + omega_i[2] * omega_i[2])
                    .sqrt()
                    .max(1e-6);
            omega_i = [x, omega_i[1] * s, omega_i[2] * s];
        }
        cases.push(Case {
            fibre: k % list.len(),
            albedo: [0; 3].map(|_| uniform(&mut random) as f32),
            omega_o,
            omega_i,
            dark_back: (k / 8 % 2) as f32,
            harmonics: [8, 3, 4, 6][k / 16 % 4],
        });
    }
    let axes = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    for fibre in 0..list.len() {
        for omega_o in axes {
            for omega_i in axes {
                for a in [0.0, 1.0, 1e9] {
                    cases.push(Case {
                        fibre,
                        albedo: [a; 3],
                        omega_o,
                        omega_i,
                        dark_back: 1.0,
                        harmonics: 8,
                    });
                }
            }
        }
    }
    let Some(out) = evaluated(&tables, &cases) else {
        return;
    };
    let mut worst = [0.0_f64; 4];
    for (i, c) in cases.iter().enumerate() {
        let got = &out[i * 13..i * 13 + 13];
        assert!(got.iter().all(|x| x.is_finite()), "{i}: {got:?}");
        assert!(got[..11].iter().all(|x| *x >= 0.0), "{i}: {got:?}");
        let s = shade(&tables[c.fibre], c);
        let omega_i = c.omega_i.map(f64::from);
        let k = fibre_evaluate(&s, omega_i);
        // Peak of the narrowest lobe: M is about 0.4 / beta over its width, times the spread in phi.
        let beta = f64::from(list[c.fibre].longitudinal_roughness).max(0.01);
        let peak = (0.4 / (0.5 * beta)).max(1.0) / PI / f64::from(list[c.fibre].aspect);
        let split = fibre_energy_split(&s);
        for ch in 0..3 {
            let error = (f64::from(got[ch]) - k[ch]).abs() / peak;
            worst[0] = worst[0].max(error);
            let limit = 5e-5;
            assert!(
                error < limit,
                "{i} fibre {}: {} against {} (eye {:?}, light {:?})",
                c.fibre,
                got[ch],
                k[ch],
                c.omega_o,
                c.omega_i
            );
            let e = (f64::from(got[4 + ch]) - split.front[ch])
                .abs()
                .max((f64::from(got[7 + ch]) - split.back[ch]).abs());
            worst[1] = worst[1].max(e);
        }
        worst[1] = worst[1].max((f64::from(got[3]) - split.specular).abs());
        let more = multiple_scattering(
            single_scattering_albedo(fibre_albedo(&s), 0.4),
            [0.4; 3],
            0.25,
        );
        worst[1] = worst[1].max((f64::from(got[12]) - more.spread[1] - more.cone[2]).abs());
        let table = &tables[c.fibre];
        let along = fibre_along(&table.fibre(), &exact_row(table, c), s.absorption, 0.7);
        let along = along[0] + 2.0 * along[1] + 3.0 * along[2];
        worst[2] = worst[2].max((f64::from(got[10]) - along).abs());
        let local = fibre_local(c.omega_o.map(f64::from), omega_i, c.albedo.map(f64::from));
        let parallel: f64 = c
            .omega_o
            .iter()
            .zip(c.omega_i)
            .map(|(a, b)| f64::from(a * b))
            .sum::<f64>()
            .abs();
        if parallel < 0.999 && c.albedo[0] <= 1.0 {
            worst[3] = worst[3]
                .max((f64::from(got[11]) - local[0] - 2.0 * local[1] - 3.0 * local[2]).abs());
        }
    }
    println!(
        "twins: K {:.1e} of the peak, energies {:.1e}, memory {:.1e}, frame {:.1e}",
        worst[0], worst[1], worst[2], worst[3]
    );
    assert!(
        worst[1] < 1e-5 && worst[2] < 1e-4 && worst[3] < 1e-4,
        "{worst:?}"
    );
}

#[test]
fn the_shader_passes_the_furnace() {
    let tables: Vec<FibreTable> = fibres().iter().map(FibreTable::build).collect();
    let (mut cases, mut weights) = (Vec::new(), Vec::new());
    let nodes = gauss_legendre(200);
    let eyes: [(f64, f64); 3] = [(0.0, 0.0), (0.8, 2.0), (1.5, 1.0)];
    // The last fibre has lobes of half a degree, beyond this grid.
    let count = tables.len() - 1;
    for fibre in 0..count {
        for (theta, phi) in eyes {
            for &(x, w) in &nodes {
                for k in 0..48 {
                    let (t, a) = (FRAC_PI_2 * x, 2.0 * PI * (f64::from(k) + 0.5) / 48.0);
                    cases.push(Case {
                        fibre,
                        albedo: [1.0, 0.5, 0.0],
                        omega_o: [
                            theta.sin(),
                            theta.cos() * phi.sin(),
                            theta.cos() * phi.cos(),
                        ]
                        .map(|x| x as f32),
                        omega_i: [t.sin(), t.cos() * a.sin(), t.cos() * a.cos()].map(|x| x as f32),
                        dark_back: 0.0,
                        harmonics: if theta > 0.5 { 8 } else { 3 },
                    });
                    weights.push(w * FRAC_PI_2 * 2.0 * PI / 48.0 * t.cos());
                }
            }
        }
    }
    let Some(out) = evaluated(&tables, &cases) else {
        return;
    };
    let each = nodes.len() * 48;
    let mut worst = 0.0_f64;
    for run in 0..count * eyes.len() {
        let s = shade(&tables[run / eyes.len()], &cases[run * each]);
        for c in 0..3 {
            let sum: f64 = (run * each..(run + 1) * each)
                .map(|i| f64::from(out[i * 13 + c]) * weights[i])
                .sum();
            let energy: f64 = s.energy.iter().map(|e| e[c]).sum();
            worst = worst.max((sum - energy).abs());
            assert!(
                (sum - energy).abs() < 0.01 && sum < 1.002,
                "fibre {} channel {c}: {sum} of {energy}",
                run / eyes.len()
            );
            assert!(c > 0 || sum > 0.97, "a white fibre: {sum}");
        }
    }
    println!("furnace of the shader: worst {worst:.1e}");
}

#[test]
fn sheen_shader_and_crate_agree() {
    const TEXT: &str = "
#import bevy_plumage::sheen as sheen
fn evaluate(i: u32) {
    let at = i * 10u;
    let ltc = vec3<f32>(input[at], input[at + 1u], input[at + 2u]);
    let n = vec3<f32>(0.0, 0.0, 1.0);
    let o = vec3<f32>(input[at + 3u], input[at + 4u], input[at + 5u]);
    let w = vec3<f32>(input[at + 6u], input[at + 7u], input[at + 8u]);
    output[i * 3u] = sheen::sheen_evaluate(ltc, n, o, w);
    output[i * 3u + 1u] = sheen::sheen_albedo(ltc, input[at + 9u]);
    let place = sheen::sheen_place(o.z);
    output[i * 3u + 2u] = place.x + place.y;
}
";
    let mut random = Pcg64Mcg::new(5);
    let mut input = Vec::new();
    let count = 10_240;
    for _ in 0..count {
        let (o, w) = (on_sphere(&mut random), on_sphere(&mut random));
        input.extend(sheen_lookup(o[2].abs(), uniform(&mut random) as f32));
        input.extend([
            o[0],
            o[1],
            o[2].abs(),
            w[0],
            w[1],
            w[2],
            uniform(&mut random) as f32,
        ]);
    }
    let Some(out) = run(&["sheen.wgsl"], TEXT, &input, count, count * 3) else {
        return;
    };
    let mut worst = 0.0_f64;
    for i in 0..count {
        let v: Vec<f64> = input[i * 10..i * 10 + 10]
            .iter()
            .map(|x| f64::from(*x))
            .collect();
        let ltc = [v[0], v[1], v[2]];
        let k = sheen_evaluate(ltc, [0.0, 0.0, 1.0], [v[3], v[4], v[5]], [v[6], v[7], v[8]]);
        let error = (f64::from(out[i * 3]) - k).abs() / k.max(1.0);
        worst = worst.max(error);
        assert!(error < 1e-3, "{i}: {} against {k}", out[i * 3]);
        assert!((f64::from(out[i * 3 + 1]) - sheen_albedo(ltc, v[9])).abs() < 1e-6);
        assert!((f64::from(out[i * 3 + 2]) - 31.0 * v[5]).abs() < 1e-4);
    }
    println!("sheen twins: {worst:.1e}");
}
