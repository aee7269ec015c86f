//! What the inspector remembers, and what it reads from the app every frame.

use super::{
    fields::Fields,
    panels::{FeatherPanel, GroomPanel, Statistics, Tool},
    pick::Picked,
    session::Session,
    stroke::Stroke,
};
use crate::{
    anatomy::Feather,
    groom::{Groom, Plumage},
};
use bevy::prelude::*;
use std::path::PathBuf;

/// Which panel is shown on the left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    /// One feather.
    #[default]
    Feather,
    /// The groom of the bird.
    Groom,
    /// Error budget, transparency, debug view.
    Quality,
    /// Counters, times, memory.
    Statistics,
}

/// The state of the inspector.
#[derive(Resource)]
pub struct Inspector {
    /// Shown at all (F12).
    pub open: bool,
    /// The panel shown.
    pub tab: Tab,
    /// The bird edited.
    pub bird: Option<Entity>,
    /// The feather edited.
    pub feather: Option<AssetId<Feather>>,
    /// The feather picked last.
    pub picked: Option<Picked>,
    /// Feathers that are open.
    pub feathers: Session<Feather>,
    /// Grooms that are open.
    pub grooms: Session<Groom>,
    /// The feather panel.
    pub feather_panel: FeatherPanel,
    /// The groom panel.
    pub groom_panel: GroomPanel,
    /// The last frames.
    pub statistics: Statistics,
    /// Photographs that become feathers.
    #[cfg(feature = "photo")]
    pub photos: super::photo::Photos,
    pub(super) fields: Fields,
    pub(super) assets: PathBuf,
    pub(super) gesture: u64,
    /// The pointer was let go in the last frame.
    pub(super) released: bool,
    /// A drag on the bird under way.
    pub(super) stroke: Stroke,
    /// A plumage that waits for the pointer to be let go: each is a build.
    pub(super) pending: Option<(Entity, Plumage)>,
}

impl Inspector {
    pub(super) fn new(assets: PathBuf) -> Self {
        Self {
            open: true,
            tab: Tab::Feather,
            bird: None,
            feather: None,
            picked: None,
            feathers: Session::default(),
            grooms: Session::default(),
            feather_panel: FeatherPanel::default(),
            groom_panel: GroomPanel::default(),
            statistics: Statistics::default(),
            #[cfg(feature = "photo")]
            photos: super::photo::Photos::default(),
            fields: Fields::default(),
            assets,
            gesture: 0,
            released: false,
            stroke: Stroke::default(),
            pending: None,
        }
    }

    /// Shows a feather picked on a bird.
    pub fn choose(&mut self, picked: Picked) {
        self.bird = Some(picked.bird);
        self.feather = Some(picked.feather);
        self.picked = Some(picked);
    }

    /// Whether a drag on the bird belongs to a tool, so that it should not turn the camera.
    pub fn takes_drags(&self) -> bool {
        self.open && self.tab == Tab::Groom && self.groom_panel.tool != Tool::Pick
    }

    /// A number for a new step of the history.
    pub fn next_gesture(&mut self) -> u64 {
        self.gesture += 1;
        self.gesture
    }
}

/// Takes files that were written outside into the histories.
pub(super) fn follow_files(
    mut inspector: ResMut<Inspector>,
    mut feather_events: MessageReader<AssetEvent<Feather>>,
    mut groom_events: MessageReader<AssetEvent<Groom>>,
    feathers: Res<Assets<Feather>>,
    grooms: Res<Assets<Groom>>,
) {
    for event in feather_events.read() {
        if let AssetEvent::Modified { id } = event
            && let Some(feather) = feathers.get(*id)
        {
            let gesture = inspector.gesture + 1;
            if inspector.feathers.changed_outside(*id, feather, gesture) {
                inspector.gesture = gesture;
            }
        }
    }
    for event in groom_events.read() {
        if let AssetEvent::Modified { id } = event
            && let Some(groom) = grooms.get(*id)
        {
            let gesture = inspector.gesture + 1;
            if inspector.grooms.changed_outside(*id, groom, gesture) {
                inspector.gesture = gesture;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy;

    #[test]
    fn own_edits_are_not_taken_for_those_of_others() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Feather>()
            .init_asset::<Groom>()
            .insert_resource(Inspector::new(PathBuf::new()))
            .add_systems(Update, follow_files);
        let mut feather = anatomy::contour();
        let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
        let handle = feathers.add(feather.clone());
        let id = handle.id();
        app.update();
        let mut inspector = app.world_mut().resource_mut::<Inspector>();
        inspector.feathers.document(id, &feather, || None);
        // A drag: edits of one gesture, each put into the asset.
        let gesture = inspector.next_gesture();
        for length in [20.0, 21.0, 22.0] {
            feather.length_mm = length;
            let mut inspector = app.world_mut().resource_mut::<Inspector>();
            let now = inspector.gesture;
            inspector.feathers.edit(id, feather.clone(), now);
            let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
            feathers.insert(id, feather.clone()).unwrap();
            app.update();
            app.update();
        }
        let inspector = app.world().resource::<Inspector>();
        assert_eq!(inspector.gesture, gesture);
        assert_eq!(inspector.feathers.get(id).unwrap().depth(), (1, 0));
        // Somebody else's edit is a step of its own.
        feather.length_mm = 33.0;
        let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
        feathers.insert(id, feather.clone()).unwrap();
        app.update();
        app.update();
        let inspector = app.world().resource::<Inspector>();
        assert_ne!(inspector.gesture, gesture);
        let document = inspector.feathers.get(id).unwrap();
        assert_eq!((document.depth(), document.present()), ((2, 0), &feather));
    }
}
