//! The painted pattern baked into a small image over the UV rectangle.

use super::{Albedo, Bars, Feather, Pattern, Rim, Side};
use crate::maths::{card, functions::smooth_step};
use noise::{NoiseFn, Perlin};

impl Albedo {
    /// The pattern of the face towards the body.
    pub fn back_pattern(&self) -> &Pattern {
        self.back.as_ref().unwrap_or(&self.front)
    }
}

/// Default width of a baked pattern in pixels.
pub const BAKE_WIDTH: usize = 32;
/// Default height of a baked pattern in pixels.
pub const BAKE_HEIGHT: usize = 128;

fn blend(from: [f32; 4], to: [f32; 4], share: f32) -> [f32; 4] {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share)
}

fn with_tint(rgb: [f32; 3], tint: f32) -> [f32; 4] {
    [rgb[0], rgb[1], rgb[2], tint]
}

/// What one feather's patterns have in common: outline, map, noise.
struct Canvas<'a> {
    feather: &'a Feather,
    outline: Vec<[f32; 2]>,
    /// Largest reach, the unit of a rim's width.
    half_width: f32,
    perlin: Perlin,
}

impl Canvas<'_> {
    /// Signed distance to the outline in half widths, positive inside the vane.
    fn inset(&self, side: Side, point: [f32; 2]) -> f32 {
        let mut squared = f32::INFINITY;
        for (i, a) in self.outline.iter().enumerate() {
            let b = self.outline[(i + 1) % self.outline.len()];
            let (edge, to) = (
                [b[0] - a[0], b[1] - a[1]],
                [point[0] - a[0], point[1] - a[1]],
            );
            let length = (edge[0] * edge[0] + edge[1] * edge[1]).max(1e-12);
            let t = ((edge[0] * to[0] + edge[1] * to[1]) / length).clamp(0.0, 1.0);
            let gap = [to[0] - t * edge[0], to[1] - t * edge[1]];
            squared = squared.min(gap[0] * gap[0] + gap[1] * gap[1]);
        }
        let root = card::barb_root(point, self.feather.vane(side).cotangent());
        let inside = point[0].abs() < self.feather.contour.reach(side, root);
        let distance = squared.min(4.0).sqrt() / self.half_width;
        if inside { distance } else { -distance }
    }

    fn paint(&self, pattern: &Pattern, point: [f32; 2]) -> [f32; 4] {
        let [x, y] = point;
        let across = x / self.half_width;
        let side = if x < 0.0 { Side::Left } else { Side::Right };
        let noise =
            |a: f32, b: f32, seed: f64| self.perlin.get([f64::from(a), f64::from(b), seed]) as f32;
        // Zones and bars follow the barbs a little and are never ruler-straight.
        let along =
            y - 0.06 * across.abs() * self.half_width + 0.02 * noise(across * 2.0, y * 6.0, 0.5);
        let mut paint = stop_color(pattern, along);
        if let Some(Bars {
            count,
            color,
            share,
            waviness,
        }) = pattern.bars
        {
            let wave = waviness
                * (0.9 * noise(across * 1.7, y * count * 0.4, 1.5)
                    + 0.25 * (across.abs() * 3.0).sin());
            let phase = (y * count + wave).rem_euclid(1.0);
            let from_middle = (phase - 0.5).abs();
            let softness = 0.06 + 0.1 * waviness;
            let bar =
                1.0 - smooth_step(share * 0.5 - softness, share * 0.5 + softness, from_middle);
            paint = blend(paint, with_tint(color, 0.0), bar);
        }
        if let Some(Rim {
            width,
            softness,
            color,
            tint,
        }) = pattern.rim
        {
            let soft = (width * softness).max(0.02);
            let rim = 1.0 - smooth_step(width - soft, width + soft, self.inset(side, point));
            // Down has no rim.
            let downy = self.feather.vane(side).downy;
            let rim = rim * smooth_step(downy - 0.02, downy + 0.15, y);
            paint = blend(paint, with_tint(color, tint), rim);
        }
        for spot in &pattern.spots {
            let from_middle = f32::hypot(
                (across - spot.across) / spot.half_width,
                (y - spot.v) / spot.half_length,
            );
            let inside = 1.0 - smooth_step(0.8, 1.2, from_middle);
            paint = blend(paint, with_tint(spot.color, spot.tint), inside);
        }
        if pattern.mottle > 0.0 {
            // A barb keeps its tone, its neighbors differ: streaks along the barbs.
            let barb =
                card::barb_root(point, self.feather.vane(side).cotangent()) / self.half_width;
            let seed = if x < 0.0 { 2.5 } else { 12.5 };
            let grain = 0.7 * noise(across * 1.5, barb * 4.5, seed)
                + 0.5 * noise(across * 3.0, barb * 13.0, seed + 1.0);
            let value = 1.0 + pattern.mottle * grain;
            for channel in &mut paint[..3] {
                *channel = (*channel * value).clamp(0.0, 1.0);
            }
        }
        paint
    }
}

/// Color and tint share of the stops at height `v`, held beyond the first and last.
fn stop_color(pattern: &Pattern, v: f32) -> [f32; 4] {
    let Some(first) = pattern.stops.first() else {
        return [0.5, 0.5, 0.5, 0.0];
    };
    let mut last = (first.v, with_tint(first.color, first.tint));
    for stop in &pattern.stops {
        let (at, here) = (stop.v, with_tint(stop.color, stop.tint));
        if v < at {
            return blend(
                last.1,
                here,
                ((v - last.0) / (at - last.0).max(1e-6)).clamp(0.0, 1.0),
            );
        }
        last = (at, here);
    }
    last.1
}

impl Pattern {
    /// The pattern as `width` x `height` RGBA bytes over the UV rectangle of `feather`, rows from v = 0 (skin) to 1, each
    /// row from u = 0 to 1. RGB is sRGB, A the tint share (0 keeps the paint, 255 hands it to the groom). The pattern
    /// runs on beyond the outline, so that filtering at the rim picks up no foreign paint. Sizes are clamped to 1..4096.
    pub fn bake(&self, width: usize, height: usize, feather: &Feather) -> Vec<u8> {
        let (width, height) = (width.clamp(1, 4096), height.clamp(1, 4096));
        let reach = feather.contour.left.iter().chain(&feather.contour.right);
        let canvas = Canvas {
            feather,
            outline: feather
                .contour
                .resampled(96)
                .polyline([feather.left.barb_angle, feather.right.barb_angle]),
            half_width: reach.copied().fold(1e-3, f32::max),
            perlin: Perlin::new(feather.gaps.seed),
        };
        let map = feather.map();
        let mut bytes = Vec::with_capacity(width * height * 4);
        for row in 0..height {
            let v = (row as f64 + 0.5) / height as f64;
            for column in 0..width {
                let u = (column as f64 + 0.5) / width as f64;
                let point = map.canonical([u, v]).map(|x| x as f32);
                let paint = canvas.paint(self, point);
                bytes.extend(paint.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8));
            }
        }
        bytes
    }
}
