//! The WGSL twin of `maths::vertex_light`.

use bevy_plumage::maths::vertex_light::{grazing_light, vertex_light_error};

const TEXT: &str = "
#import bevy_plumage::vertex_light::{grazing_light, vertex_light_error}
fn evaluate(i: u32) {
    let at = 9u * i;
    let lights = vec2(input[at + 2u], input[at + 3u]);
    let shares = vec2(input[at + 4u], input[at + 5u]);
    let against = vec2(input[at + 6u], input[at + 7u]);
    output[2u * i] = vertex_light_error(input[at], input[at + 1u], lights, against, shares, input[at + 8u]);
    output[2u * i + 1u] = grazing_light(input[at + 6u]);
}";

#[test]
fn shader_and_crate_agree() {
    let mut input: Vec<f32> = Vec::new();
    for turn in [0.0, 2.0, 5.0, 10.0, 20.0, 40.0] {
        for (number, facing) in (0..=40).enumerate() {
            let facing = facing as f32 / 40.0;
            // The eye, one light, one of two, two, none: as frontal as that, the others along the card or away from it.
            let (others, first) = ([0.0, 0.3, 1.0][number % 3], [0.2, 0.6, 1.0][number / 3 % 3]);
            for (eye, lights, shares) in [
                (facing, [others, 1.0], [1.0, 0.0]),
                (others, [facing, 0.0], [1.0, 0.0]),
                (others, [1.0, facing], [first, 1.0 - first]),
                (1.0, [facing, others], [first, 1.0 - first]),
                (facing, [0.0, 0.0], [0.0, 0.0]),
            ] {
                input.extend([turn, eye]);
                input.extend(lights);
                input.extend(shares);
                // From behind the eye to against it.
                let mirrors = (number % 4 / 3) as f32;
                input.extend([2.0 * facing - 1.0, 1.0 - 1.5 * facing, mirrors]);
            }
        }
    }
    let count = input.len() / 9;
    let files = ["math.wgsl", "vertex_light.wgsl"];
    let Some(found) = plumage_tests::gpu::run(&files, TEXT, &input, count, 2 * count) else {
        return;
    };
    let said = |x: &[f32], turn: f32, more: f32| {
        let [eye, first, second] = [x[1], x[2], x[3]].map(|c| (c + more).min(1.0));
        vertex_light_error(turn, eye, [first, second], [x[6], x[7]], [x[4], x[5]], x[8])
    };
    for (x, found) in input.chunks(9).zip(found.chunks(2)) {
        let wanted = said(x, x[0], 0.0);
        let [found, ramp] = [found[0], found[1]];
        assert!((ramp - grazing_light(x[6])).abs() < 1e-6, "{x:?}: {ramp}");
        assert!((found - wanted).abs() < 1e-7, "{x:?}: {found}, {wanted}");
        // Nothing at all for a flat card; the more it turns and the less it is faced, the more.
        assert!((wanted > 0.0) == (x[0] > 0.0), "{x:?}: {wanted}");
        assert!(said(x, x[0] + 1.0, 0.0) > wanted, "{x:?}");
        assert!(said(x, x[0], 0.1) <= wanted, "{x:?}");
        // A light that there is not says nothing, one that is all there is and shines against the eye as much as the eye.
        let alone = |light: f32, share: f32, against: f32| {
            vertex_light_error(x[0], 1.0, [light, 0.0], [against, 0.0], [share, 0.0], x[8])
        };
        let faced = vertex_light_error(x[0], x[1], [1.0; 2], [0.0; 2], [1.0, 0.0], 0.0);
        assert_eq!(alone(x[1], 1.0, 1.0), faced, "{x:?}");
        assert!(
            alone(x[1], 0.3, 1.0) <= faced && alone(x[1], 0.0, 1.0) == alone(1.0, 1.0, 1.0),
            "{x:?}"
        );
        // Paint alone answers an eye that looks from the light's side.
        if x[0] < 40.0 && x[8] == 0.0 {
            assert_eq!(alone(x[1], 1.0, 0.0), alone(1.0, 1.0, 1.0), "{x:?}");
        }
    }
}
