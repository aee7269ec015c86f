//! Unit tests of the pure parts.

use bevy_plumage::anatomy::{
    Bars, Clumps, Contour, Feather, Gaps, Pattern, Rim, Side, Spline, Spot, Stop,
};
use bevy_plumage::asset::{AssetError, RonAsset};

fn primary() -> Feather {
    plumage_tests::shipped::feather("eagle_primary")
}

#[test]
fn presets_are_valid_and_named_once() {
    let all = plumage_tests::shipped::feathers();
    let mut names: Vec<_> = all.iter().map(|feather| feather.name.clone()).collect();
    assert!(names.len() >= 39);
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all.len());
    for feather in &all {
        feather
            .validate(&feather.name)
            .expect("a preset within its own ranges");
        let text = feather.to_ron().expect("text");
        assert_eq!(
            &Feather::from_ron(text.as_bytes(), "x").expect("read back"),
            feather
        );
        assert!(
            text.len() < 16 << 10,
            "{} has {} bytes",
            feather.name,
            text.len()
        );
    }
}

#[test]
fn preset_outlines_fit_their_card() {
    for feather in plumage_tests::shipped::feathers() {
        let map = feather.map();
        let angles = [feather.left.barb_angle, feather.right.barb_angle];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in feather.contour.polyline(angles) {
            let uv = map.uv(point.map(f64::from));
            assert!(
                (-0.002..=1.002).contains(&uv[1]),
                "{}: v {}",
                feather.name,
                uv[1]
            );
            (low, high) = (low.min(uv[0]), high.max(uv[0]));
        }
        assert!(
            low >= 0.0 && high <= 1.0,
            "{}: u {low} to {high}",
            feather.name
        );
        let radius = f64::from(feather.r_r(0.0) / feather.aspect);
        assert!(
            map.curve(0.0).0 - radius >= -0.001,
            "{}: shaft off the card",
            feather.name
        );
    }
}

#[test]
fn presets_keep_barbs_and_barbules_apart() {
    for feather in plumage_tests::shipped::feathers() {
        for side in Side::BOTH {
            let (barb, gap) = (2.0 * feather.r_b(side), feather.p_b(side));
            assert!(
                barb < 0.8 * gap,
                "{}: barbs fill {}",
                feather.name,
                barb / gap
            );
            let widest = 2.0 * feather.r_bd(side).max(feather.r_bp(side));
            assert!(widest < 0.8 * feather.p_bl(side), "{}", feather.name);
        }
    }
}

#[test]
fn table_one_by_hand() {
    let feather = primary();
    let angle = 36f32.to_radians();
    approx::assert_relative_eq!(
        feather.p_b(Side::Right),
        angle.sin() * 0.53 / 489.0,
        max_relative = 2e-3
    );
    approx::assert_relative_eq!(
        feather.d_bl(Side::Right),
        0.0365 / 489.0,
        max_relative = 1e-5
    );
    approx::assert_relative_eq!(feather.r_b(Side::Left), 0.040 / 489.0, max_relative = 1e-5);
    for side in Side::BOTH {
        let (n, v) = (feather.n_b(side), feather.v_b(side));
        assert!(
            (n[0] * v[0] + n[1] * v[1]).abs() < 1e-6,
            "normal and direction"
        );
        assert!(
            v[1] > 0.0 && v[0] * side.sign() > 0.0,
            "barbs run out and up"
        );
        // cos(alpha_bl) = n_bl . n_b for both families; they lean to opposite sides.
        let b = |m: [f32; 2]| m[0] * v[0] + m[1] * v[1];
        let a = |m: [f32; 2]| m[0] * n[0] + m[1] * n[1];
        let alpha = feather.vane(side).alpha_bl();
        approx::assert_abs_diff_eq!(a(feather.n_bd(side)), alpha.cos(), epsilon = 1e-6);
        approx::assert_abs_diff_eq!(a(feather.n_bp(side)), alpha.cos(), epsilon = 1e-6);
        approx::assert_abs_diff_eq!(b(feather.n_bd(side)), -alpha.sin(), epsilon = 1e-6);
        approx::assert_abs_diff_eq!(b(feather.n_bp(side)), alpha.sin(), epsilon = 1e-6);
    }
    approx::assert_relative_eq!(feather.r_r(0.0), 3.4 / 489.0, max_relative = 1e-5);
    approx::assert_relative_eq!(feather.r_r(0.5), 1.15 / 489.0, max_relative = 1e-4);
    approx::assert_relative_eq!(feather.r_r(1.0), 0.2 / 489.0, max_relative = 1e-4);
}

#[test]
fn spline_meets_its_values_and_is_smooth() {
    let values = [0.2, 0.25, 0.5, 0.45, 0.7];
    let spline = Spline::new(&values);
    for (i, value) in values.iter().enumerate() {
        approx::assert_abs_diff_eq!(
            spline.at(i as f64 / 4.0).0,
            f64::from(*value),
            epsilon = 1e-12
        );
    }
    let h = 1e-5;
    for i in 1..1000 {
        let v = i as f64 / 1000.0;
        let slope = (spline.at(v + h).0 - spline.at(v - h).0) / (2.0 * h);
        approx::assert_abs_diff_eq!(slope, spline.at(v).1, epsilon = 1e-7);
        let bend = |v: f64| (spline.at(v + h).1 - spline.at(v - h).1) / (2.0 * h);
        assert!(
            (bend(v + 2.0 * h) - bend(v - 2.0 * h)).abs() < 1.0,
            "second derivative jumps at {v}"
        );
    }
    // A straight line stays one; a natural end has no bend.
    let line = Spline::new(&[0.1, 0.2, 0.3]);
    approx::assert_abs_diff_eq!(line.at(0.37).0, 0.174, epsilon = 1e-7);
    let end = (spline.at(2.0 * h).1 - spline.at(0.0).1) / (2.0 * h);
    assert!(end.abs() < 1e-2, "bend {end} at the end");
    for odd in [f64::NAN, f64::INFINITY, -3.0, 7.0] {
        assert!(spline.at(odd).0.is_finite());
    }
    assert_eq!(Spline::new(&[]).at(0.5), (0.0, 0.0));
}

#[test]
fn polyline_to_contour_and_back() {
    // A diamond: 0.2 wide at half height. The barb from (0, y0) at 45 degrees meets x/0.2 = 2 (1 - y) above the middle.
    let diamond = [[0.0, 0.0], [0.2, 0.5], [0.0, 1.0], [-0.2, 0.5]];
    let contour = Contour::from_polyline(&diamond, [45.0, 45.0], 0.1, 91);
    for side in Side::BOTH {
        for root in [0.35f32, 0.5, 0.71, 0.93] {
            // x = 0.4 (1 - root - x)
            let expected = 0.4 * (1.0 - root) / 1.4;
            approx::assert_abs_diff_eq!(contour.reach(side, root), expected, epsilon = 1e-4);
        }
        assert_eq!(contour.reach(side, 0.05), 0.0);
        assert_eq!(contour.reach(side, f32::NAN), 0.0);
    }
    for point in contour.polyline([45.0, 45.0]).into_iter().skip(1) {
        let edge = if point[1] < 0.5 {
            0.4 * point[1]
        } else {
            0.4 * (1.0 - point[1])
        };
        // Barbs below the start do not exist, so the lowest points may lie inside.
        assert!(
            point[0].abs() <= edge + 1e-3,
            "{point:?} outside the diamond"
        );
    }
    for junk in [
        &[][..],
        &[[f32::NAN, 0.0]],
        &[[0.0, 0.0], [f32::INFINITY, 1.0], [0.3, 0.2]],
    ] {
        let contour = Contour::from_polyline(junk, [f32::NAN, 0.0], f32::NAN, 0);
        assert!(
            contour
                .left
                .iter()
                .chain(&contour.right)
                .all(|reach| reach.is_finite())
        );
    }
}

#[test]
fn gaps_split_where_told() {
    let flat = Contour {
        start: 0.0,
        left: vec![0.1; 256],
        right: vec![0.1; 256],
    };
    assert_eq!(flat.perturbed(&Gaps::default()), flat);
    for count in [1u32, 4, 7] {
        let gaps = Gaps {
            count,
            width: 0.01,
            depth: 0.5,
            seed: 9,
        };
        let split = flat.perturbed(&gaps);
        let minima = |values: &[f32]| {
            (1..values.len() - 1)
                .filter(|&i| {
                    values[i] < values[i - 1] && values[i] <= values[i + 1] && values[i] < 0.06
                })
                .count()
        };
        assert_eq!(minima(&split.left) + minima(&split.right), count as usize);
        for value in split.left.iter().chain(&split.right) {
            assert!((0.0..=0.1).contains(value));
        }
        assert_eq!(
            split,
            flat.perturbed(&gaps),
            "the same seed, the same splits"
        );
        assert_ne!(split, flat.perturbed(&Gaps { seed: 10, ..gaps }));
        // Half depth in the middle: the deepest barb keeps half.
        let deepest = split
            .left
            .iter()
            .chain(&split.right)
            .copied()
            .fold(1.0, f32::min);
        approx::assert_abs_diff_eq!(deepest, 0.05, epsilon = 2e-3);
    }
}

#[test]
fn clumps_part_the_barbs_towards_the_tip() {
    let flat = Contour {
        start: 0.0,
        left: vec![0.1; 256],
        right: vec![0.1; 256],
    };
    assert_eq!(flat.clumped(&Clumps::default()), flat);
    let clumps = Clumps {
        count: 12,
        depth: 0.8,
        variation: 0.0,
        ..Clumps::default()
    };
    let apart = flat.clumped(&clumps);
    assert_eq!(apart.left, apart.right);
    let deepest: Vec<(usize, f32)> = (1..255)
        .map(|i| (i, apart.left[i]))
        .filter(|(i, reach)| *reach < apart.left[i - 1] && *reach <= apart.left[i + 1])
        .collect();
    assert_eq!(deepest.len(), 11, "a gap between each two clumps");
    for (i, reach) in deepest {
        // Depth grows with the height.
        let height = i as f32 / 255.0;
        approx::assert_abs_diff_eq!(reach, 0.1 * (1.0 - 0.8 * height), epsilon = 0.012);
    }
    // A wedge: half as deep at half the way to its rim, which is 0.3 of a twelfth wide.
    let middle = 255 * 6 / 12;
    let rim = (0.5 * 0.3 / 12.0 * 255.0_f32).round() as usize;
    assert!(apart.left[middle + rim + 1] > 0.0999);
    let depth = |i: usize| 0.1 - apart.left[i];
    let halfway = depth(middle + rim / 2 + 1) / depth(middle);
    assert!((0.2..0.7).contains(&halfway), "{halfway}");
    let uneven = Clumps {
        variation: 1.0,
        ..clumps
    };
    let (one, other) = (
        flat.clumped(&uneven),
        flat.clumped(&Clumps { seed: 2, ..uneven }),
    );
    assert_eq!(one, flat.clumped(&uneven), "the same seed, the same clumps");
    assert_ne!(one, other);
    assert_ne!(one.left, one.right, "vanes of their own");
    for value in one.left.iter().chain(&one.right) {
        assert!((0.0..=0.1).contains(value));
    }
    // The shader's table has them: no level of detail is without.
    let mut feather = primary();
    let whole = feather.shape_table();
    feather.clumps = clumps;
    let parted = feather.shape_table();
    let area = |table: &[[f32; 4]]| table.iter().map(|row| row[0] + row[1]).sum::<f32>();
    let share = area(&parted.contour) / area(&whole.contour);
    assert!((0.85..0.97).contains(&share), "{share}");
}

#[test]
fn shape_table_follows_the_feather() {
    let mut feather = primary();
    feather.gaps = Gaps::default();
    let table = feather.shape_table();
    assert_eq!((table.rachis.len(), table.contour.len()), (64, 256));
    let map = feather.map();
    for (i, row) in table.rachis.iter().enumerate() {
        let v = i as f64 / 63.0;
        approx::assert_abs_diff_eq!(f64::from(row[0]), map.curve(v).0, epsilon = 1e-6);
        approx::assert_abs_diff_eq!(f64::from(row[1]), map.curve(v).1, epsilon = 1e-5);
        assert_eq!(row[2], feather.r_r(v as f32));
    }
    let step = (1.0 - table.start) / 255.0;
    for i in 1..255 {
        let root = table.start + step * i as f32;
        approx::assert_abs_diff_eq!(
            table.contour[i][0],
            feather.contour.reach(Side::Left, root),
            epsilon = 1e-6
        );
        let slope = (table.contour[i + 1][1] - table.contour[i - 1][1]) / (2.0 * step);
        approx::assert_abs_diff_eq!(table.contour[i][3], slope, epsilon = 1e-4);
    }
}

fn stop(v: f32, color: [f32; 3], tint: f32) -> Stop {
    Stop { v, color, tint }
}

#[test]
fn bake_paints_stops_rim_bars_and_tint() {
    let feather = plumage_tests::shipped::feather("eagle_contour");
    let pattern = Pattern {
        stops: vec![
            stop(0.0, [1.0, 0.0, 0.0], 0.0),
            stop(0.5, [0.0, 1.0, 0.0], 1.0),
        ],
        ..Pattern::default()
    };
    let (width, height) = (32, 128);
    let bytes = pattern.bake(width, height, &feather);
    assert_eq!(bytes.len(), width * height * 4);
    let at = |bytes: &[u8], column: usize, row: usize| {
        let i = (row * width + column) * 4;
        [bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]
    };
    assert!(at(&bytes, 16, 1)[0] > 240, "row 0 is the skin");
    assert_eq!(at(&bytes, 16, 120), [0, 255, 0, 255]);
    let rimmed = Pattern {
        rim: Some(Rim {
            width: 0.15,
            softness: Rim::SOFTNESS,
            color: [0.0, 0.0, 1.0],
            tint: 0.0,
        }),
        ..pattern.clone()
    };
    let bytes = rimmed.bake(width, height, &feather);
    assert_eq!(
        at(&bytes, 16, 90),
        [0, 255, 0, 255],
        "the middle keeps its color"
    );
    assert_eq!(
        at(&bytes, 0, 90),
        [0, 0, 255, 0],
        "the rim runs on beyond the outline"
    );
    // A soft one runs out over many pixels, a sharp one over few.
    let between = |softness: f32| {
        let rim = rimmed.rim.map(|rim| Rim {
            width: 0.4,
            softness,
            ..rim
        });
        let soft = Pattern {
            rim,
            ..rimmed.clone()
        };
        let bytes = soft.bake(width, height, &feather);
        let blues = (0..width).map(|column| at(&bytes, column, 90)[2]);
        blues.filter(|blue| (20..236).contains(blue)).count()
    };
    let (sharp, soft) = (between(0.1), between(1.0));
    assert!(sharp <= 4 && soft >= 8, "{sharp} and {soft} pixels");
    let barred = Pattern {
        bars: Some(Bars {
            count: 6.0,
            color: [0.0, 0.0, 1.0],
            share: 0.5,
            waviness: 0.0,
        }),
        ..pattern.clone()
    };
    let bytes = barred.bake(width, height, &feather);
    let blue = (0..height)
        .map(|row| f32::from(at(&bytes, 16, row)[2]))
        .sum::<f32>()
        / (255.0 * height as f32);
    assert!((blue - 0.5).abs() < 0.08, "bars fill {blue}");
    let flips = (1..height)
        .filter(|&row| (at(&bytes, 16, row)[2] > 127) != (at(&bytes, 16, row - 1)[2] > 127))
        .count();
    assert!((11..=13).contains(&flips), "{flips} edges for 6 bars");
    let spot = Spot {
        v: 0.7,
        across: 0.0,
        half_width: 0.3,
        half_length: 0.1,
        color: [0.0, 0.0, 1.0],
        tint: 0.0,
    };
    let pearl = Spot {
        half_width: 0.1,
        half_length: 0.03,
        color: [1.0; 3],
        ..spot
    };
    let spotted = Pattern {
        spots: vec![spot, pearl],
        ..pattern
    };
    let bytes = spotted.bake(width, height, &feather);
    let middle = (0.7 * height as f32) as usize;
    assert_eq!(
        at(&bytes, 16, middle),
        [255, 255, 255, 0],
        "the pearl lies on top"
    );
    assert_eq!(at(&bytes, 16, middle - 8)[2], 255, "inside the spot");
    for (column, row) in [(16, middle + 20), (16, middle - 20), (2, middle)] {
        assert_eq!(at(&bytes, column, row)[2], 0, "{column} {row} is outside");
    }
}

#[test]
fn errors_say_where_what_and_which_range() {
    let mut feather = primary();
    feather.left.barbules.angle = 95.0;
    let error = feather.validate(&feather.name).expect_err("95 degrees");
    assert_eq!(
        error.to_string(),
        "eagle_primary: `left.barbules.angle` is 95, allowed is 10 to 80"
    );
    let text = primary().to_ron().expect("text");
    let of = |text: String| {
        Feather::from_ron(text.as_bytes(), "a/b.feather.ron")
            .expect_err("damaged")
            .to_string()
    };
    assert_eq!(
        of(text.replace("version: 2,", "version: 7, newer: Some([1, (2)]),")),
        "a/b.feather.ron: format version 7, this crate reads 1 to 2 (written by a newer bevy_plumage: update the crate)"
    );
    assert!(of(text.replace("version: 2,", "version: 0,")).contains("too old"));
    assert_eq!(
        of(text.replace("length_mm: 489.0", "length_mm: -1.5")),
        "a/b.feather.ron: `length_mm` is -1.5, allowed is 0.1 to 5000"
    );
    assert!(of(text.replace("length_mm: 489.0", "length_mm: NaN")).contains("`length_mm` is NaN"));
    assert!(of(text.replace("start: 0.025", "start: inf")).contains("`contour.start` is inf"));
    let unknown = of(text.replace("aspect:", "aspekt:"));
    assert!(
        unknown.starts_with("a/b.feather.ron:5:") && unknown.contains("aspekt"),
        "{unknown}"
    );
    let long = Feather::from_ron(&vec![b' '; Feather::MAX_BYTES + 1], "big").expect_err("5 MB");
    assert!(matches!(long, AssetError::TooLarge { .. }));
    let mut feather = primary();
    feather.contour.left = vec![0.1; 2000];
    assert_eq!(
        feather
            .validate(&feather.name)
            .expect_err("long")
            .to_string(),
        "eagle_primary: `contour.left` is 2000 values long, allowed is 2 to 1024 values"
    );
    let mut feather = primary();
    feather.albedo.front.stops[1].v = 0.9;
    assert!(
        feather
            .validate("x")
            .expect_err("falling")
            .to_string()
            .contains("albedo.front.stops[2].v")
    );
}
