//! How a synthetic photograph is taken: everything that the feather's file does not say.

use super::{Hand, color, pose::Pose};
use bevy_plumage::anatomy::{Feather, Pattern};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::PI;

/// What the feather lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Background {
    /// White paper.
    White,
    /// Black velvet.
    Black,
    /// An 18 % grey card.
    Grey,
    /// Planks with grain and seams.
    Wood,
    /// Two tones, one running into the other across the frame.
    Gradient,
    /// Colored card.
    Color,
    /// A wall of rough rock: nobody lays a feather there to photograph it, so [`Self::ALL`] has it not.
    Rock,
}

impl Background {
    /// Every kind that a feather is laid on.
    pub const ALL: [Self; 6] = [
        Self::White,
        Self::Black,
        Self::Grey,
        Self::Wood,
        Self::Gradient,
        Self::Color,
    ];
}

/// One lamp and the light of the room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where the lamp stands, radians clockwise from the upper edge of the frame.
    pub azimuth: f32,
    /// Height of the lamp over the table, radians, 0.2..1.5.
    pub elevation: f32,
    /// Share of the light that comes from everywhere, 0..1.
    pub ambient: f32,
    /// Height of the feather over the table in feather lengths, 0..0.05: how far its shadow falls.
    pub lift: f32,
    /// Half shadow: standard deviation over the height of what casts it, 0.05..1.
    pub softness: f32,
    /// Light lost in the corners of the frame, 0..0.5.
    pub vignette: f32,
    /// Difference of the light between the edge nearest to the lamp and the farthest, 0..0.5.
    pub falloff: f32,
}

/// Everything about a photograph but the feather.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Width and height in pixels, 16..8192.
    pub size: [u32; 2],
    /// What the feather lies on.
    pub background: Background,
    /// Color of the background (sRGB 0..1); of the darker end for [`Background::Gradient`].
    pub ground: [f32; 3],
    /// The light.
    pub light: Light,
    /// Direction of the tip, radians clockwise from the upper edge of the frame.
    pub rotation: f64,
    /// How much of the frame the feather's card fills, 0.2..0.95.
    pub fill: f64,
    /// Place of the card in the room that is left, -1..1 each way.
    pub position: [f64; 2],
    /// Perspective: relative change of scale per feather length, across and along the feather, -0.1..0.1.
    pub tilt: [f64; 2],
    /// The face towards the body lies up: the picture is mirrored and shows the back pattern.
    pub back: bool,
    /// sRGB color for the patterns' tint shares.
    pub tint: [f32; 3],
    /// Factor on the color of the shaft, 0.3..3.
    pub shaft: f32,
    /// Standard deviation of the lens's blur in pixels, 0..4.
    pub blur: f32,
    /// Standard deviation of the sensor's noise at middle grey, in sRGB units, 0..0.1.
    pub noise: f32,
    /// Quality of the JPEG, 1..100; none keeps the pixels.
    pub jpeg: Option<u8>,
    /// Factor on all light, 0.5..1.2 (1 shows white paper as white).
    pub exposure: f32,
    /// Factors on the color of the light.
    pub white_balance: [f32; 3],
    /// What holds the feather.
    pub hand: Option<Hand>,
    /// Seed of grain, noise and irregular barbs.
    pub seed: u64,
}

impl Default for Setting {
    /// A good photograph: grey card, soft light, 600 x 900 pixels.
    fn default() -> Self {
        Self {
            size: [600, 900],
            background: Background::Grey,
            ground: [0.46; 3],
            light: Light {
                azimuth: -0.8,
                elevation: 0.9,
                ambient: 0.45,
                lift: 0.016,
                softness: 0.35,
                vignette: 0.06,
                falloff: 0.05,
            },
            rotation: 0.0,
            fill: 0.85,
            position: [0.0; 2],
            tilt: [0.0; 2],
            back: false,
            tint: [0.55, 0.45, 0.34],
            shaft: 1.6,
            blur: 0.5,
            noise: 0.01,
            jpeg: Some(90),
            exposure: 0.9,
            white_balance: [1.0; 3],
            hand: None,
            seed: 1,
        }
    }
}

/// A stream of random numbers.
pub(super) struct Stream(Pcg64Mcg);

impl Stream {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Uniform in 0..1.
    pub fn uniform(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Uniform between two values.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }

    /// Uniform in the logarithm between two positive values.
    pub fn scale(&mut self, low: f32, high: f32) -> f32 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Nearly normal, deviation 1: the sum of four 16-bit uniforms.
    pub fn normal(&mut self) -> f32 {
        let bits = self.0.next_u64();
        let sum: u32 = (0..4).map(|i| (bits >> (16 * i)) as u32 & 0xffff).sum();
        (sum as f32 / 65_536.0 - 2.0) * 1.732_05
    }
}

/// Least contrast at the edge that [`Setting::random`] leaves, see [`Setting::contrast`].
pub const LEAST_CONTRAST: f32 = 0.14;

impl Setting {
    /// A photograph as people take them, over the whole range of every field, drawn from `seed`. Someone who photographs a
    /// feather to keep its shape chooses a background that it stands out from: backgrounds are drawn until the contrast is at
    /// least [`LEAST_CONTRAST`].
    pub fn random(feather: &Feather, seed: u64) -> Self {
        let mut r = Stream::new(seed ^ 0x5eed_f0e7);
        let long = r.scale(320.0, 1500.0);
        let short = long * [0.667, 0.75, 0.75, 1.0][(r.uniform() * 4.0) as usize & 3];
        // Mostly upright feathers, in upright frames; a third lies any way.
        let any = r.uniform() < 0.35;
        let turned = r.uniform() < 0.25;
        let quarter = f64::from(u8::from(turned)) * std::f64::consts::FRAC_PI_2;
        let size = if turned { [long, short] } else { [short, long] };
        let rotation = if any {
            f64::from(r.between(-PI, PI))
        } else {
            let over = f64::from(u8::from(r.uniform() < 0.2)) * std::f64::consts::PI;
            quarter + over + f64::from(r.between(-0.3, 0.3))
        };
        let cast = r.between(-0.04, 0.04);
        let mut setting = Self {
            size: size.map(|side| side.round() as u32),
            light: Light {
                azimuth: r.between(-PI, PI),
                elevation: r.between(0.6, 1.3),
                ambient: r.between(0.25, 0.75),
                lift: r.scale(0.004, 0.03),
                softness: r.between(0.12, 0.6),
                vignette: r.between(0.0, 0.15),
                falloff: r.between(0.0, 0.12),
            },
            rotation,
            fill: f64::from(r.between(0.7, 0.94)),
            position: [r.between(-0.9, 0.9).into(), r.between(-0.9, 0.9).into()],
            tilt: [r.between(-0.05, 0.05).into(), r.between(-0.05, 0.05).into()],
            back: feather.albedo.back.is_some() && r.uniform() < 0.35,
            tint: plumage(&mut r),
            shaft: r.scale(0.5, 2.4),
            blur: r.between(0.2, 1.1),
            noise: r.scale(0.003, 0.03),
            jpeg: (r.uniform() < 0.8).then(|| r.between(60.0, 97.0) as u8),
            exposure: r.between(0.75, 1.0),
            white_balance: [1.0 + cast, 1.0, 1.0 - cast],
            seed,
            ..Self::default()
        };
        // Any kind of background; another kind only where this feather does not stand out from it.
        let first = (r.uniform() * 6.0) as usize;
        for attempt in 0..60 {
            setting.background = Background::ALL[(first + attempt / 10) % 6];
            setting.ground = ground(setting.background, &mut r);
            if setting.contrast(feather) >= LEAST_CONTRAST {
                break;
            }
            // A brown bird on brown wood: another tint, where the pattern takes one.
            setting.tint = plumage(&mut r);
        }
        setting
    }

    /// The pattern of the face that lies up.
    pub fn pattern<'a>(&self, feather: &'a Feather) -> &'a Pattern {
        if self.back {
            feather.albedo.back_pattern()
        } else {
            &feather.albedo.front
        }
    }

    /// How well the feather stands out: distance between its colors and the background's in Oklab (Ottosson 2020; white to
    /// black is 1), the fifth percentile over its length, light and shadow left out.
    pub fn contrast(&self, feather: &Feather) -> f32 {
        let ground = color::oklab(self.ground.map(color::linear));
        let rows = 40;
        let bytes = self.pattern(feather).bake(5, rows, feather);
        let mut distances: Vec<f32> = bytes
            .chunks_exact(4)
            .map(|texel| {
                let lab = color::oklab(color::tinted(texel, self.tint));
                (0..3)
                    .map(|i| (lab[i] - ground[i]).powi(2))
                    .sum::<f32>()
                    .sqrt()
            })
            .collect();
        distances.sort_by(f32::total_cmp);
        distances[distances.len() / 20]
    }

    /// Where the feather lies in the frame.
    pub fn pose(&self, feather: &Feather) -> Pose {
        Pose::new(self, feather)
    }
}

/// A color for a kind of background.
fn ground(kind: Background, r: &mut Stream) -> [f32; 3] {
    match kind {
        Background::White => [r.between(0.9, 0.98); 3],
        Background::Black => [r.between(0.02, 0.09); 3],
        Background::Grey => [r.between(0.42, 0.52); 3],
        Background::Gradient => {
            let value = r.between(0.1, 0.85);
            [
                value,
                value + r.between(-0.05, 0.05),
                value + r.between(-0.08, 0.08),
            ]
        }
        Background::Wood => {
            let value = r.between(0.3, 0.8);
            [
                value,
                value * r.between(0.68, 0.9),
                value * r.between(0.4, 0.75),
            ]
        }
        Background::Rock => {
            let value = r.between(0.35, 0.55);
            [value, value * 0.92, value * 0.82]
        }
        Background::Color => {
            let value = r.between(0.2, 0.8);
            std::array::from_fn(|_| (value + r.between(-0.22, 0.22)).clamp(0.05, 0.95))
        }
    }
}

/// A color that feathers have: melanins from buff to black for most, else a carotenoid or structural color.
fn plumage(r: &mut Stream) -> [f32; 3] {
    const BRIGHT: [[f32; 3]; 6] = [
        [0.78, 0.12, 0.10],
        [0.88, 0.62, 0.10],
        [0.15, 0.32, 0.66],
        [0.25, 0.48, 0.20],
        [0.85, 0.55, 0.52],
        [0.10, 0.40, 0.45],
    ];
    if r.uniform() < 0.6 {
        let value = r.between(0.14, 0.92);
        let warm = r.between(0.0, 0.3) * (1.0 - value);
        return [value, value * (1.0 - warm), value * (1.0 - 1.9 * warm)];
    }
    let color = BRIGHT[(r.uniform() * 6.0) as usize % 6];
    color.map(|channel| (channel * r.between(0.8, 1.15)).clamp(0.02, 0.95))
}
