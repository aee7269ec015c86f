//! From groomed cards to pixels: the material, what it packs for the GPU, and the passes of a frame.
//!
//! What Bevy's renderer needs to draw feathers lives here. It may use the cards of `groom`, `anatomy`, `maths` and `shaders`; it may
//! not know how a coat was groomed, and nothing of `undercoat`.
//!
//! | file | what |
//! |---|---|
//! | `material` | [`FeatherMaterial`], its settings and pipelines |
//! | `key`, `specialize` | how coverage becomes pixels in the view at hand |
//! | `extra_draws` | the card mesh drawn once more: LOD classes, order-independent transparency |
//! | `order` | in which order the cards of a mesh are drawn |
//! | `wind` | [`Wind`] and [`Ruffle`] |
//! | `pack` | feathers, fibre tables and cards as the shaders read them |
//! | `prepare` | gives every groomed bird its material; [`PlumageMemory`] |
//! | `listed` | draws from the lists of each class that `lod` writes |
//! | `lod` | compute pass that classifies every card for every camera |
//! | `bounds` | bounds of cards, for rays |
//! | `limits` | what the device must offer |
//! | `fallback` | what is drawn where it does not |

mod baked;
mod bounds;
mod cascades;
mod extra_draws;
mod fallback;
#[cfg(feature = "internals")]
pub mod key;
#[cfg(not(feature = "internals"))]
mod key;
#[cfg(feature = "internals")]
pub mod layout;
mod lights;
mod limits;
mod listed;
mod lod;
mod material;
mod order;
pub mod pack;
mod prepare;
mod specialize;
mod stacks;
mod wind;

pub use baked::BakedFeather;
pub use cascades::fit_cascades;
pub use key::{CoverageMethod, DrawnCards, DrawnUnder, FeatherTransparency, ThinLayers};
pub use limits::{ActiveFeatherPath, FeatherPath};
pub use lod::CARD_COUNTERS;
pub use material::{DebugView, FeatherMaterial, FeatherSettings};
pub use prepare::{FeatherQuality, PlumageMemory, PlumageWork};
pub use wind::{Ruffle, Wind};

use crate::{groom::PlumageSystems, shaders::ShadersPlugin};
use bevy::{
    camera::visibility::VisibilitySystems,
    pbr::{MaterialPlugin, PbrPlugin},
    prelude::*,
};

/// Draws the feathers of every groomed bird. One of the `PlumagePlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct FeatherRenderPlugin {
    /// How feathers are drawn; by default in full wherever the device is up to it. [`ActiveFeatherPath`] says what came of it.
    /// `PlumagePlugins.set(FeatherRenderPlugin { path: FeatherPath::Fallback })` asks for the fallback, for machines that are too
    /// slow.
    pub path: FeatherPath,
}

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
            .init_resource::<lights::WorldLights>()
            .register_type::<PlumageMemory>()
            .add_systems(
                PostUpdate,
                bounds::update_bounds
                    .in_set(PlumageSystems::UpdateBounds)
                    .before(VisibilitySystems::CheckVisibility),
            )
            .add_plugins((
                ShadersPlugin,
                extra_draws::ExtraDrawPlugin,
                MaterialPlugin::<FeatherMaterial>::default(),
                prepare::PreparePlugin,
                lod::LodPlugin,
            ));
    }

    fn finish(&self, app: &mut App) {
        if !app.is_plugin_added::<PbrPlugin>() {
            return;
        }
        match limits::decide(app, self.path) {
            FeatherPath::Full => {
                lod::share_meshes(app);
                prepare::add_systems(app);
                extra_draws::add_systems(app);
                listed::add_systems(app);
                order::add_systems(app);
            }
            FeatherPath::Fallback => {
                app.add_systems(
                    PostUpdate,
                    (fallback::mark_stale, fallback::prepare_fallback)
                        .chain()
                        .in_set(PlumageSystems::PrepareMaterials),
                );
            }
        }
    }
}
