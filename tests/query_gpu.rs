//! The shader twins of `query` agree with the Rust functions.
mod common;

use common::gpu;

#[test]
fn harness_runs() {
    let text = "#import bevy_plumage::math::{error_function}
        fn evaluate(i: u32) { output[i] = error_function(input[i]); }";
    let input: Vec<f32> = (0..200).map(|i| (i as f32 - 100.0) * 0.05).collect();
    let Some(result) = gpu::run(&["math.wgsl"], text, &input, 200, 200) else {
        return;
    };
    eprintln!("{:?}", gpu::adapter_name());
    for (x, y) in input.iter().zip(&result) {
        assert!((libm::erff(*x) - y).abs() < 1e-6, "erf({x}) = {y}");
    }
}
