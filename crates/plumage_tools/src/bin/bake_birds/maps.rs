//! Textures of the hard parts: what the surface is like at each place (color, relief, roughness), painted by formulas into images.
//!
//! The relief becomes a normal map in the frame of the mesh's own tangents ([`crate::tube`]): red along growing u, green along growing v.

use std::io::Cursor;

use bevy::color::Srgba;
use image::{ImageFormat, Rgb, RgbImage};

/// What a surface is like at one place.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Linear color.
    pub color: [f32; 3],
    /// Height above the mesh, mm.
    pub height: f32,
    /// Perceptual roughness, 0..1.
    pub roughness: f32,
    /// How much of the sky it sees, 0..1.
    pub open: f32,
}

/// A horizontal strip of a texture, for one part of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    /// From and to, v.
    pub v: [f32; 2],
}

/// Textures of one material.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Base color, sRGB.
    pub color: RgbImage,
    /// Normals.
    pub normal: RgbImage,
    /// Occlusion in red, roughness in green.
    pub surface: RgbImage,
}

fn byte(x: f32) -> u8 {
    (255.0 * x.clamp(0.0, 1.0)).round() as u8
}

impl Maps {
    /// Paints all strips. `paint` says what strip `k` is like at (u, v) in 0..1, `span` how many mm u and v run over there.
    pub fn paint(
        [width, height]: [u32; 2],
        strips: &[Strip],
        paint: impl Fn(usize, [f32; 2]) -> Texel,
        span: impl Fn(usize, f32) -> [f32; 2],
    ) -> Self {
        let mut out = Self {
            color: RgbImage::new(width, height),
            normal: RgbImage::from_pixel(width, height, Rgb([128, 128, 255])),
            surface: RgbImage::new(width, height),
        };
        for y in 0..height {
            let v = (y as f32 + 0.5) / height as f32;
            let away = |s: &Strip| (s.v[0] - v).max(v - s.v[1]);
            let Some(k) =
                (0..strips.len()).min_by(|a, b| away(&strips[*a]).total_cmp(&away(&strips[*b])))
            else {
                continue;
            };
            let [low, high] = strips[k].v;
            // Rows between two strips repeat the last one of the nearer.
            let v = ((v - low) / (high - low)).clamp(0.0, 1.0);
            let [across, along] = span(k, v);
            let step = [
                1.0 / width as f32,
                1.0 / (height as f32 * (high - low)).max(1.0),
            ];
            for x in 0..width {
                let u = (x as f32 + 0.5) * step[0];
                let texel = paint(k, [u, v]);
                // Differences over two texels are kept off the ends.
                let slope = |du: f32, dv: f32, mm: f32| {
                    let after = [u + du, (v + dv).min(1.0)];
                    let before = [u - du, (v - dv).max(0.0)];
                    let share = (after[0] - before[0]) + (after[1] - before[1]);
                    (paint(k, after).height - paint(k, before).height) / (share * mm.max(0.1))
                };
                let [a, b] = [slope(step[0], 0.0, across), slope(0.0, step[1], along)];
                let length = (1.0 + a * a + b * b).sqrt();
                let normal = [-a, -b, 1.0].map(|n| byte(0.5 + 0.5 * n / length));
                let surface = [texel.open, texel.roughness, 0.0];
                out.color.put_pixel(
                    x,
                    y,
                    Rgb(texel.color.map(|c| byte(Srgba::gamma_function_inverse(c)))),
                );
                out.normal.put_pixel(x, y, Rgb(normal));
                out.surface.put_pixel(x, y, Rgb(surface.map(byte)));
            }
        }
        out
    }

    /// Linear color at texture coordinates.
    pub fn color_at(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        let at = |x: f32, n: u32| ((x * n as f32) as u32).min(n - 1);
        let Rgb([r, g, b]) = *self
            .color
            .get_pixel(at(u, self.color.width()), at(v, self.color.height()));
        crate::species::linear(u32::from_be_bytes([0, r, g, b]))
    }
}

/// An image as PNG.
pub fn png(image: &RgbImage) -> Result<Vec<u8>, String> {
    let mut bytes = Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

/// From 0 at `a` to 1 at `b`, smoothly; `a` may be the greater.
pub fn ease(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear blend of two colors, `t` limited to 0..1.
pub fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t.clamp(0.0, 1.0))
}

/// A number in 0..1 that belongs to a cell.
fn hash([x, y, z]: [i32; 3], seed: u32) -> f32 {
    let mut h = seed
        .wrapping_add((x as u32).wrapping_mul(0x9E37_79B1))
        .wrapping_add((y as u32).wrapping_mul(0x85EB_CA77))
        .wrapping_add((z as u32).wrapping_mul(0xC2B2_AE3D));
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h ^ (h >> 15)) as f32 / u32::MAX as f32
}

/// Value noise in -1..1 with a wavelength of 1.
pub fn noise(p: [f32; 3], seed: u32) -> f32 {
    let cell = p.map(|x| x.floor() as i32);
    let t = p.map(|x| x - x.floor()).map(|t| t * t * (3.0 - 2.0 * t));
    let mut sum = 0.0;
    for corner in 0..8 {
        let bit = [corner & 1, (corner >> 1) & 1, corner >> 2];
        let weight: f32 = (0..3)
            .map(|k| if bit[k] == 1 { t[k] } else { 1.0 - t[k] })
            .product();
        sum += weight * hash(std::array::from_fn(|k| cell[k] + bit[k]), seed);
    }
    2.0 * sum - 1.0
}

/// Four octaves of [`noise`], the first with a wavelength of 1; about -1..1.
pub fn cloud(p: [f32; 3], seed: u32) -> f32 {
    (0..4_u32)
        .map(|k| {
            let f = (1 << k) as f32;
            noise(p.map(|x| x * f), seed + k) / f
        })
        .sum::<f32>()
        / 1.6
}

/// Rounded plates that fill the plane, cells of size 1: height 0 in the grooves between them to 1 on their tops, and the number of the
/// cell in 0..1. In x they repeat after `period` cells.
pub fn plates([x, y]: [f32; 2], period: i32, seed: u32) -> [f32; 2] {
    let (i, j) = (x.floor() as i32, y.floor() as i32);
    let mut nearest = [(f32::MAX, 0.0); 2];
    for a in -1..=1 {
        for b in -1..=1 {
            let cell = [(i + a).rem_euclid(period.max(1)), j + b, 0];
            let at = [0, 1].map(|k| 0.5 + 0.7 * (hash(cell, seed + k) - 0.5));
            let d = (x - (i + a) as f32 - at[0]).hypot(y - (j + b) as f32 - at[1]);
            if d < nearest[0].0 {
                nearest = [(d, hash(cell, seed + 2)), nearest[0]];
            } else if d < nearest[1].0 {
                nearest[1] = (d, 0.0);
            }
        }
    }
    let edge = ((nearest[1].0 - nearest[0].0) / 0.35).min(1.0);
    [edge * (2.0 - edge), nearest[0].1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(height: impl Fn([f32; 2]) -> f32) -> Maps {
        let texel = |uv| Texel {
            color: [0.5; 3],
            height: height(uv),
            roughness: 0.4,
            open: 1.0,
        };
        let strips = [Strip { v: [0.0, 0.48] }, Strip { v: [0.52, 1.0] }];
        Maps::paint([32, 32], &strips, |_, uv| texel(uv), |_, _| [10.0, 20.0])
    }

    #[test]
    fn a_slope_tilts_normals_against_it_by_its_steepness() {
        // 5 mm over 10 mm in u, 10 mm over 20 mm in v.
        for (k, map) in [slope(|uv| 5.0 * uv[0]), slope(|uv| 10.0 * uv[1])]
            .iter()
            .enumerate()
        {
            for pixel in map.normal.pixels() {
                let n = pixel.0.map(|b| f32::from(b) / 127.5 - 1.0);
                assert!((n[k] / n[2] + 0.5).abs() < 0.02, "{n:?}");
                assert!(n[1 - k].abs() < 0.01, "{n:?}");
            }
        }
    }

    #[test]
    fn colors_come_back_and_noise_stays_within_its_range() {
        let map = slope(|_| 0.0);
        assert!((map.color_at([0.3, 0.9])[1] - 0.5).abs() < 0.01);
        for i in 0..2000 {
            let p = [0.37 * i as f32, 0.11 * i as f32, 2.3];
            assert!(noise(p, 1).abs() <= 1.0 && cloud(p, 1).abs() <= 1.2);
            let [height, number] = plates([p[0], p[1]], 7, 3);
            assert!((0.0..=1.0).contains(&height) && (0.0..=1.0).contains(&number));
            let [again, _] = plates([p[0] + 7.0, p[1]], 7, 3);
            assert!((height - again).abs() < 1e-2, "{height} {again}");
        }
    }
}
