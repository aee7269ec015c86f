//! Meshes as the search for hidden cards reads them (docs/book/lod.md#hidden-cards): where their vertices are in Bevy's buffers.

use crate::groom::ATTRIBUTE_RAISED;
use bevy::{
    mesh::MeshVertexAttribute,
    prelude::*,
    render::{
        mesh::{RenderMesh, allocator::MeshAllocator, allocator::MeshBufferSlice},
        render_asset::RenderAssets,
        render_resource::{
            BindingResource, Buffer, BufferBinding, BufferSize, BufferUsages, VertexFormat,
        },
        renderer::RenderDevice,
    },
};

/// Stands for what is not there.
pub const NOTHING: u32 = u32::MAX;
/// Texels of the grid over a bird along a side.
pub const GRID: u64 = 256;
/// First texel in the buffer of counters, bounds and texels.
const FIRST_TEXEL: u64 = 16;
/// Bytes of that buffer without its texels.
pub const COUNTER_BYTES: u64 = 4 * FIRST_TEXEL;
/// Bytes of it whole.
pub const GRID_BYTES: u64 = COUNTER_BYTES + 4 * GRID * GRID;
/// vec4s that are kept of a card while the pass runs.
pub const MEASURED: u64 = 2;

/// What is needed to find meshes in Bevy's buffers.
pub struct Meshes<'a> {
    pub meshes: &'a RenderAssets<RenderMesh>,
    pub allocator: &'a MeshAllocator,
    pub device: &'a RenderDevice,
}

/// A part of a buffer that is bound: buffer, offset, bytes.
#[derive(Clone, Copy)]
pub struct Slice<'a>(&'a Buffer, u64, u64);

impl<'a> From<Slice<'a>> for BindingResource<'a> {
    fn from(Slice(buffer, offset, bytes): Slice<'a>) -> Self {
        Self::Buffer(BufferBinding {
            buffer,
            offset,
            size: BufferSize::new(bytes),
        })
    }
}

/// Where the vertices of a mesh are in the part that is bound, in words of four bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexPlaces {
    /// First vertex.
    pub first_word: u32,
    /// Size of a vertex.
    pub stride: u32,
    /// In a vertex, whose place comes first: normal, [`NOTHING`] where it has none, as of the next ones.
    pub normal: u32,
    /// Joints.
    pub joints: u32,
    /// Their weights.
    pub weights: u32,
    /// What it keeps of the poses.
    pub raised: u32,
}

impl VertexPlaces {
    /// Of no mesh.
    pub const NONE: Self = Self {
        first_word: 0,
        stride: 0,
        normal: NOTHING,
        joints: NOTHING,
        weights: NOTHING,
        raised: NOTHING,
    };
}

impl<'a> Meshes<'a> {
    /// A slice from element `first` on, `stride` bytes each, and how many words into the part bound that one is; none where Bevy's buffer
    /// cannot be bound.
    pub fn bind(
        &self,
        slice: &MeshBufferSlice<'a>,
        first: u64,
        stride: u64,
    ) -> Option<(Slice<'a>, u32)> {
        let limits = self.device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment).max(4);
        let start = first * stride;
        let offset = start / alignment * alignment;
        let end = (u64::from(slice.range.end) * stride).next_multiple_of(4);
        let bytes = end.min(slice.buffer.size()) - offset;
        let fits = bytes <= limits.max_storage_buffer_binding_size
            && start.is_multiple_of(4)
            && slice.buffer.usage().contains(BufferUsages::STORAGE);
        let words = ((start - offset) / 4) as u32;
        fits.then_some((Slice(slice.buffer, offset, bytes), words))
    }

    /// The vertices of a mesh; none where they cannot be bound or are not as glTF and the plugin make them.
    pub fn vertices(&self, mesh: AssetId<Mesh>) -> Option<(VertexPlaces, Slice<'a>)> {
        let layout = &self.meshes.get(mesh)?.layout;
        let find = |attribute: MeshVertexAttribute, format: VertexFormat| {
            let found = layout.0.get_layout(&[attribute.at_shader_location(0)]);
            let found = found.ok().map(|found| found.attributes[0]);
            match found {
                Some(found) if found.format == format => Some((found.offset / 4) as u32),
                Some(_) => None,
                None => Some(NOTHING),
            }
        };
        let stride = layout.0.layout().array_stride;
        let slice = self.allocator.mesh_vertex_slice(&mesh)?;
        let (bound, first_word) = self.bind(&slice, u64::from(slice.range.start), stride)?;
        if find(Mesh::ATTRIBUTE_POSITION, VertexFormat::Float32x3)? != 0
            || !stride.is_multiple_of(4)
        {
            return None;
        }
        let places = VertexPlaces {
            first_word,
            stride: (stride / 4) as u32,
            normal: find(Mesh::ATTRIBUTE_NORMAL, VertexFormat::Float32x3)?,
            joints: find(Mesh::ATTRIBUTE_JOINT_INDEX, VertexFormat::Uint16x4)?,
            weights: find(Mesh::ATTRIBUTE_JOINT_WEIGHT, VertexFormat::Float32x4)?,
            raised: find(ATTRIBUTE_RAISED, VertexFormat::Uint16x4)?,
        };
        Some((places, bound))
    }
}
