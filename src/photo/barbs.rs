//! Barb angle and density, from patches at the photograph's own resolution.

use super::{
    BarbMeasure, Confidence, Doubt,
    prepare::{Photo, View},
    raster::{Plane, median, quantile},
    shaft::Shaft,
};
use crate::anatomy::Side;
use bevy::math::Vec2;
use image::GrayImage;

/// Side of a patch in pixels of the photograph.
const PATCH: (f32, f32) = (9.0, 96.0);
/// Least coherence of a patch that has a vote.
const COHERENCE: f32 = 0.2;
/// Least contrast of a patch's detail, standard deviation of lightness.
const CONTRAST: f32 = 0.003;

/// What one patch shows.
struct Vote {
    side: Side,
    /// Angle of the barbs against the straightened shaft, radians, 0 along it towards the top of the view, pi towards its bottom.
    angle: f32,
    coherence: f32,
    /// Spacing across the barbs in pixels of the photograph.
    period: Option<f32>,
}

/// Barbs of both vanes (left, right as the view shows them).
pub(super) struct Barbs {
    votes: Vec<Vote>,
    /// Pixels of the photograph per feather length.
    length: f32,
}

/// Structure tensor of a patch, weighted by a Hann window: direction along the stripes, coherence, contrast.
fn direction(patch: &Plane) -> (Vec2, f32, f32) {
    let n = patch.width;
    let smooth = patch.blur(0.7);
    let hann = |i: usize| 0.5 - 0.5 * (std::f32::consts::TAU * (i as f32 + 0.5) / n as f32).cos();
    let (mut xx, mut xy, mut yy, mut sum, mut square) = (0.0, 0.0, 0.0, 0.0f32, 0.0);
    for y in 1..n - 1 {
        for x in 1..n - 1 {
            let weight = hann(x) * hann(y);
            let g = smooth.gradient(x, y);
            xx += weight * g.x * g.x;
            xy += weight * g.x * g.y;
            yy += weight * g.y * g.y;
            square += weight * patch.data[y * n + x].powi(2);
            sum += weight;
        }
    }
    let across = 0.5 * (2.0 * xy).atan2(xx - yy);
    let trace = (xx + yy).max(1e-12);
    let coherence = (xx - yy).hypot(2.0 * xy) / trace;
    let contrast = (square / sum.max(1e-6)).sqrt();
    (Vec2::from_angle(across).perp(), coherence, contrast)
}

/// Period of the stripes that run `along`: the peak of the spectrum of the patch projected onto their normal.
fn period(patch: &Plane, along: Vec2) -> Option<f32> {
    let n = patch.width;
    if n < 24 {
        return None;
    }
    let normal = along.perp();
    let half = n as f32 / 2.0;
    let bins = n * 2;
    let (mut sums, mut counts) = (vec![0.0f32; bins], vec![0.0f32; bins]);
    for y in 0..n {
        for x in 0..n {
            let p = Vec2::new(x as f32 + 0.5 - half, y as f32 + 0.5 - half);
            if p.length() > half {
                continue;
            }
            let at = p.dot(normal) * 2.0 + n as f32;
            let i = (at as usize).min(bins - 1);
            sums[i] += patch.data[y * n + x];
            counts[i] += 1.0;
        }
    }
    // Bins of half a pixel, the ones near the rim with few pixels left out.
    let least = 0.3 * half;
    let profile: Vec<f32> = sums
        .iter()
        .zip(&counts)
        .map(|(s, c)| if *c > least { s / c } else { 0.0 })
        .collect();
    let used = counts.iter().filter(|&&c| c > least).count() as f32 * 0.5;
    if used < 16.0 {
        return None;
    }
    let frequencies: Vec<f32> = (0..)
        .map(|k| 4.0 / used + k as f32 * 0.25 / used)
        .take_while(|f| *f < 0.42)
        .collect();
    let power: Vec<f32> = frequencies
        .iter()
        .map(|f| {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, value) in profile.iter().enumerate() {
                let (sin, cos) = (std::f32::consts::TAU * f * i as f32 * 0.5).sin_cos();
                re += value * cos;
                im += value * sin;
            }
            re * re + im * im
        })
        .collect();
    let best = (0..power.len()).max_by(|&a, &b| power[a].total_cmp(&power[b]))?;
    let typical = median(&mut power.clone());
    let inner = best > 1 && best + 2 < power.len();
    (inner && power[best] > 12.0 * typical).then(|| 1.0 / frequencies[best])
}

impl Barbs {
    /// Looks at patches all over both vanes of an upright view.
    pub fn look(photo: &Photo, view: &View, mask: &GrayImage, shaft: &Shaft) -> Self {
        let span = super::score::spans(mask);
        let (first, last) = shaft.rows;
        let rows = (last - first) as f32;
        let mut votes = Vec::new();
        let photo_step = photo.step.max_element();
        for i in 0..=28 {
            let y = first as f32 + rows * (0.06 + 0.84 * i as f32 / 28.0);
            let Some(Some((low, high))) = span.get(y as usize).copied() else {
                continue;
            };
            let x = shaft.at(y);
            // Slope of the shaft per unit towards the top.
            let slope = (shaft.at(y - 6.0) - shaft.at(y + 6.0)) / 12.0;
            for (side, reach) in [(Side::Left, x - low), (Side::Right, high - x)] {
                let size = (0.55 * reach * view.scale / photo_step).clamp(PATCH.0, PATCH.1);
                let n = size as usize;
                for share in [0.38, 0.66] {
                    let centre = Vec2::new(x + side.sign() * reach * share, y);
                    let half = 0.4 * size * photo_step / view.scale;
                    let rim = [(-half, -half), (half, -half), (-half, half), (half, half)];
                    let inside = |p: Vec2| {
                        p.x >= 0.0
                            && p.y >= 0.0
                            && p.x < mask.width() as f32
                            && p.y < mask.height() as f32
                            && mask.get_pixel(p.x as u32, p.y as u32)[0] > 0
                    };
                    let clear = (centre.x - x).abs() - half > 0.06 * reach;
                    if !clear || !rim.iter().all(|&(a, b)| inside(centre + Vec2::new(a, b))) {
                        continue;
                    }
                    let mut patch = Plane::new(n, n, 0.0);
                    for row in 0..n {
                        for column in 0..n {
                            let off = Vec2::new(column as f32, row as f32) + 0.5 - size * 0.5;
                            let at = view.photo(centre + off * photo_step / view.scale);
                            let [r, g, b, _] = photo.sample(at).unwrap_or_default();
                            patch.data[row * n + column] = (0.3 * r + 0.6 * g + 0.1 * b) / 255.0;
                        }
                    }
                    // Bars and shading go, barbs stay.
                    let low_pass = patch.blur((size / 7.0).clamp(2.0, 5.0));
                    let patch = patch.zip(&low_pass, |a, b| a - b);
                    let (along, coherence, contrast) = direction(&patch);
                    if coherence < COHERENCE || contrast < CONTRAST {
                        continue;
                    }
                    // Outwards and up the view, sheared so that the shaft is straight.
                    let up = -along.y;
                    let out = (along.x - slope * up) * side.sign();
                    let (out, up) = if out < 0.0 { (-out, -up) } else { (out, up) };
                    votes.push(Vote {
                        side,
                        angle: out.atan2(up),
                        coherence,
                        period: period(&patch, along).map(|p| p * photo_step),
                    });
                }
            }
        }
        Self {
            votes,
            length: rows * view.scale,
        }
    }

    /// How strongly barbs point to the top of the view (positive) or its bottom, -1..1, and the weight behind it.
    pub fn upward(&self) -> (f32, f32) {
        let (mut sum, mut weight) = (0.0, 0.0);
        for vote in &self.votes {
            let w = vote.coherence * vote.coherence;
            // Nearly parallel or square to the shaft says nothing.
            let clear = (2.0 * vote.angle).sin().abs();
            sum += w * clear * vote.angle.cos().signum();
            weight += w * clear;
        }
        (sum / weight.max(1e-6), weight)
    }

    /// Angle, spread and density of one vane; `trust` hears of doubts.
    pub fn measure(
        &self,
        side: Side,
        slot: usize,
        confidence: &mut Confidence,
    ) -> Option<BarbMeasure> {
        let trust = &mut confidence.barbs[slot];
        let range = 5f32.to_radians()..85f32.to_radians();
        let mut votes: Vec<&Vote> = self
            .votes
            .iter()
            .filter(|vote| vote.side == side && range.contains(&vote.angle))
            .collect();
        let total: f32 = votes.iter().map(|v| v.coherence * v.coherence).sum();
        if votes.len() < 4 || total < 0.5 {
            trust.doubt(Doubt::BarbsNotResolved, 0.0);
            return None;
        }
        votes.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        let at = |share: f32| {
            let mut sum = 0.0;
            for vote in &votes {
                sum += vote.coherence * vote.coherence;
                if sum >= share * total {
                    return vote.angle;
                }
            }
            votes[votes.len() - 1].angle
        };
        let angle = at(0.5);
        let spread = at(0.75) - at(0.25);
        if spread > 0.2 {
            trust.doubt(Doubt::BarbsSpread(spread.to_degrees()), 0.2 / spread);
        }
        let mut counts: Vec<f32> = votes
            .iter()
            .filter_map(|vote| Some(self.length * vote.angle.sin() / vote.period?))
            .collect();
        let enough = counts.len() * 3 >= votes.len() && counts.len() >= 4;
        let agree = quantile(&mut counts, 0.75) < 1.6 * quantile(&mut counts, 0.25);
        let count = (enough && agree).then(|| median(&mut counts));
        Some(BarbMeasure {
            angle,
            spread,
            count,
            coherence: votes.iter().map(|v| v.coherence).sum::<f32>() / votes.len() as f32,
        })
    }
}
