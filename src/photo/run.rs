//! All stages in order.

use super::{
    Confidence, Doubt, ExtractError, ExtractSettings, Extraction, Face, Progress, ScoreMap, Stage,
    assemble, axis,
    barbs::Barbs,
    find, load, outline, paint,
    prepare::{self, Photo},
    raster,
    score::{self, Score},
    shaft::{self, Shaft},
    silhouette::{self, Silhouette},
};
use crate::anatomy::Side;
use bevy::math::Vec2;
use image::{DynamicImage, GrayImage, Luma};

/// Most pixels held of the photograph at its own resolution, for barbs.
const DETAIL_PIXELS: f32 = 24e6;
/// Least confidence of a feather on rough ground.
const ROUGH_CONFIDENCE: f32 = 0.15;
/// Points of the shaft that are returned.
const SHAFT_POINTS: usize = 256;

/// Extracts the one feather of a photograph. `progress` hears each stage as it begins. Deterministic; bounded in time and
/// memory whatever the picture shows.
pub fn extract(
    photograph: &DynamicImage,
    settings: &ExtractSettings,
    progress: &mut dyn FnMut(Progress),
) -> Result<Extraction, ExtractError> {
    load::check_size(photograph.width(), photograph.height())?;
    settings.check()?;
    let mut confidence = Confidence::default();
    progress(Progress::begin(Stage::Prepare));
    progress(Progress::begin(Stage::Segment));
    let mut cut = silhouette::silhouette(photograph, settings, None, &mut confidence)?;
    check_ground(&cut, &confidence)?;
    progress(Progress::begin(Stage::Contour));
    let mut quill = quill(&cut);
    if quill < 0.0 {
        cut = cut.turned();
        quill = -quill;
    }
    progress(Progress::begin(Stage::Rachis));
    let (mut map, mut shaft) = find_shaft(&cut)?;
    if cut.slender < silhouette::SLENDER && shaft.clear < 0.5 {
        // The outline does not say which way it lies: the clearest shaft does.
        for turn in [0.0, 0.25, 0.5, 0.75].map(|turn| turn * std::f32::consts::PI) {
            let mut doubts = Confidence::default();
            let other = silhouette::silhouette(photograph, settings, Some(turn), &mut doubts)?;
            let toward = self::quill(&other);
            let other = if toward < 0.0 { other.turned() } else { other };
            if let Ok(found) = find_shaft(&other)
                && found.1.clear > shaft.clear + 0.1
            {
                (cut, quill, confidence) = (other, toward.abs(), doubts);
                (map, shaft) = found;
            }
        }
    }

    progress(Progress::begin(Stage::Barbs));
    let (width, height) = (photograph.width() as f32, photograph.height() as f32);
    let detail = (DETAIL_PIXELS / (width * height)).sqrt().min(1.0);
    let photo = Photo::reduced(photograph, width.max(height) * detail);
    let mut barbs = Barbs::look(&photo, &cut.view, &cut.mask, &shaft);
    let (upward, weight) = barbs.upward();
    // Barbs point to the tip; a bare quill is no weaker a sign.
    let barb_sign = upward * (weight / 2.0).min(1.0);
    let sure = 1.4 * barb_sign + quill + 0.5 * thick_end(&map, &shaft);
    if sure < 0.0 {
        cut = cut.turned();
        (map, shaft) = find_shaft(&cut)?;
        barbs = Barbs::look(&photo, &cut.view, &cut.mask, &shaft);
    }
    drop(photo);
    if sure.abs() < 0.3 {
        confidence
            .direction
            .doubt(Doubt::EndsAlike, 0.5 + 1.6 * sure.abs());
    }
    if shaft.clear < 0.5 {
        confidence
            .rachis
            .doubt(Doubt::FaintRachis(shaft.clear), 0.3 + 1.4 * shaft.clear);
    }
    if shaft.kink > 0.26 {
        confidence.rachis.doubt(
            Doubt::Kink(shaft.kink.to_degrees()),
            (0.26 / shaft.kink).powi(2),
        );
    }
    judge_shape(&cut, &mut confidence);
    let sides = match settings.face {
        Face::Front => Side::BOTH,
        Face::Back => [Side::Right, Side::Left],
    };
    let measured = [0, 1].map(|slot: usize| barbs.measure(sides[slot], slot, &mut confidence));

    check_ground(&cut, &confidence)?;

    progress(Progress::begin(Stage::Albedo));
    let card = assemble::card(&cut, &shaft, settings.face);
    let radius = assemble::radii(&map, &shaft);
    let thick = |share: f32| {
        let (low, high, t) = if share < 0.5 {
            (radius[0], radius[1], share * 2.0)
        } else {
            (radius[1], radius[2], share * 2.0 - 1.0)
        };
        low + (high - low) * t.clamp(0.0, 1.0)
    };
    let albedo = paint::paint(
        &cut,
        &map,
        &shaft,
        &thick,
        &card.frame,
        card.aspect,
        settings,
    );
    judge_exposure(&cut, &mut confidence);

    progress(Progress::begin(Stage::Assemble));
    let mut feather = assemble::assemble(
        &cut,
        &card,
        radius,
        &measured,
        &albedo,
        settings,
        &mut confidence,
    )?;
    feather.albedo.share.rachis = paint::shaft_share(&cut, &shaft, &card.frame, &albedo);
    let contour: Vec<Vec2> = cut.outline.iter().map(|p| cut.view.photo(*p)).collect();
    let mask = outline::fill(&contour, photograph.width(), photograph.height());
    let (score_width, score_height) = (cut.view.width as u32, cut.view.height as u32);
    Ok(Extraction {
        feather,
        albedo,
        mask,
        rachis: outline::resample(&card.line, SHAFT_POINTS, false),
        contour,
        score: ScoreMap {
            image: GrayImage::from_fn(score_width, score_height, |x, y| {
                let value = map.score.data[y as usize * cut.view.width + x as usize];
                Luma([(value.clamp(0.0, 1.0) * 255.0) as u8])
            }),
            origin: cut.view.origin,
            axis: cut.view.axis,
            scale: cut.view.scale,
        },
        barbs: measured,
        frame: card.frame,
        confidence,
    })
}

fn find_shaft(cut: &Silhouette) -> Result<(Score, Shaft), ExtractError> {
    let light = prepare::equalise(&cut.lab, 8, 2.5);
    let main = score::main_direction(&cut.mask);
    let map = score::score(&light, &cut.lab, &cut.mask, &main);
    let cusp = axis::cusp(&cut.lab, &map.distance, &main);
    let shaft = shaft::shaft(&map, &cusp).ok_or_else(|| ExtractError::NoFeather {
        reason: "no way through from end to end".to_owned(),
    })?;
    Ok((map, shaft))
}

/// Refuses what is too doubtful on rough ground.
fn check_ground(cut: &Silhouette, confidence: &Confidence) -> Result<(), ExtractError> {
    if cut.noise <= find::ROUGH || confidence.overall() >= ROUGH_CONFIDENCE {
        return Ok(());
    }
    Err(ExtractError::RoughGround {
        noise: cut.noise,
        even: find::ROUGH,
        measure: "confidence",
        value: confidence.overall(),
        least: ROUGH_CONFIDENCE,
    })
}

/// Which end is the quill, as [`quill_end`], or as it is held.
fn quill(cut: &Silhouette) -> f32 {
    cut.held.map_or_else(
        || quill_end(&cut.mask),
        |at| (cut.view.view(at).y - 0.5 * cut.view.height as f32).signum(),
    )
}

/// Which end is the quill: positive when it is the lower one, about -1..1. A quill is narrow for long, and as wide at its very
/// end as further in, where a tip tapers.
fn quill_end(mask: &GrayImage) -> f32 {
    let widths: Vec<f32> = mask
        .rows()
        .map(|row| row.filter(|p| p[0] > 0).count() as f32)
        .collect();
    let (Some(first), Some(last)) = (
        widths.iter().position(|&w| w > 0.0),
        widths.iter().rposition(|&w| w > 0.0),
    ) else {
        return 0.0;
    };
    let mut widths = widths[first..=last].to_vec();
    let widest = raster::quantile(&mut widths.clone(), 0.95).max(1.0);
    let mut ends = [0.0; 2];
    for end in &mut ends {
        let mean = |low: f32, high: f32| {
            let at = |share: f32| (share * widths.len() as f32) as usize;
            let part = &widths[at(low)..at(high).max(at(low) + 1).min(widths.len())];
            part.iter().sum::<f32>() / part.len().max(1) as f32
        };
        let sixth = &widths[..(widths.len() / 6).max(1)];
        let bare = sixth
            .iter()
            .map(|w| (1.0 - w / widest).max(0.0).powi(2))
            .sum::<f32>()
            / sixth.len() as f32;
        let further = mean(0.03, 0.05);
        let flat = if further < 0.3 * widest {
            (mean(0.007, 0.02) / further.max(1.0) - 0.6) / 0.4
        } else {
            0.0
        };
        *end = 1.3 * bare + 0.5 * flat.clamp(-1.0, 1.0);
        widths.reverse();
    }
    ends[1] - ends[0]
}

/// Which end of the shaft is the thicker one: positive when it is the lower one, -1..1.
fn thick_end(map: &Score, shaft: &Shaft) -> f32 {
    let rows = shaft.x.len();
    let mean = |from: usize, to: usize| {
        let sum: f32 = (from..to)
            .map(|i| {
                let x = (shaft.x[i] as usize).min(map.radius.width - 1);
                map.radius.data[(shaft.rows.0 + i) * map.radius.width + x]
            })
            .sum();
        sum / (to - from).max(1) as f32
    };
    // The ends themselves are quill or taper.
    let (top, bottom) = (
        mean(rows / 10, rows * 4 / 10),
        mean(rows * 6 / 10, rows * 9 / 10),
    );
    (1.5 * (bottom - top) / (bottom + top).max(1e-3)).clamp(-1.0, 1.0)
}

/// Notes an outline that no feather has.
fn judge_shape(cut: &Silhouette, confidence: &mut Confidence) {
    let trust = &mut confidence.one_feather;
    let area = cut.mask.as_raw().iter().filter(|&&m| m > 0).count() as f32;
    let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
    for p in &cut.outline {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let size = (high - low).max(Vec2::ONE);
    if size.x > 0.75 * size.y {
        trust.doubt(
            Doubt::Shape("nearly as wide as long"),
            0.75 * size.y / size.x * 0.6,
        );
    }
    let points: Vec<imageproc::point::Point<i32>> = cut
        .outline
        .iter()
        .map(|p| imageproc::point::Point::new(p.x as i32, p.y as i32))
        .collect();
    let hull = imageproc::geometry::convex_hull(points);
    let hull_area = imageproc::geometry::contour_area(&hull).max(1.0) as f32;
    let solid = area / hull_area;
    if solid < 0.55 {
        trust.doubt(Doubt::Shape("deeply lobed"), (solid / 0.55).powi(2));
    }
    let perimeter = outline::length(&cut.outline);
    let ragged = perimeter / (2.0 * (size.x + size.y));
    if ragged > 2.2 {
        trust.doubt(Doubt::Shape("ragged outline"), (2.2 / ragged).max(0.2));
    }
}

/// Notes colors that are clipped.
fn judge_exposure(cut: &Silhouette, confidence: &mut Confidence) {
    let (mut clipped, mut count) = (0u32, 0u32);
    for (pixel, mask) in cut.image.pixels().zip(cut.mask.as_raw()) {
        if *mask > 0 {
            let [r, g, b, _] = pixel.0;
            count += 1;
            clipped += u32::from(r.min(g).min(b) > 252 || r.max(g).max(b) < 3);
        }
    }
    let share = clipped as f32 / count.max(1) as f32;
    if share > 0.03 {
        confidence.albedo.doubt(Doubt::Clipped(share), 1.0 - share);
    }
}
