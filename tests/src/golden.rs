//! Pictures of reference, kept in `tests/golden`. Drivers place samples differently, so a picture is compared by the statistics of its
//! blocks of 8 by 8 pixels: their means, and how much their pixels vary.

use bevy::color::{Color, ColorToComponents};

/// Side of a block, pixels.
const BLOCK: u32 = 8;
/// How pictures of reference are made anew, where a change is meant.
const ANEW: &str = "If the change is meant, `make golden` makes the pictures of reference anew.";

/// How far two pictures are apart, in shares of the range of the values shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Apart {
    /// Root mean square over all pixels.
    pub pixels: f64,
    /// Ratio of the means, less 1.
    pub mean: f64,
    /// Root mean square over the means of all blocks.
    pub block_means: f64,
    /// Root mean square over the standard deviations within all blocks.
    pub block_deviations: f64,
    /// The largest difference of a block's mean, in standard errors of that block (never less than a step of 8 bits).
    pub worst_block: f64,
}

impl Apart {
    /// Whether nothing is farther apart than in `limit`.
    pub fn within(&self, limit: &Self) -> bool {
        self.pixels <= limit.pixels
            && self.mean.abs() <= limit.mean
            && self.block_means <= limit.block_means
            && self.block_deviations <= limit.block_deviations
            && self.worst_block <= limit.worst_block
    }
}

/// Feathers: fine lines fall otherwise into the pixels of another driver, in means and variations they do not differ.
pub const STATISTICAL: Apart = Apart {
    pixels: f64::INFINITY,
    mean: 0.005,
    block_means: 0.006,
    block_deviations: 0.008,
    worst_block: 4.0,
};

/// Fur, which is smooth: pixel by pixel, too.
pub const PIXELWISE: Apart = Apart {
    pixels: 0.03,
    mean: 0.01,
    ..STATISTICAL
};

/// Mean and standard deviation of one channel of a block.
fn block(values: &[u8], width: u32, (x, y): (u32, u32), channel: u32) -> (f64, f64) {
    let pixels = (0..BLOCK * BLOCK).map(|i| {
        let at = (y + i / BLOCK) * width + x + i % BLOCK;
        f64::from(values[(3 * at + channel) as usize]) / 255.0
    });
    let count = f64::from(BLOCK * BLOCK);
    let (sum, square) = pixels.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
    let mean = sum / count;
    (mean, (square / count - mean * mean).max(0.0).sqrt())
}

/// Compares two pictures of RGB bytes as shown; sides that are multiples of 8.
pub fn apart(kept: &[u8], now: &[u8], (width, height): (u32, u32)) -> Apart {
    assert_eq!(kept.len(), now.len(), "pictures of one size");
    let mut found = Apart::default();
    let (mut before, mut after) = (0.0, 0.0);
    for (a, b) in kept.iter().zip(now) {
        let (a, b) = (f64::from(*a) / 255.0, f64::from(*b) / 255.0);
        found.pixels += (a - b) * (a - b);
        before += a;
        after += b;
    }
    found.pixels = (found.pixels / kept.len() as f64).sqrt();
    found.mean = after / before - 1.0;
    let mut blocks = 0.0;
    for y in (0..height).step_by(BLOCK as usize) {
        for x in (0..width).step_by(BLOCK as usize) {
            for channel in 0..3 {
                let (mean, deviation) = block(kept, width, (x, y), channel);
                let (mean_now, deviation_now) = block(now, width, (x, y), channel);
                let off = mean_now - mean;
                let error = deviation.max(deviation_now) / f64::from(BLOCK);
                found.block_means += off * off;
                found.block_deviations += (deviation_now - deviation).powi(2);
                found.worst_block = found.worst_block.max(off.abs() / error.max(1.0 / 255.0));
                blocks += 1.0;
            }
        }
    }
    found.block_means = (found.block_means / blocks).sqrt();
    found.block_deviations = (found.block_deviations / blocks).sqrt();
    found
}

/// Bytes as shown, of linear RGB.
fn shown(picture: &[[f32; 3]]) -> Vec<u8> {
    let srgb = |[r, g, b]: &[f32; 3]| {
        Color::linear_rgb(*r, *g, *b)
            .to_srgba()
            .to_f32_array_no_alpha()
    };
    let values = picture.iter().flat_map(srgb);
    values.map(|c| (c * 255.0).round() as u8).collect()
}

/// Compares a picture with the one kept in `tests/golden`, which `PLUMAGE_GOLDEN=write` makes anew. Where they differ, picture,
/// reference and difference are left under `target/test_failures`.
pub fn check(name: &str, picture: &[[f32; 3]], size: (u32, u32), limit: &Apart) {
    let file = crate::root().join(format!("tests/golden/{name}.png"));
    let bytes = shown(picture);
    let image = |bytes: Vec<u8>| image::RgbImage::from_raw(size.0, size.1, bytes).unwrap();
    if std::env::var("PLUMAGE_GOLDEN").is_ok_and(|value| value == "write") {
        image(bytes).save(file).unwrap();
        return;
    }
    let kept = image::open(&file)
        .unwrap_or_else(|e| panic!("{}: {e}. {ANEW}", file.display()))
        .to_rgb8();
    assert_eq!(kept.dimensions(), size, "{name}. {ANEW}");
    let kept = kept.into_raw();
    let found = apart(&kept, &bytes, size);
    println!("{name}: {found:.5?}");
    if found.within(limit) {
        return;
    }
    let difference = kept
        .iter()
        .zip(&bytes)
        .map(|(a, b)| a.abs_diff(*b).saturating_mul(4))
        .collect();
    for (kind, bytes) in [
        ("picture", bytes),
        ("reference", kept),
        ("difference", difference),
    ] {
        let file = crate::failure(&format!("{name}_{kind}.png"));
        image(bytes).save(file).unwrap();
    }
    panic!("{name}: {found:.4?}, allowed {limit:?}; pictures in target/test_failures. {ANEW}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::FRAC_PI_2;

    const SIZE: (u32, u32) = (64, 48);

    /// Stripes of four pixels, two to a block, that lie across the picture, in noise.
    fn stripes(seed: u64, shift: f64, gain: f64, contrast: f64) -> Vec<u8> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut bytes = Vec::new();
        for i in 0..SIZE.0 * SIZE.1 {
            let (x, y) = (f64::from(i % SIZE.0), f64::from(i / SIZE.0));
            let wave = ((FRAC_PI_2 * x + 0.4 * y + shift).sin() * 0.2 * contrast + 0.5) * gain;
            for level in [1.0, 0.7, 0.4] {
                let noise = (random.random::<f64>() - 0.5) * 0.04;
                bytes.push(((wave * level + noise) * 255.0).round() as u8);
            }
        }
        bytes
    }

    #[test]
    fn other_noise_is_the_same_picture_and_other_light_is_not() {
        let kept = stripes(1, 0.0, 1.0, 1.0);
        let off = |picture: &[u8]| apart(&kept, picture, SIZE);
        assert_eq!(off(&kept), Apart::default());
        let noise = off(&stripes(2, 0.0, 1.0, 1.0));
        assert!(
            noise.within(&STATISTICAL) && noise.within(&PIXELWISE),
            "{noise:?}"
        );
        // Lines elsewhere in the pixels: the same feather on another driver.
        let moved = off(&stripes(2, 0.8, 1.0, 1.0));
        assert!(
            moved.within(&STATISTICAL) && !moved.within(&PIXELWISE),
            "{moved:?}"
        );
        // Two per cent brighter, lines a tenth softer.
        let bright = off(&stripes(2, 0.0, 1.02, 1.0));
        assert!(!bright.within(&STATISTICAL), "{bright:?}");
        let soft = off(&stripes(2, 0.0, 1.0, 0.85));
        assert!(!soft.within(&STATISTICAL), "{soft:?}");
        // One block in another color.
        let mut spot = stripes(2, 0.0, 1.0, 1.0);
        for i in 0..64u32 {
            let at = 3 * ((16 + i / 8) * SIZE.0 + 24 + i % 8) as usize;
            spot.swap(at, at + 2);
        }
        let spot = off(&spot);
        assert!(!spot.within(&STATISTICAL), "{spot:?}");
    }
}
