//! A feather held in a hand, before a wall of rock too: the visible feather is found, or the refusal says why not.
use bevy_plumage::anatomy::Feather;
use bevy_plumage::photo::{Doubt, ExtractError, ExtractSettings, Extraction, extract};
use image::{DynamicImage, RgbImage};
use plumage_reference::photograph::measure::dice;
use plumage_reference::photograph::{Background, Hand, Light, Photograph, Setting};
use rayon::prelude::*;

const RED: [f32; 3] = [0.70, 0.10, 0.07];
const PALE: [f32; 3] = [0.86, 0.84, 0.80];
const DARK: [f32; 3] = [0.07, 0.065, 0.06];
const LIGHT_SKIN: [f32; 3] = [0.80, 0.60, 0.49];

fn take(picture: &RgbImage) -> Result<Extraction, ExtractError> {
    let settings = ExtractSettings {
        resolution: 400,
        albedo_height: 64,
        length_mm: Some(100.0),
        ..ExtractSettings::default()
    };
    let picture = DynamicImage::ImageRgb8(picture.clone());
    extract(&picture, &settings, &mut |_| ())
}

/// A feather held into the picture by two or three fingers.
fn held(background: Background, ground: [f32; 3], skin: [f32; 3], seed: u64) -> Setting {
    Setting {
        size: [240, 360],
        background,
        ground,
        light: Light {
            azimuth: -0.8 + 0.5 * seed as f32,
            lift: 0.05,
            ..Setting::default().light
        },
        rotation: [0.2, -0.35, 1.2, 2.9, -1.0, 0.0][seed as usize % 6],
        fill: 0.66,
        hand: Some(Hand {
            cover: 0.1 + 0.02 * (seed % 6) as f64,
            skin,
            fingers: 2 + (seed % 2) as u8,
            thick: 0.04 + 0.006 * (seed % 5) as f64,
            seed,
        }),
        seed,
        ..Setting::default()
    }
}

fn rock(skin: [f32; 3], seed: u64) -> Setting {
    held(Background::Rock, [0.46, 0.42, 0.37], skin, seed)
}

fn card(skin: [f32; 3], seed: u64) -> Setting {
    held(Background::Color, [0.45, 0.62, 0.70], skin, seed)
}

/// One photograph of the name's feather, in one color or its own.
fn photograph(name: &str, color: Option<[f32; 3]>, setting: &Setting) -> (Photograph, String) {
    let mut feather: Feather = plumage_tests::shipped::feather(name);
    if let Some(color) = color {
        let front = &mut feather.albedo.front;
        for stop in &mut front.stops {
            (stop.color, stop.tint) = (color, 0.0);
        }
        (front.rim, front.bars, front.mottle) = (None, None, 0.05);
    }
    let photograph = Photograph::take(&feather, setting);
    let path = plumage_tests::failure(&format!(
        "held_{name}_{:?}_{}.png",
        setting.background, setting.seed
    ));
    let _ = photograph.image.save(&path);
    (photograph, path.display().to_string())
}

/// The visible feather without the hand, its base where the hand is.
fn check(found: &Extraction, photograph: &Photograph, file: &str) {
    let truth = &photograph.truth;
    let score = dice(&truth.mask, &found.mask);
    let area = found.mask.iter().filter(|m| **m > 0).count() as f32;
    let wrong = found.mask.iter().zip(truth.mask.iter());
    let wrong = wrong.filter(|(m, t)| **m > 0 && **t == 0).count() as f32 / area;
    let overall = found.confidence.overall();
    println!("{file}: Dice {score:.3}, {wrong:.3} of it no feather, confidence {overall:.2}");
    assert!(score > 0.9, "{file}: Dice {score}");
    assert!(wrong < 0.06, "{file}: {wrong} of the mask is no feather");
    let far = |p: bevy::math::Vec2| {
        (f64::from(p.x) - truth.rachis[0][0]).hypot(f64::from(p.y) - truth.rachis[0][1])
    };
    let ends = [found.rachis[0], found.rachis[found.rachis.len() - 1]];
    assert!(far(ends[0]) < far(ends[1]), "{file}: tip and base");
}

#[test]
fn a_held_feather_is_found_without_the_hand() {
    let cases = [
        ("eagle_rectrix", Some(RED), rock(LIGHT_SKIN, 0)),
        ("eagle_rectrix", Some(PALE), rock(LIGHT_SKIN, 1)),
        ("macaw_primary", Some(DARK), card(LIGHT_SKIN, 1)),
    ];
    cases.into_par_iter().for_each(|(name, color, setting)| {
        let (photograph, file) = photograph(name, color, &setting);
        let found = match take(&photograph.image) {
            Ok(found) => found,
            Err(error) => panic!("{file}: {error}"),
        };
        check(&found, &photograph, &file);
        let trust = &found.confidence.one_feather;
        assert!(trust.doubts.contains(&Doubt::Held), "{file}: {trust:?}");
        assert!(found.confidence.overall() <= 0.8, "{file}");
    });
}

/// Dark feathers have the colors of the rock's shadows, banded brown ones those of the rock: nothing else is taken for them, not the hand
/// either.
#[test]
fn rock_too_like_the_feather_is_named() {
    let cases = [
        ("eagle_secondary", None, 1),
        ("eagle_rectrix", Some(DARK), 2),
    ];
    let refused: usize = cases
        .into_par_iter()
        .map(|(name, color, seed)| {
            let (photograph, file) = photograph(name, color, &rock(LIGHT_SKIN, seed));
            match take(&photograph.image) {
                Ok(found) => {
                    check(&found, &photograph, &file);
                    0
                }
                Err(error) => {
                    println!("{file}: {error}");
                    let ExtractError::RoughGround {
                        noise,
                        even,
                        value,
                        least,
                        ..
                    } = error
                    else {
                        panic!("{file}: {error}");
                    };
                    assert!(noise > even && value < least, "{file}: {error}");
                    assert!(error.to_string().contains("ground is too rough"));
                    1
                }
            }
        })
        .sum();
    assert!(refused > 0, "no rock was too like a feather");
}

/// A feather that the border cuts through its bands is held by nothing.
#[test]
fn a_banded_feather_cut_by_the_border_is_not_held() {
    let name = "mallard_speculum";
    let mut setting = card(LIGHT_SKIN, 5);
    (setting.hand, setting.fill) = (None, 0.85);
    let (photograph, file) = photograph(name, None, &setting);
    let cut = |image: &DynamicImage| image.crop_imm(0, 0, 240, 250);
    let image = cut(&photograph.image.clone().into()).to_rgb8();
    let truth = cut(&photograph.truth.mask.clone().into()).to_luma8();
    let found = match take(&image) {
        Ok(found) => found,
        Err(error) => panic!("{file}: {error}"),
    };
    let score = dice(&truth, &found.mask);
    let doubts = &found.confidence.one_feather.doubts;
    println!("{file}: Dice {score:.3}, {doubts:?}");
    assert!(score > 0.97, "{file}: Dice {score}");
    assert!(!doubts.contains(&Doubt::Held), "{file}: {doubts:?}");
    let cut = |doubt: &Doubt| matches!(doubt, Doubt::CutByFrame(_));
    assert!(doubts.iter().any(cut), "{file}: {doubts:?}");
}
