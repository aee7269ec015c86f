//! The birds of the scenes without an app: their glTF files read and posed, and their coats groomed.

use bevy::{
    asset::RenderAssetUsages,
    math::{Affine3A, Mat4, Quat, Vec3},
    mesh::{Indices, Mesh, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues},
};
use bevy_plumage::{
    groom::{
        ATTRIBUTE_RAISED, Bird, Coat, Groom, JointPose, KeyPose, SkinMesh, Wear, fan_transform,
        groom_bird, skin::Weights,
    },
    maths::order::{raised_heights, raised_held, raised_window},
};
use gltf_json::{
    Root, accessor::ComponentType, animation::Property, mesh::Semantic, validation::Checked::Valid,
};
use std::path::Path;

/// A node's place under its parent.
#[derive(Clone, Copy)]
struct Local {
    translation: Vec3,
    rotation: Quat,
    scale: Vec3,
}

/// One animated property of one node.
struct Channel {
    node: usize,
    property: Property,
    times: Vec<f32>,
    values: Vec<[f32; 4]>,
}

/// A bird, its skeleton, and its clip.
pub struct SceneBird {
    /// Skin and names of the joints.
    pub bird: Bird,
    /// Its groom.
    pub groom: Groom,
    /// Length of the clip, seconds.
    pub duration: f32,
    parts: Vec<(Vec<Vec3>, Vec<Weights>, Vec<u32>)>,
    inverse_bind: Vec<Mat4>,
    joints: Vec<usize>,
    nodes: Vec<Local>,
    parents: Vec<Option<usize>>,
    channels: Vec<Channel>,
}

/// Cards and body in one pose.
pub struct PosedCoat {
    /// Vertices of the card mesh.
    pub cards: Vec<Vec3>,
    /// Triangles of skin, bill, legs and eyes.
    pub body: Vec<[Vec3; 3]>,
    /// How far behind the nearest each vertex is seen, widths of its card; empty: not at all.
    pub windows: Vec<f32>,
}

struct File {
    root: Root,
    bytes: Vec<u8>,
}

impl File {
    fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).expect("the bird is there");
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i])) as usize;
        let json = word(12);
        Self {
            root: Root::from_slice(&bytes[20..20 + json]).expect("glTF parses"),
            bytes: bytes[28 + json..].to_vec(),
        }
    }

    /// An accessor's values, `N` numbers each.
    fn values<const N: usize>(&self, accessor: usize) -> Vec<[f32; N]> {
        let accessor = &self.root.accessors[accessor];
        let view = &self.root.buffer_views[accessor.buffer_view.expect("has a view").value()];
        let start = (view.byte_offset.map_or(0, |at| at.0)
            + accessor.byte_offset.map_or(0, |at| at.0)) as usize;
        let Valid(component) = accessor.component_type else {
            panic!("component type")
        };
        let size = match component.0 {
            ComponentType::U8 | ComponentType::I8 => 1,
            ComponentType::U16 | ComponentType::I16 => 2,
            ComponentType::U32 | ComponentType::F32 => 4,
        };
        let number = |at: usize| {
            let bytes = &self.bytes[at..at + size];
            match component.0 {
                ComponentType::U8 => f32::from(bytes[0]),
                ComponentType::U16 => f32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
                ComponentType::U32 => {
                    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32
                }
                ComponentType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
                other => panic!("component type {other:?}"),
            }
        };
        (0..accessor.count.0 as usize)
            .map(|i| std::array::from_fn(|k| number(start + (i * N + k) * size)))
            .collect()
    }
}

/// File of the assets folder.
fn asset(path: &str) -> std::path::PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../assets")).join(path)
}

impl SceneBird {
    /// Reads `assets/birds/{name}.glb` and its groom.
    ///
    /// # Panics
    /// If either is missing or damaged.
    pub fn load(name: &str) -> Self {
        let text = std::fs::read_to_string(asset(&format!("grooms/{name}.groom.ron")))
            .expect("the groom is there");
        let groom: Groom = ron::from_str(&text).expect("the groom parses");
        let file = File::read(&asset(&format!("birds/{name}.glb")));
        let root = &file.root;
        let skin = &root.skins[0];
        let joints: Vec<usize> = skin.joints.iter().map(|joint| joint.value()).collect();
        let inverse = skin.inverse_bind_matrices.expect("has bind poses").value();
        let inverse_bind = file.values::<16>(inverse);
        let inverse_bind = inverse_bind.iter().map(Mat4::from_cols_array).collect();
        let names = joints
            .iter()
            .map(|node| root.nodes[*node].name.clone().unwrap_or_default())
            .collect();
        let mut parents = vec![None; root.nodes.len()];
        for (number, node) in root.nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                parents[child.value()] = Some(number);
            }
        }
        let nodes = root
            .nodes
            .iter()
            .map(|node| Local {
                translation: node.translation.map_or(Vec3::ZERO, Vec3::from_array),
                rotation: node
                    .rotation
                    .map_or(Quat::IDENTITY, |q| Quat::from_array(q.0)),
                scale: node.scale.map_or(Vec3::ONE, Vec3::from_array),
            })
            .collect();
        let (mut meshes, mut parts) = (Vec::new(), Vec::new());
        for mesh in &root.meshes {
            for primitive in &mesh.primitives {
                let find = |semantic: Semantic| {
                    let found = primitive.attributes.get(&Valid(semantic));
                    found.map(|accessor| accessor.value())
                };
                let must = |semantic: Semantic| find(semantic).expect("attribute is there");
                let positions = file.values::<3>(must(Semantic::Positions));
                let joints: Vec<[u16; 4]> = file
                    .values::<4>(must(Semantic::Joints(0)))
                    .iter()
                    .map(|list| list.map(|joint| joint as u16))
                    .collect();
                let weights = file.values::<4>(must(Semantic::Weights(0)));
                let indices: Vec<u32> = file
                    .values::<1>(primitive.indices.expect("indexed").value())
                    .iter()
                    .map(|index| index[0] as u32)
                    .collect();
                parts.push((
                    positions.iter().copied().map(Vec3::from_array).collect(),
                    joints
                        .iter()
                        .copied()
                        .zip(weights.iter().copied())
                        .collect(),
                    indices.clone(),
                ));
                let Some(tracts) = find(Semantic::TexCoords(1)) else {
                    continue;
                };
                let mut mesh = Mesh::new(
                    PrimitiveTopology::TriangleList,
                    RenderAssetUsages::default(),
                );
                mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
                let normals = file.values::<3>(must(Semantic::Normals));
                mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
                let colors = file.values::<4>(must(Semantic::Colors(0)));
                mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
                mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, file.values::<2>(tracts));
                mesh.insert_attribute(
                    Mesh::ATTRIBUTE_JOINT_INDEX,
                    VertexAttributeValues::Uint16x4(joints),
                );
                mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
                mesh.insert_indices(Indices::U32(indices));
                meshes.push(mesh);
            }
        }
        let clip = &root.animations[0];
        let channels: Vec<Channel> = clip
            .channels
            .iter()
            .map(|channel| {
                let sampler = &clip.samplers[channel.sampler.value()];
                let Valid(property) = channel.target.path else {
                    panic!("property")
                };
                let times = file.values::<1>(sampler.input.value());
                let output = sampler.output.value();
                let values = match property {
                    Property::Rotation => file.values::<4>(output),
                    _ => file
                        .values::<3>(output)
                        .iter()
                        .map(|v| [v[0], v[1], v[2], 0.0])
                        .collect(),
                };
                Channel {
                    node: channel.target.node.value(),
                    property,
                    times: times.iter().map(|time| time[0]).collect(),
                    values,
                }
            })
            .collect();
        let last = |channel: &Channel| channel.times.last().copied().unwrap_or(0.0);
        let meshes: Vec<&Mesh> = meshes.iter().collect();
        Self {
            bird: Bird {
                skin: SkinMesh::from_meshes(&meshes, &[]).expect("the body is a skin"),
                joints: names,
                pivots: Vec::new(),
            },
            groom,
            duration: channels.iter().map(last).fold(0.0, f32::max),
            parts,
            inverse_bind,
            joints,
            nodes,
            parents,
            channels,
        }
    }

    /// Its coat.
    ///
    /// # Panics
    /// If the groom is damaged.
    pub fn groom(&self, seed: u64, density: f32) -> Coat {
        groom_bird(&self.bird, &self.groom, seed, density).expect("the bird is groomed")
    }

    /// What each joint of the body does to the bind pose at a time of the clip; without a time: nothing.
    pub fn skinning(&self, time: Option<f32>) -> Vec<Affine3A> {
        let Some(time) = time else {
            return vec![Affine3A::IDENTITY; self.joints.len()];
        };
        let mut nodes = self.nodes.clone();
        for channel in &self.channels {
            let time = time.rem_euclid(self.duration.max(1.0e-6));
            let after = channel.times.partition_point(|t| *t <= time);
            let (a, b) = (after.saturating_sub(1), after.min(channel.times.len() - 1));
            let span = channel.times[b] - channel.times[a];
            let share = if span > 0.0 {
                (time - channel.times[a]) / span
            } else {
                0.0
            };
            let (from, to) = (channel.values[a], channel.values[b]);
            let node = &mut nodes[channel.node];
            let vector = |v: [f32; 4]| Vec3::new(v[0], v[1], v[2]);
            let mixed = vector(from).lerp(vector(to), share);
            match channel.property {
                Property::Rotation => {
                    node.rotation = Quat::from_array(from)
                        .slerp(Quat::from_array(to), share)
                        .normalize();
                }
                Property::Translation => node.translation = mixed,
                Property::Scale => node.scale = mixed,
                Property::MorphTargetWeights => {}
            }
        }
        let global = |joint: usize| {
            let mut matrix = Affine3A::IDENTITY;
            let mut at = Some(joint);
            while let Some(node) = at {
                let own = nodes[node];
                matrix = Affine3A::from_scale_rotation_translation(
                    own.scale,
                    own.rotation,
                    own.translation,
                ) * matrix;
                at = self.parents[node];
            }
            matrix
        };
        self.joints
            .iter()
            .zip(&self.inverse_bind)
            .map(|(joint, inverse)| global(*joint) * Affine3A::from_mat4(*inverse))
            .collect()
    }

    /// The pose of a time of the clip, as grooms give poses.
    pub fn key_pose(&self, name: &str, time: f32) -> KeyPose {
        let joints = self.bird.joints.iter().zip(self.skinning(Some(time)));
        let round = |x: f32| (x * 1.0e5).round() * 1.0e-5;
        let pose = |(joint, matrix): (&String, Affine3A)| {
            let (_, rotation, translation) = matrix.to_scale_rotation_translation();
            JointPose {
                joint: joint.clone(),
                rotation: rotation.to_array().map(round),
                translation: (translation / self.groom.unit).to_array().map(round),
            }
        };
        KeyPose {
            name: name.into(),
            joints: joints.map(pose).collect(),
        }
    }

    /// What the joints of a pose do to each vertex of a coat.
    pub fn carries(coat: &Coat, skinning: &[Affine3A]) -> Vec<Affine3A> {
        let mut all = skinning.to_vec();
        all.extend(
            coat.fans
                .iter()
                .map(|fan| fan_transform(fan, skinning) * Affine3A::from_mat4(fan.inverse_bind())),
        );
        let joints = match coat.mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
            Some(VertexAttributeValues::Uint16x4(joints)) => joints.as_slice(),
            _ => &[],
        };
        let weights = match coat.mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT) {
            Some(VertexAttributeValues::Float32x4(weights)) => weights.as_slice(),
            _ => &[],
        };
        let sets = joints.iter().zip(weights);
        sets.map(|(joints, weights)| carry((*joints, *weights), &all))
            .collect()
    }

    /// Where a coat's vertices, given in bind pose, and the body are in a pose. `carries`: of that pose.
    pub fn pose(
        &self,
        vertices: &[Vec3],
        carries: &[Affine3A],
        skinning: &[Affine3A],
    ) -> PosedCoat {
        let cards = vertices
            .iter()
            .zip(carries)
            .map(|(place, carry)| carry.transform_point3(*place))
            .collect();
        let mut body = Vec::new();
        for (positions, weights, indices) in &self.parts {
            let posed: Vec<Vec3> = positions
                .iter()
                .zip(weights)
                .map(|(place, weights)| carry(*weights, skinning).transform_point3(*place))
                .collect();
            body.extend(
                indices
                    .chunks_exact(3)
                    .map(|corner| [0, 1, 2].map(|k| posed[corner[k] as usize])),
            );
        }
        PosedCoat {
            cards,
            body,
            windows: Vec::new(),
        }
    }

    /// Vertices of a coat in bind pose, raised as the pose wants it that the joints of the body are in.
    pub fn vertices(coat: &Coat, skinning: &[Affine3A]) -> Vec<Vec3> {
        let vectors = |attribute: MeshVertexAttribute| -> Vec<Vec3> {
            match coat.mesh.attribute(attribute) {
                Some(VertexAttributeValues::Float32x3(list)) => {
                    list.iter().copied().map(Vec3::from_array).collect()
                }
                _ => Vec::new(),
            }
        };
        let mut places = vectors(Mesh::ATTRIBUTE_POSITION);
        let normals = vectors(Mesh::ATTRIBUTE_NORMAL);
        let shares = coat.worn.wear(skinning).shares;
        for ((place, normal), raised) in places.iter_mut().zip(normals).zip(Self::raised(coat)) {
            let units = raised_heights::<f32>(*raised);
            let units = units.iter().zip(&shares[1..]);
            let height: f32 = units.map(|(unit, share)| unit * share).sum();
            *place += normal * (height * coat.worn.reach);
        }
        places
    }

    fn raised(coat: &Coat) -> &[[u16; 4]] {
        match coat.mesh.attribute(ATTRIBUTE_RAISED) {
            Some(VertexAttributeValues::Uint16x4(raised)) => raised,
            _ => &[],
        }
    }

    /// How far behind the nearest each vertex is seen in the pose that the joints of the body are in, widths of its card.
    pub fn windows(coat: &Coat, skinning: &[Affine3A]) -> Vec<f32> {
        let Wear { shares, between } = coat.worn.wear(skinning);
        let [_, further @ ..] = shares;
        let raised = Self::raised(coat).iter();
        raised
            .map(|words| raised_window(*words, further, between))
            .collect()
    }

    /// How far, 0..1, each vertex is held down by stiffer feathers in that pose.
    pub fn held(coat: &Coat, skinning: &[Affine3A]) -> Vec<f32> {
        let [_, further @ ..] = coat.worn.wear(skinning).shares;
        let raised = Self::raised(coat).iter();
        raised.map(|words| raised_held(*words, further)).collect()
    }

    /// Part of the body that a region or row of its groom belongs to.
    pub fn part(&self, region: u16) -> &'static str {
        let region = usize::from(region);
        let name = match region.checked_sub(self.groom.regions.len()) {
            None => self.groom.regions[region].name.as_str(),
            Some(row) => self.groom.rows[row].name.as_str(),
        };
        match name {
            "crown" | "nape" | "cheek" | "face" | "lore" | "face_lines" | "neck_dorsal"
            | "neck_ventral" => "head and neck",
            "scapulars" => "scapulars",
            "femoral" | "crural" | "tarsal" => "legs",
            "lesser_upper" | "marginal_upper" | "elbow" => "wing coverts",
            "lesser_under" | "marginal_under" | "axillaries" => "under wing",
            _ if name.starts_with("under_") && !name.contains("tail") => "under wing",
            _ if name.contains("tail") || name == "rectrices" => "tail",
            _ if region >= self.groom.regions.len() => "flight feathers and coverts",
            _ => "trunk",
        }
    }
}

fn carry((joints, weights): Weights, matrices: &[Affine3A]) -> Affine3A {
    let mut sum = Affine3A::ZERO;
    for k in (0..4).filter(|k| weights[*k] > 0.0) {
        let own = matrices[usize::from(joints[k])];
        sum.matrix3 += own.matrix3 * weights[k];
        sum.translation += own.translation * weights[k];
    }
    sum
}
