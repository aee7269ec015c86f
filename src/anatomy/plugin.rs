//! [`Feather`] and [`Down`] as Bevy assets.

use super::{Down, Feather};
use crate::asset::RonLoader;
use bevy::{
    app::{App, Plugin},
    asset::AssetApp,
};

/// Registers [`Feather`] and [`Down`] with their loaders. Needs Bevy's `AssetPlugin` before it.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnatomyPlugin;

impl Plugin for AnatomyPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Feather>()
            .register_asset_reflect::<Feather>()
            .register_type::<Feather>()
            .init_asset_loader::<RonLoader<Feather>>();
        if !app.is_plugin_added::<DownPlugin>() {
            app.add_plugins(DownPlugin);
        }
    }
}

/// Registers [`Down`] alone, for fur without feathers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DownPlugin;

impl Plugin for DownPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Down>()
            .register_asset_reflect::<Down>()
            .register_type::<Down>()
            .init_asset_loader::<RonLoader<Down>>();
    }
}
