//! The WGSL twin of `maths::vertex_light`.

use bevy_plumage::maths::vertex_light::vertex_light_error;

const TEXT: &str = "
#import bevy_plumage::vertex_light::vertex_light_error
fn evaluate(i: u32) {
    output[i] = vertex_light_error(input[2u * i], input[2u * i + 1u]);
}";

#[test]
fn shader_and_crate_agree() {
    let mut input: Vec<f32> = Vec::new();
    for turn in [0.0, 2.0, 5.0, 10.0, 20.0, 40.0] {
        for facing in 0..=40 {
            input.extend([turn, facing as f32 / 40.0]);
        }
    }
    let count = input.len() / 2;
    let files = ["math.wgsl", "vertex_light.wgsl"];
    let Some(found) = plumage_tests::gpu::run(&files, TEXT, &input, count, count) else {
        return;
    };
    for (x, found) in input.chunks(2).zip(found) {
        let wanted = vertex_light_error(x[0], x[1]);
        assert!((found - wanted).abs() < 1e-7, "{x:?}: {found}, {wanted}");
        // Nothing at all for a flat card; the more it turns and the less it is faced, the more.
        assert!((wanted > 0.0) == (x[0] > 0.0), "{x:?}: {wanted}");
        let (turned, faced) = (x[0] + 1.0, (x[1] + 0.1).min(1.0));
        assert!(vertex_light_error(turned, x[1]) > wanted, "{x:?}");
        assert!(vertex_light_error(x[0], faced) <= wanted, "{x:?}");
    }
}
