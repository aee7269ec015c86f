//! Test D10 (docs/down.md#tests): fur and strands mixed in a pixel, against the exact interleaving.

use plumage_reference::undercoat::fragments::*;
use plumage_tests::pixel::{Pixel, pixel_error as error, pixels};

type F = Fragment<f64>;

/// The table of docs/book/undercoat.md#reference-values, for 1, 3, 8 and 20 strands a pixel.
const TABLE: [(&str, [f64; 4]); 7] = [
    ("front", [0.094, 0.178, 0.214, 0.285]),
    ("published", [0.097, 0.133, 0.136, 0.111]),
    ("product", [0.082, 0.111, 0.115, 0.095]),
    ("mean depth", [0.062, 0.118, 0.118, 0.113]),
    ("2", [0.037, 0.051, 0.051, 0.049]),
    ("4", [0.017, 0.026, 0.024, 0.026]),
    ("8", [0.008, 0.011, 0.012, 0.012]),
];

#[test]
fn d10_virtual_fragments_stay_within_the_table() {
    for (column, strands) in [1, 3, 8, 20].into_iter().enumerate() {
        let pixels = pixels(strands);
        let exact: Vec<_> = pixels.iter().map(Pixel::exact).collect();
        let best = |product: bool| {
            (0..=12)
                .map(|i| {
                    let attenuation = 2f64.powf(f64::from(i) * 0.5);
                    error(&pixels, &exact, |p| p.published(attenuation, product))
                })
                .fold(f64::INFINITY, f64::min)
        };
        let mut rows = vec![
            error(&pixels, &exact, |p| p.one(true)),
            best(false),
            best(true),
            error(&pixels, &exact, |p| p.one(false)),
        ];
        for count in [2, 4, 8] {
            rows.push(error(&pixels, &exact, |p| {
                p.virtual_fragments(count, p.optical_depth())
            }));
        }
        let mean: Vec<f64> = [2, 4, 8]
            .map(|count| error(&pixels, &exact, |p| p.virtual_fragments(count, 4.0)))
            .into();
        println!("D10, {strands} strands:");
        for ((name, expected), row) in TABLE.iter().zip(&rows) {
            println!("  {name:12} {row:.4}  expected {}", expected[column]);
        }
        println!("  cut by the mean depth, 2/4/8: {mean:.4?}");
        for ((name, expected), row) in TABLE.iter().zip(&rows).skip(3) {
            assert!(
                *row < 1.2 * expected[column],
                "{strands} strands, {name}: {row}"
            );
        }
        for (i, (mean, row)) in mean.iter().zip(&rows[4..]).enumerate() {
            assert!(
                *mean < 1.2 * TABLE[4 + i].1[column],
                "{strands} strands, mean depth: {mean} {row}"
            );
        }
        for (row, (name, expected)) in rows.iter().zip(TABLE).take(3) {
            let ratio = row / expected[column];
            assert!(
                (0.85..1.15).contains(&ratio),
                "{name}: other pixels than the table's, {ratio}"
            );
        }
        assert!(
            rows[1] > rows[4] && rows[2] > rows[4],
            "two fragments beat Eq. (4)"
        );
    }
}

#[test]
fn slabs_alone_are_the_march() {
    for pixel in pixels(0) {
        for count in 1..=8 {
            for expected in [pixel.optical_depth(), 4.0, 0.5, 20.0] {
                let mut slabs = slabs(count, expected);
                let (mut sum, mut left) = ([0.0; 3], 1.0);
                for (radiance, alpha, depth) in pixel.march(40) {
                    slab_add(&mut slabs, radiance, alpha, depth);
                    for (sum, c) in sum.iter_mut().zip(radiance) {
                        *sum += left * alpha * c;
                    }
                    left *= 1.0 - alpha;
                }
                for (sum, c) in sum.iter_mut().zip(pixel.background) {
                    *sum += left * c;
                }
                let mut all: Vec<F> = (0..count as usize)
                    .map(|k| slab_fragment(&slabs, k))
                    .collect();
                let depths: Vec<f64> = all
                    .iter()
                    .filter(|f| f.alpha > 0.0)
                    .map(|f| f.depth)
                    .collect();
                let sorted = depths.windows(2).all(|d| d[0] < d[1] + 1e-12);
                assert!(sorted, "{depths:?}");
                for (a, b) in blend(&mut all, pixel.background).into_iter().zip(sum) {
                    assert!(
                        (a - b).abs() < 1e-5,
                        "{count} slabs, depth {expected}: {a} {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn slabs_have_equal_opacity() {
    for pixel in pixels(0).iter().take(50) {
        let mut slabs = slabs(4, pixel.optical_depth());
        for (radiance, alpha, depth) in pixel.march(16) {
            slab_add(&mut slabs, radiance, alpha, depth);
        }
        let whole = 1.0 - (-pixel.optical_depth()).exp();
        let mut left = 1.0;
        for k in 0..4 {
            let alpha = slab_fragment(&slabs, k).alpha;
            assert!(
                (left * alpha - whole / 4.0).abs() < 1e-5,
                "slab {k}: {}",
                left * alpha
            );
            left *= 1.0 - alpha;
        }
    }
}

#[test]
fn bad_marches_give_no_fragments() {
    for depth in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let mut march = slabs(0, depth);
        slab_add(&mut march, [1.0; 3], f64::NAN, 0.5);
        slab_add(&mut march, [1.0; 3], 2.0, 0.5);
        slab_add(&mut march, [1.0; 3], 0.5, 0.5);
        for k in [0, 7, 99] {
            let f = slab_fragment(&march, k);
            assert!(
                f.alpha.is_finite() && f.depth.is_finite() && f.color.iter().all(|c| c.is_finite())
            );
            assert!((0.0..=1.0).contains(&f.alpha));
        }
    }
}

#[test]
fn printed_blending_takes_off_for_strands_that_are_not_there() {
    let fur = F {
        color: [1.0; 3],
        alpha: 0.9,
        depth: 0.0,
    };
    let ghost = F {
        color: [0.0; 3],
        alpha: 0.0,
        depth: 0.1,
    };
    assert!(published::alpha(&fur, &[ghost], 2.0) < 0.1);
    assert_eq!(published::alpha(&fur, &[ghost; 4], 2.0), 0.0);
    assert_eq!(published::product_alpha(&fur, &[ghost; 4], 2.0), 0.9);
}
