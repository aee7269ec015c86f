//! Color over the UV rectangle without shaft, barbs or background.

use super::{
    AlbedoFilter, CardFrame, ExtractSettings,
    color::{LINEAR, encode},
    raster::{Plane, median},
    score::Score,
    shaft::Shaft,
    silhouette::Silhouette,
};
use bevy::math::Vec2;
use image::{Rgba, RgbaImage};

/// Rounds of the rolling guidance (Zhang et al. 2014).
const ROUNDS: usize = 4;
/// Difference of encoded color that counts as a border of a pattern.
const BORDER: f32 = 0.07;

/// Brightness of the shaft over that of the vane painted beneath it, the median along its middle part, 0.25..4: what the feather's
/// own share of color for the shaft has to be.
pub(super) fn shaft_share(
    cut: &Silhouette,
    shaft: &Shaft,
    frame: &CardFrame,
    albedo: &RgbaImage,
) -> f32 {
    let light = |pixel: &Rgba<u8>| {
        let [r, g, b, _] = pixel.0.map(|byte| LINEAR[usize::from(byte)]);
        0.21 * r + 0.72 * g + 0.07 * b
    };
    let rows = shaft.x.len();
    let mut shares: Vec<f32> = (rows / 5..rows * 4 / 5)
        .filter_map(|i| {
            let y = (shaft.rows.0 + i) as f32 + 0.5;
            let p = Vec2::new(shaft.at(y), y);
            let seen = cut.image.get_pixel_checked(p.x as u32, p.y as u32)?;
            let uv = frame.uv(cut.view.photo(p));
            let size = Vec2::new(albedo.width() as f32, albedo.height() as f32);
            let texel = (uv * size).max(Vec2::ZERO);
            let under = light(albedo.get_pixel_checked(texel.x as u32, texel.y as u32)?);
            (under > 0.002).then(|| light(seen) / under)
        })
        .collect();
    if shares.is_empty() {
        return 1.0;
    }
    median(&mut shares).clamp(0.25, 4.0)
}

/// Albedo image of the card at `frame`; `aspect` is its width over its length, `radius` that of the shaft in pixels of the view
/// by row share from base to tip.
pub(super) fn paint(
    cut: &Silhouette,
    map: &Score,
    shaft: &Shaft,
    radius: &dyn Fn(f32) -> f32,
    frame: &CardFrame,
    aspect: f32,
    settings: &ExtractSettings,
) -> RgbaImage {
    let (width, height) = (cut.view.width, cut.view.height);
    let rows = (shaft.rows.1 - shaft.rows.0).max(1) as f32;
    // 1 on vane that is surely vane: the lens and an enlarged view soften its rim.
    let rim = 1.5 + 1.2 / cut.view.scale.clamp(0.4, 1.5);
    let usable = Plane::from_fn(width, height, |x, y| {
        let i = y * width + x;
        let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
        let share = (shaft.rows.1 as f32 - py) / rows;
        let from_shaft = (px - shaft.at(py)).abs();
        let vane = map.distance.data[i] > rim && from_shaft > 1.5 * radius(share) + 2.0;
        f32::from(u8::from(vane))
    });
    // Between loose barbs one looks through to the background: what is nearer to its color than its surroundings counts less.
    let around = cut.far.blur(0.006 * rows);
    let opaque = cut.far.zip(&around, |far, around| {
        (far / (1.15 * around).max(1e-3)).clamp(0.3, 1.0).powi(4)
    });
    // A feather that is all shaft has its shaft's color.
    let usable = if usable.data.iter().sum::<f32>() < 30.0 {
        map.distance.map(|d| f32::from(u8::from(d > 0.5)))
    } else {
        usable
    };
    let usable = usable.zip(&opaque, |usable, opaque| usable * opaque);
    let length = (frame.v.length() / cut.view.scale).max(1.0);
    let tall = settings.albedo_height as usize;
    let wide = ((tall as f32 * aspect).round() as usize).clamp(8, 2048);
    // Pixels of the view per texel: the reduction needs a filter as wide.
    let ratio = length / tall as f32;
    let before = (0.4 * ratio).max(0.0);
    let weight = usable.blur(before);
    let texel = |x: usize, y: usize| {
        let uv = Vec2::new(
            (x as f32 + 0.5) / wide as f32,
            (y as f32 + 0.5) / tall as f32,
        );
        cut.view.view(frame.pixel(uv))
    };
    let held = Plane::from_fn(wide, tall, |x, y| {
        let p = texel(x, y);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width as f32 && p.y < height as f32;
        f32::from(u8::from(inside && weight.sample(p) > 0.1))
    });
    let channels = [0, 1, 2].map(|c| {
        let light = Plane {
            width,
            height,
            data: cut
                .image
                .pixels()
                .zip(&usable.data)
                .map(|(pixel, w)| LINEAR[usize::from(pixel[c])] * w)
                .collect(),
        }
        .blur(before);
        Plane::from_fn(wide, tall, |x, y| {
            let p = texel(x, y);
            light.sample(p) / weight.sample(p).max(1e-3)
        })
        .fill_in(&held)
    });
    let sigma = settings.albedo_sigma * tall as f32;
    let smooth = match settings.albedo {
        AlbedoFilter::LowPass => channels.each_ref().map(|plane| plane.blur(sigma)),
        AlbedoFilter::EdgeAware => rolling_guidance(&channels, sigma),
    };
    RgbaImage::from_fn(wide as u32, tall as u32, |x, y| {
        let i = y as usize * wide + x as usize;
        let [r, g, b] = smooth.each_ref().map(|plane| encode(plane.data[i]));
        Rgba([r, g, b, 255])
    })
}

/// Rolling guidance filter: detail finer than `sigma` goes in the first blur and never comes back, as later rounds average
/// `channels` only over pixels that look alike in the result so far; borders of large areas sharpen again.
fn rolling_guidance(channels: &[Plane; 3], sigma: f32) -> [Plane; 3] {
    let (width, height) = (channels[0].width, channels[0].height);
    let radius = (2.0 * sigma).ceil().clamp(1.0, 12.0) as isize;
    let near: Vec<f32> = (-radius..=radius)
        .map(|i| (-((i * i) as f32) / (2.0 * sigma * sigma).max(1e-3)).exp())
        .collect();
    let mut guide = channels.each_ref().map(|plane| plane.blur(sigma));
    for _ in 0..ROUNDS {
        // About as the eye sees it.
        let seen = guide.each_ref().map(|p| p.map(|v| v.max(0.0).sqrt()));
        let mut next = guide.clone();
        for y in 0..height as isize {
            for x in 0..width as isize {
                let i = y as usize * width + x as usize;
                let here = seen.each_ref().map(|p| p.data[i]);
                let (mut sums, mut total) = ([0.0; 3], 0.0f32);
                for dy in -radius..=radius {
                    let row = y + dy;
                    if row < 0 || row >= height as isize {
                        continue;
                    }
                    for dx in -radius..=radius {
                        let column = x + dx;
                        if column < 0 || column >= width as isize {
                            continue;
                        }
                        let j = row as usize * width + column as usize;
                        let square: f32 = (0..3).map(|c| (seen[c].data[j] - here[c]).powi(2)).sum();
                        let range = (1.0 - square / (6.0 * BORDER * BORDER)).max(0.0);
                        let weight = near[(dx + radius) as usize]
                            * near[(dy + radius) as usize]
                            * range
                            * range;
                        for (sum, channel) in sums.iter_mut().zip(channels) {
                            *sum += weight * channel.data[j];
                        }
                        total += weight;
                    }
                }
                for (plane, sum) in next.iter_mut().zip(sums) {
                    plane.data[i] = sum / total.max(1e-6);
                }
            }
        }
        guide = next;
    }
    guide
}
