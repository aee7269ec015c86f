//! The shader twins of `query` agree with the Rust functions.

use bevy_plumage::maths::query::{ErrorBudget, Lod, Vane};
use bevy_plumage::maths::{Footprint, functions, query};
use plumage_reference::query_published;
use plumage_tests::{gpu, sweep};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

const FILES: [&str; 1] = ["query_feather.wgsl"];

/// Largest difference; infinite where one is not a number.
fn difference(a: &[f32], b: &[f32]) -> f32 {
    let worst = |m: f32, e: f32| if e.is_nan() { f32::INFINITY } else { m.max(e) };
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, worst)
}

/// The text with the default budget's threshold as a constant.
fn with_threshold(text: &str) -> String {
    format!(
        "{text}\nconst THRESHOLD: f32 = {:?};",
        ErrorBudget::<f32>::default().threshold()
    )
}

#[test]
fn functions_of_one_variable() {
    let text = "#import bevy_plumage::math as m
        fn evaluate(i: u32) {
            let x = input[2u * i];
            let v = input[2u * i + 1u];
            let w = m::width(v);
            let d = m::staircase_derivatives(x, w);
            let values = array<f32, 13>(m::sine_turns(x), m::error_function(x), m::normal_distribution(x), m::staircase(x, w),
                d.x, d.y, m::overlap(x, 0.3, 0.4), m::overlap_integral(x, 0.3, 0.4), m::overlap_second_integral(x, 0.3, 0.4),
                m::overlap_third_integral(x, 0.3, 0.4), d.z * v, m::arc_sine(fract(abs(x))), m::normal_share(x));
            for (var j = 0u; j < 13u; j++) { output[13u * i + j] = values[j]; }
        }";
    let mut input = Vec::new();
    for i in 0..400 {
        for v in [1e-4f32, 0.01, 0.0149, 0.05, 0.3, 0.5] {
            input.extend([(i as f32 - 200.0) * 0.013, v]);
        }
    }
    let count = input.len() / 2;
    let Some(result) = gpu::run(&["math.wgsl"], text, &input, count, 13 * count) else {
        return;
    };
    for (pair, found) in input.chunks(2).zip(result.chunks(13)) {
        let (x, v) = (pair[0], pair[1]);
        let w = functions::width(v);
        let [first, second, third] = functions::staircase_derivatives(x, w);
        let wanted = [
            functions::sine_turns(x),
            functions::error_function(x),
            functions::normal_distribution(x),
            functions::staircase(x, w),
            first,
            second,
            functions::overlap(x, 0.3, 0.4),
            functions::overlap_integral(x, 0.3, 0.4),
            functions::overlap_second_integral(x, 0.3, 0.4),
            functions::overlap_third_integral(x, 0.3, 0.4),
            third * v,
            functions::arc_sine(x.abs().fract()),
            functions::normal_share(x),
        ];
        let exact = functions::normal_distribution(x);
        assert!((functions::normal_share(x) - exact).abs() < 2e-5, "{x}");
        for (j, (a, b)) in wanted.iter().zip(found).enumerate() {
            assert!(
                (a - b).abs() <= 2e-6 * (1.0 + a.abs()) + 2e-6 / v.min(1.0),
                "function {j} at {x}, {v}: {a} against {b}"
            );
        }
    }
}

#[test]
fn coverage_in_cell_units() {
    let text = "#import bevy_plumage::masking::{Cell}
        #import bevy_plumage::query::{cell_coverage, LOD_MIXED}
        #import bevy_plumage::query_far::{Local}
        fn evaluate(i: u32) {
            let a = 14u * i;
            let cell = Cell(input[a], input[a + 1u], input[a + 2u], input[a + 3u], input[a + 4u], input[a + 5u], input[a + 6u],
                input[a + 7u], input[a + 8u]);
            let local = Local(input[a + 9u], input[a + 10u], input[a + 11u], input[a + 12u], input[a + 13u]);
            let w = cell_coverage(cell, local, LOD_MIXED, THRESHOLD);
            output[3u * i] = w.x;
            output[3u * i + 1u] = w.y;
            output[3u * i + 2u] = w.z;
        }";
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut cases = sweep::cases(&mut random, 2000, false);
    cases.extend(sweep::cases(&mut random, 2000, true));
    let mut input = Vec::new();
    let mut wanted = Vec::new();
    let budget = ErrorBudget::<f32>::default();
    assert!((budget.threshold() - 0.3105).abs() < 1e-4);
    for (i, case) in cases.iter().enumerate() {
        let mut c = sweep::cell_f32(&case.cell);
        c.side = if i % 3 == 0 { -1.0 } else { 1.0 };
        let l = sweep::local_f32(&case.local);
        input.extend([
            c.kappa, c.e_root, c.v_low, c.v_high, c.h_d, c.h_p, c.s_d, c.s_p, c.side,
        ]);
        input.extend([l.u, l.tau, l.variance, l.slope, l.conditional]);
        wanted.push(query::cell_coverage(&c, &l, Lod::Mixed, &budget));
    }
    let Some(result) = gpu::run(
        &FILES,
        &with_threshold(text),
        &input,
        cases.len(),
        3 * cases.len(),
    ) else {
        return;
    };
    let mut worst = 0f32;
    let mut above = 0;
    for (i, (a, b)) in wanted.iter().zip(result.chunks(3)).enumerate() {
        let e = difference(a, b);
        worst = worst.max(e);
        if e > 1e-4 {
            above += 1;
            eprintln!(
                "{i}: {e} {a:?} {b:?} {:?} {:?}",
                cases[i].cell, cases[i].local
            );
        }
    }
    eprintln!(
        "{:?}: worst difference {worst}, {above} of {} above 1e-4",
        gpu::adapter_name(),
        cases.len()
    );
    assert!(above == 0, "{above} cases differ by more than 1e-4");
    // Twice what the README quotes. A GPU may round functions otherwise.
    let software = gpu::adapter_name().is_some_and(|name| name.contains("(Cpu)"));
    assert!(!software || worst <= 4.8e-6, "{worst}");
}

/// What a card is asked: everything that `cover` takes, as the shader reads it.
const WHOLE_INPUTS: usize = 25;

#[test]
fn whole_query() {
    let text = "#import bevy_plumage::anatomy::{barb_cotangent, barb_root}
        #import bevy_plumage::footprint::{Footprint, mirrored, widened}
        #import bevy_plumage::masking::{Vane, mask_rachis, vane_shape}
        #import bevy_plumage::query::{classify_bounds, LOD_MIXED}
        #import bevy_plumage::query_feather::{CardVane, Outline, cover_feather, cover_rachis, cover_vane}
        #import bevy_plumage::query_split::{outline_node, outline_root, outline_sight}
        // An outline of the given width and slope with a notch at 0.5 of the given depth.
        fn reach_at(outline: vec3<f32>, root: f32) -> vec2<f32> {
            let t = (root - 0.5) / 0.02;
            let notch = outline.z * exp(-0.5 * t * t);
            return vec2(outline.x * (1.0 - notch) + outline.y * (root - 0.5), outline.x * notch * t / 0.02 + outline.y);
        }
        fn side(card: CardVane, start: f32, contour: vec3<f32>, f: Footprint, seen: Footprint, edge: f32, view: vec3<f32>, lod: u32) -> vec3<f32> {
            let cotangent = barb_cotangent(card.shape.vane.sin_b, card.shape.vane.cos_b);
            let sight = outline_sight(seen, cotangent, 1.0 / 255.0);
            var nodes = vec2(0.0);
            for (var j = 0u; j < sight.count; j++) {
                nodes += outline_node(sight, j, reach_at(contour, outline_root(sight, j)));
            }
            let outline = Outline(reach_at(contour, barb_root(f.mean, cotangent)), nodes.y / max(nodes.x, 1e-9));
            return cover_vane(card, start, outline, f, edge, view, lod, LOD_MIXED, THRESHOLD).weights;
        }
        fn evaluate(i: u32) {
            let a = 25u * i;
            let vane = Vane(input[a], input[a + 1u], input[a + 2u], input[a + 3u], input[a + 4u], input[a + 5u], input[a + 6u],
                input[a + 7u], input[a + 8u], 1.0);
            let f = Footprint(vec2(input[a + 9u], input[a + 10u]), vec3(input[a + 11u], input[a + 12u], input[a + 13u]));
            let view = normalize(vec3(input[a + 14u], input[a + 15u], input[a + 16u]));
            let contour = vec3(input[a + 18u], input[a + 19u], input[a + 20u]);
            let card = CardVane(vane_shape(vane), input[a + 21u], input[a + 22u]);
            let start = input[a + 23u];
            let lod = u32(input[a + 24u]);
            let wide = widened(f).footprint;
            let edges = mask_rachis(input[a + 17u], view);
            let left = side(card, start, contour, wide, f, edges.x, view, lod);
            let right = side(card, start, contour, mirrored(wide), mirrored(f), -edges.y, view * vec3(-1.0, 1.0, 1.0), lod);
            let w = cover_feather(cover_rachis(wide, edges, f.mean.y), left, right);
            output[5u * i] = w.x;
            output[5u * i + 1u] = w.y;
            output[5u * i + 2u] = w.z;
            output[5u * i + 3u] = w.w;
            output[5u * i + 4u] = f32(classify_bounds(vane, sqrt(input[a + 13u]), sqrt(input[a + 11u]), THRESHOLD));
        }";
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let mut input: Vec<f32> = Vec::new();
    let mut wanted = Vec::new();
    let budget = ErrorBudget::<f32>::default();
    let count = 6000;
    for case in 0..count {
        let mut between = |a: f64, b: f64| sweep::between(&mut random, a, b) as f32;
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
        let major = between(-9.0, -3.0).exp();
        let minor = major * between(0.06, 1.0);
        let (sin, cos) = between(0.0, 3.2).sin_cos();
        let (a, b) = (major * major, minor * minor);
        let covariance = [
            a * cos * cos + b * sin * sin,
            (a - b) * sin * cos,
            a * sin * sin + b * cos * cos,
        ];
        let f = Footprint {
            mean: [between(-0.05, 0.05), between(0.0, 1.0)],
            covariance,
        };
        let view = [between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)];
        let radius = between(0.0, 0.02);
        // Half of the vanes have no end near the footprint, some no loose barbules.
        let ended = case % 2 == 0;
        let (width, slope, notch) = if ended {
            (between(0.01, 0.06), between(-0.1, 0.1), between(0.0, 0.6))
        } else {
            (10.0, 0.0, 0.0)
        };
        let card = query::CardVane {
            vane: v,
            fringe: if case % 3 == 0 {
                0.0
            } else {
                between(0.0, 0.5)
            },
            downy: if case % 5 == 0 {
                0.0
            } else {
                between(0.0, 0.5)
            },
        };
        let start = if ended { between(0.0, 0.3) } else { -10.0 };
        let threshold = budget.threshold();
        let classified =
            query::classify_bounds(&v, covariance[2].sqrt(), covariance[0].sqrt(), threshold);
        // What the LOD pass may have said of the card.
        let lod = [Lod::Mixed, Lod::Near, Lod::Far, Lod::Mean][case % 4];
        input.extend([
            v.p_b, v.d_bl, v.cos_b, v.sin_b, v.cos_bl, v.sin_bl, v.r_b, v.r_bd, v.r_bp,
        ]);
        input.extend(f.mean);
        input.extend(f.covariance);
        input.extend(view);
        input.extend([radius, width, slope, notch, card.fringe, card.downy, start]);
        input.push(lod as u32 as f32);
        let feather = query::CardFeather {
            vanes: [card; 2],
            rachis_radius: radius,
            start,
            reach: |_, root: f32| {
                let t = (root - 0.5) / 0.02;
                let notch = notch * (-0.5 * t * t).exp();
                [
                    width * (1.0 - notch) + slope * (root - 0.5),
                    width * notch * t / 0.02 + slope,
                ]
            },
            spacing: 1.0 / 255.0,
        };
        let c = query::cover(&feather, &f, f.mean[1], view, lod, &budget);
        wanted.push([
            c.rachis,
            c.barb,
            c.distal,
            c.proximal,
            classified as u32 as f32,
        ]);
    }
    assert_eq!(input.len(), count * WHOLE_INPUTS);
    let Some(result) = gpu::run(&FILES, &with_threshold(text), &input, count, 5 * count) else {
        return;
    };
    let mut errors = Vec::new();
    for (i, (a, b)) in wanted.iter().zip(result.chunks(5)).enumerate() {
        let e = difference(a, b);
        if e > 1e-3 {
            let asked = &input[WHOLE_INPUTS * i..WHOLE_INPUTS * (i + 1)];
            eprintln!("{i}: {a:?} {b:?} {asked:?}");
        }
        errors.push(f64::from(e));
    }
    let [rms, p99, max] = sweep::statistics(&errors);
    eprintln!("whole query, CPU against GPU: RMS {rms:.2e}, P99 {p99:.2e}, max {max:.2e}");
    assert!(p99 <= 1e-4 && max <= 1e-3, "P99 {p99}, max {max}");
}

#[test]
fn published_methods() {
    let text = "#import bevy_plumage::masking::{Cell}
        #import bevy_plumage::query_far::{Local}
        #import bevy_plumage::query_published::{PublishedMethod, published_evaluate}
        fn evaluate(i: u32) {
            let kind = i / COUNT + 1u;
            let a = 14u * (i % COUNT);
            let cell = Cell(input[a], input[a + 1u], input[a + 2u], input[a + 3u], input[a + 4u], input[a + 5u], input[a + 6u],
                input[a + 7u], input[a + 8u]);
            let local = Local(input[a + 9u], input[a + 10u], input[a + 11u], input[a + 12u], input[a + 13u]);
            let w = published_evaluate(cell, local, PublishedMethod(kind, 64u, 6u, 2, 3));
            output[3u * i] = w.x;
            output[3u * i + 1u] = w.y;
            output[3u * i + 2u] = w.z;
        }";
    let mut input = Vec::new();
    let mut wanted = Vec::new();
    // Mesa's software renderer stops every loop after 65,535 rounds in all, so no footprints of thousands of barbules.
    let mut cases = sweep::cases(&mut Pcg64Mcg::seed_from_u64(8), 800, true);
    cases.retain(|c| c.local.conditional < 9.0 && c.local.variance < 25.0);
    let nodes = query_published::Method::<f32>::nodes(6);
    let orders = query_published::Orders {
        stripes: 2,
        window: 3,
    };
    let methods = [
        query_published::Method::Points(64),
        query_published::Method::Spatial(nodes.clone()),
        query_published::Method::WholeGap(nodes.clone()),
        query_published::Method::Frequency(orders),
        query_published::Method::HardSwitch(nodes, orders),
    ];
    for case in &cases {
        let (c, l) = (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local));
        input.extend([
            c.kappa, c.e_root, c.v_low, c.v_high, c.h_d, c.h_p, c.s_d, c.s_p, c.side,
        ]);
        input.extend([l.u, l.tau, l.variance, l.slope, l.conditional]);
    }
    for method in &methods {
        for case in &cases {
            let (c, l) = (sweep::cell_f32(&case.cell), sweep::local_f32(&case.local));
            wanted.push(method.evaluate(&c, &l));
        }
    }
    let text = format!("{text}\nconst COUNT: u32 = {}u;", cases.len());
    let mut files = FILES.to_vec();
    files.push("query_published.wgsl");
    let Some(result) = gpu::run(&files, &text, &input, 5 * cases.len(), 15 * cases.len()) else {
        return;
    };
    let mut worst = [0f32; 5];
    for (i, (a, b)) in wanted.iter().zip(result.chunks(3)).enumerate() {
        // Over a whole gap the nodes' weights are far above 1.
        let scale = a.iter().fold(1f32, |m, x| m.max(x.abs()));
        let m = &mut worst[i / cases.len()];
        *m = m.max(difference(a, b) / scale);
    }
    eprintln!("published methods, CPU against GPU: {worst:?}");
    // A point on an edge may fall to either side: two samples of 64.
    assert!(worst[0] <= 2.1 / 64.0, "{worst:?}");
    assert!(worst[1..].iter().all(|e| *e < 2e-4), "{worst:?}");
}

#[test]
fn any_input_gives_shares() {
    // Every number is drawn on the GPU from its index: ordinary ones, zeros, denormals, extremes.
    let text = "#import bevy_plumage::masking::{Vane, mask_vane}
        #import bevy_plumage::query::{vane_coverage, LOD_MIXED}
        #import bevy_plumage::footprint::{Footprint}
        #import bevy_plumage::query_split::{rachis_line, split_line, line_part}
        fn hash(x: u32) -> u32 {
            let a = x * 747796405u + 2891336453u;
            let b = ((a >> ((a >> 28u) + 4u)) ^ a) * 277803737u;
            return (b >> 22u) ^ b;
        }
        var<private> state: u32;
        fn any_number(scale: f32) -> f32 {
            state = hash(state);
            let kind = state % 41u;
            if kind == 0u { return 0.0; }
            if kind == 1u { return bitcast<f32>(state >> 12u); }
            if kind == 2u { return 3.0e38; }
            if kind == 3u { return -3.0e38; }
            if kind == 4u { return 1e-30; }
            return (f32(state >> 8u) / 8388608.0 - 1.0) * scale;
        }
        fn evaluate(i: u32) {
            state = hash(i + 17u);
            var vane = Vane(0.004, 0.0004, 0.825, 0.565, 0.765, 0.644, 3e-4, 6e-5, 8e-5, 1.0);
            if i % 3u == 0u {
                vane.p_b = max(abs(any_number(0.01)), 1e-6);
                vane.d_bl = max(abs(any_number(0.001)), 1e-6);
                vane.r_b = abs(any_number(0.002));
                vane.r_bd = abs(any_number(0.0003));
                vane.r_bp = abs(any_number(0.0003));
            }
            let size = pow(10.0, clamp(any_number(1.0), -1.0, 1.0) * 3.0 - 4.0);
            let a = any_number(size);
            let b = any_number(size);
            let c = any_number(size);
            var f = Footprint(vec2(any_number(0.2), any_number(1.0)), vec3(a * a, a * b, b * b + c * c));
            if i % 5u == 0u {
                f.covariance = vec3(any_number(size), any_number(size), any_number(size));
            }
            let view = vec3(any_number(1.0), any_number(1.0), any_number(1.0));
            let cell = mask_vane(vane, view);
            let w = vane_coverage(cell, vane, f, LOD_MIXED, THRESHOLD);
            var wrong = max(max(-w.x, -w.y), -w.z);
            wrong = max(wrong, w.x + w.y + w.z - 1.0);
            let cut = split_line(f, rachis_line(any_number(0.1)), true);
            var mass = 0.0;
            for (var j = 0u; j < cut.parts; j++) { mass += line_part(cut, j).mass; }
            wrong = max(wrong, max(-mass, mass - 1.0) - 1e-5);
            // A comparison with what is no number fails, too.
            output[i] = select(1.0, wrong, wrong <= 2e-6 && mass > -1.0 && w.x + w.y + w.z < 2.0);
        }";
    let count = 1_000_000;
    let Some(result) = gpu::run(&FILES, &with_threshold(text), &[0.0], count, count) else {
        return;
    };
    let wrong: Vec<usize> = (0..count).filter(|i| result[*i] > 2e-6).collect();
    assert!(
        wrong.is_empty(),
        "{} inputs, first {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(8)]
    );
}

#[test]
fn a_pixel_ends() {
    let text = "#import bevy_plumage::query_split::ended_share
        fn evaluate(i: u32) {
            output[i] = ended_share(input[i]);
        }";
    let input: Vec<f32> = (0..=1000).map(|i| i as f32 / 1000.0).collect();
    let wanted: Vec<f32> = input.iter().map(|x| query::ended_share(*x)).collect();
    assert!(wanted[39] == 0.0 && wanted[41] > 0.0 && wanted[961] == 1.0);
    for (i, share) in wanted.iter().enumerate() {
        // Both sides of an outline alike, and nowhere far from the Gaussian.
        assert!((share + wanted[1000 - i] - 1.0).abs() < 1e-6, "{i}");
        assert!((share - input[i]).abs() < 0.0401, "{i}: {share}");
    }
    let Some(result) = gpu::run(&FILES, text, &input, input.len(), input.len()) else {
        return;
    };
    assert!(difference(&wanted, &result) < 1e-6);
}

#[test]
fn outlines() {
    let text = "#import bevy_plumage::footprint::{Footprint}
        #import bevy_plumage::query_split::{outline_sight, outline_root, outline_node}
        fn reach(root: f32) -> vec2<f32> {
            let t = (root - 0.5) / 0.02;
            let notch = 0.5 * exp(-0.5 * t * t);
            return vec2(0.2 * (1.0 - notch), 0.2 * notch * t / 0.02);
        }
        fn evaluate(i: u32) {
            let a = 5u * i;
            let f = Footprint(vec2(input[a], input[a + 1u]), vec3(input[a + 2u], input[a + 3u], input[a + 4u]));
            let sight = outline_sight(f, 0.8, 1.0 / 255.0);
            var sum = vec2(0.0);
            for (var j = 0u; j < sight.count; j++) {
                sum += outline_node(sight, j, reach(outline_root(sight, j)));
            }
            output[i] = sum.y / sum.x;
        }";
    let mut random = Pcg64Mcg::seed_from_u64(12);
    let mut input = Vec::new();
    let mut wanted = Vec::new();
    for _ in 0..2000 {
        let mut between = |a: f64, b: f64| sweep::between(&mut random, a, b) as f32;
        let sigma = between(-8.0, -3.0).exp();
        let (a, b, c) = (sigma, between(-1.0, 1.0) * sigma, between(0.1, 1.0) * sigma);
        let f = Footprint {
            mean: [between(-0.25, -0.05), between(0.55, 0.75)],
            covariance: [a * a, a * b, b * b + c * c],
        };
        input.extend(f.mean);
        input.extend(f.covariance);
        wanted.push(query::outline_share(&f, 0.8, 1.0 / 255.0, |root: f32| {
            let t = (root - 0.5) / 0.02;
            let notch = 0.5 * (-0.5 * t * t).exp();
            [0.2 * (1.0 - notch), 0.2 * notch * t / 0.02]
        }));
    }
    let Some(result) = gpu::run(&FILES, text, &input, wanted.len(), wanted.len()) else {
        return;
    };
    let worst = difference(&wanted, &result);
    eprintln!("outline, CPU against GPU: {worst:.2e}");
    assert!(worst < 2e-4, "{worst}");
}
