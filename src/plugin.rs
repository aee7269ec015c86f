//! The plugin group.

use crate::{
    anatomy::AnatomyPlugin, groom::GroomPlugin, render::FeatherRenderPlugin,
    skin_color::SkinColorPlugin, undercoat::UndercoatPlugin, weathering::WeatheringPlugin,
};
use bevy::app::{PluginGroup, PluginGroupBuilder};

/// Everything: feather and groom assets, grooming, rendering. Add it after `DefaultPlugins`.
pub struct PlumagePlugins;

impl PluginGroup for PlumagePlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(AnatomyPlugin)
            .add(GroomPlugin)
            .add(SkinColorPlugin)
            .add(WeatheringPlugin)
            .add(FeatherRenderPlugin::default())
            .add(UndercoatPlugin);
        #[cfg(feature = "photo")]
        let group = group.add(crate::photo::ExtractPlugin);
        group
    }
}
