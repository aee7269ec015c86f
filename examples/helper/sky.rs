//! A gradient sky as cube maps, computed at start: no image is fetched.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};

/// Radiance of the sky, relative units: blue above, a bright hazy horizon, a warm ground, a soft window of light.
pub fn radiance(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let zenith = Vec3::new(0.22, 0.42, 0.78);
    let horizon = Vec3::new(0.62, 0.78, 0.90);
    let ground = Vec3::new(0.16, 0.24, 0.13);
    // The horizon is far and hazy: no line.
    let base = if up >= 0.0 {
        horizon.lerp(zenith, up.powf(0.7))
    } else {
        horizon.lerp(ground, (1.0 - (1.0 + up).powi(3)).min(1.0))
    };
    let window = Vec3::new(-0.7, 0.45, 0.55).normalize();
    let glow = ((direction.dot(window) - 0.72) / 0.2).clamp(0.0, 1.0);
    base + Vec3::new(1.2, 1.1, 0.95) * glow * glow
}

fn texel(face: usize, x: u32, y: u32, size: u32) -> Vec3 {
    let u = 2.0 * (x as f32 + 0.5) / size as f32 - 1.0;
    let v = 2.0 * (y as f32 + 0.5) / size as f32 - 1.0;
    match face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    }
    .normalize()
}

/// The sky seen through a lobe cos^n.
fn filtered(direction: Vec3, exponent: f32, samples: &[(Vec3, Vec3)]) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut weight = 1e-6;
    for (toward, light) in samples {
        let w = direction.dot(*toward).max(0.0).powf(exponent);
        sum += *light * w;
        weight += w;
    }
    sum / weight
}

/// The bits of a 16-bit float; for values from 0 to 65,000, truncated.
pub fn half_float(value: f32) -> u16 {
    match value {
        v if v < 6.2e-5 => 0,
        v => ((v.min(65_000.0).to_bits() >> 13) - (112 << 10)) as u16,
    }
}

/// The value of a 16-bit float that is finite.
pub fn from_half(bits: u16) -> f32 {
    let (sign, exponent, fraction) = (bits >> 15, (bits >> 10) & 31, f32::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2.0_f32.powi(-24),
        e => (1.0 + fraction / 1024.0) * 2.0_f32.powi(i32::from(e) - 15),
    };
    if sign == 1 { -size } else { size }
}

fn cube(size: u32, levels: u32, color: impl Fn(Vec3, u32) -> Vec3) -> Image {
    let mut data = Vec::new();
    for face in 0..6 {
        for level in 0..levels {
            let side = size >> level;
            for y in 0..side {
                for x in 0..side {
                    let c = color(texel(face, x, y, side), level);
                    for value in [c.x, c.y, c.z, 1.0] {
                        data.extend(half_float(value).to_le_bytes());
                    }
                }
            }
        }
    }
    let mut image = Image::new_uninit(
        Extent3d {
            width: size,
            height: size,
            depth_or_array_layers: 6,
        },
        TextureDimension::D2,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some(data);
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..default()
    });
    image
}

/// (background and reflections, irradiance) of a sky of this radiance.
pub fn maps(radiance: impl Fn(Vec3) -> Vec3) -> (Image, Image) {
    let samples: Vec<_> = (0..6)
        .flat_map(|face| (0..64).map(move |i| texel(face, i % 8, i / 8, 8)))
        .map(|direction| (direction, radiance(direction)))
        .collect();
    let specular = cube(64, 5, |direction, level| match level {
        0 => radiance(direction),
        // A GGX lobe of roughness r is about cos^(2/r^4 - 2) wide.
        _ => {
            let roughness = level as f32 / 4.0;
            filtered(
                direction,
                (2.0 / roughness.powi(4) - 2.0).clamp(1.0, 60.0),
                &samples,
            )
        }
    });
    let diffuse = cube(8, 1, |direction, _| filtered(direction, 1.0, &samples));
    (specular, diffuse)
}
