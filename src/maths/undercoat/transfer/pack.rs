//! Transfer as one texture.

use super::{Four, Transfer, TransferBands};
use crate::maths::functions::{Real, real};
use crate::maths::undercoat::Tile;
use bevy::math::UVec3;

/// One level of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Mip {
    /// Texels along x, y and z.
    pub size: UVec3,
    /// Four bytes a texel.
    pub bytes: Vec<u8>,
}

/// A 3D texture of format `Rgba8Unorm`, one texel a cell: the bent vector over [`TransferBands::longest`], from -1..1 to 0..255, and
/// the openness. Up to `levels` mips, largest first; a level is the mean of the finer one weighted by what is seen of it, its
/// extinction. Empty if the tile is not the one that was baked.
pub fn transfer_texture(transfer: &Transfer, tile: &Tile, levels: u32) -> Vec<Mip> {
    let mut size = tile.size();
    if transfer.cells.len() != tile.extinction().len() {
        return Vec::new();
    }
    // A cell that is empty still counts for look-ups next to it.
    let least = 1e-3 * tile.extinction().iter().copied().fold(1e-3, f32::max);
    let mut cells: Vec<(f32, [f32; 4])> = transfer
        .cells
        .iter()
        .zip(tile.extinction())
        .map(|(four, e)| {
            let [x, y, z] = four.bent;
            (e + least, [x, y, z, four.openness])
        })
        .collect();
    let mut mips = Vec::new();
    for _ in 0..levels.max(1) {
        mips.push(Mip {
            size,
            bytes: cells
                .iter()
                .flat_map(|(_, cell)| encode(cell, transfer.bands.longest))
                .collect(),
        });
        if size == UVec3::ONE {
            break;
        }
        (size, cells) = halve(size, &cells);
    }
    mips
}

fn encode(cell: &[f32; 4], longest: f32) -> [u8; 4] {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [x, y, z] = [cell[0], cell[1], cell[2]].map(|v| byte(0.5 + 0.5 * v / longest));
    [x, y, z, byte(cell[3])]
}

fn halve(size: UVec3, cells: &[(f32, [f32; 4])]) -> (UVec3, Vec<(f32, [f32; 4])>) {
    let half = (size / 2).max(UVec3::ONE);
    let mut out = Vec::with_capacity(half.as_usizevec3().element_product());
    for z in 0..half.z {
        for y in 0..half.y {
            for x in 0..half.x {
                let mut weight = 0.0;
                let mut sum = [0.0; 4];
                for corner in 0..8 {
                    let offset = UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
                    let p = (UVec3::new(x, y, z) * 2 + offset).min(size - 1);
                    let (w, cell) = cells[(p.x + size.x * (p.y + size.y * p.z)) as usize];
                    weight += w;
                    for (sum, value) in sum.iter_mut().zip(cell) {
                        *sum += w * value;
                    }
                }
                out.push((weight / 8.0, sum.map(|v| v / weight)));
            }
        }
    }
    (half, out)
}

/// A texel (each channel 0 to 1) as it was before packing.
pub fn transfer_decode<T: Real>(texel: [T; 4], bands: &TransferBands) -> Four<T> {
    let longest = real::<T>(f64::from(bands.longest));
    let [x, y, z, openness] = texel;
    Four {
        bent: [x, y, z].map(|v| (v + v - T::one()) * longest),
        openness,
    }
}
