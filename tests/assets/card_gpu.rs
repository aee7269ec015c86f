//! The WGSL twins of `maths::card`.

use bevy_plumage::maths::card;
use rand::{RngExt, SeedableRng};

const FILES: [&str; 1] = ["anatomy.wgsl"];
const COUNT: usize = 4000;
const INPUTS: usize = 16;
const OUTPUTS: usize = 26;

const TEXT: &str = "
#import bevy_plumage::anatomy::{
    CardSight, canonical_footprint, barb_cotangent, barb_root, contour_coverage, vane_start_coverage, hooked, barbule_factor, contour_row,
    card_share, card_size, edge_shift, narrowed, on_card,
}
fn evaluate(i: u32) {
    let k = i * 16u;
    let at = canonical_footprint(
        vec2(input[k], input[k + 1u]), vec2(input[k + 2u], input[k + 3u]), vec2(input[k + 4u], input[k + 5u]),
        input[k + 6u], input[k + 7u], input[k + 8u]);
    let cotangent = barb_cotangent(sin(input[k + 9u]), cos(input[k + 9u]));
    let reach = input[k + 10u];
    let root = barb_root(at.mean, cotangent);
    let o = i * 26u;
    output[o] = at.mean.x;
    output[o + 1u] = at.mean.y;
    output[o + 2u] = at.covariance.x;
    output[o + 3u] = at.covariance.y;
    output[o + 4u] = at.covariance.z;
    output[o + 5u] = root;
    output[o + 6u] = contour_coverage(at, reach, input[k + 11u], cotangent);
    output[o + 7u] = vane_start_coverage(at, input[k + 12u], cotangent);
    output[o + 8u] = hooked(abs(at.mean.x), at.mean.y, reach, input[k + 13u], input[k + 14u]);
    output[o + 9u] = barbule_factor(output[o + 8u]);
    output[o + 10u] = contour_row(root, input[k + 12u], 256.0);
    let place = vec2(input[k], input[k + 1u]);
    let size = card_size(vec2(input[k + 2u], input[k + 3u]), vec2(input[k + 4u], input[k + 5u]));
    output[o + 11u] = card_share(place, size);
    let weights = on_card(vec4(input[k], input[k + 1u], input[k + 12u], input[k + 13u]) * 0.25, output[o + 11u]);
    output[o + 12u] = weights.x;
    output[o + 13u] = weights.y;
    output[o + 14u] = weights.z;
    output[o + 15u] = weights.w;
    output[o + 16u] = edge_shift(
        input[k], abs(input[k + 7u]), 0.1 * input[k + 6u], input[k + 6u] - 0.5, input[k + 9u] - 0.7, input[k + 8u] > 0.6);
    let wide = CardSight(at, place, vec2(1.0 / input[k + 8u], size.y));
    let seen = narrowed(wide, vec2(input[k + 12u], 0.1 * input[k + 7u]));
    output[o + 17u] = seen.footprint.mean.x;
    output[o + 18u] = seen.footprint.mean.y;
    output[o + 19u] = seen.footprint.covariance.x;
    output[o + 20u] = seen.footprint.covariance.y;
    output[o + 21u] = seen.footprint.covariance.z;
    output[o + 22u] = seen.place.x;
    output[o + 23u] = seen.place.y;
    output[o + 24u] = seen.size.x;
    output[o + 25u] = seen.size.y;
}";

#[test]
fn shader_and_crate_agree() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(5);
    let mut input = Vec::with_capacity(COUNT * INPUTS);
    for i in 0..COUNT {
        let mut span = |low: f32, high: f32| low + (high - low) * random.random::<f32>();
        // Pixels from a twentieth of the feather down to a barbule's width.
        let size = 10f32.powf(span(-5.0, -1.3));
        let reach = if i % 10 == 0 { 0.0 } else { span(0.0, 0.3) };
        input.extend([
            span(0.0, 1.0),
            span(0.0, 1.0),
            size * span(-1.0, 1.0),
            size * span(-1.0, 1.0),
            size * span(-1.0, 1.0),
            size * span(-1.0, 1.0),
            span(0.2, 0.8),
            span(-0.6, 0.6),
            span(0.02, 1.2),
            span(0.1, 1.4),
            reach,
            if i % 7 == 0 {
                span(-20.0, 20.0)
            } else {
                span(-1.0, 1.0)
            },
            span(0.0, 0.3),
            if i % 5 == 0 { 0.0 } else { span(0.0, 1.0) },
            if i % 6 == 0 { 0.0 } else { span(0.0, 1.0) },
            span(-3000.0, 3000.0).round(),
        ]);
    }
    let Some(gpu) = plumage_tests::gpu::run(&FILES, TEXT, &input, COUNT, COUNT * OUTPUTS) else {
        return;
    };
    for (i, (x, got)) in input.chunks(INPUTS).zip(gpu.chunks(OUTPUTS)).enumerate() {
        let at =
            card::canonical_footprint([x[0], x[1]], [x[2], x[3]], [x[4], x[5]], x[6], x[7], x[8]);
        let cotangent = card::barb_cotangent(x[9].sin(), x[9].cos());
        let root = card::barb_root(at.mean, cotangent);
        let hooked = card::hooked(at.mean[0].abs(), at.mean[1], x[10], x[13], x[14]);
        let plain = [
            at.mean[0],
            at.mean[1],
            at.covariance[0],
            at.covariance[1],
            at.covariance[2],
            root,
        ];
        for k in 0..6 {
            let tolerance = 1e-6 + 2e-5 * plain[k].abs();
            assert!(
                (got[k] - plain[k]).abs() <= tolerance,
                "case {i} output {k}: {} against {}",
                got[k],
                plain[k]
            );
        }
        assert!(
            (got[8] - hooked).abs() < 1e-4,
            "case {i} hooked: {} against {hooked}",
            got[8]
        );
        assert!((got[9] - card::barbule_factor(hooked)).abs() < 1e-4);
        let size = card::card_size([x[2], x[3]], [x[4], x[5]]);
        let share = card::card_share([x[0], x[1]], size);
        assert!(
            (got[11] - share).abs() <= 1e-4,
            "case {i} share of the card: {} against {share}",
            got[11]
        );
        let weights = card::on_card([x[0], x[1], x[12], x[13]].map(|w| 0.25 * w), share);
        for k in 0..4 {
            assert!(
                (got[12 + k] - weights[k]).abs() <= 1e-3,
                "case {i} weight {k}: {} against {}",
                got[12 + k],
                weights[k]
            );
        }
        let wide = card::CardSight {
            footprint: at,
            place: [x[0], x[1]],
            size: [1.0 / x[8], size[1]],
        };
        let seen = card::narrowed(&wide, [x[12], 0.1 * x[7]]);
        let [f, place, size] = [&seen.footprint.mean, &seen.place, &seen.size];
        let c = seen.footprint.covariance;
        let seen = [
            f[0], f[1], c[0], c[1], c[2], place[0], place[1], size[0], size[1],
        ];
        for k in 0..9 {
            assert!(
                (got[17 + k] - seen[k]).abs() <= 1e-5 + 2e-5 * seen[k].abs(),
                "case {i} narrowed {k}: {} against {}",
                got[17 + k],
                seen[k]
            );
        }
        let shift = card::edge_shift(
            x[0],
            x[7].abs(),
            0.1 * x[6],
            x[6] - 0.5,
            x[9] - 0.7,
            x[8] > 0.6,
        );
        assert!(
            (got[16] - shift).abs() <= 1e-6,
            "case {i} shift: {} against {shift}",
            got[16]
        );
        let row = card::contour_row(root, x[12], 256.0);
        assert!(
            (got[10] - row).abs() < 0.01,
            "case {i} row: {} against {row}",
            got[10]
        );
        // A step over a footprint far smaller than the rounding of the point itself may fall on either side: the last
        // bits of the distance count in units of the footprint.
        for (k, value) in [
            (6, card::contour_coverage(&at, x[10], x[11], cotangent)),
            (7, card::vane_start_coverage(&at, x[12], cotangent)),
        ] {
            let sigma = at.covariance[0].max(at.covariance[2]).sqrt().max(1e-7);
            let tolerance = 1e-4 + 2e-6 / sigma;
            assert!(
                (0.0..=1.0).contains(&got[k]),
                "case {i} output {k}: {}",
                got[k]
            );
            assert!(
                (got[k] - value).abs() <= tolerance,
                "case {i} output {k}: {} against {value}",
                got[k]
            );
        }
    }
}
