//! The coat bound to the GPU: [`UndercoatMaterial`] for volumes and shells, [`StrandMaterial`] for single hairs.

use super::{UndercoatMode, pack::CELL};
use crate::shaders::{UNDERCOAT, UNDERCOAT_STRANDS};
use bevy::{
    material::OpaqueRendererMethod,
    mesh::{MeshVertexAttribute, MeshVertexBufferLayoutRef, VertexFormat},
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        render_resource::{
            AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
        },
        storage::ShaderBuffer,
    },
    shader::{ShaderDefVal, ShaderRef},
};

/// Samples of the mean column.
pub const COLUMN: usize = 32;

/// One coat as the shader reads it (`UndercoatUniform` in `undercoat_data.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, ShaderType)]
pub struct UndercoatUniform {
    /// Nodes of the shell, then prisms, `UndercoatView` and `UndercoatTier` as numbers.
    pub counts: UVec4,
    /// Steps to the eye, to the light, shells, 1: jitter.
    pub steps: UVec4,
    /// Linear albedo at the skin; largest extinction of the tile.
    pub colour: Vec4,
    /// Linear albedo of the tips; mean optical depth.
    pub tip_colour: Vec4,
    /// Linear albedo of the skin; depth at which rays are cut off.
    pub skin: Vec4,
    /// Spread of the tangents at skin and tips; share and exponent of the highlight.
    pub fibre: Vec4,
    /// Lean; thickness on the screen of near and of far; 1: the depth of the coat is written, 0: of the skin below, -1: of its top.
    pub shape: Vec4,
    /// Share by which the coat is seen, for the rest the painted skin; 1: the skin's colours tint the coat.
    pub paint: Vec4,
    /// [`TransferBands::vec4s`](super::transfer::TransferBands::vec4s).
    pub bands: [Vec4; 8],
    /// Mean optical depth above each height, in heights 0..1.
    pub column: [Vec4; COLUMN / 4],
    /// [`tier_correction`](super::tier::tier_correction): by the cosines of eye and light, then of the sky by that of the eye.
    pub correction: [Vec4; 18],
}

/// The shader picks the samples that a fragment covers itself: hardware rounds opacities to quarters, which leaves thin hairs out.
fn pick_samples(descriptor: &mut RenderPipelineDescriptor) {
    let samples = descriptor.multisample.count;
    descriptor.multisample.alpha_to_coverage_enabled = false;
    if samples > 1
        && let Some(fragment) = &mut descriptor.fragment
    {
        fragment.shader_defs.push("SAMPLE_COVERAGE".into());
        fragment
            .shader_defs
            .push(ShaderDefVal::UInt("UNDERCOAT_SAMPLES".into(), samples));
    }
}

/// What makes two coats want different pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct UndercoatKey {
    mode: UndercoatMode,
    sunk: bool,
}

impl From<&UndercoatMaterial> for UndercoatKey {
    fn from(material: &UndercoatMaterial) -> Self {
        Self {
            mode: material.mode,
            sunk: material.sunk,
        }
    }
}

/// One coat on one skin. The plugin makes one for every [`Undercoat`](super::Undercoat).
#[derive(Asset, TypePath, AsBindGroup, Clone, Debug)]
#[bind_group_data(UndercoatKey)]
pub struct UndercoatMaterial {
    /// How it is drawn.
    pub mode: UndercoatMode,
    /// Whether it lies below the skin of a bird: its depth is then that of its outside, sample by sample.
    pub sunk: bool,
    /// Look and quality.
    #[uniform(0)]
    pub uniform: UndercoatUniform,
    /// Nodes as the extrusion leaves them, and prisms.
    #[storage(1, read_only)]
    pub shell: Handle<ShaderBuffer>,
    /// Extinction of the tile over its largest.
    #[texture(2, dimension = "3d")]
    #[sampler(3)]
    pub density: Handle<Image>,
    /// Bent vector and openness.
    #[texture(4, dimension = "3d")]
    pub transfer: Handle<Image>,
}

impl Material for UndercoatMaterial {
    fn vertex_shader() -> ShaderRef {
        UNDERCOAT.into()
    }

    fn fragment_shader() -> ShaderRef {
        UNDERCOAT.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        match self.mode {
            UndercoatMode::Volume => AlphaMode::AlphaToCoverage,
            UndercoatMode::Shells => AlphaMode::Blend,
        }
    }

    fn opaque_render_method(&self) -> OpaqueRendererMethod {
        OpaqueRendererMethod::Forward
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _pipeline: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[CELL.at_shader_location(0)])?];
        if key.bind_group_data.sunk {
            let sunk = || ShaderDefVal::from("UNDERCOAT_SUNK");
            descriptor.vertex.shader_defs.push(sunk());
            descriptor
                .fragment
                .iter_mut()
                .for_each(|fragment| fragment.shader_defs.push(sunk()));
        }
        if let Some(fragment) = &mut descriptor.fragment
            && key.bind_group_data.mode == UndercoatMode::Shells
        {
            fragment.shader_defs.push("UNDERCOAT_SHELLS".into());
        } else {
            pick_samples(descriptor);
        }
        Ok(())
    }
}

/// (strand, segment and side) of a vertex of a strand.
pub const STRAND: MeshVertexAttribute = MeshVertexAttribute::new(
    "Undercoat_Strand",
    0x7c1f_93d2_40ab_5e02,
    VertexFormat::Uint32x2,
);

/// Strands as the shader reads them (`StrandUniform` in `undercoat_strands.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, ShaderType)]
pub struct StrandUniform {
    /// Nodes of the shell, prisms, strands, 1: a volume lies below.
    pub counts: UVec4,
    /// Linear albedo at the root; radius there, metres.
    pub colour: Vec4,
    /// Linear albedo of the tip; fading.
    pub tip_colour: Vec4,
    /// Lean, droop, share and exponent of the highlight.
    pub shape: Vec4,
    /// Mean optical depth of the coat above each height.
    pub column: [Vec4; COLUMN / 4],
}

/// The strands of one skin.
#[derive(Asset, TypePath, AsBindGroup, Clone, Debug)]
pub struct StrandMaterial {
    /// Look.
    #[uniform(0)]
    pub uniform: StrandUniform,
    /// Nodes as the extrusion leaves them, and prisms.
    #[storage(1, read_only, visibility(vertex))]
    pub shell: Handle<ShaderBuffer>,
    /// Roots: (prism, place, length, seed).
    #[storage(2, read_only, visibility(vertex))]
    pub roots: Handle<ShaderBuffer>,
}

impl Material for StrandMaterial {
    fn vertex_shader() -> ShaderRef {
        UNDERCOAT_STRANDS.into()
    }

    fn fragment_shader() -> ShaderRef {
        UNDERCOAT_STRANDS.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::AlphaToCoverage
    }

    fn opaque_render_method(&self) -> OpaqueRendererMethod {
        OpaqueRendererMethod::Forward
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _pipeline: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        _key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[STRAND.at_shader_location(0)])?];
        descriptor.primitive.cull_mode = None;
        pick_samples(descriptor);
        Ok(())
    }
}
