//! Photographs that become feathers in the background.

use crate::{
    anatomy::Feather,
    photo::{ExtractError, ExtractSettings, Extraction, Progress, extract, load_photograph},
};
use bevy::{
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool},
};
use bevy_egui::egui;
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

/// An extraction under way.
pub(super) struct Job {
    pub(super) file: PathBuf,
    progress: Arc<Mutex<f32>>,
    pub(super) task: Task<Result<Extraction, ExtractError>>,
}

/// A feather that came from a photograph.
pub struct Photo {
    /// The asset.
    pub feather: Handle<Feather>,
    /// What the extraction found.
    pub extraction: Extraction,
}

/// Photographs under way and done.
#[derive(Default)]
pub struct Photos {
    pub(super) jobs: Vec<Job>,
    /// Done, oldest first.
    pub done: Vec<Photo>,
    pub(super) error: Option<String>,
}

impl Photos {
    /// Begins the extraction of a file in the background.
    pub fn begin(&mut self, file: PathBuf) {
        let progress = Arc::new(Mutex::new(0.0));
        let seen = progress.clone();
        let path = file.clone();
        let settings = ExtractSettings {
            name: name_of(&file),
            ..ExtractSettings::default()
        };
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        let task = pool.spawn(async move {
            let image = load_photograph(&path)?;
            extract(&image, &settings, &mut |progress: Progress| {
                if let Ok(mut seen) = seen.lock() {
                    *seen = progress.share;
                }
            })
        });
        self.error = None;
        self.jobs.push(Job {
            file,
            progress,
            task,
        });
    }

    /// The photograph of a feather, if it came from one.
    pub fn of(&self, id: AssetId<Feather>) -> Option<&Photo> {
        self.done.iter().find(|photo| photo.feather.id() == id)
    }
}

/// Name of the feather: the file's, in letters that a file name may have.
fn name_of(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = stem
        .chars()
        .take(64)
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .collect();
    if name.is_empty() {
        "photo".into()
    } else {
        name
    }
}

/// Progress bars, errors, and the confidence of the feather shown.
pub fn photo_panel(ui: &mut egui::Ui, photos: &Photos, shown: Option<AssetId<Feather>>) {
    for job in &photos.jobs {
        let share = job.progress.lock().map_or(0.0, |share| *share);
        let name = job.file.file_name().unwrap_or_default().to_string_lossy();
        ui.add(egui::ProgressBar::new(share).text(name));
    }
    if let Some(error) = &photos.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    let Some(photo) = shown.and_then(|id| photos.of(id)) else {
        return;
    };
    let confidence = &photo.extraction.confidence;
    ui.strong(format!(
        "From a photograph: confidence {:.2}",
        confidence.overall()
    ));
    for (result, doubt) in confidence.doubts() {
        ui.weak(format!("{result}: {doubt}"));
    }
    ui.weak("Save it under a name to keep it with its picture.");
}
