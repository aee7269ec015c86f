//! Photographs that become feathers in the background.

use crate::{
    anatomy::Feather,
    photo::{
        ExtractError, ExtractSettings, Extraction, ObjectChoice, PhotoObject, Progress, extract,
        load_photograph,
    },
};
use bevy::{
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};
use bevy_egui::egui;
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

/// Longest side of the picture in which one of several objects is chosen, pixels.
const CHOICE_SIDE: u32 = 480;

/// An extraction under way.
struct Job {
    file: PathBuf,
    progress: Arc<Mutex<f32>>,
    task: Task<Result<Extraction, Refusal>>,
}

/// Why there is no feather, and the reduced photograph where it shows several.
struct Refusal {
    error: ExtractError,
    picture: Option<Picture>,
}

/// A reduced photograph.
struct Picture {
    image: egui::ColorImage,
    /// Width and height of the photograph itself, pixels.
    full: Vec2,
}

/// A photograph of several objects, of which one has to be chosen.
pub struct PhotoChoice {
    /// The file.
    pub file: PathBuf,
    /// The objects from left to right.
    pub objects: Vec<PhotoObject>,
    picture: Picture,
    texture: Option<egui::TextureHandle>,
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
    /// Those that show several objects: a click on one takes it.
    pub choices: Vec<PhotoChoice>,
    error: Option<String>,
}

impl Photos {
    /// Begins the extraction of a file in the background.
    pub fn begin(&mut self, file: PathBuf) {
        self.begin_with(file, ObjectChoice::Only);
    }

    /// The same of one of several objects in it.
    pub fn begin_with(&mut self, file: PathBuf, object: ObjectChoice) {
        let progress = Arc::new(Mutex::new(0.0));
        let seen = progress.clone();
        let path = file.clone();
        let settings = ExtractSettings {
            name: name_of(&file),
            object,
            ..ExtractSettings::default()
        };
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        let task = pool.spawn(async move {
            let refused = |error| Refusal {
                error,
                picture: None,
            };
            let photograph = load_photograph(&path).map_err(refused)?;
            let found = extract(&photograph, &settings, &mut |progress: Progress| {
                if let Ok(mut seen) = seen.lock() {
                    *seen = progress.share;
                }
            });
            found.map_err(|error| Refusal {
                picture: matches!(error, ExtractError::SeveralObjects { .. }).then(|| {
                    let small = photograph.thumbnail(CHOICE_SIDE, CHOICE_SIDE).to_rgba8();
                    let size = [small.width() as usize, small.height() as usize];
                    Picture {
                        image: egui::ColorImage::from_rgba_unmultiplied(size, small.as_raw()),
                        full: Vec2::new(photograph.width() as f32, photograph.height() as f32),
                    }
                }),
                error,
            })
        });
        self.error = None;
        self.choices.retain(|choice| choice.file != file);
        self.jobs.push(Job {
            file,
            progress,
            task,
        });
    }

    /// Takes over what is finished: returns what became a feather, keeps what is to be chosen from and what is wrong.
    pub fn poll(&mut self) -> Vec<Extraction> {
        let mut finished = Vec::new();
        self.jobs
            .retain_mut(|job| match block_on(poll_once(&mut job.task)) {
                Some(result) => {
                    finished.push((job.file.clone(), result));
                    false
                }
                None => true,
            });
        let mut done = Vec::new();
        for (file, result) in finished {
            match result {
                Ok(extraction) => done.push(extraction),
                Err(Refusal {
                    error: ExtractError::SeveralObjects { objects },
                    picture: Some(picture),
                }) => self.choices.push(PhotoChoice {
                    file,
                    objects,
                    picture,
                    texture: None,
                }),
                Err(Refusal { error, .. }) => {
                    self.error = Some(format!("{}: {error}", file.display()));
                }
            }
        }
        done
    }

    /// How many are under way.
    pub fn busy(&self) -> usize {
        self.jobs.len()
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

fn file_name(file: &Path) -> std::borrow::Cow<'_, str> {
    file.file_name().unwrap_or_default().to_string_lossy()
}

/// Progress bars, errors, photographs to choose an object in, and the confidence of the feather shown.
pub fn photo_panel(ui: &mut egui::Ui, photos: &mut Photos, shown: Option<AssetId<Feather>>) {
    for job in &photos.jobs {
        let share = job.progress.lock().map_or(0.0, |share| *share);
        ui.add(egui::ProgressBar::new(share).text(file_name(&job.file)));
    }
    if let Some(error) = &photos.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    let mut chosen = None;
    for (i, choice) in photos.choices.iter_mut().enumerate() {
        if let Some(answer) = choice_panel(ui, choice) {
            chosen = Some((i, answer));
        }
    }
    if let Some((i, answer)) = chosen {
        let choice = photos.choices.remove(i);
        if let Some(object) = answer {
            photos.begin_with(choice.file, object);
        }
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

/// A photograph with a box around each object. Some answer: this one, or none of them.
fn choice_panel(ui: &mut egui::Ui, choice: &mut PhotoChoice) -> Option<Option<ObjectChoice>> {
    ui.label(format!(
        "{}: {} objects; click the feather",
        file_name(&choice.file),
        choice.objects.len()
    ));
    let texture = choice.texture.get_or_insert_with(|| {
        ui.ctx().load_texture(
            choice.file.to_string_lossy(),
            choice.picture.image.clone(),
            egui::TextureOptions::LINEAR,
        )
    });
    let picture = egui::Image::from_texture(&*texture)
        .max_width(ui.available_width())
        .sense(egui::Sense::click())
        .alt_text("photograph");
    let response = ui.add(picture);
    let rect = response.rect;
    let full = choice.picture.full;
    let place = |p: Vec2| rect.min + rect.size() * egui::vec2(p.x / full.x, p.y / full.y);
    let color = ui.visuals().selection.stroke.color;
    for (number, object) in (1..).zip(&choice.objects) {
        let around = egui::Rect::from_two_pos(place(object.low), place(object.high));
        let stroke = egui::Stroke::new(1.5, color);
        let painter = ui.painter();
        painter.rect_stroke(around, 2.0, stroke, egui::StrokeKind::Middle);
        painter.text(
            around.left_top(),
            egui::Align2::LEFT_TOP,
            number.to_string(),
            egui::FontId::proportional(14.0),
            color,
        );
    }
    let clicked = response.clicked().then(|| response.interact_pointer_pos());
    if let Some(at) = clicked.flatten() {
        let at = (at - rect.min) / rect.size();
        return Some(Some(ObjectChoice::At([at.x * full.x, at.y * full.y])));
    }
    ui.small_button("none of them").clicked().then_some(None)
}
