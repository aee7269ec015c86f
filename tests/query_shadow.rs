//! Shadows between fibres: the closed form against rays to explicit fibres, against its shader, and at its ends.
mod common;

use bevy_plumage::{
    anatomy::{Feather, Side, presets},
    curves::{CurveOptions, CurveShader, Curves, Ray, Visibility},
    query::{Vane, mean_shadow, vane_shadow, vane_sight},
};
use common::gpu;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

fn unit(v: [f64; 3]) -> [f64; 3] {
    let l = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / l)
}

fn shadow(vane: &Vane<f64>, eye: [f64; 3], light: [f64; 3]) -> [f64; 4] {
    let front = eye[2] >= 0.0;
    let [eye, light] = [eye, light].map(|d| vane_sight(vane, 1.0, d, front));
    vane_shadow(&eye, &light, front)
}

const EYES: [[f64; 3]; 4] = [
    [0.0, 0.0, 1.0],
    [0.7, -0.5, 0.8],
    [0.8, 0.4, 0.25],
    [0.1, 0.2, -1.0],
];
const LIGHTS: [[f64; 3]; 9] = [
    [0.05, 0.03, 1.0],
    [0.3, 0.4, 1.0],
    [-1.0, 0.1, 0.5],
    [1.0, 0.1, 0.5],
    [0.2, 1.0, 0.25],
    [-0.2, -1.0, 0.25],
    [0.3, 0.2, -1.0],
    [0.0, 0.0, -1.0],
    [-0.7, 0.2, -0.4],
];

/// Of what the eye sees of a patch of the left vane: number of fibres met, and how many of them the light reaches, per part.
fn traced(
    feather: &Feather,
    curves: &Curves,
    eye: [f64; 3],
    light: [f64; 3],
) -> ([f64; 4], [f64; 4]) {
    let options = CurveOptions {
        visibility: Visibility::Traced,
        ..CurveOptions::default()
    };
    let shader = CurveShader::new(feather, [0.5; 3], options);
    let x = -0.1 + f64::from(feather.rachis.curve[4] - 0.5) * f64::from(feather.aspect);
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let (mut met, mut lit) = ([0.0; 4], [0.0; 4]);
    for _ in 0..6000 {
        let p = [x, 0.6].map(|c| c + 0.06 * (random.random::<f64>() - 0.5));
        let ray = Ray {
            origin: [p[0] + 2.0 * eye[0], p[1] + 2.0 * eye[1], 2.0 * eye[2]],
            direction: eye.map(|c| -c),
        };
        if let Some(hit) = curves.hit(&ray, 0.0, None) {
            let part = hit.fibre.part as usize;
            met[part] += 1.0;
            lit[part] += shader.visibility(curves, &hit, eye, light, random.random());
        }
    }
    (met, lit)
}

#[test]
fn shadows_agree_with_rays() {
    for name in ["macaw_lesser", "eagle_contour"] {
        let feather = presets::by_name(name).unwrap();
        let curves = Curves::build(&feather);
        let vane = feather.query_vane(Side::Left);
        let pairs: Vec<_> = EYES
            .into_iter()
            .flat_map(|eye| LIGHTS.map(|light| (unit(eye), unit(light))))
            .collect();
        let found: Vec<_> = pairs
            .par_iter()
            .map(|&(eye, light)| {
                let (met, lit) = traced(&feather, &curves, eye, light);
                let shadow = shadow(&vane, eye, light);
                let model: f64 = (0..4).map(|i| met[i] * shadow[i]).sum();
                let worst = (0..4)
                    .filter(|i| met[*i] > 300.0)
                    .map(|i| (shadow[i] - lit[i] / met[i]).abs())
                    .fold(0.0, f64::max);
                (
                    model / met.iter().sum::<f64>(),
                    lit.iter().sum::<f64>() / met.iter().sum::<f64>(),
                    worst,
                )
            })
            .collect();
        let (mut most, mut least) = (0.0_f64, 0.0_f64);
        for ((eye, light), (model, rays, part)) in pairs.iter().zip(&found) {
            most = most.max(model - rays);
            least = least.min(model - rays);
            assert!(
                (model - rays).abs() < 0.04,
                "{name}: eye {eye:.2?}, light {light:.2?}: {model:.3} of the light, by rays {rays:.3}"
            );
            assert!(*part < 0.2, "{name}: {eye:?}, {light:?}: a part by {part}");
        }
        let square: f64 = found.iter().map(|(m, r, _)| (m - r).powi(2)).sum();
        println!(
            "{name}: RMS {:.4}, {least:+.4} to {most:+.4} of the light",
            (square / found.len() as f64).sqrt()
        );
    }
}

/// A direction anywhere on the sphere.
fn anywhere(random: &mut Pcg64Mcg) -> [f64; 3] {
    let z: f64 = random.random_range(-1.0..1.0);
    let (s, c) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    [r * c, r * s, z]
}

fn any_vane(random: &mut Pcg64Mcg) -> Vane<f64> {
    let barb = random.random_range(4e-4..0.02);
    let spacing = random.random_range(5e-5..2e-3);
    Vane::new(
        barb,
        spacing,
        random.random_range(0.2..1.4),
        random.random_range(0.2..1.4),
        barb * random.random_range(0.0..0.6),
        spacing * random.random_range(0.0..0.6),
        spacing * random.random_range(0.0..0.6),
    )
}

#[test]
fn the_shader_shades_like_the_processor() {
    let text = "#import bevy_plumage::{masking::Vane, shadow}
        fn evaluate(i: u32) {
            let at = 16u * i;
            let vane = Vane(input[at], input[at + 1u], input[at + 2u], input[at + 3u], input[at + 4u], input[at + 5u],
                input[at + 6u], input[at + 7u], input[at + 8u]);
            let front = input[at + 12u] >= 0.0;
            let eye = shadow::vane_sight(vane, input[at + 9u], vec3(input[at + 10u], input[at + 11u], input[at + 12u]), front);
            let light = shadow::vane_sight(vane, input[at + 9u], vec3(input[at + 13u], input[at + 14u], input[at + 15u]), front);
            let found = shadow::vane_shadow(eye, light, front);
            for (var j = 0u; j < 4u; j++) { output[4u * i + j] = found[j]; }
        }";
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let mut input: Vec<f32> = Vec::new();
    for _ in 0..10_000 {
        let v = any_vane(&mut random);
        let hooked: f64 = random.random_range(0.3..1.0);
        let mut eye = anywhere(&mut random);
        let mut light = anywhere(&mut random);
        // Within two degrees of edge on single precision has too few digits for the place of a grating.
        for d in [&mut eye, &mut light] {
            d[2] = (d[2].abs() + 0.035).copysign(d[2]);
        }
        let sizes = [v.p_b, v.d_bl, v.cos_b, v.sin_b, v.cos_bl, v.sin_bl];
        let values = sizes
            .into_iter()
            .chain([v.r_b, v.r_bd, v.r_bp, hooked])
            .chain(unit(eye))
            .chain(unit(light));
        input.extend(values.map(|x| x as f32));
    }
    let count = input.len() / 16;
    let files = ["shadow.wgsl", "masking.wgsl", "math.wgsl"];
    let Some(result) = gpu::run(&files, text, &input, count, 4 * count) else {
        return;
    };
    let mut worst = 0.0_f32;
    for (given, found) in input.chunks(16).zip(result.chunks(4)) {
        let vane = Vane {
            p_b: given[0],
            d_bl: given[1],
            cos_b: given[2],
            sin_b: given[3],
            cos_bl: given[4],
            sin_bl: given[5],
            r_b: given[6],
            r_bd: given[7],
            r_bp: given[8],
        };
        let front = given[12] >= 0.0;
        let [eye, light] = [10, 13].map(|k| {
            vane_sight(
                &vane,
                given[9],
                [given[k], given[k + 1], given[k + 2]],
                front,
            )
        });
        for (wanted, got) in vane_shadow(&eye, &light, front).iter().zip(found) {
            assert!(got.is_finite(), "{given:?}");
            worst = worst.max((wanted - got).abs());
        }
    }
    println!("largest difference of shader and processor: {worst:.1e}");
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn shadows_are_shares_everywhere() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    for i in 0..20_000 {
        let vane = any_vane(&mut random);
        let mut eye = anywhere(&mut random);
        let mut light = anywhere(&mut random);
        match i % 4 {
            0 => eye[2] = 0.0,
            1 => light = [0.0, 1.0, 0.0],
            2 => light[2] = -eye[2],
            _ => {}
        }
        for value in shadow(&vane, eye, light) {
            assert!((0.0..=1.0).contains(&value), "{value}: {eye:?}, {light:?}");
        }
        // Light from the eye, on the normal, misses nothing that the eye sees but the flanks of the lower barbules.
        let at_eye = shadow(&vane, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let open = vane.r_b < 0.5 * vane.p_b;
        assert!(!open || at_eye[2] > 0.99 / (2.0 * vane.r_bd / vane.p_bl()).max(1.0));
        for fronts in [true, false] {
            if i % 1000 == 0 {
                for side in mean_shadow(&vane, fronts) {
                    assert!(side.iter().all(|x| (0.0..=1.0).contains(x)), "{side:?}");
                }
            }
        }
    }
}
