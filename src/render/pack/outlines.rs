//! The outlines of a bird's feathers as a texture array: what distant cards are cut out by.

use super::mips::append_with_mips;
use crate::{anatomy::Feather, maths::query::MAP_SIZE};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};

/// Shorter side of the smallest level.
const LEAST_SIDE: u32 = 2;

/// Whether two states of a feather have the same outline on their cards, but for the curve of the rachis.
pub fn same_outline(a: &Feather, b: &Feather) -> bool {
    a.contour == b.contour
        && a.aspect == b.aspect
        && a.gaps == b.gaps
        && a.clumps == b.clumps
        && a.left.barb_angle == b.left.barb_angle
        && a.right.barb_angle == b.right.barb_angle
}

/// The outlines of one bird, a layer per feather ([`Feather::outline_map`]), with mip levels.
pub fn outline_array(feathers: &[&Feather]) -> Image {
    let [width, height] = MAP_SIZE;
    let mut data = Vec::new();
    let mut levels = 1;
    for feather in feathers {
        let map = feather.outline_map();
        levels = append_with_mips::<1>(&mut data, map, width, height, LEAST_SIDE);
    }
    let mut image = Image::new_uninit(
        Extent3d {
            width,
            height,
            depth_or_array_layers: feathers.len().max(1) as u32,
        },
        TextureDimension::D2,
        TextureFormat::R8Unorm,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some(data);
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..default()
    });
    image
}
