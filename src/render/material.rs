//! [`FeatherMaterial`]: the look bound to the GPU.

use super::{
    key::{
        CoverageMethod, DrawnCards, DrawnUnder, FeatherPipelineKey, FeatherTransparency, ThinLayers,
    },
    specialize,
};
use crate::maths::query::ErrorBudget;
use crate::parameter::Parameter;
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
    shader::ShaderRef,
};
use serde::{Deserialize, Serialize};

/// What a feather shows instead of its shaded color.
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
    /// A color per card.
    Card,
    /// The layer, black (low) to white.
    Layer,
    /// The world normal of the card.
    Normal,
    /// A color per barb; the two vanes apart.
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
    /// Number of the pattern by which coverage becomes holes or MSAA samples, in the picture and in shadow maps. Frames that are
    /// averaged, on the processor or by TAA, take a number each: then the pattern averages out. 0 (default) for single pictures: the same
    /// from frame to frame.
    pub pattern: u32,
    /// What is shown.
    pub debug_view: DebugView,
    /// How coverage is found.
    pub coverage_method: CoverageMethod,
    /// Depth, in widths of a feather, within which the one that lies over the other in the coat is seen though it is further away, at
    /// most, 0..0.5 (0.5): it is as deep as settling has left the coat out of order, place by place, and 0.1 on meshes that were not
    /// groomed. 0: the nearest is seen. For cameras with a depth prepass (docs/bevy_view.md#layering).
    #[reflect(@Parameter::new("", 0.0, 0.5))]
    pub order_window: f32,
    /// Samples of the environment map per pixel, 0..1024, by importance; 0 (default) takes Bevy's prefiltered maps instead.
    #[reflect(@Parameter::new("", 0.0, 1024.0))]
    pub environment_samples: u32,
    /// Look at the fibres once for every four lights instead of once for each: cheaper where several lights reach the same
    /// feathers, dearer where one does (many registers). The picture is the same.
    pub lights_together: bool,
    /// Typical error of light, as a share of white, up to which it is found at the vertices of a distant card and interpolated, 0..0.1
    /// (0.02: an estimate, docs/book/lod.md#light-at-vertices); 0: light is found in every fragment.
    #[reflect(@Parameter::new("", 0.0, 0.1))]
    pub light_budget: f32,
    /// Leave out cards that lie behind the bird's own skin (docs/book/lod.md#hidden-cards).
    pub cull_hidden: bool,
}

impl FeatherSettings {
    /// Threshold of the chooser (docs/book/range_queries.md#the-chooser) for the error budget.
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
            pattern: 0,
            debug_view: DebugView::None,
            coverage_method: CoverageMethod::Chosen,
            order_window: 0.5,
            environment_samples: 0,
            lights_together: false,
            light_budget: 0.02,
            cull_hidden: true,
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
    /// `FeatherSettings::order_window`.
    pub order_window: f32,
    /// `FeatherSettings::pattern`.
    pub pattern: u32,
}

/// For the test that holds it against the shader.
#[cfg(feature = "internals")]
pub(super) fn settings_layout() -> crate::shaders::StructLayout {
    crate::shaders::struct_layout!(GpuFeatherSettings, "card/feather_bindings.wgsl", "FeatherSettings", {
        threshold, multiple_scattering, shelter, dither, debug_view, environment_samples, order_window, pattern,
    })
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
            order_window: settings.order_window.clamp(0.0, 0.5),
            pattern: settings.pattern,
        }
    }
}

impl From<&FeatherMaterial> for FeatherPipelineKey {
    fn from(material: &FeatherMaterial) -> Self {
        let settings = &material.settings;
        let shaded = settings.debug_view == DebugView::None;
        let overdraw = settings.debug_view == DebugView::Overdraw;
        let key = Self {
            coverage_method: settings.coverage_method,
            transparency: material.transparency,
            sampled_environment: shaded && settings.environment_samples > 0,
            lights_together: shaded && settings.lights_together,
            overdraw,
            debug: !shaded && !overdraw,
            drawn: material.drawn,
            under: material.under,
            ordered: material.settings.order_window > 0.0,
            plain: false,
            layers: material.layers,
        };
        key.with_plain_fibres(material.plain)
    }
}

/// Which fragments a material draws, and under which lights.
pub(super) type Drawing = (DrawnCards, DrawnUnder);

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
    /// Under which lights it draws them.
    pub under: DrawnUnder,
    /// All fibres are plain ([`FibreTable::is_plain`](crate::maths::scattering::FibreTable::is_plain)): FAR and MEAN cards take
    /// their short form.
    pub plain: bool,
    /// What the feathers have of thin layers.
    pub layers: ThinLayers,
    /// Feathers and fibre tables, laid out as `shaders/feather_data.wgsl` reads them.
    #[storage(1, read_only)]
    pub feathers: Handle<ShaderBuffer>,
    /// Card records, [`super::pack::CARD_VEC4S`] each.
    #[storage(2, read_only, visibility(vertex))]
    pub cards: Handle<ShaderBuffer>,
    /// LOD class of every card, written by the LOD pass, then how far the wind lifts each.
    #[storage(3, read_only, visibility(vertex))]
    pub lod: Handle<ShaderBuffer>,
    /// Albedo: two layers (front, back) per feather, alpha = share of the groom's tint.
    #[texture(4, dimension = "2d_array", visibility(vertex, fragment))]
    #[sampler(5, visibility(vertex, fragment))]
    pub albedo: Handle<Image>,
    /// Shares of the cards inside the outlines, one layer per feather ([`Feather::outline_map`](crate::anatomy::Feather::outline_map)).
    #[texture(7, dimension = "2d_array")]
    pub outlines: Handle<Image>,
    /// Wind and ruffle, see [`super::Wind`].
    #[storage(6, read_only, visibility(vertex))]
    pub motion: Handle<ShaderBuffer>,
}

impl FeatherMaterial {
    /// See [`FeatherPipelineKey::splits`].
    pub(super) fn splits(&self) -> bool {
        FeatherPipelineKey::from(self).splits()
    }

    /// `FeatherSettings::light_budget`, 0 where the feathers cannot be lit at vertices ([`FeatherPipelineKey::lights_vertices`]).
    pub(super) fn light_budget(&self) -> f32 {
        if self.plain && FeatherPipelineKey::from(self).lights_vertices() {
            self.settings.light_budget.clamp(0.0, 0.1)
        } else {
            0.0
        }
    }

    /// The same feathers, but other fragments of them.
    pub(super) fn drawing(&self, (drawn, under): Drawing) -> Self {
        Self {
            drawn,
            under,
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
        FeatherPipelineKey::from(self).alpha_mode()
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
