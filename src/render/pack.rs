//! Feathers, fibre tables and cards as the shaders read them (twin of `shaders/feather_data.wgsl`).

use crate::{
    anatomy::{CONTOUR_ROWS, Feather, Pattern, RACHIS_ROWS, Side},
    groom::Card,
    query::mean_shadow,
    scattering::{FIBRE_ROW_VEC4S, FIBRE_ROWS, Fibre, FibreTable, SHEEN_TABLE_SIZE, sheen_row},
};
use bevy::{
    asset::RenderAssetUsages,
    image::{ImageSampler, ImageSamplerDescriptor},
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};

/// vec4s of a feather's header.
pub const HEADER_LENGTH: usize = 26;
/// vec4s of one feather.
pub const FEATHER_STRIDE: usize = HEADER_LENGTH + RACHIS_ROWS + CONTOUR_ROWS + SHEEN_TABLE_SIZE;
/// vec4s (of `u32`) of one card record.
pub const CARD_VEC4S: usize = 5;
/// Regions (and rows) that a card record can tell apart; further ones share the last.
pub const MAX_REGIONS: u32 = 128;
/// Size of a baked albedo layer.
const ALBEDO_SIZE: (u32, u32) = (32, 128);
/// Size of the layers where a feather has a picture.
const PICTURE_SIZE: (u32, u32) = (128, 512);

/// Tables are counted in steps of this many, so that an edit seldom changes the size of the buffer.
const TABLE_STEP: usize = 8;

/// Fibre tables built before, by what they were built from: building is the dear part of packing.
#[derive(Default)]
pub struct TableCache(Vec<(Fibre, FibreTable)>);

/// The buffer `feathers` of one bird, in the order given: header, feathers, fibre tables. Tables that `cache` knows are taken from it; it keeps those of these feathers.
pub fn pack_feathers(feathers: &[&Feather], cache: &mut TableCache) -> Vec<u8> {
    let known = std::mem::take(&mut cache.0);
    let mut tables: Vec<(Fibre, FibreTable)> = Vec::new();
    let mut rows: Vec<[f32; 4]> = vec![[0.0; 4]];
    for feather in feathers {
        pack_feather(feather, &mut rows, &mut tables, &known);
    }
    let first_table = rows.len();
    for (_, table) in &tables {
        rows.extend(table.pack_rows());
    }
    let room = tables.len().next_multiple_of(TABLE_STEP) - tables.len();
    rows.resize(rows.len() + room * FIBRE_ROWS * FIBRE_ROW_VEC4S, [0.0; 4]);
    rows[0] = [
        feathers.len() as f32,
        first_table as f32,
        tables.len() as f32,
        0.0,
    ];
    cache.0 = tables;
    rows.iter()
        .flatten()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// Whether two states of a feather have the same albedo texture.
pub fn same_paint(a: &Feather, b: &Feather) -> bool {
    let paint = |feather: &Feather| {
        (
            feather.albedo.front.clone(),
            feather.albedo.back.clone(),
            feather.image.clone(),
        )
    };
    paint(a) == paint(b) && a.contour == b.contour && a.rachis == b.rachis && a.aspect == b.aspect
}

fn vane_rows(feather: &Feather, side: Side) -> [[f32; 4]; 3] {
    let vane = feather.vane(side);
    let (sin_b, cos_b) = vane.alpha_b().sin_cos();
    let (sin_bl, cos_bl) = vane.alpha_bl().sin_cos();
    [
        [sin_b, cos_b, sin_bl, cos_bl],
        [
            feather.p_b(side),
            feather.d_bl(side),
            feather.r_b(side),
            feather.r_bd(side),
        ],
        [feather.r_bp(side), vane.fringe, vane.downy, vane.alpha_b()],
    ]
}

/// What fibres keep of light from all around: seen from the front of light from before and behind, seen from the back of both.
fn mean_shadows(feather: &Feather) -> [[f32; 4]; 4] {
    let vanes = Side::BOTH.map(|side| feather.query_vane(side));
    let rows = [true, false].map(|fronts| {
        let [left, right] = [0, 1].map(|side| mean_shadow(&vanes[side], fronts));
        [0, 1].map(|side| {
            std::array::from_fn(|part| (0.5 * (left[side][part] + right[side][part])) as f32)
        })
    });
    [rows[0][0], rows[0][1], rows[1][0], rows[1][1]]
}

fn pack_feather(
    feather: &Feather,
    rows: &mut Vec<[f32; 4]>,
    tables: &mut Vec<(Fibre, FibreTable)>,
    known: &[(Fibre, FibreTable)],
) {
    let start = rows.len();
    let shape = feather.shape_table();
    rows.push([
        feather.aspect,
        feather.length_mm * 1e-3,
        shape.start,
        // Without colours of its own the back of a structural feather is dark (its mirrors face outwards).
        f32::from(u8::from(feather.albedo.back.is_none())),
    ]);
    rows.extend(vane_rows(feather, Side::Left));
    rows.extend(vane_rows(feather, Side::Right));
    let sheen = feather.optics.sheen;
    rows.push([sheen.strength, sheen.roughness, 0.0, 0.0]);
    let optics = &feather.optics;
    let mut index = [0.0; 4];
    for (slot, fibre) in [optics.rachis, optics.barb, optics.distal, optics.proximal]
        .into_iter()
        .enumerate()
    {
        let table = tables
            .iter()
            .position(|(known, _)| *known == fibre)
            .unwrap_or_else(|| {
                let before = known.iter().find(|(other, _)| *other == fibre);
                let table =
                    before.map_or_else(|| FibreTable::build(&fibre), |(_, table)| table.clone());
                tables.push((fibre, table));
                tables.len() - 1
            });
        rows.extend(tables[table].1.pack_parameters());
        index[slot] = table as f32;
    }
    rows.push(index);
    let share = feather.albedo.share;
    rows.push([share.rachis, share.barb, share.barbule, share.barbule]);
    rows.extend(mean_shadows(feather));
    rows.resize(start + HEADER_LENGTH, [0.0; 4]);
    rows.extend_from_slice(&shape.rachis);
    rows.extend_from_slice(&shape.contour);
    rows.extend(sheen_row(sheen.roughness));
    debug_assert_eq!(rows.len() - start, FEATHER_STRIDE);
}

/// A direction as two signed 16-bit numbers of the octahedral map (Cigolle et al. 2014).
fn octahedral(direction: Vec3) -> u32 {
    let v = direction / direction.abs().element_sum().max(f32::MIN_POSITIVE);
    let folded = if v.z >= 0.0 {
        v.truncate()
    } else {
        (Vec2::ONE - v.yx().abs()) * Vec2::new(1f32.copysign(v.x), 1f32.copysign(v.y))
    };
    let [x, y] = folded
        .to_array()
        .map(|c| u32::from((c.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16));
    x | y << 16
}

/// Card records; five `vec4<u32>` each.
pub fn pack_cards(cards: &[Card]) -> Vec<u8> {
    let layers = cards
        .iter()
        .map(|card| card.layer)
        .fold((f32::MAX, f32::MIN), |(lo, hi), l| (lo.min(l), hi.max(l)));
    let mut data = Vec::with_capacity(cards.len() * CARD_VEC4S * 16);
    for card in cards {
        let mut word = |value: u32| data.extend_from_slice(&value.to_le_bytes());
        for value in card.root.to_array() {
            word(value.to_bits());
        }
        word(card.length.to_bits());
        for value in card.center.to_array() {
            word(value.to_bits());
        }
        word(card.radius.to_bits());
        for value in card.along.to_array() {
            word(value.to_bits());
        }
        word(card.width.to_bits());
        let [a, b, c, d] = card.joints.map(u32::from);
        word(a | b << 16);
        word(c | d << 16);
        let [a, b, c, d] = card
            .weights
            .map(|w| (w.clamp(0.0, 1.0) * 65535.0).round() as u32);
        word(a | b << 16);
        word(c | d << 16);
        let layer = (card.layer - layers.0) / (layers.1 - layers.0).max(1e-6);
        word(
            u32::from(card.feather)
                | u32::from(card.mirrored) << 16
                | u32::from(card.region).min(MAX_REGIONS - 1) << 17
                | ((layer.clamp(0.0, 1.0) * 255.0) as u32) << 24,
        );
        let [r, g, b] = card
            .tint
            .map(|t| (t.clamp(0.0, 1.0).sqrt() * 1023.0).round() as u32);
        word(r | g << 10 | b << 20);
        word(card.seed);
        word(octahedral(card.normal));
    }
    data
}

/// The albedo of one bird, two layers per feather: front, back. `images` serves albedo images that replace the painted front.
pub fn albedo_array(feathers: &[&Feather], images: &Assets<Image>) -> Image {
    let pictures = feathers.iter().any(|feather| feather.image.is_some());
    let (width, height) = if pictures { PICTURE_SIZE } else { ALBEDO_SIZE };
    let mut data = Vec::new();
    let mut levels = 1;
    for feather in feathers {
        let front = feather
            .image
            .as_ref()
            .and_then(|handle| images.get(handle))
            .and_then(|image| resample(image, width, height))
            .unwrap_or_else(|| {
                feather
                    .albedo
                    .front
                    .bake(width as usize, height as usize, feather)
            });
        let back: Option<&Pattern> = feather.albedo.back.as_ref();
        let back = back.map_or_else(
            || front.clone(),
            |back| back.bake(width as usize, height as usize, feather),
        );
        for face in [front, back] {
            levels = append_with_mips(&mut data, face, width, height);
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
            let color = Color::linear_rgb(mean.x, mean.y, mean.z).to_srgba();
            out.extend(
                [color.red, color.green, color.blue]
                    .map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8),
            );
            out.push(0);
        }
    }
    Some(out)
}

/// Appends a layer and its mip levels (halved by plain averages), largest first; returns the number of levels.
fn append_with_mips(
    data: &mut Vec<u8>,
    mut level: Vec<u8>,
    mut width: u32,
    mut height: u32,
) -> u32 {
    let mut count = 1;
    data.extend_from_slice(&level);
    while width > 4 && height > 4 {
        let (w, h) = (width / 2, height / 2);
        let mut next = Vec::with_capacity((w * h * 4) as usize);
        for y in 0..h {
            for x in 0..w {
                for c in 0..4 {
                    let at = |dx: u32, dy: u32| {
                        u32::from(level[(((2 * y + dy) * width + 2 * x + dx) * 4 + c) as usize])
                    };
                    next.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8);
                }
            }
        }
        data.extend_from_slice(&next);
        (level, width, height) = (next, w, h);
        count += 1;
    }
    count
}
