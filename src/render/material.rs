//! [`FeatherMaterial`]: the look bound to the GPU.

use super::specialize;
use crate::parameter::Parameter;
use crate::query::ErrorBudget;
use crate::shaders::{FEATHER, FEATHER_PREPASS, FEATHER_VERTEX};
use bevy::{
    material::OpaqueRendererMethod,
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
    /// Coverage becomes MSAA samples: no sorting, writes depth. Wants `Msaa::Sample4`; with `Msaa::Off` it is [`Self::Hashed`].
    #[default]
    AlphaToCoverage,
    /// Every pixel is there or not, by a pattern fixed to the feather (Wyman and McGuire 2017): no sorting, writes depth, works
    /// without MSAA. Grainy in a single frame.
    Hashed,
    /// Interiors of vanes, almost opaque, are drawn with depth; only fringes go to Bevy's order-independent transparency, which
    /// the camera needs: `OrderIndependentTransparencySettings` and `Msaa::Off`. On cameras without it the feathers are drawn as
    /// with [`Self::AlphaToCoverage`], and a warning says so.
    OrderIndependent,
    /// Blended in the order of the mesh, without depth: exact for a single feather, wrong where feathers cover each other. A
    /// camera with order-independent transparency sorts the fragments.
    Blend,
}

/// Which fragments of a bird's cards a material draws. The plugin draws the cards of its first and of the last two by materials
/// and pipelines of their own, so that a fragment far away does not carry what only near ones need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DrawnCards {
    /// Shadows of all; colour and depth of what no other material draws.
    #[default]
    Own,
    /// The almost opaque interiors for [`FeatherTransparency::OrderIndependent`].
    Core,
    /// Colour and depth of cards of the class FAR.
    Far,
    /// Colour and depth of cards of the class MEAN.
    Mean,
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
    /// A colour per barb; the two vanes apart.
    Barb,
    /// Where the light of the fibres goes: reflected by the surface red, out of the fibre to the front green, to the back blue.
    Lobe,
    /// Number of fragments over one another; sixteen make white.
    Overdraw,
}

/// Quality of all feathers of a bird.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FeatherSettings {
    /// Largest error of coverage that a cheaper evaluator may bring, 0.0005..0.05 (half an 8-bit step, 1/510). One number sets the
    /// thresholds of the LOD and how finely near footprints are resolved.
    #[reflect(@Parameter::new("", 0.0005, 0.05).logarithmic())]
    pub error_budget: f32,
    /// How much of the light that fibres scatter onto other fibres is followed further, 0..1: all of it (1) keeps the energy of a
    /// white feather, 0 is single scattering.
    #[reflect(@Parameter::share())]
    pub multiple_scattering: f32,
    /// Share of the sky that the feathers above hide at a feather's root, 0..1 (0.55); falls to nothing towards the tip. 0 for a
    /// feather on its own.
    #[reflect(@Parameter::share())]
    pub shelter: f32,
    /// Vary the alpha by a fixed pattern before it becomes MSAA samples, so that its mean is right.
    pub dither: bool,
    /// What is shown.
    pub debug_view: DebugView,
    /// How coverage is found.
    pub coverage_method: CoverageMethod,
    /// Samples of the environment map per pixel, 0..1024, by importance; 0 (default) takes Bevy's prefiltered maps instead.
    #[reflect(@Parameter::new("", 0.0, 1024.0))]
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
            multiple_scattering: 1.0,
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
            environment_samples: settings.environment_samples.min(1024),
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
    /// [`DebugView::Overdraw`].
    pub overdraw: bool,
    /// `FeatherMaterial::drawn`.
    pub drawn: DrawnCards,
    /// Cards of the classes FAR and MEAN are drawn by other materials.
    pub splits: bool,
}

impl FeatherPipelineKey {
    /// Shader definitions that do not depend on the view.
    pub(super) fn shader_defs(&self) -> Vec<ShaderDefVal> {
        let mut defs = Vec::new();
        match self.coverage_method {
            CoverageMethod::Chosen => {}
            CoverageMethod::Published => defs.push("PUBLISHED_COVERAGE".into()),
            CoverageMethod::Supersampled => defs.push("SUPERSAMPLED_COVERAGE".into()),
        }
        if self.sampled_environment {
            defs.push("SAMPLED_ENVIRONMENT".into());
        }
        if self.overdraw {
            defs.push("OVERDRAW".into());
        }
        match self.drawn {
            DrawnCards::Own if self.splits => defs.push("ONLY_RESOLVED".into()),
            DrawnCards::Own | DrawnCards::Core => {}
            DrawnCards::Far => defs.push("ONLY_FAR".into()),
            DrawnCards::Mean => defs.push("ONLY_MEAN".into()),
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
            overdraw: material.settings.debug_view == DebugView::Overdraw,
            drawn: material.drawn,
            splits: material.splits(),
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
    /// Which fragments this material draws; the plugin makes materials for the rest.
    pub drawn: DrawnCards,
    /// Feathers and fibre tables, laid out as `shaders/feather_data.wgsl` reads them.
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
    /// Wind and ruffle, see [`super::Wind`].
    #[storage(6, read_only, visibility(vertex))]
    pub motion: Handle<ShaderBuffer>,
}

impl FeatherMaterial {
    /// Whether every LOD class has a pipeline of its own. Blending keeps the order of the mesh, so its cards stay together; the
    /// methods that are there for comparison know no classes.
    pub(super) fn splits(&self) -> bool {
        self.settings.coverage_method == CoverageMethod::Chosen
            && matches!(
                self.transparency,
                FeatherTransparency::AlphaToCoverage | FeatherTransparency::Hashed
            )
    }

    /// The same feathers, but other fragments of them.
    pub(super) fn drawing(&self, drawn: DrawnCards) -> Self {
        Self {
            drawn,
            ..self.clone()
        }
    }
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
        FEATHER_PREPASS.into()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        FEATHER_PREPASS.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        if self.settings.debug_view == DebugView::Overdraw {
            return AlphaMode::Add;
        }
        if self.drawn == DrawnCards::Core {
            return AlphaMode::Mask(0.5);
        }
        match self.transparency {
            FeatherTransparency::AlphaToCoverage => AlphaMode::AlphaToCoverage,
            FeatherTransparency::Hashed => AlphaMode::Mask(0.5),
            FeatherTransparency::OrderIndependent | FeatherTransparency::Blend => AlphaMode::Blend,
        }
    }

    fn opaque_render_method(&self) -> OpaqueRendererMethod {
        OpaqueRendererMethod::Forward
    }

    fn specialize(
        _pipeline: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        specialize::feather_pipeline(descriptor, layout, key.mesh_key, &key.bind_group_data)
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
