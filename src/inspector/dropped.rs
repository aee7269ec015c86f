//! A photograph dropped on the window becomes a feather.

use super::{photo::Photo, state::Inspector};
use crate::{anatomy::Feather, photo::Extraction};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
    tasks::{block_on, poll_once},
    window::FileDragAndDrop,
};

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
