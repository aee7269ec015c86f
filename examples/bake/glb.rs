//! The cards as binary glTF 2.0: one mesh, one material, and the skeleton in the pose of its file.

use super::{atlas::Atlas, gather::Bird};
use bevy::prelude::*;
use serde_json::{Value, json};

/// Numbers of OpenGL for types and uses.
const FLOAT: u32 = 5126;
const SHORT: u32 = 5123;
const INT: u32 = 5125;
const VERTICES: u32 = 34_962;
const CORNERS: u32 = 34_963;

/// The file's bytes, and what they are.
#[derive(Default)]
struct Bytes {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Bytes {
    fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<u32>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({
            "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start,
        });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, kind: u32, of: &str, count: usize) -> usize {
        self.accessors.push(json!({
            "bufferView": view, "componentType": kind, "type": of, "count": count,
        }));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, rows: &[[f32; N]], target: Option<u32>) -> usize {
        let bytes: Vec<u8> = rows
            .iter()
            .flatten()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let view = self.view(bytes, target);
        let of = match N {
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        self.accessor(view, FLOAT, of, rows.len())
    }
}

/// The file.
pub fn write(bird: &Bird, atlas: &Atlas) -> Result<Vec<u8>, String> {
    let mut bytes = Bytes::default();
    let count = bird.positions.len();
    let mut uvs = vec![[0.0; 2]; count];
    let mut colors = vec![[1.0; 3]; count];
    for (number, (card, block)) in bird.cards.iter().zip(&bird.geometry).enumerate() {
        for i in block.first_vertex..block.first_vertex + block.vertex_count {
            let i = i as usize;
            uvs[i] = atlas.place(usize::from(card.feather), bird.uvs[i]);
            colors[i] = atlas.colors[number];
        }
    }
    let normals: Vec<[f32; 3]> = bird
        .normals
        .iter()
        .map(|n| Vec3::from_array(*n).normalize_or(Vec3::Y).to_array())
        .collect();
    let mut attributes = json!({
        "POSITION": bytes.floats(&bird.positions, Some(VERTICES)),
        "NORMAL": bytes.floats(&normals, Some(VERTICES)),
        "TEXCOORD_0": bytes.floats(&uvs, Some(VERTICES)),
        "COLOR_0": bytes.floats(&colors, Some(VERTICES)),
    });
    let bound = |pick: fn(Vec3, Vec3) -> Vec3| {
        let places = bird.positions.iter().copied().map(Vec3::from_array);
        places.reduce(pick).unwrap_or_default().to_array()
    };
    let position = attributes["POSITION"].as_u64().unwrap_or(0) as usize;
    bytes.accessors[position]["min"] = json!(bound(Vec3::min));
    bytes.accessors[position]["max"] = json!(bound(Vec3::max));
    let skinned = !bird.joints.is_empty();
    if skinned {
        // A joint without a weight is no joint.
        let joints = bird.joint_indices.iter().zip(&bird.joint_weights);
        let joints: Vec<u8> = joints
            .flat_map(|(joints, weights)| {
                let kept = |k: usize| if weights[k] > 0.0 { joints[k] } else { 0 };
                [0, 1, 2, 3].map(kept)
            })
            .flat_map(u16::to_le_bytes)
            .collect();
        let view = bytes.view(joints, Some(VERTICES));
        attributes["JOINTS_0"] = json!(bytes.accessor(view, SHORT, "VEC4", count));
        attributes["WEIGHTS_0"] = json!(bytes.floats(&bird.joint_weights, Some(VERTICES)));
    }
    let corners = bird.indices.iter().flat_map(|i| i.to_le_bytes());
    let view = bytes.view(corners, Some(CORNERS));
    let indices = bytes.accessor(view, INT, "SCALAR", bird.indices.len());
    let mut nodes = vec![json!({"name": "Plumage", "mesh": 0})];
    let mut roots = vec![0];
    let mut root = json!({"asset": {"version": "2.0", "generator": "bevy_plumage bake"}});
    if skinned {
        nodes[0]["skin"] = json!(0);
        skeleton(bird, &mut nodes, &mut roots);
        let bind: Vec<[f32; 16]> = bird
            .joints
            .iter()
            .map(|joint| {
                let mut bind = joint.inverse_bind;
                // The format wants the last row to be exactly that of an affine map.
                for (column, last) in [0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
                    bind.col_mut(column).w = last;
                }
                bind.to_cols_array()
            })
            .collect();
        root["skins"] = json!([{
            "joints": (1..=bird.joints.len()).collect::<Vec<_>>(),
            "inverseBindMatrices": bytes.floats(&bind, None),
        }]);
    } else {
        nodes[0]["matrix"] = json!(bird.place.to_cols_array());
    }
    let picture = bytes.view(atlas.png.iter().copied(), None);
    root["scene"] = json!(0);
    root["scenes"] = json!([{"nodes": roots}]);
    root["nodes"] = json!(nodes);
    root["meshes"] = json!([{"name": "Plumage", "primitives": [{
        "attributes": attributes, "indices": indices, "material": 0,
    }]}]);
    root["materials"] = json!([{
        "name": "Feathers",
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicFactor": 0.0, "roughnessFactor": 0.8,
        },
        "alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true,
    }]);
    root["textures"] = json!([{"source": 0, "sampler": 0}]);
    // Linear with mip maps, not beyond the edges.
    root["samplers"] = json!([{
        "magFilter": 9729, "minFilter": 9987, "wrapS": 33_071, "wrapT": 33_071,
    }]);
    root["images"] = json!([{"bufferView": picture, "mimeType": "image/png"}]);
    root["accessors"] = json!(bytes.accessors);
    root["bufferViews"] = json!(bytes.views);
    root["buffers"] = json!([{"byteLength": bytes.bytes.len()}]);
    let text = serde_json::to_vec(&root).map_err(|error| error.to_string())?;
    Ok(container(text, &bytes.bytes))
}

/// Joints as nodes 1, 2, ... below one another.
fn skeleton(bird: &Bird, nodes: &mut Vec<Value>, roots: &mut Vec<usize>) {
    let mut children = vec![Vec::new(); bird.joints.len()];
    for (number, joint) in bird.joints.iter().enumerate() {
        let local = match joint.parent {
            Some(parent) => {
                children[parent].push(number + 1);
                bird.joints[parent].global.inverse() * joint.global
            }
            None => {
                roots.push(number + 1);
                joint.global
            }
        };
        let (scale, rotation, translation) = local.to_scale_rotation_translation();
        nodes.push(json!({
            "name": joint.name,
            "scale": scale.to_array(),
            "rotation": rotation.normalize().to_array(),
            "translation": translation.to_array(),
        }));
    }
    for (number, children) in children.into_iter().enumerate() {
        if !children.is_empty() {
            nodes[number + 1]["children"] = json!(children);
        }
    }
}

/// Header, text and bytes.
fn container(mut text: Vec<u8>, bytes: &[u8]) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + bytes.len();
    let mut file = Vec::with_capacity(total);
    file.extend(b"glTF");
    for word in [2, total as u32, text.len() as u32] {
        file.extend(word.to_le_bytes());
    }
    file.extend(b"JSON");
    file.extend(text);
    file.extend((bytes.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(bytes);
    file
}
