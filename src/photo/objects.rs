//! Which of the things in a picture is the feather: a shadow that lies apart from it is none, and of several the caller takes one.

use super::{
    ExtractError, ObjectChoice, PhotoObject,
    background::shadow_color,
    color::Lab,
    prepare::View,
    segment::{Segment, bodies, cores, fill_holes},
};
use bevy::math::Vec2;
use image::{GrayImage, Luma};
use imageproc::{
    distance_transform::{Norm, euclidean_squared_distance_transform},
    morphology,
    region_labelling::{Connectivity, connected_components},
};

/// An object this large over the largest one is comparable.
const COMPARABLE: f32 = 0.3;
/// Of more objects than these only the largest are told apart: that is no picture of feathers.
const MOST: usize = 24;
/// Share of a shadow's pixels that have the background's hue and are darker.
const DARK: f32 = 0.85;
/// A shadow and what casts it overlap by this much (common area over the area of both), once they lie over each other.
const ALIKE: f32 = 0.55;
/// They lie the same way within this angle, radians.
const TURNED: f32 = 0.4;
/// A shadow's detail is at most this share of that of what casts it.
const PLAINER: f32 = 0.7;
/// Cells of the grid on which shapes are compared, a side, and the standard deviations from its middle to its rim.
const GRID: (usize, f32) = (48, 3.5);
/// A click this far from an object still takes it, as a share of the picture's longer side.
const NEAR: f32 = 0.03;

/// What the overview saw.
pub(super) struct Overview<'a> {
    pub view: &'a View,
    /// Colors as photographed, and of the background behind them; none where an alpha channel cuts the feather out and nothing
    /// is a shadow.
    pub colors: Option<(&'a Lab, &'a [[f32; 3]])>,
}

/// The feather among what was found.
pub(super) struct Chosen {
    pub mask: GrayImage,
    pub loose: GrayImage,
    /// 255 where another object, or a shadow, is nearer than the feather; none where it lies alone.
    pub foreign: Option<GrayImage>,
    /// Objects that were taken for shadows.
    pub shadows: u32,
    /// Areas of small objects beside it, over its own.
    pub others: Vec<f32>,
}

/// One object of comparable size.
struct Object {
    mask: GrayImage,
    middle: Vec2,
    low: Vec2,
    high: Vec2,
    /// Standard deviations along and across it, as vectors.
    axes: [Vec2; 2],
}

impl Object {
    fn new(mask: GrayImage) -> Self {
        let on = || {
            mask.enumerate_pixels()
                .filter(|(_, _, pixel)| pixel[0] > 0)
                .map(|(x, y, _)| Vec2::new(x as f32 + 0.5, y as f32 + 0.5))
        };
        let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
        let (mut count, mut sum) = (0.0f64, [0.0f64; 2]);
        for p in on() {
            (low, high) = (low.min(p - 0.5), high.max(p + 0.5));
            count += 1.0;
            sum = [sum[0] + f64::from(p.x), sum[1] + f64::from(p.y)];
        }
        let middle = Vec2::from_array(sum.map(|sum| (sum / count.max(1.0)) as f32));
        let mut squares = [0.0f64; 3];
        for p in on() {
            let d = p - middle;
            for (sum, value) in squares.iter_mut().zip([d.x * d.x, d.x * d.y, d.y * d.y]) {
                *sum += f64::from(value);
            }
        }
        let [xx, xy, yy] = squares.map(|sum| sum / count.max(1.0));
        let along = Vec2::from_angle((0.5 * (2.0 * xy).atan2(xx - yy)) as f32);
        let (mean, root) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let deviation = |variance: f64| variance.max(0.1).sqrt() as f32;
        Self {
            axes: [
                along * deviation(mean + root),
                along.perp() * deviation(mean - root),
            ],
            middle,
            low,
            high,
            mask,
        }
    }

    fn listed(&self, view: &View) -> PhotoObject {
        PhotoObject {
            center: view.photo(self.middle),
            low: view.photo(self.low),
            high: view.photo(self.high),
        }
    }

    /// Its shape on a grid around its middle, in units of its own deviations.
    fn shape(&self, turned: bool) -> Vec<bool> {
        let (cells, reach) = GRID;
        let half = cells as f32 * 0.5;
        let step = if turned { -reach } else { reach } / half;
        (0..cells * cells)
            .map(|i| {
                let cell = Vec2::new((i % cells) as f32, (i / cells) as f32) + 0.5 - half;
                let p = self.middle + (self.axes[0] * cell.x + self.axes[1] * cell.y) * step;
                let inside = p.cmpge(Vec2::ZERO).all()
                    && p.x < self.mask.width() as f32
                    && p.y < self.mask.height() as f32;
                inside && self.mask.get_pixel(p.x as u32, p.y as u32)[0] > 0
            })
            .collect()
    }

    /// Could one be cast by the other? Both have one shape, and lie the same way.
    fn is_like(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|object| {
            let [long, wide] = object.axes.map(Vec2::length);
            (object.axes[0], long, long / wide)
        });
        let turn = a.0.angle_to(b.0).sin().abs();
        let size = a.1 / b.1;
        // What is hardly longer than wide lies no way.
        if a.2.min(b.2) > 1.5 && turn > TURNED.sin() || !(0.5..2.0).contains(&size) {
            return false;
        }
        let overlap = |turned: bool| {
            let [a, b] = [self.shape(false), other.shape(turned)];
            let both = a.iter().zip(&b).filter(|(a, b)| **a && **b).count();
            let any = a.iter().zip(&b).filter(|(a, b)| **a || **b).count();
            both as f32 / any.max(1) as f32
        };
        overlap(false).max(overlap(true)) > ALIKE
    }
}

/// How much an object looks like background in shadow.
#[derive(Clone, Copy, Debug)]
struct Looks {
    /// Share of its pixels that have the background's hue and are darker.
    dark: f32,
    /// Mean difference of its pixels from their surroundings, over the background's own.
    detail: f32,
}

impl Looks {
    /// Is this the shadow of what looks as `other`?
    fn is_shadow_of(self, other: Self) -> bool {
        self.dark > DARK && self.detail < PLAINER * other.detail
    }
}

fn looks(objects: &[Object], lab: &Lab, behind: &[[f32; 3]]) -> Vec<Looks> {
    let light = &lab.planes[0];
    let detail = light.zip(&light.blur(1.5), |a, b| (a - b).abs());
    let mut around = GrayImage::new(light.width as u32, light.height as u32);
    for object in objects {
        let grown = morphology::dilate(&object.mask, Norm::L2, 6);
        for (pixel, own) in around.iter_mut().zip(grown.iter()) {
            *pixel |= own;
        }
    }
    let mean = |mask: &GrayImage, wanted: bool, value: &dyn Fn(usize) -> f32| {
        let pixels = mask.iter().enumerate().filter(|(_, m)| (**m > 0) == wanted);
        let (sum, count) = pixels.fold((0.0, 0.0f32), |(sum, count), (i, _)| {
            (sum + value(i), count + 1.0)
        });
        sum / count.max(1.0)
    };
    let grain = mean(&around, false, &|i| detail.data[i]).max(5e-4);
    objects
        .iter()
        .map(|object| {
            // Edges are no detail.
            let mut inner = morphology::erode(&object.mask, Norm::L2, 3);
            if inner.iter().filter(|m| **m > 0).count() < 64 {
                inner.clone_from(&object.mask);
            }
            Looks {
                dark: mean(&inner, true, &|i| {
                    f32::from(u8::from(shadow_color(lab.at(i), behind[i])))
                }),
                detail: mean(&inner, true, &|i| detail.data[i]) / grain,
            }
        })
        .collect()
}

/// Objects of comparable size, left to right; those that touch are parted where the bridge between them is narrowest.
fn comparable(found: &Segment, by_alpha: bool) -> Vec<Object> {
    let labels = connected_components(&found.all, Connectivity::Eight, Luma([0]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let mut areas = vec![0u32; count + 1];
    for label in labels.iter() {
        areas[*label as usize] += 1;
    }
    areas[0] = 0;
    let most = areas.iter().copied().max().unwrap_or(0) as f32;
    let mut large: Vec<usize> = (1..=count)
        .filter(|&label| areas[label] as f32 > COMPARABLE * most)
        .collect();
    large.sort_by_key(|&label| std::cmp::Reverse(areas[label]));
    if large.len() > 1 && !by_alpha {
        // A seam of the table, or a bare shaft that it cuts off, is large beside a small vane, but thin; and a vane may show as
        // single barbs.
        let whole = morphology::close(&found.loose, Norm::L2, 4);
        let distance = euclidean_squared_distance_transform(&inverse(&found.all));
        let mut thick = vec![0.0f64; count + 1];
        for (label, distance) in labels.iter().zip(distance.iter()) {
            let thick = &mut thick[*label as usize];
            *thick = thick.max(*distance);
        }
        large[1..].sort_by(|&a, &b| thick[b].total_cmp(&thick[a]));
        large.truncate(bodies(&whole));
    }
    large.truncate(MOST);
    let mut objects: Vec<Object> = large
        .into_iter()
        .flat_map(|label| {
            let mut mask = GrayImage::from_fn(labels.width(), labels.height(), |x, y| {
                let on = labels.get_pixel(x, y)[0] as usize == label;
                Luma([if on { 255 } else { 0 }])
            });
            fill_holes(&mut mask);
            parted(mask)
        })
        .map(Object::new)
        .collect();
    objects.sort_by(|a, b| a.middle.x.total_cmp(&b.middle.x));
    objects
}

fn inverse(mask: &GrayImage) -> GrayImage {
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        Luma([255 - mask.get_pixel(x, y)[0]])
    })
}

/// The bodies of a mask, each with the pixels that are nearest to it.
fn parted(mask: GrayImage) -> Vec<GrayImage> {
    let cores = cores(&mask, MOST);
    if cores.len() < 2 {
        return vec![mask];
    }
    let distances: Vec<_> = cores
        .iter()
        .map(euclidean_squared_distance_transform)
        .collect();
    let mut parts = vec![GrayImage::new(mask.width(), mask.height()); cores.len()];
    for (i, pixel) in mask.iter().enumerate() {
        let nearest = (0..cores.len())
            .min_by(|&a, &b| distances[a].as_raw()[i].total_cmp(&distances[b].as_raw()[i]));
        if let Some(nearest) = nearest.filter(|_| *pixel > 0) {
            let (x, y) = (i as u32 % mask.width(), i as u32 / mask.width());
            parts[nearest].put_pixel(x, y, Luma([255]));
        }
    }
    parts
}

/// Takes the feather out of what was found.
pub(super) fn choose(
    found: &Segment,
    overview: &Overview,
    choice: ObjectChoice,
) -> Result<Chosen, ExtractError> {
    let mut objects = comparable(found, overview.colors.is_none());
    let mut shadows = Vec::new();
    if let Some((lab, behind)) = overview.colors
        && objects.len() > 1
    {
        let looks = looks(&objects, lab, behind);
        let is_shadow: Vec<bool> = (0..objects.len())
            .map(|i| {
                (0..objects.len())
                    .any(|k| looks[i].is_shadow_of(looks[k]) && objects[i].is_like(&objects[k]))
            })
            .collect();
        let mut keep = is_shadow.iter();
        (objects, shadows) = objects
            .into_iter()
            .partition(|_| keep.next() == Some(&false));
    }
    let at = pick(&objects, overview.view, choice)?;
    if objects.len() < 2 && shadows.is_empty() {
        return Ok(Chosen {
            mask: found.mask.clone(),
            loose: found.loose.clone(),
            foreign: None,
            shadows: 0,
            others: found.others.clone(),
        });
    }
    let chosen = objects.swap_remove(at);
    let own = euclidean_squared_distance_transform(&chosen.mask);
    let mut beside = GrayImage::new(chosen.mask.width(), chosen.mask.height());
    for other in objects.iter().chain(&shadows) {
        for (pixel, own) in beside.iter_mut().zip(other.mask.iter()) {
            *pixel |= own;
        }
    }
    let far = euclidean_squared_distance_transform(&beside);
    for (pixel, (own, far)) in beside.iter_mut().zip(own.iter().zip(far.iter())) {
        *pixel = if far < own { 255 } else { 0 };
    }
    let mut loose = found.loose.clone();
    for (pixel, foreign) in loose.iter_mut().zip(beside.iter()) {
        *pixel &= !foreign;
    }
    Ok(Chosen {
        others: Vec::new(),
        mask: chosen.mask,
        loose,
        foreign: Some(beside),
        shadows: shadows.len() as u32,
    })
}

/// Which of the objects is asked for.
fn pick(objects: &[Object], view: &View, choice: ObjectChoice) -> Result<usize, ExtractError> {
    let listed = || objects.iter().map(|object| object.listed(view)).collect();
    match choice {
        ObjectChoice::Only if objects.len() > 1 => {
            Err(ExtractError::SeveralObjects { objects: listed() })
        }
        ObjectChoice::Only => Ok(0),
        ObjectChoice::Number(number) => {
            let at = (number as usize).wrapping_sub(1);
            if at < objects.len() {
                return Ok(at);
            }
            Err(ExtractError::NoSuchObject {
                asked: format!("number {number}"),
                objects: listed(),
            })
        }
        ObjectChoice::At(place) => {
            let click = view.view(Vec2::from_array(place));
            let within = NEAR * view.width.max(view.height) as f32;
            let distance = |object: &Object| {
                let on = object.mask.enumerate_pixels().filter(|(_, _, m)| m[0] > 0);
                on.map(|(x, y, _)| Vec2::new(x as f32 + 0.5, y as f32 + 0.5).distance(click))
                    .fold(f32::INFINITY, f32::min)
            };
            objects
                .iter()
                .map(distance)
                .enumerate()
                .filter(|(_, distance)| *distance < within)
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(at, _)| at)
                .ok_or_else(|| ExtractError::NoSuchObject {
                    asked: format!("one at ({}, {})", place[0], place[1]),
                    objects: listed(),
                })
        }
    }
}
