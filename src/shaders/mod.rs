//! The WGSL of the crate, embedded in the binary: maths modules (plain functions, twins of the Rust ones), and the thin layer
//! that binds them to Bevy.

use bevy::{asset::embedded_asset, prelude::*, shader::load_shader_library};

/// Vertex function of every feather pass.
pub const FEATHER_VERTEX: &str = "embedded://bevy_plumage/shaders/feather_vertex.wgsl";
/// Colour of a fragment.
pub const FEATHER: &str = "embedded://bevy_plumage/shaders/feather.wgsl";
/// Vertex function and silhouette of the depth prepass and of shadow maps.
pub const FEATHER_PREPASS: &str = "embedded://bevy_plumage/shaders/feather_prepass.wgsl";
/// Classification of cards.
pub const FEATHER_LOD: &str = "embedded://bevy_plumage/shaders/feather_lod.wgsl";
/// The undercoat, as a volume or as shells.
pub const UNDERCOAT: &str = "embedded://bevy_plumage/shaders/undercoat.wgsl";
/// Skinning and extrusion of the undercoat's shell.
pub const UNDERCOAT_EXTRUDE: &str = "embedded://bevy_plumage/shaders/undercoat_extrude.wgsl";
/// Single strands.
pub const UNDERCOAT_STRANDS: &str = "embedded://bevy_plumage/shaders/undercoat_strands.wgsl";

pub(crate) struct ShadersPlugin;

impl Plugin for ShadersPlugin {
    fn build(&self, app: &mut App) {
        load_shader_library!(app, "math.wgsl");
        load_shader_library!(app, "masking.wgsl");
        load_shader_library!(app, "shadow.wgsl");
        load_shader_library!(app, "query_far.wgsl");
        load_shader_library!(app, "query_near.wgsl");
        load_shader_library!(app, "query.wgsl");
        load_shader_library!(app, "query_split.wgsl");
        load_shader_library!(app, "query_published.wgsl");
        load_shader_library!(app, "anatomy.wgsl");
        load_shader_library!(app, "scattering.wgsl");
        load_shader_library!(app, "scattering_azimuth.wgsl");
        load_shader_library!(app, "scattering_near.wgsl");
        load_shader_library!(app, "scattering_sample.wgsl");
        load_shader_library!(app, "sheen.wgsl");
        load_shader_library!(app, "down_coverage.wgsl");
        load_shader_library!(app, "down_transfer.wgsl");
        load_shader_library!(app, "down_slabs.wgsl");
        load_shader_library!(app, "down_strands.wgsl");
        load_shader_library!(app, "down_fragments.wgsl");
        load_shader_library!(app, "feather_data.wgsl");
        load_shader_library!(app, "feather_io.wgsl");
        load_shader_library!(app, "wind.wgsl");
        load_shader_library!(app, "feather_pattern.wgsl");
        load_shader_library!(app, "feather_cover.wgsl");
        load_shader_library!(app, "feather_shadow.wgsl");
        load_shader_library!(app, "feather_opacity.wgsl");
        load_shader_library!(app, "feather_place.wgsl");
        load_shader_library!(app, "feather_debug.wgsl");
        load_shader_library!(app, "feather_view.wgsl");
        load_shader_library!(app, "feather_bindings.wgsl");
        load_shader_library!(app, "feather_lighting.wgsl");
        load_shader_library!(app, "feather_near.wgsl");
        load_shader_library!(app, "feather_environment.wgsl");
        load_shader_library!(app, "down_density.wgsl");
        load_shader_library!(app, "down_light.wgsl");
        load_shader_library!(app, "down_march.wgsl");
        load_shader_library!(app, "down_prism.wgsl");
        load_shader_library!(app, "down_tier.wgsl");
        load_shader_library!(app, "down_walk.wgsl");
        load_shader_library!(app, "undercoat_data.wgsl");
        load_shader_library!(app, "undercoat_lighting.wgsl");
        embedded_asset!(app, "undercoat.wgsl");
        embedded_asset!(app, "undercoat_extrude.wgsl");
        embedded_asset!(app, "undercoat_strands.wgsl");
        embedded_asset!(app, "feather_vertex.wgsl");
        embedded_asset!(app, "feather.wgsl");
        embedded_asset!(app, "feather_prepass.wgsl");
        embedded_asset!(app, "feather_lod.wgsl");
    }
}
