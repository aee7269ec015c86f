//! Pixels as colors in Oklab.

use super::raster::Plane;
use bevy::{
    color::{ColorToComponents, LinearRgba, Oklaba},
    math::Vec3,
};
use image::RgbaImage;
use std::sync::LazyLock;

/// Linear light of an sRGB byte.
pub(super) static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let c = i as f32 / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
});

/// sRGB byte of linear light.
pub(super) fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let c = if c <= 0.003_130_8 {
        c * 12.92
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    };
    (c * 255.0).round() as u8
}

/// Oklab of an sRGB pixel: lightness 0..1, a, b.
pub(super) fn oklab(rgb: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = rgb.map(|c| LINEAR[usize::from(c)]);
    let lab = Oklaba::from(LinearRgba::rgb(r, g, b));
    [lab.lightness, lab.a, lab.b]
}

/// Linear light of Oklab.
pub(super) fn linear(lab: [f32; 3]) -> Vec3 {
    let linear = LinearRgba::from(Oklaba::lab(lab[0], lab[1], lab[2]));
    Vec3::new(linear.red, linear.green, linear.blue)
}

/// Oklab of linear light.
pub(super) fn oklab_of(linear: Vec3) -> [f32; 3] {
    let lab = Oklaba::from(LinearRgba::from_vec3(linear));
    [lab.lightness, lab.a, lab.b]
}

/// sRGB 0..1 of Oklab.
pub(super) fn srgb(lab: [f32; 3]) -> [f32; 3] {
    let linear = LinearRgba::from(Oklaba::lab(lab[0], lab[1], lab[2]));
    [linear.red, linear.green, linear.blue].map(|c| f32::from(encode(c)) / 255.0)
}

/// Value and chroma vector of HSV's cone: (v, s v cos h, s v sin h) - the hue of a grey pixel does not matter there.
pub(super) fn hsv_cone(rgb: [f32; 3]) -> [f32; 3] {
    let [r, g, b] = rgb;
    let value = r.max(g).max(b);
    let chroma = value - r.min(g).min(b);
    let (x, y) = (r - 0.5 * (g + b), 3f32.sqrt() / 2.0 * (g - b));
    let length = x.hypot(y).max(1e-6);
    [value, chroma * x / length, chroma * y / length]
}

/// The three channels of a picture in Oklab.
#[derive(Clone, Debug)]
pub(super) struct Lab {
    pub planes: [Plane; 3],
}

impl Lab {
    pub fn of(image: &RgbaImage) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut planes = [0; 3].map(|_| Plane::new(width, height, 0.0));
        for (i, pixel) in image.pixels().enumerate() {
            let lab = oklab([pixel[0], pixel[1], pixel[2]]);
            for (plane, value) in planes.iter_mut().zip(lab) {
                plane.data[i] = value;
            }
        }
        Self { planes }
    }

    pub fn width(&self) -> usize {
        self.planes[0].width
    }

    pub fn height(&self) -> usize {
        self.planes[0].height
    }

    pub fn at(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|c| self.planes[c].data[i])
    }
}
