//! The WGSL twin of `maths::order`.

use bevy_plumage::maths::order::order_reach;

const TEXT: &str = "
#import bevy_plumage::order::order_reach
fn evaluate(i: u32) {
    output[i] = order_reach(input[3u * i], input[3u * i + 1u], input[3u * i + 2u]);
}";

#[test]
fn shader_and_crate_agree() {
    let mut input: Vec<f32> = Vec::new();
    for window in [0.0, 0.001, 0.02] {
        for facing in -8..=8 {
            for along in 0..=20 {
                input.extend([window, facing as f32 / 8.0, along as f32 / 20.0]);
            }
        }
    }
    let count = input.len() / 3;
    let files = ["math.wgsl", "order.wgsl"];
    let Some(found) = plumage_tests::gpu::run(&files, TEXT, &input, count, count) else {
        return;
    };
    for (x, found) in input.chunks(3).zip(found) {
        let wanted = order_reach(x[0], x[1], x[2]);
        assert!((found - wanted).abs() < 1e-8, "{x:?}: {found}, {wanted}");
        let closed = x[1] <= 0.0 || x[2] <= 0.05;
        assert!(!closed || wanted == 0.0, "{x:?}: {wanted}");
        assert!(wanted <= x[0] && (x[0] == 0.0 || closed || wanted > 0.0));
    }
}
