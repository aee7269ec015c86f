//! The albedo of a bird's feathers as a texture array.

use super::{mips::append_with_mips, outlines::same_outline};
use crate::anatomy::{Feather, Pattern, Weather};
use bevy::{
    asset::RenderAssetUsages,
    color::ColorToPacked,
    image::{ImageSampler, ImageSamplerDescriptor},
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};

/// Size of a baked albedo layer.
const ALBEDO_SIZE: (u32, u32) = (32, 128);
/// Shorter side of the smallest level.
const LEAST_SIDE: u32 = 4;
/// Size of the layers where a feather has a picture.
const PICTURE_SIZE: (u32, u32) = (128, 512);

/// Whether two states of a feather have the same textures: albedo and outline.
pub fn same_paint(a: &Feather, b: &Feather) -> bool {
    let paint = |feather: &Feather| {
        (
            feather.albedo.front.clone(),
            feather.albedo.back.clone(),
            feather.image.clone(),
            feather.weather,
        )
    };
    paint(a) == paint(b) && a.rachis == b.rachis && same_outline(a, b)
}

/// The albedo of one bird, two layers per feather: front, back. `images` serves albedo images that replace the painted front.
pub fn albedo_array(feathers: &[&Feather], images: &Assets<Image>) -> Image {
    let pictures = feathers.iter().any(|feather| feather.image.is_some());
    let (width, height) = if pictures { PICTURE_SIZE } else { ALBEDO_SIZE };
    let mut data = Vec::new();
    let mut levels = 1;
    for feather in feathers {
        let front = albedo_front(feather, images, width, height);
        let back: Option<&Pattern> = feather.albedo.back.as_ref();
        let back = back.map_or_else(
            || front.clone(),
            |back| weathered(feather, back.bake(width as usize, height as usize, feather)),
        );
        for face in [front, back] {
            levels = append_with_mips::<4>(&mut data, face, width, height, LEAST_SIDE);
        }
    }
    let mut image = Image::new_uninit(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 2 * feathers.len().max(1) as u32,
        },
        TextureDimension::D2,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some(data);
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..default()
    });
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor::linear());
    image
}

/// The front of a feather, RGBA8: its photograph if it has one, else the painted pattern; alpha is the share of the groom's tint.
pub fn albedo_front(feather: &Feather, images: &Assets<Image>, width: u32, height: u32) -> Vec<u8> {
    let photograph = feather.image.as_ref().and_then(|handle| images.get(handle));
    let face = photograph
        .and_then(|image| resample(image, width, height))
        .unwrap_or_else(|| {
            let painted = &feather.albedo.front;
            painted.bake(width as usize, height as usize, feather)
        });
    weathered(feather, face)
}

/// The colors of a face under the feather's weather.
fn weathered(feather: &Feather, mut face: Vec<u8>) -> Vec<u8> {
    if feather.weather == Weather::default() {
        return face;
    }
    for texel in face.chunks_exact_mut(4) {
        let color = Color::srgb_u8(texel[0], texel[1], texel[2]).to_linear();
        let [r, g, b] = feather.weather.color([color.red, color.green, color.blue]);
        texel[..3].copy_from_slice(&srgb_bytes([r, g, b]));
    }
    face
}

fn srgb_bytes([red, green, blue]: [f32; 3]) -> [u8; 3] {
    Srgba::from(LinearRgba::rgb(red, green, blue)).to_u8_array_no_alpha()
}

/// An image of any size as RGBA8 of the albedo's size, by the mean of the pixels that fall on each texel; its alpha counts as
/// "no tint".
fn resample(image: &Image, width: u32, height: u32) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity((width * height * 4) as usize);
    let size = image.size();
    // At least one pixel, at most all of them.
    let span = |i: u32, from: u32, to: u32| {
        let first = (i * from / to).min(from.saturating_sub(1));
        first..((i + 1) * from / to).clamp(first + 1, from.max(first + 1))
    };
    for y in 0..height {
        for x in 0..width {
            let (mut sum, mut count) = (Vec3::ZERO, 0.0);
            for py in span(y, size.y, height) {
                for px in span(x, size.x, width) {
                    let color = image.get_color_at(px, py).ok()?.to_linear();
                    sum += Vec3::new(color.red, color.green, color.blue);
                    count += 1.0;
                }
            }
            let mean = sum / count;
            out.extend(srgb_bytes(mean.to_array()));
            out.push(0);
        }
    }
    Some(out)
}
