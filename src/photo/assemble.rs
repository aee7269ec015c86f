//! From curves in pixels to the asset.

use super::{
    BarbMeasure, CardFrame, Confidence, Doubt, ExtractError, ExtractSettings, Face, outline,
    prepare::View, raster::median, score::Score, shaft::Shaft, silhouette::Silhouette,
};
use crate::{
    anatomy::{Albedo, Contour, Feather, Gaps, Pattern, Rachis, Stop, Vane, primary},
    asset::RonAsset,
};
use bevy::math::Vec2;
use image::RgbaImage;

/// Length taken when none is given, in millimetres.
const TYPICAL_LENGTH_MM: f32 = 150.0;
/// Values of F_P in the asset.
const CURVE: usize = 33;
/// Barb angle taken when none is seen, in degrees: the median of the trailing vanes of 93 birds' primaries (FeatherEvo).
const TYPICAL_ANGLE: f32 = 34.0;

/// Card and shaft curve.
pub(super) struct Card {
    pub frame: CardFrame,
    pub aspect: f32,
    pub curve: Vec<f32>,
    /// The shaft in pixels of the photograph from base to tip.
    pub line: Vec<Vec2>,
}

/// Lays the card around the outline: v along the shaft's chord, u across, mirrored when the back was seen.
pub(super) fn card(cut: &Silhouette, shaft: &Shaft, face: Face) -> Card {
    let view: &View = &cut.view;
    let line: Vec<Vec2> = (0..shaft.x.len())
        .rev()
        .map(|i| {
            let y = (shaft.rows.0 + i) as f32 + 0.5;
            view.photo(Vec2::new(shaft.x[i], y))
        })
        .collect();
    let points: Vec<Vec2> = cut.outline.iter().map(|p| view.photo(*p)).collect();
    let (base, tip) = (line[0], line[line.len() - 1]);
    let up = (tip - base).normalize_or(Vec2::NEG_Y);
    // Tip up, the photograph's right is a quarter turn clockwise on the screen.
    let right = match face {
        Face::Front => up.perp(),
        Face::Back => -up.perp(),
    };
    let extent = |direction: Vec2| {
        points
            .iter()
            .chain(&line)
            .fold((f32::MAX, f32::MIN), |(a, b), p| {
                let at = (*p - base).dot(direction);
                (a.min(at), b.max(at))
            })
    };
    let ((v0, v1), (u0, u1)) = (extent(up), extent(right));
    let length = (v1 - v0).max(1.0);
    let margin = 0.02 * (u1 - u0);
    let width = (u1 - u0 + 2.0 * margin).clamp(0.01 * length, 2.0 * length);
    let frame = CardFrame {
        origin: base + right * (u0 - margin) + up * v0,
        u: right * width,
        v: up * length,
    };
    // The spline wants u at equal steps of v; beyond its ends the shaft runs on straight.
    let uv: Vec<Vec2> = line.iter().map(|p| frame.uv(*p)).collect();
    let curve = (0..CURVE)
        .map(|i| {
            let v = i as f32 / (CURVE - 1) as f32;
            let k = uv
                .partition_point(|p| p.y < v)
                .clamp(1, uv.len().max(2) - 1);
            let (a, b) = (uv[k - 1], uv[k]);
            let t = ((v - a.y) / (b.y - a.y).max(1e-6)).clamp(-8.0, 8.0);
            (a.x + (b.x - a.x) * t).clamp(-0.5, 1.5)
        })
        .collect();
    Card {
        frame,
        aspect: width / length,
        curve,
        line,
    }
}

/// Half thickness of the shaft in pixels of the view at the base, middle and tip.
pub(super) fn radii(map: &Score, shaft: &Shaft) -> [f32; 3] {
    let rows = shaft.x.len();
    let unit = rows as f32 / 1100.0;
    let around = |low: f32, high: f32| {
        let range = (low * rows as f32) as usize..(high * rows as f32) as usize;
        let mut values: Vec<f32> = range
            .filter_map(|i| {
                // Rows count from the tip.
                let row = shaft.rows.1 - i.min(rows - 1);
                let (a, b) = map.span[row]?;
                let x = shaft.at(row as f32 + 0.5);
                let i = row * map.radius.width + (x as usize).min(map.radius.width - 1);
                let ridge = map.radius.data[i];
                let half = 0.5 * (b - a);
                Some(if ridge > 0.0 {
                    ridge.min(half)
                } else {
                    half.min(6.0 * unit)
                })
            })
            .collect();
        median(&mut values).max(0.5)
    };
    let (base, middle) = (around(0.02, 0.12), around(0.4, 0.6));
    let base = base.clamp(middle, 4.0 * middle);
    [base, middle, (0.3 * middle).max(0.3)]
}

/// Lowest root of the barbs and the share of the length that is down.
fn vane_start(points: &[[f32; 2]], radius: f32, angles: [f32; 2]) -> f32 {
    let mut roots: Vec<f32> = points
        .iter()
        .filter(|[x, _]| x.abs() > 1.8 * radius + 0.002)
        .map(|[x, y]| {
            let angle = if *x < 0.0 { angles[0] } else { angles[1] };
            y - x.abs() / angle.to_radians().tan().max(0.05)
        })
        .collect();
    super::raster::quantile(&mut roots, 0.01).clamp(0.0, 0.9)
}

/// Share of the length from the base that is down: where the outline is so ragged that it is much longer than straight.
fn downy(points: &[[f32; 2]], start: f32) -> f32 {
    const BANDS: usize = 24;
    let mut lengths = [0.0f32; BANDS];
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        let band = ((0.5 * (a[1] + b[1])).clamp(0.0, 0.999) * BANDS as f32) as usize;
        lengths[band] += (b[0] - a[0]).hypot(b[1] - a[1]);
    }
    let mut upper = lengths[BANDS / 2..BANDS - 2].to_vec();
    let typical = median(&mut upper).max(1e-6);
    let first = (start * BANDS as f32) as usize;
    let ragged = (first..BANDS)
        .take_while(|&i| lengths[i] > 1.7 * typical)
        .count();
    if ragged == 0 {
        return 0.0;
    }
    (first + ragged) as f32 / BANDS as f32
}

/// Overlap of two masks, Dice.
fn dice(a: &image::GrayImage, b: &image::GrayImage) -> f32 {
    let (mut both, mut sum) = (0u32, 0u32);
    for (a, b) in a.as_raw().iter().zip(b.as_raw()) {
        both += u32::from(*a > 0 && *b > 0);
        sum += u32::from(*a > 0) + u32::from(*b > 0);
    }
    2.0 * both as f32 / sum.max(1) as f32
}

fn stops(albedo: &RgbaImage) -> Pattern {
    let rows = albedo.height();
    let stops = (0..8u32).map(|i| {
        let range = rows * i / 8..rows * (i + 1) / 8;
        let mut sum = [0.0f32; 3];
        let mut count = 0.0f32;
        for y in range {
            for x in 0..albedo.width() {
                let pixel = albedo.get_pixel(x, y);
                for c in 0..3 {
                    sum[c] += f32::from(pixel[c]) / 255.0;
                }
                count += 1.0;
            }
        }
        let short = |x: f32| (x * 1000.0).round() / 1000.0;
        Stop {
            v: short((i as f32 + 0.5) / 8.0),
            color: sum.map(|s| short(s / count.max(1.0))),
            tint: 0.0,
        }
    });
    Pattern {
        stops: stops.collect(),
        ..Pattern::default()
    }
}

/// The asset. `radius` as from [`radii`], `barbs` left and right of the card.
pub(super) fn assemble(
    cut: &Silhouette,
    card: &Card,
    radius: [f32; 3],
    barbs: &[Option<BarbMeasure>; 2],
    albedo: &RgbaImage,
    settings: &ExtractSettings,
    confidence: &mut Confidence,
) -> Result<Feather, ExtractError> {
    let length_mm = settings.length_mm.unwrap_or_else(|| {
        confidence.scale.doubt(Doubt::NoScale, 0.2);
        TYPICAL_LENGTH_MM
    });
    if settings.face == Face::Back {
        confidence.albedo.doubt(Doubt::BackSeen, 0.5);
    }
    let length = card.frame.v.length();
    let share = |pixels: f32| pixels * cut.view.scale / length.max(1.0);
    let template = primary();
    let vane = |slot: usize, downy: f32| -> Vane {
        let mut vane = [template.left, template.right][slot];
        // Barbs per length grow with the feather where they could not be counted.
        let typical = vane.barb_count * length_mm / template.length_mm;
        let seen = barbs[slot];
        vane.barb_angle = seen.map_or(TYPICAL_ANGLE, |b| b.angle.to_degrees().clamp(8.0, 80.0));
        vane.barb_count = seen
            .and_then(|b| b.count)
            .unwrap_or(typical)
            .round()
            .clamp(4.0, 5000.0);
        vane.downy = downy;
        vane.fringe = 0.0;
        vane
    };
    let spline = crate::anatomy::Spline::new(&card.curve);
    let points: Vec<[f32; 2]> = cut
        .outline
        .iter()
        .map(|p| {
            let uv = card.frame.uv(cut.view.photo(*p));
            let middle = spline.at(f64::from(uv.y)).0 as f32;
            [(uv.x - middle) * card.aspect, uv.y]
        })
        .collect();
    let (mut left, mut right) = (vane(0, 0.0), vane(1, 0.0));
    // Barbs that hardly show may be misread, and reach of barbs at a wrong angle cannot follow the outline: then the angle that
    // follows it best is taken.
    let samples = settings.contour_samples as usize;
    let fit = |angles: [f32; 2]| {
        let start = vane_start(&points, share(radius[0]), angles);
        let contour = Contour::from_polyline(&points, angles, start, samples);
        let overlap = dice(&redrawn(cut, card, &contour, angles, radius), &cut.mask);
        (overlap, angles, start, contour)
    };
    let mut best = fit([left.barb_angle, right.barb_angle]);
    if best.0 < 0.975 {
        for slot in 0..2 {
            for angle in [18.0, 26.0, 34.0, 42.0, 50.0, 58.0] {
                let mut angles = best.1;
                angles[slot] = angle;
                let other = fit(angles);
                if other.0 > best.0 + 0.004 {
                    best = other;
                }
            }
            if Some(best.1[slot]) != barbs[slot].map(|b| b.angle.to_degrees().clamp(8.0, 80.0)) {
                let trust = &mut confidence.barbs[slot];
                trust.doubt(Doubt::AngleFromOutline(best.1[slot]), 0.5);
            }
        }
    }
    let (overlap, angles, start, contour) = best;
    [left.barb_angle, right.barb_angle] = angles;
    let down = downy(&points, start);
    (left.downy, right.downy) = (down, down);
    if overlap < 0.97 {
        confidence
            .contour
            .doubt(Doubt::OutlineLost(overlap), overlap.powi(4));
    }
    let to_mm = |pixels: f32| (share(pixels) * length_mm).clamp(0.0, 50.0);
    let feather = Feather {
        name: settings.name.clone(),
        length_mm,
        aspect: card.aspect,
        contour,
        rachis: Rachis {
            curve: card.curve.clone(),
            radius_mm: radius.map(to_mm),
        },
        left,
        right,
        gaps: Gaps {
            seed: settings.seed,
            ..Gaps::default()
        },
        albedo: Albedo {
            front: stops(albedo),
            ..Albedo::default()
        },
        ..Feather::default()
    };
    feather.validate(&feather.name)?;
    Ok(feather)
}

/// The asset's outline and shaft drawn back into the view.
fn redrawn(
    cut: &Silhouette,
    card: &Card,
    contour: &Contour,
    angles: [f32; 2],
    radius: [f32; 3],
) -> image::GrayImage {
    let spline = crate::anatomy::Spline::new(&card.curve);
    let place = |[x, y]: [f32; 2]| {
        let u = x / card.aspect.max(1e-6) + spline.at(f64::from(y)).0 as f32;
        cut.view.view(card.frame.pixel(Vec2::new(u, y)))
    };
    let polygon: Vec<Vec2> = contour.polyline(angles).into_iter().map(place).collect();
    let (width, height) = cut.mask.dimensions();
    let mut mask = outline::fill(&polygon, width, height);
    let quill = radius[0] * cut.view.scale / card.frame.v.length().max(1.0);
    let top = contour.start + 0.05;
    let steps = 16;
    let side = |sign: f32, i: usize| place([sign * quill, top * i as f32 / steps as f32]);
    let quill: Vec<Vec2> = (0..=steps)
        .map(|i| side(-1.0, i))
        .chain((0..=steps).rev().map(|i| side(1.0, i)))
        .collect();
    let shaft = outline::fill(&quill, width, height);
    for (a, b) in mask.iter_mut().zip(shaft.as_raw()) {
        *a |= b;
    }
    mask
}
