//! What a device without room for the feather pipelines gets: every feather is a plain textured card, cut out at its contour,
//! with Bevy's standard material.

use crate::{
    anatomy::{Feather, ShapeTable},
    groom::PlumageCards,
};
use bevy::{
    asset::RenderAssetUsages,
    mesh::VertexAttributeValues,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

/// How feathers are drawn. The plugin decides by the device's limits; an app may insert `CutOut` itself, before
/// `App::finish`, for machines that are too slow.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub enum FeatherPath {
    /// Barbs, barbules and fibre scattering.
    #[default]
    Full,
    /// A textured card cut out at the feather's contour.
    CutOut,
}

/// Size of one feather in the atlas, pixels.
const TILE: (usize, usize) = (64, 256);
/// Most feathers in one atlas; further ones look like the last. 8192 pixels is the width that WebGPU promises.
const MOST_TILES: usize = 8192 / TILE.0;

/// On a card mesh that is drawn cut out: its texture coordinates are the atlas's.
#[derive(Component)]
pub(super) struct CutOut;

/// Gives every groomed bird a standard material with its feathers in one texture.
pub(super) fn wear_cut_outs(
    mut commands: Commands,
    bare: Query<(Entity, &PlumageCards, &Mesh3d), Without<CutOut>>,
    feathers: Res<Assets<Feather>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (entity, worn, mesh) in &bare {
        let assets = worn.feathers.iter().map(|handle| feathers.get(handle));
        let Some(assets) = assets.collect::<Option<Vec<_>>>() else {
            continue;
        };
        let Some(mut mesh) = meshes.get_mut(mesh.id()) else {
            continue;
        };
        let count = assets.len().clamp(1, MOST_TILES);
        to_atlas(&mut mesh, worn, count);
        let material = StandardMaterial {
            base_color_texture: Some(images.add(atlas(&assets, worn, count))),
            alpha_mode: AlphaMode::Mask(0.5),
            perceptual_roughness: 0.8,
            reflectance: 0.2,
            double_sided: true,
            cull_mode: None,
            ..default()
        };
        commands
            .entity(entity)
            .insert((MeshMaterial3d(materials.add(material)), CutOut));
    }
}

/// Squeezes the texture coordinates of every card into its feather's tile.
fn to_atlas(mesh: &mut Mesh, worn: &PlumageCards, count: usize) {
    let Ok(VertexAttributeValues::Float32x2(ids)) = mesh.try_attribute(Mesh::ATTRIBUTE_UV_1) else {
        return;
    };
    let feather_of = |id: &[f32; 2]| {
        let card = worn.cards.get(id[0].max(0.0).round() as usize);
        card.map_or(0, |card| usize::from(card.feather).min(count - 1))
    };
    let tiles: Vec<usize> = ids.iter().map(feather_of).collect();
    if let Ok(VertexAttributeValues::Float32x2(uvs)) = mesh.try_attribute_mut(Mesh::ATTRIBUTE_UV_0)
    {
        // Half a pixel of margin keeps the neighbour out.
        let margin = 0.5 / TILE.0 as f32;
        for (uv, tile) in uvs.iter_mut().zip(tiles) {
            uv[0] = (tile as f32 + uv[0].clamp(margin, 1.0 - margin)) / count as f32;
        }
    }
}

/// One tile per feather, side by side: the painted front, tinted by the mean of its cards' tints; alpha is the contour.
fn atlas(feathers: &[&Feather], worn: &PlumageCards, count: usize) -> Image {
    let (width, height) = TILE;
    let mut data = vec![0u8; width * count * height * 4];
    for (tile, feather) in feathers.iter().take(count).enumerate() {
        let tint = mean_tint(worn, tile);
        let painted = feather.albedo.front.bake(width, height, feather);
        let alpha = contour_alpha(feather, width, height);
        for y in 0..height {
            for x in 0..width {
                let from = (y * width + x) * 4;
                let to = (y * width * count + tile * width + x) * 4;
                let share = f32::from(painted[from + 3]) / 255.0;
                let texel = Color::srgb_u8(painted[from], painted[from + 1], painted[from + 2]);
                let mixed = texel
                    .to_linear()
                    .mix(&tint, share)
                    .with_alpha(alpha[y * width + x]);
                data[to..to + 4].copy_from_slice(&Srgba::from(mixed).to_u8_array());
            }
        }
    }
    Image::new(
        Extent3d {
            width: (width * count) as u32,
            height: height as u32,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        data,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    )
}

fn mean_tint(worn: &PlumageCards, feather: usize) -> LinearRgba {
    let mut sum = Vec3::ZERO;
    let mut count = 0.0f32;
    for card in worn.cards.iter() {
        if usize::from(card.feather) == feather {
            sum += Vec3::from(card.tint);
            count += 1.0;
        }
    }
    let mean = sum / count.max(1.0);
    LinearRgba::rgb(mean.x, mean.y, mean.z)
}

/// Share of each texel inside the contour or on the rachis, 0..1.
fn contour_alpha(feather: &Feather, width: usize, height: usize) -> Vec<f32> {
    let shape = feather.shape_table();
    let map = feather.map();
    let texel = feather.aspect / width as f32;
    let mut alpha = Vec::with_capacity(width * height);
    for y in 0..height {
        let v = (y as f64 + 0.5) / height as f64;
        let row = (v * (shape.rachis.len() - 1) as f64) as usize;
        let shaft = shape.rachis.get(row).map_or(0.0, |row| row[2]).max(texel);
        for x in 0..width {
            let place = map.canonical([(x as f64 + 0.5) / width as f64, v]);
            let place = place.map(|c| c as f32);
            let inside = reach(feather, &shape, place) - place[0].abs();
            let inside = inside.max(shaft - place[0].abs());
            alpha.push((inside / texel + 0.5).clamp(0.0, 1.0));
        }
    }
    alpha
}

/// How far the vane reaches from the rachis along x, at the barb through a place; below 0 where no barb is rooted.
fn reach(feather: &Feather, shape: &ShapeTable, place: [f32; 2]) -> f32 {
    let left = place[0] < 0.0;
    let vane = if left { &feather.left } else { &feather.right };
    let angle = vane.barb_angle.to_radians();
    let root = place[1] - place[0].abs() * angle.cos() / angle.sin().max(1e-3);
    if root < shape.start || shape.contour.is_empty() {
        return -1.0;
    }
    let last = (shape.contour.len() - 1) as f32;
    let row = (root - shape.start) / (1.0 - shape.start).max(1e-3) * last;
    let row = row.clamp(0.0, last) as usize;
    shape.contour[row][usize::from(!left)]
}
