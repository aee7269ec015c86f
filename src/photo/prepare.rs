//! Resolution, noise, contrast.

use super::{color::Lab, raster::Plane};
use bevy::math::{Mat2, Vec2};
use image::{DynamicImage, RgbaImage, imageops::FilterType};
use imageproc::filter::bilateral::{GaussianEuclideanColorDistance, bilateral_filter};

/// A view of the photograph: a rectangle of pixels, turned and scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Point of the photograph at the view's outer corner.
    pub origin: Vec2,
    /// Unit vector of the view's x axis in the photograph; y is a quarter turn on.
    pub axis: Vec2,
    /// Pixels of the photograph per pixel of the view.
    pub scale: f32,
    pub width: usize,
    pub height: usize,
}

impl View {
    /// Point of the photograph at a point of the view.
    pub fn photo(&self, point: Vec2) -> Vec2 {
        self.origin + Mat2::from_cols(self.axis, self.axis.perp()) * point * self.scale
    }

    /// Point of the view at a point of the photograph.
    pub fn view(&self, photo: Vec2) -> Vec2 {
        let from = (photo - self.origin) / self.scale;
        Vec2::new(from.dot(self.axis), from.dot(self.axis.perp()))
    }

    /// The same rectangle upside down.
    pub fn turned(&self) -> Self {
        Self {
            origin: self.photo(Vec2::new(self.width as f32, self.height as f32)),
            axis: -self.axis,
            ..*self
        }
    }
}

/// A photograph reduced by whole steps, so that views of it need no wide filter.
pub(super) struct Photo {
    pub image: RgbaImage,
    /// Pixels of the photograph per pixel held.
    pub step: Vec2,
}

impl Photo {
    /// The photograph, reduced to about `side` pixels on its longer side if it is larger.
    pub fn reduced(photograph: &DynamicImage, side: f32) -> Self {
        let (width, height) = (photograph.width(), photograph.height());
        let factor = side / width.max(height) as f32;
        let image = if factor >= 1.0 {
            photograph.to_rgba8()
        } else {
            let scaled = |x: u32| ((x as f32 * factor).round() as u32).max(1);
            let (w, h) = (scaled(width), scaled(height));
            if factor < 0.5 {
                photograph.thumbnail_exact(w, h).to_rgba8()
            } else {
                photograph
                    .resize_exact(w, h, FilterType::Triangle)
                    .to_rgba8()
            }
        };
        let step = Vec2::new(
            width as f32 / image.width() as f32,
            height as f32 / image.height() as f32,
        );
        Self { image, step }
    }

    /// Bilinear sample at a point of the photograph; `None` outside it.
    pub fn sample(&self, photo: Vec2) -> Option<[f32; 4]> {
        let (width, height) = self.image.dimensions();
        let p = photo / self.step;
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x <= width as f32 && p.y <= height as f32;
        if !inside {
            return None;
        }
        let x = (p.x - 0.5).clamp(0.0, width as f32 - 1.0);
        let y = (p.y - 0.5).clamp(0.0, height as f32 - 1.0);
        let (i, j) = (x as u32, y as u32);
        let (s, t) = (x - i as f32, y - j as f32);
        let (right, down) = ((i + 1).min(width - 1), (j + 1).min(height - 1));
        let at = |x, y| self.image.get_pixel(x, y).0.map(f32::from);
        let (a, b, c, d) = (at(i, j), at(right, j), at(i, down), at(right, down));
        Some(std::array::from_fn(|k| {
            (a[k] * (1.0 - s) + b[k] * s) * (1.0 - t) + (c[k] * (1.0 - s) + d[k] * s) * t
        }))
    }

    /// The view's pixels, and 1 where they lie in the photograph (0 beyond it, where the nearest pixel stands).
    pub fn look(&self, view: &View) -> (RgbaImage, Plane) {
        let size = Vec2::new(self.image.width() as f32, self.image.height() as f32) * self.step;
        let mut valid = Plane::new(view.width, view.height, 1.0);
        let mut image = RgbaImage::new(view.width as u32, view.height as u32);
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let photo = view.photo(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            let held = photo.clamp(Vec2::ZERO, size);
            if held != photo {
                valid.data[y as usize * view.width + x as usize] = 0.0;
            }
            let color = self.sample(held).unwrap_or_default();
            pixel.0 = color.map(|c| c.round().clamp(0.0, 255.0) as u8);
        }
        (image, valid)
    }
}

/// Noise of a picture: standard deviation of its finest detail in bytes, from the median second difference.
fn noise(image: &RgbaImage) -> f32 {
    let (width, height) = image.dimensions();
    let green = |x: u32, y: u32| f32::from(image.get_pixel(x, y)[1]);
    let step = ((width * height) as usize / 20_000).max(1);
    let mut values: Vec<f32> = (0..height)
        .flat_map(|y| (1..width.saturating_sub(1)).map(move |x| (x, y)))
        .step_by(step)
        .map(|(x, y)| (green(x - 1, y) - 2.0 * green(x, y) + green(x + 1, y)).abs())
        .collect();
    super::raster::median(&mut values) / (0.6745 * 6f32.sqrt())
}

/// Removes noise and keeps edges: a bilateral filter (Tomasi and Manduchi 1998) as wide as the noise asks for.
pub(super) fn denoise(image: &RgbaImage) -> RgbaImage {
    let range = (3.0 * noise(image)).clamp(8.0, 60.0);
    let radius = if range > 20.0 { 3 } else { 2 };
    let rgb = DynamicImage::ImageRgba8(image.clone()).to_rgb8();
    let smooth = bilateral_filter(
        &rgb,
        radius,
        f32::from(radius) * 0.7,
        GaussianEuclideanColorDistance::new(range),
    );
    RgbaImage::from_fn(image.width(), image.height(), |x, y| {
        let [r, g, b] = smooth.get_pixel(x, y).0;
        image::Rgba([r, g, b, image.get_pixel(x, y)[3]])
    })
}

/// Lightness with local contrast evened out: histogram equalisation in `tiles` x `tiles` tiles, the contrast limited to
/// `limit` times the mean (Zuiderveld 1994), and blended with the plain lightness where a tile is dark: there equalisation
/// would bring up noise.
pub(super) fn equalise(lab: &Lab, tiles: usize, limit: f32) -> Plane {
    const BINS: usize = 128;
    let light = &lab.planes[0];
    let (width, height) = (light.width, light.height);
    let across = tiles.clamp(1, width.max(1));
    let down = tiles.clamp(1, height.max(1));
    let bin = |value: f32| ((value.clamp(0.0, 1.0) * BINS as f32) as usize).min(BINS - 1);
    let mut maps = Vec::with_capacity(across * down);
    for ty in 0..down {
        for tx in 0..across {
            let mut histogram = [0f32; BINS];
            let rows = ty * height / down..(ty + 1) * height / down;
            let mut count = 0.0;
            for y in rows {
                for x in tx * width / across..(tx + 1) * width / across {
                    histogram[bin(light.data[y * width + x])] += 1.0;
                    count += 1.0;
                }
            }
            let most = limit * count / BINS as f32;
            let cut: f32 = histogram.iter().map(|h| (h - most).max(0.0)).sum();
            let mut sum = 0.0;
            maps.push(histogram.map(|h| {
                sum += h.min(most) + cut / BINS as f32;
                sum / f32::max(count, 1.0)
            }));
        }
    }
    Plane::from_fn(width, height, |x, y| {
        let value = light.data[y * width + x];
        let place = |i: usize, side: usize, tiles: usize| {
            let p = ((i as f32 + 0.5) * tiles as f32 / side as f32 - 0.5)
                .clamp(0.0, tiles as f32 - 1.0);
            let low = p as usize;
            (low, (low + 1).min(tiles - 1), p - low as f32)
        };
        let (x0, x1, s) = place(x, width, across);
        let (y0, y1, t) = place(y, height, down);
        let k = bin(value);
        let at = |tx: usize, ty: usize| maps[ty * across + tx][k];
        let even = (at(x0, y0) * (1.0 - s) + at(x1, y0) * s) * (1.0 - t)
            + (at(x0, y1) * (1.0 - s) + at(x1, y1) * s) * t;
        let trust = (value / 0.25).clamp(0.3, 1.0);
        value + (even - value) * trust
    })
}
