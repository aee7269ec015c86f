//! The plugin.

use super::{
    Down, DownLoader, GuardStrands, Undercoat, UndercoatQuality, UndercoatSettings, UndercoatState,
    bake::{self, Bakes},
    extrude::ExtrudePlugin,
    grow,
    material::{StrandMaterial, UndercoatMaterial},
    tract, wear,
};
use crate::shaders::ShadersPlugin;
use bevy::{
    pbr::{MaterialPlugin, PbrPlugin},
    prelude::*,
};

/// Grows and draws the coats of all entities with an [`Undercoat`]. One of the `PlumagePlugins`; for fur without feathers add it
/// alone, after `DefaultPlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct UndercoatPlugin;

impl Plugin for UndercoatPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Down>()
            .register_asset_reflect::<Down>()
            .init_asset_loader::<DownLoader>()
            .init_resource::<UndercoatSettings>()
            .register_type::<Undercoat>()
            .register_type::<GuardStrands>()
            .register_type::<UndercoatState>()
            .register_type::<UndercoatSettings>()
            .register_type::<UndercoatQuality>();
        if !app.is_plugin_added::<PbrPlugin>() {
            info!("bevy_plumage: the app has no PbrPlugin, undercoats are not drawn");
            return;
        }
        if !app.is_plugin_added::<ShadersPlugin>() {
            app.add_plugins(ShadersPlugin);
        }
        app.init_resource::<Bakes>()
            .add_plugins((
                MaterialPlugin::<UndercoatMaterial>::default(),
                MaterialPlugin::<StrandMaterial>::default(),
                ExtrudePlugin,
            ))
            .add_systems(
                PostUpdate,
                (
                    bake::forget_changed,
                    grow::request,
                    grow::tend,
                    wear::let_go,
                    grow::start,
                    grow::finish,
                    tract::find_tracts,
                    tract::tend_tracts,
                    wear::apply_settings,
                )
                    .chain()
                    .after(TransformSystems::Propagate),
            );
    }
}
