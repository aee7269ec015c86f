//! The birds of the scenes without an app: their glTF files read and posed, and their coats groomed.

use bevy::{
    asset::RenderAssetUsages,
    math::{Affine3A, Mat4, Quat, Vec3},
    mesh::{Indices, Mesh, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues},
};
use bevy_plumage::{
    groom::{
        ATTRIBUTE_RAISED, Bird, Coat, Groom, JointPose, KeyPose, SkinMesh, Wear, fan_transform,
        groom_bird, groom_with, skin::Weights,
    },
    maths::order::{raised_heights, raised_held, raised_window},
};
use gltf::animation::{Interpolation, Property, util::ReadOutputs};
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
    /// Whether each value holds until the next.
    steps: bool,
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

/// File of the assets folder.
fn asset(path: &str) -> std::path::PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../assets")).join(path)
}

/// Mesh of a primitive, and its vertices and triangles as they are.
fn primitive(
    primitive: &gltf::Primitive,
    bytes: &[u8],
) -> Option<(Mesh, (Vec<Vec3>, Vec<Weights>, Vec<u32>))> {
    let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(bytes));
    let positions: Vec<[f32; 3]> = reader.read_positions()?.collect();
    let joints: Vec<[u16; 4]> = reader.read_joints(0)?.into_u16().collect();
    let weights: Vec<[f32; 4]> = reader.read_weights(0)?.into_f32().collect();
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..positions.len() as u32).collect(),
    };
    let mut mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    );
    if let Some(normals) = reader.read_normals() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals.collect::<Vec<_>>());
    }
    if let Some(colors) = reader.read_colors(0) {
        let colors: Vec<[f32; 4]> = colors.into_rgba_f32().collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    }
    if let Some(tracts) = reader.read_tex_coords(1) {
        let tracts: Vec<[f32; 2]> = tracts.into_f32().collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, tracts);
    }
    let part = (
        positions.iter().copied().map(Vec3::from_array).collect(),
        joints
            .iter()
            .copied()
            .zip(weights.iter().copied())
            .collect(),
        indices.clone(),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(joints),
    );
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    mesh.insert_indices(Indices::U32(indices));
    Some((mesh, part))
}

/// What a clip does to one node.
fn channel(channel: &gltf::animation::Channel, bytes: &[u8]) -> Option<Channel> {
    let reader = channel.reader(|buffer| (buffer.index() == 0).then_some(bytes));
    let flat = |v: [f32; 3]| [v[0], v[1], v[2], 0.0];
    let values: Vec<[f32; 4]> = match reader.read_outputs()? {
        ReadOutputs::Translations(values) => values.map(flat).collect(),
        ReadOutputs::Scales(values) => values.map(flat).collect(),
        ReadOutputs::Rotations(values) => values.into_f32().collect(),
        ReadOutputs::MorphTargetWeights(_) => return None,
    };
    let interpolation = channel.sampler().interpolation();
    let values = match interpolation {
        // The tangents beside each value are left out.
        Interpolation::CubicSpline => values.chunks_exact(3).map(|key| key[1]).collect(),
        _ => values,
    };
    Some(Channel {
        node: channel.target().node().index(),
        property: channel.target().property(),
        steps: interpolation == Interpolation::Step,
        times: reader.read_inputs()?.collect(),
        values,
    })
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
        let mut bird =
            Self::read(&asset(&format!("birds/{name}.glb")), 0).expect("the bird is read");
        // Its body is a closed skin that needs no more feathers where it bends.
        bird.bird.pivots = Vec::new();
        bird.groom = groom;
        bird
    }

    /// Reads any skinned model in one binary glTF file, and moves it by one of its clips. Its groom is that of meshes without one.
    ///
    /// # Errors
    /// If the file cannot be read, or has no skin or no such clip.
    pub fn read(path: &Path, clip: usize) -> Result<Self, String> {
        let fail = |error: String| format!("{}: {error}", path.display());
        let bytes = std::fs::read(path).map_err(|error| fail(error.to_string()))?;
        let file = gltf::Gltf::from_slice(&bytes).map_err(|error| fail(error.to_string()))?;
        let bytes = file.blob.as_deref().unwrap_or_default();
        let missing = |what: &str| fail(format!("has no {what}"));
        let skin = file.skins().next().ok_or_else(|| missing("skin"))?;
        let joints: Vec<usize> = skin.joints().map(|joint| joint.index()).collect();
        let reader = skin.reader(|buffer| (buffer.index() == 0).then_some(bytes));
        let inverse_bind: Vec<Mat4> = match reader.read_inverse_bind_matrices() {
            Some(matrices) => matrices.map(|m| Mat4::from_cols_array_2d(&m)).collect(),
            None => vec![Mat4::IDENTITY; joints.len()],
        };
        let names = skin.joints();
        let names = names.map(|joint| joint.name().unwrap_or_default().to_owned());
        let mut parents = vec![None; file.nodes().len()];
        for node in file.nodes() {
            for child in node.children() {
                parents[child.index()] = Some(node.index());
            }
        }
        let local = |node: gltf::Node| {
            let (translation, rotation, scale) = node.transform().decomposed();
            Local {
                translation: translation.into(),
                rotation: Quat::from_array(rotation),
                scale: scale.into(),
            }
        };
        let primitives = file.meshes();
        let primitives: Vec<_> = primitives
            .flat_map(|mesh| mesh.primitives().collect::<Vec<_>>())
            .filter_map(|one| primitive(&one, bytes))
            .collect();
        // As the plugin does it: what has tracts is the body, if anything has.
        let has_tracts = |mesh: &Mesh| mesh.attribute(Mesh::ATTRIBUTE_UV_1).is_some();
        let any = primitives.iter().any(|(mesh, _)| has_tracts(mesh));
        let meshes: Vec<&Mesh> = primitives
            .iter()
            .map(|(mesh, _)| mesh)
            .filter(|mesh| !any || has_tracts(mesh))
            .collect();
        let skin = SkinMesh::from_meshes(&meshes, &[]).map_err(|error| fail(error.to_string()))?;
        let clip = file
            .animations()
            .nth(clip)
            .ok_or_else(|| missing("such clip"))?;
        let channels: Vec<Channel> = clip
            .channels()
            .filter_map(|one| channel(&one, bytes))
            .collect();
        let last = |channel: &Channel| channel.times.last().copied().unwrap_or(0.0);
        let pivot = |bind: &Mat4| bind.inverse().w_axis.truncate();
        let bird = Bird {
            skin,
            joints: names.collect(),
            pivots: inverse_bind.iter().map(pivot).collect(),
        };
        Ok(Self {
            groom: Groom::fallback(&bird.skin, &bird.joints),
            bird,
            duration: channels.iter().map(last).fold(0.0, f32::max),
            nodes: file.nodes().map(local).collect(),
            parts: primitives.into_iter().map(|(_, part)| part).collect(),
            inverse_bind,
            joints,
            parents,
            channels,
        })
    }

    /// Its coat.
    ///
    /// # Panics
    /// If the groom is damaged.
    pub fn groom(&self, seed: u64, density: f32) -> Coat {
        groom_bird(&self.bird, &self.groom, seed, density).expect("the bird is groomed")
    }

    /// Its coat as it is before it is settled.
    ///
    /// # Panics
    /// If the groom is damaged.
    pub fn groom_unsettled(&self, seed: u64, density: f32) -> Coat {
        groom_with(&self.bird, &self.groom, seed, density, false).expect("the bird is groomed")
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
            let share = if span > 0.0 && !channel.steps {
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
            "lesser_upper" | "marginal_upper" | "marginal_hand" | "elbow" => "wing coverts",
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
