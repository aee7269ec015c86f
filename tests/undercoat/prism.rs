//! The address of a cell in a prism (test D1 of docs/down.md), and its shader twin.

use plumage_reference::undercoat::prism::*;
use plumage_reference::undercoat::published;
use plumage_tests::gpu;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[test]
fn every_cell_once_and_back() {
    for level in 0..=8 {
        let cells = 1u32 << (2 * level);
        for index in 0..cells {
            let cell = prism_cell(index);
            let centre: [f64; 3] = prism_centre(cell, level);
            assert!(
                centre.iter().all(|l| (0.0..=1.0).contains(l)),
                "{level} {index}: {centre:?}"
            );
            assert_eq!(prism_index(centre, level), index, "level {level}");
            assert_eq!(
                prism_index(centre.map(|l| l as f32), level),
                index,
                "level {level}, f32"
            );
            // The inside agrees with Eq. 2.
            assert_eq!(published::floor_index(centre, level), i64::from(index));
        }
    }
}

#[test]
fn edges_and_corners_stay_inside() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let (mut bad, mut published_bad) = (0, 0);
    for i in 0..1_000_000u32 {
        let level = rng.random_range(0..=8u32);
        let n = 1u32 << level;
        // On a grid vertex, or on an edge between two.
        let a = rng.random_range(0..=n);
        let b = rng.random_range(0..=n - a);
        let t: f32 = if i % 2 == 0 {
            0.0
        } else {
            rng.random_range(0.0..1.0)
        };
        let (da, db) = match rng.random_range(0..3) {
            0 => (t, 0.0),
            1 => (0.0, t),
            _ => (t, -t),
        };
        let l1 = (a as f32 + da) / n as f32;
        let l2 = (b as f32 + db) / n as f32;
        let lambda = [1.0 - l1 - l2, l1, l2];
        let cells = 1u32 << (2 * level);
        let index = prism_index(lambda, level);
        bad += u32::from(index >= cells);
        // Any cell that is named has to touch the point.
        let near: [f32; 3] = prism_centre(prism_cell(index), level);
        let inside = lambda.iter().all(|l| *l >= 0.0);
        let far = (0..3)
            .map(|k| (near[k] - lambda[k]).abs())
            .fold(0.0, f32::max)
            * n as f32;
        bad += u32::from(inside && far > 1.01);
        published_bad +=
            u32::from(!(0..i64::from(cells)).contains(&published::floor_index(lambda, level)));
    }
    println!("ours {bad}, published floors {published_bad} of 1e6");
    assert_eq!(bad, 0);
    assert!(
        published_bad > 10_000,
        "the literal floors fail: {published_bad}"
    );
    for l in [f32::NAN, f32::INFINITY, -1.0, 2.0] {
        assert!(prism_index([l; 3], 3) < 64);
    }
}

#[test]
fn interior_is_the_published_index() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let mut differ = 0;
    for _ in 0..1_000_000 {
        let (x, y): (f32, f32) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
        let (x, y) = if x + y > 1.0 {
            (1.0 - x, 1.0 - y)
        } else {
            (x, y)
        };
        let lambda = [1.0 - x - y, x, y];
        let level = rng.random_range(0..=8u32);
        differ += u32::from(
            i64::from(prism_index(lambda, level)) != published::floor_index(lambda, level),
        );
    }
    println!("{differ} of 1e6 differ");
    assert!(differ < 200, "{differ}");
    // Eq. 1 as printed is one cell.
    assert_eq!(published::printed_sub_index(0.4f64, 5), 0);
    assert_eq!(published::printed_sub_index(1e-4f64, 5), 0);
}

#[test]
fn elements_of_prisms_with_different_levels_do_not_meet() {
    let levels = [0, 3, 1, 5, 2];
    let bases = prism_bases(&levels, 16).expect("few");
    let mut used = vec![false; bases[5] as usize];
    let mut collides = std::collections::HashSet::new();
    let mut published_twice = false;
    for (prism, level) in levels.iter().enumerate() {
        for layer in 0..16 {
            for index in 0..1 << (2 * level) {
                let at = prism_element(bases[prism], layer, *level, index) as usize;
                assert!(!std::mem::replace(&mut used[at], true));
                let theirs = published::global_index(
                    prism as u64,
                    16,
                    u64::from(layer),
                    *level,
                    u64::from(index),
                );
                published_twice |= !collides.insert(theirs);
            }
        }
    }
    assert!(used.iter().all(|u| *u));
    assert!(published_twice);
    assert_eq!(prism_bases(&[12; 300], 4096), None);
}

#[test]
fn levels_hold_on() {
    assert_eq!(prism_level(64.0f64, 2.0, 8), 5.0);
    assert_eq!(prism_level(1.0f64, 2.0, 8), 0.0);
    assert_eq!(prism_level(1e9f64, 2.0, 8), 8.0);
    assert_eq!(prism_level(f64::NAN, 2.0, 8), 0.0);
    assert_eq!(prism_level_next(3, 3.7f64), 3);
    assert_eq!(prism_level_next(3, 3.9f64), 4);
    assert_eq!(prism_level_next(3, 2.3f64), 3);
    assert_eq!(prism_level_next(3, 2.1f64), 2);
    assert_eq!(prism_level_next(0, 0.0f64), 0);
}

#[test]
fn shader_twin() {
    let text = "#import bevy_plumage::down_prism::{prism_index, prism_cell, prism_centre, prism_element}
        fn evaluate(i: u32) {
            let level = u32(input[4u * i + 3u]);
            let index = prism_index(vec3(input[4u * i], input[4u * i + 1u], input[4u * i + 2u]), level);
            let cell = prism_cell(index);
            let centre = prism_centre(cell, level);
            let back = prism_index(centre, level);
            output[4u * i] = f32(index);
            output[4u * i + 1u] = centre.y;
            output[4u * i + 2u] = f32(back);
            output[4u * i + 3u] = f32(prism_element(7u, 3u, level, index));
        }";
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let mut input = Vec::new();
    for _ in 0..5000 {
        let (x, y): (f32, f32) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
        let (x, y) = if x + y > 1.0 {
            (1.0 - x, 1.0 - y)
        } else {
            (x, y)
        };
        input.extend([1.0 - x - y, x, y, rng.random_range(0..=8u32) as f32]);
    }
    let Some(result) = gpu::run(&["down_prism.wgsl"], text, &input, 5000, 20_000) else {
        return;
    };
    for (i, got) in input.chunks(4).zip(result.chunks(4)) {
        let level = i[3] as u32;
        let index = prism_index([i[0], i[1], i[2]], level);
        let centre: [f32; 3] = prism_centre(prism_cell(index), level);
        assert_eq!(got[0], index as f32);
        assert!((got[1] - centre[1]).abs() < 1e-6);
        assert_eq!(got[2], index as f32);
        assert_eq!(got[3], prism_element(7, 3, level, index) as f32);
    }
}
