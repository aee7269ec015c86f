//! Lens, sensor and file: blur, noise, JPEG.

use super::{Setting, color, setting::Stream};
use image::{ImageFormat, Rgb, RgbImage, codecs::jpeg::JpegEncoder};
use std::io::Cursor;

/// A running mean over `2 radius + 1` values of every `stride`-th element from `start`; the ends repeat.
fn box_line(
    values: &mut [f32],
    line: &mut Vec<f32>,
    start: usize,
    stride: usize,
    count: usize,
    radius: usize,
) {
    line.clear();
    line.extend((0..count).map(|i| values[start + i * stride]));
    let at = |i: isize| f64::from(line[i.clamp(0, count as isize - 1) as usize]);
    let r = radius as isize;
    let mut sum: f64 = (-r..=r).map(at).sum();
    let share = 1.0 / (2 * radius + 1) as f64;
    for i in 0..count {
        values[start + i * stride] = (sum * share) as f32;
        sum += at(i as isize + r + 1) - at(i as isize - r);
    }
}

/// Blur of nearly Gaussian shape with standard deviation `sigma` pixels: three running means each way, or a short kernel where
/// those would be too coarse.
pub(super) fn blur(values: &mut [f32], width: usize, height: usize, sigma: f32) {
    if sigma < 0.1 || width == 0 || height == 0 {
        return;
    }
    let mut line = Vec::new();
    if sigma < 1.6 {
        let reach = (3.0 * sigma).ceil() as isize;
        let kernel: Vec<f32> = (-reach..=reach)
            .map(|i| (-0.5 * (i as f32 / sigma).powi(2)).exp())
            .collect();
        let total: f32 = kernel.iter().sum();
        let mut pass = |start: usize, stride: usize, count: usize| {
            line.clear();
            line.extend((0..count).map(|i| values[start + i * stride]));
            for i in 0..count {
                let sum: f32 = kernel
                    .iter()
                    .zip(-reach..)
                    .map(|(weight, k)| {
                        weight * line[(i as isize + k).clamp(0, count as isize - 1) as usize]
                    })
                    .sum();
                values[start + i * stride] = sum / total;
            }
        };
        (0..height).for_each(|y| pass(y * width, 1, width));
        (0..width).for_each(|x| pass(x, width, height));
        return;
    }
    // Variance of three boxes of radius r: r (r + 1).
    let radius = ((0.25 + sigma * sigma).sqrt() - 0.5).round().max(1.0) as usize;
    for _ in 0..3 {
        (0..height).for_each(|y| box_line(values, &mut line, y * width, 1, width, radius));
        (0..width).for_each(|x| box_line(values, &mut line, x, width, height, radius));
    }
}

/// Linear planes (red, green, blue) to the pixels of a file: shot and read noise that neighbors share a little (as after
/// demosaicing), sRGB, rounding.
pub(super) fn develop(planes: &mut [Vec<f32>; 3], setting: &Setting) -> RgbImage {
    let [width, height] = setting.size.map(|side| side as usize);
    let mut r = Stream::new(setting.seed ^ 0x0150_5e50);
    for plane in planes.iter_mut() {
        blur(plane, width, height, setting.blur);
    }
    let noise = setting.noise.clamp(0.0, 0.2);
    let mut before = [0.0f32; 3];
    let mut row_above = vec![[0.0f32; 3]; width];
    RgbImage::from_fn(setting.size[0], setting.size[1], |x, y| {
        let i = y as usize * width + x as usize;
        let shared = r.normal();
        let mut pixel = [0u8; 3];
        for c in 0..3 {
            let own = 0.8 * r.normal() + 0.45 * shared;
            let smooth = 0.75 * own + 0.35 * before[c] + 0.35 * row_above[x as usize][c];
            before[c] = own;
            row_above[x as usize][c] = own;
            let light = planes[c][i].max(0.0) * setting.exposure * setting.white_balance[c];
            let value = color::encoded(light);
            // In sRGB units shot noise is nearly even and falls towards white; the read noise shows in the dark.
            let grain = noise * smooth * (1.15 - 0.5 * value);
            pixel[c] = ((value + grain).clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        }
        Rgb(pixel)
    })
}

/// The file: a JPEG of the setting's quality, or a PNG.
pub(super) fn file(image: &RgbImage, jpeg: Option<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let written = match jpeg {
        Some(quality) => {
            JpegEncoder::new_with_quality(&mut bytes, quality.clamp(1, 100)).encode_image(image)
        }
        None => image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png),
    };
    // A vector takes every byte; nothing is left to fail for an image of this size.
    if written.is_err() {
        bytes.clear();
    }
    bytes
}
