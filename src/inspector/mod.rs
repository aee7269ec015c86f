//! The material inspector and groom editor (feature `inspector`).
//!
//! Add [`PlumageInspectorPlugin`] to any app that has [`PlumagePlugins`](crate::plugin::PlumagePlugins); it brings `EguiPlugin`
//! if the app has none. F12 hides and shows it.
//!
//! Only what needs egui lives here. It may use every other room; none may use it.
//!
//! | file | what |
//! |---|---|
//! | `fields` | widgets from reflection: unit, range and tooltip of every field |
//! | `document`, `history`, `session` | what is edited: undo, files, conflicts; no window needed |
//! | `panels` | functions of a `Ui` and plain data |
//! | `state` | what the inspector remembers |
//! | `draw` | puts the panels on the screen and their edits into the assets |
//! | `overlay` | guides, the brush and the feather picked, drawn over the bird |
//! | `pick`, `skin` | which feather, and which place on the skin, is under the pointer |
//! | `stroke` | guides drawn and moved, density and length painted |
//! | `mouse` | clicks and drags on the bird |
//! | `measure` | what the statistics panel shows |
//! | `mirror` | the plane that a bird is its own mirror image in |
//! | `photo`, `dropped` | a photograph dropped on the window becomes a feather (feature `photo`) |
//! | `preview` | one feather alone, with a cursor that reads its coverage |

mod command;
mod document;
mod draw;
#[cfg(feature = "photo")]
mod dropped;
mod fields;
mod history;
mod measure;
mod mirror;
mod mouse;
mod overlay;
mod panels;
#[cfg(feature = "photo")]
mod photo;
mod pick;
mod preview;
mod session;
mod skin;
mod state;
mod stroke;

pub use command::Command;
pub use document::{Document, DocumentError, Editable};
pub use fields::Fields;
pub use history::History;
pub use mirror::MirrorPlane;
pub use panels::{
    FeatherPanel, GroomPanel, Part, Sample, Statistics, Tool, Toolbar, feather_panel, groom_panel,
    lobe_plot, pattern_editor, plumage_panel, quality_panel, statistics_panel, toolbar,
    weather_panel,
};
#[cfg(feature = "photo")]
pub use photo::{Photo, PhotoChoice, Photos, photo_panel};
pub use pick::{Picked, pick_card};
pub use session::Session;
pub use state::{Inspector, Tab};
pub use stroke::{add_guide, guide_through, move_point, nearest_guide_point};

use bevy::{
    asset::io::file::FileAssetReader,
    core_pipeline::{Core3d, Core3dSystems},
    prelude::*,
    render::{Render, RenderApp, RenderSystems},
};
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass, render::egui_pass};
use std::path::PathBuf;

/// Shows and edits every parameter of the feathers, the groom and the quality of the birds in an app.
#[derive(Clone, Debug)]
pub struct PlumageInspectorPlugin {
    /// Folder of the assets on disk, for saving and loading.
    pub assets: PathBuf,
}

impl Default for PlumageInspectorPlugin {
    /// The folder `assets` where Bevy looks for it by default.
    fn default() -> Self {
        Self {
            assets: FileAssetReader::get_base_path().join("assets"),
        }
    }
}

/// What draws the panels, in `EguiPrimaryContextPass`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorSystems;

impl Plugin for PlumageInspectorPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
        }
        app.insert_resource(Inspector::new(self.assets.clone()))
            .init_resource::<preview::Preview>()
            .add_systems(
                Update,
                (
                    measure::measure,
                    state::follow_files,
                    mouse::pick_by_mouse,
                    mouse::stroke_by_mouse,
                    preview::update_preview,
                ),
            )
            .add_systems(
                EguiPrimaryContextPass,
                (draw::draw, overlay::draw_overlay)
                    .chain()
                    .in_set(InspectorSystems),
            );
        #[cfg(feature = "photo")]
        app.add_systems(Update, dropped::follow_photos);
        let compiling = preview::Compiling::default();
        app.insert_resource(compiling.clone());
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app.insert_resource(compiling).add_systems(
                Render,
                preview::watch_pipelines.in_set(RenderSystems::Cleanup),
            );
            // Without its `bevy_ui` feature bevy_egui leaves its pass and tone mapping in no order, and cameras with HDR lose
            // the panels.
            let between = (|| {}).after(Core3dSystems::PostProcess).before(egui_pass);
            render_app.add_systems(Core3d, between);
        }
    }
}
