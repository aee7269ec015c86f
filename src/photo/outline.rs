//! The outline: border following, sub-pixel refinement, equal steps, and back to a mask.

use super::raster::Plane;
use bevy::math::Vec2;
use image::{GrayImage, Luma};
use imageproc::contours::{BorderType, find_contours};

/// Longest outer border of a mask (Suzuki and Abe 1985) through the centres of its border pixels, on average clockwise on
/// the screen or not as it comes.
pub(super) fn border(mask: &GrayImage) -> Vec<Vec2> {
    find_contours::<i32>(mask)
        .into_iter()
        .filter(|contour| contour.border_type == BorderType::Outer)
        .max_by_key(|contour| contour.points.len())
        .map(|contour| {
            let centre =
                |p: imageproc::point::Point<i32>| Vec2::new(p.x as f32 + 0.5, p.y as f32 + 0.5);
            contour.points.into_iter().map(centre).collect()
        })
        .unwrap_or_default()
}

/// Twice the signed area of a closed polygon.
fn doubled_area(points: &[Vec2]) -> f32 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}

/// Length of a polyline.
pub(super) fn length(points: &[Vec2]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Length of a closed line of equal steps over that of its course smoothed over `share` of its extent (three moving averages,
/// wrapped around); 1 for a smooth one.
pub(super) fn raggedness(points: &[Vec2], share: f32) -> f32 {
    let closed = |line: &[Vec2]| {
        let next = line.iter().cycle().skip(1);
        line.iter()
            .zip(next)
            .map(|(a, b)| a.distance(*b))
            .sum::<f32>()
    };
    let total = closed(points);
    let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
    for p in points {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let n = points.len();
    let reach = share * (high - low).max_element() / (total / n.max(1) as f32).max(1e-6);
    let reach = (reach.round() as usize).clamp(1, n / 8 + 1);
    let mut line = points.to_vec();
    for _ in 0..3 {
        let around = |i: usize| (n + i - reach..=n + i + reach).map(|k| line[k % n]);
        line = (0..n)
            .map(|i| around(i).sum::<Vec2>() / (2 * reach + 1) as f32)
            .collect();
    }
    total / closed(&line).max(1e-6)
}

/// The polyline at `count` equal steps of arc length; a closed one does not repeat its first point.
pub(super) fn resample(points: &[Vec2], count: usize, closed: bool) -> Vec<Vec2> {
    let Some(&first) = points.first() else {
        return Vec::new();
    };
    let mut line = points.to_vec();
    if closed {
        line.push(first);
    }
    let total = length(&line);
    let steps = if closed {
        count
    } else {
        count.saturating_sub(1)
    };
    if total <= 0.0 || steps == 0 {
        return vec![first; count];
    }
    let mut result = Vec::with_capacity(count);
    let (mut i, mut passed) = (0, 0.0);
    for k in 0..count {
        let target = total * k as f32 / steps as f32;
        while i + 2 < line.len() && passed + line[i].distance(line[i + 1]) < target {
            passed += line[i].distance(line[i + 1]);
            i += 1;
        }
        let (a, b) = (line[i], line[(i + 1).min(line.len() - 1)]);
        let t = (target - passed) / a.distance(b).max(1e-6);
        result.push(a.lerp(b, t.clamp(0.0, 1.0)));
    }
    result
}

/// Moves each point along its normal to where `field` passes 0, at most `reach` pixels, and evens out the moves a little.
/// Border pixels' centres lie half a pixel inside: without a crossing that half is what a point moves.
pub(super) fn refine(points: &[Vec2], field: &Plane, reach: f32) -> Vec<Vec2> {
    let n = points.len();
    if n < 8 {
        return points.to_vec();
    }
    let outward = if doubled_area(points) > 0.0 {
        -1.0
    } else {
        1.0
    };
    let at =
        |i: usize, offset: isize| points[(i as isize + offset).rem_euclid(n as isize) as usize];
    let normals: Vec<Vec2> = (0..n)
        .map(|i| (at(i, 2) - at(i, -2)).perp().normalize_or_zero() * outward)
        .collect();
    let moves: Vec<f32> = (0..n)
        .map(|i| {
            let value = |t: f32| field.sample(points[i] + normals[i] * t);
            let step = 0.25;
            let steps = (reach / step) as i32;
            // Nearest crossing from feather (inside) to background (outside).
            let crossing = |k: i32| {
                let t = k as f32 * step;
                let (a, b) = (value(t), value(t + step));
                (a > 0.0 && b <= 0.0).then(|| t + step * a / (a - b).max(1e-9))
            };
            (0..steps)
                .flat_map(|k| [k, -k - 1])
                .find_map(crossing)
                .unwrap_or(0.5)
        })
        .collect();
    (0..n)
        .map(|i| {
            let around =
                |offset: isize| moves[(i as isize + offset).rem_euclid(n as isize) as usize];
            let mut window = [around(-2), around(-1), around(0), around(1), around(2)];
            window.sort_by(f32::total_cmp);
            points[i] + normals[i] * (0.5 * window[2] + 0.5 * around(0))
        })
        .collect()
}

/// Mask of a closed polygon: 255 where a pixel's centre lies inside (even-odd rule).
pub(super) fn fill(points: &[Vec2], width: u32, height: u32) -> GrayImage {
    let mut mask = GrayImage::new(width, height);
    let mut crossings: Vec<Vec<f32>> = vec![Vec::new(); height as usize];
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
        let first = (low.y - 0.5).ceil().max(0.0) as usize;
        let last = (high.y - 0.5).ceil().clamp(0.0, height as f32) as usize;
        for (y, row) in crossings.iter_mut().enumerate().take(last).skip(first) {
            let t = (y as f32 + 0.5 - low.y) / (high.y - low.y).max(1e-9);
            row.push(low.x + (high.x - low.x) * t);
        }
    }
    for (y, row) in crossings.iter_mut().enumerate() {
        row.sort_by(f32::total_cmp);
        for pair in row.chunks_exact(2) {
            let first = (pair[0] - 0.5).ceil().max(0.0) as u32;
            let last = (pair[1] - 0.5).ceil().clamp(0.0, width as f32) as u32;
            for x in first..last {
                mask.put_pixel(x, y as u32, Luma([255]));
            }
        }
    }
    mask
}
