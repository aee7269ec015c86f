//! A made-up bird for the groom's tests: an ellipsoid of three joints with two tracts, a back and a belly.

use bevy::{
    asset::RenderAssetUsages,
    math::{Mat4, Vec3},
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};
use bevy_plumage::groom::*;

/// Half axes, metres: long in z, the head towards +z.
pub const HALF: Vec3 = Vec3::new(0.05, 0.06, 0.12);

/// Joints: root, spine in the middle, wing at the left side.
pub const JOINTS: [&str; 4] = ["root", "spine", "wing_L", "wing_R"];

/// Where the joints are in bind pose.
pub fn joint_places() -> Vec<Vec3> {
    vec![
        Vec3::ZERO,
        Vec3::new(0.0, 0.0, 0.05),
        Vec3::new(0.05, 0.0, 0.02),
        Vec3::new(-0.05, 0.0, 0.02),
    ]
}

/// Inverse bind poses of the joints.
pub fn inverse_bind() -> Vec<Mat4> {
    joint_places()
        .iter()
        .map(|place| Mat4::from_translation(-*place))
        .collect()
}

/// The ellipsoid; `tracts`: with TEXCOORD_1 (tract 1 above, 2 below; phi from head to tail).
pub fn body(tracts: bool) -> Mesh {
    let (rings, sides) = (40_u32, 48_u32);
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let (mut joints, mut weights) = (Vec::new(), Vec::new());
    for i in 0..=rings {
        let polar = std::f32::consts::PI * i as f32 / rings as f32;
        for j in 0..=sides {
            let turn = std::f32::consts::TAU * j as f32 / sides as f32;
            let unit = Vec3::new(
                polar.sin() * turn.sin(),
                polar.sin() * turn.cos(),
                polar.cos(),
            );
            positions.push((unit * HALF).to_array());
            normals.push((unit / HALF).normalize().to_array());
            uvs.push([
                if unit.y >= 0.0 { 1.0 } else { 2.0 },
                i as f32 / rings as f32,
            ]);
            let front = (0.5 + 0.5 * unit.z).clamp(0.0, 1.0);
            joints.push([0_u16, 1, 0, 0]);
            weights.push([1.0 - front, front, 0.0, 0.0]);
        }
    }
    let mut indices = Vec::new();
    for i in 0..rings {
        for j in 0..sides {
            let a = i * (sides + 1) + j;
            let b = a + sides + 1;
            indices.extend([a, b + 1, a + 1, a, b, b + 1]);
        }
    }
    let mut mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    if tracts {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, uvs);
    }
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(joints),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    mesh.insert_indices(Indices::U32(indices));
    mesh
}

/// The ellipsoid as a bird.
pub fn bird(tracts: bool) -> Bird {
    let mesh = body(tracts);
    Bird {
        skin: SkinMesh::from_meshes(&[&mesh], &[]).expect("a sound mesh"),
        joints: JOINTS.map(String::from).to_vec(),
        pivots: Vec::new(),
    }
}

/// A region of the made-up bird, in millimetres.
pub fn region(name: &str, select: Select, count: u32, layer: f32) -> Region {
    let mut region = Region::new(name);
    region.select = select;
    region.count = count;
    region.length = Span(16.0, 26.0);
    region.width = Span(9.0, 14.0);
    region.lift = Span(9.0, 9.0);
    region.camber = 0.07;
    region.curl = 8.0;
    region.stiffness = 0.25;
    region.layer = layer;
    region.tint = Tint([0.7, 0.1, 0.1], [0.2, 0.3, 0.8]);
    region
}

fn station(at: f32, root: [f32; 3], direction: [f32; 3], joint: &str) -> Station {
    let (own, hand) = if joint == "root" {
        (1.0, 0.0)
    } else {
        (0.0, 1.0)
    };
    let mut station = Station::new(at, root, direction, [0.2, 1.0, 0.0]);
    station.ride = vec![JointWeight::new("wing_L", 1.0)];
    station.follow = vec![
        JointWeight::new("root", own),
        JointWeight::new("wing_L", hand),
    ];
    station
}

/// A mirrored wing row of eight, from body to hand: the first follows the root joint, the last the wing.
pub fn wing() -> Row {
    let lengths = vec![60.0, 64.0, 68.0, 72.0, 76.0, 80.0, 84.0, 86.0];
    let stations = vec![
        station(0.0, [50.0, 10.0, 10.0], [0.1, 0.0, -1.0], "root"),
        station(1.0, [110.0, 10.0, 30.0], [0.8, 0.0, -0.6], "wing"),
    ];
    let mut row = Row::new("remiges", lengths, stations);
    row.width = Span(18.0, 12.0);
    row.mirror = true;
    row.handed = true;
    row.camber = 0.06;
    row.curl = 6.0;
    row.layer = Span(3.0, 2.0);
    row.offset = 0.8;
    row.segments = Segments::new(6, 4);
    row.tint = Tint([0.1, 0.2, 0.6], [0.1, 0.2, 0.6]);
    row.jitter = Jitter::NONE;
    row
}

/// A groom of two tracts and a wing.
pub fn groom() -> Groom {
    let mut back = region("back", Select::Tract(1), 400, 5.0);
    back.placement = Placement::Rows(14);
    let mut groom = Groom::default();
    groom.name = "made-up".into();
    groom.feathers = vec!["a.feather.ron".into()];
    groom.regions = vec![back, region("belly", Select::Tract(2), 350, 4.0)];
    groom.guides = vec![Guide::new([[0.0, 60.0, 40.0], [0.0, 60.0, -40.0]])];
    groom.rows = vec![wing()];
    groom
}
