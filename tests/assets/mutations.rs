//! What strangers bring: damaged files, and meshes that nobody has groomed.

use bevy::{
    asset::RenderAssetUsages,
    math::{Vec3, primitives::Sphere},
    mesh::{Indices, Mesh, Meshable, PrimitiveTopology, VertexAttributeValues},
};
use bevy_plumage::anatomy::Feather;
use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::groom::*;
use plumage_tests::skins::*;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::time::Instant;

/// Mutations of each kind of file.
const EACH: usize = 5_000;

/// Numbers that a file should not be able to do harm with.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1e30",
    "-1e30",
    "1e39",
    "NaN",
    "inf",
    "-inf",
    "1e-40",
    "4294967295",
    "65536",
    "99999999999999999999999",
    "0.5",
    "-0.0",
];

/// Damages a text: the same number, the same damage.
fn mutate(text: &str, number: u64) -> Vec<u8> {
    let mut random = Pcg64Mcg::seed_from_u64(number);
    let mut below = |n: usize| random.next_u32() as usize % n.max(1);
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + below(3) {
        let length = bytes.len();
        if length < 2 {
            break;
        }
        let at = below(length);
        match below(8) {
            // Another number (twice as likely as the rest, and the one that reaches the checks of ranges).
            0 | 1 => {
                let digit = |b: &u8| b.is_ascii_digit();
                let Some(from) = bytes[at..].iter().position(digit).map(|i| i + at) else {
                    continue;
                };
                let part = |b: &u8| b.is_ascii_digit() || b".e-".contains(b);
                let to = bytes[from..].iter().position(|b| !part(b));
                let to = to.map_or(length, |i| i + from);
                let number = NUMBERS[below(NUMBERS.len())];
                bytes.splice(from..to, number.bytes());
            }
            2 => bytes[at] ^= 1 << below(8),
            3 => {
                let to = (at + 1 + below(40)).min(length);
                bytes.drain(at..to);
            }
            4 => {
                let to = (at + 1 + below(200)).min(length);
                let copy = bytes[at..to].to_vec();
                bytes.splice(at..at, copy);
            }
            5 => bytes.truncate(at),
            6 => {
                let open = [&b"("[..], b"[", b"{", b"Not(", b"Any([", b"\"", b"/*"][below(7)];
                let deep = open.repeat(1 + below(3_000));
                bytes.splice(at..at, deep);
            }
            _ => {
                let other = below(length);
                bytes.swap(at, other);
            }
        }
    }
    bytes
}

fn folder(name: &str) -> Vec<(String, String)> {
    let mut files: Vec<_> = std::fs::read_dir(plumage_tests::asset(name))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path.display().to_string(), text)
        })
        .collect();
    files.sort();
    files
}

#[test]
fn five_thousand_damaged_feathers_are_errors_or_feathers() {
    let files = folder("feathers");
    let begun = Instant::now();
    let sound = (0..EACH)
        .into_par_iter()
        .filter(|number| {
            let (file, text) = &files[number % files.len()];
            let bytes = mutate(text, *number as u64);
            match Feather::from_ron(&bytes, file) {
                Ok(feather) => {
                    // What passes can be used.
                    let shape = feather.shape_table();
                    let finite = |rows: &[[f32; 4]]| rows.iter().flatten().all(|x| x.is_finite());
                    assert!(finite(&shape.contour) && finite(&shape.rachis), "{number}");
                    true
                }
                Err(error) => {
                    let typed: AssetError = error;
                    assert!(
                        typed.to_string().contains(".feather.ron"),
                        "{number}: {typed}"
                    );
                    false
                }
            }
        })
        .count();
    println!(
        "{sound} of {EACH} still are feathers, {:?}",
        begun.elapsed()
    );
    // A mutation that never gets past the parser tests little.
    assert!(sound > EACH / 50 && sound < EACH / 2, "{sound}");
    assert!(begun.elapsed() < plumage_tests::wait::PATIENCE);
}

/// A real groom cut down, so that one file parses in a fraction of a millisecond.
fn short(text: &str, file: &str) -> String {
    let mut groom = Groom::from_ron(text.as_bytes(), file).unwrap();
    groom.regions.truncate(3);
    groom.guides.truncate(3);
    let kept: Vec<String> = groom.regions.iter().map(|r| r.name.clone()).collect();
    for guide in &mut groom.guides {
        guide.regions.retain(|name| kept.contains(name));
    }
    groom.rows.truncate(1);
    groom.to_ron().unwrap()
}

#[test]
fn five_thousand_damaged_grooms_are_errors_or_grooms() {
    let real = folder("grooms");
    let mut files: Vec<_> = real
        .iter()
        .map(|(file, text)| (file.clone(), short(text, file)))
        .collect();
    files.push(("made-up.groom.ron".into(), groom().to_ron().unwrap()));
    let bird = bird(true);
    let begun = Instant::now();
    let sound = (0..EACH)
        .into_par_iter()
        .filter(|number| {
            // Every hundredth is a whole file.
            let list = if number % 100 == 0 { &real } else { &files };
            let (file, text) = &list[number % list.len()];
            let bytes = mutate(text, 1_000_000 + *number as u64);
            let groom = match Groom::from_ron(&bytes, file) {
                Ok(groom) => groom,
                Err(error) => {
                    let typed: AssetError = error;
                    assert!(
                        typed.to_string().contains(".groom.ron"),
                        "{number}: {typed}"
                    );
                    return false;
                }
            };
            let count: u32 = groom.regions.iter().map(|region| region.count).sum();
            if number % 11 == 0 && count < 1_000 {
                let coat = groom_bird(&bird, &groom, 1, 1.0);
                let finite = |coat: &Coat| {
                    positions(&coat.mesh)
                        .iter()
                        .all(|p| p.iter().all(|x| x.is_finite()))
                };
                assert!(
                    coat.is_err() || coat.is_ok_and(|coat| finite(&coat)),
                    "{number}"
                );
            }
            true
        })
        .count();
    println!("{sound} of {EACH} still are grooms, {:?}", begun.elapsed());
    assert!(sound > EACH / 50 && sound < EACH / 2, "{sound}");
    assert!(begun.elapsed() < plumage_tests::wait::PATIENCE);
}

#[test]
fn a_groom_that_does_not_fit_into_memory_is_an_error() {
    let mut large = groom();
    large.regions[0].count = 200_000;
    large.regions[0].segments = Segments::new(64, 16);
    let error = large.validate("large.groom.ron").unwrap_err().to_string();
    assert!(error.contains("vertices"), "{error}");
    // Within the limits at its own density, not at sixteen times that.
    large.regions[0].segments = Segments::new(3, 1);
    large.validate("large.groom.ron").unwrap();
    let error = groom_bird(&bird(true), &large, 1, 16.0).unwrap_err();
    assert!(error.to_string().contains("density 16"), "{error}");
    // Densities past the end are clamped.
    let mut small = groom();
    small
        .regions
        .iter_mut()
        .for_each(|region| region.count = 20);
    let coat = groom_bird(&bird(true), &small, 1, 1.0e30).unwrap();
    assert_eq!(coat.cards.len(), (40 + 16) * 16);
}

fn positions(mesh: &Mesh) -> &[[f32; 3]] {
    match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(list)) => list,
        _ => &[],
    }
}

/// Grooms a mesh by what it offers.
fn fallback(mesh: &Mesh, joints: &[&str]) -> Result<(Groom, Coat), GroomError> {
    let skin = SkinMesh::from_meshes(&[mesh], &[])?;
    let joints: Vec<String> = joints.iter().map(|name| (*name).into()).collect();
    let groom = Groom::fallback(&skin, &joints);
    groom.validate("fallback")?;
    let bird = Bird {
        skin,
        joints,
        ..Bird::default()
    };
    // A quarter of the feathers, twice as long: faster.
    let coat = groom_bird(&bird, &groom, 1, 0.25)?;
    Ok((groom, coat))
}

/// The feathers of a fallback groom are sound, many, and as long as the mesh is large.
fn judge(what: &str, mesh: &Mesh, coat: &Coat) {
    let (low, high) = positions(mesh)
        .iter()
        .filter(|p| p.iter().all(|x| x.is_finite()))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
            (a.min(Vec3::from_array(*p)), b.max(Vec3::from_array(*p)))
        });
    let size = (high - low).length();
    assert!(coat.cards.len() > 300, "{what}: {} cards", coat.cards.len());
    assert!(coat.warnings.is_empty(), "{what}: {:?}", coat.warnings);
    for card in &coat.cards {
        let length = card.length / size;
        assert!((0.016..0.11).contains(&length), "{what}: length {length}");
    }
    for p in positions(&coat.mesh) {
        let p = Vec3::from_array(*p);
        let reach = 0.12 * size;
        assert!(
            p.cmpge(low - reach).all() && p.cmple(high + reach).all(),
            "{what}: a vertex at {p} outside {low}..{high}"
        );
    }
}

#[test]
fn any_mesh_gets_feathers() {
    let bare = |mesh: &mut Mesh| {
        mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
        mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    };
    let changes: Vec<(&str, Box<dyn Fn(&mut Mesh)>)> = vec![
        ("unskinned", Box::new(bare)),
        (
            "without normals",
            Box::new(|m| {
                m.remove_attribute(Mesh::ATTRIBUTE_NORMAL);
            }),
        ),
        ("without indices", Box::new(|m| m.duplicate_vertices())),
        (
            "a thousandth",
            Box::new(|m| m.scale_by(Vec3::splat(1.0e-3))),
        ),
        (
            "a thousand times",
            Box::new(|m| m.scale_by(Vec3::splat(1.0e3))),
        ),
        (
            "with damaged triangles",
            Box::new(|m| {
                let Some(Indices::U32(list)) = m.indices_mut() else {
                    panic!()
                };
                // Without area, twice the same, turned round, and three on one edge.
                let first = list[600..606].to_vec();
                list.extend([7, 7, 9, 1_000_000, 2, 3]);
                list.extend(&first);
                list.extend(first.iter().rev());
                list.extend([first[0], first[1], 40, first[0], first[1], 1200]);
            }),
        ),
        (
            "with points that are no numbers",
            Box::new(|m| {
                let Some(VertexAttributeValues::Float32x3(list)) =
                    m.attribute_mut(Mesh::ATTRIBUTE_POSITION)
                else {
                    panic!()
                };
                list[900] = [f32::NAN; 3];
                list[901] = [f32::INFINITY, 0.0, 0.0];
            }),
        ),
    ];
    for (what, change) in changes {
        let mut mesh = body(false);
        change(&mut mesh);
        let (_, coat) = fallback(&mesh, &JOINTS).unwrap_or_else(|error| panic!("{what}: {error}"));
        judge(what, &mesh, &coat);
    }
}

#[test]
fn regions_come_from_what_the_mesh_offers() {
    let names = |groom: &Groom| {
        let mut names: Vec<_> = groom.regions.iter().map(|r| r.name.clone()).collect();
        names.sort();
        names
    };
    let (groom, _) = fallback(&body(true), &JOINTS).unwrap();
    assert_eq!(names(&groom), ["tract 1", "tract 2"]);
    // A second set of texture coordinates that is for light maps is not taken for tracts.
    let mut mesh = body(true);
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute_mut(Mesh::ATTRIBUTE_UV_1)
    else {
        panic!()
    };
    uvs.iter_mut().for_each(|uv| uv[0] = uv[1] * 0.7);
    let (groom, coat) = fallback(&mesh, &JOINTS).unwrap();
    assert_eq!(names(&groom), ["root", "spine"]);
    judge("joints", &mesh, &coat);
    let colors: Vec<[f32; 4]> = positions(&mesh)
        .iter()
        .map(|p| match p[2] > 0.0 {
            true => [0.8, 0.1, 0.05, 1.0],
            false => [0.9, 0.9, 0.9, 1.0],
        })
        .collect();
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    let (groom, coat) = fallback(&mesh, &JOINTS).unwrap();
    assert_eq!(names(&groom)[..2], ["color 0", "color 1"]);
    judge("colors", &mesh, &coat);
    for card in coat.cards.iter().filter(|card| card.root.z.abs() > 0.02) {
        let red = card.tint[0] > 2.0 * card.tint[1];
        assert_eq!(red, card.root.z > 0.0, "{:?} at {}", card.tint, card.root);
    }
    // Colors that run into each other: every triangle has its region, and only one.
    let shades: Vec<[f32; 4]> = positions(&mesh)
        .iter()
        .map(|p| {
            let share = (p[2] * 4.0 + 0.5).clamp(0.0, 1.0);
            [share, 0.3, 1.0 - share, 1.0]
        })
        .collect();
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, shades);
    let (groom, _) = fallback(&mesh, &JOINTS).unwrap();
    assert!(groom.regions.len() > 3, "{}", groom.regions.len());
    let skin = SkinMesh::from_meshes(&[&mesh], &[]).unwrap();
    let mut taken = vec![0; skin.triangles.len()];
    for region in &groom.regions {
        let triangles = select::select_triangles(&region.select, &skin, &[], groom.unit);
        taken
            .iter_mut()
            .zip(triangles)
            .for_each(|(n, t)| *n += i32::from(t));
    }
    assert!(taken.iter().all(|n| *n == 1), "{taken:?}");
    // Joints without names of their own say nothing.
    let (groom, _) = fallback(&body(false), &["", "", "", ""]).unwrap();
    assert_eq!(names(&groom), ["all"]);
}

/// Share of the skin above which no vane lies, bind pose: a ray leaves every fifth triangle along its normal.
fn bare_share(skin: &SkinMesh, coat: &Coat) -> f32 {
    let places = positions(&coat.mesh);
    let Some(VertexAttributeValues::Float32x2(uvs)) = coat.mesh.attribute(Mesh::ATTRIBUTE_UV_0)
    else {
        panic!("no texture coordinates")
    };
    let indices: Vec<usize> = coat.mesh.indices().unwrap().iter().collect();
    let longest = coat
        .cards
        .iter()
        .map(|card| card.length)
        .fold(0.0, f32::max);
    let covers = |corners: &[usize], from: Vec3, along: Vec3| {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from_array(places[corners[i]]) - from);
        // Möller and Trumbore 1997.
        let (to_b, to_c) = (b - a, c - a);
        let across = along.cross(to_c);
        let volume = to_b.dot(across);
        let u = -a.dot(across) / volume;
        let q = -a.cross(to_b);
        let (v, distance) = (along.dot(q) / volume, to_c.dot(q) / volume);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        let at = |k: usize| {
            let [a, b, c] = [0, 1, 2].map(|i| uvs[corners[i]][k]);
            a + u * (b - a) + v * (c - a)
        };
        // The vane is closed above the first quarter, and rounder than the card.
        inside && (0.0..longest).contains(&distance) && at(1) > 0.25 && (at(0) - 0.5).abs() < 0.4
    };
    let (mut bare, mut all) = (0.0, 0.0);
    for triangle in (0..skin.triangles.len() as u32).step_by(5) {
        let bary = Vec3::splat(1.0 / 3.0);
        let from = skin.position(skin::SurfacePoint { triangle, bary });
        let along = skin.face_normals[triangle as usize];
        let near = |corners: &&[usize]| {
            Vec3::from_array(places[corners[0]]).distance(from) < 2.0 * longest
        };
        let mut above = indices.chunks(3).filter(near);
        all += skin.areas[triangle as usize];
        if !above.any(|corners| covers(corners, from, along)) {
            bare += skin.areas[triangle as usize];
        }
    }
    bare / all
}

/// A thin wing with a front edge, and a ball: no guide says how their feathers lie, and still little stays bare.
#[test]
fn feathers_without_guides_cover_edges() {
    let shares = [Vec3::new(1.0, 0.06, 0.3), Vec3::ONE].map(|shape| {
        let ball = Sphere::new(1.0).mesh().ico(20).unwrap();
        let mesh = ball.scaled_by(shape);
        let skin = SkinMesh::from_meshes(&[&mesh], &[]).unwrap();
        let groom = Groom::fallback(&skin, &[]);
        let joints = Vec::new();
        let bird = Bird {
            skin,
            joints,
            ..Bird::default()
        };
        let coat = groom_bird(&bird, &groom, 1, 1.0).unwrap();
        bare_share(&bird.skin, &coat)
    });
    println!("bare: {shares:?}");
    assert!(shares[0] < 0.01 && shares[1] < 0.001, "{shares:?}");
}

#[test]
fn what_cannot_carry_feathers_says_why() {
    let lines = Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 4]);
    let empty = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    );
    let mut flat = body(false);
    flat.scale_by(Vec3::new(0.0, 0.0, 1.0));
    for (mesh, reason) in [
        (lines, "list of triangles"),
        (empty, "no positions"),
        (flat, "no triangle with an area"),
    ] {
        match fallback(&mesh, &[]) {
            Err(GroomError::Skin { message, .. }) => assert!(message.contains(reason), "{message}"),
            Err(other) => panic!("{reason}: {other}"),
            Ok(_) => panic!("{reason}: groomed"),
        }
    }
}
