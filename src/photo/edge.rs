//! The outline's own neighborhood: where exactly feather ends and background begins, and what was bitten out of it.

use super::{
    background::{FAR, difference, shadow_color},
    color::{Lab, linear, oklab_of},
    raster::{Plane, median, quantile},
    spread,
};
use bevy::math::{Vec2, Vec3};
use image::{GrayImage, Luma};
use imageproc::{
    distance_transform::Norm,
    morphology,
    region_labelling::{Connectivity, connected_components},
};
use std::f32::consts::TAU;

/// Parts of the feather narrower than this share of its length are bare shaft.
const THIN: f32 = 0.025;
/// Widest mouth of a bite over the feather's length, and over its mean width, halved.
const MOUTH: (f32, f32) = (0.05, 0.25);
/// A split is narrower than this share of the length, halved.
const SPLIT: f32 = 0.009;

/// Standard deviation of what lens and sensor make of a point, in pixels of the photograph: a fair camera's, its pixels included.
const BLUR: f32 = 0.75;
/// Standard deviation in pixels over which widths of lines are measured.
const STRETCH: f32 = 8.0;

/// A picture and the background behind it.
pub(super) struct Scene<'a> {
    pub lab: &'a Lab,
    /// The background's color behind each pixel.
    pub behind: &'a [[f32; 3]],
    /// Distance of each pixel's color to it.
    pub far: &'a Plane,
    /// Width of a pixel of the photograph in pixels here.
    pub pixel: f32,
    /// 1 within the photograph.
    pub usable: &'a Plane,
}

fn on(mask: &GrayImage) -> Plane {
    Plane {
        width: mask.width() as usize,
        height: mask.height() as usize,
        data: mask.iter().map(|&m| f32::from(u8::from(m > 0))).collect(),
    }
}

/// Radius in pixels for a share of a mask's length (its longer side), 1..60.
fn radius(mask: &GrayImage, share: f32) -> u8 {
    let long = mask.width().max(mask.height()) as f32;
    (share * long).round().clamp(1.0, 60.0) as u8
}

/// Positive on the feather, 0 where the color is half way between feather and background as they are within `band` pixels.
/// Where the feather near the outline has one color, only the difference towards that color counts: a shadow on the other side
/// of the background's lightness is then background. `low` is the least distance that is no noise. The masks are where shadows
/// are found out thus: surely, and likely.
pub(super) fn field(
    scene: &Scene,
    kept: &GrayImage,
    low: f32,
    band: f32,
) -> ([Plane; 2], [GrayImage; 2]) {
    let on = on(kept);
    let shaft = radius(kept, 0.5 * THIN);
    let thick = morphology::open(kept, Norm::L2, shaft);
    let thick = morphology::dilate(&thick, Norm::L2, 2);
    let times = |a: &Plane, b: &Plane| a.zip(b, |a, b| a * b);
    let ratio =
        |a: &Plane, b: &Plane, least: f32| a.zip(b, |a, b| if b > least { a / b } else { 0.0 });
    let differences: Vec<Vec3> = (0..scene.far.data.len())
        .map(|i| difference(scene.lab.at(i), scene.behind[i]))
        .collect();
    let far = &Plane {
        // Beyond the limit of what counts elsewhere, too: the edge lies between both colors as they are.
        data: scene
            .far
            .data
            .iter()
            .zip(&differences)
            .map(|(&far, d)| if far < FAR { far } else { d.length().max(FAR) })
            .collect(),
        ..*scene.far
    };
    // Strong differences have the vote. A bare shaft has one color: there shadows have none, and as blur takes more off a thin
    // line's flanks than off its ridge, the ridge counts.
    let mut weight = times(&on, far);
    // What may be shadow has little say on the vane, too, where anything else is near.
    for (i, weight) in weight.data.iter_mut().enumerate() {
        if *weight > 0.0 {
            let dark = shadow_color(scene.lab.at(i), scene.behind[i]);
            if thick.as_raw()[i] == 0 {
                *weight *= (far.data[i] / 0.1).powi(5).min(1e4);
                *weight *= if dark { 1e-3 } else { 1.0 };
            } else if dark {
                *weight *= 0.1;
            }
        }
    }
    let sum = weight.blur(band);
    let mean_far = ratio(&times(&weight, far).blur(band), &sum, 1e-7);
    let mean = [0, 1, 2].map(|c| {
        let part = Plane {
            data: weight
                .data
                .iter()
                .zip(&differences)
                .map(|(w, d)| w * d[c])
                .collect(),
            ..*far
        };
        ratio(&part.blur(band), &sum, 1e-7)
    });
    let trust = |i: usize| {
        let mean = Vec3::new(mean[0].data[i], mean[1].data[i], mean[2].data[i]);
        let agree = mean.length() / mean_far.data[i].max(1e-6);
        (mean, ((agree - 0.8) / 0.15).clamp(0.0, 1.0))
    };
    let toward = |i: usize, far: f32, difference: Vec3| {
        let (mean, trust) = trust(i);
        let cosine = difference.normalize_or_zero().dot(mean.normalize_or_zero());
        far * (1.0 - trust + trust * cosine)
    };
    let towards = Plane::from_fn(far.width, far.height, |x, y| {
        let i = y * far.width + x;
        toward(i, far.data[i], differences[i])
    });
    let off = on.zip(scene.usable, |on, usable| (1.0 - on) * usable);
    let outside = ratio(&times(&off, &towards).blur(band), &off.blur(band), 1e-3);
    let near = on.blur(band);
    // A pixel half feather and half background has the mean of their light, which is not half way in Oklab: nearer to the
    // brighter one. Where that is the background, half way in Oklab makes up for the feather's own shadow beside it.
    let light: Vec<Vec3> = (0..far.data.len())
        .map(|i| linear(scene.lab.at(i)))
        .collect();
    let mean_light = |weight: &Plane, sum: &Plane, least: f32| {
        [0, 1, 2].map(|c| {
            let part = Plane {
                data: weight
                    .data
                    .iter()
                    .zip(&light)
                    .map(|(w, l)| w * l[c])
                    .collect(),
                ..*far
            };
            ratio(&part.blur(band), sum, least)
        })
    };
    let feather = mean_light(&weight, &sum, 1e-7);
    let around = off.blur(band);
    let beside = mean_light(&off, &around, 1e-3);
    let at = |light: &[Plane; 3], i: usize| Vec3::from_array([0, 1, 2].map(|c| light[c].data[i]));
    let field = Plane::from_fn(far.width, far.height, |x, y| {
        let i = y * far.width + x;
        if near.data[i] < 0.002 {
            return -0.1;
        }
        let mut half = 0.5 * (mean_far.data[i] + outside.data[i]);
        if around.data[i] > 1e-3 {
            let mixed = oklab_of((at(&feather, i) + at(&beside, i)) * 0.5);
            let mixed = difference(mixed, scene.behind[i]);
            half = half.max(toward(i, mixed.length(), mixed));
        }
        towards.data[i] - half.max(low)
    });
    let shadow = |value: &Plane| {
        GrayImage::from_fn(kept.width(), kept.height(), |x, y| {
            let i = y as usize * far.width + x as usize;
            let dark = value.data[i] < 0.0 && shadow_color(scene.lab.at(i), scene.behind[i]);
            Luma([if dark { 255 } else { 0 }])
        })
    };
    // A bare shaft and the foot of a vane may be as narrow as their own half shadow: there the mask holds them together.
    let vane = morphology::open(kept, Norm::L2, shaft.saturating_mul(2));
    let mut likely = morphology::close(&shadow(&field), Norm::L2, 2);
    for (pixel, vane) in likely.iter_mut().zip(vane.iter()) {
        *pixel &= vane;
    }
    let shadows = [shadow(&towards), likely];
    let sharp = sharpened(&field, kept, &thick, scene.pixel);
    ([field, sharp], shadows)
}

/// The field with the edges of thin lines drawn in: a line hardly wider than the blur of lens and sensor looks wider than it is,
/// by a width that follows from both.
fn sharpened(field: &Plane, kept: &GrayImage, thick: &GrayImage, pixel: f32) -> Plane {
    let near = morphology::dilate(kept, Norm::L2, 3);
    let seen = Plane {
        data: field
            .data
            .iter()
            .zip(near.iter())
            .map(|(&field, &near)| f32::from(u8::from(field > 0.0 && near > 0)))
            .collect(),
        ..*field
    };
    // A straight line of width w, blurred much wider, is w / (sigma sqrt(2 pi)) high.
    let sigma = STRETCH;
    let width = seen.blur(sigma).map(|share| share * sigma * TAU.sqrt());
    let on_line = |i: usize| seen.data[i] > 0.0 && thick.as_raw()[i] == 0;
    let mut widths: Vec<f32> = (0..width.data.len())
        .filter(|&i| on_line(i))
        .map(|i| width.data[i])
        .collect();
    if widths.is_empty() {
        return field.clone();
    }
    // Even a hair shows as wide as the blur: 2.36 standard deviations at half of its height.
    let blur = (BLUR * pixel)
        .max(0.6)
        .min(quantile(&mut widths, 0.1) / 2.36);
    Plane::from_fn(field.width, field.height, |x, y| {
        let i = y * field.width + x;
        if thick.as_raw()[i] > 0 || near.as_raw()[i] == 0 {
            return field.data[i];
        }
        field.data[i] - field.gradient(x, y).length() * spread::excess(width.data[i], blur)
    })
}

/// A bay of the outline.
#[derive(Clone, Default)]
struct Bay {
    area: u32,
    /// Border pixels, and those towards the open.
    rim: u32,
    mouth: u32,
    low: [u32; 2],
    high: [u32; 2],
    colors: [Vec<f32>; 3],
    /// Sums of x, y, x x, x y, y y from its first pixel.
    sums: [f32; 5],
    /// Its first pixel.
    first: Option<Vec2>,
}

impl Bay {
    /// Long, and leading inwards as barbs do, not square to the shaft as bars: the feather (upright in the view) has come apart.
    fn is_split(&self) -> bool {
        let n = self.area.max(1) as f32;
        let [x, y, xx, xy, yy] = self.sums.map(|sum| sum / n);
        let (xx, xy, yy) = (xx - x * x, xy - x * y, yy - y * y);
        let (mean, root) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        // From the view's x axis, across the shaft.
        let tilt = 0.5 * (2.0 * xy).atan2(xx - yy);
        mean + root > 6.0 * (mean - root) && (20.0..75.0).contains(&tilt.abs().to_degrees())
    }
}

/// Fills bays of the outline that differ from the background on the whole, though not pixel by pixel: bars and spots of nearly
/// its color. Returns the area, over the feather's, of the bays left that are deep and wider than splits.
pub(super) fn fill_bites(kept: &mut GrayImage, scene: &Scene, noise: f32) -> f32 {
    let (width, height) = kept.dimensions();
    let area = kept.iter().filter(|&&m| m > 0).count().max(1) as f32;
    let wide = area / (width.max(height) as f32).powi(2);
    let mouth = radius(kept, MOUTH.0.min(MOUTH.1 * wide));
    let split = radius(kept, SPLIT);
    let closed = morphology::close(kept, Norm::L2, mouth);
    let mut bays = GrayImage::from_fn(width, height, |x, y| {
        let usable = scene.usable.data[(y * width + x) as usize] > 0.0;
        let inner = usable && closed.get_pixel(x, y)[0] > 0 && kept.get_pixel(x, y)[0] == 0;
        Luma([if inner { 255 } else { 0 }])
    });
    bays = morphology::open(&bays, Norm::L2, split);
    let labels = connected_components(&bays, Connectivity::Four, Luma([0]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let mut found = vec![Bay::default(); count + 1];
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let label = labels.get_pixel(x, y)[0] as usize;
            if label == 0 {
                continue;
            }
            let i = (y * width + x) as usize;
            let bay = &mut found[label];
            if bay.area == 0 {
                bay.low = [x, y];
            }
            bay.area += 1;
            bay.low = [bay.low[0].min(x), bay.low[1].min(y)];
            bay.high = [bay.high[0].max(x), bay.high[1].max(y)];
            let beside = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            let open = |&(x, y): &(u32, u32)| closed.get_pixel(x, y)[0] == 0;
            let edge = |&(x, y): &(u32, u32)| labels.get_pixel(x, y)[0] == 0;
            bay.rim += u32::from(beside.iter().any(edge));
            bay.mouth += u32::from(beside.iter().any(open));
            let at = bay.first.get_or_insert(Vec2::new(x as f32, y as f32));
            let p = Vec2::new(x as f32, y as f32) - *at;
            for (sum, value) in bay
                .sums
                .iter_mut()
                .zip([p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y])
            {
                *sum += value;
            }
            let d = difference(scene.lab.at(i), scene.behind[i]);
            for (c, colors) in bay.colors.iter_mut().enumerate() {
                colors.push(d[c]);
            }
        }
    }
    let mut left = 0.0;
    for (label, bay) in found.iter_mut().enumerate().skip(1) {
        if bay.area == 0 {
            continue;
        }
        let share = bay.mouth as f32 / bay.rim.max(1) as f32;
        // The background beside the bay, beyond its mouth.
        let reach = u32::from(mouth) * 2;
        let mut around: [Vec<f32>; 3] = Default::default();
        let mut beside: [Vec<f32>; 3] = Default::default();
        for y in bay.low[1].saturating_sub(reach)..(bay.high[1] + reach).min(height) {
            for x in bay.low[0].saturating_sub(reach)..(bay.high[0] + reach).min(width) {
                let i = (y * width + x) as usize;
                let free = closed.get_pixel(x, y)[0] == 0 && scene.usable.data[i] > 0.0;
                let feather = kept.get_pixel(x, y)[0] > 0;
                if (free || feather) && (x + y) % 3 == 0 {
                    let d = difference(scene.lab.at(i), scene.behind[i]);
                    let place = if free { &mut around } else { &mut beside };
                    for (c, colors) in place.iter_mut().enumerate() {
                        colors.push(d[c]);
                    }
                }
            }
        }
        if around[0].len() < 30 {
            continue;
        }
        let middle = |values: &mut [Vec<f32>; 3]| {
            Vec3::from_array(values.each_mut().map(|values| median(values)))
        };
        let outer = middle(&mut around);
        let off = middle(&mut bay.colors) - outer;
        let feather = middle(&mut beside) - outer;
        let like = off.dot(feather) / feather.length_squared().max(1e-6);
        if like < 0.15 && bay.is_split() {
            continue;
        }
        // Darker and of the same hue is what a shadow is.
        let shadow = off.x < 0.0 && off.y.hypot(off.z) < 0.4 * -off.x;
        if share < if shadow { 0.17 } else { 0.3 } && off.length() > (0.35 * noise).max(0.012) {
            for (pixel, own) in kept.iter_mut().zip(labels.iter()) {
                if *own as usize == label {
                    *pixel = 255;
                }
            }
        } else if share < 0.17 {
            left += bay.area as f32 / area;
        }
    }
    left
}
