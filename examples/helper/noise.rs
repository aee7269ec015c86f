//! Value noise of what is made up: bark, woods.

use bevy::prelude::*;

fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Numbers that look random, evenly spread over 0..1.
pub struct Dice(pub u32);

impl Dice {
    /// The next one.
    pub fn roll(&mut self) -> f32 {
        self.0 = hash(self.0.wrapping_add(0x9e37_79b9));
        (self.0 >> 8) as f32 / 16_777_216.0
    }
}

/// Smooth noise of period about 1, -1..1.
pub fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let at = |x: f32, y: f32, z: f32| {
        let [x, y, z] = (cell + Vec3::new(x, y, z))
            .to_array()
            .map(|c| c as i32 as u32);
        let mixed = hash(x ^ hash(y ^ hash(z)));
        (mixed >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let plane = |z: f32| {
        let low = mix(at(0.0, 0.0, z), at(1.0, 0.0, z), f.x);
        let high = mix(at(0.0, 1.0, z), at(1.0, 1.0, z), f.x);
        mix(low, high, f.y)
    };
    mix(plane(0.0), plane(1.0), f.z)
}

/// Sum of octaves, each half as strong and twice as fine; about -1..1.
pub fn fractal(p: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut scale) = (0.0, 0.5, 1.0);
    for i in 0..octaves {
        sum += weight * noise(p * scale + Vec3::splat(17.3 * i as f32));
        weight *= 0.5;
        scale *= 2.03;
    }
    sum
}
