//! A picture of what was found, for the eye.

use super::Extraction;
use bevy::math::Vec2;
use image::{DynamicImage, Rgb, RgbImage, imageops::FilterType};

/// Longest side of the overlay.
const SIDE: f32 = 1400.0;

impl Extraction {
    /// The photograph (reduced) with the outline in green, the shaft in red and the card in grey; beside it mask, score map
    /// and albedo.
    pub fn overlay(&self, photograph: &DynamicImage) -> RgbImage {
        let longest = photograph.width().max(photograph.height()) as f32;
        let scale = (SIDE / longest).min(2.0);
        let scaled = |side: u32| ((side as f32 * scale).round() as u32).max(1);
        let (width, height) = (scaled(photograph.width()), scaled(photograph.height()));
        let mut picture = photograph
            .resize_exact(width, height, FilterType::Triangle)
            .to_rgb8();
        let frame = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|uv| self.frame.pixel(uv));
        draw(&mut picture, &frame, true, scale, [150, 150, 150]);
        draw(&mut picture, &self.contour, true, scale, [0, 230, 60]);
        draw(&mut picture, &self.rachis, false, scale, [240, 20, 20]);
        let mask = DynamicImage::ImageLuma8(self.mask.clone())
            .resize_exact(width, height, FilterType::Triangle)
            .to_rgb8();
        let fit = |image: DynamicImage| image.resize(width, height, FilterType::Triangle).to_rgb8();
        let score = fit(DynamicImage::ImageLuma8(self.score.image.clone()));
        let mut albedo = self.albedo.clone();
        image::imageops::flip_vertical_in_place(&mut albedo);
        let albedo = fit(DynamicImage::ImageRgba8(albedo));
        let parts = [picture, mask, score, albedo];
        // Side by side or one below the other, whichever is squarer.
        let tall = height > width;
        let size = |p: &RgbImage| if tall { p.width() } else { p.height() };
        let total: u32 = parts.iter().map(|p| size(p) + 8).sum();
        let (w, h) = if tall {
            (total, height)
        } else {
            (width, total)
        };
        let mut sheet = RgbImage::from_pixel(w, h, Rgb([90, 90, 90]));
        let mut at = 0;
        for part in &parts {
            let (x, y) = if tall { (at, 0) } else { (0, at) };
            image::imageops::replace(&mut sheet, part, i64::from(x), i64::from(y));
            at += size(part) + 8;
        }
        sheet
    }
}

/// A polyline, one pixel wide.
fn draw(picture: &mut RgbImage, points: &[Vec2], closed: bool, scale: f32, color: [u8; 3]) {
    let mut line: Vec<Vec2> = points.iter().map(|p| *p * scale).collect();
    if closed && let Some(&first) = line.first() {
        line.push(first);
    }
    for pair in line.windows(2) {
        let steps = (pair[0].distance(pair[1]).min(1e4) * 1.5).ceil().max(1.0) as usize;
        for i in 0..=steps {
            let p = pair[0].lerp(pair[1], i as f32 / steps as f32);
            if p.x >= 0.0
                && p.y >= 0.0
                && p.x < picture.width() as f32
                && p.y < picture.height() as f32
            {
                picture.put_pixel(p.x as u32, p.y as u32, Rgb(color));
            }
        }
    }
}
