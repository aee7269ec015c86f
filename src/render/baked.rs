//! A feather as a picture of its card: for the fallback, and for engines that draw nothing but textured cards.

use super::pack::albedo_front;
use crate::anatomy::{Feather, ShapeTable};
use bevy::{
    asset::Assets,
    color::{Alpha, Color, LinearRgba, Mix},
    image::Image,
};

/// The front of a feather over its card, row by row from the root (v = 0), each row from u = 0 to 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakedFeather {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear color of the paint; it runs on beyond the outline.
    pub paint: Vec<LinearRgba>,
    /// Share of the groom's color in it, 0..1.
    pub tint_share: Vec<f32>,
    /// Share of the texel inside the outline or on the rachis, 0..1. Gaps of the outline are cut out, those between barbs are not.
    pub alpha: Vec<f32>,
}

impl Feather {
    /// Bakes the front; sizes are clamped to 1..4096 texels. `images`: where a feather from a photograph has its picture.
    pub fn bake_picture(
        &self,
        images: &Assets<Image>,
        width: usize,
        height: usize,
    ) -> BakedFeather {
        let (width, height) = (width.clamp(1, 4096), height.clamp(1, 4096));
        let front = albedo_front(self, images, width as u32, height as u32);
        let texels = || front.chunks_exact(4);
        BakedFeather {
            width,
            height,
            paint: texels()
                .map(|texel| Color::srgb_u8(texel[0], texel[1], texel[2]).to_linear())
                .collect(),
            tint_share: texels().map(|texel| f32::from(texel[3]) / 255.0).collect(),
            alpha: contour_alpha(self, width, height),
        }
    }
}

impl BakedFeather {
    /// A texel of a feather that the groom gives this color.
    pub fn color(&self, texel: usize, tint: &LinearRgba) -> LinearRgba {
        let (Some(paint), Some(share), Some(alpha)) = (
            self.paint.get(texel),
            self.tint_share.get(texel),
            self.alpha.get(texel),
        ) else {
            return LinearRgba::NONE;
        };
        paint.mix(tint, *share).with_alpha(*alpha)
    }
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
