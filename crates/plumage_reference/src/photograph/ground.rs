//! What the feather lies on.

use super::{Background, Setting, color};
use noise::{NoiseFn, Perlin};

/// The background as a field over the frame, linear color.
pub(super) struct Ground {
    kind: Background,
    color: [f32; 3],
    other: [f32; 3],
    perlin: Perlin,
    /// One over the longer side.
    unit: f64,
    /// Direction of grain or gradient.
    along: [f64; 2],
}

impl Ground {
    pub fn new(setting: &Setting) -> Self {
        let angle = f64::from(setting.seed as u32 % 628) * 0.01;
        // Planks run along one edge of the frame, nearly.
        let grain = if setting.seed & 1 == 0 {
            0.0
        } else {
            std::f64::consts::FRAC_PI_2
        } + 0.06 * angle.sin();
        let angle = if setting.background == Background::Wood {
            grain
        } else {
            angle
        };
        let brighter = setting.ground.map(|value| (value + 0.16).min(1.0));
        Self {
            kind: setting.background,
            color: setting.ground.map(color::linear),
            other: brighter.map(color::linear),
            perlin: Perlin::new(setting.seed as u32 ^ 1234),
            unit: 1.0 / f64::from(setting.size[0].max(setting.size[1]).max(1)),
            along: [angle.cos(), angle.sin()],
        }
    }

    fn noise(&self, x: f64, y: f64, layer: f64) -> f32 {
        self.perlin.get([x, y, layer]) as f32
    }

    /// Linear color at a pixel.
    pub fn at(&self, pixel: [f64; 2]) -> [f32; 3] {
        let [x, y] = pixel.map(|value| value * self.unit);
        let t = x * self.along[0] + y * self.along[1];
        let s = y * self.along[0] - x * self.along[1];
        match self.kind {
            Background::White | Background::Grey | Background::Color => {
                // Paper: faint clouds and fibre.
                let cloud = 0.012 * self.noise(x * 5.0, y * 5.0, 0.3);
                let fibre = 0.012 * self.noise(x * 220.0, y * 220.0, 1.3);
                self.color.map(|value| value * (1.0 + cloud + fibre))
            }
            Background::Black => {
                // Velvet: the pile leans this way and that.
                let pile = 1.0
                    + 0.25 * self.noise(x * 9.0, y * 9.0, 0.3)
                    + 0.3 * self.noise(x * 160.0, y * 160.0, 1.3);
                self.color.map(|value| value * pile)
            }
            Background::Gradient => {
                let share = (0.5 + 0.7 * (t - 0.4)).clamp(0.0, 1.0) as f32;
                std::array::from_fn(|i| self.color[i] + (self.other[i] - self.color[i]) * share)
            }
            Background::Wood => self.wood(t, s),
            Background::Rock => self.rock(t, s),
        }
    }

    fn wood(&self, t: f64, s: f64) -> [f32; 3] {
        let plank = (s * 3.1 + 7.3).floor();
        let within = (s * 3.1 + 7.3).fract();
        let shift = plank * 17.31;
        // Growth rings cut lengthwise, pores, and a tone for each plank.
        let bend = self.noise(t * 1.3, s * 4.0, shift);
        let rings = (f64::from(bend) * 6.0 + s * 60.0).sin() as f32;
        let pores = self.noise(t * 14.0, s * 260.0, shift + 1.7);
        let streak = self.noise(t * 3.0, s * 45.0, shift + 2.9);
        let tone = self.noise(plank * 0.77, 0.37, 5.1);
        let seam = 1.0 - 0.75 * (-(within.min(1.0 - within) / 0.012).powi(2)).exp() as f32;
        let value = (1.0 + 0.05 * rings + 0.07 * pores + 0.11 * streak + 0.16 * tone) * seam;
        let warm = 0.04 * rings + 0.05 * streak;
        [
            self.color[0] * value,
            self.color[1] * value * (1.0 - 0.4 * warm),
            self.color[2] * value * (1.0 - warm),
        ]
        .map(|channel| channel.max(0.0))
    }

    /// Height of the rock: lumps down to grains, and ledges.
    fn lumps(&self, x: f64, y: f64) -> f64 {
        let octave = |i: u32| {
            let scale = 3.0 * 2f64.powi(i as i32);
            f64::from(self.noise(x * scale, y * scale, 0.37 * f64::from(i))) / scale.powf(0.85)
        };
        let ledge = f64::from(self.noise(x * 4.0, y * 7.0, 9.1));
        (0..7).map(octave).sum::<f64>() + 0.03 * (ledge * 5.0).fract()
    }

    fn rock(&self, t: f64, s: f64) -> [f32; 3] {
        let step = 0.0015;
        let here = self.lumps(t, s);
        let slope = |dt: f64, ds: f64| (self.lumps(t + dt, s + ds) - here) / step;
        let (along, across) = (slope(step, 0.0), slope(0.0, step));
        // A low lamp on the slopes, and hollows in the dark.
        let facing = 0.3
            + 0.7 * (1.0 - 0.4 * along + 0.25 * across).max(0.0)
                / (1.0 + along * along + across * across).sqrt();
        let hollow = (1.0 + 2.0 * here).clamp(0.25, 1.5);
        // Cracks: where a warped field passes 0.
        let warp = f64::from(self.noise(t * 6.0, s * 6.0, 21.4)) * 0.08;
        let crack = |scale: f64, layer: f64, wide: f64| {
            let field = f64::from(self.noise((t + warp) * scale, (s - warp) * scale, layer));
            1.0 - 0.85 * (-(field / wide).powi(2)).exp()
        };
        let cracks = crack(3.1, 31.4, 0.018) * crack(7.7, 37.4, 0.022);
        let value = (facing.min(1.8) * hollow * cracks) as f32;
        // Iron in some places, gray in others.
        let iron = (0.5
            + 0.9 * self.noise(t * 5.0, s * 5.0, 41.4)
            + 0.3 * self.noise(t * 40.0, s * 40.0, 43.4))
        .clamp(0.0, 1.0);
        let pale = 1.0 + 0.3 * self.noise(t * 9.0, s * 9.0, 47.4);
        [
            self.color[0] * value * pale * (1.0 + 0.15 * iron),
            self.color[1] * value * pale,
            self.color[2] * value * pale * (1.0 - 0.3 * iron),
        ]
        .map(|channel| channel.clamp(0.0, 1.0))
    }
}
