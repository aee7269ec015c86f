//! The plugin group.

use crate::{
    anatomy::AnatomyPlugin, down::UndercoatPlugin, groom::GroomPlugin, render::FeatherRenderPlugin,
};
use bevy::app::{PluginGroup, PluginGroupBuilder};

/// Everything: feather and groom assets, grooming, rendering. Add it after `DefaultPlugins`.
pub struct PlumagePlugins;

impl PluginGroup for PlumagePlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(AnatomyPlugin)
            .add(GroomPlugin)
            .add(FeatherRenderPlugin)
            .add(UndercoatPlugin);
        #[cfg(feature = "extract")]
        let group = group.add(crate::extract::ExtractPlugin);
        group
    }
}
