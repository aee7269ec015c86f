//! The march against the dense reference (test D3 of docs/down.md), the density's chain of levels, and the shader twin of
//! procedural down.

use bevy::math::{UVec3, Vec3};
use bevy_plumage::maths::undercoat::density::*;
use bevy_plumage::maths::undercoat::march::*;
use bevy_plumage::maths::undercoat::{Density, Tile};
use plumage_reference::undercoat::reference::{Lit, Medium};
use plumage_tests::gpu;
use std::sync::OnceLock;

/// The tile of docs/book/undercoat.md: 64 x 64 x 32 cells, twice as wide as high, depth 4.
fn down() -> &'static (Tile, Density, Medium, [([f64; 3], Lit); 2]) {
    static DOWN: OnceLock<(Tile, Density, Medium, [([f64; 3], Lit); 2])> = OnceLock::new();
    DOWN.get_or_init(|| {
        let tile = down_tile(&DownShape::default(), TILE_SIZE, 2.0, 4.0).expect("a sound tile");
        let medium = Medium::new(&tile);
        let lights = [30.0, 65.0f64].map(|angle| {
            let (s, c) = angle.to_radians().sin_cos();
            let light = [0.6 * s, 0.8 * s, c];
            (light, medium.lit(light))
        });
        (tile.clone(), Density::new(&tile), medium, lights)
    })
}

fn eye(angle: f64) -> [f64; 3] {
    let (s, c) = angle.to_radians().sin_cos();
    [s, 0.0, c]
}

const PIXELS: usize = 128;

fn pixel(i: usize) -> [f64; 2] {
    // A rank-1 lattice over the tile.
    let x = i as f64 / PIXELS as f64;
    [x, (i as f64 * 0.618_033_988_749_895).fract()]
}

/// Single scattering with exact light, by the march's own steps.
fn marched(
    density: &Density,
    entry: [f64; 2],
    eye: [f64; 3],
    lit: &Lit,
    steps: f64,
    clip: f64,
) -> f64 {
    let whole = 1.0 / eye[2];
    let power = f64::from(density.power());
    let floor = march_floor(eye[2], f64::from(density.mean()), power, clip);
    let length = whole * (1.0 - floor);
    let at = |t: f64| {
        let w = f64::from(density.width());
        [
            entry[0] - t * eye[0] / w,
            entry[1] - t * eye[1] / w,
            1.0 - t * eye[2],
        ]
    };
    let mut march = March::default();
    let mut last = 0.0;
    for i in 0..steps.ceil() as u32 {
        let (share, width) = march_step(i, steps, 0.5);
        let depth = density.sample(at(share * length), 0.0) * width * length;
        let light = lit.at(at((share + (march_lit(depth) - 0.5) * width) * length));
        march = march.add(depth, [light; 3], share);
        last += (light - last) * (width * steps).clamp(0.0, 1.0);
    }
    let ground = if length < whole { last } else { 0.0 };
    march.over([ground; 3])[0]
}

#[test]
fn sixteen_clipped_steps() {
    let (_, density, medium, lights) = down();
    for (angle, bound) in [(0.0, 0.005), (45.0, 0.03), (70.0, 0.06), (82.0, 0.10)] {
        let eye = eye(angle);
        let (mut square, mut off, mut mean) = (0.0, 0.0, 0.0);
        for (_, lit) in lights {
            for i in 0..PIXELS {
                let truth = medium.radiance(pixel(i), eye, lit, 2048).0;
                let found = marched(density, pixel(i), eye, lit, 16.0, DEPTH_CLIP);
                square += (found - truth) * (found - truth);
                off += found - truth;
                mean += truth;
            }
        }
        let n = 2.0 * PIXELS as f64;
        let (rms, bias) = ((square / n).sqrt() / (mean / n), off / mean);
        println!("{angle} degrees: RMS {rms:.4}, bias {bias:+.4}");
        assert!(rms < bound, "{angle}: {rms}");
        assert!(bias.abs() < 0.03, "{angle}: {bias}");
    }
}

#[test]
fn many_steps_are_the_reference() {
    let (_, density, medium, lights) = down();
    let mut worst = 0.0f64;
    for angle in [0.0, 45.0, 70.0, 82.0] {
        for i in 0..8 {
            let truth = medium.radiance(pixel(i), eye(angle), &lights[0].1, 4096).0;
            // 4096 through the bounded function: 64 steps at a time would hide its rounding, so all pieces are summed here.
            let mut march = March::default();
            let eye = eye(angle);
            let whole = 1.0 / eye[2];
            for step in 0..4096 {
                let t = (f64::from(step) + 0.5) / 4096.0 * whole;
                let place = [
                    pixel(i)[0] - t * eye[0] / f64::from(density.width()),
                    pixel(i)[1] - t * eye[1] / f64::from(density.width()),
                    1.0 - t * eye[2],
                ];
                let light = lights[0].1.at(place);
                march = march.add(density.sample(place, 0.0) * whole / 4096.0, [light; 3], t);
            }
            worst = worst.max((march.radiance[0] - truth).abs());
        }
    }
    println!("worst {worst:.1e}");
    assert!(worst < 1e-6, "{worst}");
}

#[test]
fn steps_change_without_a_jump() {
    let (_, density, _, lights) = down();
    for angle in [0.0, 45.0, 70.0] {
        for i in 0..16 {
            let at = |steps| {
                marched(
                    density,
                    pixel(i),
                    eye(angle),
                    &lights[0].1,
                    steps,
                    DEPTH_CLIP,
                )
            };
            for k in 8..16 {
                let n = f64::from(k);
                assert!((at(n + 1e-6) - at(n)).abs() < 1e-4);
                let whole: f64 = (0..=k as u32).map(|i| march_step(i, n + 0.37, 0.5).1).sum();
                assert!((whole - 1.0).abs() < 1e-12, "{whole}");
            }
        }
    }
}

#[test]
fn coarse_levels_hide_what_fine_ones_hid() {
    let (_, density, ..) = down();
    // Hair: thin dense lines. A mean density hides far too much.
    let size = UVec3::splat(16);
    let lines = |i: usize| {
        if (i % 16).is_multiple_of(4) && (i / 16 % 16).is_multiple_of(4) {
            64.0
        } else {
            0.0
        }
    };
    let extinction = (0..4096).map(lines).collect();
    let hair = Tile::new(size, 1.0, extinction, vec![Vec3::Z; 4096]).expect("a sound tile");
    let hair = Density::new(&hair);
    assert_eq!(hair.levels().len(), 5);
    let through = |density: &Density, level: usize, axis: usize| {
        // Straight through the cells of a level, mean transmittance.
        let n = density.levels()[level].size.to_array();
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut sum = 0.0;
        for i in 0..n[a] {
            for k in 0..n[b] {
                let mut depth = 0.0;
                for j in 0..n[axis] {
                    let mut cell = [0; 3];
                    (cell[axis], cell[a], cell[b]) = (j, i, k);
                    let at = cell[0] + n[0] * (cell[1] + n[1] * cell[2]);
                    let wide = if axis == 2 { 1.0 } else { density.width() };
                    depth +=
                        density.levels()[level].extinction[at as usize] * wide / n[axis] as f32;
                }
                sum += (-depth).exp();
            }
        }
        sum / (n[a] * n[b]) as f32
    };
    let mean_hair = 4.0f32;
    for axis in 0..3 {
        let (fine, coarse) = (through(&hair, 0, axis), through(&hair, 1, axis));
        println!("hair, axis {axis}: {fine:.3} {coarse:.3}");
    }
    // Across the lines, where the coat is looked at from the side, a level keeps more light than the mean would.
    assert!(through(&hair, 1, 0) > (-mean_hair).exp());
    for axis in 0..3 {
        let (fine, coarse) = (through(density, 0, axis), through(density, 1, axis));
        assert!(
            (fine - coarse).abs() < 0.02,
            "down, axis {axis}: {fine} {coarse}"
        );
    }
}

#[test]
fn tile_is_periodic_and_has_its_depth() {
    let (tile, density, ..) = down();
    assert!((density.mean() - 4.0).abs() < 1e-3);
    assert!((density.column(0.0f64) - 4.0).abs() < 1e-3 && density.column(1.0f64) == 0.0);
    let columns = density.columns();
    assert!(columns.windows(2).all(|c| c[0] >= c[1]));
    let shape = DownShape::default();
    for i in 0..64 {
        let v = f64::from(i) / 64.0;
        for z in [0.1, 0.5, 0.9] {
            let (a, b) = (
                down_density([1e-9, v, z], &shape),
                down_density([1.0 - 1e-9, v, z], &shape),
            );
            assert!((a - b).abs() < 1e-5, "{v} {z}: {a} {b}");
            let (a, b) = (
                density.sample([0.0, v, z], 0.0),
                density.sample([1.0, v + 1.0, z], 0.0),
            );
            assert!((a - b).abs() < 1e-5);
        }
    }
    assert!(tile.tangent().iter().all(|t| t.is_normalized()));
    // Clumps thin out upwards: that is what reads as an undercoat.
    let layer = |z: usize| {
        tile.extinction()[z * 4096..(z + 1) * 4096]
            .iter()
            .filter(|e| **e == 0.0)
            .count()
    };
    assert!(layer(0) == 0 && layer(31) > 3500 && layer(24) > 800);
    // Physical scale (docs/book/undercoat.md#density): mink 2.6 a millimetre, loose down 0.26 to 1.3.
    assert!((fibre_extinction(200.0, 13.0) - 2.6f64).abs() < 1e-9);
    assert!((loose_extinction(2.0, 6.0) - 0.256f64).abs() < 1e-3);
    assert!((loose_extinction(10.0, 6.0) - 1.28f64).abs() < 1e-2);
}

#[test]
fn shader_twin_of_procedural_down() {
    let text = "#import bevy_plumage::down_density::{DownShape, down_density, down_tangent}
        fn evaluate(i: u32) {
            let p = vec3(input[3u * i], input[3u * i + 1u], input[3u * i + 2u]);
            let shape = DownShape(8u, 24u, 0.05, 0.55, 0.25, 0.3, vec2(1.0, 0.0), vec2(0.15, 0.7), 1u);
            output[4u * i] = down_density(p, shape);
            let t = down_tangent(p, shape);
            output[4u * i + 1u] = t.x;
            output[4u * i + 2u] = t.y;
            output[4u * i + 3u] = t.z;
        }";
    let shape = DownShape::default();
    let points = (0..4000u32).map(|i| {
        let n = |k| lattice_noise::<f32>(i, k, 9) * 2.0 - 0.5;
        [n(0), n(1), n(2).clamp(0.0, 1.0)]
    });
    let points = points.collect::<Vec<_>>();
    let input = points.iter().flatten().copied().collect::<Vec<_>>();
    let Some(result) = gpu::run(&["down_density.wgsl"], text, &input, 4000, 16_000) else {
        return;
    };
    for (p, got) in points.iter().zip(result.chunks(4)) {
        let tangent = down_tangent(*p, &shape);
        let want = [down_density(*p, &shape), tangent[0], tangent[1], tangent[2]];
        for (a, b) in got.iter().zip(want) {
            assert!((a - b).abs() < 1e-4, "{p:?}: {got:?} {want:?}");
        }
    }
}

/// How far fibres have come is the integral of their slope.
#[test]
fn leaning_fibres_follow_their_slope() {
    for bend in [0.0, 0.02, 0.3, 0.75, 0.95, 1.0] {
        let slope = |z: f64| {
            let x = f64::min(bend, 0.95) * z;
            x / (1.0 - x)
        };
        let mut sum = 0.0;
        for i in 0..4000 {
            let z = (f64::from(i) + 0.5) / 4000.0;
            sum += slope(z) / 4000.0;
            let end = f64::from(i + 1) / 4000.0;
            assert!((lean_shift(end, bend) - sum).abs() < 2e-5, "{bend} {end}");
        }
    }
    assert!(lean_shift(f64::NAN, 0.5).is_finite() && lean_shift(0.5, f64::NAN).is_finite());
}
