//! Synthetic photographs: a [`Feather`] rendered as if it lay on a table, with everything known that an extraction has to
//! find out. The extraction is judged on them.
//!
//! A [`Setting`] says how the picture is taken (frame, background, lamp, lens, sensor, file), [`Photograph::take`] takes it, and
//! [`Truth`] is what is really there. The geometry is the feather's own: outline with splits, shaft, barbs and barbules by the
//! range query; light is a lamp over matt cords, since only plausible pictures are wanted, not radiometry. What a photograph
//! has beyond the model is added: barbs of unequal tone and length, strays, several layers of barbules, shadows, paper, wood,
//! grain. The same feather and setting give the same bytes.

mod camera;
mod color;
mod ground;
mod hand;
pub mod measure;
mod pose;
mod setting;
mod sheet;
mod truth;

pub use hand::Hand;
pub use pose::Pose;
pub use setting::{Background, LEAST_CONTRAST, Light, Setting};
pub use truth::{BarbTruth, PatternEdge, Truth};

use bevy_plumage::anatomy::Feather;
use ground::Ground;
use hand::Fingers;
use image::{GrayImage, ImageFormat, Luma, RgbImage};
use sheet::Sheet;

/// A synthetic photograph and what it shows.
pub struct Photograph {
    /// The picture, as its file is opened (JPEG artefacts included).
    pub image: RgbImage,
    /// What is really there.
    pub truth: Truth,
    setting: Setting,
    jpeg: Option<Vec<u8>>,
}

impl Photograph {
    /// Photographs `feather`. Sizes are clamped to 16..8192; time is about 1 s per megapixel on one core.
    pub fn take(feather: &Feather, setting: &Setting) -> Self {
        let mut setting = setting.clone();
        setting.size = setting.size.map(|side| side.clamp(16, 8192));
        let [width, height] = setting.size.map(|side| side as usize);
        let sheet = Sheet::new(feather, &setting);
        let mut planes: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; width * height]);
        let mut alpha = vec![0.0f32; width * height];
        let mut mask = GrayImage::new(setting.size[0], setting.size[1]);
        for y in 0..height {
            for x in 0..width {
                let i = y * width + x;
                let (texel, outline) = sheet.texel([x as f64 + 0.5, y as f64 + 0.5]);
                alpha[i] = texel.alpha;
                for (plane, color) in planes.iter_mut().zip(texel.color) {
                    plane[i] = color * texel.alpha;
                }
                if outline >= 0.5 {
                    mask.put_pixel(x as u32, y as u32, Luma([255]));
                }
            }
        }
        compose(&mut planes, &alpha, &setting, &sheet);
        drop(alpha);
        if let Some(hand) = &setting.hand {
            hold(&mut planes, &mut mask, hand, &setting, &sheet.pose);
        }
        let image = camera::develop(&mut planes, &setting);
        drop(planes);
        let jpeg = setting
            .jpeg
            .map(|quality| camera::file(&image, Some(quality)));
        let opened = jpeg
            .as_ref()
            .and_then(|bytes| image::load_from_memory_with_format(bytes, ImageFormat::Jpeg).ok());
        Self {
            image: opened.map_or(image, |opened| opened.to_rgb8()),
            truth: Truth::new(feather, &setting, sheet, mask),
            setting,
            jpeg,
        }
    }

    /// The file's bytes: JPEG where the setting has a quality, else PNG.
    pub fn file(&self) -> Vec<u8> {
        self.jpeg
            .clone()
            .unwrap_or_else(|| camera::file(&self.image, None))
    }

    /// How it was taken.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }
}

/// `alpha` moved by whole pixels and blurred.
fn shadow(alpha: &[f32], size: [usize; 2], shift: [f32; 2], sigma: f32) -> Vec<f32> {
    let [width, height] = size;
    let [dx, dy] = shift.map(|value| value.round() as isize);
    let mut moved = vec![0.0; alpha.len()];
    for y in 0..height {
        let from = y as isize - dy;
        if !(0..height as isize).contains(&from) {
            continue;
        }
        for x in 0..width {
            let column = x as isize - dx;
            if (0..width as isize).contains(&column) {
                moved[y * width + x] = alpha[from as usize * width + column as usize];
            }
        }
    }
    camera::blur(&mut moved, width, height, sigma);
    moved
}

/// Puts the background with its shadows behind the feather and the room's light over both.
fn compose(planes: &mut [Vec<f32>; 3], alpha: &[f32], setting: &Setting, sheet: &Sheet) {
    let size = setting.size.map(|side| side as usize);
    let [width, height] = size;
    let light = &setting.light;
    let lift = light.lift.clamp(0.0, 0.05) * sheet.pose.scale as f32;
    let away = [-light.azimuth.sin(), light.azimuth.cos()];
    let length = lift / light.elevation.clamp(0.2, 1.5).tan();
    let cast = shadow(
        alpha,
        size,
        away.map(|axis| axis * length),
        (lift * light.softness).max(0.5),
    );
    let contact = shadow(alpha, size, [0.0; 2], (0.8 * lift).max(0.5));
    let ground = Ground::new(setting);
    let half = [0.5 * width as f32, 0.5 * height as f32];
    let radius = half[0].hypot(half[1]);
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            let pixel = [x as f64 + 0.5, y as f64 + 0.5];
            let from_middle = [
                (x as f32 + 0.5 - half[0]) / radius,
                (y as f32 + 0.5 - half[1]) / radius,
            ];
            let squared = from_middle[0] * from_middle[0] + from_middle[1] * from_middle[1];
            let along = from_middle[0] * away[0] + from_middle[1] * away[1];
            let level = (1.0 - light.vignette * squared) * (1.0 - 0.5 * light.falloff * along);
            let dark = (1.0 - (1.0 - light.ambient) * 0.9 * cast[i])
                * (1.0 - light.ambient * 0.45 * contact[i]);
            let behind = ground.at(pixel);
            for c in 0..3 {
                planes[c][i] = (planes[c][i] + (1.0 - alpha[i]) * behind[c] * dark) * level;
            }
        }
    }
}

/// Lays a hand with the shadow next to it over all, and takes what it hides out of the truth's mask.
fn hold(
    planes: &mut [Vec<f32>; 3],
    mask: &mut GrayImage,
    hand: &Hand,
    setting: &Setting,
    pose: &Pose,
) {
    let [width, height] = setting.size.map(|side| side as usize);
    let fingers = Fingers::new(hand, setting, pose);
    let seen: Vec<_> = (0..width * height)
        .map(|i| fingers.at([(i % width) as f64 + 0.5, (i / width) as f64 + 0.5]))
        .collect();
    let cover: Vec<f32> = seen.iter().map(|(_, cover)| *cover).collect();
    let away = [-setting.light.azimuth.sin(), setting.light.azimuth.cos()];
    let near = 0.3 * (hand.thick * pose.scale) as f32;
    let dark = shadow(&cover, [width, height], away.map(|axis| axis * near), near);
    for (i, (skin, cover)) in seen.into_iter().enumerate() {
        for (plane, skin) in planes.iter_mut().zip(skin) {
            plane[i] = plane[i] * (1.0 - cover) * (1.0 - 0.5 * dark[i]) + skin * cover;
        }
        if cover >= 0.5 {
            mask.put_pixel((i % width) as u32, (i / width) as u32, Luma([0]));
        }
    }
}
