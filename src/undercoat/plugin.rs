//! The plugin.

use super::{
    GuardStrands, Undercoat, UndercoatFailed, UndercoatOf, UndercoatParts, UndercoatQuality,
    UndercoatReady, UndercoatSettings, UndercoatState, UndercoatSystems,
    bake::{self, Bakes},
    extrude::ExtrudePlugin,
    grow,
    material::{StrandMaterial, UndercoatMaterial},
    spawn, tract,
};
use crate::{anatomy::DownPlugin, shaders::ShadersPlugin};
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
        if !app.is_plugin_added::<DownPlugin>() {
            app.add_plugins(DownPlugin);
        }
        app.init_resource::<UndercoatSettings>()
            .register_type::<Undercoat>()
            .register_type::<GuardStrands>()
            .register_type::<UndercoatState>()
            .register_type::<UndercoatSettings>()
            .register_type::<UndercoatQuality>()
            .register_type::<UndercoatReady>()
            .register_type::<UndercoatFailed>()
            .register_type::<UndercoatOf>()
            .register_type::<UndercoatParts>();
        if !app.is_plugin_added::<PbrPlugin>() {
            info!("bevy_plumage: the app has no PbrPlugin, undercoats are not drawn");
            return;
        }
        if !app.is_plugin_added::<ShadersPlugin>() {
            app.add_plugins(ShadersPlugin);
        }
        app.init_resource::<Bakes>()
            .add_observer(grow::drop_removed)
            .add_observer(grow::regrow_lost)
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
                    spawn::despawn_replaced,
                    grow::start,
                    grow::finish,
                    tract::prepare_tracts,
                    tract::update_tracts,
                    spawn::apply_settings,
                )
                    .chain()
                    .in_set(UndercoatSystems)
                    .after(TransformSystems::Propagate),
            );
    }
}
