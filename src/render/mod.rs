//! From groomed cards to pixels: the material, what it packs for the GPU, and the passes of a frame.
//!
//! | file | what |
//! |---|---|
//! | `material` | [`FeatherMaterial`], its settings and pipelines |
//! | `pack` | feathers, fibre tables and cards as the shaders read them |
//! | `wear` | gives every groomed bird its material; [`PlumageMemory`] |
//! | `lod` | compute pass that classifies every card for every camera |
//! | `limits` | what the device must offer |

mod limits;
mod lod;
mod material;
mod pack;
mod wear;

pub use lod::CARD_COUNTERS;
pub use material::{
    CoverageMethod, DebugView, FeatherMaterial, FeatherSettings, FeatherTransparency,
};
pub use pack::{CARD_VEC4S, PackedFeathers};
pub use wear::{FeatherQuality, PlumageMemory};

use crate::shaders::ShadersPlugin;
use bevy::{
    pbr::{MaterialPlugin, PbrPlugin},
    prelude::*,
};

/// Draws every bird that the groom has dressed.
pub struct FeatherRenderPlugin;

impl Plugin for FeatherRenderPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<PbrPlugin>() {
            // A server: birds are groomed, nothing is drawn.
            info!("bevy_plumage: the app has no PbrPlugin, feathers are not drawn");
            return;
        }
        app.register_type::<FeatherQuality>()
            .register_type::<FeatherSettings>()
            .add_plugins((
                ShadersPlugin,
                MaterialPlugin::<FeatherMaterial>::default(),
                wear::WearPlugin,
                lod::LodPlugin,
            ));
    }

    fn finish(&self, app: &mut App) {
        limits::check(app);
    }
}
