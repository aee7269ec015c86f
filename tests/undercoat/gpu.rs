//! The shader twins of coverage, transfer, slabs and fragments against the double-precision functions of the crate.

use bevy_plumage::maths::undercoat::coverage::*;
use bevy_plumage::maths::undercoat::harmonics::*;
use bevy_plumage::maths::undercoat::transfer::*;
use plumage_reference::undercoat::fragments::*;
use plumage_reference::undercoat::slabs::*;
use plumage_tests::gpu::run;
use plumage_tests::tiles::*;

/// Numbers without pattern, from 0 to 1.
struct Lattice(u32);

impl Lattice {
    fn next(&mut self, low: f32, high: f32) -> f32 {
        self.0 += 1;
        let x = (f64::from(self.0) * 0.754_877_666_246_692_8).fract();
        let y = (x * 7919.0 + f64::from(self.0) * 0.569_840_290_998_053_3).fract();
        low + (high - low) * y as f32
    }
}

/// Largest difference of each of `width` results.
fn differences(got: &[f32], wanted: &[f64], width: usize) -> Vec<f64> {
    let mut worst = vec![0f64; width];
    for (i, (g, w)) in got.iter().zip(wanted).enumerate() {
        // A NaN must not pass.
        let error = (f64::from(*g) - w).abs();
        worst[i % width] = worst[i % width].max(if error.is_finite() { error } else { 1e9 });
    }
    worst
}

#[test]
fn coverage_agrees() {
    const ENTRY: &str = "
    #import bevy_plumage::down_coverage as coverage
    fn evaluate(i: u32) {
        let r = input[3u * i];
        let centre = vec2(input[3u * i + 1u], input[3u * i + 2u]);
        output[2u * i] = coverage::disc_coverage(r, centre);
        output[2u * i + 1u] = coverage::disc_coverage_separable(r, centre);
    }";
    let mut lattice = Lattice(0);
    let (mut input, mut wanted) = (Vec::new(), Vec::new());
    let count = 8192;
    for _ in 0..count {
        let r = lattice.next(0.02, 2.0);
        let centre = [lattice.next(-1.0, 2.0), lattice.next(-1.0, 2.0)];
        input.extend([r, centre[0], centre[1]]);
        wanted.push(disc_coverage(f64::from(r), centre.map(f64::from)));
        wanted.push(disc_coverage_separable(f64::from(r), centre.map(f64::from)));
    }
    let Some(got) = run(&["down_coverage.wgsl"], ENTRY, &input, count, 2 * count) else {
        return;
    };
    let worst = differences(&got, &wanted, 2);
    println!("coverage: {worst:?}");
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{worst:?}");
}

#[test]
fn d8_transfer_agrees() {
    const ENTRY: &str = "
    #import bevy_plumage::down_transfer as transfer
    fn load(at: u32) -> vec3<f32> {
        return vec3(input[at], input[at + 1u], input[at + 2u]);
    }
    fn evaluate(i: u32) {
        var bands: transfer::TransferBands;
        for (var k = 0u; k < 8u; k++) {
            bands.fit[k] = vec4(load(4u * k), input[4u * k + 3u]);
        }
        var low: array<vec3<f32>, 9>;
        var full: array<vec3<f32>, 25>;
        for (var k = 0u; k < 25u; k++) {
            full[k] = load(32u + 3u * k);
            if k < 9u {
                low[k] = full[k];
            }
        }
        let at = 107u + i * 16u;
        let texel = vec4(load(at), input[at + 3u]);
        let frame = mat3x3<f32>(load(at + 4u), load(at + 7u), load(at + 10u));
        let four = transfer::transfer_rotate(transfer::transfer_decode(texel, bands), frame);
        let a = transfer::transfer_zonal(four, bands, low);
        let b = transfer::transfer_zonal_full(four, bands, full);
        let direction = load(at + 13u);
        let y = transfer::harmonics(direction);
        let out = i * 32u;
        for (var k = 0u; k < 3u; k++) {
            output[out + k] = a[k];
            output[out + 3u + k] = b[k];
        }
        output[out + 6u] = transfer::transfer_towards(four, bands, direction);
        for (var k = 0u; k < 25u; k++) {
            output[out + 7u + k] = y[k];
        }
    }";
    let tile = hair_tile(32, 16, 3);
    for albedo in [0.0, 0.5] {
        let settings = TransferSettings {
            count: 64,
            skin: Skin::Opaque(albedo),
            ..TransferSettings::default()
        };
        let transfer = Transfer::compress(&bake(&tile, &settings, 2).expect("sound"));
        let light = sky(1024, |d| sky_light([0.6, 0.0, 0.8], d));
        let texels = &transfer_texture(&transfer, &tile, 1)[0].bytes;
        let mut input: Vec<f32> = transfer.bands.vec4s().into_iter().flatten().collect();
        input.extend(light.harmonics.iter().flatten());
        let (full, low) = (
            light.harmonics.map(|c| c.map(f64::from)),
            light.low().map(|c| c.map(f64::from)),
        );
        let mut wanted = Vec::new();
        let frames = fibonacci_rays(64);
        let (texels, _) = texels.as_chunks::<4>();
        for (i, texel) in texels.iter().enumerate() {
            let texel = texel.map(|b| f32::from(b) / 255.0);
            // A frame with its z along one direction.
            let z = frames[i % 64];
            let x = [z[1], -z[0], 0.0].map(|v| v / (z[0] * z[0] + z[1] * z[1]).sqrt());
            let y = [
                z[1] * x[2] - z[2] * x[1],
                z[2] * x[0] - z[0] * x[2],
                z[0] * x[1] - z[1] * x[0],
            ];
            let frame = [x, y, z].map(|v| v.map(|x| x as f32));
            let direction = frames[(i * 7 + 3) % 64].map(|v| v as f32);
            input.extend(texel);
            input.extend(frame.iter().flatten());
            input.extend(direction);
            let four = transfer_rotate(
                &transfer_decode(texel.map(f64::from), &transfer.bands),
                frame.map(|v| v.map(f64::from)),
            );
            wanted.extend(transfer_zonal(&four, &transfer.bands, &low));
            wanted.extend(transfer_zonal_full(&four, &transfer.bands, &full));
            wanted.push(transfer_towards(
                &four,
                &transfer.bands,
                direction.map(f64::from),
            ));
            wanted.extend(harmonics(direction.map(f64::from)));
        }
        let count = texels.len();
        let Some(got) = run(&["down_transfer.wgsl"], ENTRY, &input, count, 32 * count) else {
            return;
        };
        let worst = differences(&got, &wanted, 32);
        let largest = worst.iter().fold(0f64, |m, w| m.max(*w));
        println!("D8: shader against double precision {largest:.1e}");
        assert!(largest < 1e-5, "{worst:?}");
    }
}

#[test]
fn slabs_agree() {
    const ENTRY: &str = "
    #import bevy_plumage::down_slabs as slabs
    fn evaluate(i: u32) {
        let x = vec3(input[3u * i], input[3u * i + 1u], input[3u * i + 2u]);
        output[3u * i] = slabs::slab_alpha(x.x + x.y, x.x, x.z);
        output[3u * i + 1u] = slabs::shell_count(20.0 * x.y + 0.01, x.z, 32u);
        output[3u * i + 2u] = slabs::published_alpha(x.x * 30.0, 32.0);
    }";
    let mut lattice = Lattice(7);
    let (mut input, mut wanted) = (Vec::new(), Vec::new());
    let count = 4096;
    for _ in 0..count {
        let x = [
            lattice.next(0.0, 4.0),
            lattice.next(0.0, 2.0),
            lattice.next(-1.0, 1.0),
        ];
        input.extend(x);
        let [a, b, c] = x.map(f64::from);
        wanted.push(slab_alpha(a + b, a, c));
        wanted.push(shell_count(20.0 * b + 0.01, c, 32));
        wanted.push(published_alpha(a * 30.0, 32.0));
    }
    let Some(got) = run(&["down_slabs.wgsl"], ENTRY, &input, count, 3 * count) else {
        return;
    };
    let worst = differences(&got, &wanted, 3);
    assert!(
        worst[0] < 1e-5 && worst[1] < 0.5 && worst[2] < 1e-5,
        "{worst:?}"
    );
}

#[test]
fn fragments_agree() {
    const ENTRY: &str = "
    #import bevy_plumage::down_fragments as fragments
    fn evaluate(i: u32) {
        let at = i * 82u;
        var march = fragments::slabs(u32(input[at]), input[at + 1u]);
        for (var k = 0u; k < 16u; k++) {
            let s = at + 2u + 5u * k;
            let radiance = vec3(input[s], input[s + 1u], input[s + 2u]);
            fragments::slab_add(&march, radiance, input[s + 3u], input[s + 4u]);
        }
        var left = 1.0;
        var sum = vec3(0.0);
        for (var k = 0u; k < 8u; k++) {
            let f = fragments::slab_fragment(&march, k);
            output[i * 44u + k] = f.alpha * left;
            output[i * 44u + 8u + k] = f.depth * f.alpha * left;
            sum += left * f.alpha * f.color;
            left *= 1.0 - f.alpha;
        }
        for (var k = 0u; k < 3u; k++) {
            output[i * 44u + 16u + k] = sum[k];
        }
        output[i * 44u + 19u] = left;
    }";
    let mut lattice = Lattice(11);
    let (mut input, mut wanted) = (Vec::new(), Vec::new());
    let count = 1024;
    for i in 0..count {
        let slab_count = (i % 8 + 1) as u32;
        let depth = lattice.next(0.3, 8.0);
        input.extend([slab_count as f32, depth]);
        let mut march = slabs(slab_count, f64::from(depth));
        for k in 0..16 {
            let radiance = [0; 3].map(|_| lattice.next(0.0, 2.0));
            let alpha = lattice.next(0.0, 0.6).powi(2);
            let place = k as f32 + lattice.next(0.0, 1.0);
            input.extend(radiance);
            input.extend([alpha, place]);
            slab_add(
                &mut march,
                radiance.map(f64::from),
                f64::from(alpha),
                f64::from(place),
            );
        }
        let mut row = vec![0.0; 44];
        let mut left = 1.0;
        for k in 0..8 {
            let f = slab_fragment(&march, k);
            row[k] = f.alpha * left;
            row[8 + k] = f.depth * f.alpha * left;
            for (sum, c) in row[16..19].iter_mut().zip(f.color) {
                *sum += left * f.alpha * c;
            }
            left *= 1.0 - f.alpha;
        }
        row[19] = left;
        wanted.extend(row);
    }
    let Some(got) = run(&["down_fragments.wgsl"], ENTRY, &input, count, 44 * count) else {
        return;
    };
    let worst = differences(&got, &wanted, 44);
    let largest = worst.iter().fold(0f64, |m, w| m.max(*w));
    println!("fragments: {largest:.1e}");
    // Depths go up to 16.
    assert!(largest < 1e-4, "{worst:?}");
}
