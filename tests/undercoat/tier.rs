//! When the undercoat is drawn, by which tier, and that no change of tier shows (test D11 of docs/down.md, on the processor's
//! evaluators).

use bevy_plumage::maths::undercoat::Density;
use bevy_plumage::maths::undercoat::density::{DownShape, TILE_SIZE, down_tile};
use bevy_plumage::maths::undercoat::slab::{Coat, SlabRay};
use bevy_plumage::maths::undercoat::tier::*;
use bevy_plumage::undercoat::draws_down;
use plumage_tests::gpu;

#[test]
fn rule_of_four_layers() {
    let drawn =
        |cover: f64, lift: f64, was: bool| is_drawn(cover, lift, CONTRAST, 1.0 / 255.0, was);
    // Real tracts: macaw 6.2 to 10.1, eagle 4.7 to 19.6 are skipped at rest; fillers and faces are drawn.
    let rest = |k: f64| drawn(cover_now(k, 0.0, 1.0, 0.0), 0.0, false);
    for k in [4.7, 6.2, 10.1, 19.6] {
        assert!(!rest(k), "{k}");
    }
    for k in [0.0, 0.9, 2.9, 3.2, 3.6] {
        assert!(rest(k), "{k}");
    }
    // What is skipped is below the error, rounded.
    assert!(cover_transmittance(4.0 + 1e-9) * CONTRAST < 1.1 / 255.0);
    // Hysteresis.
    assert!(drawn(4.2, 0.0, true) && !drawn(4.2, 0.0, false));
    assert!(!drawn(4.5, 0.0, true));
    // Ruffled, moulting, stretched.
    assert!(drawn(cover_now(9.0, 0.4, 1.0, 0.0), 0.4, false));
    assert!(drawn(cover_now(6.2, 0.0, 1.0, 0.5), 0.0, false));
    assert!(drawn(cover_now(6.2, 0.0, 2.0, 0.0), 0.0, false));
}

#[test]
fn shares_of_the_tiers() {
    let px = TIER_PX;
    let mut last: Option<TierMix<f64>> = None;
    for i in 0..4000 {
        let mix = tier_mix(f64::from(i) * 0.01, px);
        assert!((mix.near + mix.middle + mix.far - 1.0).abs() < 1e-12);
        assert!(
            [mix.near, mix.middle, mix.far]
                .iter()
                .filter(|w| **w > 0.0)
                .count()
                <= 2
        );
        if let Some(last) = last {
            assert!((mix.steps - last.steps).abs() < 0.05 && (mix.far - last.far).abs() < 0.03);
        }
        last = Some(mix);
    }
    assert_eq!(tier_mix(40.0, px).near, 1.0);
    assert_eq!(tier_mix(6.0, px).middle, 1.0);
    assert_eq!(tier_mix(1.0, px).far, 1.0);
    assert!(tier_mix(f64::NAN, px).steps >= 8.0);
}

#[test]
fn dolly_without_popping() {
    let tile = down_tile(&DownShape::default(), TILE_SIZE, 2.0, 4.0).expect("a sound tile");
    let density = Density::new(&tile);
    let coat = Coat {
        albedo: [0.9, 0.8, 0.5],
        skin: [0.4, 0.3, 0.25],
    };
    let far = FarTable::bake(&density, &coat, 256);
    for (eye, light, azimuth) in [
        (1.0f32, 0.87f32, 0.5f32),
        (0.7, 0.42, 1.3),
        (0.34, 0.6, 2.3),
    ] {
        let direction = |c: f32, a: f32| {
            let s = (1.0 - c * c).sqrt();
            [s * a.cos(), s * a.sin(), c]
        };
        let patch = |h: f32| {
            let mix = tier_mix(h, TIER_PX.map(|x| x as f32));
            let mut sum = [0.0f64; 3];
            const N: usize = 384;
            for i in 0..N {
                // A patch seen from everywhere around: the table has no azimuth of the view.
                let turn = std::f32::consts::TAU * (i as f32 * 0.754_877_7).fract();
                let ray = SlabRay {
                    place: [(i as f32 + 0.25) / N as f32, (i as f32 * 0.618_034).fract()],
                    eye: direction(eye, turn),
                    light: direction(light, turn + azimuth),
                };
                let found = tier_radiance(&density, &coat, &far, &ray, &mix);
                for (s, v) in sum.iter_mut().zip(found) {
                    *s += f64::from(v) / N as f64;
                }
            }
            sum
        };
        // 3 % nearer every frame: one second from 30 to 1 pixel.
        let frames = (0..116)
            .map(|i| patch(30.0 * 0.97f32.powi(i)))
            .collect::<Vec<_>>();
        let mut step = 0.0f64;
        let apart = |a: &[f64; 3], b: &[f64; 3]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
        };
        for pair in frames.windows(2) {
            step = step.max(apart(&pair[0], &pair[1]));
        }
        let total = apart(&frames[0], &frames[115]);
        // No frame changes three times as much as the one before it or after it; changes below a quarter of
        // a step of 8 bits are not seen, and count as that.
        let steps = frames.windows(2).map(|pair| apart(&pair[0], &pair[1]));
        let steps = steps.map(|s| s.max(0.25 / 255.0)).collect::<Vec<_>>();
        let slope = steps
            .windows(2)
            .map(|pair| (pair[0] / pair[1]).max(pair[1] / pair[0]))
            .fold(1.0, f64::max);
        println!(
            "eye {eye} light {light}: step {:.2}/255, slopes at most {slope:.2} apart, near to far {:.2}/255 of {:.0}/255",
            255.0 * step,
            255.0 * total,
            255.0 * frames[0][0]
        );
        assert!(step <= 1.0 / 255.0, "{eye} {light}: {step}");
        assert!(slope <= 3.0, "{eye} {light}: {slope}");
    }
}

/// From the far tier to none: feathers close over the down, and open again; it is left out and drawn again where nobody sees it.
#[test]
fn closing_feathers_hide_the_down_without_a_step() {
    let error = 1.0 / 255.0;
    let covers = (0..=800).map(|i| f64::from(i) * 0.01);
    let both = covers.clone().chain(covers.rev());
    let (mut drawn, mut changes) = (true, Vec::new());
    for cover in both {
        let now = draws_down(cover as f32, 0.0, error, drawn);
        if now != drawn {
            // What the picture changes by at once: all that shows of the down, times its contrast to the skin.
            changes.push((now, cover, cover_transmittance(cover) * CONTRAST));
        }
        drawn = now;
    }
    println!("{changes:?}");
    let [(false, closed, at_closing), (true, open, at_opening)] = changes[..] else {
        panic!("{changes:?}");
    };
    assert!(closed - open > 0.25, "no hysteresis: {closed} {open}");
    assert!(at_closing <= 1.0 / 255.0 && at_opening <= 1.01 / 255.0);
}

#[test]
fn table_between_its_nodes() {
    let tile = down_tile(&DownShape::default(), TILE_SIZE, 2.0, 4.0).expect("a sound tile");
    let density = Density::new(&tile);
    let coat = Coat {
        albedo: [0.9, 0.8, 0.5],
        skin: [0.4, 0.3, 0.25],
    };
    let far = FarTable::bake(&density, &coat, 64);
    for node in 0..FAR_SIZE {
        assert!((far_node(far_cosine(node)) - node as f32).abs() < 1e-4);
        let found = far.radiance(far_cosine(node), far_cosine(3));
        let stored = far.light[node + FAR_SIZE * 3];
        assert!((0..3).all(|c| (found[c] - stored[c]).abs() < 1e-4));
    }
    assert_eq!(far.radiance(0.5, 0.0), [0.0; 3]);
    assert_eq!(far.radiance(0.5, -0.5), [0.0; 3]);
    // Energy: a coat is no brighter than a white wall.
    assert!(
        far.light
            .iter()
            .chain(&far.sky)
            .flatten()
            .all(|x| (0.0..=1.0).contains(x))
    );
    assert!(far.radiance(f32::NAN, 0.5).iter().all(|x| x.is_finite()));
}

#[test]
fn shader_twin() {
    let text = "#import bevy_plumage::down_tier as t
        fn evaluate(i: u32) {
            let mix = t::tier_mix(input[i], vec2(12.0, 3.0));
            output[7u * i] = mix.near;
            output[7u * i + 1u] = mix.middle;
            output[7u * i + 2u] = mix.far;
            output[7u * i + 3u] = mix.steps;
            output[7u * i + 4u] = mix.mip;
            output[7u * i + 5u] = mix.rim;
            output[7u * i + 6u] = t::far_node(0.06 * input[i]);
        }";
    let input = (0..400).map(|i| i as f32 * 0.05).collect::<Vec<_>>();
    let Some(result) = gpu::run(&["down_tier.wgsl"], text, &input, 400, 2800) else {
        return;
    };
    for (h, got) in input.iter().zip(result.chunks(7)) {
        let m = tier_mix(*h, [12.0, 3.0]);
        let want = [
            m.near,
            m.middle,
            m.far,
            m.steps,
            m.mip,
            m.rim,
            far_node(0.06 * h),
        ];
        assert!(
            got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-4),
            "{h}: {got:?} {want:?}"
        );
    }
}
