//! Writes a model as binary glTF.

use bevy::math::{Quat, Vec3};
use gltf_json as json;
use json::validation::Checked::Valid;
use json::validation::USize64;

use crate::idle;
use crate::maps::{self, Maps};
use crate::model::{Model, Part};
use crate::species::Species;

const METRES: f32 = 0.001;
const RATE: f32 = 30.0;

struct Writer {
    bin: Vec<u8>,
    root: json::Root,
}

impl Writer {
    fn view(
        &mut self,
        bytes: &[u8],
        target: Option<json::buffer::Target>,
    ) -> json::Index<json::buffer::View> {
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        self.root.push(json::buffer::View {
            buffer: json::Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        })
    }

    fn accessor(
        &mut self,
        bytes: &[u8],
        count: usize,
        kind: json::accessor::Type,
        component: json::accessor::ComponentType,
        target: Option<json::buffer::Target>,
        bounds: Option<(Vec<f32>, Vec<f32>)>,
    ) -> json::Index<json::Accessor> {
        let view = self.view(bytes, target);
        let (min, max) = bounds.unzip();
        self.root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: Some(USize64(0)),
            count: USize64::from(count),
            component_type: Valid(json::accessor::GenericComponentType(component)),
            type_: Valid(kind),
            min: min.map(|v| json::serialize::to_value(v).unwrap_or_default()),
            max: max.map(|v| json::serialize::to_value(v).unwrap_or_default()),
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        })
    }

    fn floats<const N: usize>(
        &mut self,
        rows: &[[f32; N]],
        attribute: bool,
        bounds: bool,
    ) -> json::Index<json::Accessor> {
        use json::accessor::Type;
        let bytes: Vec<u8> = rows
            .iter()
            .flatten()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let kind = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        let limits = bounds.then(|| {
            let fold = |start: f32, f: fn(f32, f32) -> f32| {
                (0..N)
                    .map(|i| rows.iter().map(|r| r[i]).fold(start, f))
                    .collect::<Vec<_>>()
            };
            (fold(f32::MAX, f32::min), fold(f32::MIN, f32::max))
        });
        let target = attribute.then_some(json::buffer::Target::ArrayBuffer);
        self.accessor(
            &bytes,
            rows.len(),
            kind,
            json::accessor::ComponentType::F32,
            target,
            limits,
        )
    }

    /// An image as a texture, in the file itself.
    fn texture(&mut self, image: &image::RgbImage) -> Result<json::Index<json::Texture>, String> {
        let view = self.view(&maps::png(image)?, None);
        let source = self.root.push(json::Image {
            buffer_view: Some(view),
            mime_type: Some(json::image::MimeType("image/png".to_string())),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        Ok(self.root.push(json::Texture {
            name: None,
            sampler: None,
            source,
            extensions: None,
            extras: Default::default(),
        }))
    }

    fn material(&mut self, part: &Part) -> Result<(), String> {
        let mut material = json::Material {
            name: Some(part.name.to_string()),
            pbr_metallic_roughness: json::material::PbrMetallicRoughness {
                roughness_factor: json::material::StrengthFactor(part.roughness),
                metallic_factor: json::material::StrengthFactor(0.0),
                ..Default::default()
            },
            ..Default::default()
        };
        if let Some(Maps {
            color,
            normal,
            surface,
        }) = &part.maps
        {
            let info = |index| json::texture::Info {
                index,
                tex_coord: 0,
                extensions: None,
                extras: Default::default(),
            };
            let surface = self.texture(surface)?;
            let pbr = &mut material.pbr_metallic_roughness;
            pbr.base_color_texture = Some(info(self.texture(color)?));
            pbr.metallic_roughness_texture = Some(info(surface));
            material.occlusion_texture = Some(json::material::OcclusionTexture {
                index: surface,
                strength: json::material::StrengthFactor(1.0),
                tex_coord: 0,
                extensions: None,
                extras: Default::default(),
            });
            material.normal_texture = Some(json::material::NormalTexture {
                index: self.texture(normal)?,
                scale: 1.0,
                tex_coord: 0,
                extensions: None,
                extras: Default::default(),
            });
        }
        self.root.push(material);
        Ok(())
    }

    fn primitive(&mut self, part: &Part, material: u32) -> json::mesh::Primitive {
        use json::mesh::Semantic;
        let p = &part.primitive;
        let v = &p.vertices;
        let position: Vec<[f32; 3]> = v.iter().map(|v| (v.position * METRES).to_array()).collect();
        let normal: Vec<[f32; 3]> = v.iter().map(|v| v.normal.to_array()).collect();
        let uv: Vec<[f32; 2]> = v.iter().map(|v| v.uv).collect();
        // Where a texture has the colors, vertices are white.
        let color: Vec<[f32; 4]> = v
            .iter()
            .map(|v| match part.maps {
                Some(_) => [1.0; 4],
                None => [v.color[0], v.color[1], v.color[2], 1.0],
            })
            .collect();
        let weights: Vec<[f32; 4]> = v.iter().map(|v| v.binding.1).collect();
        let joints: Vec<u8> = v
            .iter()
            .flat_map(|v| v.binding.0)
            .map(|j| j as u8)
            .collect();
        let mut attributes = vec![
            (Semantic::Positions, self.floats(&position, true, true)),
            (Semantic::Normals, self.floats(&normal, true, false)),
            (Semantic::TexCoords(0), self.floats(&uv, true, false)),
            (Semantic::Colors(0), self.floats(&color, true, false)),
            (Semantic::Weights(0), self.floats(&weights, true, false)),
        ];
        attributes.push((
            Semantic::Joints(0),
            self.accessor(
                &joints,
                v.len(),
                json::accessor::Type::Vec4,
                json::accessor::ComponentType::U8,
                Some(json::buffer::Target::ArrayBuffer),
                None,
            ),
        ));
        if part.maps.is_some() {
            let tangent: Vec<[f32; 4]> = v.iter().map(|v| v.tangent).collect();
            attributes.push((Semantic::Tangents, self.floats(&tangent, true, false)));
        }
        if part.skin {
            let tract: Vec<[f32; 2]> = v.iter().map(|v| v.tract).collect();
            attributes.push((Semantic::TexCoords(1), self.floats(&tract, true, false)));
        }
        let indices: Vec<u8> = p
            .triangles
            .iter()
            .flatten()
            .flat_map(|i| i.to_le_bytes())
            .collect();
        let indices = self.accessor(
            &indices,
            p.triangles.len() * 3,
            json::accessor::Type::Scalar,
            json::accessor::ComponentType::U32,
            Some(json::buffer::Target::ElementArrayBuffer),
            None,
        );
        json::mesh::Primitive {
            attributes: attributes.into_iter().map(|(s, a)| (Valid(s), a)).collect(),
            indices: Some(indices),
            material: Some(json::Index::new(material)),
            mode: Valid(json::mesh::Mode::Triangles),
            targets: None,
            extensions: None,
            extras: Default::default(),
        }
    }
}

fn node(name: &str) -> json::Node {
    json::Node {
        name: Some(name.to_string()),
        ..Default::default()
    }
}

/// The glb of a bird.
pub fn write(species: &Species, model: &Model) -> Result<Vec<u8>, String> {
    let mut w = Writer {
        bin: Vec::new(),
        root: json::Root::default(),
    };
    w.root.asset.version = "2.0".to_string();
    w.root.asset.generator = Some("bevy_plumage bake_birds".to_string());
    let mut primitives = Vec::new();
    for (i, part) in model.parts.iter().enumerate() {
        w.material(part)?;
        primitives.push(w.primitive(part, i as u32));
    }
    let hard = primitives.split_off(1);
    for (name, primitives) in [("body", primitives), ("parts", hard)] {
        w.root.push(json::Mesh {
            name: Some(name.to_string()),
            primitives,
            weights: None,
            extensions: None,
            extras: Default::default(),
        });
    }
    // Joint nodes come first, so that joint i is node i.
    let joints = &model.skeleton.joints;
    for (i, j) in joints.iter().enumerate() {
        let children: Vec<_> = (0..joints.len())
            .filter(|k| joints[*k].parent == Some(i))
            .map(|k| json::Index::new(k as u32))
            .collect();
        w.root.push(json::Node {
            translation: Some((model.skeleton.offset(i) * METRES).to_array()),
            children: (!children.is_empty()).then_some(children),
            ..node(&j.name)
        });
    }
    let inverse: Vec<[f32; 16]> = joints
        .iter()
        .map(|j| bevy::math::Mat4::from_translation(-j.position * METRES).to_cols_array())
        .collect();
    let inverse = w.floats(&inverse, false, false);
    let skin = w.root.push(json::Skin {
        name: Some(species.name.to_string()),
        inverse_bind_matrices: Some(inverse),
        joints: (0..joints.len())
            .map(|i| json::Index::new(i as u32))
            .collect(),
        skeleton: Some(json::Index::new(0)),
        extensions: None,
        extras: Default::default(),
    });
    let mut roots = vec![json::Index::new(0)];
    for (i, name) in ["body", "parts"].iter().enumerate() {
        roots.push(w.root.push(json::Node {
            mesh: Some(json::Index::new(i as u32)),
            skin: Some(skin),
            ..node(name)
        }));
    }
    let bird = w.root.push(json::Node {
        children: Some(roots),
        ..node(species.name)
    });
    let scene = w.root.push(json::Scene {
        name: Some(species.name.to_string()),
        nodes: vec![bird],
        extensions: None,
        extras: Default::default(),
    });
    w.root.scene = Some(scene);
    animate(&mut w, species, model);
    w.root.buffers.push(json::Buffer {
        byte_length: USize64::from(w.bin.len()),
        name: None,
        uri: None,
        extensions: None,
        extras: Default::default(),
    });
    let mut text = w
        .root
        .to_vec()
        .map_err(|e| format!("{}: {e}", species.name))?;
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let total = 12 + 8 + text.len() + 8 + w.bin.len();
    let mut out = Vec::with_capacity(total);
    for v in [
        0x4654_6C67_u32,
        2,
        total as u32,
        text.len() as u32,
        0x4E4F_534A,
    ] {
        out.extend_from_slice(&v.to_le_bytes());
    }
    out.extend_from_slice(&text);
    for v in [w.bin.len() as u32, 0x004E_4942] {
        out.extend_from_slice(&v.to_le_bytes());
    }
    out.extend_from_slice(&w.bin);
    Ok(out)
}

/// Samples the idle clip; only joints that move, or that rest away from their bind pose, get channels.
fn animate(w: &mut Writer, species: &Species, model: &Model) {
    let frames = (species.motion.seconds * RATE).round() as usize;
    let times: Vec<[f32; 1]> = (0..=frames).map(|i| [i as f32 / RATE]).collect();
    let mut poses: Vec<_> = times
        .iter()
        .map(|t| idle::pose(species, &model.skeleton, t[0]))
        .collect();
    if let Some(first) = poses.first().cloned() {
        // The clip loops: its last key is its first.
        poses[frames] = first;
    }
    let dense = w.floats(&times, false, true);
    let ends = w.floats(&[[0.0], [frames as f32 / RATE]], false, true);
    let mut samplers = Vec::new();
    let mut channels = Vec::new();
    for (i, _) in model.skeleton.joints.iter().enumerate() {
        let rest = model.skeleton.offset(i);
        let translations: Vec<[f32; 3]> = poses
            .iter()
            .map(|p| ((rest + p.offset[i]) * METRES).to_array())
            .collect();
        let mut last = Quat::IDENTITY;
        let rotations: Vec<[f32; 4]> = poses
            .iter()
            .map(|p| {
                let q = p.rotation[i];
                last = if q.dot(last) < 0.0 { -q } else { q };
                last.to_array()
            })
            .collect();
        let scales: Vec<[f32; 3]> = poses.iter().map(|p| p.scale[i].to_array()).collect();
        let still = (rest * METRES).to_array();
        add(
            w,
            dense,
            ends,
            i,
            json::animation::Property::Translation,
            &translations,
            still,
            &mut samplers,
            &mut channels,
        );
        add(
            w,
            dense,
            ends,
            i,
            json::animation::Property::Rotation,
            &rotations,
            [0., 0., 0., 1.],
            &mut samplers,
            &mut channels,
        );
        add(
            w,
            dense,
            ends,
            i,
            json::animation::Property::Scale,
            &scales,
            Vec3::ONE.to_array(),
            &mut samplers,
            &mut channels,
        );
    }
    w.root.push(json::Animation {
        name: Some("idle".to_string()),
        channels,
        samplers,
        extensions: None,
        extras: Default::default(),
    });
}

fn add<const N: usize>(
    w: &mut Writer,
    dense: json::Index<json::Accessor>,
    ends: json::Index<json::Accessor>,
    joint: usize,
    path: json::animation::Property,
    values: &[[f32; N]],
    still: [f32; N],
    samplers: &mut Vec<json::animation::Sampler>,
    channels: &mut Vec<json::animation::Channel>,
) {
    let near = |a: &[f32; N], b: &[f32; N]| a.iter().zip(b).all(|(u, v)| (u - v).abs() < 1e-6);
    if values.iter().all(|v| near(v, &still)) {
        return;
    }
    let (input, output) = if values.iter().all(|v| near(v, &values[0])) {
        (ends, w.floats(&[values[0], values[0]], false, false))
    } else {
        (dense, w.floats(values, false, false))
    };
    channels.push(json::animation::Channel {
        sampler: json::Index::new(samplers.len() as u32),
        target: json::animation::Target {
            node: json::Index::new(joint as u32),
            path: Valid(path),
            extensions: None,
            extras: Default::default(),
        },
        extensions: None,
        extras: Default::default(),
    });
    samplers.push(json::animation::Sampler {
        input,
        interpolation: Valid(json::animation::Interpolation::Linear),
        output,
        extensions: None,
        extras: Default::default(),
    });
}
