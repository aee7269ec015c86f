//! Fallback below the required limits: every feather is a plain textured card, cut out at its contour, with Bevy's standard
//! material.

use crate::{anatomy::Feather, groom::PlumageCards};
use bevy::{
    asset::RenderAssetUsages,
    mesh::VertexAttributeValues,
    platform::collections::HashMap,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

/// Size of one feather in the atlas, pixels.
const TILE: (usize, usize) = (64, 256);
/// Most feathers in one atlas; further ones look like the last. 8192 pixels is the width that WebGPU promises.
const MOST_TILES: usize = 8192 / TILE.0;

/// On a card mesh that is drawn by the fallback.
#[derive(Component)]
pub(super) struct FallbackCards {
    /// The mesh that it was made for.
    mesh: AssetId<Mesh>,
    /// Whether the material no longer shows the feathers as they are.
    stale: bool,
}

/// Ids of the assets that the messages not yet read call loaded, replaced or edited.
fn changed<A: Asset>(events: &mut MessageReader<AssetEvent<A>>) -> Vec<AssetId<A>> {
    let id = |event: &AssetEvent<A>| match event {
        AssetEvent::Added { id } | AssetEvent::Modified { id } => Some(*id),
        _ => None,
    };
    events.read().filter_map(id).collect()
}

/// Marks the cards whose feathers, or whose feathers' photographs, have changed.
pub(super) fn mark_stale(
    mut feather_events: MessageReader<AssetEvent<Feather>>,
    mut image_events: MessageReader<AssetEvent<Image>>,
    feathers: Res<Assets<Feather>>,
    mut drawn: Query<(&PlumageCards, &mut FallbackCards)>,
) {
    let (edited, pictures) = (changed(&mut feather_events), changed(&mut image_events));
    if edited.is_empty() && pictures.is_empty() {
        return;
    }
    for (cards, mut drawn) in &mut drawn {
        let pictured = |id: AssetId<Feather>| {
            let image = feathers.get(id).and_then(|feather| feather.image.as_ref());
            image.is_some_and(|image| pictures.contains(&image.id()))
        };
        let stale =
            |feather: &Handle<Feather>| edited.contains(&feather.id()) || pictured(feather.id());
        if cards.all_feathers().any(stale) {
            drawn.stale = true;
        }
    }
}

/// Gives every groomed bird a standard material with its feathers in one texture.
pub(super) fn prepare_fallback(
    mut commands: Commands,
    mut squeezed: Local<HashMap<AssetId<Mesh>, usize>>,
    server: Res<AssetServer>,
    mut birds: Query<(
        Entity,
        Ref<PlumageCards>,
        &Mesh3d,
        Option<&mut FallbackCards>,
    )>,
    feathers: Res<Assets<Feather>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (entity, cards, mesh, drawn) in &mut birds {
        let known = drawn.as_ref().filter(|drawn| drawn.mesh == mesh.id());
        if known.is_some_and(|drawn| !drawn.stale) && !cards.is_changed() {
            continue;
        }
        if let Some(mut drawn) = drawn {
            drawn.stale = true;
        }
        let assets = cards.all_feathers().map(|handle| feathers.get(handle));
        let Some(assets) = assets.collect::<Option<Vec<_>>>() else {
            continue;
        };
        // A picture that failed to load leaves the painted pattern; the loader has said so.
        let pending = |image: &Handle<Image>| {
            images.get(image).is_none() && !server.load_state(image).is_failed()
        };
        if assets
            .iter()
            .any(|feather| feather.image.as_ref().is_some_and(pending))
        {
            continue;
        }
        let Some(mut shape) = meshes.get_mut(mesh.id()) else {
            continue;
        };
        let tiles = assets.len().clamp(1, MOST_TILES);
        // Equal birds share a mesh.
        let before = squeezed.insert(mesh.id(), tiles);
        to_atlas(&mut shape, &cards, before, tiles);
        drop(shape);
        squeezed.retain(|id, _| meshes.contains(*id));
        let atlas = atlas(&assets, &cards, &images, tiles);
        let material = StandardMaterial {
            base_color_texture: Some(images.add(atlas)),
            alpha_mode: AlphaMode::Mask(0.5),
            perceptual_roughness: 0.8,
            reflectance: 0.2,
            double_sided: true,
            cull_mode: None,
            ..default()
        };
        commands.entity(entity).insert((
            MeshMaterial3d(materials.add(material)),
            FallbackCards {
                mesh: mesh.id(),
                stale: false,
            },
        ));
    }
}

/// Squeezes the texture coordinates of every card into its feather's tile. `before`: tiles of the atlas that they are in already.
fn to_atlas(mesh: &mut Mesh, cards: &PlumageCards, before: Option<usize>, count: usize) {
    let Ok(VertexAttributeValues::Float32x2(ids)) = mesh.try_attribute(Mesh::ATTRIBUTE_UV_1) else {
        return;
    };
    let feather_of = |id: &[f32; 2]| {
        let card = cards.cards.get(id[0].max(0.0).round() as usize);
        card.map_or(0, |card| usize::from(card.feather).min(count - 1))
    };
    let tiles: Vec<usize> = ids.iter().map(feather_of).collect();
    if let Ok(VertexAttributeValues::Float32x2(uvs)) = mesh.try_attribute_mut(Mesh::ATTRIBUTE_UV_0)
    {
        // Half a pixel of margin keeps the neighbor out.
        let margin = 0.5 / TILE.0 as f32;
        for (uv, tile) in uvs.iter_mut().zip(tiles) {
            let across = before.map_or(uv[0], |before| (uv[0] * before as f32).fract());
            uv[0] = (tile as f32 + across.clamp(margin, 1.0 - margin)) / count as f32;
        }
    }
}

/// One tile per feather, side by side: its front, tinted by the mean of its cards' tints; alpha is the contour.
fn atlas(
    feathers: &[&Feather],
    cards: &PlumageCards,
    images: &Assets<Image>,
    count: usize,
) -> Image {
    let (width, height) = TILE;
    let mut data = vec![0u8; width * count * height * 4];
    for (tile, feather) in feathers.iter().take(count).enumerate() {
        let tint = mean_tint(cards, tile);
        let baked = feather.bake_picture(images, width, height);
        for y in 0..height {
            for x in 0..width {
                let to = (y * width * count + tile * width + x) * 4;
                let mixed = baked.color(y * width + x, &tint);
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

fn mean_tint(cards: &PlumageCards, feather: usize) -> LinearRgba {
    let mut sum = Vec3::ZERO;
    let mut count = 0.0f32;
    for card in cards.cards.iter() {
        if usize::from(card.feather) == feather {
            sum += Vec3::from(card.tint);
            count += 1.0;
        }
    }
    let mean = sum / count.max(1.0);
    LinearRgba::rgb(mean.x, mean.y, mean.z)
}
