//! The map that distant cards are cut out by: against dense sampling of the outline, and its shader twin.

use bevy_plumage::anatomy::{CONTOUR_ROWS, Feather, RACHIS_ROWS, ShapeTable, Side};
use bevy_plumage::maths::query::{
    CardVane, Component, ErrorBudget, MAP_SIZE, Vane, map_decided, map_place, map_share, map_sight,
    map_vanes, mean_stop, mean_vane,
};
use plumage_tests::{
    geometry::dense_shares,
    gpu, shipped,
    sweep::{between, statistics},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// A map with its levels, read as a GPU reads them: linear between texels and levels, held at the edges.
struct Levels(Vec<(usize, usize, Vec<f64>)>);

impl Levels {
    fn of(feather: &Feather) -> Self {
        let [mut width, mut height] = MAP_SIZE.map(|side| side as usize);
        let mut texels: Vec<f64> = feather
            .outline_map()
            .iter()
            .map(|x| f64::from(*x) / 255.0)
            .collect();
        let mut levels = Vec::new();
        loop {
            levels.push((width, height, texels.clone()));
            if width <= 2 {
                return Self(levels);
            }
            let at = |x: usize, y: usize| texels[y * width + x];
            let next = (0..height / 2)
                .flat_map(|y| (0..width / 2).map(move |x| (2 * x, 2 * y)))
                .map(|(x, y)| 0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)))
                .collect();
            (width, height, texels) = (width / 2, height / 2, next);
        }
    }

    fn on(&self, level: usize, place: [f64; 2]) -> f64 {
        let (width, height, texels) = &self.0[level];
        let x = place[0] * *width as f64 - 0.5;
        let y = place[1] * *height as f64 - 0.5;
        let at = |x: f64, y: f64| {
            let x = x.clamp(0.0, *width as f64 - 1.0) as usize;
            let y = y.clamp(0.0, *height as f64 - 1.0) as usize;
            texels[y * width + x]
        };
        let (i, j) = (x.floor(), y.floor());
        let row = |j: f64| at(i, j) + (at(i + 1.0, j) - at(i, j)) * (x - i);
        row(j) + (row(j + 1.0) - row(j)) * (y - j)
    }

    fn look(&self, place: [f64; 2], level: f64) -> f64 {
        let last = self.0.len() - 1;
        let level = level.clamp(0.0, last as f64);
        let low = level as usize;
        let (a, b) = (self.on(low, place), self.on((low + 1).min(last), place));
        a + (b - a) * (level - low as f64)
    }
}

/// Least share of fine footprints that one look decides about.
const LEAST_DECIDED: f64 = 0.5;

/// Linear between the rows of a table.
fn linear(rows: &[[f32; 4]], place: f64, column: usize) -> f64 {
    let i = (place as usize).min(rows.len() - 2);
    let (low, high) = (f64::from(rows[i][column]), f64::from(rows[i + 1][column]));
    low + (high - low) * (place - i as f64)
}

fn curve_at(table: &ShapeTable, v: f64) -> f64 {
    linear(
        &table.rachis,
        v.clamp(0.0, 1.0) * (RACHIS_ROWS - 1) as f64,
        0,
    )
}

/// Whether a point of the card is inside, by the tables that the shaders read.
fn is_inside(table: &ShapeTable, feather: &Feather, [u, v]: [f64; 2]) -> bool {
    let curve = curve_at(table, v);
    let x = (u - curve) * f64::from(feather.aspect);
    let side = usize::from(x > 0.0);
    let vane = feather.query_vane::<f64>([Side::Left, Side::Right][side]);
    let root = v - x.abs() * vane.cos_b / vane.sin_b;
    let start = f64::from(table.start);
    let row = (root - start) / (1.0 - start) * (CONTOUR_ROWS - 1) as f64;
    root >= start
        && x.abs()
            <= linear(
                &table.contour,
                row.clamp(0.0, (CONTOUR_ROWS - 1) as f64),
                side,
            )
}

/// A pixel over a card of so many pixels from root to tip: its place and the derivatives of it.
struct Pixel {
    uv: [f64; 2],
    dx: [f64; 2],
    dy: [f64; 2],
}

impl Pixel {
    fn random(random: &mut Pcg64Mcg, pixels: [f64; 2], aspect: f64) -> Self {
        let uv = [between(random, 0.0, 1.0), between(random, 0.0, 1.0)];
        let (low, high) = (pixels[0].ln(), pixels[1].ln());
        let long = between(random, low, high).exp();
        // A card turned on the screen, after it has been turned out of it.
        let (slant_sin, slant_cos) = between(random, 0.0, 3.2).sin_cos();
        let narrow = between(random, 0.2, 1.0);
        let (sin, cos) = between(random, 0.0, 6.3).sin_cos();
        // Canonical lengths a pixel along an axis of the screen.
        let step = |[x, y]: [f64; 2]| {
            let (a, b) = (x * cos - y * sin, (x * sin + y * cos) / narrow);
            let (a, b) = (a * slant_cos - b * slant_sin, a * slant_sin + b * slant_cos);
            [a / long / aspect, b / long]
        };
        let (dx, dy) = (step([1.0, 0.0]), step([0.0, 1.0]));
        Self { uv, dx, dy }
    }

    /// Share of it inside the outline, densely sampled.
    fn truth(&self, table: &ShapeTable, feather: &Feather) -> f64 {
        dense_shares(
            4000,
            |[a, b]| [0, 1].map(|k| self.uv[k] + 0.5 * (self.dx[k] * a + self.dy[k] * b)),
            |point| match is_inside(table, feather, point) {
                true => Component::Rachis,
                false => Component::None,
            },
        )[1]
    }
}

/// Root mean square, 99th percentile and largest error of the map over cards of so many pixels from root to tip.
fn errors(name: &str, pixels: [f64; 2], count: usize) -> [f64; 3] {
    let feather = shipped::feather(name);
    let levels = Levels::of(&feather);
    let table = feather.shape_table();
    let mut random = Pcg64Mcg::seed_from_u64(71);
    let (mut errors, mut bias) = (Vec::new(), 0.0);
    while errors.len() < count {
        let pixel = Pixel::random(&mut random, pixels, feather.aspect.into());
        let sight = map_sight(pixel.dx, pixel.dy);
        if !sight.serves {
            continue;
        }
        let found = map_share(pixel.uv, &sight, |place, level| levels.look(place, level));
        let off = found - pixel.truth(&table, &feather);
        bias += off / count as f64;
        errors.push(off.abs());
    }
    let found = statistics(&errors);
    eprintln!("{name}, {pixels:?} pixels: RMS, P99, max {found:.4?}, bias {bias:.4}");
    assert!(bias.abs() <= 0.007, "{name}: {bias}");
    found
}

#[test]
fn the_map_is_the_outline() {
    for name in [
        "contour",
        "macaw_contour",
        "macaw_primary",
        "macaw_head",
        "eagle_trouser",
        "eagle_primary",
    ] {
        // A contour's tangents are off by 0.05 to 0.16 on the smallest of these, by 0.008 to 0.044 on the others.
        for (pixels, most) in [
            ([6.0, 40.0], [0.025, 0.08]),
            ([40.0, 90.0], [0.016, 0.075]),
            ([90.0, 140.0], [0.016, 0.08]),
        ] {
            let [rms, p99, _] = errors(name, pixels, 600);
            assert!(
                rms <= most[0] && p99 <= most[1],
                "{name}, {pixels:?}: {rms} {p99}"
            );
        }
    }
}

#[test]
fn one_look_decides_within_and_beyond_the_outline() {
    for name in ["contour", "macaw_primary", "macaw_neck", "eagle_trouser"] {
        let feather = shipped::feather(name);
        let levels = Levels::of(&feather);
        let table = feather.shape_table();
        let mut random = Pcg64Mcg::seed_from_u64(74);
        let (mut fine, mut errors) = (0, Vec::new());
        while fine < 1500 {
            let pixel = Pixel::random(&mut random, [150.0, 2000.0], feather.aspect.into());
            let sight = map_sight(pixel.dx, pixel.dy);
            if sight.serves {
                continue;
            }
            fine += 1;
            let look = levels.look(map_place(pixel.uv), sight.level);
            let decided = map_decided(look, sight.level);
            if decided >= 0.0 {
                errors.push((decided - pixel.truth(&table, &feather)).abs());
            }
        }
        let share = errors.len() as f64 / f64::from(fine);
        let [rms, _, most] = statistics(&errors);
        eprintln!("{name}: {share:.2} decided, RMS, max {rms:.5} {most:.4}");
        assert!(share >= LEAST_DECIDED, "{name}: {share}");
        assert!(rms <= 0.001 && most <= 0.01, "{name}: {rms} {most}");
    }
}

#[test]
fn the_shader_looks_where_the_processor_does() {
    let text = "#import bevy_plumage::query_map::{map_decided, map_place, map_sight, map_vanes}
        fn evaluate(i: u32) {
            let a = 7u * i;
            let s = map_sight(vec2(input[a], input[a + 1u]), vec2(input[a + 2u], input[a + 3u]));
            let place = map_place(vec2(input[a + 4u], input[a + 5u]));
            let vanes = map_vanes(input[a + 4u], input[a + 5u], vec2(input[a + 6u], 1.0 - input[a + 6u]));
            let decided = map_decided(4.0 * input[a + 5u] - 1.0, s.level);
            let values = array<f32, 10>(s.step.x, s.step.y, s.level, f32(s.count), f32(s.serves), place.x, place.y, vanes.x, vanes.y, decided);
            for (var j = 0u; j < 10u; j++) { output[10u * i + j] = values[j]; }
        }";
    let mut random = Pcg64Mcg::seed_from_u64(72);
    let mut input = Vec::new();
    let mut wanted = Vec::new();
    for i in 0..4000 {
        let mut d = [0.0; 4].map(|_: f32| {
            let size = between(&mut random, -9.0, 1.0).exp();
            (size * between(&mut random, -1.0, 1.0)) as f32
        });
        // Nothing at all, along one axis, and square.
        match i % 40 {
            0 => d = [0.0; 4],
            1 => (d[1], d[3]) = (0.0, 0.0),
            2 => (d[2], d[3]) = (-d[1], d[0]),
            _ => {}
        }
        let [u, v, left] = [0.0; 3].map(|_: f32| between(&mut random, 0.0, 1.0) as f32);
        input.extend(d);
        input.extend([u, v, left]);
        let sight = map_sight([d[0], d[1]], [d[2], d[3]]);
        let [x, y] = map_place([u, v]);
        let vanes = map_vanes(u, v, [left, 1.0 - left]);
        let [a, b] = sight.step;
        let serves = f32::from(u8::from(sight.serves));
        wanted.extend([
            a,
            b,
            sight.level,
            sight.count as f32,
            serves,
            x,
            y,
            vanes[0],
            vanes[1],
            map_decided(4.0 * v - 1.0, sight.level),
        ]);
    }
    assert!(wanted.iter().all(|x| x.is_finite()));
    let Some(result) = gpu::run(&["query_map.wgsl"], text, &input, 4000, 10 * 4000) else {
        return;
    };
    let mut other = 0;
    for (i, (a, b)) in wanted.chunks(10).zip(result.chunks(10)).enumerate() {
        // A rounding may ask for one look more, take the map for too coarse, or look a level higher, at the very border.
        let coarser = a[4] == 0.0 && a[2] != b[2];
        if a[3] != b[3] || a[4] != b[4] || coarser {
            other += 1;
            continue;
        }
        // Which end is the first one does not matter where both axes are alike.
        let turned = a[0] * b[0] + a[1] * b[1] < 0.0;
        for j in 0..10 {
            let b = if turned && j < 2 { -b[j] } else { b[j] };
            let off = (a[j] - b).abs();
            assert!(
                off <= 2e-4 * (1.0 + a[j].abs()),
                "{i}: value {j}: {a:?} {b:?}"
            );
        }
    }
    assert!(other <= 4, "{other} differ");
}

#[test]
fn the_shader_averages_a_vane_as_the_processor_does() {
    let text = "#import bevy_plumage::masking::{Vane, vane_shape}
        #import bevy_plumage::query_feather::{CardVane, mean_stop, mean_vane}
        fn evaluate(i: u32) {
            let a = 18u * i;
            let vane = Vane(input[a], input[a + 1u], input[a + 2u], input[a + 3u], input[a + 4u], input[a + 5u], input[a + 6u],
                input[a + 7u], input[a + 8u], 1.0);
            let card = CardVane(vane_shape(vane), input[a + 9u], input[a + 10u]);
            let view = normalize(vec3(input[a + 15u], input[a + 16u], input[a + 17u]));
            let found = mean_vane(card, vec2(input[a + 11u], input[a + 12u]), input[a + 13u], input[a + 14u], view);
            output[4u * i] = found.weights.x;
            output[4u * i + 1u] = found.weights.y;
            output[4u * i + 2u] = found.weights.z;
            output[4u * i + 3u] = found.hook;
            output[8000u + i] = mean_stop(card, vec2(input[a + 11u], input[a + 12u]), input[a + 13u], input[a + 14u], view);
        }";
    let mut random = Pcg64Mcg::seed_from_u64(73);
    let mut input = Vec::new();
    let mut wanted = Vec::new();
    let mut stops = Vec::new();
    let budget = ErrorBudget::<f32>::default();
    for _ in 0..2000 {
        let mut between = |a: f64, b: f64| between(&mut random, a, b) as f32;
        let v = Vane::<f32>::from_measures(
            between(100.0, 600.0),
            between(20.0, 70.0),
            between(10.0, 40.0),
            between(20.0, 60.0),
            between(25.0, 60.0),
            between(3.0, 12.0),
            between(3.0, 12.0),
            between(40.0, 200.0),
        );
        let card = CardVane {
            vane: v,
            fringe: between(0.0, 0.5),
            downy: between(0.0, 0.3),
        };
        let mean = [between(-0.3, 0.0), between(0.0, 1.0)];
        let (reach, share) = (between(0.05, 0.3), between(-0.1, 1.0));
        let (x, y, z) = (between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
        let length = (x * x + y * y + z * z).sqrt();
        input.extend([
            v.p_b, v.d_bl, v.cos_b, v.sin_b, v.cos_bl, v.sin_bl, v.r_b, v.r_bd, v.r_bp,
        ]);
        input.extend([
            card.fringe,
            card.downy,
            mean[0],
            mean[1],
            reach,
            share,
            x,
            y,
            z,
        ]);
        let view = [x / length, y / length, z / length];
        wanted.push(mean_vane(&card, mean, reach, share, view, &budget));
        stops.push(mean_stop(&card, mean, reach, share, view));
    }
    let Some(result) = gpu::run(&["query_feather.wgsl"], text, &input, 2000, 5 * 2000) else {
        return;
    };
    let (parts, sums) = result.split_at(4 * 2000);
    for (i, (a, b)) in stops.iter().zip(sums).enumerate() {
        assert!((a - b).abs() <= 2e-4, "{i}: {a} {b}");
    }
    for (i, (a, b)) in wanted.iter().zip(parts.chunks(4)).enumerate() {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() <= 2e-4, "{i}: {a} {b}");
        }
    }
}
