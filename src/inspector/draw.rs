//! Puts the panels on the screen and their edits into the assets.

use super::{
    command::Command,
    fields::Fields,
    panels::{
        FeatherPanel, GroomPanel, Sample, Statistics, Tool, feather_panel, groom_panel,
        quality_panel, statistics_panel, toolbar,
    },
    pick::Picked,
    preview::{Preview, preview_panel},
    session::{Session, files},
};
use crate::{
    anatomy::{Feather, presets},
    groom::{Groom, Plumage, PlumageCards, PlumageState},
    render::{CARD_COUNTERS, FeatherQuality, PlumageMemory},
};
use bevy::{diagnostic::DiagnosticsStore, prelude::*};
use bevy_egui::{EguiContexts, egui};
use std::path::{Path, PathBuf};

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
    #[cfg(feature = "extract")]
    pub photos: super::photo::Photos,
    fields: Fields,
    assets: PathBuf,
    gesture: u64,
    pointer_down: bool,
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
            #[cfg(feature = "extract")]
            photos: super::photo::Photos::default(),
            fields: Fields::default(),
            assets,
            gesture: 0,
            pointer_down: false,
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

/// Collects what the statistics panel shows.
pub(super) fn measure(
    mut inspector: ResMut<Inspector>,
    store: Option<Res<DiagnosticsStore>>,
    memory: Option<Res<PlumageMemory>>,
    time: Res<Time<Real>>,
    states: Query<&PlumageState>,
    cards: Query<&PlumageCards>,
) {
    let mut sample = Sample {
        frame_ms: time.delta_secs_f64() * 1e3,
        memory: memory.map_or_else(PlumageMemory::default, |memory| *memory),
        feathers: cards.iter().map(|worn| worn.cards.len() as u64).sum(),
        ..Sample::default()
    };
    for state in &states {
        sample.triangles += u64::from(state.triangles);
        sample.groom_ms = sample.groom_ms.max(state.groom_ms);
        sample.errors.extend(state.error.clone());
    }
    for diagnostic in store.iter().flat_map(|store| store.iter()) {
        let path = diagnostic.path().as_str();
        if let Some(name) = path.strip_prefix("render/feather_cards_") {
            if let Some(i) = CARD_COUNTERS.iter().position(|known| *known == name) {
                sample.cards[i] = diagnostic.value().unwrap_or(0.0) as u64;
            }
        } else if let Some(name) = path
            .strip_prefix("render/")
            .and_then(|path| path.strip_suffix("/elapsed_gpu"))
            && let Some(ms) = diagnostic.smoothed()
        {
            sample.passes.push((name.to_owned(), ms));
        }
    }
    inspector.statistics.push(sample);
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
            let gesture = inspector.next_gesture();
            inspector.feathers.changed_outside(*id, feather, gesture);
        }
    }
    for event in groom_events.read() {
        if let AssetEvent::Modified { id } = event
            && let Some(groom) = grooms.get(*id)
        {
            let gesture = inspector.next_gesture();
            inspector.grooms.changed_outside(*id, groom, gesture);
        }
    }
}

/// The birds and assets that the panels show.
#[derive(bevy::ecs::system::SystemParam)]
pub(super) struct World<'w, 's> {
    server: Res<'w, AssetServer>,
    feathers: ResMut<'w, Assets<Feather>>,
    grooms: ResMut<'w, Assets<Groom>>,
    birds: Query<
        'w,
        's,
        (
            Entity,
            &'static mut Plumage,
            Option<&'static mut FeatherQuality>,
            Option<&'static Name>,
        ),
    >,
    cards: Query<'w, 's, &'static PlumageCards>,
}

/// Draws everything. Runs inside the egui pass.
pub(super) fn draw(
    mut contexts: EguiContexts,
    mut inspector: ResMut<Inspector>,
    mut world: World,
    mut preview: ResMut<Preview>,
    mut commands: Commands,
) -> Result {
    let texture = preview.texture(&mut contexts);
    let context = contexts.ctx_mut()?.clone();
    if context.input(|input| input.key_pressed(egui::Key::F12)) {
        inspector.open = !inspector.open;
    }
    let down = context.input(|input| input.pointer.any_down());
    if down != inspector.pointer_down {
        // A press or a release begins a new step of the history.
        inspector.pointer_down = down;
        inspector.next_gesture();
    }
    if inspector.open {
        let inspector = &mut *inspector;
        left_panel(&context, inspector, &mut world, &mut commands);
        right_panel(&context, inspector, &world, &mut preview, texture);
        shortcuts(&context, inspector, &world);
    }
    show_documents(&mut inspector, &mut world, down);
    Ok(())
}

/// Puts what the documents hold into the assets: feathers at once, grooms when the pointer is up (each is a build).
fn show_documents(inspector: &mut Inspector, world: &mut World, pointer_down: bool) {
    if let Some(id) = inspector.feather
        && let Some(value) = inspector.feathers.shown(id)
        && world.feathers.get(id).is_some_and(|asset| asset != value)
    {
        let _ = world.feathers.insert(id, value.clone());
    }
    let groom = inspector
        .bird
        .and_then(|bird| world.birds.get(bird).ok())
        .map(|(_, plumage, ..)| plumage.groom.id());
    if let Some(id) = groom
        && !pointer_down
        && let Some(value) = inspector.grooms.shown(id)
        && world.grooms.get(id).is_some_and(|asset| asset != value)
    {
        let _ = world.grooms.insert(id, value.clone());
    }
}

fn left_panel(
    context: &egui::Context,
    inspector: &mut Inspector,
    world: &mut World,
    commands: &mut Commands,
) {
    let window = egui::Window::new("Plumage")
        .default_pos([8.0, 8.0])
        .default_size([370.0, 640.0])
        .min_width(300.0);
    window.show(context, |ui| {
        choose_bird(ui, inspector, world);
        ui.horizontal(|ui| {
            for (tab, name) in [
                (Tab::Feather, "Feather"),
                (Tab::Groom, "Groom"),
                (Tab::Quality, "Quality"),
                (Tab::Statistics, "Statistics"),
            ] {
                ui.selectable_value(&mut inspector.tab, tab, name);
            }
        });
        ui.separator();
        match inspector.tab {
            Tab::Feather => feather_tab(ui, inspector, world),
            Tab::Groom => groom_tab(ui, inspector, world),
            Tab::Quality => quality_tab(ui, inspector, world, commands),
            Tab::Statistics => {
                scroll(ui, |ui| statistics_panel(ui, &inspector.statistics));
            }
        }
    });
}

fn scroll(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    egui::ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, body);
}

fn choose_bird(ui: &mut egui::Ui, inspector: &mut Inspector, world: &World) {
    let label = |entity: Entity, name: Option<&Name>| {
        name.map_or_else(|| format!("bird {entity}"), |name| name.to_string())
    };
    let alive = inspector
        .bird
        .is_some_and(|bird| world.birds.contains(bird));
    if !alive {
        inspector.bird = world.birds.iter().map(|(entity, ..)| entity).min();
    }
    let selected = inspector
        .bird
        .and_then(|bird| world.birds.get(bird).ok())
        .map_or_else(|| "no bird".to_owned(), |(e, _, _, name)| label(e, name));
    egui::ComboBox::from_id_salt("bird")
        .selected_text(selected)
        .show_ui(ui, |ui| {
            for (entity, _, _, name) in &world.birds {
                ui.selectable_value(&mut inspector.bird, Some(entity), label(entity, name));
            }
        });
}

/// The feathers to choose from: those that the bird wears, and those from photographs.
fn choices(inspector: &Inspector, world: &World) -> Vec<Handle<Feather>> {
    #[allow(unused_mut, reason = "photographs need a feature")]
    let mut choices = world
        .cards
        .iter()
        .find(|worn| Some(worn.owner) == inspector.bird)
        .map(|worn| worn.feathers.clone())
        .unwrap_or_default();
    #[cfg(feature = "extract")]
    choices.extend(
        inspector
            .photos
            .done
            .iter()
            .map(|photo| photo.feather.clone()),
    );
    choices
}

fn file_of(
    server: &AssetServer,
    assets: &Path,
    id: impl Into<bevy::asset::UntypedAssetId>,
) -> Option<PathBuf> {
    let path = server.get_path(id)?;
    Some(assets.join(path.path()))
}

fn feather_tab(ui: &mut egui::Ui, inspector: &mut Inspector, world: &mut World) {
    let worn = choices(inspector, world);
    if inspector
        .feather
        .is_none_or(|id| !worn.iter().any(|feather| feather.id() == id))
    {
        inspector.feather = worn.first().map(Handle::id);
    }
    let name = |id: AssetId<Feather>| {
        world
            .feathers
            .get(id)
            .map_or_else(|| "loading".to_owned(), |feather| feather.name.clone())
    };
    egui::ComboBox::from_id_salt("feather")
        .selected_text(inspector.feather.map_or_else(String::new, name))
        .height(400.0)
        .show_ui(ui, |ui| {
            for feather in &worn {
                let id = feather.id();
                ui.selectable_value(&mut inspector.feather, Some(id), name(id));
            }
        });
    let Some((id, asset)) = inspector
        .feather
        .and_then(|id| Some((id, world.feathers.get(id)?)))
    else {
        ui.label("The bird has no feathers yet.");
        return;
    };
    let gesture = inspector.gesture;
    let file = || file_of(&world.server, &inspector.assets, id);
    let document = inspector.feathers.document(id, asset, file).clone();
    let folder = folder_of(&document, &inspector.assets, "feathers");
    let preset = presets::by_name(&document.present().name);
    inspector.feathers.toolbar.files = files(&folder, "feather.ron");
    let command = toolbar(
        ui,
        &mut inspector.feathers.toolbar,
        &document,
        preset.is_some(),
    );
    let mut value = document.present().clone();
    let mut changed = false;
    scroll(ui, |ui| {
        changed = feather_panel(
            ui,
            &inspector.fields,
            &mut inspector.feather_panel,
            &mut value,
        );
    });
    if changed {
        inspector.feathers.edit(id, value, gesture);
    }
    if let Some(command) = command {
        let gesture = inspector.next_gesture();
        inspector
            .feathers
            .run(id, command, &folder, preset, gesture);
    }
}

/// The folder of a document's file, or where files of its kind usually lie.
fn folder_of<T: super::document::Editable>(
    document: &super::document::Document<T>,
    assets: &Path,
    usual: &str,
) -> PathBuf {
    document
        .file()
        .and_then(Path::parent)
        .map_or_else(|| assets.join(usual), Path::to_path_buf)
}

fn groom_tab(ui: &mut egui::Ui, inspector: &mut Inspector, world: &mut World) {
    let Some((id, asset)) = inspector
        .bird
        .and_then(|bird| world.birds.get(bird).ok())
        .and_then(|(_, plumage, ..)| {
            let id = plumage.groom.id();
            Some((id, world.grooms.get(id)?))
        })
    else {
        ui.label("The bird has no groom yet.");
        return;
    };
    let gesture = inspector.gesture;
    let file = || file_of(&world.server, &inspector.assets, id);
    let document = inspector.grooms.document(id, asset, file).clone();
    let folder = folder_of(&document, &inspector.assets, "grooms");
    inspector.grooms.toolbar.files = files(&folder, "groom.ron");
    let command = toolbar(ui, &mut inspector.grooms.toolbar, &document, false);
    let mut value = document.present().clone();
    let mut changed = false;
    scroll(ui, |ui| {
        changed = groom_panel(
            ui,
            &inspector.fields,
            &mut inspector.groom_panel,
            &mut value,
        );
    });
    if changed {
        inspector.grooms.edit(id, value, gesture);
    }
    if let Some(command) = command {
        let gesture = inspector.next_gesture();
        inspector.grooms.run(id, command, &folder, None, gesture);
    }
}

fn quality_tab(
    ui: &mut egui::Ui,
    inspector: &mut Inspector,
    world: &mut World,
    commands: &mut Commands,
) {
    let Some((entity, mut plumage, quality, _)) = inspector
        .bird
        .and_then(|bird| world.birds.get_mut(bird).ok())
    else {
        ui.label("There is no bird.");
        return;
    };
    let mut new_quality = quality.as_deref().copied().unwrap_or_default();
    let mut new_plumage = plumage.clone();
    let mut changed = (false, false);
    scroll(ui, |ui| {
        changed = quality_panel(ui, &inspector.fields, &mut new_quality, &mut new_plumage);
    });
    if changed.0 {
        match quality {
            Some(mut quality) => {
                quality.set_if_neq(new_quality);
            }
            None => {
                commands.entity(entity).insert(new_quality);
            }
        }
    }
    if changed.1 {
        plumage.set_if_neq(new_plumage);
    }
}

fn right_panel(
    context: &egui::Context,
    inspector: &mut Inspector,
    world: &World,
    preview: &mut Preview,
    texture: Option<egui::TextureId>,
) {
    let window = egui::Window::new("Feather")
        .pivot(egui::Align2::RIGHT_TOP)
        .default_pos(context.content_rect().right_top() + egui::vec2(-8.0, 8.0))
        .default_size([250.0, 560.0])
        .min_width(200.0);
    window.show(context, |ui| {
        scroll(ui, |ui| {
            let feather = inspector.feather.and_then(|id| world.feathers.get(id));
            preview_panel(ui, preview, feather, texture);
            ui.separator();
            match &inspector.picked {
                Some(picked) => {
                    ui.label("Picked");
                    for line in &picked.text {
                        ui.label(line);
                    }
                    ui.label(format!("at u {:.3}, v {:.3}", picked.uv.x, picked.uv.y));
                }
                None => {
                    ui.weak("Click a feather on the bird (Groom tab, tool Pick).");
                }
            }
            ui.separator();
            ui.weak("F12 hides the panels. Hold C to see the saved state. Ctrl+Z, Ctrl+Shift+Z.");
        });
    });
}

/// Keys for the document of the tab shown.
fn shortcuts(context: &egui::Context, inspector: &mut Inspector, world: &World) {
    if context.egui_wants_keyboard_input() {
        return;
    }
    let shift = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    let command = context.input_mut(|input| {
        if input.consume_key(shift, egui::Key::Z) {
            Some(Command::Redo)
        } else if input.consume_key(egui::Modifiers::COMMAND, egui::Key::Z) {
            Some(Command::Undo)
        } else if input.consume_key(egui::Modifiers::COMMAND, egui::Key::S) {
            Some(Command::Save { overwrite: false })
        } else if input.key_pressed(egui::Key::C) && input.modifiers.is_none() {
            Some(Command::Compare(true))
        } else if input.key_released(egui::Key::C) {
            Some(Command::Compare(false))
        } else {
            None
        }
    });
    let Some(command) = command else {
        return;
    };
    let gesture = inspector.next_gesture();
    let folder = PathBuf::new();
    if inspector.tab == Tab::Groom {
        let groom = inspector
            .bird
            .and_then(|bird| world.birds.get(bird).ok())
            .map(|(_, plumage, ..)| plumage.groom.id());
        if let Some(id) = groom {
            inspector.grooms.run(id, command, &folder, None, gesture);
        }
    } else if let Some(id) = inspector.feather {
        inspector.feathers.run(id, command, &folder, None, gesture);
    }
}
