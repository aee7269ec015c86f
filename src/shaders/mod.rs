//! The WGSL of the crate, embedded in the binary: maths modules (plain functions, twins of the Rust ones), and the thin layer
//! that binds them to Bevy.
//!
//! Only WGSL and the plugin that embeds it live here: `maths` without bindings, `card` and `undercoat` with those of their materials,
//! `comparison` with the published methods (feature `comparison`). It may not know any other room.

#[cfg(feature = "internals")]
mod layout;
#[cfg(feature = "internals")]
pub(crate) use layout::struct_layout;
#[cfg(feature = "internals")]
pub use layout::{ConstantLayout, StructLayout};

use bevy::{asset::embedded_asset, prelude::*, shader::load_shader_library};

/// Vertex function of every feather pass.
pub const FEATHER_VERTEX: &str = "embedded://bevy_plumage/shaders/card/feather_vertex.wgsl";
/// Color of a fragment.
pub const FEATHER: &str = "embedded://bevy_plumage/shaders/card/feather.wgsl";
/// Vertex function and silhouette of the depth prepass and of shadow maps.
pub const FEATHER_PREPASS: &str = "embedded://bevy_plumage/shaders/card/feather_prepass.wgsl";
/// Classification of cards.
pub const FEATHER_LOD: &str = "embedded://bevy_plumage/shaders/card/feather_lod.wgsl";
/// How far the wind lifts them.
pub const FEATHER_LIFT: &str = "embedded://bevy_plumage/shaders/card/feather_lift.wgsl";
/// The skin as a grid of depths.
pub const FEATHER_SKIN: &str = "embedded://bevy_plumage/shaders/card/feather_skin.wgsl";
/// Cards behind it.
pub const FEATHER_HIDE: &str = "embedded://bevy_plumage/shaders/card/feather_hide.wgsl";
/// Their triangles, class by class.
pub const FEATHER_LISTS: &str = "embedded://bevy_plumage/shaders/card/feather_lists.wgsl";
/// The undercoat, as a volume or as shells.
pub const UNDERCOAT: &str = "embedded://bevy_plumage/shaders/undercoat/undercoat.wgsl";
/// Skinning and extrusion of the undercoat's shell.
pub const UNDERCOAT_EXTRUDE: &str =
    "embedded://bevy_plumage/shaders/undercoat/undercoat_extrude.wgsl";
/// Single strands.
pub const UNDERCOAT_STRANDS: &str =
    "embedded://bevy_plumage/shaders/undercoat/undercoat_strands.wgsl";

pub(crate) struct ShadersPlugin;

impl Plugin for ShadersPlugin {
    fn build(&self, app: &mut App) {
        load_shader_library!(app, "maths/math.wgsl");
        load_shader_library!(app, "maths/footprint.wgsl");
        load_shader_library!(app, "maths/masking.wgsl");
        load_shader_library!(app, "maths/shadow.wgsl");
        load_shader_library!(app, "maths/query_far.wgsl");
        load_shader_library!(app, "maths/query_near.wgsl");
        load_shader_library!(app, "maths/query.wgsl");
        load_shader_library!(app, "maths/query_split.wgsl");
        load_shader_library!(app, "maths/query_map.wgsl");
        load_shader_library!(app, "maths/query_feather.wgsl");
        #[cfg(not(feature = "comparison"))]
        load_shader_library!(app, "maths/coverage_method.wgsl");
        #[cfg(feature = "comparison")]
        {
            load_shader_library!(app, "comparison/coverage_method.wgsl");
            load_shader_library!(app, "comparison/query_published.wgsl");
        }
        load_shader_library!(app, "maths/anatomy.wgsl");
        load_shader_library!(app, "maths/scattering.wgsl");
        load_shader_library!(app, "maths/scattering_azimuth.wgsl");
        load_shader_library!(app, "maths/scattering_multiple.wgsl");
        load_shader_library!(app, "maths/scattering_short.wgsl");
        load_shader_library!(app, "maths/scattering_near.wgsl");
        load_shader_library!(app, "maths/scattering_sample.wgsl");
        load_shader_library!(app, "maths/interference.wgsl");
        load_shader_library!(app, "maths/sheen.wgsl");
        load_shader_library!(app, "maths/vertex_light.wgsl");
        load_shader_library!(app, "maths/down_transfer.wgsl");
        load_shader_library!(app, "maths/down_strands.wgsl");
        load_shader_library!(app, "card/feather_data.wgsl");
        load_shader_library!(app, "card/feather_lod_bindings.wgsl");
        load_shader_library!(app, "card/feather_measure.wgsl");
        load_shader_library!(app, "card/feather_iridescence.wgsl");
        load_shader_library!(app, "card/feather_io.wgsl");
        load_shader_library!(app, "maths/wind.wgsl");
        load_shader_library!(app, "maths/order.wgsl");
        load_shader_library!(app, "card/feather_pattern.wgsl");
        load_shader_library!(app, "card/feather_cover.wgsl");
        load_shader_library!(app, "card/feather_eye.wgsl");
        load_shader_library!(app, "card/feather_shadow.wgsl");
        load_shader_library!(app, "card/feather_fibre.wgsl");
        load_shader_library!(app, "card/feather_vertex_light.wgsl");
        load_shader_library!(app, "card/feather_opacity.wgsl");
        load_shader_library!(app, "card/feather_place.wgsl");
        load_shader_library!(app, "card/feather_debug.wgsl");
        load_shader_library!(app, "card/feather_view.wgsl");
        load_shader_library!(app, "card/feather_bindings.wgsl");
        load_shader_library!(app, "card/feather_lighting.wgsl");
        load_shader_library!(app, "card/feather_near.wgsl");
        load_shader_library!(app, "card/feather_environment.wgsl");
        load_shader_library!(app, "maths/down_light.wgsl");
        load_shader_library!(app, "maths/down_march.wgsl");
        load_shader_library!(app, "maths/down_tier.wgsl");
        load_shader_library!(app, "maths/down_walk.wgsl");
        load_shader_library!(app, "undercoat/undercoat_data.wgsl");
        load_shader_library!(app, "undercoat/undercoat_lighting.wgsl");
        embedded_asset!(app, "undercoat/undercoat.wgsl");
        embedded_asset!(app, "undercoat/undercoat_extrude.wgsl");
        embedded_asset!(app, "undercoat/undercoat_strands.wgsl");
        embedded_asset!(app, "card/feather_vertex.wgsl");
        embedded_asset!(app, "card/feather.wgsl");
        embedded_asset!(app, "card/feather_prepass.wgsl");
        embedded_asset!(app, "card/feather_lod.wgsl");
        embedded_asset!(app, "card/feather_lift.wgsl");
        embedded_asset!(app, "card/feather_skin.wgsl");
        embedded_asset!(app, "card/feather_hide.wgsl");
        embedded_asset!(app, "card/feather_lists.wgsl");
    }
}
