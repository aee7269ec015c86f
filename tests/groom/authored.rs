//! What an artist puts into a glTF file beside the mesh: masks on vertices, curves along the lay, stations of a row.

use bevy::{gltf::GltfAssetLabel, math::Vec3, prelude::*, world_serialization::WorldAssetRoot};
use bevy_plumage::groom::*;
use bevy_plumage::prelude::{FeatherPath, Plumage};
use plumage_tests::headless;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Vertices along each side of the skin.
const SIDE: usize = 21;

/// Puts numbers into the file's bytes and describes them.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn add(&mut self, bytes: &[u8], count: usize, mut accessor: Value) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(),
        }));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        accessor["bufferView"] = json!(self.views.len() - 1);
        accessor["count"] = json!(count);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, rows: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = rows
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let fold = |f: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..N)
                .map(|k| rows.iter().map(|row| row[k]).reduce(f).unwrap_or(0.0))
                .collect()
        };
        let accessor = json!({
            "componentType": 5126, "type": kind, "min": fold(f32::min), "max": fold(f32::max),
        });
        self.add(&bytes, rows.len(), accessor)
    }

    fn indices(&mut self, list: &[u32]) -> usize {
        let bytes: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
        let accessor = json!({"componentType": 5125, "type": "SCALAR"});
        self.add(&bytes, list.len(), accessor)
    }

    fn write(self, name: &str, meshes: Value, nodes: Value) -> PathBuf {
        let count = nodes.as_array().map_or(0, Vec::len);
        let root = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": (0..count).collect::<Vec<_>>()}],
            "nodes": nodes,
            "meshes": meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.bytes.len()}],
        });
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut file = Vec::new();
        for word in [0x4654_6C67, 2, total as u32, text.len() as u32, 0x4E4F_534A] {
            file.extend(u32::to_le_bytes(word));
        }
        file.extend(text);
        for word in [self.bytes.len() as u32, 0x004E_4942] {
            file.extend(u32::to_le_bytes(word));
        }
        file.extend(self.bytes);
        let path = plumage_tests::failure(name);
        std::fs::write(&path, file).expect("the folder for failures");
        path
    }
}

/// A square of 0.4 m that faces up. Left of the middle no feathers grow; behind it they are half as long.
fn square(file: &mut File) -> Value {
    let place = |i: usize| 0.4 * (i as f32 / (SIDE - 1) as f32 - 0.5);
    let places: Vec<[f32; 3]> = (0..SIDE * SIDE)
        .map(|i| [place(i % SIDE), 0.0, place(i / SIDE)])
        .collect();
    let mut list = Vec::new();
    for z in 0..SIDE as u32 - 1 {
        for x in 0..SIDE as u32 - 1 {
            let n = SIDE as u32;
            let a = z * n + x;
            list.extend([a, a + n, a + 1, a + 1, a + n, a + n + 1]);
        }
    }
    let density: Vec<u8> = places
        .iter()
        .map(|p| if p[0] < 0.0 { 0 } else { 255 })
        .collect();
    let rows: Vec<u8> = density.iter().flat_map(|d| [*d, 9, 9, 255]).collect();
    let accessor = json!({"componentType": 5121, "type": "VEC4", "normalized": true});
    let density = file.add(&rows, places.len(), accessor);
    let length: Vec<[f32; 1]> = places
        .iter()
        .map(|p| [if p[2] < 0.0 { 0.5 } else { 1.0 }])
        .collect();
    let up = vec![[0.0, 1.0, 0.0]; places.len()];
    let spare = vec![[1.0]; places.len()];
    json!({"name": "skin", "primitives": [{
        "attributes": {
            "POSITION": file.floats(&places),
            "NORMAL": file.floats(&up),
            "_DENSITY": density,
            "_LENGTH": file.floats(&length),
            "_DENSTIY": file.floats(&spare),
        },
        "indices": file.indices(&list),
    }]})
}

/// Feathers of a file without a groom, what was said of them, and the names of their regions.
pub fn cards(path: PathBuf) -> (Vec<Card>, PlumageState, Vec<CardRegion>) {
    let mut app = headless::app(FeatherPath::Full);
    let scene = app
        .world()
        .resource::<AssetServer>()
        .load(GltfAssetLabel::Scene(0).from_asset(path));
    let bird = app
        .world_mut()
        .spawn((
            WorldAssetRoot(scene),
            Plumage::default(),
            Transform::default(),
            Visibility::default(),
        ))
        .id();
    headless::wait(&mut app, "the feathers", |world| {
        let state = world.get::<PlumageState>(bird);
        state.is_some_and(|state| {
            assert_eq!(state.error, None);
            state.is_ready()
        })
    });
    let mut drawn = app.world_mut().query::<(&Mesh3d, &Visibility)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    for (mesh, visibility) in drawn.iter(app.world()) {
        let lines = meshes.get(&mesh.0).map(|mesh| mesh.primitive_topology());
        if lines == Some(bevy::mesh::PrimitiveTopology::LineList) {
            assert_eq!(*visibility, Visibility::Hidden, "curves are not to be seen");
        }
    }
    let world = app.world();
    let parts = world.get::<PlumageParts>(bird).expect("parts");
    let cards = world.get::<PlumageCards>(parts[0]).expect("cards");
    let state = world.get::<PlumageState>(bird).expect("a state").clone();
    (cards.cards.to_vec(), state, cards.regions.to_vec())
}

#[test]
fn masks_curves_and_stations_of_a_file_are_followed() {
    let mut file = File::default();
    let skin = square(&mut file);
    // A bent curve along x, its vertices out of order, from the end with the lower number.
    let curve = [[0.0, 0.0, 0.1], [0.2, 0.0, -0.1], [0.1, 0.0, 0.0]];
    let curves = json!({"name": "guides", "primitives": [{
        "mode": 1,
        "attributes": {"POSITION": file.floats(&curve)},
        "indices": file.indices(&[2, 1, 0, 2]),
    }]});
    let turn = std::f32::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        {"name": "skin", "mesh": 0},
        {"name": "guides", "mesh": 1, "extras": {"mirror": 1}},
        {"name": "row.tail", "extras": {"lengths": [0.1, 0.11, 0.12], "width": [0.02, 0.03]}},
        // Their y axes point along -z.
        {"name": "row.tail.001", "translation": [0.1, 0.01, -0.2], "rotation": [-turn, 0.0, 0.0, turn]},
        {"name": "row.tail.002", "translation": [0.16, 0.01, -0.2], "rotation": [-turn, 0.0, 0.0, turn]},
        {"name": "row.lost.001", "translation": [0.1, 0.01, -0.2]},
    ]);
    let path = file.write("authored.glb", json!([skin, curves]), nodes);
    let (cards, state, regions) = cards(path);
    println!("{} feathers, {:#?}", cards.len(), state.warnings);
    let of = |name: &str| regions.iter().position(|region| region.name == name);
    let tail: Vec<&Card> = cards
        .iter()
        .filter(|card| Some(usize::from(card.region)) == of("tail"))
        .collect();
    let lengths: Vec<f32> = tail.iter().map(|card| card.length).collect();
    assert_eq!(tail.len(), 3, "the row has three feathers");
    for (got, wanted) in lengths.iter().zip([0.1, 0.11, 0.12]) {
        assert!((got / wanted - 1.0).abs() < 0.25, "{lengths:?}");
    }
    assert!((tail[0].root - Vec3::new(0.1, 0.01, -0.2)).length() < 0.01);
    assert!(tail.iter().all(|card| card.along.z < -0.9), "{:?}", tail[0]);
    let scattered: Vec<&Card> = cards
        .iter()
        .filter(|card| usize::from(card.region) == 0)
        .collect();
    // A root may begin a little before its place.
    let bare = scattered.iter().filter(|card| card.root.x < -0.03).count();
    assert!(scattered.len() > 300, "{}", scattered.len());
    assert_eq!(bare, 0, "feathers where the mask wants none");
    let mean = |behind: bool| {
        let some = scattered.iter().filter(|card| {
            let z = if behind { -card.root.z } else { card.root.z };
            (0.03..0.18).contains(&z)
        });
        let (sum, count) = some.fold((0.0, 0), |(sum, n), card| (sum + card.length, n + 1));
        sum / count.max(1) as f32
    };
    let ratio = mean(true) / mean(false);
    assert!((0.45..0.55).contains(&ratio), "{ratio}");
    // The curve runs to the right and back.
    let wanted = Vec3::new(1.0, 0.0, -1.0).normalize();
    let near = scattered
        .iter()
        .filter(|card| card.root.distance(Vec3::new(0.1, 0.0, 0.0)) < 0.06);
    for card in near {
        let flat = Vec3::new(card.along.x, 0.0, card.along.z).normalize();
        assert!(flat.dot(wanted) > 0.8, "{} at {}", card.along, card.root);
    }
    let said = |words: &[&str]| {
        let all = |text: &&String| words.iter().all(|word| text.contains(word));
        assert!(state.warnings.iter().any(|w| all(&w)), "{words:?}");
    };
    said(&["_DENSTIY", "left out"]);
    said(&["row.lost.NUMBER", "at least 2"]);
}

#[test]
fn curves_are_walked_from_the_lower_end_and_end_where_they_join() {
    use bevy::{
        asset::RenderAssetUsages,
        mesh::{Indices, Mesh, PrimitiveTopology},
    };
    let places: Vec<[f32; 3]> = (0..7).map(|i| [i as f32, 0.0, 0.0]).collect();
    let lines = |list: Vec<u32>| {
        Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places.clone())
            .with_inserted_indices(Indices::U32(list))
    };
    let walked = |list: Vec<u32>| -> Vec<Vec<u32>> {
        let chains = chains(&lines(list));
        let numbers = |chain: Vec<Vec3>| chain.into_iter().map(|p| p.x as u32).collect();
        chains.into_iter().map(numbers).collect()
    };
    assert_eq!(walked(vec![5, 2, 2, 6]), [[5, 2, 6]]);
    assert_eq!(walked(vec![0, 1, 1, 2, 1, 3]), [[0, 1], [1, 2], [1, 3]]);
    assert_eq!(walked(vec![0, 1, 1, 2, 2, 0]), [[0, 1, 2, 0]]);
    assert_eq!(walked(vec![0, 0, 9, 1]), Vec::<Vec<u32>>::new());
}
