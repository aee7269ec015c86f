//! A photograph dropped on the window becomes a feather.

use super::{
    photo::Photo,
    state::{Inspector, Tab},
};
use crate::{anatomy::Feather, photo::Extraction};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
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
            inspector.tab = Tab::Feather;
        }
    }
    for extraction in inspector.photos.poll() {
        let mut feather = extraction.feather.clone();
        feather.image = Some(images.add(image_of(&extraction)));
        let handle = feathers.add(feather);
        inspector.feather = Some(handle.id());
        inspector.photos.done.push(Photo {
            feather: handle,
            extraction,
        });
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
