//! Strands: where they grow, their shape, and the shader twin against double precision.

use bevy::math::Vec3;
use bevy_plumage::maths::undercoat::strands::*;
use plumage_tests::gpu::run;
use rand_pcg::{
    Pcg64Mcg,
    rand_core::{Rng, SeedableRng},
};

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: V) -> f64 {
    dot(a, a).sqrt()
}

struct Draw(Pcg64Mcg);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> V {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            let n = norm(v);
            if (0.1..1.0).contains(&n) {
                return v.map(|x| x / n);
            }
        }
    }

    fn shape(&mut self) -> StrandShape<f64> {
        let normal = self.direction();
        let mut lay = self.direction();
        let rise = dot(lay, normal);
        // A lay that leans out of the skin by 0 to 0.3.
        let lean = self.between(0.0, 0.3);
        for k in 0..3 {
            lay[k] -= rise * normal[k];
        }
        let n = norm(lay).max(1e-9);
        for k in 0..3 {
            lay[k] = lay[k] / n * (1.0 - lean * lean).sqrt() + lean * normal[k];
        }
        StrandShape {
            root: [0; 3].map(|_| self.between(-1.0, 1.0)),
            normal,
            lay,
            bend: self.between(0.0, 1.0),
            length: self.between(0.2, 2.0),
            gravity: self.direction(),
            sag: self.between(0.0, 1.5),
        }
    }
}

/// Two triangles of a square of side 2, and a far smaller third.
fn mesh() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let positions = vec![
        Vec3::ZERO,
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(2.0, 2.0, 0.0),
        Vec3::new(0.0, 2.0, 0.0),
        Vec3::new(-0.1, 0.0, 0.0),
        Vec3::new(0.0, -0.1, 0.0),
    ];
    (positions, vec![[0, 1, 2], [0, 2, 3], [0, 4, 5]])
}

fn place(root: &StrandRoot, positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec3 {
    root.mix(triangles[root.triangle as usize].map(|i| positions[i as usize]))
}

#[test]
fn roots_fill_the_surface_evenly() {
    let (positions, triangles) = mesh();
    let roots = strand_roots(&positions, &triangles, 5000.0, 3, |_| 1.0);
    let wanted = 5000.0 * 4.005;
    assert!((roots.len() as f64 - wanted).abs() < 3.0, "{}", roots.len());
    // Cells of a grid over the square: chi squared of 63 degrees of freedom.
    let mut counts = [0.0; 64];
    for root in roots.iter().filter(|r| r.triangle < 2) {
        let sum: f32 = root.barycentric.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6 && root.barycentric.iter().all(|b| *b >= 0.0));
        let p = place(root, &positions, &triangles) * 4.0;
        counts[(p.x as usize).min(7) + 8 * (p.y as usize).min(7)] += 1.0;
    }
    let mean = counts.iter().sum::<f64>() / 64.0;
    let chi: f64 = counts.iter().map(|n| (n - mean) * (n - mean) / mean).sum();
    assert!(chi < 110.0, "chi squared {chi}");
}

#[test]
fn every_prefix_is_a_fair_thinning() {
    let (positions, triangles) = mesh();
    let roots = strand_roots(&positions, &triangles, 5000.0, 3, |_| 1.0);
    let prefix = &roots[..2000];
    let left = prefix
        .iter()
        .filter(|r| place(r, &positions, &triangles).x < 1.0)
        .count();
    assert!(
        (left as f64 - 1000.0).abs() < 100.0,
        "{left} of 2000 on the left half"
    );
    let first = prefix.iter().filter(|r| r.triangle == 0).count();
    assert!(
        (first as f64 - 1000.0).abs() < 100.0,
        "{first} of 2000 on one triangle"
    );
}

#[test]
fn a_changed_density_moves_no_strand() {
    let (positions, triangles) = mesh();
    let grow = |density: &dyn Fn(Vec3) -> f32| {
        strand_roots(&positions, &triangles, 5000.0, 3, |r| {
            density(place(r, &positions, &triangles))
        })
    };
    let all = grow(&|_| 1.0);
    let half = grow(&|_| 0.5);
    let quarter = grow(&|p| if p.x < 1.0 { 0.25 } else { 0.5 });
    let ratio = half.len() as f64 / all.len() as f64;
    assert!((ratio - 0.5).abs() < 0.02, "{ratio}");
    // Each is a subsequence of the next.
    for (few, many) in [(&quarter, &half), (&half, &all)] {
        let mut rest = many.iter();
        assert!(few.iter().all(|root| rest.any(|other| other == root)));
    }
}

#[test]
fn bad_meshes_grow_nothing() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::splat(f32::NAN), Vec3::Y];
    let triangles = [[0, 1, 9], [0, 1, 2], [0, 0, 1], [0, 1, 3]];
    let roots = strand_roots(&positions, &triangles, 100.0, 1, |_| 1.0);
    assert!(roots.iter().all(|r| r.triangle == 3));
    assert!((49..=51).contains(&roots.len()), "{}", roots.len());
    for densest in [f32::NAN, -3.0, 0.0] {
        assert!(strand_roots(&positions, &triangles, densest, 1, |_| 1.0).len() <= 1);
    }
    let thinned = strand_roots(&positions, &triangles, f32::INFINITY, 1, |r| {
        f32::from(r.seed < 1 << 20)
    });
    assert!(thinned.len() < MOST_STRANDS);
}

#[test]
fn strands_keep_their_length_and_never_enter_the_skin() {
    let mut draw = Draw::new(5);
    for _ in 0..400 {
        let shape = draw.shape();
        let curve = strand_curve(&shape);
        // Length by a fine polyline.
        let n = 2000;
        let mut length = 0.0;
        let mut last = curve[0];
        for i in 1..=n {
            let p = strand_point(&curve, f64::from(i) / f64::from(n));
            length += norm([p[0] - last[0], p[1] - last[1], p[2] - last[2]]);
            last = p;
            let height = dot([0, 1, 2].map(|k| p[k] - shape.root[k]), shape.normal);
            assert!(height > 0.0, "{shape:?}");
        }
        let error = (length / shape.length - 1.0).abs();
        assert!(error < 1e-3, "length off by {error}: {shape:?}");
        let start = strand_tangent(&curve, 0.0, [0.0; 3]);
        assert!(dot(start, shape.normal) > 0.999_999);
    }
}

#[test]
fn gravity_pulls_the_tip_down() {
    let mut draw = Draw::new(6);
    for _ in 0..200 {
        let mut shape = draw.shape();
        shape.sag = 0.0;
        let low = |shape: &StrandShape<f64>| {
            dot(
                strand_curve(shape)[3].map(|x| x / shape.length),
                shape.gravity,
            )
        };
        let free = low(&shape);
        shape.sag = 0.7;
        assert!(low(&shape) >= free - 0.02, "{shape:?}");
    }
}

/// Chord error over the length for a strand bent by 0.5 (docs/book/undercoat.md#reference-values), and the rule for segments.
#[test]
fn segments_keep_the_tolerance() {
    let mut draw = Draw::new(8);
    for _ in 0..100 {
        let mut shape = draw.shape();
        (shape.bend, shape.sag) = (0.5, 0.0);
        let curve = strand_curve(&shape);
        let chord = |n: usize| -> f64 {
            let mut worst = 0f64;
            for i in 0..n {
                let at = |s: f64| strand_point(&curve, (i as f64 + s) / n as f64);
                let (a, b) = (at(0.0), at(1.0));
                for k in 1..16 {
                    let p = at(f64::from(k) / 16.0);
                    let ab = [0, 1, 2].map(|k| b[k] - a[k]);
                    let ap = [0, 1, 2].map(|k| p[k] - a[k]);
                    let t = dot(ap, ab) / dot(ab, ab);
                    let off = [0, 1, 2].map(|k| ap[k] - t * ab[k]);
                    worst = worst.max(norm(off));
                }
            }
            worst / shape.length
        };
        for (n, expected) in [(3, 0.023), (4, 0.013), (6, 0.006), (8, 0.0034)] {
            let error = chord(n);
            assert!(
                error <= expected,
                "{n} segments: {error}, expected {expected}"
            );
        }
        for pixels in [20.0, 60.0, 200.0, 600.0] {
            let n = strand_segments(shape.bend, pixels, 0.5);
            let error = chord(n as usize) * pixels;
            assert!(
                n >= 12.0 || error <= 0.5,
                "{n} segments, {pixels} px: {error} px"
            );
        }
    }
}

#[test]
fn ribbons_face_the_eye_and_keep_their_coverage() {
    let mut draw = Draw::new(9);
    for _ in 0..2000 {
        let (tangent, view, right) = (draw.direction(), draw.direction(), draw.direction());
        let side = strand_side(tangent, view, right);
        assert!((norm(side) - 1.0).abs() < 1e-9);
        let cross = 1.0 - dot(tangent, view).powi(2);
        if cross.sqrt() > 0.05 {
            assert!(dot(side, tangent).abs() < 1e-9 && dot(side, view).abs() < 1e-9);
        }
        let (radius, pixel) = (draw.between(0.0, 3.0), draw.between(0.01, 2.0));
        let ribbon = strand_ribbon(radius, pixel);
        assert!(ribbon.half_width >= 0.5 * pixel && ribbon.coverage <= 1.0);
        assert!((ribbon.half_width * ribbon.coverage - radius).abs() < 1e-12);
    }
    // End-on, a small turn of the view turns the side a little only; the two ways across a ribbon are alike.
    let (tangent, right) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let mut last = right;
    for i in 0..1000 {
        let x = f64::from(i) * 1e-4;
        let side = strand_side(tangent, [0.0, x, (1.0 - x * x).sqrt()], right);
        assert!(dot(side, last).abs() > 0.999, "jump at {x}");
        last = side;
    }
}

const ENTRY: &str = "
#import bevy_plumage::down_strands as strands

fn load(at: u32) -> vec3<f32> {
    return vec3(input[at], input[at + 1u], input[at + 2u]);
}

fn store(at: u32, v: vec3<f32>) {
    output[at] = v.x;
    output[at + 1u] = v.y;
    output[at + 2u] = v.z;
}

fn evaluate(i: u32) {
    let at = i * 26u;
    let shape = strands::StrandShape(load(at), load(at + 3u), load(at + 6u), input[at + 9u], input[at + 10u], load(at + 11u), input[at + 14u]);
    let s = input[at + 15u];
    let curve = strands::strand_curve(shape);
    let out = i * 17u;
    store(out, strands::strand_point(curve, s));
    store(out + 3u, strands::strand_tangent(curve, s, shape.normal));
    store(out + 6u, strands::strand_side(load(at + 16u), load(at + 19u), load(at + 22u)));
    let ribbon = strands::strand_ribbon(strands::strand_radius(input[at + 25u], s), 0.3);
    output[out + 9u] = ribbon.half_width;
    output[out + 10u] = ribbon.coverage;
    output[out + 11u] = strands::strand_alpha(3.0, s);
    output[out + 12u] = strands::strand_shadow(input[at + 25u], shape.normal.z);
    output[out + 13u] = strands::strand_segments(shape.bend, 100.0 * input[at + 25u], 0.5);
    store(out + 14u, curve.points[3]);
}
";

#[test]
fn shader_agrees() {
    let mut draw = Draw::new(11);
    let count = 4096;
    let mut input = Vec::new();
    let mut wanted: Vec<f64> = Vec::new();
    for _ in 0..count {
        let mut shape = draw.shape();
        // The judge gets exactly what the shader gets.
        let round = |v: V| v.map(|x| f64::from(x as f32));
        shape = StrandShape {
            root: round(shape.root),
            normal: round(shape.normal),
            lay: round(shape.lay),
            bend: f64::from(shape.bend as f32),
            length: f64::from(shape.length as f32),
            gravity: round(shape.gravity),
            sag: f64::from(shape.sag as f32),
        };
        let s = f64::from(draw.between(0.0, 1.0) as f32);
        let [tangent, view, right] = [0; 3].map(|_| round(draw.direction()));
        let x = f64::from(draw.between(0.0, 1.0) as f32);
        let flat = |v: V| v.map(|x| x as f32);
        input.extend(flat(shape.root));
        input.extend(flat(shape.normal));
        input.extend(flat(shape.lay));
        input.extend([shape.bend as f32, shape.length as f32]);
        input.extend(flat(shape.gravity));
        input.extend([shape.sag as f32, s as f32]);
        input.extend([tangent, view, right].into_iter().flat_map(flat));
        input.push(x as f32);
        let curve = strand_curve(&shape);
        wanted.extend(strand_point(&curve, s));
        wanted.extend(strand_tangent(&curve, s, shape.normal));
        wanted.extend(strand_side(tangent, view, right));
        let ribbon = strand_ribbon(strand_radius(x, s), f64::from(0.3f32));
        wanted.extend([ribbon.half_width, ribbon.coverage]);
        wanted.push(strand_alpha(3.0, s));
        wanted.push(strand_shadow(x, shape.normal[2]));
        wanted.push(strand_segments(shape.bend, 100.0 * x, 0.5));
        wanted.extend(curve[3]);
    }
    let Some(got) = run(&["down_strands.wgsl"], ENTRY, &input, count, wanted.len()) else {
        return;
    };
    let mut worst = [0f64; 17];
    let mut steps = 0;
    for (i, (g, w)) in got.iter().zip(&wanted).enumerate() {
        let error = (f64::from(*g) - w).abs();
        // A ceiling may fall to either side of a whole number.
        if i % 17 == 13 {
            steps += usize::from(error > 0.0);
            continue;
        }
        worst[i % 17] = worst[i % 17].max(error);
    }
    println!("largest differences: {worst:?}");
    assert!(worst.iter().all(|e| *e < 2e-5), "{worst:?}");
    assert!(steps <= 2, "{steps} segment counts differ");
}
