//! Shadows between fibres: the closed form against rays to explicit fibres, against its shader, and at its ends.

use bevy_plumage::anatomy::{Feather, Side};
use bevy_plumage::maths::query::{
    MirrorPlace, Vane, VaneLight, vane_caught, vane_eye, vane_ray, vane_shadow,
};
use bevy_plumage::maths::scattering::mean_caught;
use plumage_reference::curves::{CurveOptions, CurveShader, Curves, Ray, Visibility};
use plumage_tests::gpu;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::f64::consts::PI;

fn unit(v: [f64; 3]) -> [f64; 3] {
    let l = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / l)
}

/// Of barbs and of barbules.
const MIRRORS: [MirrorPlace<f64>; 2] = [
    MirrorPlace {
        blur: 0.4,
        retreat: 0.0,
    },
    MirrorPlace {
        blur: 0.3,
        retreat: 0.2,
    },
];

fn shadow(vane: &Vane<f64>, eye: [f64; 3], light: [f64; 3]) -> [VaneLight<f64>; 4] {
    let eye = vane_eye(vane, eye, MIRRORS);
    vane_shadow(&eye, &vane_ray(&eye, light))
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
            let u = random.random();
            lit[part] += shader.reach(curves, &hit, [eye, light], u, 0.0, false).even;
        }
    }
    (met, lit)
}

/// Harmonics of what light remembers of its place around the default fibre, over the first one: `bake_tables` prints them.
const HARMONICS: [f64; 4] = [1.0, 0.55, 0.46, 0.31];

/// Means of cos and sin of `k` times the place on the circle, over what a direction `angle` from the normal, across fibres `wide`
/// times as wide as their period, meets of it. Counted from the normal towards the direction's side.
fn met_of_circle(k: f64, angle: f64, wide: f64) -> [f64; 2] {
    const STEPS: usize = 400;
    let own = (angle.cos() / wide).min(1.0);
    let (from, to) = (-0.5 * PI, (2.0 * own - 1.0).asin());
    let step = (to - from) / STEPS as f64;
    let mut sum = [0.0; 2];
    for i in 0..STEPS {
        let turn = from + (i as f64 + 0.5) * step;
        let (sin, cos) = (k * (turn + angle)).sin_cos();
        let weight = turn.cos() * step / (2.0 * own);
        sum = [sum[0] + weight * cos, sum[1] + weight * sin];
    }
    sum
}

#[test]
fn one_cosine_stands_for_all_that_light_remembers() {
    let (mut square, mut count, mut worst) = (0.0, 0.0, 0.0_f64);
    for wide in [0.3, 0.57, 0.9] {
        // Barbs too thin and far apart to matter.
        let (alpha, angle) = (0.7_f64, 0.7_f64);
        let vane = Vane::new(
            100.0,
            2.0 / wide / angle.sin(),
            alpha,
            angle,
            1e-3,
            1.0,
            1.0,
        );
        let across = {
            let along = angle - alpha;
            [along.cos(), -along.sin()]
        };
        for eye in [0.0_f64, 30.0, 45.0, 60.0, 75.0, 82.0] {
            for light in [0.0_f64, 30.0, 45.0, 60.0, 75.0, 82.0] {
                for (side, up) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                    let (eye, light) = (eye.to_radians(), light.to_radians());
                    let towards = |angle: f64, side: f64, up: f64| {
                        let x = side * angle.sin();
                        [x * across[0], x * across[1], up * angle.cos()]
                    };
                    let place =
                        shadow(&vane, towards(eye, 1.0, 1.0), towards(light, side, up))[2].place;
                    let wanted: f64 = HARMONICS
                        .iter()
                        .enumerate()
                        .map(|(i, share)| {
                            let k = i as f64 + 1.0;
                            let seen = met_of_circle(k, eye, wide);
                            let mut lit = met_of_circle(k, light, wide);
                            lit[1] *= side;
                            if up < 0.0 {
                                // The circle upside down.
                                let turned = (k * PI).cos();
                                lit = [turned * lit[0], -turned * lit[1]];
                            }
                            share * (seen[0] * lit[0] + seen[1] * lit[1])
                        })
                        .sum();
                    let off = (0.25 * PI).powi(2) * place - wanted;
                    square += off * off;
                    count += 1.0;
                    worst = worst.max(off.abs());
                }
            }
        }
    }
    let rms = f64::sqrt(square / count);
    println!("what light remembers of its place, by one cosine: RMS {rms:.3}, at most {worst:.3}");
    assert!(rms < 0.12 && worst < 0.6, "{rms} {worst}");
}

#[test]
fn shadows_agree_with_rays() {
    for name in ["macaw_lesser", "eagle_contour"] {
        let feather = plumage_tests::shipped::feather(name);
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
                let reached = shadow(&vane, eye, light);
                // Rays enter beside the place that the eye sees, never before or behind it along the fibre.
                let shadow = reached.map(|light| light.even + light.along);
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
        let rms = (square / found.len() as f64).sqrt();
        println!("{name}: RMS {rms:.4}, {least:+.4} to {most:+.4} of the light");
        assert!(rms < 0.022, "{name}: RMS {rms}");
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
    let text = "#import bevy_plumage::{masking::{Vane, vane_shape}, shadow}
        fn evaluate(i: u32) {
            let at = 16u * i;
            let vane = Vane(input[at], input[at + 1u], input[at + 2u], input[at + 3u], input[at + 4u], input[at + 5u],
                input[at + 6u], input[at + 7u], input[at + 8u], input[at + 9u]);
            let eye = shadow::vane_eye(vane_shape(vane), vec3(input[at + 10u], input[at + 11u], input[at + 12u]),
                shadow::MirrorPlace(0.4, 0.0), shadow::MirrorPlace(0.3, 0.2));
            let ray = shadow::vane_ray(eye, vec3(input[at + 13u], input[at + 14u], input[at + 15u]));
            let upper = shadow::upper_light(eye, shadow::upper_eye(eye.shape, eye.layers), ray);
            let lower = shadow::lower_light(eye, shadow::lower_eye(eye.shape, eye.layers), ray);
            var found = array<shadow::VaneLight, 4>(
                shadow::shaft_light(ray), shadow::barb_light(eye, shadow::barb_eye(eye.shape, eye.layers), ray), upper, lower);
            if !eye.distal_above {
                found[2] = lower;
                found[3] = upper;
            }
            for (var j = 0u; j < 4u; j++) {
                output[21u * i + j] = found[j].mirror;
                output[21u * i + 4u + j] = found[j].even;
                output[21u * i + 8u + j] = found[j].place;
                output[21u * i + 12u + j] = found[j].along;
                output[21u * i + 16u + j] = found[j].lit;
            }
            output[21u * i + 20u] = shadow::vane_caught(eye.shape, ray.layers, ray.facing);
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
    let Some(result) = gpu::run(&files, text, &input, count, 21 * count) else {
        return;
    };
    let mut worst = 0.0_f32;
    for (given, found) in input.chunks(16).zip(result.chunks(21)) {
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
            hooked: given[9],
        };
        let [eye, light] = [10, 13].map(|k| [given[k], given[k + 1], given[k + 2]]);
        let mirrors = MIRRORS.map(|m| MirrorPlace {
            blur: m.blur as f32,
            retreat: m.retreat as f32,
        });
        let eye = vane_eye(&vane, eye, mirrors);
        let ray = vane_ray(&eye, light);
        let lights = vane_shadow(&eye, &ray);
        let caught = vane_caught(&eye.shape, &ray.storeys, ray.facing);
        let wanted = (lights.iter().map(|light| light.mirror))
            .chain(lights.iter().map(|light| light.even))
            .chain(lights.iter().map(|light| light.place))
            .chain(lights.iter().map(|light| light.along))
            .chain(lights.iter().map(|light| light.lit))
            .chain([caught]);
        // Seen at a slant a mirror may count many times.
        let scale = lights.iter().fold(1.0_f32, |m, light| m.max(light.mirror));
        for (wanted, got) in wanted.zip(found) {
            assert!(got.is_finite(), "{given:?}");
            worst = worst.max((wanted - got).abs() / scale);
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
        let reached = shadow(&vane, eye, light);
        for value in reached.map(|light| light.even) {
            assert!((0.0..=1.0).contains(&value), "{value}: {eye:?}, {light:?}");
        }
        for part in reached {
            let finite = part.place.is_finite() && part.along.is_finite();
            assert!(
                finite && part.mirror >= 0.0 && part.mirror.is_finite(),
                "{reached:?}: {eye:?}, {light:?}"
            );
            assert!(
                part.lit >= 0.0 && part.lit.is_finite(),
                "{reached:?}: {eye:?}, {light:?}"
            );
        }
        // Light from the eye, on the normal, misses nothing that the eye sees but the flanks of the lower barbules.
        let at_eye = shadow(&vane, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0])[2].even;
        let open = vane.r_b < 0.5 * vane.p_b;
        assert!(!open || at_eye > 0.99 / (2.0 * vane.r_bd / vane.p_bl()).max(1.0));
        if i % 1000 == 0 {
            assert!((0.0..=0.5).contains(&mean_caught(&vane)));
        }
    }
}
