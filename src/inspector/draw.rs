//! Puts the panels on the screen and their edits into the assets.

use super::{
    command::Command,
    panels::{
        feather_panel, groom_panel, plumage_panel, quality_panel, statistics_panel, toolbar,
        weather_panel,
    },
    preview::{Preview, preview_panel},
    state::{Inspector, Tab},
};
use crate::{
    anatomy::Feather,
    groom::{FeathersOf, Groom, Plumage, PlumageCards, PlumageState},
    render::FeatherQuality,
    weathering::Weathering,
};
use bevy::{ecs::component::Mutable, prelude::*};
use bevy_egui::{EguiContexts, egui};
use std::path::{Path, PathBuf};

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
            Option<&'static mut Weathering>,
            Option<&'static Name>,
            &'static PlumageState,
        ),
    >,
    cards: Query<'w, 's, (&'static PlumageCards, &'static FeathersOf)>,
}

/// Width of the window on the right, its frame included, in points.
const RIGHT: f32 = 264.0;

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
    let (down, pressed, released) = context.input(|input| {
        let pointer = &input.pointer;
        (
            pointer.any_down(),
            pointer.any_pressed(),
            pointer.any_released(),
        )
    });
    // A press begins a new step of the history; so does what comes after a release, which itself may still move a slider.
    if pressed || inspector.released {
        inspector.next_gesture();
    }
    inspector.released = released;
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
    if !pointer_down
        && let Some((bird, plumage)) = inspector.pending.take()
        && let Ok((_, mut worn, ..)) = world.birds.get_mut(bird)
    {
        worn.set_if_neq(plumage);
    }
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
        .min_width(300.0)
        .constrain_to(context.content_rect().shrink(8.0));
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
        .map_or_else(|| "no bird".to_owned(), |(e, .., name, _)| label(e, name));
    egui::ComboBox::from_id_salt("bird")
        .selected_text(selected)
        .show_ui(ui, |ui| {
            for (entity, .., name, _) in &world.birds {
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
        .find(|(_, of)| Some(of.0) == inspector.bird)
        .map(|(worn, _)| worn.feathers.clone())
        .unwrap_or_default();
    #[cfg(feature = "photo")]
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
    #[cfg(feature = "photo")]
    super::photo::photo_panel(ui, &mut inspector.photos, inspector.feather);
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
    let document = inspector.feathers.document(id, asset, file);
    let folder = folder_of(document, &inspector.assets, "feathers");
    let saved = document.is_changed().then(|| document.saved().clone());
    let mut value = document.present().clone();
    inspector.feathers.list(&folder);
    let reset = saved.as_ref().map(|_| "Back to what was last saved");
    let command = inspector
        .feathers
        .parts(id)
        .and_then(|(document, bar)| toolbar(ui, bar, document, reset));
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
        inspector.feathers.run(id, command, &folder, saved, gesture);
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
    let document = inspector.grooms.document(id, asset, file);
    let folder = folder_of(document, &inspector.assets, "grooms");
    let saved = document.is_changed().then(|| document.saved().clone());
    let mut value = document.present().clone();
    inspector.grooms.list(&folder);
    let reset = saved.as_ref().map(|_| "Back to what was last saved");
    let command = inspector
        .grooms
        .parts(id)
        .and_then(|(document, bar)| toolbar(ui, bar, document, reset));
    let mut plumage = inspector
        .pending
        .as_ref()
        .filter(|(bird, _)| Some(*bird) == inspector.bird)
        .map(|(_, plumage)| plumage.clone())
        .or_else(|| Some(world.birds.get(inspector.bird?).ok()?.1.clone()));
    let state = inspector
        .bird
        .and_then(|bird| world.birds.get(bird).ok())
        .map(|(.., state)| state.clone())
        .unwrap_or_default();
    let mut changed = false;
    scroll(ui, |ui| {
        if let Some((bird, plumage)) = inspector.bird.zip(plumage.as_mut())
            && plumage_panel(ui, plumage, &state)
        {
            inspector.pending = Some((bird, plumage.clone()));
        }
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
        inspector.grooms.run(id, command, &folder, saved, gesture);
    }
}

fn quality_tab(
    ui: &mut egui::Ui,
    inspector: &mut Inspector,
    world: &mut World,
    commands: &mut Commands,
) {
    let Some((entity, _, quality, weathering, ..)) = inspector
        .bird
        .and_then(|bird| world.birds.get_mut(bird).ok())
    else {
        ui.label("There is no bird.");
        return;
    };
    let mut new_quality = quality.as_deref().copied().unwrap_or_default();
    let mut new_weather = weathering.as_deref().cloned().unwrap_or_default();
    let (mut changed, mut weather_changed) = (false, false);
    scroll(ui, |ui| {
        changed = quality_panel(ui, &inspector.fields, &mut new_quality);
        ui.separator();
        weather_changed = weather_panel(ui, &inspector.fields, &mut new_weather.weather);
    });
    if changed {
        put(commands, entity, quality, new_quality);
    }
    if weather_changed {
        put(commands, entity, weathering, new_weather);
    }
}

/// Replaces a component of the bird, or gives it one.
fn put<C: Component<Mutability = Mutable> + PartialEq>(
    commands: &mut Commands,
    bird: Entity,
    old: Option<Mut<C>>,
    new: C,
) {
    match old {
        Some(mut old) => {
            old.set_if_neq(new);
        }
        None => {
            commands.entity(bird).insert(new);
        }
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
        .default_pos(context.content_rect().right_top() + egui::vec2(-8.0 - RIGHT, 8.0))
        .default_width(RIGHT - 14.0)
        .default_height(640.0)
        .min_width(200.0)
        .constrain_to(context.content_rect().shrink(8.0));
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
                    ui.weak("Click a feather on the bird to see what it is.");
                }
            }
            ui.separator();
            for (key, what) in [
                ("F12", "hides the panels"),
                ("hold C", "shows the saved state"),
                ("Ctrl+Z", "undoes, with Shift redoes; +S saves"),
            ] {
                ui.weak(format!("{key}: {what}"));
            }
        });
    });
}

/// Keys for the document of the tab shown.
fn shortcuts(context: &egui::Context, inspector: &mut Inspector, world: &World) {
    if context.egui_wants_keyboard_input() {
        return;
    }
    let shift = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    // A slow frame may bring a key several times.
    let (command, times) = context.input_mut(|input| {
        let redo = input.count_and_consume_key(shift, egui::Key::Z);
        let undo = input.count_and_consume_key(egui::Modifiers::COMMAND, egui::Key::Z);
        if redo > 0 {
            (Some(Command::Redo), redo)
        } else if undo > 0 {
            (Some(Command::Undo), undo)
        } else if input.consume_key(egui::Modifiers::COMMAND, egui::Key::S) {
            (Some(Command::Save { overwrite: false }), 1)
        } else if input.key_pressed(egui::Key::C) && input.modifiers.is_none() {
            (Some(Command::Compare(true)), 1)
        } else if input.key_released(egui::Key::C) {
            (Some(Command::Compare(false)), 1)
        } else {
            (None, 0)
        }
    });
    let Some(command) = command else {
        return;
    };
    for _ in 0..times {
        carry_out(inspector, world, command.clone());
    }
}

/// A command for the document of the tab shown.
fn carry_out(inspector: &mut Inspector, world: &World, command: Command) {
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
