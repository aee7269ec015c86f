//! Test D6 (docs/down.md#tests): how much of a pixel a disc covers.

use bevy_plumage::maths::undercoat::coverage::*;
use bevy_plumage::maths::undercoat::texture::{Coat, Fur, FurError, fur_tile};
use std::f64::consts::PI;

/// Radii and centres that a hair may have, from a lattice without pattern.
fn discs(count: u32, least: f64, most: f64) -> impl Iterator<Item = (f64, [f64; 2])> {
    (0..count).map(move |i| {
        let at = |x: f64| (f64::from(i) * x + 0.5).fract();
        let r = least + (most - least) * at(0.819_172_513_396_164_4);
        (
            r,
            [at(0.671_043_606_703_789_2), at(0.549_700_477_901_970_1)],
        )
    })
}

/// The judge: the height of the disc inside the pixel, summed over columns.
fn counted(r: f64, centre: [f64; 2]) -> f64 {
    let n = 20_000;
    let (low, high) = ((centre[0] - r).max(0.0), (centre[0] + r).min(1.0));
    if low >= high {
        return 0.0;
    }
    let step = (high - low) / f64::from(n);
    (0..n)
        .map(|i| {
            let x = low + (f64::from(i) + 0.5) * step - centre[0];
            let h = (r * r - x * x).max(0.0).sqrt();
            let (bottom, top) = ((centre[1] - h).max(0.0), (centre[1] + h).min(1.0));
            (top - bottom).max(0.0) * step
        })
        .sum()
}

#[test]
fn exact_coverage_is_the_area() {
    let mut worst = 0f64;
    for (r, [x, y]) in discs(1500, 0.05, 2.0) {
        // Pixels around the disc too.
        for centre in [[x, y], [x - 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.6]] {
            worst = worst.max((disc_coverage(r, centre) - counted(r, centre)).abs());
        }
    }
    println!("largest difference to the counted area {worst:.1e}");
    assert!(worst < 2e-6, "{worst}");
}

#[test]
fn pixels_sum_to_the_disc() {
    let (mut worst, mut worst_single) = (0f64, 0f32);
    for (r, centre) in discs(4000, 0.05, 2.0) {
        let (mut sum, mut single) = (0.0, 0.0);
        for j in -4..=4 {
            for i in -4..=4 {
                let [x, y] = [centre[0] - f64::from(i), centre[1] - f64::from(j)];
                sum += disc_coverage(r, [x, y]);
                single += disc_coverage(r as f32, [x as f32, y as f32]);
            }
        }
        let area = PI * r * r;
        worst = worst.max((sum - area).abs());
        worst_single = worst_single.max((single - area as f32).abs() / area.max(1.0) as f32);
    }
    println!(
        "D6: pixels sum to pi r^2 within {worst:.1e} (f64), {worst_single:.1e} (f32, relative)"
    );
    assert!(worst < 1e-12, "{worst}");
    assert!(worst_single < 5e-6, "{worst_single}");
}

#[test]
fn discs_at_the_pixels_edge_are_shared() {
    for r in [0.05, 0.5, 1.0, 1.5] {
        let quarter = disc_coverage(r, [0.0, 0.0]);
        assert!((disc_coverage::<f64>(r, [1.0, 1.0]) - quarter).abs() < 1e-12);
        if r <= 1.0 {
            assert!((quarter - PI * r * r / 4.0).abs() < 1e-12);
        }
        assert_eq!(disc_coverage(r, [1.0 + r, 0.5]), 0.0);
    }
    assert!((disc_coverage::<f64>(9.0, [0.3, 0.3]) - 1.0).abs() < 1e-12);
    assert_eq!(disc_coverage(0.0, [0.5, 0.5]), 0.0);
    assert_eq!(disc_coverage(-1.0, [0.5, 0.5]), 0.0);
}

/// The product of two integrals, and the paper's chords and wedges, on discs that fit a pixel.
#[test]
fn approximations_err_as_measured() {
    let (mut product, mut paper) = (Vec::new(), Vec::new());
    for (r, centre) in discs(40_000, 0.05, 0.5) {
        product.push(disc_coverage_separable(r, centre) - disc_coverage(r, centre));
        let [own, ..] = plumage_reference::undercoat::coverage_published::four_pixels(r, centre);
        paper.push(own - disc_coverage(r, centre));
    }
    let largest = |e: &[f64]| e.iter().fold(0f64, |m, x| m.max(x.abs()));
    let rms = |e: &[f64]| (e.iter().map(|x| x * x).sum::<f64>() / e.len() as f64).sqrt();
    println!(
        "separable: max {:.4}, RMS {:.4}; published: max {:.4}, RMS {:.4}",
        largest(&product),
        rms(&product),
        largest(&paper),
        rms(&paper)
    );
    assert!(largest(&product) < 0.0107 && rms(&product) < 0.0022);
    assert!(rms(&product) < rms(&paper), "the published form is worse");
}

#[test]
fn published_chord_holds_up_to_the_radius() {
    let exact = |r: f64, d: f64| {
        let a = r - d;
        r * r * (a / r).acos() - a * (r * r - a * a).max(0.0).sqrt()
    };
    let error = |d: f64| {
        (plumage_reference::undercoat::coverage_published::chord(1.0, d) / exact(1.0, d) - 1.0)
            .abs()
    };
    let worst = (1..=1000)
        .map(|i| error(f64::from(i) * 1e-3))
        .fold(0.0, f64::max);
    println!(
        "chord: {worst:.4} up to r, {:.3} at 1.5 r, {:.2} at 1.9 r",
        error(1.5),
        error(1.9)
    );
    assert!(worst < 0.0081, "{worst}");
    assert!(error(1.5) > 0.06 && error(1.9) > 0.5);
}

#[test]
fn fur_has_the_depth_asked_for_and_keeps_its_directions() {
    for seed in 1..4 {
        let tile = plumage_tests::tiles::hair_tile(32, 32, seed);
        let mean = tile.extinction().iter().sum::<f32>() / tile.extinction().len() as f32;
        assert!((mean - 4.0).abs() < 1e-3, "{mean}");
        assert!(
            tile.tangent()
                .iter()
                .all(|t| (t.length() - 1.0).abs() < 1e-4 && t.z > 0.0)
        );
        let leaning = tile.tangent().iter().filter(|t| t.z < 0.99).count();
        assert!(leaning > tile.tangent().len() / 10, "hairs curl");
        let layer = 32 * 32;
        let mass = |z: usize| {
            tile.extinction()[z * layer..(z + 1) * layer]
                .iter()
                .sum::<f32>()
        };
        // The undercoat ends at 0.6 of the height, the overcoat thins out.
        assert!(mass(1) > 4.0 * mass(16) && mass(16) > mass(24) && mass(31) < 0.01 * mass(1));
    }
}

#[test]
fn fur_is_periodic() {
    // One fat hair across the corner of the tile lies in its four corners.
    let fur = Fur {
        coats: vec![Coat {
            hairs: 400,
            radius: [2.0, 2.0],
            length: [1.0, 1.0],
            curl: [30.0, 60.0],
        }],
        ..Fur::default()
    };
    let tile = fur_tile(&fur).expect("sound");
    let layer = |z: i32, x: i32| {
        (0..64)
            .map(|y| tile.extinction()[tile.cell(x, y, z)])
            .sum::<f32>()
    };
    let mean = |z: i32| (0..64).map(|x| layer(z, x)).sum::<f32>() / 64.0;
    for x in [0, 63] {
        let ratio = (0..8).map(|z| layer(z, x)).sum::<f32>() / (0..8).map(mean).sum::<f32>();
        assert!((ratio - 1.0).abs() < 0.3, "column {x}: {ratio}");
    }
}

#[test]
fn bad_furs_are_refused() {
    let good = Fur::default();
    let wrong = |change: &dyn Fn(&mut Fur)| {
        let mut fur = good.clone();
        change(&mut fur);
        fur_tile(&fur).expect_err("refused")
    };
    let field = |e: FurError| match e {
        FurError::OutOfRange { field, .. } => field,
        FurError::Empty => "empty".into(),
    };
    assert_eq!(field(wrong(&|f| f.size.x = 0)), "size.x");
    assert_eq!(
        field(wrong(&|f| f.optical_depth = f32::NAN)),
        "optical_depth"
    );
    assert_eq!(
        field(wrong(&|f| f.coats[1].radius = [2.0, 1.0])),
        "coats[1].radius"
    );
    assert_eq!(
        field(wrong(&|f| f.coats[0].hairs = u32::MAX)),
        "coats[0].hairs"
    );
    assert_eq!(
        field(wrong(&|f| f.size = bevy::math::UVec3::splat(1024))),
        "number of cells"
    );
    assert_eq!(field(wrong(&|f| f.coats.clear())), "empty");
}
