//! A photograph dropped on the window becomes a feather, in the background.

use super::state::Inspector;
use crate::{
    anatomy::Feather,
    extract::{ExtractError, ExtractSettings, Extraction, Progress, extract, load_photograph},
};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
    window::FileDragAndDrop,
};
use bevy_egui::egui;
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

/// An extraction under way.
struct Job {
    file: PathBuf,
    progress: Arc<Mutex<f32>>,
    task: Task<Result<Extraction, ExtractError>>,
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
    jobs: Vec<Job>,
    /// Done, oldest first.
    pub done: Vec<Photo>,
    error: Option<String>,
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

/// Takes dropped files in and finished extractions out.
pub(super) fn follow_photos(
    mut inspector: ResMut<Inspector>,
    mut dropped: MessageReader<FileDragAndDrop>,
    mut feathers: ResMut<Assets<Feather>>,
    mut images: ResMut<Assets<Image>>,
) {
    for event in dropped.read() {
        if let FileDragAndDrop::DroppedFile { path_buf, .. } = event {
            inspector.photos.begin(path_buf.clone());
        }
    }
    let mut finished = Vec::new();
    inspector
        .photos
        .jobs
        .retain_mut(|job| match block_on(poll_once(&mut job.task)) {
            Some(result) => {
                finished.push((job.file.clone(), result));
                false
            }
            None => true,
        });
    for (file, result) in finished {
        match result {
            Ok(extraction) => {
                let mut feather = extraction.feather.clone();
                feather.image = Some(images.add(image_of(&extraction)));
                let handle = feathers.add(feather);
                inspector.feather = Some(handle.id());
                inspector.photos.done.push(Photo {
                    feather: handle,
                    extraction,
                });
            }
            Err(error) => {
                inspector.photos.error = Some(format!("{}: {error}", file.display()));
            }
        }
    }
}

fn image_of(extraction: &Extraction) -> Image {
    let (width, height) = extraction.albedo.dimensions();
    Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        extraction.albedo.as_raw().clone(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::default(),
    )
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
