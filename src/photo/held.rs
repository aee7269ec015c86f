//! What holds the feather: it touches it, has other colors, and reaches the picture's border.

use super::{color::Lab, outline::border, raster::Plane, segment::largest};
use image::{GrayImage, Luma};
use imageproc::{
    distance_transform::{Norm, euclidean_squared_distance_transform},
    morphology,
    region_labelling::{Connectivity, connected_components},
};
use std::{cmp::Reverse, collections::BinaryHeap};

/// An object that reaches the border along less than this share of its size (root of its area) is only cut off there.
const CONTACT: f32 = 0.10;
/// Each of the two has at least this share of the area.
const LEAST: f32 = 0.04;
/// Colors tell them apart at least this well: 1 where they have none in common, 0 where all.
const APART: f32 = 0.55;
/// Less than this, and they are one thing; between the two it is unclear.
const UNCLEAR: f32 = 0.3;
/// Two things that touch are set off from each other: this much more than half of a disk is theirs where their common edge meets
/// the outline, or their hulls are this much fuller than that of both.
const SET_OFF: f32 = 0.05;
/// Bins of the colors: lightness from 0, a and b from -0.4.
const BINS: [(usize, f32); 3] = [(24, 0.045), (36, 0.0225), (36, 0.0225)];
/// Places along the object where it is tried to end the holder.
const CUTS: usize = 48;
/// Share of the most that a cut can tell which the first one taken tells.
const NEARLY: f32 = 0.85;
/// Rounds in which colors and masks follow each other.
const ROUNDS: usize = 4;

/// What became of an object that reaches the border.
#[derive(Clone, Debug)]
pub(super) enum Held {
    /// It does not, or hardly.
    Free,
    /// As one thing that the border cuts.
    Cut,
    /// The same, but of other colors towards the border.
    Banded,
    /// Held by a part that has too much of its colors.
    Unclear { apart: f32, least: f32 },
    /// Held by the masked part.
    By(GrayImage),
}

fn bin(color: [f32; 3]) -> usize {
    let low = [0.0, -0.405, -0.405];
    (0..3).fold(0, |at, c| {
        let (count, step) = BINS[c];
        let i = ((color[c] - low[c]) / step).clamp(0.0, count as f32 - 1.0);
        at * count + i as usize
    })
}

/// Bins blurred by one step each way.
fn blurred(histogram: &[f32]) -> Vec<f32> {
    let mut values = histogram.to_vec();
    let mut stride = 1;
    for (count, _) in BINS.into_iter().rev() {
        let old = values.clone();
        for (i, value) in values.iter_mut().enumerate() {
            let at = i / stride % count;
            let before = if at > 0 { old[i - stride] } else { old[i] };
            let after = if at + 1 < count {
                old[i + stride]
            } else {
                old[i]
            };
            *value = 0.25 * before + 0.5 * old[i] + 0.25 * after;
        }
        stride *= count;
    }
    values
}

/// How much of a label of two the colors tell: mutual information over the label's own, 0..1, and the former in nats.
fn told(both: [&[f32]; 2]) -> [f32; 2] {
    let sums = both.map(|part| part.iter().sum::<f32>());
    let all = sums[0] + sums[1];
    let plogp = |p: f32| if p > 0.0 { p * p.ln() } else { 0.0 };
    let own = -plogp(sums[0] / all) - plogp(sums[1] / all);
    let left: f32 = both[0]
        .iter()
        .zip(both[1])
        .filter(|(a, b)| *a + *b > 0.0)
        .map(|(a, b)| -(plogp(a / (a + b)) + plogp(b / (a + b))) * (a + b) / all)
        .sum();
    [(own - left) / own.max(1e-6), own - left]
}

/// Way from the border to each pixel of an object, within it, in fifths of pixels; none outside.
fn ways(object: &GrayImage, starts: &[usize]) -> Vec<u32> {
    let (width, height) = (object.width() as i64, object.height() as i64);
    let mut way = vec![u32::MAX; object.as_raw().len()];
    let mut queue: BinaryHeap<Reverse<(u32, usize)>> = BinaryHeap::new();
    for &start in starts {
        way[start] = 0;
        queue.push(Reverse((0, start)));
    }
    while let Some(Reverse((far, i))) = queue.pop() {
        if far > way[i] {
            continue;
        }
        let (x, y) = (i as i64 % width, i as i64 / width);
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let (nx, ny) = (x + dx, y + dy);
            if !(0..width).contains(&nx) || !(0..height).contains(&ny) {
                continue;
            }
            let next = (ny * width + nx) as usize;
            let step = far + if dx == 0 || dy == 0 { 5 } else { 7 };
            if object.as_raw()[next] > 0 && step < way[next] {
                way[next] = step;
                queue.push(Reverse((step, next)));
            }
        }
    }
    way
}

/// Finds the part of an object that holds the rest: from the border inwards, of other colors than the rest, and set off from it by
/// corners of the outline (a banded feather that the border cuts off has none).
pub(super) fn held(object: &GrayImage, lab: &Lab) -> Held {
    let (width, height) = object.dimensions();
    let on: Vec<usize> = (0..object.as_raw().len())
        .filter(|&i| object.as_raw()[i] > 0)
        .collect();
    let edge = |i: usize| {
        let (x, y) = (i as u32 % width, i as u32 / width);
        x.min(y).min(width - 1 - x).min(height - 1 - y)
    };
    let contact: Vec<usize> = on.iter().copied().filter(|&i| edge(i) == 0).collect();
    let size = (on.len() as f32).sqrt();
    if (contact.len() as f32) < CONTACT * size {
        return Held::Free;
    }
    let way = ways(object, &contact);
    let bins: Vec<usize> = on.iter().map(|&i| bin(lab.at(i))).collect();
    let reached: Vec<usize> = (0..on.len()).filter(|&k| way[on[k]] < u32::MAX).collect();
    let most = reached
        .iter()
        .map(|&k| way[on[k]])
        .max()
        .unwrap_or(0)
        .max(1) as f32;
    let count = BINS.iter().map(|(count, _)| count).product();
    let histogram = |holder: &dyn Fn(usize) -> Option<bool>| {
        let mut both = [vec![0.0f32; count], vec![0.0f32; count]];
        for (k, &i) in on.iter().enumerate() {
            if let Some(own) = holder(i) {
                both[usize::from(own)][bins[k]] += 1.0;
            }
        }
        both
    };

    // Where along the way do the colors change most?
    let share = |i: usize| way[i] as f32 / most;
    let mut gains = Vec::new();
    for cut in 1..CUTS {
        let cut = cut as f32 / CUTS as f32;
        let both = histogram(&|i| (way[i] < u32::MAX).then(|| share(i) < cut));
        let own = both[1].iter().sum::<f32>();
        if own < LEAST * on.len() as f32 || own > (1.0 - 2.0 * LEAST) * on.len() as f32 {
            continue;
        }
        let [_, nats] = told([&both[0], &both[1]]);
        gains.push((nats, cut));
    }
    let most_told = gains.iter().fold(0.0, |most, gain| f32::max(most, gain.0));
    // The first one that tells nearly as much: the foot of the feather may have colors of its own.
    let Some(&(_, cut)) = gains.iter().find(|gain| gain.0 > NEARLY * most_told) else {
        return Held::Cut;
    };

    // Then pixel by pixel: by color, with the neighbors, and a little by place.
    let mut holder = GrayImage::from_fn(width, height, |x, y| {
        let i = (y * width + x) as usize;
        let near = object.as_raw()[i] > 0 && share(i) < cut;
        Luma([if near { 255 } else { 0 }])
    });
    let mut feather = GrayImage::new(width, height);
    let sigma = (0.015 * size).clamp(1.0, 6.0);
    for _ in 0..ROUNDS {
        let both = histogram(&|i| Some(holder.as_raw()[i] > 0)).map(|part| {
            let sum = part.iter().sum::<f32>().max(1.0);
            blurred(&part).iter().map(|v| v / sum).collect::<Vec<_>>()
        });
        let mut votes = Plane::new(width as usize, height as usize, 0.0);
        for (k, &i) in on.iter().enumerate() {
            let [other, own] = [0, 1].map(|part: usize| both[part][bins[k]] + 2e-5);
            let place = ((share(i).min(1.0) - cut) / 0.2).clamp(-1.0, 1.0);
            votes.data[i] = (own / other).ln().clamp(-3.0, 3.0) - 0.7 * place;
        }
        let votes = votes.blur(sigma);
        let own = GrayImage::from_fn(width, height, |x, y| {
            let i = (y * width + x) as usize;
            let yes = object.as_raw()[i] > 0 && votes.data[i] > 0.0;
            Luma([if yes { 255 } else { 0 }])
        });
        let own = joined(&own, &contact);
        // A bare shaft may have the colors of a hand; it is thinner than fingers.
        let thick = thickness(&own);
        let own = joined(
            &opened(&own, (0.4 * thick).clamp(1.0, 30.0) as u8),
            &contact,
        );
        // The rim of a hand may have the colors of the feather, and is as thin.
        let rest = without(object, &own);
        if [&own, &rest]
            .iter()
            .any(|part| part.iter().all(|&m| m == 0))
        {
            return Held::Cut;
        }
        let radius = (0.2 * thick).min(0.5 * thickness(&rest)).clamp(1.0, 8.0) as u8;
        let core = component(&opened(&rest, radius));
        feather = component(&without(&rest, &nearer(&own, &core)));
        holder = without(object, &feather);
    }

    let area = holder.iter().filter(|m| **m > 0).count() as f32;
    let both = histogram(&|i| Some(holder.as_raw()[i] > 0));
    let [apart, _] = told([&both[0], &both[1]]);
    let corner = corner(object, &holder, &feather);
    let waist = waist(object, &holder, &feather);
    let reach = contact.iter().filter(|&&i| holder.as_raw()[i] > 0).count() as f32;
    let share = area / on.len() as f32;
    let two = (LEAST..1.0 - LEAST).contains(&share) && reach > 0.6 * contact.len() as f32;
    let set_off = corner.max(waist);
    match (two, apart > APART) {
        (true, true) if set_off > SET_OFF => Held::By(holder),
        (true, true) => Held::Banded,
        (true, false) if apart > UNCLEAR && set_off > 2.0 * SET_OFF => Held::Unclear {
            apart,
            least: APART,
        },
        _ => Held::Cut,
    }
}

/// How much fuller the convex hulls of both parts are than that of the whole: two things that touch have a waist.
fn waist(object: &GrayImage, holder: &GrayImage, feather: &GrayImage) -> f32 {
    let fill = |masks: &[&GrayImage]| {
        let (mut area, mut hulls) = (0.0, 0.0);
        for mask in masks {
            let points: Vec<imageproc::point::Point<i32>> = border(mask)
                .into_iter()
                .map(|p| imageproc::point::Point::new(p.x as i32, p.y as i32))
                .collect();
            area += imageproc::geometry::contour_area(&points) as f32;
            hulls +=
                imageproc::geometry::contour_area(&imageproc::geometry::convex_hull(points)) as f32;
        }
        area / hulls.max(1.0)
    };
    fill(&[holder, feather]) - fill(&[object])
}

/// How far colors tell the two of a label apart, 0 (all in common) to 1 (none).
pub(super) fn apart(lab: &Lab, label: &dyn Fn(usize) -> Option<bool>) -> f32 {
    let mut both = [(); 2].map(|()| vec![0.0f32; BINS.iter().map(|(count, _)| count).product()]);
    for i in 0..lab.width() * lab.height() {
        if let Some(own) = label(i) {
            both[usize::from(own)][bin(lab.at(i))] += 1.0;
        }
    }
    told([&both[0], &both[1]])[0]
}

/// A mask opened as if it went on beyond the border.
fn opened(mask: &GrayImage, radius: u8) -> GrayImage {
    let room = u32::from(radius) + 1;
    let (width, height) = mask.dimensions();
    let at = |v: u32, side: u32| v.saturating_sub(room).min(side - 1);
    let wide = GrayImage::from_fn(width + 2 * room, height + 2 * room, |x, y| {
        *mask.get_pixel(at(x, width), at(y, height))
    });
    let wide = morphology::open(&wide, Norm::L2, radius);
    image::imageops::crop_imm(&wide, room, room, width, height).to_image()
}

/// Largest distance of a mask's pixels to its outline.
fn thickness(mask: &GrayImage) -> f32 {
    let inverse = GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        Luma([255 - mask.get_pixel(x, y)[0]])
    });
    let distance = euclidean_squared_distance_transform(&inverse);
    distance
        .iter()
        .copied()
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max)
        .sqrt() as f32
}

/// The components of a mask that hold a pixel of `seeds`.
fn joined(mask: &GrayImage, seeds: &[usize]) -> GrayImage {
    let labels = connected_components(mask, Connectivity::Eight, Luma([0]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let mut seeded = vec![false; count + 1];
    for &seed in seeds {
        seeded[labels.as_raw()[seed] as usize] = true;
    }
    seeded[0] = false;
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        let yes = seeded[labels.get_pixel(x, y)[0] as usize];
        Luma([if yes { 255 } else { 0 }])
    })
}

/// The largest component, holes left open.
fn component(mask: &GrayImage) -> GrayImage {
    let filled = largest(mask, 1).0;
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        Luma([filled.get_pixel(x, y)[0].min(mask.get_pixel(x, y)[0])])
    })
}

/// How much of a disk at the ends of the common edge belongs to the object, beyond half: the larger one of the ends.
fn corner(object: &GrayImage, holder: &GrayImage, feather: &GrayImage) -> f32 {
    // Splits are no corners.
    let object = &morphology::close(object, Norm::L2, 5);
    let (width, height) = object.dimensions();
    let near = |mask: &GrayImage| morphology::dilate(mask, Norm::L2, 2);
    let (a, b) = (near(holder), near(feather));
    let outside = GrayImage::from_fn(width, height, |x, y| {
        Luma([255 - object.get_pixel(x, y)[0]])
    });
    let open = near(&outside);
    let ends = GrayImage::from_fn(width, height, |x, y| {
        let yes = [&a, &b, &open]
            .iter()
            .all(|mask| mask.get_pixel(x, y)[0] > 0);
        Luma([if yes { 255 } else { 0 }])
    });
    let labels = connected_components(&ends, Connectivity::Eight, Luma([0]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let mut sums = vec![(0.0f32, 0.0f32, 0.0f32); count + 1];
    for (x, y, label) in labels.enumerate_pixels() {
        let sum = &mut sums[label[0] as usize];
        *sum = (sum.0 + 1.0, sum.1 + x as f32, sum.2 + y as f32);
    }
    let radius = (0.6 * thickness(holder).min(thickness(feather))).clamp(4.0, 40.0);
    let reach = radius as i64;
    sums.iter()
        .skip(1)
        .map(|(n, x, y)| {
            let (x, y) = ((x / n) as i64, (y / n) as i64);
            let (mut inside, mut all) = (0.0, 0.0);
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (px, py) = (x + dx, y + dy);
                    let within =
                        (0..i64::from(width)).contains(&px) && (0..i64::from(height)).contains(&py);
                    if within && dx * dx + dy * dy <= reach * reach {
                        all += 1.0;
                        inside +=
                            f32::from(u8::from(object.get_pixel(px as u32, py as u32)[0] > 0));
                    }
                }
            }
            inside / f32::max(all, 1.0) - 0.5
        })
        .fold(0.0, f32::max)
}

/// 255 where `mask` is nearer than `other`.
pub(super) fn nearer(mask: &GrayImage, other: &GrayImage) -> GrayImage {
    let [own, far] = [mask, other].map(euclidean_squared_distance_transform);
    let mut result = GrayImage::new(mask.width(), mask.height());
    for (pixel, (own, far)) in result.iter_mut().zip(own.iter().zip(far.iter())) {
        *pixel = if own < far { 255 } else { 0 };
    }
    result
}

/// What of a mask is not in another.
pub(super) fn without(mask: &GrayImage, other: &GrayImage) -> GrayImage {
    let mut result = mask.clone();
    for (pixel, other) in result.iter_mut().zip(other.iter()) {
        *pixel &= !other;
    }
    result
}
