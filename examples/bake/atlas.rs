//! One picture of all feathers, and what is left to the vertices: each card's own color.

use super::gather::Bird;
use bevy::prelude::*;
use std::io::Cursor;

/// All feathers side by side.
pub struct Atlas {
    /// The picture as PNG.
    pub png: Vec<u8>,
    /// Linear color of each card, which the picture is multiplied by.
    pub colors: Vec<[f32; 3]>,
    /// Tiles in a row and rows.
    size: (usize, usize),
    /// Texels across a tile.
    width: usize,
}

impl Atlas {
    /// Place on the picture (v downwards) of a place on a feather's card.
    pub fn place(&self, feather: usize, [u, v]: [f32; 2]) -> [f32; 2] {
        let (columns, rows) = self.size;
        let tile = [feather % columns, feather / columns];
        // Half a texel keeps the neighbor out.
        let margin = 0.5 / self.width as f32;
        let inside = |x: f32, margin: f32| x.clamp(margin, 1.0 - margin);
        [
            (tile[0] as f32 + inside(u, margin)) / columns as f32,
            (tile[1] as f32 + inside(v, 0.25 * margin)) / rows as f32,
        ]
    }
}

/// Bakes the feathers; `done` hears of each.
///
/// A texel is paint where the groom has no say and the groom's color where it has; a vertex color can only multiply. So the texels are those
/// of a card of the feather's mean color, divided by how far that color reaches, and each card multiplies by how far its own does: exact for
/// cards of the mean color and for feathers that are all paint or all groom.
pub fn atlas(bird: &Bird, width: usize, mut done: impl FnMut(f32, &str)) -> Result<Atlas, String> {
    let count = bird.feathers.len();
    if count == 0 {
        return Err("the groom names no feather".into());
    }
    // Sides that are powers of two suit every engine.
    let columns = count.min(16).next_power_of_two();
    let rows = count.div_ceil(columns).next_power_of_two();
    let height = 4 * width;
    let mut picture = image::RgbaImage::new((columns * width) as u32, (rows * height) as u32);
    let mut colors = vec![[1.0; 3]; bird.cards.len()];
    for (number, feather) in bird.feathers.iter().enumerate() {
        done(number as f32 / count as f32, &feather.name);
        let baked = bird.baked(number, width).ok_or("a feather is gone")?;
        let (mut share, mut area) = (0.0, 0.0);
        for (tint, alpha) in baked.tint_share.iter().zip(&baked.alpha) {
            share += tint * alpha;
            area += alpha;
        }
        let share = share / f32::max(area, f32::MIN_POSITIVE);
        let wears = |card: &&bevy_plumage::Card| usize::from(card.feather) == number;
        let own: Vec<Vec3> = bird
            .cards
            .iter()
            .filter(wears)
            .map(|card| Vec3::from_array(card.tint))
            .collect();
        let mean = own.iter().sum::<Vec3>() / own.len().max(1) as f32;
        let reach = |tint: Vec3| Vec3::ONE.lerp(tint, share).max(Vec3::splat(1.0e-3));
        for (color, card) in colors.iter_mut().zip(&bird.cards) {
            if wears(&card) {
                *color = reach(Vec3::from_array(card.tint)).to_array();
            }
        }
        let tint = LinearRgba::rgb(mean.x, mean.y, mean.z);
        let (left, top) = (number % columns * width, number / columns * height);
        for texel in 0..width * height {
            let color = baked.color(texel, &tint);
            let rgb = Vec3::new(color.red, color.green, color.blue) / reach(mean);
            let rgb = rgb.clamp(Vec3::ZERO, Vec3::ONE);
            let shown = Srgba::from(LinearRgba::new(rgb.x, rgb.y, rgb.z, color.alpha));
            let (x, y) = (left + texel % width, top + texel / width);
            picture.put_pixel(x as u32, y as u32, image::Rgba(shown.to_u8_array()));
        }
    }
    let mut png = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut png), image::ImageFormat::Png)
        .map_err(|error| format!("the atlas: {error}"))?;
    Ok(Atlas {
        png,
        colors,
        size: (columns, rows),
        width,
    })
}
