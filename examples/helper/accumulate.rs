//! Pictures without noise: many frames, each from another place in the pixel, on the lens and on the sun's disc, averaged in
//! linear light before the film develops them.

use bevy::prelude::*;

/// Half the angle at which the sun is seen, radians.
pub const SUN: f32 = 0.267 * std::f32::consts::PI / 180.0;

/// One frame of a picture that is accumulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Place in the pixel, -0.5..0.5.
    pub pixel: Vec2,
    /// Place on the lens, in a disc of radius 1.
    pub lens: Vec2,
    /// Place on the sun, in a disc of radius 1.
    pub sun: Vec2,
}

/// The radical inverse of `index` in a prime base, 0..1.
fn halton(mut index: u32, base: u32) -> f32 {
    let (mut value, mut share) = (0.0, 1.0);
    while index > 0 {
        share /= base as f32;
        value += share * (index % base) as f32;
        index /= base;
    }
    value
}

/// A number in 0..1 for a seed and a dimension.
fn shift(seed: u64, dimension: u64) -> f32 {
    let mut x = seed ^ dimension.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 40) as f32 / 16_777_216.0
}

/// Sample `index` of the sequence of a seed: Halton points, turned by the seed.
pub fn sample(seed: u64, index: u32) -> Sample {
    const BASES: [u32; 6] = [2, 3, 5, 7, 11, 13];
    let at = |k: usize| (halton(index + 1, BASES[k]) + shift(seed, k as u64)).fract();
    let disc =
        |k: usize| Vec2::from_angle(std::f32::consts::TAU * at(k + 1)) * at(k).max(0.0).sqrt();
    Sample {
        pixel: Vec2::new(at(0), at(1)) - 0.5,
        lens: disc(2),
        sun: disc(4),
    }
}

/// The camera moved over its lens; what lies at `target` stays where it is in the picture.
pub fn through_lens(camera: Transform, target: Vec3, offset: Vec2) -> Transform {
    let eye = camera.translation + camera.rotation * offset.extend(0.0);
    Transform::from_translation(eye).looking_at(target, camera.up())
}

/// A light turned to a place on its disc.
pub fn on_disc(light: Transform, at: Vec2) -> Transform {
    let turn = Quat::from_euler(EulerRot::XYZ, SUN * at.x, SUN * at.y, 0.0);
    light.with_rotation(light.rotation * turn)
}

/// Sum of frames in linear light.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    total: Vec<Vec3>,
    frames: u32,
}

impl Sum {
    /// Adds a frame; all of them are of one size.
    pub fn add(&mut self, frame: &[Vec3]) {
        self.total.resize(frame.len(), Vec3::ZERO);
        for (sum, color) in self.total.iter_mut().zip(frame) {
            *sum += *color;
        }
        self.frames += 1;
    }

    /// The mean of the frames.
    pub fn mean(&self) -> impl Iterator<Item = Vec3> + '_ {
        let share = 1.0 / self.frames.max(1) as f32;
        self.total.iter().map(move |sum| *sum * share)
    }
}
