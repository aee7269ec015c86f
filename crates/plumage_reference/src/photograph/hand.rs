//! A hand that holds the feather by its lower end and leaves the frame.

use super::{Pose, Setting, color, setting::Stream};
use noise::{NoiseFn, Perlin};

/// How a hand holds the feather: a finger and a thumb, or two fingers and a thumb, lie over its lower end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Share of the feather's length from the skin up that the tips of the fingers cover, 0.05..0.4.
    pub cover: f64,
    /// Color of the skin, sRGB 0..1.
    pub skin: [f32; 3],
    /// Fingers, the thumb among them, 2..3.
    pub fingers: u8,
    /// Half the width of a finger over the feather's length, 0.02..0.12.
    pub thick: f64,
    /// Seed of how the fingers lie.
    pub seed: u64,
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            cover: 0.15,
            skin: [0.80, 0.60, 0.49],
            fingers: 3,
            thick: 0.05,
            seed: 1,
        }
    }
}

/// One finger: a rounded bar from its tip to beyond the frame.
struct Finger {
    tip: [f64; 2],
    /// Unit vector from the tip to the palm.
    along: [f64; 2],
    radius: f64,
    nail: bool,
    tone: f32,
}

/// The fingers in pixels of one photograph.
pub(super) struct Fingers {
    fingers: Vec<Finger>,
    skin: [f32; 3],
    /// Unit vector to the lamp, z to the camera.
    lamp: [f64; 3],
    ambient: f32,
    perlin: Perlin,
}

impl Fingers {
    pub fn new(hand: &Hand, setting: &Setting, pose: &Pose) -> Self {
        let mut r = Stream::new(hand.seed ^ 0x0ad5);
        let cover = hand.cover.clamp(0.05, 0.4);
        let radius = hand.thick.clamp(0.02, 0.12) * pose.scale;
        let [foot, grip] = [0.0, cover].map(|v| pose.pixel_of_canonical([0.0, v]));
        let down = unit([foot[0] - grip[0], foot[1] - grip[1]]);
        let side = if r.uniform() < 0.5 { -1.0 } else { 1.0 };
        // (tip across and along in radii, turn from the feather's axis, width): the thumb lies on top of the others.
        let lies = [
            (-0.9, 0.9, -0.35, 0.95),
            (0.9, 0.5, 0.30, 0.9),
            (0.1, 0.8, 0.05, 1.1),
        ];
        let first = usize::from(hand.fingers < 3);
        let fingers = lies[first..]
            .iter()
            .enumerate()
            .map(|(i, &(across, below, turn, width))| {
                let mut near = |spread: f32| f64::from(r.between(-spread, spread));
                let (across, below) = (side * (across + near(0.15)), below + near(0.12));
                let turn: f64 = -side * (turn + near(0.12));
                let (sin, cos) = turn.sin_cos();
                Finger {
                    tip: [
                        grip[0] + radius * (down[0] * below - down[1] * across),
                        grip[1] + radius * (down[1] * below + down[0] * across),
                    ],
                    along: [down[0] * cos - down[1] * sin, down[1] * cos + down[0] * sin],
                    radius: radius * width,
                    nail: i + first == 2,
                    tone: 1.0 + 0.08 * near(1.0) as f32,
                }
            })
            .collect();
        let light = &setting.light;
        let (sin, cos) = (
            f64::from(light.azimuth).sin(),
            f64::from(light.azimuth).cos(),
        );
        let (rise, flat) = (
            f64::from(light.elevation).sin(),
            f64::from(light.elevation).cos(),
        );
        Self {
            fingers,
            skin: hand.skin.map(color::linear),
            lamp: [sin * flat, -cos * flat, rise],
            ambient: light.ambient,
            perlin: Perlin::new(hand.seed as u32 ^ 77),
        }
    }

    /// Linear color of the hand at a pixel, and how much of the pixel it covers.
    pub fn at(&self, pixel: [f64; 2]) -> ([f32; 3], f32) {
        let (mut color, mut cover) = ([0.0; 3], 0.0f32);
        for finger in &self.fingers {
            let d = [pixel[0] - finger.tip[0], pixel[1] - finger.tip[1]];
            let t = d[0] * finger.along[0] + d[1] * finger.along[1];
            let s = d[1] * finger.along[0] - d[0] * finger.along[1];
            // A finger grows a little to the palm, and swells at its joints.
            let joint = |at: f64| (-((t / finger.radius - at) / 0.8).powi(2)).exp();
            let radius = finger.radius
                * (0.94 + 0.03 * (t / finger.radius).clamp(0.0, 8.0) + 0.06 * joint(3.6));
            let off = if t > 0.0 { s.abs() } else { s.hypot(t) };
            let own = ((radius - off + 0.5).clamp(0.0, 1.0)) as f32;
            if own <= 0.0 {
                continue;
            }
            let skin = self.skin_at(finger, [t, s], radius, off);
            for c in 0..3 {
                color[c] = color[c] * (1.0 - own) + skin[c] * own;
            }
            cover = cover * (1.0 - own) + own;
        }
        (color.map(|value| value / cover.max(1e-6)), cover)
    }

    fn skin_at(&self, finger: &Finger, [t, s]: [f64; 2], radius: f64, off: f64) -> [f32; 3] {
        let share = (off / radius).min(0.98);
        let height = (1.0 - share * share).sqrt();
        let out = if t > 0.0 {
            [0.0, s / radius]
        } else {
            [t / radius, s / radius]
        };
        let normal = [
            out[0] * finger.along[0] - out[1] * finger.along[1],
            out[0] * finger.along[1] + out[1] * finger.along[0],
        ];
        let facing = normal[0] * self.lamp[0] + normal[1] * self.lamp[1] + height * self.lamp[2];
        // Light goes through skin a little: the terminator is soft.
        let lit = ((facing + 0.15) / (1.15 * self.lamp[2])).max(0.0) as f32;
        let light = self.ambient * (0.55 + 0.45 * height as f32) + (1.0 - self.ambient) * lit;
        let (u, w) = (t / finger.radius, s / finger.radius);
        let crease = |at: f64, wide: f64| {
            let bend = 0.12 * w * w + 0.05 * self.perlin.get([u * 2.0, w * 2.0, 3.1]);
            (-(((u - at) + bend) / wide).powi(2)).exp() as f32
        };
        let folds = 0.28 * crease(3.4, 0.06) + 0.22 * crease(3.7, 0.05) + 0.18 * crease(4.0, 0.05);
        let fine = 0.05 * self.perlin.get([u * 9.0, w * 9.0, 0.7]) as f32
            + 0.04 * self.perlin.get([u * 26.0, w * 26.0, 1.9]) as f32;
        let blotch = self.perlin.get([u * 1.3, w * 1.3, 5.3]) as f32;
        let value = light * finger.tone * (1.0 - folds) * (1.0 + fine);
        // Tips are redder.
        let red = 0.10 * (-(u / 1.5).powi(2)).exp() as f32 + 0.05 * blotch;
        let mut skin = [
            self.skin[0] * value * (1.0 + red),
            self.skin[1] * value * (1.0 - red),
            self.skin[2] * value * (1.0 - red),
        ];
        let nail = ((u - 0.15) / 0.75).powi(2) + (w / 0.55).powi(2);
        if finger.nail && nail < 1.0 {
            let rim = if nail > 0.85 { 0.85 } else { 1.0 };
            for (channel, pale) in skin.iter_mut().zip([1.12, 1.08, 1.1]) {
                *channel *= pale * rim;
            }
        }
        skin
    }
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y).max(1e-9);
    [x / length, y / length]
}
