//! What is not one feather, and what hardly is a picture: typed errors or low confidence, never a panic.
use bevy::math::Vec2;
use bevy_plumage::asset::RonAsset;
use bevy_plumage::photo::{
    Doubt, ExtractError, ExtractSettings, Extraction, Face, decode_photograph, extract,
    load_photograph,
};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use proptest::prelude::*;
use std::io::Cursor;

const PAPER: [u8; 3] = [205, 208, 214];

fn settings() -> ExtractSettings {
    ExtractSettings {
        resolution: 400,
        albedo_height: 96,
        length_mm: Some(100.0),
        ..ExtractSettings::default()
    }
}

fn run(image: &DynamicImage) -> Result<Extraction, ExtractError> {
    extract(image, &settings(), &mut |_| ())
}

/// Coverage and brightness of a plain feather at `p`: tip up, base of the quill at (0, 0), length 1, narrower left vane.
fn feather(p: Vec2) -> Option<f32> {
    let shaft = 0.05 * p.y * p.y;
    let x = p.x - shaft;
    if !(0.0..1.0).contains(&p.y) {
        return None;
    }
    if x.abs() < 0.012 * (1.2 - p.y) {
        return Some(1.0);
    }
    let h = (p.y - 0.18) / 0.82;
    if h < 0.0 {
        return None;
    }
    let width = (1.0 - h.powi(3)).sqrt() * (h * 8.0).min(1.0);
    let reach = if x < 0.0 { 0.07 } else { 0.13 } * width;
    // Barbs at 40 degrees.
    let barb = (p.y - x.abs() / 40f32.to_radians().tan()) * 60.0 * std::f32::consts::TAU;
    (x.abs() < reach).then(|| 0.45 + 0.12 * barb.sin())
}

/// Draws feathers (base, direction to the tip, length in pixels) on paper.
fn picture(width: u32, height: u32, feathers: &[(Vec2, Vec2, f32)]) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let mut color = PAPER.map(f32::from);
        for (base, up, length) in feathers {
            let mut cover = 0.0;
            let mut light = 0.0;
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let from = (Vec2::new(x as f32 + dx, y as f32 + dy) - *base) / *length;
                let p = Vec2::new(from.dot(up.perp()), from.dot(*up));
                if let Some(value) = feather(p) {
                    cover += 0.25;
                    light += 0.25 * value;
                }
            }
            for (c, tint) in color.iter_mut().zip([150.0, 95.0, 60.0]) {
                *c = *c * (1.0 - cover) + light * tint;
            }
        }
        Rgb(color.map(|c| c.clamp(0.0, 255.0) as u8))
    })
}

fn one() -> RgbImage {
    picture(
        200,
        400,
        &[(Vec2::new(85.0, 385.0), Vec2::new(0.0, -1.0), 370.0)],
    )
}

fn png(image: &DynamicImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    image
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .expect("encoded");
    bytes
}

/// The drawn feather is found where it was drawn, the right way up, and the asset covers it.
#[test]
fn plain_feather() {
    let image = DynamicImage::ImageRgb8(one());
    let found = run(&image).expect("a feather");
    let (mut both, mut sum) = (0.0, 0.0);
    for (x, y, pixel) in found.mask.enumerate_pixels() {
        let from = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - Vec2::new(85.0, 385.0)) / 370.0;
        let real = feather(Vec2::new(from.x, -from.y)).is_some();
        both += f32::from(u8::from(real && pixel[0] > 0));
        sum += f32::from(u8::from(real)) + f32::from(u8::from(pixel[0] > 0));
    }
    assert!(2.0 * both / sum > 0.975, "Dice {}", 2.0 * both / sum);
    let off = found
        .rachis
        .iter()
        .map(|p| {
            let y = (385.0 - p.y) / 370.0;
            (p.x - 85.0 - 370.0 * 0.05 * y * y).abs()
        })
        .sum::<f32>()
        / found.rachis.len() as f32;
    assert!(off < 1.2, "shaft {off} pixels off");
    assert!(found.rachis[0].y > 370.0 && found.rachis[255].y < 30.0);
    assert!(found.confidence.overall() > 0.8, "{:?}", found.confidence);
    for barbs in &found.barbs {
        let angle = barbs.expect("barbs").angle.to_degrees();
        assert!((angle - 40.0).abs() < 4.0, "barbs at {angle} degrees");
    }
    // Its own card: base and tip at v = 0 and 1.
    let base = found.frame.uv(found.rachis[0]);
    assert!(base.y.abs() < 0.02, "{base}");
    let back = found.frame.pixel(base);
    assert!(back.distance(found.rachis[0]) < 0.01);
    assert!(
        found.feather.contour.right.iter().sum::<f32>()
            > found.feather.contour.left.iter().sum::<f32>()
    );
    assert_eq!(found.feather.length_mm, 100.0);
}

/// The picture upside down is the same feather; seen from the back the vanes change sides.
#[test]
fn turned_and_mirrored() {
    let image = DynamicImage::ImageRgb8(one());
    let turned = run(&image.rotate180()).expect("a feather");
    assert!(turned.rachis[0].y < 30.0, "base {}", turned.rachis[0]);
    let side = run(&image.rotate90()).expect("a feather");
    assert!(side.rachis[255].x > 170.0, "tip {}", side.rachis[255]);
    let settings = ExtractSettings {
        face: Face::Back,
        ..settings()
    };
    let back = extract(&image, &settings, &mut |_| ()).expect("a feather");
    let sum = |reach: &[f32]| reach.iter().sum::<f32>();
    assert!(sum(&back.feather.contour.left) > sum(&back.feather.contour.right));
    let doubts: Vec<_> = back.confidence.albedo.doubts.clone();
    assert!(doubts.contains(&Doubt::BackSeen), "{doubts:?}");
}

/// An alpha channel that cuts the feather out is its mask, whatever color lies beneath.
#[test]
fn alpha_is_the_mask() {
    let photo = one();
    let image = RgbaImage::from_fn(200, 400, |x, y| {
        let from = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - Vec2::new(85.0, 385.0)) / 370.0;
        let on = feather(Vec2::new(from.x, -from.y)).is_some();
        let Rgb([r, g, b]) = *photo.get_pixel(x, y);
        Rgba([r, g, b, if on { 255 } else { 0 }])
    });
    let alpha: Vec<bool> = image.pixels().map(|p| p[3] > 0).collect();
    let found = run(&DynamicImage::ImageRgba8(image)).expect("a feather");
    let differ = found
        .mask
        .pixels()
        .zip(&alpha)
        .filter(|(m, a)| (m[0] > 0) != **a)
        .count();
    let area = alpha.iter().filter(|a| **a).count();
    assert!(differ * 30 < area, "{differ} of {area} pixels differ");
}

/// The same call gives the same bytes, and what is written is read back.
#[test]
fn deterministic_and_written() {
    let image = DynamicImage::ImageRgb8(one());
    let (a, b) = (run(&image).expect("one"), run(&image).expect("two"));
    assert_eq!(a.feather, b.feather);
    assert_eq!(a.albedo, b.albedo);
    let folder = std::env::temp_dir().join(format!("bevy_plumage_write_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("folder");
    let [feather, albedo] = a.write(&folder).expect("written");
    let text = std::fs::read(&feather).expect("read");
    let read = bevy_plumage::anatomy::Feather::from_ron(&text, "x").expect("valid");
    assert_eq!(read.albedo.image.as_deref(), Some("photograph_albedo.png"));
    assert_eq!(image::open(&albedo).expect("picture").height(), 96);
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn nothing_to_see() {
    let blank = DynamicImage::ImageRgb8(RgbImage::from_pixel(120, 160, Rgb(PAPER)));
    assert!(matches!(run(&blank), Err(ExtractError::NoFeather { .. })));
    let grain = RgbImage::from_fn(120, 160, |x, y| {
        Rgb([0, 1, 2].map(|c| ((x * 7919 + y * 104_729 + c * 31) % 251) as u8))
    });
    match run(&DynamicImage::ImageRgb8(grain)) {
        Err(
            ExtractError::NoFeather { .. }
            | ExtractError::SeveralObjects { .. }
            | ExtractError::RoughGround { .. },
        ) => (),
        Err(error) => panic!("{error}"),
        Ok(found) => assert!(found.confidence.overall() < 0.5, "{:?}", found.confidence),
    }
}

#[test]
fn sizes() {
    let tiny = DynamicImage::ImageRgb8(RgbImage::new(16, 16));
    assert!(matches!(run(&tiny), Err(ExtractError::Size { .. })));
    let huge = DynamicImage::ImageLuma8(GrayImage::new(40_000, 30));
    assert!(matches!(run(&huge), Err(ExtractError::Size { .. })));
    // 20,000 pixels wide is a panorama, not a feather, and takes no longer than another picture.
    let wide = GrayImage::from_fn(20_000, 60, |x, y| {
        let on = (4000..16_000).contains(&x) && (20..40).contains(&y);
        Luma([if on { 60 } else { 200 }])
    });
    let refused = run(&DynamicImage::ImageLuma8(wide)).map(|found| found.confidence);
    assert!(
        matches!(
            refused,
            Err(ExtractError::NoFeather { .. } | ExtractError::SeveralObjects { .. })
        ),
        "{refused:?}"
    );
}

#[test]
fn several_feathers_and_pieces() {
    let up = Vec2::new(0.0, -1.0);
    let three = picture(
        360,
        300,
        &[
            (Vec2::new(60.0, 285.0), up, 260.0),
            (Vec2::new(170.0, 285.0), up, 260.0),
            (Vec2::new(280.0, 285.0), up, 260.0),
        ],
    );
    let error = run(&DynamicImage::ImageRgb8(three)).expect_err("three");
    let ExtractError::SeveralObjects { objects } = error else {
        panic!("{error}");
    };
    assert_eq!(objects.len(), 3);
    // Between the two vanes, and above the quill.
    for (object, x) in objects.iter().zip([60.0, 170.0, 280.0]) {
        assert!((object.center.x - x).abs() < 15.0, "{object}");
        assert!((80.0..180.0).contains(&object.center.y), "{object}");
    }
    let cut = picture(200, 300, &[(Vec2::new(85.0, 360.0), up, 330.0)]);
    let found = run(&DynamicImage::ImageRgb8(cut)).expect("most of a feather");
    let doubts = &found.confidence.one_feather.doubts;
    assert!(
        doubts.iter().any(|d| matches!(d, Doubt::CutByFrame(_))),
        "{doubts:?}"
    );
    // The frame alone is in doubt, by the share of the outline that it cuts.
    let trust = &found.confidence;
    assert_eq!(trust.one_feather.doubts.len(), 1, "{trust:?}");
    assert!(
        (trust.overall() - 0.927).abs() < 0.01 && trust.overall() == trust.one_feather.value,
        "{trust:?}"
    );
}

/// Five fingers on a palm.
#[test]
fn hand() {
    let image = RgbImage::from_fn(300, 300, |x, y| {
        let p = Vec2::new(x as f32, y as f32);
        let palm = p.distance(Vec2::new(150.0, 215.0)) < 55.0;
        let finger = (0..5).any(|i| {
            let way = Vec2::from_angle(-2.45 + 0.44 * i as f32);
            let from = p - Vec2::new(150.0, 215.0);
            (0.0..170.0).contains(&from.dot(way)) && from.dot(way.perp()).abs() < 13.0
        });
        Rgb(if palm || finger {
            [224, 172, 140]
        } else {
            PAPER
        })
    });
    match run(&DynamicImage::ImageRgb8(image)) {
        Err(ExtractError::NoFeather { .. } | ExtractError::SeveralObjects { .. }) => (),
        Err(error) => panic!("{error}"),
        Ok(found) => {
            assert!(found.confidence.overall() < 0.6, "{:?}", found.confidence);
            assert!(!found.confidence.one_feather.doubts.is_empty());
        }
    }
}

#[test]
fn any_kind_of_pixel() {
    let image = DynamicImage::ImageRgb8(one());
    for kind in [
        DynamicImage::ImageLuma8(image.to_luma8()),
        DynamicImage::ImageRgb16(image.to_rgb16()),
        DynamicImage::ImageRgba32F(image.to_rgba32f()),
    ] {
        let found = run(&kind).expect("a feather");
        assert!(found.confidence.overall() > 0.5, "{:?}", found.confidence);
    }
}

/// A PNG named .jpg is read by its content; half a file and another format are errors that name it.
#[test]
fn files() {
    let folder = std::env::temp_dir().join(format!("bevy_plumage_files_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("folder");
    let bytes = png(&DynamicImage::ImageRgb8(one()));
    let path = folder.join("feather.jpg");
    std::fs::write(&path, &bytes).expect("written");
    assert_eq!(load_photograph(&path).expect("picture").width(), 200);
    std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("written");
    let error = load_photograph(&path).expect_err("half a file");
    assert!(matches!(&error, ExtractError::Decode { file, .. } if file.ends_with("feather.jpg")));
    std::fs::write(&path, b"BM no picture").expect("written");
    assert!(matches!(
        load_photograph(&path),
        Err(ExtractError::Decode { .. })
    ));
    let missing = load_photograph(folder.join("none.png"));
    assert!(matches!(missing, Err(ExtractError::Io { .. })));
    // A header that claims more pixels than are allowed is refused before they are decoded.
    let mut claim = bytes.clone();
    claim[16..24].copy_from_slice(&[0, 0, 0x70, 0, 0, 0, 0x70, 0]);
    assert!(decode_photograph(&claim, "claim").is_err());
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn settings_are_checked() {
    let image = DynamicImage::ImageRgb8(one());
    let mut wrong = settings();
    wrong.resolution = 7;
    assert!(matches!(
        extract(&image, &wrong, &mut |_| ()),
        Err(ExtractError::Setting {
            field: "resolution",
            ..
        })
    ));
    let mut wrong = settings();
    wrong.name = "../x".to_owned();
    assert!(matches!(
        extract(&image, &wrong, &mut |_| ()),
        Err(ExtractError::Name { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Blocks of random colors of any size: whatever comes out is finite and valid.
    #[test]
    fn random_pictures(
        width in 1u32..90,
        height in 1u32..90,
        block in 1u32..30,
        levels in 1u32..6,
        seed in any::<u32>(),
        transparent in any::<bool>(),
    ) {
        let image = RgbaImage::from_fn(width, height, |x, y| {
            let mut h = seed ^ (x / block).wrapping_mul(0x9E37_79B1) ^ (y / block).wrapping_mul(0x85EB_CA77);
            h ^= h >> 15;
            h = h.wrapping_mul(0x2C1B_3C6D);
            h ^= h >> 12;
            let level = |shift: u32| ((h >> shift) % levels * 255 / levels.max(1)) as u8;
            Rgba([level(0), level(8), level(16), if transparent { level(24) } else { 255 }])
        });
        let settings = ExtractSettings { resolution: 256, albedo_height: 32, ..settings() };
        if let Ok(found) = extract(&DynamicImage::ImageRgba8(image), &settings, &mut |_| ()) {
            prop_assert!(found.feather.validate("found").is_ok());
            prop_assert!(found.contour.iter().chain(&found.rachis).all(|p| p.is_finite()));
            prop_assert!((0.0..=1.0).contains(&found.confidence.overall()));
        }
    }

    /// Cut and scrambled files.
    #[test]
    fn broken_files(cut in 0.0f32..1.0, at in 0.0f32..1.0, flip in any::<u8>(), jpeg in any::<bool>()) {
        let image = DynamicImage::ImageRgb8(one());
        let mut bytes = Vec::new();
        let format = if jpeg { ImageFormat::Jpeg } else { ImageFormat::Png };
        image.write_to(&mut Cursor::new(&mut bytes), format).expect("encoded");
        bytes.truncate((bytes.len() as f32 * cut) as usize);
        if let Some(byte) = bytes.get_mut((at * cut * 1000.0) as usize) {
            *byte ^= flip;
        }
        if let Ok(image) = decode_photograph(&bytes, "broken") {
            prop_assert!(image.width() > 0);
        }
    }
}
