//! Planes of floats: sampling, smoothing, filling in.

use bevy::math::Vec2;

/// One channel of a picture; the centre of pixel (x, y) lies at (x + 0.5, y + 0.5).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    pub width: usize,
    pub height: usize,
    pub data: Vec<f32>,
}

impl Plane {
    pub fn new(width: usize, height: usize, value: f32) -> Self {
        Self {
            width,
            height,
            data: vec![value; width * height],
        }
    }

    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> f32) -> Self {
        let data = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| f(x, y))
            .collect();
        Self {
            width,
            height,
            data,
        }
    }

    /// The pixel, with coordinates held inside.
    pub fn at(&self, x: isize, y: isize) -> f32 {
        let x = x.clamp(0, self.width as isize - 1) as usize;
        let y = y.clamp(0, self.height as isize - 1) as usize;
        self.data[y * self.width + x]
    }

    pub fn map(&self, f: impl Fn(f32) -> f32) -> Self {
        self.zip(self, |a, _| f(a))
    }

    pub fn zip(&self, other: &Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let pairs = self.data.iter().zip(&other.data);
        Self {
            data: pairs.map(|(&a, &b)| f(a, b)).collect(),
            ..*self
        }
    }

    /// Bilinear sample at a point, held at the rim.
    pub fn sample(&self, point: Vec2) -> f32 {
        let clean = |x: f32, side: usize| {
            if x.is_finite() {
                (x - 0.5).clamp(0.0, side as f32 - 1.0)
            } else {
                0.0
            }
        };
        let (x, y) = (clean(point.x, self.width), clean(point.y, self.height));
        let (i, j) = (x as isize, y as isize);
        let (s, t) = (x - i as f32, y - j as f32);
        let top = self.at(i, j) * (1.0 - s) + self.at(i + 1, j) * s;
        let bottom = self.at(i, j + 1) * (1.0 - s) + self.at(i + 1, j + 1) * s;
        top * (1.0 - t) + bottom * t
    }

    /// Central differences (x, y) at a pixel.
    pub fn gradient(&self, x: usize, y: usize) -> Vec2 {
        let (x, y) = (x as isize, y as isize);
        Vec2::new(
            self.at(x + 1, y) - self.at(x - 1, y),
            self.at(x, y + 1) - self.at(x, y - 1),
        ) * 0.5
    }

    /// Gaussian blur, the rim held. Wide ones as three boxes.
    pub fn blur(&self, sigma: f32) -> Self {
        if sigma < 0.2 {
            return self.clone();
        }
        let kernel: Vec<f32> = if sigma <= 3.0 {
            let radius = (sigma * 3.0).ceil() as i32;
            (-radius..=radius)
                .map(|i| (-(i * i) as f32 / (2.0 * sigma * sigma)).exp())
                .collect()
        } else {
            return self.boxes(sigma);
        };
        let sum: f32 = kernel.iter().sum();
        let kernel: Vec<f32> = kernel.iter().map(|k| k / sum).collect();
        self.rows(&kernel).transposed().rows(&kernel).transposed()
    }

    /// Gaussian blur along the columns only, as three boxes.
    pub fn blur_down(&self, sigma: f32) -> Self {
        let turned = self.transposed();
        (0..3)
            .fold(turned, |plane, _| plane.box_rows(sigma))
            .transposed()
    }

    fn rows(&self, kernel: &[f32]) -> Self {
        let radius = kernel.len() / 2;
        let mut data = Vec::with_capacity(self.data.len());
        let mut line = vec![0.0; self.width + 2 * radius];
        for row in self.data.chunks_exact(self.width) {
            line[..radius].fill(row[0]);
            line[radius..radius + self.width].copy_from_slice(row);
            line[radius + self.width..].fill(row[self.width - 1]);
            data.extend((0..self.width).map(|x| {
                kernel
                    .iter()
                    .zip(&line[x..])
                    .map(|(k, v)| k * v)
                    .sum::<f32>()
            }));
        }
        Self { data, ..*self }
    }

    /// Three box filters of the Gaussian's variance (the outer weights fractional).
    fn boxes(&self, sigma: f32) -> Self {
        let mut plane = self.clone();
        for _ in 0..2 {
            for _ in 0..3 {
                plane = plane.box_rows(sigma);
            }
            plane = plane.transposed();
        }
        plane
    }

    fn box_rows(&self, sigma: f32) -> Self {
        // A box of half width h (in pixels, fractional) has variance about h (h + 1) / 3; three of them make sigma^2.
        let half = ((1.0 + 4.0 * sigma * sigma).sqrt() - 1.0) / 2.0;
        let radius = half as usize;
        let rest = half - radius as f32;
        let norm = 1.0 / (2.0 * half + 1.0);
        let last = self.width as isize - 1;
        let mut data = Vec::with_capacity(self.data.len());
        for row in self.data.chunks_exact(self.width) {
            let at = |x: isize| row[x.clamp(0, last) as usize];
            let r = radius as isize;
            let mut sum: f64 = (-r..=r).map(|x| f64::from(at(x))).sum();
            for x in 0..=last {
                let ends = at(x - r - 1) + at(x + r + 1);
                data.push((sum as f32 + rest * ends) * norm);
                sum += f64::from(at(x + r + 1)) - f64::from(at(x - r));
            }
        }
        Self { data, ..*self }
    }

    pub fn transposed(&self) -> Self {
        let mut data = vec![0.0; self.data.len()];
        // Blocks keep both sides in the cache.
        for y0 in (0..self.height).step_by(32) {
            for x0 in (0..self.width).step_by(32) {
                for y in y0..(y0 + 32).min(self.height) {
                    for x in x0..(x0 + 32).min(self.width) {
                        data[x * self.height + y] = self.data[y * self.width + x];
                    }
                }
            }
        }
        Self {
            width: self.height,
            height: self.width,
            data,
        }
    }

    /// Half the size, averages of 2 x 2 (an odd last row or column is repeated).
    fn half(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        Self::from_fn(width, height, |x, y| {
            let (x, y) = (2 * x as isize, 2 * y as isize);
            (self.at(x, y) + self.at(x + 1, y) + self.at(x, y + 1) + self.at(x + 1, y + 1)) * 0.25
        })
    }

    /// Fills in where `weight` is 0 from around it, by averages over ever larger squares (push and pull). The values where
    /// `weight` is 1 stay.
    pub fn fill_in(&self, weight: &Self) -> Self {
        let product = self.zip(weight, |a, w| a * w);
        Self::pull(&product, weight)
    }

    fn pull(product: &Self, weight: &Self) -> Self {
        let divided = product.zip(weight, |p, w| p / w.max(1e-9));
        if product.width.max(product.height) <= 1 || weight.data.iter().all(|&w| w >= 1.0) {
            return divided;
        }
        // A few pixels are enough for a full vote of a coarser square.
        let (p, w) = (product.half(), weight.half());
        let full = w.map(|w| (w * 4.0).min(1.0));
        let scaled = p.zip(&w, |p, w| p / w.max(1e-9)).zip(&full, |p, w| p * w);
        let coarse = Self::pull(&scaled, &full);
        let mut result = divided;
        for y in 0..result.height {
            for x in 0..result.width {
                let i = y * result.width + x;
                let w = weight.data[i].clamp(0.0, 1.0);
                if w < 1.0 {
                    let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * 0.5;
                    let below = coarse.sample(point);
                    result.data[i] = result.data[i] * w + below * (1.0 - w);
                }
            }
        }
        result
    }
}

/// The value below which `share` of the values lie; 0 without values. Reorders them.
pub(super) fn quantile(values: &mut [f32], share: f32) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let i = ((values.len() - 1) as f32 * share.clamp(0.0, 1.0)).round() as usize;
    *values.select_nth_unstable_by(i, f32::total_cmp).1
}

/// Median; 0 without values. Reorders them.
pub(super) fn median(values: &mut [f32]) -> f32 {
    quantile(values, 0.5)
}
