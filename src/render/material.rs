//! [`FeatherMaterial`]: the look bound to the GPU.

use crate::query::ErrorBudget;
use crate::shaders::{FEATHER, FEATHER_PREPASS, FEATHER_VERTEX};
use bevy::{
    mesh::MeshVertexBufferLayoutRef,
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
use serde::{Deserialize, Serialize};

/// How what lies behind a feather shows through it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FeatherTransparency {
    /// Coverage becomes MSAA samples: no sorting, writes depth. Wants `Msaa::Sample4`; with `Msaa::Off` it cuts out at one half.
    #[default]
    AlphaToCoverage,
    /// Blended; the camera's order-independent transparency sorts the fragments if it has it.
    Blend,
}

/// How the shader finds the coverage of a pixel's footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CoverageMethod {
    /// The cheapest evaluator within the error budget ([`crate::query::choose`]).
    #[default]
    Chosen,
    /// The paper's own: spatial domain by Gauss-Legendre near, frequency domain far, a hard switch between them
    /// ([`crate::query::published`]). For comparison only.
    Published,
    /// 1,024 point queries per footprint: slow, the truth that the others are compared with.
    Supersampled,
}

/// What a feather shows instead of its shaded colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum DebugView {
    /// Shaded.
    #[default]
    None,
    /// Coverage: rachis and barbs red, distal barbules green, proximal barbules blue.
    Coverage,
    /// LOD: near red, far green, mean blue, mixed white.
    Lod,
    /// A colour per card.
    Card,
    /// The layer, black (low) to white.
    Layer,
    /// The world normal of the card.
    Normal,
}

/// Quality of all feathers of a bird.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FeatherSettings {
    /// Largest error of coverage that a cheaper evaluator may bring, 0.0005..0.05 (half an 8-bit step, 1/510). One number sets the
    /// thresholds of the LOD and how finely near footprints are resolved.
    pub error_budget: f32,
    /// Strength of the light that reaches a feather through its neighbours, 0..1: scattered light between feathers (0.5).
    pub multiple_scattering: f32,
    /// Share of the sky that the feathers above hide at a feather's root, 0..1 (0.55); falls to nothing towards the tip. 0 for a
    /// feather on its own.
    pub shelter: f32,
    /// Vary the alpha by a fixed pattern before it becomes MSAA samples, so that its mean is right.
    pub dither: bool,
    /// What is shown.
    pub debug_view: DebugView,
    /// How coverage is found.
    pub coverage_method: CoverageMethod,
    /// Samples of the environment map per pixel, 0..64, by importance; 0 (default) takes Bevy's prefiltered maps instead.
    pub environment_samples: u32,
}

impl FeatherSettings {
    /// Threshold of the chooser (range query study, sec. 4) for the error budget.
    pub fn threshold(&self) -> f32 {
        ErrorBudget::new(self.error_budget.clamp(5e-4, 0.05)).threshold()
    }
}

impl Default for FeatherSettings {
    fn default() -> Self {
        Self {
            error_budget: 1.0 / 510.0,
            multiple_scattering: 0.5,
            shelter: 0.55,
            dither: true,
            debug_view: DebugView::None,
            coverage_method: CoverageMethod::Chosen,
            environment_samples: 0,
        }
    }
}

/// [`FeatherSettings`] as the shaders read them.
#[derive(Clone, Copy, Debug, PartialEq, ShaderType)]
pub struct GpuFeatherSettings {
    /// Threshold of the chooser that `FeatherSettings::error_budget` comes to.
    pub threshold: f32,
    /// `FeatherSettings::multiple_scattering`.
    pub multiple_scattering: f32,
    /// `FeatherSettings::shelter`.
    pub shelter: f32,
    /// 1: dither.
    pub dither: u32,
    /// `DebugView` as a number.
    pub debug_view: u32,
    /// `FeatherSettings::environment_samples`.
    pub environment_samples: u32,
}

impl From<&FeatherSettings> for GpuFeatherSettings {
    fn from(settings: &FeatherSettings) -> Self {
        Self {
            threshold: settings.threshold(),
            multiple_scattering: settings.multiple_scattering.clamp(0.0, 1.0),
            shelter: settings.shelter.clamp(0.0, 1.0),
            dither: u32::from(settings.dither),
            debug_view: settings.debug_view as u32,
            environment_samples: settings.environment_samples.min(64),
        }
    }
}

/// What makes two feather materials want different pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FeatherPipelineKey {
    /// `FeatherSettings::coverage_method`.
    pub coverage_method: CoverageMethod,
    /// `FeatherMaterial::transparency`.
    pub transparency: FeatherTransparency,
    /// The environment map is sampled by importance.
    pub sampled_environment: bool,
}

impl FeatherPipelineKey {
    /// Shader definitions of the main pass.
    fn shader_defs(&self) -> Vec<ShaderDefVal> {
        let mut defs = Vec::new();
        match self.coverage_method {
            CoverageMethod::Chosen => {}
            CoverageMethod::Published => defs.push("PUBLISHED_COVERAGE".into()),
            CoverageMethod::Supersampled => defs.push("SUPERSAMPLED_COVERAGE".into()),
        }
        if self.sampled_environment {
            defs.push("SAMPLED_ENVIRONMENT".into());
        }
        defs
    }
}

impl From<&FeatherMaterial> for FeatherPipelineKey {
    fn from(material: &FeatherMaterial) -> Self {
        Self {
            coverage_method: material.settings.coverage_method,
            transparency: material.transparency,
            sampled_environment: material.settings.environment_samples > 0,
        }
    }
}

/// The feathers one bird wears, bound to the GPU. The plugin makes one for every groomed bird.
#[derive(Asset, TypePath, AsBindGroup, Clone, Debug)]
#[uniform(0, GpuFeatherSettings)]
#[bind_group_data(FeatherPipelineKey)]
pub struct FeatherMaterial {
    /// Quality.
    pub settings: FeatherSettings,
    /// Transparency.
    pub transparency: FeatherTransparency,
    /// Feathers and fibre tables, see [`super::PackedFeathers`].
    #[storage(1, read_only)]
    pub feathers: Handle<ShaderBuffer>,
    /// Card records, [`super::CARD_VEC4S`] each.
    #[storage(2, read_only, visibility(vertex))]
    pub cards: Handle<ShaderBuffer>,
    /// LOD class of every card, written by the LOD pass.
    #[storage(3, read_only, visibility(vertex))]
    pub lod: Handle<ShaderBuffer>,
    /// Albedo: two layers (front, back) per feather, alpha = share of the groom's tint.
    #[texture(4, dimension = "2d_array")]
    #[sampler(5)]
    pub albedo: Handle<Image>,
}

impl From<&FeatherMaterial> for GpuFeatherSettings {
    fn from(material: &FeatherMaterial) -> Self {
        Self::from(&material.settings)
    }
}

impl Material for FeatherMaterial {
    fn vertex_shader() -> ShaderRef {
        FEATHER_VERTEX.into()
    }

    fn fragment_shader() -> ShaderRef {
        FEATHER.into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        FEATHER_VERTEX.into()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        FEATHER_PREPASS.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        match self.transparency {
            FeatherTransparency::AlphaToCoverage => AlphaMode::AlphaToCoverage,
            FeatherTransparency::Blend => AlphaMode::Blend,
        }
    }

    /// Under MSAA the depth prepass of an alpha-to-coverage material has no fragment stage and would write the whole card.
    fn enable_prepass() -> bool {
        false
    }

    fn specialize(
        _pipeline: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        if let Some(fragment) = &mut descriptor.fragment {
            fragment
                .shader_defs
                .extend(key.bind_group_data.shader_defs());
        }
        // Both faces of a feather show, and both cast shadows.
        descriptor.primitive.cull_mode = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let shader = include_str!("../shaders/feather_bindings.wgsl");
        let start = shader.find("struct FeatherSettings").unwrap();
        let end = start + shader[start..].find('}').unwrap() + 1;
        let module = naga::front::wgsl::parse_str(&shader[start..end]).unwrap();
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).unwrap();
        let (handle, settings) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some("FeatherSettings"))
            .unwrap();
        assert_eq!(
            u64::from(layouter[handle].size),
            GpuFeatherSettings::min_size().get()
        );
        let naga::TypeInner::Struct { members, .. } = &settings.inner else {
            panic!("not a struct");
        };
        let names: Vec<_> = members.iter().filter_map(|m| m.name.as_deref()).collect();
        assert_eq!(
            names,
            [
                "threshold",
                "multiple_scattering",
                "shelter",
                "dither",
                "debug_view",
                "environment_samples"
            ]
        );
        assert!(
            members
                .iter()
                .enumerate()
                .all(|(i, m)| m.offset == 4 * i as u32)
        );
    }

    #[test]
    fn settings_are_clamped() {
        let odd = FeatherSettings {
            error_budget: f32::INFINITY,
            multiple_scattering: -1.0,
            shelter: 7.0,
            ..FeatherSettings::default()
        };
        let gpu = GpuFeatherSettings::from(&odd);
        assert_eq!((gpu.multiple_scattering, gpu.shelter), (0.0, 1.0));
        assert!(gpu.threshold.is_finite() && gpu.threshold > 0.0);
    }
}
