//! How far an extraction is from the truth.

use super::{
    Truth,
    truth::{EDGE_REACH, crossing, grey},
};
use image::GrayImage;

/// Share of agreement of two masks of one size: twice the common area over the sum of areas, 0..1 (1 for two empty ones).
pub fn dice(a: &GrayImage, b: &GrayImage) -> f64 {
    if a.dimensions() != b.dimensions() {
        return 0.0;
    }
    let (mut common, mut sum) = (0u64, 0u64);
    for (x, y) in a.iter().zip(b.iter()) {
        let (x, y) = (u64::from(*x >= 128), u64::from(*y >= 128));
        common += x & y;
        sum += x + y;
    }
    if sum == 0 {
        return 1.0;
    }
    2.0 * common as f64 / sum as f64
}

/// `count` points at equal steps of arc length along a polyline; empty where that has fewer than 2 points or no length.
pub fn equal_steps(line: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let length: f64 = line.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    if length.is_nan() || length <= 0.0 || count < 2 {
        return Vec::new();
    }
    let step = length / (count - 1) as f64;
    let mut points = vec![line[0]];
    let mut walked = 0.0;
    for pair in line.windows(2) {
        let part = distance(pair[0], pair[1]);
        while points.len() < count - 1 && walked + part >= step * points.len() as f64 {
            let share = (step * points.len() as f64 - walked) / part.max(1e-12);
            points.push(std::array::from_fn(|i| {
                pair[0][i] + share * (pair[1][i] - pair[0][i])
            }));
        }
        walked += part;
    }
    points.push(line[line.len() - 1]);
    points
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn to_line(point: [f64; 2], line: &[[f64; 2]]) -> f64 {
    line.windows(2)
        .map(|pair| {
            let edge = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let to = [point[0] - pair[0][0], point[1] - pair[0][1]];
            let length = (edge[0] * edge[0] + edge[1] * edge[1]).max(1e-12);
            let t = ((edge[0] * to[0] + edge[1] * to[1]) / length).clamp(0.0, 1.0);
            distance(point, [pair[0][0] + t * edge[0], pair[0][1] + t * edge[1]])
        })
        .fold(f64::INFINITY, f64::min)
}

/// Mean distance of two polylines over the image's height: 200 points of each to the other line, so that a missing end counts.
pub fn line_distance(a: &[[f64; 2]], b: &[[f64; 2]], height: f64) -> f64 {
    let (from_a, from_b) = (equal_steps(a, 200), equal_steps(b, 200));
    if from_a.is_empty() || from_b.is_empty() {
        return 1.0;
    }
    let mean = |points: &[[f64; 2]], line: &[[f64; 2]]| {
        points
            .iter()
            .map(|&point| to_line(point, line))
            .sum::<f64>()
            / points.len() as f64
    };
    0.5 * (mean(&from_a, &from_b) + mean(&from_b, &from_a)) / height.max(1.0)
}

/// What the albedo of an extraction is like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlbedoScore {
    /// Root mean square of the difference over places and channels, sRGB 0..1, where the vane is closed and the pattern plain;
    /// none where nothing is.
    pub rms: Option<f64>,
    /// The same where the vane is open and what lies behind shows through.
    pub open: Option<f64>,
    /// Mean displacement of the pattern's edges in pixels; an edge that is gone counts the reach of the search, 8.
    pub edges: Option<f64>,
    /// Share of edges that kept less than 40 % of their step.
    pub lost: f64,
}

/// Judges an albedo, given as a function from pixels of the photograph to sRGB.
pub fn albedo(truth: &Truth, found: impl Fn([f64; 2]) -> Option<[f32; 3]>) -> AlbedoScore {
    // Sum and count, open and closed.
    let mut sums = [(0.0, 0usize); 2];
    for pixel in truth.grid(1500, 5.0) {
        if !truth.is_plain(pixel) {
            continue;
        }
        let wanted = truth.albedo(pixel);
        // What was not found counts as black.
        let got = found(pixel).unwrap_or_default();
        let part = &mut sums[usize::from(truth.is_closed(pixel))];
        part.0 += (0..3)
            .map(|c| f64::from(got[c] - wanted[c]).powi(2))
            .sum::<f64>()
            / 3.0;
        part.1 += 1;
    }
    let [open, rms] = sums.map(|(sum, count)| (count > 0).then(|| (sum / count as f64).sqrt()));
    let edges = truth.pattern_edges();
    let (mut moved, mut lost) = (0.0, 0usize);
    for edge in &edges {
        let line = |t: f64| {
            [
                edge.place[0] + t * edge.normal[0],
                edge.place[1] + t * edge.normal[1],
            ]
        };
        let at = |t: f64| grey(found(line(t)).unwrap_or_default());
        let real = |t: f64| grey(truth.albedo(line(t)));
        let (low, high) = (at(-EDGE_REACH), at(EDGE_REACH));
        let step = real(EDGE_REACH) - real(-EDGE_REACH);
        let level = 0.5 * (low + high);
        let real_level = 0.5 * (real(EDGE_REACH) + real(-EDGE_REACH));
        match (crossing(&at, level), crossing(&real, real_level)) {
            (Some(place), Some(wanted)) if high - low >= 0.4 * step => {
                moved += (place - wanted).abs();
            }
            _ => {
                lost += 1;
                moved += EDGE_REACH;
            }
        }
    }
    AlbedoScore {
        rms,
        open,
        edges: (!edges.is_empty()).then(|| moved / edges.len().max(1) as f64),
        lost: lost as f64 / edges.len().max(1) as f64,
    }
}

/// Mean and percentiles of a set of figures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// How many figures.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// 5th percentile.
    pub low: f64,
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub high: f64,
}

impl Summary {
    /// Of these figures; those that are not finite are left out.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else {
            return Self::default();
        };
        let at = |share: f64| values[(share * last as f64).round() as usize];
        Self {
            count: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            low: at(0.05),
            median: at(0.5),
            high: at(0.95),
        }
    }
}
