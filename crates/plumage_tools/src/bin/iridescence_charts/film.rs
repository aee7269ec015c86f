//! One film, its Airy formula at three wavelengths: what shaders without a table do.

use std::f64::consts::TAU;

/// Wavelengths that stand for red, green and blue, nm.
const WAVELENGTHS: [f64; 3] = [612.0, 549.0, 464.0];
/// Refractive index of keratin.
const KERATIN: f64 = 1.55;

/// The film that comes nearest to a stack: thickness in nanometres, index below, and per channel a factor and an offset.
pub struct Fitted {
    thickness: f64,
    below: f64,
    lines: [[f64; 2]; 3],
}

/// Mean over polarizations of a film's reflectance.
fn airy(thickness: f64, below: f64, cosine: f64, wavelength: f64) -> f64 {
    let sin2 = 1.0 - cosine * cosine;
    let inside = (1.0 - sin2 / (KERATIN * KERATIN)).sqrt();
    let beneath = (1.0 - sin2 / (below * below)).max(0.0).sqrt();
    let phase = (2.0 * TAU / wavelength * KERATIN * thickness * inside).cos();
    let reflected = |upper: f64, lower: f64| {
        let product = 2.0 * upper * lower * phase;
        let (u2, l2) = (upper * upper, lower * lower);
        (u2 + l2 + product) / (1.0 + u2 * l2 + product)
    };
    let s = |a: f64, ca: f64, b: f64, cb: f64| (a * ca - b * cb) / (a * ca + b * cb);
    let p = |a: f64, ca: f64, b: f64, cb: f64| (b * ca - a * cb) / (b * ca + a * cb);
    let across = reflected(
        s(1.0, cosine, KERATIN, inside),
        s(KERATIN, inside, below, beneath),
    );
    let along = reflected(
        p(1.0, cosine, KERATIN, inside),
        p(KERATIN, inside, below, beneath),
    );
    0.5 * (across + along)
}

impl Fitted {
    /// Least squares over the colors at `cosine(0)`, `cosine(1)` and so on.
    pub fn to(colors: &[[f64; 3]], cosine: fn(usize) -> f64) -> Self {
        let mut best = (f64::INFINITY, None);
        for below in [1.0, 1.75] {
            for step in 0..200 {
                let thickness = 60.0 + 5.0 * f64::from(step);
                let mut residue = 0.0;
                let lines = [0, 1, 2].map(|c| {
                    let value = |i: usize| airy(thickness, below, cosine(i), WAVELENGTHS[c]);
                    let n = colors.len() as f64;
                    let (mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0);
                    for (i, color) in colors.iter().enumerate() {
                        let v = value(i);
                        (x, y, xx, xy) = (x + v, y + color[c], xx + v * v, xy + v * color[c]);
                    }
                    let slope = (n * xy - x * y) / (n * xx - x * x).max(1e-12);
                    let offset = (y - slope * x) / n;
                    let error = |(i, color): (usize, &[f64; 3])| {
                        (slope * value(i) + offset - color[c]).powi(2)
                    };
                    residue += colors.iter().enumerate().map(error).sum::<f64>();
                    [slope, offset]
                });
                if residue < best.0 {
                    let found = Self {
                        thickness,
                        below,
                        lines,
                    };
                    best = (residue, Some(found));
                }
            }
        }
        best.1.unwrap_or(Self {
            thickness: 0.0,
            below: 1.0,
            lines: [[0.0; 2]; 3],
        })
    }

    /// Its color.
    pub fn color(&self, cosine: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let [slope, offset] = self.lines[c];
            (slope * airy(self.thickness, self.below, cosine, WAVELENGTHS[c]) + offset).max(0.0)
        })
    }
}
