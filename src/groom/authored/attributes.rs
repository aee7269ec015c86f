//! Vertex attributes of glTF files that say something about feathers, from the file's own bytes: in any number format, whatever the app has
//! registered with Bevy's loader.

use super::SkinMasks;
use bevy::{
    asset::LoadContext,
    ecs::world::EntityWorldMut,
    gltf::{
        extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler, GltfExtensionHandlers},
        gltf::{Gltf, Material, Mesh as GltfMesh, Primitive},
    },
    mesh::{Mesh, MeshVertexAttribute},
    platform::collections::HashMap,
    tasks::{ConditionalSendFuture, block_on},
};

/// What Bevy reads by itself.
const BEVYS: [&str; 8] = [
    "POSITION",
    "NORMAL",
    "TANGENT",
    "COLOR_0",
    "TEXCOORD_0",
    "TEXCOORD_1",
    "JOINTS_0",
    "WEIGHTS_0",
];

/// Reads the attributes of files from now on.
pub(in crate::groom) fn read_attributes(handlers: &GltfExtensionHandlers) {
    let mut list = block_on(handlers.0.write());
    list.push(Box::new(FeatherAttributes::default()));
}

/// Masks of a file that is being loaded, by mesh and primitive.
#[derive(Clone, Default)]
struct FeatherAttributes(HashMap<(usize, usize), SkinMasks>);

impl GltfExtensionHandler for FeatherAttributes {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_gltf_primitive(
        &mut self,
        _: &mut LoadContext<'_>,
        _: &Gltf,
        mesh: &GltfMesh,
        primitive: &Primitive,
        buffers: &[Vec<u8>],
        registered: &HashMap<Box<str>, MeshVertexAttribute>,
        _: bool,
        _: bool,
        _: &mut Option<Mesh>,
    ) -> impl ConditionalSendFuture<Output = ()> {
        let masks = masks(primitive, buffers, |name| registered.contains_key(name));
        if masks != SkinMasks::default() {
            self.0.insert((mesh.index(), primitive.index()), masks);
        }
        async {}
    }

    fn on_spawn_mesh_and_material(
        &mut self,
        _: &mut LoadContext<'_>,
        primitive: &Primitive,
        mesh: &GltfMesh,
        _: &Material,
        entity: &mut EntityWorldMut,
        _: &str,
    ) {
        if let Some(masks) = self.0.get(&(mesh.index(), primitive.index())) {
            entity.insert(masks.clone());
        }
    }
}

/// What the attributes of a primitive say.
fn masks(
    primitive: &Primitive,
    buffers: &[Vec<u8>],
    registered: impl Fn(&str) -> bool,
) -> SkinMasks {
    let mut masks = SkinMasks::default();
    let has_normals = primitive
        .attributes()
        .any(|(semantic, _)| semantic.to_string() == "NORMAL");
    // Bevy gives meshes without normals a vertex for each corner.
    let corners: Option<Vec<u32>> = if has_normals {
        None
    } else {
        let bytes = |index: usize| buffers.get(index).map(Vec::as_slice);
        let reader = primitive.reader(|buffer| bytes(buffer.index()));
        reader.read_indices().map(|list| list.into_u32().collect())
    };
    for (semantic, accessor) in primitive.attributes() {
        let name = semantic.to_string();
        if BEVYS.contains(&name.as_str()) {
            continue;
        }
        let wide = accessor.dimensions().multiplicity();
        let kind = accessor.data_type().as_gl_enum();
        let read = || {
            let view = accessor.view()?;
            let (size, whole) = format(kind)?;
            let bytes = buffers.get(view.buffer().index())?;
            let start = view.offset() + accessor.offset();
            let stride = view.stride().unwrap_or(size * wide);
            let whole = if accessor.normalized() { whole } else { 1.0 };
            let places = 0..accessor.count();
            let value = |i: usize, k: usize| {
                let at = start + i * stride + k * size;
                Some(number(kind, bytes.get(at..at + size)?) / whole)
            };
            let rows: Option<Vec<[f32; 3]>> = places
                .map(|i| {
                    let mut row = [0.0; 3];
                    for (k, x) in row.iter_mut().enumerate().take(wide) {
                        *x = value(i, k)?;
                    }
                    Some(row)
                })
                .collect();
            let rows = rows?;
            let Some(corners) = &corners else {
                return Some(rows);
            };
            let corner = |corner: &u32| rows.get(*corner as usize).copied();
            corners.iter().map(corner).collect()
        };
        let mut refuse = |why: &str| masks.unread.push(format!("{name} ({why})"));
        let single = match name.to_ascii_uppercase().as_str() {
            "_DENSITY" => &mut masks.density,
            "_LENGTH" => &mut masks.length,
            "_LIFT" => &mut masks.lift,
            "_TRACT" => &mut masks.tract,
            "_LAY" if wide < 3 => {
                refuse("three numbers are wanted");
                continue;
            }
            "_LAY" => {
                match read() {
                    Some(rows) => masks.lay = rows,
                    None => refuse("its bytes cannot be read"),
                }
                continue;
            }
            _ => {
                if !registered(&name) && !registered(name.trim_start_matches('_')) {
                    masks.unread.push(name);
                }
                continue;
            }
        };
        match read() {
            Some(rows) => *single = rows.iter().map(|row| row[0]).collect(),
            None => masks
                .unread
                .push(format!("{name} (its bytes cannot be read)")),
        }
    }
    masks
}

/// Bytes of a number, and what counts as 1 where numbers are normalized, by OpenGL's name for its type.
fn format(kind: u32) -> Option<(usize, f32)> {
    match kind {
        5120 => Some((1, 127.0)),
        5121 => Some((1, 255.0)),
        5122 => Some((2, 32_767.0)),
        5123 => Some((2, 65_535.0)),
        5125 => Some((4, 4_294_967_295.0)),
        5126 => Some((4, 1.0)),
        _ => None,
    }
}

fn number(kind: u32, bytes: &[u8]) -> f32 {
    match (kind, bytes) {
        (5120, [a]) => f32::from(i8::from_le_bytes([*a])),
        (5121, [a]) => f32::from(*a),
        (5122, [a, b]) => f32::from(i16::from_le_bytes([*a, *b])),
        (5123, [a, b]) => f32::from(u16::from_le_bytes([*a, *b])),
        (5125, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
        (_, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
        _ => f32::NAN,
    }
}
