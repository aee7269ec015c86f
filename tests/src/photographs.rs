//! One synthetic photograph, extracted and judged.

use bevy::math::Vec2;
use bevy_plumage::anatomy::{Feather, Side};
use bevy_plumage::maths::card;
use bevy_plumage::photo::{ExtractSettings, Extraction, Face, extract};
use image::{DynamicImage, GrayImage, Luma};
use plumage_reference::photograph::measure::{AlbedoScore, Summary, albedo, dice, line_distance};
use plumage_reference::photograph::{Photograph, Setting, Truth};
use std::time::Instant;

/// Least confidence in the barbs of a vane that says that the photograph resolves them.
const SURE: f32 = 0.7;

/// Scores of an extraction that came out.
#[derive(Clone, Debug)]
pub struct Scores {
    /// Dice of the masks.
    pub dice: f64,
    /// Dice of the truth's mask and the extracted asset's own outline.
    pub asset: f64,
    /// Mean distance of the shafts over the image's height.
    pub rachis: f64,
    /// Tip and base are exchanged.
    pub turned: bool,
    /// Error of the barb angle in degrees, left and right, where barbs are resolved and an angle was given.
    pub angle: [Option<f64>; 2],
    /// The same where the extraction itself says that it saw barbs: it counted them, and doubts their angle little.
    pub sure_angle: [Option<f64>; 2],
    /// Vanes whose barbs are resolved but got no angle.
    pub missed: usize,
    /// The same where barbs are finer than that and an angle was given nevertheless.
    pub fine_angle: [Option<f64>; 2],
    /// Relative error of the barb density where resolved and given.
    pub density: [Option<f64>; 2],
    /// Color.
    pub albedo: AlbedoScore,
    /// The extraction's own confidence in the shape.
    pub confidence: f64,
}

/// One photograph and what came of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// Seed of [`Setting::random`], or a number within a sweep.
    pub index: u64,
    /// Name of the preset.
    pub name: String,
    /// How it was taken.
    pub setting: Setting,
    /// Contrast of feather and background.
    pub contrast: f64,
    /// Pixels per feather length.
    pub scale: f64,
    /// Scores, or why there are none.
    pub scores: Result<Scores, String>,
    /// Seconds that the extraction took.
    pub seconds: f64,
}

impl Case {
    /// Dice; an extraction refused counts 0.
    pub fn dice(&self) -> f64 {
        self.scores.as_ref().map_or(0.0, |scores| scores.dice)
    }

    /// Distance of the shafts; an extraction refused counts 1.
    pub fn rachis(&self) -> f64 {
        self.scores.as_ref().map_or(1.0, |scores| scores.rachis)
    }
}

/// The presets in turn; photograph `index` shows the one of that number.
pub fn random_case(index: u64) -> (Feather, Setting) {
    let all = crate::shipped::photographed();
    let feather = all[index as usize % all.len()].clone();
    let setting = Setting::random(&feather, index);
    (feather, setting)
}

/// What the caller tells the extraction: the length, and which face lies up.
pub fn settings(feather: &Feather, setting: &Setting) -> ExtractSettings {
    ExtractSettings {
        name: feather.name.clone(),
        length_mm: Some(feather.length_mm),
        face: if setting.back {
            Face::Back
        } else {
            Face::Front
        },
        ..ExtractSettings::default()
    }
}

/// Takes the photograph, extracts and judges.
pub fn run(index: u64, feather: &Feather, setting: &Setting, settings: &ExtractSettings) -> Case {
    let photograph = Photograph::take(feather, setting);
    let picture = DynamicImage::ImageRgb8(photograph.image.clone());
    let start = Instant::now();
    let found = extract(&picture, settings, &mut |_| ());
    let seconds = start.elapsed().as_secs_f64();
    let truth = &photograph.truth;
    Case {
        index,
        name: feather.name.clone(),
        setting: setting.clone(),
        contrast: f64::from(setting.contrast(feather)),
        scale: truth.pose.scale,
        scores: match &found {
            Ok(found) => Ok(judge(truth, found)),
            Err(error) => Err(error.to_string()),
        },
        seconds,
    }
}

fn points(line: &[Vec2]) -> Vec<[f64; 2]> {
    line.iter()
        .map(|p| [f64::from(p.x), f64::from(p.y)])
        .collect()
}

/// Compares an extraction with the truth.
pub fn judge(truth: &Truth, found: &Extraction) -> Scores {
    let height = f64::from(truth.mask.height());
    let rachis = points(&found.rachis);
    let end = truth.rachis[truth.rachis.len() - 1];
    let turned = rachis.last().is_some_and(|tip| {
        let far = |to: [f64; 2]| (tip[0] - to[0]).hypot(tip[1] - to[1]);
        far(end) > far(truth.rachis[0])
    });
    let mut angle = [None; 2];
    let mut sure_angle = [None; 2];
    let mut missed = 0;
    let mut fine_angle = [None; 2];
    let mut density = [None; 2];
    for side in 0..2 {
        let real = truth.barbs[side];
        let measured = found.barbs[side];
        let error = measured.map(|barbs| (f64::from(barbs.angle) - real.angle).to_degrees().abs());
        let counted = measured.is_some_and(|barbs| barbs.count.is_some());
        if counted && found.confidence.barbs[side].value >= SURE {
            sure_angle[side] = error;
        }
        if real.is_resolved() {
            angle[side] = error;
            missed += usize::from(error.is_none());
            density[side] = measured
                .and_then(|barbs| barbs.count)
                .map(|count| (f64::from(count) / (real.density * truth.length_mm) - 1.0).abs());
        } else if real.closed > 0.6 {
            fine_angle[side] = error;
        }
    }
    let color = |[x, y]: [f64; 2]| {
        let uv = found.frame.uv(Vec2::new(x as f32, y as f32));
        sample(&found.albedo, uv)
    };
    Scores {
        dice: dice(&truth.mask, &found.mask),
        asset: dice(&truth.mask, &asset_mask(found, truth.mask.dimensions())),
        rachis: line_distance(&truth.rachis, &rachis, height),
        turned,
        angle,
        sure_angle,
        missed,
        fine_angle,
        density,
        albedo: albedo(truth, color),
        confidence: f64::from(found.confidence.overall()),
    }
}

/// Bilinear sRGB of the albedo image; none outside the card.
fn sample(albedo: &image::RgbaImage, uv: Vec2) -> Option<[f32; 3]> {
    if !uv.is_finite() || !(-0.02..=1.02).contains(&uv.x) || !(-0.02..=1.02).contains(&uv.y) {
        return None;
    }
    let (width, height) = albedo.dimensions();
    let place = |value: f32, count: u32| {
        let at = (value * count as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        (at as u32, ((at as u32) + 1).min(count - 1), at.fract())
    };
    let ((x0, x1, s), (y0, y1, t)) = (place(uv.x, width), place(uv.y, height));
    let at = |x, y, c: usize| f32::from(albedo.get_pixel(x, y).0[c]) / 255.0;
    Some(std::array::from_fn(|c| {
        let low = at(x0, y0, c) + (at(x1, y0, c) - at(x0, y0, c)) * s;
        let high = at(x0, y1, c) + (at(x1, y1, c) - at(x0, y1, c)) * s;
        low + (high - low) * t
    }))
}

/// What the asset itself covers in the photograph: its vanes up to their reach, and its shaft.
pub fn asset_mask(found: &Extraction, (width, height): (u32, u32)) -> GrayImage {
    let feather = &found.feather;
    let feather_map = feather.map();
    GrayImage::from_fn(width, height, |x, y| {
        let uv = found.frame.uv(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let point = feather_map
            .canonical([f64::from(uv.x), f64::from(uv.y)])
            .map(|x| x as f32);
        let side = if point[0] < 0.0 {
            Side::Left
        } else {
            Side::Right
        };
        let root = card::barb_root(point, feather.vane(side).cotangent());
        let on_vane = point[0].abs() < feather.contour.reach(side, root);
        let on_shaft = (0.0..=1.0).contains(&point[1]) && point[0].abs() < feather.r_r(point[1]);
        Luma([if on_vane || on_shaft { 255 } else { 0 }])
    })
}

/// The table of a set of cases.
pub struct Report {
    /// Dice of the masks.
    pub dice: Summary,
    /// Dice of the asset's outline.
    pub asset: Summary,
    /// Distance of the shafts.
    pub rachis: Summary,
    /// Barb angle where resolved, degrees.
    pub angle: Summary,
    /// Barb angle where the extraction says that it saw barbs.
    pub sure_angle: Summary,
    /// Shares of both within 4 degrees.
    pub within: [f64; 2],
    /// Barb angle where finer.
    pub fine_angle: Summary,
    /// Relative error of the density.
    pub density: Summary,
    /// RMS of the color where the vane is closed and the pattern plain.
    pub albedo: Summary,
    /// The same where it is open.
    pub open: Summary,
    /// Resolved vanes without an angle.
    pub missed: usize,
    /// Displacement of pattern edges, pixels.
    pub edges: Summary,
    /// Seconds.
    pub seconds: Summary,
    /// How many were refused.
    pub refused: usize,
    /// How many have tip and base exchanged.
    pub turned: usize,
}

impl Report {
    /// Of these cases.
    pub fn of(cases: &[Case]) -> Self {
        let within = |angles: Vec<f64>| {
            let good = angles.iter().filter(|error| **error <= 4.0).count();
            good as f64 / angles.len().max(1) as f64
        };
        let good = || cases.iter().filter_map(|case| case.scores.as_ref().ok());
        Self {
            dice: Summary::of(cases.iter().map(Case::dice)),
            asset: Summary::of(
                cases
                    .iter()
                    .map(|case| case.scores.as_ref().map_or(0.0, |scores| scores.asset)),
            ),
            rachis: Summary::of(cases.iter().map(Case::rachis)),
            angle: Summary::of(good().flat_map(|s| s.angle).flatten()),
            sure_angle: Summary::of(good().flat_map(|s| s.sure_angle).flatten()),
            within: [
                within(good().flat_map(|s| s.angle).flatten().collect()),
                within(good().flat_map(|s| s.sure_angle).flatten().collect()),
            ],
            fine_angle: Summary::of(good().flat_map(|s| s.fine_angle).flatten()),
            density: Summary::of(good().flat_map(|s| s.density).flatten()),
            albedo: Summary::of(good().filter_map(|s| s.albedo.rms)),
            open: Summary::of(good().filter_map(|s| s.albedo.open)),
            missed: good().map(|s| s.missed).sum(),
            edges: Summary::of(good().filter_map(|s| s.albedo.edges)),
            seconds: Summary::of(cases.iter().map(|case| case.seconds)),
            refused: cases.iter().filter(|case| case.scores.is_err()).count(),
            turned: good().filter(|scores| scores.turned).count(),
        }
    }

    /// Prints the table.
    pub fn print(&self) {
        println!("| measure | photographs | mean | 5th percentile | median | 95th percentile |");
        println!("|---|---|---|---|---|---|");
        for (name, s) in [
            ("contour, Dice of the mask", &self.dice),
            ("contour, Dice of the asset's outline", &self.asset),
            ("rachis, mean distance over image height", &self.rachis),
            ("barb angle where resolved, degrees off", &self.angle),
            ("the same where the extraction is sure", &self.sure_angle),
            ("barb angle where finer, degrees off", &self.fine_angle),
            ("barb density where resolved, relative error", &self.density),
            ("albedo, RMS away from patterns", &self.albedo),
            ("the same through open vanes", &self.open),
            ("pattern edges, pixels off", &self.edges),
            ("seconds", &self.seconds),
        ] {
            println!(
                "| {name} | {} | {:.4} | {:.4} | {:.4} | {:.4} |",
                s.count, s.mean, s.low, s.median, s.high
            );
        }
        println!(
            "refused: {}; tip and base exchanged: {}; resolved vanes without an angle: {}",
            self.refused, self.turned, self.missed
        );
        println!(
            "barb angle within 4 degrees: {:.3} of the vanes where resolved, {:.3} where the extraction is sure",
            self.within[0], self.within[1]
        );
    }
}
