//! The walk through the shell against brute force (test D2 of docs/down.md), the shell's structure, and the shader twin.

use bevy_plumage::maths::undercoat::shell::{NO_LINK, Shell, ShellError};
use bevy_plumage::maths::undercoat::walk::{Walk, WalkEnd, walk_start};
use bevy_plumage::maths::undercoat::{shell, walk};
use plumage_reference::undercoat::published;
use plumage_tests::gpu;
use plumage_tests::shells::{Aim, Brute, Skin, fan, ray, skins, torus};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Length of the path inside the shell that the walk missed, that it made up, the whole, walks, ends without an exit, cells at most.
fn judge(shell: &Shell, brute: &Brute, aim: Aim, seed: u64) -> [f64; 6] {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let (origin, direction) = ray(shell, aim, &mut rng);
    // The precision of the places in f32.
    let gap = 1e-5;
    let truth = brute.intervals(origin, direction, gap);
    let mut found: Vec<(f64, f64)> = Vec::new();
    let (mut walks, mut bad, mut cells) = (0.0, 0.0, 0.0f64);
    for (t, start) in brute.entries(origin, direction) {
        // The ray starts at the fragment, as the renderer's does.
        let near = t - 0.25;
        let o = [0, 1, 2].map(|k| (origin[k] + near * direction[k]) as f32);
        let d = direction.map(|x| x as f32);
        let begin: Walk<f32> = walk_start(shell, start, o, d);
        let mut span = (f64::from(begin.t) + near, f64::from(begin.t) + near);
        let mut count = 0.0;
        let end = walk::walk(shell, begin, o, d, |s| {
            span.1 = f64::from(s.t[1]) + near;
            count += 1.0;
            for place in s.place {
                let sum = place[0] + place[1] + place[2];
                assert!(
                    (sum - 1.0).abs() < 1e-5 && place.iter().all(|x| (0.0..=1.0).contains(x)),
                    "{place:?}"
                );
            }
            true
        });
        walks += 1.0;
        bad += f64::from(u8::from(!matches!(end, WalkEnd::Skin | WalkEnd::Air)));
        cells = cells.max(count);
        found.push(span);
    }
    let length = |list: &[(f64, f64)]| list.iter().map(|s| s.1 - s.0).sum::<f64>();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut common = 0.0;
    let mut union: Vec<(f64, f64)> = Vec::new();
    for span in found {
        match union.last_mut() {
            Some(last) if span.0 <= last.1 => last.1 = last.1.max(span.1),
            _ => union.push(span),
        }
    }
    for a in &truth {
        for b in &union {
            common += (a.1.min(b.1) - a.0.max(b.0)).max(0.0);
        }
    }
    let whole = length(&truth);
    [
        whole - common,
        length(&union) - common,
        whole,
        walks,
        bad,
        cells,
    ]
}

#[test]
fn walk_against_brute_force() {
    for skin in skins() {
        let shell = skin.shell();
        let brute = Brute::new(&shell);
        for aim in [Aim::Random, Aim::Tangent, Aim::Vertices] {
            let cells = std::sync::atomic::AtomicU32::new(0);
            let [lost, over, whole, walks, bad] = plumage_tests::shells::sum(10_000, |i| {
                let r = judge(&shell, &brute, aim, i + 1);
                cells.fetch_max(r[5] as u32, std::sync::atomic::Ordering::Relaxed);
                [r[0], r[1], r[2], r[3], r[4]]
            });
            let cells = cells.into_inner();
            println!(
                "{} {aim:?}: lost {:.1e}, over {:.1e}, exits {:.5}, {walks} walks, at most {cells} cells",
                skin.name,
                lost / whole,
                over / whole,
                1.0 - bad / walks,
            );
            assert!(
                lost / whole < 1e-5,
                "{} {aim:?}: lost {:e}",
                skin.name,
                lost / whole
            );
            assert!(
                over / whole < 1e-5,
                "{} {aim:?}: over {:e}",
                skin.name,
                over / whole
            );
            assert!(bad == 0.0, "{} {aim:?}: {bad} of {walks}", skin.name);
            assert!(cells <= 256);
        }
    }
}

#[test]
fn structure_of_the_shell() {
    let closed = torus("torus", 60, 28, 0.0, false, 0.1).shell();
    assert_eq!(closed.report.boundary_edges, 0);
    assert_eq!(closed.report.non_manifold_edges, 0);
    assert_eq!(closed.faces.len(), closed.prisms.len());
    assert_eq!(closed.report.folded, 0);

    let open = torus("open", 60, 28, 0.0, true, 0.1).shell();
    assert_eq!(open.report.boundary_edges, 2 * 28);
    assert_eq!(open.faces.len() - open.tops, 4 * 28);

    // Eight edges of three sheets on one axis; two triangles without area.
    let fan = fan().shell();
    assert_eq!(fan.report.non_manifold_edges, 8);
    assert_eq!(fan.report.degenerate, 2);
    assert_eq!(fan.report.boundary_edges, 3 * 3 * 8);

    // Links go both ways.
    for shell in [&closed, &open, &fan] {
        for (i, prism) in shell.prisms.iter().enumerate() {
            for (wall, link) in prism.links.iter().enumerate() {
                if *link != NO_LINK {
                    let back = shell.prisms[*link as usize / 4].links[*link as usize % 4];
                    assert_eq!(back, i as u32 * 4 + wall as u32);
                }
            }
        }
    }
}

#[test]
fn a_seam_does_not_split_the_shell() {
    // The same torus with every triangle on its own vertices.
    let smooth = torus("torus", 24, 12, 0.0, false, 0.05);
    let split = Skin {
        positions: smooth
            .indices
            .iter()
            .map(|i| smooth.positions[*i as usize])
            .collect(),
        indices: (0..smooth.indices.len() as u32).collect(),
        ..torus("split", 24, 12, 0.0, false, 0.05)
    }
    .shell();
    assert_eq!(split.vertices.len(), 24 * 12);
    assert_eq!(split.report.boundary_edges, 0);
    assert_eq!(split.report.welded, smooth.indices.len() - 24 * 12);
}

#[test]
fn heights_stay_safe() {
    // Twice the small radius: the inside of the ring and the bumps would fold.
    let shell = torus("bumpy", 80, 48, 0.15, false, 0.5).shell();
    assert!(shell.report.lowered > 0);
    assert_eq!(shell.report.folded, 0);
    for prism in 0..shell.prisms.len() {
        let corners = shell.corners::<f64>(prism);
        let (bottom, top) = (
            [corners[0], corners[1], corners[2]],
            [corners[3], corners[4], corners[5]],
        );
        assert!(shell::area_ratio(bottom, top) >= shell::LOWEST_RATIO - 1e-3);
    }
    // Where there is room the height is what was asked for.
    let sphere = torus("thin", 80, 48, 0.0, false, 0.02).shell();
    assert_eq!(sphere.report.lowered, 0);
}

#[test]
fn bad_meshes_are_told() {
    let p = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let h = [0.1; 3];
    assert_eq!(Shell::build(&p, &[0, 1], &h), Err(ShellError::Indices(2)));
    assert_eq!(
        Shell::build(&p, &[0, 1, 3], &h),
        Err(ShellError::Index {
            triangle: 0,
            index: 3,
            vertices: 3
        })
    );
    assert_eq!(
        Shell::build(&p, &[0, 1, 2], &h[..2]),
        Err(ShellError::Heights {
            heights: 2,
            vertices: 3
        })
    );
    assert_eq!(
        Shell::build(&p, &[0, 1, 2], &[0.1, f32::NAN, 0.1]),
        Err(ShellError::Vertex(1))
    );
    assert!(Shell::build(&[], &[], &[]).unwrap().prisms.is_empty());
}

/// Bindings-free walk over prisms that lie in the input: per ray 8 floats, per vertex 6 (bottom, top), per prism 8 words.
const WALK: &str = "
#import bevy_plumage::down_walk::{Walk, PrismCorners, walk_start, tet_exit, face_place, face_tet, tet_across, linked_face, prism_parity, MAX_CELLS, NO_FACE, NO_LINK, FACE_SKIN, FACE_TOP}
fn point(at: u32) -> vec3<f32> { return vec3(input[at], input[at + 1u], input[at + 2u]); }
fn word(prism: u32, k: u32) -> u32 { return bitcast<u32>(input[PRISMS + prism * 8u + k]); }
fn corners_of(prism: u32) -> PrismCorners {
    let a = VERTICES + 6u * word(prism, 0u);
    let b = VERTICES + 6u * word(prism, 1u);
    let c = VERTICES + 6u * word(prism, 2u);
    return PrismCorners(point(a), point(b), point(c), point(a + 3u), point(b + 3u), point(c + 3u));
}
fn evaluate(i: u32) {
    let o = point(8u * i);
    let d = point(8u * i + 3u);
    let start = bitcast<u32>(input[8u * i + 6u]);
    var prism = start / 16u;
    var corners = corners_of(prism);
    var walk = walk_start(corners, start & 15u, o, d);
    var length = 0.0;
    var lambda = 0.0;
    var end = 3.0;
    var cells = 0u;
    for (var n = 0u; n < MAX_CELLS; n++) {
        cells = n + 1u;
        let exit = tet_exit(corners, prism_parity(word(prism, 3u)), walk.tet, walk.face, o, d);
        if exit.face == NO_FACE { end = 4.0; break; }
        let t = max(exit.t, walk.t);
        let place = face_place(corners, exit.face, o + t * d);
        length += t - walk.t;
        lambda += (t - walk.t) * (walk.place.w + place.w + 2.0 * walk.place.x + 2.0 * place.x);
        if exit.face == FACE_SKIN { end = 1.0; break; }
        if exit.face == FACE_TOP { end = 2.0; break; }
        if exit.face < FACE_TOP {
            walk = Walk(tet_across(exit.face, walk.tet), exit.face, t, place);
            continue;
        }
        let link = word(prism, 4u + (exit.face - 4u) % 3u);
        if link == NO_LINK { end = 2.0; break; }
        prism = link / 4u;
        corners = corners_of(prism);
        let face = linked_face(exit.face, link);
        walk = Walk(face_tet(face), face, t, face_place(corners, face, o + t * d));
    }
    output[4u * i] = end;
    output[4u * i + 1u] = length;
    output[4u * i + 2u] = lambda;
    output[4u * i + 3u] = f32(cells);
}";

#[test]
fn shader_twin() {
    let shell = torus("bumpy", 40, 24, 0.15, true, 0.08).shell();
    let brute = Brute::new(&shell);
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut input = Vec::new();
    let mut expected = Vec::new();
    for k in 0..1500 {
        let aim = [Aim::Random, Aim::Tangent, Aim::Vertices][k % 3];
        let (origin, direction) = ray(&shell, aim, &mut rng);
        for (t, start) in brute.entries(origin, direction) {
            let o = [0, 1, 2].map(|k| (origin[k] + (t - 0.1) * direction[k]) as f32);
            let d = direction.map(|x| x as f32);
            input.extend(o.into_iter().chain(d));
            input.extend([f32::from_bits(start), 0.0]);
            let (mut length, mut lambda, mut cells) = (0.0, 0.0, 0.0);
            let end = walk::walk(&shell, walk_start(&shell, start, o, d), o, d, |s| {
                let dt = s.t[1] - s.t[0];
                let [p, q] = s.place;
                length += dt;
                lambda += dt * (p[3] + q[3] + 2.0 * p[0] + 2.0 * q[0]);
                cells += 1.0;
                true
            });
            let end = match end {
                WalkEnd::Skin => 1.0,
                WalkEnd::Air => 2.0,
                WalkEnd::Lost => 4.0,
                _ => 3.0,
            };
            expected.push([end, length, lambda, cells]);
        }
    }
    let vertices = input.len();
    input.extend(
        shell
            .vertices
            .iter()
            .flat_map(|v| v.position.into_iter().chain(v.top())),
    );
    let prisms = input.len();
    input.extend(
        shell
            .prisms
            .iter()
            .flat_map(|p| p.words().map(f32::from_bits)),
    );
    let text =
        format!("{WALK}\nconst VERTICES: u32 = {vertices}u;\nconst PRISMS: u32 = {prisms}u;");
    let count = expected.len();
    let Some(result) = gpu::run(&["down_walk.wgsl"], &text, &input, count, 4 * count) else {
        return;
    };
    let (result, _) = result.as_chunks::<4>();
    // Another rounding may send a ray through a vertex's other neighbor: the path is what must agree.
    let mut ends = 0;
    for (got, want) in result.iter().zip(&expected) {
        ends += usize::from(got[0] != want[0]);
        assert!((got[1] - want[1]).abs() < 2e-5, "{got:?} {want:?}");
        assert!((got[2] - want[2]).abs() < 1e-3, "{got:?} {want:?}");
    }
    println!("{count} walks, {ends} other ends");
    assert!(ends * 500 < count, "{ends} of {count} end otherwise");
}

#[test]
fn published_steps_lose_path() {
    // The published walk finds the same way through the shell, but for the last part of a step.
    let shell = torus("torus", 40, 20, 0.0, false, 0.1).shell();
    let brute = Brute::new(&shell);
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let (mut off, mut whole) = ([0.0f64; 2], 0.0);
    for _ in 0..400 {
        let (origin, direction) = ray(&shell, Aim::Random, &mut rng);
        let Some((t, start)) = brute.entries(origin, direction).first().copied() else {
            continue;
        };
        if start % 16 != 3 {
            continue;
        }
        let at = [0, 1, 2].map(|k| origin[k] + t * direction[k]);
        let mut length = 0.0;
        let begin: Walk<f64> = walk_start(&shell, start, at, direction);
        walk::walk(&shell, begin, at, direction, |s| {
            length += s.t[1] - s.t[0];
            true
        });
        whole += length;
        for (off, step) in off.iter_mut().zip([0.008, 0.03]) {
            let steps =
                published::step_walk(&shell, start / 16, at, direction, step, |_, place| {
                    assert!(place.iter().all(|x| *x > -1e-3 && *x < 1.001), "{place:?}");
                });
            *off += (f64::from(steps) * step - length).abs();
        }
    }
    println!(
        "off by {:.4} at 0.05 edges, {:.4} at 0.2",
        off[0] / whole,
        off[1] / whole
    );
    assert!(off[0] / whole < 0.05 && off[1] / whole < 0.15);
    assert!(off[0] < off[1], "shorter steps end more exactly");
}
