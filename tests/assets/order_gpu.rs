//! The WGSL twin of `maths::order`.

use bevy_plumage::maths::order::{
    WINDOW_MOST, order_reach, raised_heights, raised_held, raised_pack, raised_widest,
    raised_window, stirred_window,
};

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

const RAISED_TEXT: &str = "
#import bevy_plumage::order::{raised_heights, raised_held, raised_widest, raised_window, stirred_window}
fn evaluate(i: u32) {
    var words: vec4<u32>;
    var shares: vec4<f32>;
    for (var k = 0u; k < 4u; k++) {
        words[k] = u32(input[9u * i + k]);
        shares[k] = input[9u * i + 4u + k];
    }
    let heights = raised_heights(words);
    for (var k = 0u; k < 4u; k++) {
        output[8u * i + k] = heights[k];
    }
    output[8u * i + 4u] = raised_window(words, shares, input[9u * i + 8u]);
    output[8u * i + 5u] = raised_widest(words);
    output[8u * i + 6u] = raised_held(words, shares);
    output[8u * i + 7u] = stirred_window(0.1, 0.2 * input[9u * i + 8u]);
}";

#[test]
fn vertices_keep_heights_and_windows() {
    let mut cases = Vec::new();
    let mut input: Vec<f32> = Vec::new();
    for number in 0..400 {
        let part = |k: usize| ((number * 37 + k * 101) % 97) as f32 / 96.0;
        let heights: [f32; 4] = std::array::from_fn(|k| 2.0 * part(k) - 1.0);
        let windows: [f32; 6] = std::array::from_fn(|k| WINDOW_MOST * part(7 + k).powi(2));
        let mut shares: [f32; 4] = std::array::from_fn(|k| part(20 + k));
        let sum = shares.iter().sum::<f32>() + part(30);
        shares = shares.map(|share| share / sum.max(1.0e-3));
        let between = part(40);
        let words = raised_pack(heights, windows, part(50));
        for (found, wanted) in raised_heights::<f32>(words).into_iter().zip(heights) {
            assert!((found - wanted).abs() < 0.6 / 1023.0, "{found}, {wanted}");
        }
        // A window is kept no narrower than asked for, and less than a step wider.
        for pose in 0..6 {
            let mut worn = [0.0; 4];
            let between = if pose == 5 { 1.0 } else { 0.0 };
            if (1..5).contains(&pose) {
                worn[pose - 1] = 1.0;
            }
            let found: f32 = raised_window(words, worn, between);
            let step = |window: f32| 7.0 * (window / WINDOW_MOST).sqrt();
            let first = if pose == 5 {
                found.max(windows[0])
            } else {
                found
            };
            assert!(
                first >= windows[pose] - 1.0e-6,
                "{pose}: {found}, {windows:?}"
            );
            assert!(pose == 5 || step(found) < step(windows[pose]) + 1.001);
            assert!(found <= raised_widest::<f32>(words) + 1.0e-6);
        }
        input.extend(words.map(f32::from));
        input.extend(shares);
        input.push(between);
        cases.push((words, shares, between));
    }
    let files = ["math.wgsl", "order.wgsl"];
    let (count, values) = (cases.len(), 8 * cases.len());
    let Some(found) = plumage_tests::gpu::run(&files, RAISED_TEXT, &input, count, values) else {
        return;
    };
    for ((words, shares, between), found) in cases.into_iter().zip(found.chunks(8)) {
        let window = raised_window(words, shares, between);
        let wanted = raised_heights::<f32>(words);
        let others = [
            window,
            raised_widest(words),
            raised_held(words, shares),
            stirred_window(0.1, 0.2 * between),
        ];
        let wanted = wanted.into_iter().chain(others);
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1.0e-6,
                "{words:?}: {found}, {wanted}"
            );
        }
    }
}
