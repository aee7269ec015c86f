//! From a [`Down`] to the textures and tables that its coats share: baked once on a worker thread.

use super::{Down, Transfer as TransferKind, material::COLUMN};
use crate::asset::{AssetError, RonAsset};
use crate::maths::undercoat::{
    Tile,
    density::{self, Density, DownShape},
    march::extinction_sine,
    texture::{self, Fur, fur_tile},
    tier::tier_correction,
    transfer::{Transfer, TransferSettings, bake, transfer_texture},
};
use bevy::{
    asset::{AssetEvent, AssetId, Assets, Handle, RenderAssetUsages},
    ecs::prelude::*,
    image::{Image, ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    math::{UVec3, Vec3, Vec4},
    platform::collections::HashMap,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};

/// Clumps along a tile.
const CLUMPS: u32 = 8;
/// Levels of the density texture.
const MIPS: usize = 4;
/// Rays for each node of the table that joins the tiers.
const CORRECTION_RAYS: u32 = 128;

/// What is baked of one down.
#[derive(Clone, Debug)]
pub(super) struct TileBake {
    size: UVec3,
    levels: u32,
    density: Vec<u8>,
    transfer_size: UVec3,
    transfer: Vec<u8>,
    pub(super) table: Table,
}

/// The numbers among what is baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Table {
    /// Extinction that 255 in the density texture stands for, optical depth per height across the fibres.
    pub largest: f32,
    /// Mean extinction across the fibres.
    pub mean: f32,
    /// Mean optical depth above each height.
    pub column: [Vec4; COLUMN / 4],
    /// How the higher bands of the transfer follow from its four numbers.
    pub bands: [Vec4; 8],
    /// [`tier_correction`].
    pub correction: [Vec4; 18],
}

/// A baked down on its way to the GPU.
#[derive(Clone, Debug)]
pub(super) struct Baked {
    pub density: Handle<Image>,
    pub transfer: Handle<Image>,
    pub table: Table,
    pub bytes: u64,
}

enum Bake {
    Busy(Task<Result<TileBake, AssetError>>),
    Done(Box<Baked>),
    Failed(String),
}

/// Baked downs by asset.
#[derive(Resource, Default)]
pub(super) struct Bakes(HashMap<AssetId<Down>, Bake>);

impl Bakes {
    /// The bake of a down, begun if there is none yet. `None` while it is under way.
    pub(super) fn get(
        &mut self,
        id: AssetId<Down>,
        down: &Down,
        images: &mut Assets<Image>,
    ) -> Option<Result<Baked, String>> {
        let bake = self.0.entry(id).or_insert_with(|| {
            let down = down.clone();
            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
            Bake::Busy(pool.spawn(async move { bake_tile(&down) }))
        });
        if let Bake::Busy(task) = bake
            && let Some(result) = block_on(poll_once(task))
        {
            *bake = match result {
                Ok(baked) => Bake::Done(Box::new(upload(baked, images))),
                Err(error) => Bake::Failed(error.to_string()),
            };
        }
        match bake {
            Bake::Busy(_) => None,
            Bake::Done(baked) => Some(Ok((**baked).clone())),
            Bake::Failed(error) => Some(Err(error.clone())),
        }
    }
}

/// Forgets what was baked of a down that has changed or gone.
pub(super) fn forget_changed(
    mut events: MessageReader<AssetEvent<Down>>,
    mut bakes: ResMut<Bakes>,
) {
    for event in events.read() {
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
            bakes.0.remove(id);
        }
    }
}

fn upload(bake: TileBake, images: &mut Assets<Image>) -> Baked {
    let image = |size: UVec3, levels: u32, data: Vec<u8>, format| {
        let mut image = Image::new_uninit(
            Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: size.z,
            },
            TextureDimension::D3,
            format,
            RenderAssetUsages::RENDER_WORLD,
        );
        image.texture_descriptor.mip_level_count = levels;
        image.data = Some(data);
        image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
            address_mode_u: ImageAddressMode::Repeat,
            address_mode_v: ImageAddressMode::Repeat,
            address_mode_w: ImageAddressMode::ClampToEdge,
            mag_filter: ImageFilterMode::Linear,
            min_filter: ImageFilterMode::Linear,
            mipmap_filter: ImageFilterMode::Linear,
            ..ImageSamplerDescriptor::default()
        });
        image
    };
    Baked {
        bytes: (bake.density.len() + bake.transfer.len()) as u64,
        density: images.add(image(
            bake.size,
            bake.levels,
            bake.density,
            TextureFormat::R8Unorm,
        )),
        transfer: images.add(image(
            bake.transfer_size,
            1,
            bake.transfer,
            TextureFormat::Rgba8Unorm,
        )),
        table: bake.table,
    }
}

/// The tile of a down.
pub(super) fn down_tile(down: &Down) -> Result<Tile, AssetError> {
    let fail = |error: String| AssetError::value("coats", error, "hairs that can be drawn");
    let size = UVec3::from(down.tile);
    let width = (down.tile_metres() / (1.0e-3 * down.thickness_mm)).clamp(0.01, 1000.0);
    if down.coats.is_empty() {
        let shape = DownShape {
            clumps: CLUMPS,
            fibres: 3 * CLUMPS,
            jitter: down.uv_jitter,
            bend: down.bend,
            spread: [
                down.tangent_spread.skin,
                down.tangent_spread.tips - down.tangent_spread.skin,
            ],
            seed: down.seed as u32,
            ..DownShape::default()
        };
        return density::down_tile(&shape, size, width, down.optical_depth.max(0.01))
            .ok_or_else(|| fail("nothing".into()));
    }
    let fur = Fur {
        size,
        width,
        optical_depth: down.optical_depth.max(0.01),
        coats: down
            .coats
            .iter()
            .map(|coat| texture::Coat {
                hairs: coat.hairs,
                radius: [coat.radius.low, coat.radius.high],
                length: [coat.length.low, coat.length.high],
                curl: [0.0, coat.curl],
            })
            .collect(),
        seed: down.seed,
    };
    fur_tile(&fur).map_err(|error| fail(error.to_string()))
}

/// Cosine between the fibres at height `z` (0..1) and the normal, and their spread there.
fn lean(down: &Down, z: f32) -> (f32, f32) {
    let share = down.bend * z;
    let upright = Vec3::new(share, 0.0, 1.0 - share);
    let spread =
        down.tangent_spread.skin + (down.tangent_spread.tips - down.tangent_spread.skin) * z;
    (upright.normalize_or(Vec3::Z).z, spread)
}

/// Mean over the azimuth of what fibres half-way up block of a ray with the cosine `mu` to the normal.
fn mean_sine(down: &Down, mu: f32) -> f32 {
    let (cos, spread) = lean(down, 0.5);
    let across = ((1.0 - mu * mu) * (1.0 - cos * cos)).max(0.0).sqrt();
    let azimuths = (0..8).map(|i| (std::f32::consts::TAU * i as f32 / 8.0).cos());
    azimuths
        .map(|turn| extinction_sine(mu * cos + across * turn, spread))
        .sum::<f32>()
        / 8.0
}

/// Bakes everything of a down.
fn bake_tile(down: &Down) -> Result<TileBake, AssetError> {
    down.validate(&down.name)?;
    let tile = down_tile(down)?;
    let density = Density::new(&tile);
    let layers = tile.size().z as usize;
    // The optical depth is meant straight down, where upright fibres show less of themselves than across.
    let seen = |(z, pair): (usize, &[f32])| {
        let (cos, spread) = lean(down, (z as f32 + 0.5) / layers as f32);
        (pair[0] - pair[1]) * extinction_sine(cos, spread)
    };
    let straight: f32 = density.columns().windows(2).enumerate().map(seen).sum();
    let scale = if straight > 0.0 {
        down.optical_depth / straight
    } else {
        0.0
    };
    let largest = tile.extinction().iter().copied().fold(1e-6, f32::max);
    let step = |e: &f32| (e / largest * 255.0).round().min(255.0) as u8;
    let levels: Vec<_> = density.levels().iter().take(MIPS).collect();
    let texels = levels
        .iter()
        .flat_map(|level| level.extinction.iter().map(step));
    let column = std::array::from_fn(|i| {
        let at = |k: usize| scale * density.column((4 * i + k) as f32 / (COLUMN - 1) as f32);
        Vec4::new(at(0), at(1), at(2), at(3))
    });
    let (transfer_size, transfer, bands) = match down.transfer {
        // Open above, whatever lies around.
        TransferKind::Off => (UVec3::ONE, vec![128, 128, 255, 128], [Vec4::ZERO; 8]),
        TransferKind::Four => {
            let fail = |error: String| AssetError::value("transfer", error, "a tile");
            // What reaches a place from all around is smooth: half the cells along each axis.
            let coarse = density.levels().get(1).unwrap_or(&density.levels()[0]);
            let upright = vec![Vec3::Z; coarse.extinction.len()];
            let coarse = Tile::new(
                coarse.size,
                tile.width(),
                coarse.extinction.clone(),
                upright,
            )
            .ok_or_else(|| fail("empty".into()))?;
            let raw = bake(&coarse, &TransferSettings::default(), 2)
                .map_err(|error| fail(error.to_string()))?;
            let transfer = Transfer::compress(&raw);
            let bytes = transfer_texture(&transfer, &coarse, 1)
                .into_iter()
                .next()
                .map(|mip| mip.bytes)
                .unwrap_or_default();
            (coarse.size(), bytes, transfer.bands.vec4s().map(Vec4::from))
        }
    };
    let correction = tier_correction(&density, CORRECTION_RAYS, |mu| scale * mean_sine(down, mu));
    Ok(TileBake {
        size: tile.size(),
        levels: levels.len() as u32,
        density: texels.collect(),
        transfer_size,
        transfer,
        table: Table {
            largest: largest * scale,
            mean: scale * density.mean(),
            column,
            bands,
            correction: std::array::from_fn(|i| Vec4::from_slice(&correction[4 * i..])),
        },
    })
}
