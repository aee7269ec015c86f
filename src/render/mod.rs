//! From groomed cards to pixels: the material, what it packs for the GPU, and the passes of a frame.
//!
//! | file | what |
//! |---|---|
//! | `material` | [`FeatherMaterial`], its settings and pipelines |
//! | `specialize` | how coverage becomes pixels in the view at hand |
//! | `repeat` | the card mesh drawn more than once: LOD classes, order-independent transparency |
//! | `wind` | [`Wind`] and [`Ruffle`] |
//! | `pack` | feathers, fibre tables and cards as the shaders read them |
//! | `wear` | gives every groomed bird its material; [`PlumageMemory`] |
//! | `lod` | compute pass that classifies every card for every camera |
//! | `bounds` | bounds of cards, for rays |
//! | `limits` | what the device must offer |
//! | `cut_out` | what is drawn where it does not |

mod bounds;
mod cut_out;
mod limits;
mod lod;
mod material;
mod pack;
mod repeat;
mod specialize;
mod wear;
mod wind;

pub use cut_out::FeatherPath;
pub use lod::CARD_COUNTERS;
pub use material::{
    CoverageMethod, DebugView, DrawnCards, FeatherMaterial, FeatherSettings, FeatherTransparency,
};
pub use pack::CARD_VEC4S;
pub use wear::{FeatherQuality, PlumageMemory, PlumageWork};
pub use wind::{
    RUFFLE_LIFT, RUFFLE_YAW, Ruffle, Wind, value_noise, wind_lift, wind_response, wind_velocity,
};

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
            .register_type::<Wind>()
            .register_type::<Ruffle>()
            .register_type::<FeatherPath>()
            .init_resource::<Wind>()
            .init_resource::<FeatherPath>()
            .add_systems(
                PostUpdate,
                (
                    bounds::bound_cards,
                    cut_out::wear_cut_outs.run_if(resource_equals(FeatherPath::CutOut)),
                ),
            )
            .add_plugins((
                ShadersPlugin,
                repeat::RepeatPlugin,
                MaterialPlugin::<FeatherMaterial>::default(),
                wear::WearPlugin,
                lod::LodPlugin,
            ));
    }

    fn finish(&self, app: &mut App) {
        limits::check(app);
    }
}
