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
    /// Nodes of the shell; at least 1.
    pub node_count: u32,
    /// Prisms of the shell; at least 1.
    pub prism_count: u32,
    /// [`UndercoatView`](super::UndercoatView) as a number.
    pub view: u32,
    /// [`UndercoatTier`](super::UndercoatTier) as a number.
    pub tier: u32,
    /// Steps of a ray to the eye.
    pub eye_steps: u32,
    /// Steps of a ray to a light.
    pub light_steps: u32,
    /// Shells drawn, where the coat is drawn as shells.
    pub shell_count: u32,
    /// 1: rays begin at a random part of a step.
    pub jitter: u32,
    /// Linear albedo at the skin.
    pub color: Vec3,
    /// Largest extinction of the tile.
    pub largest_extinction: f32,
    /// Linear albedo of the tips.
    pub tip_color: Vec3,
    /// Mean optical depth of the tile.
    pub mean_depth: f32,
    /// Linear albedo of the skin.
    pub skin_color: Vec3,
    /// Optical depth at which rays are cut off.
    pub depth_clip: f32,
    /// Spread of the tangents at the skin.
    pub skin_spread: f32,
    /// Spread of the tangents at the tips.
    pub tip_spread: f32,
    /// Share of the light that the highlight mirrors.
    pub highlight_strength: f32,
    /// Exponent of the highlight.
    pub highlight_exponent: f32,
    /// How far the tips lean along the lay.
    pub lean: f32,
    /// Height on the screen above which the coat is of the near tier, pixels.
    pub near_px: f32,
    /// Height on the screen below which it is of the far tier, pixels.
    pub far_px: f32,
    /// 1: the depth of the coat is written; 0: that of the skin below it.
    pub own_depth: u32,
    /// Share by which the coat is seen, for the rest the painted skin.
    pub shown: f32,
    /// Share by which the skin's colors tint the coat.
    pub tinted: f32,
    /// [`TransferBands::vec4s`](crate::maths::undercoat::transfer::TransferBands::vec4s).
    pub bands: [Vec4; 8],
    /// Mean optical depth above each height, in heights 0..1.
    pub column: [Vec4; COLUMN / 4],
    /// [`tier_correction`](crate::maths::undercoat::tier::tier_correction): by the cosines of eye and light, then of the sky by that of the eye.
    pub correction: [Vec4; 18],
}

/// The shader picks the samples that a fragment covers itself: hardware rounds opacities to quarters, which leaves thin hairs out.
fn pick_samples(descriptor: &mut RenderPipelineDescriptor) {
    let samples = descriptor.multisample.count;
    descriptor.multisample.alpha_to_coverage_enabled = false;
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader_defs.extend(sample_defs(samples));
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
        let defs = coat_defs(key.bind_group_data.mode, key.bind_group_data.sunk);
        descriptor.vertex.shader_defs.extend(defs.clone());
        if let Some(fragment) = &mut descriptor.fragment {
            fragment.shader_defs.extend(defs);
        }
        if key.bind_group_data.mode != UndercoatMode::Shells {
            pick_samples(descriptor);
        }
        Ok(())
    }
}

/// Definitions of both stages of a coat.
fn coat_defs(mode: UndercoatMode, sunk: bool) -> Vec<ShaderDefVal> {
    let mut defs = Vec::new();
    if sunk {
        defs.push("UNDERCOAT_SUNK".into());
    }
    if mode == UndercoatMode::Shells {
        defs.push("UNDERCOAT_SHELLS".into());
    }
    defs
}

/// Definitions by which a fragment picks the samples that it covers.
fn sample_defs(samples: u32) -> Vec<ShaderDefVal> {
    if samples > 1 {
        vec![
            "SAMPLE_COVERAGE".into(),
            ShaderDefVal::UInt("UNDERCOAT_SAMPLES".into(), samples),
        ]
    } else {
        Vec::new()
    }
}

/// Definitions of every coat, then of strands, that the plugin makes a pipeline for: `samples` is a number above 1.
#[cfg(feature = "internals")]
pub(super) fn fragment_defs(samples: u32) -> [Vec<Vec<ShaderDefVal>>; 2] {
    let mut coats = Vec::new();
    for sunk in [false, true] {
        coats.push(coat_defs(UndercoatMode::Shells, sunk));
        for count in [1, samples] {
            let mut defs = coat_defs(UndercoatMode::Volume, sunk);
            defs.extend(sample_defs(count));
            coats.push(defs);
        }
    }
    [coats, [1, samples].map(sample_defs).to_vec()]
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
    /// Nodes of the shell; at least 1.
    pub node_count: u32,
    /// Prisms of the shell; at least 1.
    pub prism_count: u32,
    /// Linear albedo at the root.
    pub color: Vec3,
    /// Radius at the root, metres.
    pub radius: f32,
    /// Linear albedo of the tip.
    pub tip_color: Vec3,
    /// Share of its length over which a strand fades.
    pub fade: f32,
    /// How far strands lean along the lay.
    pub lean: f32,
    /// How far gravity bends them.
    pub droop: f32,
    /// Share of the light that the highlight mirrors.
    pub highlight_strength: f32,
    /// Exponent of the highlight.
    pub highlight_exponent: f32,
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
