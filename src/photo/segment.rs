//! Feather or background.

use super::{
    background::{Background, FAR, distance, hsv_distance, shadow_color},
    color::Lab,
    edge,
    raster::Plane,
};
use bevy::math::Vec2;
use image::{GrayImage, ImageBuffer, Luma};
use imageproc::{
    contrast::otsu_level,
    distance_transform::{Norm, euclidean_squared_distance_transform},
    morphology,
    region_labelling::{Connectivity, connected_components},
};

/// A shadow falls no further than this share of the feather's length.
const SHADOW: f32 = 0.045;
const ON: Luma<u8> = Luma([255]);
const OFF: Luma<u8> = Luma([0]);

/// A mask and what it was cut from.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    /// 255 on the feather.
    pub mask: GrayImage,
    /// Positive on the feather, 0 on its outline to a fraction of a pixel.
    pub field: Plane,
    /// Distance of each pixel's color to the background's.
    pub far: Plane,
    /// 255 on all that is not background, thin lines too.
    pub loose: GrayImage,
    /// The same without thin lines, gaps closed: the objects.
    pub all: GrayImage,
    /// Areas of the other objects, as shares of the feather's.
    pub others: Vec<f32>,
    /// Distance to the background that was asked for.
    pub threshold: f32,
    /// Share of the outline that lay in shadow.
    pub shadow: f32,
    /// Area of bites into the outline that stayed, over the feather's.
    pub bitten: f32,
}

fn mask_of(plane: &Plane, on: impl Fn(usize, f32) -> bool) -> GrayImage {
    GrayImage::from_fn(plane.width as u32, plane.height as u32, |x, y| {
        let i = y as usize * plane.width + x as usize;
        if on(i, plane.data[i]) { ON } else { OFF }
    })
}

/// Largest component of a mask with its holes filled, and the areas of the others that are at least `least` pixels large.
pub(super) fn largest(mask: &GrayImage, least: u32) -> (GrayImage, u32, Vec<u32>) {
    let labels = connected_components(mask, Connectivity::Eight, OFF);
    let mut areas: Vec<u32> = Vec::new();
    for label in labels.as_raw() {
        let label = *label as usize;
        if label >= areas.len() {
            areas.resize(label + 1, 0);
        }
        areas[label] += 1;
    }
    let best = (1..areas.len()).max_by_key(|&i| areas[i]).unwrap_or(0);
    let area = if best == 0 { 0 } else { areas[best] };
    let mut kept = GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        let on = best > 0 && labels.get_pixel(x, y)[0] as usize == best;
        if on { ON } else { OFF }
    });
    fill_holes(&mut kept);
    let others = (1..areas.len())
        .filter(|&i| i != best && areas[i] >= least)
        .map(|i| areas[i])
        .collect();
    (kept, area, others)
}

/// Fills what is not connected to the frame.
pub(super) fn fill_holes(mask: &mut GrayImage) {
    let (width, height) = mask.dimensions();
    let inverse = GrayImage::from_fn(width, height, |x, y| Luma([255 - mask.get_pixel(x, y)[0]]));
    let labels = connected_components(&inverse, Connectivity::Four, OFF);
    let count = labels.as_raw().iter().copied().max().unwrap_or(0) as usize;
    let mut open = vec![false; count + 1];
    for x in 0..width {
        for y in [0, height - 1] {
            open[labels.get_pixel(x, y)[0] as usize] = true;
        }
    }
    for y in 0..height {
        for x in [0, width - 1] {
            open[labels.get_pixel(x, y)[0] as usize] = true;
        }
    }
    for (pixel, label) in mask.iter_mut().zip(labels.as_raw()) {
        if *label > 0 && !open[*label as usize] {
            *pixel = 255;
        }
    }
}

/// Components of `low` that hold a pixel of `high`.
fn hysteresis(low: &GrayImage, high: &GrayImage) -> GrayImage {
    let labels = connected_components(low, Connectivity::Eight, OFF);
    let count = labels.as_raw().iter().copied().max().unwrap_or(0) as usize;
    let mut seeded = vec![false; count + 1];
    for (label, seed) in labels.as_raw().iter().zip(high.as_raw()) {
        seeded[*label as usize] |= *seed > 0;
    }
    seeded[0] = false;
    GrayImage::from_fn(low.width(), low.height(), |x, y| {
        let on = seeded[labels.get_pixel(x, y)[0] as usize];
        if on { ON } else { OFF }
    })
}

/// Puts back what opening took off: a bare shaft or quill as thin as a line. Such a piece of `loose` leads away from the mask,
/// is much longer than wide, and ends within the picture (a seam of the table does not).
pub(super) fn with_thin_ends(kept: &GrayImage, loose: &GrayImage) -> GrayImage {
    #[derive(Clone, Copy)]
    struct Piece {
        area: u32,
        /// Pixels well away from the mask.
        away: u32,
        low: [u32; 2],
        high: [u32; 2],
        touches: bool,
    }
    let (width, height) = kept.dimensions();
    let area = kept.as_raw().iter().filter(|&&m| m > 0).count() as f32;
    let joined = morphology::close(loose, Norm::L2, 2);
    let [grown, around] = [3, 8].map(|radius| morphology::dilate(kept, Norm::L2, radius));
    let thin = GrayImage::from_fn(width, height, |x, y| {
        let on = joined.get_pixel(x, y)[0] > 0 && kept.get_pixel(x, y)[0] == 0;
        if on { ON } else { OFF }
    });
    let labels = connected_components(&thin, Connectivity::Eight, OFF);
    let count = labels.as_raw().iter().copied().max().unwrap_or(0) as usize;
    let none = Piece {
        area: 0,
        away: 0,
        low: [u32::MAX; 2],
        high: [0; 2],
        touches: false,
    };
    let mut pieces = vec![none; count + 1];
    for (x, y, label) in labels.enumerate_pixels() {
        let piece = &mut pieces[label[0] as usize];
        piece.area += 1;
        piece.away += u32::from(around.get_pixel(x, y)[0] == 0);
        piece.low = [piece.low[0].min(x), piece.low[1].min(y)];
        piece.high = [piece.high[0].max(x), piece.high[1].max(y)];
        piece.touches |= grown.get_pixel(x, y)[0] > 0;
    }
    let good: Vec<bool> = pieces
        .iter()
        .enumerate()
        .map(|(i, piece)| {
            if i == 0 || !piece.touches {
                return false;
            }
            let size = [0, 1].map(|axis| (piece.high[axis] - piece.low[axis] + 1) as f32);
            let long = size[0].hypot(size[1]);
            let within = piece.low.iter().all(|&edge| edge > 0)
                && piece.high[0] + 1 < width
                && piece.high[1] + 1 < height;
            within
                && piece.away * 2 > piece.area
                && long * long > 8.0 * piece.area as f32
                && long > 0.15 * area.sqrt()
        })
        .collect();
    let mut all = kept.clone();
    for (pixel, label) in all.iter_mut().zip(labels.as_raw()) {
        if good[*label as usize] {
            *pixel = 255;
        }
    }
    if good.iter().any(|&good| good) {
        // Over the last gap between a piece and the mask.
        all = largest(&morphology::close(&all, Norm::L2, 3), 1).0;
    }
    all
}

/// Takes soft-edged regions of the background's own hue, only darker, out of the mask; `upright` says that the feather lies along
/// y. Returns how many pixels went.
fn remove_shadow(
    mask: &mut GrayImage,
    lab: &Lab,
    behind: &[[f32; 3]],
    far: &Plane,
    upright: bool,
) -> u32 {
    let (width, height) = mask.dimensions();
    let like_shadow = GrayImage::from_fn(width, height, |x, y| {
        let i = (y * width + x) as usize;
        let on = mask.as_raw()[i] > 0 && shadow_color(lab.at(i), behind[i]);
        if on { ON } else { OFF }
    });
    let total = mask.as_raw().iter().filter(|&&m| m > 0).count() as u32;
    let labels = connected_components(&like_shadow, Connectivity::Eight, OFF);
    let count = labels.as_raw().iter().copied().max().unwrap_or(0) as usize;
    // A vane of the background's hue shows barbs, a shadow only the background's own grain.
    let light = &lab.planes[0];
    let detail = light.zip(&light.blur(1.5), |a, b| (a - b).abs());
    // A shadow as narrow as a bristle's is all slope across, but even along the feather.
    let along = light.zip(&light.blur_down(1.5), |a, b| (a - b).abs());
    let inner = morphology::erode(&like_shadow, Norm::L2, 3);
    let away = morphology::dilate(mask, Norm::L2, 3);
    let [grain, grain_along] = [&detail, &along].map(|detail| {
        let outside = detail.data.iter().zip(away.as_raw());
        let outside = outside.filter(|(_, m)| **m == 0);
        let (sum, count) =
            outside.fold((0.0, 0.0f32), |(sum, count), (d, _)| (sum + d, count + 1.0));
        sum / count.max(1.0)
    });

    #[derive(Clone, Copy, Default)]
    struct Region {
        area: f32,
        /// Pixels beside the background, and the sum of the edge's slope there.
        rim: f32,
        slope: f32,
        depth: f32,
        inner: f32,
        detail: f32,
        along: f32,
    }
    let mut regions = vec![Region::default(); count + 1];
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let label = labels.get_pixel(x, y)[0] as usize;
            if label == 0 {
                continue;
            }
            let i = (y * width + x) as usize;
            let region = &mut regions[label];
            region.area += 1.0;
            region.depth += far.data[i];
            if inner.as_raw()[i] > 0 {
                region.inner += 1.0;
                region.detail += detail.data[i];
                region.along += along.data[i];
            }
            let beside = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            if beside.iter().any(|&(x, y)| mask.get_pixel(x, y)[0] == 0) {
                region.rim += 1.0;
                region.slope += far.gradient(x as usize, y as usize).length();
            }
        }
    }
    let soft: Vec<bool> = regions
        .iter()
        .enumerate()
        .map(|(i, region)| {
            let big = region.area > total as f32 / 300.0 + 8.0 && region.area < 0.7 * total as f32;
            let outside = region.rim > 0.15 * region.area.sqrt();
            let sharpness = region.slope * region.area / (region.rim * region.depth).max(1e-6);
            let narrow = upright
                && region.inner < 0.5 * region.area
                && region.area < 0.02 * height as f32 * region.rim;
            let plain = region.detail < (1.4 * grain + 0.0008) * region.inner
                || narrow && region.along < (1.4 * grain_along + 0.0008) * region.inner;
            // Too narrow to tell: the edge decides.
            let limit = match region.inner > 0.1 * region.area {
                true if plain => 0.3,
                true => 0.03,
                false => 0.16,
            };
            i > 0 && big && outside && sharpness < limit
        })
        .collect();
    // A bare quill of the background's hue sticks out further than a shadow falls.
    let mut rows = vec![(0u32, 0u32); height as usize];
    for ((_, y, pixel), label) in mask.enumerate_pixels().zip(labels.as_raw()) {
        if pixel[0] > 0 {
            let (dark, all) = &mut rows[y as usize];
            *dark += u32::from(soft[*label as usize]);
            *all += 1;
        }
    }
    let mut ends = [0; 2];
    for end in &mut ends {
        let first = rows.iter().position(|&(_, all)| all > 0).unwrap_or(0);
        let rest = rows[first..]
            .iter()
            .position(|&(dark, all)| dark * 4 < all * 3);
        let quill = rest.unwrap_or(0);
        if upright && quill as f32 > SHADOW * height as f32 {
            *end = first + quill;
        }
        rows.reverse();
    }
    let inner = ends[0] as u32..height - (ends[1] as u32).min(height);
    let mut gone = 0;
    for ((_, y, pixel), label) in mask.enumerate_pixels_mut().zip(labels.as_raw()) {
        if soft[*label as usize] && inner.contains(&y) {
            pixel[0] = 0;
            gone += 1;
        }
    }
    gone
}

/// Fills rows that a mask leaves out between others with those of `kept`: where a thin shaft leaves its vane, the field may lose it.
fn bridge(mask: &mut GrayImage, kept: &GrayImage) {
    let on: Vec<bool> = mask
        .rows()
        .map(|mut row| row.any(|pixel| pixel[0] > 0))
        .collect();
    let (Some(first), Some(last)) = (on.iter().position(|&on| on), on.iter().rposition(|&on| on))
    else {
        return;
    };
    for (x, y, pixel) in mask.enumerate_pixels_mut() {
        let row = y as usize;
        if (first..=last).contains(&row) && !on[row] {
            *pixel = *kept.get_pixel(x, y);
        }
    }
}

/// Cuts the feather out. `open` is the radius below which what sticks out of it is taken off (lines of a grid), `close` that
/// of gaps which are closed, `band` the width along the outline over which the threshold adapts; `valid` is 0 beyond the photograph.
pub(super) fn segment(
    lab: &Lab,
    background: &Background,
    place: &dyn Fn(usize, usize) -> Vec2,
    valid: Option<&Plane>,
    [open, close]: [u8; 2],
    [band, pixel]: [f32; 2],
) -> Segment {
    let (width, height) = (lab.width(), lab.height());
    let behind: Vec<[f32; 3]> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| background.behind(place(x, y), lab.at(y * width + x)))
        .collect();
    let inside = |i: usize| valid.is_none_or(|v| v.data[i] > 0.0);
    let mut far = Plane::new(width, height, 0.0);
    for (i, value) in far.data.iter_mut().enumerate() {
        *value = if inside(i) {
            background.distance(lab.at(i), behind[i]).min(FAR)
        } else {
            0.0
        };
    }
    // Lines are thin: what has their color and is thick is no line.
    if background.line.is_some() {
        let plain = Plane::from_fn(width, height, |x, y| {
            let i = y * width + x;
            if inside(i) {
                distance(lab.at(i), behind[i]).min(FAR)
            } else {
                0.0
            }
        });
        let limit = (1.6 * background.most).max(0.06);
        let other = mask_of(&plain, |_, value| value > limit);
        let radius = (width.max(height) as f32 * 0.008).ceil().clamp(3.0, 12.0) as u8;
        let thick = morphology::dilate(&morphology::open(&other, Norm::L2, radius), Norm::L2, 2);
        for (i, value) in far.data.iter_mut().enumerate() {
            if thick.as_raw()[i] > 0 {
                *value = plain.data[i];
            }
        }
    }

    // Otsu's threshold over the distances, kept clear of the background's own.
    let bytes = GrayImage::from_fn(width as u32, height as u32, |x, y| {
        let value = far.data[y as usize * width + x as usize];
        Luma([(value / FAR * 255.0) as u8])
    });
    let otsu = f32::from(otsu_level(&bytes)) / 255.0 * FAR;
    let floor = (1.6 * background.most).max(0.028);
    let high = otsu.clamp(floor.min(0.3), 0.3);
    let low = floor.min(0.7 * high);
    // What may be shadow has to differ more.
    let low_shadow = low.max(0.35 * high);
    let high_mask = mask_of(&far, |i, value| {
        value > high
            && hsv_distance(lab.at(i), behind[i]) > (1.2 * background.most_hsv).clamp(0.04, 0.3)
    });
    let low_mask = mask_of(&far, |i, value| {
        value > low_shadow || (value > low && !shadow_color(lab.at(i), behind[i]))
    });
    let mut mask = hysteresis(&low_mask, &high_mask);
    let before = mask.as_raw().iter().filter(|&&m| m > 0).count();
    let gone = remove_shadow(&mut mask, lab, &behind, &far.blur(0.8), band > 0.0);
    let shadow = gone as f32 / before.max(1) as f32;
    let loose = mask.clone();
    // Thin lines go first; then closing joins what a stripe of the background's color parts.
    if open > 0 {
        mask = morphology::open(&mask, Norm::L2, open);
    }
    mask = morphology::close(&mask, Norm::L2, close);
    let least = (width * height / 4000).max(12) as u32;
    let (mut kept, area, others) = largest(&mask, least);
    let all = mask;
    if band > 0.0 {
        kept = with_thin_ends(&kept, &loose);
    }

    // Between feather and background the outline runs half way, whatever their contrast there.
    let mut field = far.map(|value| value - low);
    let mut bitten = 0.0;
    if band > 0.0 && area > 0 {
        let scene = edge::Scene {
            lab,
            behind: &behind,
            far: &far,
            pixel,
            usable: &Plane::from_fn(width, height, |x, y| {
                f32::from(u8::from(inside(y * width + x)))
            }),
        };
        let ([seen, sharp], [in_shadow, likely]) = edge::field(&scene, &kept, low, band);
        field = sharp;
        let near_kept = morphology::dilate(&kept, Norm::L2, 3);
        let mut refined = mask_of(&seen, |i, value| value > 0.0 && near_kept.as_raw()[i] > 0);
        // Deep inside, a pattern of the background's color is feather all the same; less deep, unless it may be shadow.
        let core = morphology::erode(&kept, Norm::L2, close.max(3));
        let deep = morphology::erode(&kept, Norm::L2, (1.5 * band) as u8);
        for (i, pixel) in refined.iter_mut().enumerate() {
            let inside = if likely.as_raw()[i] == 0 {
                &core
            } else {
                &deep
            };
            if in_shadow.as_raw()[i] == 0 {
                *pixel |= inside.as_raw()[i];
            }
        }
        // Gaps between the ends of barbs.
        let filled = morphology::close(&refined, Norm::L2, close);
        for (i, pixel) in refined.iter_mut().enumerate() {
            if in_shadow.as_raw()[i] == 0 {
                *pixel |= filled.as_raw()[i] & kept.as_raw()[i];
            }
        }
        bridge(&mut refined, &kept);
        let whole = refined.clone();
        if open > 0 {
            refined = morphology::open(&refined, Norm::L2, 1);
        }
        let (refined, ..) = largest(&refined, least);
        let refined = with_thin_ends(&refined, &whole);
        // A refinement that loses much of the feather was misled; a thin line may lose half of its width.
        let around = morphology::dilate(&refined, Norm::L2, 6);
        let held = kept.iter().zip(around.iter());
        let held = held.filter(|(kept, around)| **kept > 0 && **around > 0);
        if held.count() as f32 > 0.6 * area as f32 {
            kept = refined;
        }
        bitten = edge::fill_bites(&mut kept, &scene, background.most);
    }
    Segment {
        mask: kept,
        field,
        far,
        loose,
        all,
        others: others
            .iter()
            .map(|&a| a as f32 / area.max(1) as f32)
            .collect(),
        threshold: low,
        shadow,
        bitten,
    }
}

/// Labels of what a mask holds once bridges narrower than two fifths of the widest are cut, and those of comparable size, the
/// largest first.
fn core_labels(mask: &GrayImage) -> (ImageBuffer<Luma<u32>, Vec<u32>>, Vec<u32>) {
    let inverse = GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        Luma([255 - mask.get_pixel(x, y)[0]])
    });
    let distance = euclidean_squared_distance_transform(&inverse);
    let widest = distance.as_raw().iter().copied().fold(0.0, f64::max).sqrt();
    let radius = (0.2 * widest).clamp(1.0, 40.0) as u8;
    let opened = morphology::open(mask, Norm::L2, radius);
    let labels = connected_components(&opened, Connectivity::Eight, OFF);
    let count = labels.as_raw().iter().copied().max().unwrap_or(0);
    let mut areas = vec![0u32; count as usize + 1];
    for label in labels.as_raw() {
        areas[*label as usize] += 1;
    }
    areas[0] = 0;
    let most = areas.iter().copied().max().unwrap_or(0) as f32;
    let mut large: Vec<u32> = (1..=count)
        .filter(|&label| areas[label as usize] as f32 > 0.3 * most)
        .collect();
    large.sort_by_key(|&label| std::cmp::Reverse(areas[label as usize]));
    (labels, large)
}

/// How many objects of comparable size a mask holds once bridges between them are cut.
pub(super) fn bodies(mask: &GrayImage) -> usize {
    core_labels(mask).1.len().max(1)
}

/// The cores of those objects, at most `most`.
pub(super) fn cores(mask: &GrayImage, most: usize) -> Vec<GrayImage> {
    let (labels, large) = core_labels(mask);
    let core = |label: &u32| {
        GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
            let on = labels.get_pixel(x, y)[0] == *label;
            if on { ON } else { OFF }
        })
    };
    large.iter().take(most).map(core).collect()
}
