//! The baked birds: meshes, skeletons, clips and grooms are complete and fit together.

use std::collections::BTreeSet;

use bevy_plumage::asset::RonAsset;
use bevy_plumage::groom::{Groom, Select};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked::Valid;
use plumage_tests::asset;

/// All birds that are shipped.
const BIRDS: [&str; 3] = ["parrot", "eagle", "owl"];

struct Glb {
    root: gltf_json::Root,
    bin: Vec<u8>,
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

fn glb(bird: &str) -> Glb {
    let bytes = std::fs::read(asset(&format!("birds/{bird}.glb"))).expect("glb is there");
    assert_eq!(word(&bytes, 0), 0x4654_6C67, "magic");
    assert_eq!(word(&bytes, 8) as usize, bytes.len(), "total length");
    let json = word(&bytes, 12) as usize;
    let root = gltf_json::Root::from_slice(&bytes[20..20 + json]).expect("JSON chunk parses");
    let bin = bytes[28 + json..].to_vec();
    assert_eq!(word(&bytes, 20 + json) as usize, bin.len(), "binary chunk");
    Glb { root, bin }
}

fn groom(bird: &str) -> Groom {
    plumage_tests::shipped::groom(bird)
}

impl Glb {
    fn floats(&self, accessor: usize, width: usize) -> Vec<Vec<f32>> {
        let a = &self.root.accessors[accessor];
        let v = &self.root.buffer_views[a.buffer_view.expect("has a view").value()];
        let start = (v.byte_offset.map_or(0, |o| o.0) + a.byte_offset.map_or(0, |o| o.0)) as usize;
        (0..a.count.0 as usize)
            .map(|i| {
                (0..width)
                    .map(|k| f32::from_bits(word(&self.bin, start + 4 * (i * width + k))))
                    .collect()
            })
            .collect()
    }

    fn attribute(
        &self,
        mesh: usize,
        primitive: usize,
        semantic: Semantic,
        width: usize,
    ) -> Vec<Vec<f32>> {
        let attributes = &self.root.meshes[mesh].primitives[primitive].attributes;
        let accessor = attributes
            .get(&Valid(semantic))
            .expect("attribute is there");
        self.floats(accessor.value(), width)
    }

    fn joint_names(&self) -> BTreeSet<String> {
        self.root.skins[0]
            .joints
            .iter()
            .map(|j| {
                self.root.nodes[j.value()]
                    .name
                    .clone()
                    .expect("joints are named")
            })
            .collect()
    }
}

fn tracts_of(select: &Select, out: &mut Vec<u32>) {
    match select {
        Select::Tract(t) => out.push(*t),
        Select::Any(all) | Select::Every(all) | Select::Not(all) => {
            all.iter().for_each(|s| tracts_of(s, out))
        }
        _ => {}
    }
}

#[test]
fn birds_are_symmetric_in_the_plane_that_mirror_flags_mean() {
    for bird in BIRDS {
        let positions: Vec<bevy::math::Vec3> = glb(bird)
            .attribute(0, 0, Semantic::Positions, 3)
            .iter()
            .map(|p| bevy::math::Vec3::new(p[0], p[1], p[2]))
            .collect();
        let plane = bevy_plumage::inspector::MirrorPlane::find(&positions);
        assert!(
            plane.is_some_and(|plane| plane.is_model(0.4, 0.001)),
            "{bird}: {plane:?}"
        );
    }
}

#[test]
fn skeletons_have_57_distinct_named_joints() {
    for bird in BIRDS {
        let g = glb(bird);
        let names = g.joint_names();
        assert_eq!(names.len(), 57, "{bird}");
        assert_eq!(g.root.skins[0].joints.len(), 57, "{bird}");
        for name in [
            "hips",
            "chest",
            "head",
            "jaw",
            "tail_fan_L",
            "humerus_R",
            "hand_L",
            "toe4b_R",
        ] {
            assert!(names.contains(name), "{bird}: {name}");
        }
        assert_eq!(
            names.iter().filter(|n| n.ends_with("_L")).count(),
            names.iter().filter(|n| n.ends_with("_R")).count()
        );
    }
}

#[test]
fn weights_sum_to_one_and_colors_and_normals_are_finite() {
    for bird in BIRDS {
        let g = glb(bird);
        for (m, mesh) in g.root.meshes.iter().enumerate() {
            for p in 0..mesh.primitives.len() {
                for w in g.attribute(m, p, Semantic::Weights(0), 4) {
                    let sum: f32 = w.iter().sum();
                    assert!(
                        (sum - 1.0).abs() < 1e-4,
                        "{bird} mesh {m} primitive {p}: {w:?}"
                    );
                    assert!(w.iter().all(|v| *v >= 0.0));
                }
                for n in g.attribute(m, p, Semantic::Normals, 3) {
                    let length = n.iter().map(|v| v * v).sum::<f32>().sqrt();
                    assert!(
                        (length - 1.0).abs() < 1e-3,
                        "{bird} mesh {m} primitive {p}: {n:?}"
                    );
                }
                for c in g.attribute(m, p, Semantic::Colors(0), 4) {
                    assert!(c.iter().all(|v| (0.0..=1.0).contains(v)), "{bird}: {c:?}");
                }
            }
        }
    }
}

#[test]
fn birds_have_the_size_of_birds() {
    // Height of the perched body without tail feathers, and span of the skin of the half-open wings, metres.
    for (bird, height, span) in [
        ("parrot", 0.33..0.40, 0.45..0.65),
        ("eagle", 0.52..0.62, 0.9..1.2),
        ("owl", 0.27..0.32, 0.4..0.55),
    ] {
        let g = glb(bird);
        let p = g.attribute(0, 0, Semantic::Positions, 3);
        let limits = |k: usize| {
            p.iter()
                .map(|v| v[k])
                .fold((f32::MAX, f32::MIN), |(lo, hi), v| (lo.min(v), hi.max(v)))
        };
        let (x, y) = (limits(0), limits(1));
        assert!((x.0 + x.1).abs() < 1e-3, "{bird} is symmetric: {x:?}");
        assert!(span.contains(&(x.1 - x.0)), "{bird} span {}", x.1 - x.0);
        assert!(height.contains(&y.1), "{bird} height {}", y.1);
    }
}

#[test]
fn skin_is_closed() {
    for bird in BIRDS {
        let g = glb(bird);
        let points = g.attribute(0, 0, Semantic::Positions, 3);
        let indices = g.root.meshes[0].primitives[0].indices.expect("indexed");
        let a = &g.root.accessors[indices.value()];
        let v = &g.root.buffer_views[a.buffer_view.expect("has a view").value()];
        let start = v.byte_offset.map_or(0, |o| o.0) as usize;
        // Vertices are doubled along tract borders: compare by place.
        let key = |i: u32| -> [u32; 3] { std::array::from_fn(|k| points[i as usize][k].to_bits()) };
        let mut edges = std::collections::BTreeMap::new();
        for t in 0..a.count.0 as usize / 3 {
            let c: Vec<_> = (0..3)
                .map(|k| key(word(&g.bin, start + 4 * (3 * t + k))))
                .collect();
            for k in 0..3 {
                let (p, q) = (c[k], c[(k + 1) % 3]);
                *edges.entry((p.min(q), p.max(q))).or_insert(0) += if p < q { 1 } else { -1 };
            }
        }
        assert_eq!(edges.values().filter(|v| **v != 0).count(), 0, "{bird}");
    }
}

#[test]
fn grooms_hold_the_counted_feathers() {
    for (bird, count) in [("parrot", 6460), ("eagle", 6484), ("owl", 6838)] {
        let g = groom(bird);
        assert_eq!(g.version, Groom::VERSION);
        let scattered: u32 = g.regions.iter().map(|r| r.count).sum();
        let rows: usize = g
            .rows
            .iter()
            .map(|r| r.lengths.len() * if r.mirror { 2 } else { 1 })
            .sum();
        assert_eq!(scattered as usize + rows, count, "{bird}");
        let used = g
            .regions
            .iter()
            .map(|r| r.feather)
            .chain(g.rows.iter().map(|r| r.feather));
        assert!(
            used.into_iter().all(|f| (f as usize) < g.feathers.len()),
            "{bird}"
        );
        let names: BTreeSet<_> = g
            .regions
            .iter()
            .map(|r| &r.name)
            .chain(g.rows.iter().map(|r| &r.name))
            .collect();
        assert_eq!(
            names.len(),
            g.regions.len() + g.rows.len(),
            "{bird}: names are seeds, so distinct"
        );
    }
}

#[test]
fn every_tract_of_a_groom_is_on_its_mesh() {
    for bird in BIRDS {
        let g = glb(bird);
        let present: BTreeSet<u32> = g
            .attribute(0, 0, Semantic::TexCoords(1), 2)
            .iter()
            .map(|t| t[0].round() as u32)
            .collect();
        for region in groom(bird).regions {
            let mut wanted = Vec::new();
            tracts_of(&region.select, &mut wanted);
            assert!(!wanted.is_empty(), "{bird}: {}", region.name);
            for t in wanted {
                assert!(
                    present.contains(&t),
                    "{bird}: {} wants tract {t}",
                    region.name
                );
            }
        }
        for t in g.attribute(0, 0, Semantic::TexCoords(1), 2) {
            assert!((0.0..=1.0).contains(&t[1]), "{bird}: phi {}", t[1]);
        }
    }
}

#[test]
fn rows_stand_on_joints_and_frames_are_orthonormal() {
    for bird in BIRDS {
        let joints = glb(bird).joint_names();
        for row in groom(bird).rows {
            assert!(
                row.stations.windows(2).all(|s| s[0].at < s[1].at),
                "{bird}: {}",
                row.name
            );
            for s in &row.stations {
                let d: f32 = s.direction.iter().zip(s.normal).map(|(a, b)| a * b).sum();
                let length: f32 = s.direction.iter().map(|v| v * v).sum();
                assert!(
                    d.abs() < 0.02 && (length - 1.0).abs() < 1e-3,
                    "{bird}: {} {s:?}",
                    row.name
                );
                for list in [&s.ride, &s.follow] {
                    let sum: f32 = list.iter().map(|ride| ride.weight).sum();
                    assert!((sum - 1.0).abs() < 1e-3, "{bird}: {} {list:?}", row.name);
                    for ride in list {
                        let name = &ride.joint;
                        assert!(joints.contains(name), "{bird}: {} rides {name}", row.name);
                    }
                }
            }
        }
    }
}

#[test]
fn idle_loops() {
    for (bird, seconds) in [("parrot", 5.0), ("eagle", 6.0), ("owl", 6.0)] {
        let g = glb(bird);
        assert_eq!(g.root.animations.len(), 1);
        let clip = &g.root.animations[0];
        assert_eq!(clip.name.as_deref(), Some("idle"));
        let mut moving = BTreeSet::new();
        for c in &clip.channels {
            let s = &clip.samplers[c.sampler.value()];
            let times = g.floats(s.input.value(), 1);
            assert!((times[times.len() - 1][0] - seconds).abs() < 1e-4, "{bird}");
            assert!(times.windows(2).all(|t| t[0][0] < t[1][0]), "{bird}");
            let width = match c.target.path {
                Valid(gltf_json::animation::Property::Rotation) => 4,
                _ => 3,
            };
            let values = g.floats(s.output.value(), width);
            assert_eq!(values.len(), times.len());
            assert_eq!(
                values.first(),
                values.last(),
                "{bird}: channel of node {}",
                c.target.node.value()
            );
            if values.iter().any(|v| v != &values[0]) {
                moving.insert(
                    g.root.nodes[c.target.node.value()]
                        .name
                        .clone()
                        .unwrap_or_default(),
                );
            }
        }
        for name in [
            "chest",
            "head",
            "neck2",
            "humerus_L",
            "hand_L",
            "tail_fan_R",
            "jaw",
            "lid_lo_R",
        ] {
            assert!(moving.contains(name), "{bird}: {name} moves");
        }
    }
}

#[test]
fn idle_has_no_jumps() {
    for bird in BIRDS {
        let g = glb(bird);
        let clip = &g.root.animations[0];
        for c in &clip.channels {
            let name = g.root.nodes[c.target.node.value()]
                .name
                .clone()
                .unwrap_or_default();
            let rotation = c.target.path == Valid(gltf_json::animation::Property::Rotation);
            if !rotation || name.starts_with("lid_") {
                continue;
            }
            let values = g.floats(clip.samplers[c.sampler.value()].output.value(), 4);
            for v in values.windows(2) {
                let dot: f32 = v[0].iter().zip(&v[1]).map(|(a, b)| a * b).sum();
                let degrees = 2.0 * dot.clamp(-1.0, 1.0).acos().to_degrees();
                assert!(
                    dot > 0.0 && degrees < 9.0,
                    "{bird}: {name} turns {degrees} degrees in a frame"
                );
            }
        }
    }
}
