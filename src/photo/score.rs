//! The score map S = v a d of Eq. 1: vesselness, alignment, distance.

use super::{color::Lab, outline, raster::Plane};
use bevy::math::Vec2;
use image::{GrayImage, Luma};
use imageproc::distance_transform::euclidean_squared_distance_transform;

/// Frangi's beta: how much a blob is held against a ridge.
const BETA: f32 = 0.5;
/// Color against lightness in the vesselness.
const CHROMA: f32 = 2.0;
/// Power of the cosine between ridge and feather.
const ALIGNMENT: i32 = 6;

/// Score map and what goes into it.
pub(super) struct Score {
    /// S, 0..1.
    pub score: Plane,
    /// Scale of the strongest ridge in pixels, about the half width of a shaft; 0 where there is none.
    pub radius: Plane,
    /// Distance to the outline in pixels.
    pub distance: Plane,
    /// Left and right end of the mask in each row.
    pub span: Vec<Option<(f32, f32)>>,
}

/// First and last pixel of each row of a mask.
pub(super) fn spans(mask: &GrayImage) -> Vec<Option<(f32, f32)>> {
    mask.rows()
        .map(|row| {
            let on: Vec<bool> = row.map(|p| p[0] > 0).collect();
            let first = on.iter().position(|&on| on)?;
            let last = on.iter().rposition(|&on| on)?;
            Some((first as f32, last as f32 + 1.0))
        })
        .collect()
}

/// Eigenvalues (smaller magnitude first) and the direction along the ridge of a symmetric 2 x 2 matrix.
fn eigen(xx: f32, xy: f32, yy: f32) -> (f32, f32, Vec2) {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let root = half.hypot(xy);
    let (a, b) = (mean + root, mean - root);
    let (small, large) = if a.abs() < b.abs() { (a, b) } else { (b, a) };
    // Eigenvector of `small`.
    let along = if xy.abs() > 1e-9 {
        Vec2::new(small - yy, xy).normalize_or(Vec2::Y)
    } else if (xx - small).abs() < (yy - small).abs() {
        Vec2::X
    } else {
        Vec2::Y
    };
    (small, large, along)
}

/// Builds the score map of an upright view. `light` is the equalised lightness, `main` the feather's direction in each row.
pub(super) fn score(light: &Plane, lab: &Lab, mask: &GrayImage, main: &[Vec2]) -> Score {
    let (width, height) = (light.width, light.height);
    let inverse = GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        Luma([255 - mask.get_pixel(x, y)[0]])
    });
    let distance = euclidean_squared_distance_transform(&inverse);
    let distance = Plane {
        width,
        height,
        data: distance.as_raw().iter().map(|d| d.sqrt() as f32).collect(),
    };
    let inner = distance.map(|d| f32::from(u8::from(d > 1.5)));
    let span = spans(mask);
    let length = span.iter().flatten().count().max(1) as f32;

    // Beyond the outline the vane goes on, so that the outline is no ridge.
    let channels = [
        light.fill_in(&inner),
        lab.planes[1].fill_in(&inner).map(|v| v * CHROMA),
        lab.planes[2].fill_in(&inner).map(|v| v * CHROMA),
    ];
    let unit = length / 1100.0;
    let mut best = Plane::new(width, height, 0.0);
    let mut radius = Plane::new(width, height, 0.0);
    for sigma in [1.3, 2.0, 3.0, 4.5, 6.5, 9.5].map(|s: f32| (s * unit).max(0.9)) {
        let smooth = channels.each_ref().map(|plane| plane.blur(sigma));
        let mut strength = Plane::new(width, height, 0.0);
        let mut response = Plane::new(width, height, 0.0);
        for (y, main) in main.iter().enumerate().take(height) {
            for x in 0..width {
                let i = y * width + x;
                if mask.as_raw()[i] == 0 {
                    continue;
                }
                let (mut sum, mut norm) = (0.0f32, 0.0f32);
                for plane in &smooth {
                    let p = |dx, dy| plane.at(x as isize + dx, y as isize + dy);
                    let squared = sigma * sigma;
                    let xx = (p(1, 0) - 2.0 * p(0, 0) + p(-1, 0)) * squared;
                    let yy = (p(0, 1) - 2.0 * p(0, 0) + p(0, -1)) * squared;
                    let xy = (p(1, 1) - p(1, -1) - p(-1, 1) + p(-1, -1)) * 0.25 * squared;
                    let (small, large, along) = eigen(xx, xy, yy);
                    let structure = small.hypot(large);
                    let blob = small / if large.abs() > 1e-9 { large } else { 1e-9 };
                    let aligned = along.dot(*main).abs().powi(ALIGNMENT);
                    let ridge = (-blob * blob / (2.0 * BETA * BETA)).exp() * aligned;
                    sum += (structure * ridge).powi(2);
                    norm += structure * structure;
                }
                strength.data[i] = norm.sqrt();
                response.data[i] = sum.sqrt();
            }
        }
        let mut levels: Vec<f32> = strength.data.iter().copied().filter(|&s| s > 0.0).collect();
        let c = (0.5 * super::raster::quantile(&mut levels, 0.98)).max(0.004);
        for i in 0..best.data.len() {
            // v a: Frangi's factor for structure, here on the response of all channels.
            let r = response.data[i];
            let value = (1.0 - (-r * r / (2.0 * c * c)).exp()).max(0.0);
            if value > best.data[i] {
                best.data[i] = value;
                radius.data[i] = sigma;
            }
        }
    }

    // d: full from a third of the way in; a bare quill is its own middle line.
    let widest = span
        .iter()
        .flatten()
        .map(|(a, b)| b - a)
        .fold(1.0, f32::max);
    let mut score = Plane::new(width, height, 0.0);
    for (y, row) in span.iter().enumerate() {
        let Some((low, high)) = *row else { continue };
        let half = 0.5 * (high - low);
        // Much narrower than the vanes, or as narrow as no vane is.
        let narrow = 1.0 - (2.0 * half / widest - 0.08) / 0.08;
        let thin = 1.0 - (2.0 * half / length - 0.02) / 0.008;
        let bare = narrow.max(thin).clamp(0.0, 1.0);
        for x in low as usize..high as usize {
            let i = y * width + x;
            if mask.as_raw()[i] == 0 {
                continue;
            }
            let d = (distance.data[i] / (0.22 * half).max(1.0)).min(1.0);
            let d = d * d * (3.0 - 2.0 * d);
            let off = ((x as f32 + 0.5) - 0.5 * (low + high)).abs() / half.max(1.0);
            let middle = (1.0 - off * off).max(0.0);
            let ridge = best.data[i] * d * (0.75 + 0.25 * middle);
            score.data[i] = ridge * (1.0 - bare) + middle * bare;
        }
    }
    Score {
        score,
        radius,
        distance,
        span,
    }
}

/// The feather's direction in each row: of the line through the middles of the mask, smoothed over a tenth of its length.
pub(super) fn main_direction(mask: &GrayImage) -> Vec<Vec2> {
    let span = spans(mask);
    let height = span.len();
    let known: Vec<(usize, f32)> = span
        .iter()
        .enumerate()
        .filter_map(|(y, s)| s.map(|(a, b)| (y, 0.5 * (a + b))))
        .collect();
    let (Some(first), Some(last)) = (known.first(), known.last()) else {
        return vec![Vec2::Y; height];
    };
    let points: Vec<Vec2> = known.iter().map(|&(y, x)| Vec2::new(x, y as f32)).collect();
    let line = outline::resample(&points, height, false);
    let xs = Plane::from_fn(1, height, |_, y| line[y].x);
    let smooth = xs.blur((0.06 * (last.0 - first.0) as f32).max(1.0));
    (0..height)
        .map(|y| {
            let (a, b) = (smooth.at(0, y as isize - 2), smooth.at(0, y as isize + 2));
            Vec2::new((b - a) * 0.25 * 0.5, 1.0).normalize_or(Vec2::Y)
        })
        .collect()
}
