//! Undo, redo, reset, compare, save and load: the same bar for feathers and grooms.

use crate::inspector::{
    command::Command,
    document::{Document, Editable},
};
use bevy_egui::egui;
use std::path::PathBuf;

/// What the bar remembers between frames.
#[derive(Clone, Debug, Default)]
pub struct Toolbar {
    /// Name typed for "save as".
    pub name: String,
    /// Files that can be loaded.
    pub files: Vec<PathBuf>,
    /// The question "overwrite?" is open.
    pub asking: bool,
    /// The state last saved is shown.
    pub comparing: bool,
    /// What was done last, or why it failed.
    pub message: Option<Result<String, String>>,
}

/// Draws the bar; what was asked for, if anything. `reset` says what "Reset" goes back to, if it can.
pub fn toolbar<T: Editable>(
    ui: &mut egui::Ui,
    bar: &mut Toolbar,
    document: &Document<T>,
    reset: Option<&str>,
) -> Option<Command> {
    let mut command = None;
    let (back, forth) = document.depth();
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut egui::Ui, enabled, text: &str, hint: String, ask: Command| {
            if ui
                .add_enabled(enabled, egui::Button::new(text))
                .on_hover_text(hint)
                .clicked()
            {
                command = Some(ask);
            }
        };
        button(
            ui,
            back > 0,
            "Undo",
            format!("Ctrl+Z: {back} steps"),
            Command::Undo,
        );
        button(
            ui,
            forth > 0,
            "Redo",
            format!("Ctrl+Shift+Z: {forth} steps"),
            Command::Redo,
        );
        button(
            ui,
            reset.is_some(),
            "Reset",
            reset.unwrap_or_default().into(),
            Command::Reset,
        );
        let hint = "Hold C: the state last saved";
        let compare = ui
            .add_enabled(
                document.is_changed() || bar.comparing,
                egui::Button::selectable(bar.comparing, "Before"),
            )
            .on_hover_text(hint);
        if compare.clicked() {
            command = Some(Command::Compare(!bar.comparing));
        }
    });
    ui.horizontal_wrapped(|ui| {
        let save = egui::Button::new(if document.is_changed() {
            "Save *"
        } else {
            "Save"
        })
        .min_size(egui::vec2(50.0, 0.0));
        if ui
            .add_enabled(document.file().is_some(), save)
            .on_hover_text(document.file().map_or_else(
                || "It has no file yet: save it under a name".to_owned(),
                |file| file.display().to_string(),
            ))
            .clicked()
        {
            command = Some(Command::Save { overwrite: false });
        }
        ui.add(
            egui::TextEdit::singleline(&mut bar.name)
                .hint_text("name")
                .desired_width(90.0),
        );
        let named = !bar.name.trim().is_empty();
        if ui
            .add_enabled(named, egui::Button::new("Save as"))
            .on_hover_text(format!("NAME.{}", T::EXTENSION))
            .clicked()
        {
            command = Some(Command::SaveAs(bar.name.trim().to_owned()));
        }
        ui.menu_button("Load", |ui| {
            egui::ScrollArea::vertical()
                .max_height(300.0)
                .show(ui, |ui| {
                    if bar.files.is_empty() {
                        ui.label("No files in the folder");
                    }
                    for file in &bar.files {
                        let name = file.file_name().unwrap_or_default().to_string_lossy();
                        if ui.button(name).clicked() {
                            command = Some(Command::Load(file.clone()));
                            ui.close();
                        }
                    }
                });
        });
    });
    if bar.asking {
        ui.horizontal_wrapped(|ui| {
            ui.colored_label(ui.visuals().warn_fg_color, "The file has changed on disk.");
            if ui.button("Overwrite it").clicked() {
                command = Some(Command::Save { overwrite: true });
            }
            if let Some(file) = document.file()
                && ui.button("Load it").clicked()
            {
                command = Some(Command::Load(file.to_path_buf()));
            }
            if ui.button("Cancel").clicked() {
                bar.asking = false;
            }
        });
    }
    match &bar.message {
        Some(Ok(text)) => {
            ui.label(text);
        }
        Some(Err(text)) => {
            ui.colored_label(ui.visuals().error_fg_color, text);
        }
        // The line stays, so that nothing below moves under the pointer.
        None if document.is_changed() => {
            ui.weak("Not saved");
        }
        None => {
            ui.weak(if document.file().is_some() {
                "As in its file"
            } else {
                "It has no file yet"
            });
        }
    }
    ui.separator();
    command
}
