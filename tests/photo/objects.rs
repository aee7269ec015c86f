//! More than one thing in a picture: a shadow that lies apart is none, of several feathers the caller takes one.
use bevy::math::Vec2;
use bevy_plumage::anatomy::Feather;
use bevy_plumage::photo::{
    Doubt, ExtractError, ExtractSettings, Extraction, ObjectChoice, PhotoObject, extract,
};
use image::{DynamicImage, GrayImage, RgbImage};
use plumage_reference::photograph::measure::dice;
use plumage_reference::photograph::{Background, Light, Photograph, Setting};

fn settings(object: ObjectChoice) -> ExtractSettings {
    ExtractSettings {
        resolution: 640,
        albedo_height: 96,
        length_mm: Some(100.0),
        object,
        ..ExtractSettings::default()
    }
}

fn take(picture: &RgbImage, object: ObjectChoice) -> Result<Extraction, ExtractError> {
    let picture = DynamicImage::ImageRgb8(picture.clone());
    extract(&picture, &settings(object), &mut |_| ())
}

/// A feather in one color.
fn painted(name: &str, color: [f32; 3]) -> Feather {
    let mut feather = plumage_tests::shipped::feather(name);
    let front = &mut feather.albedo.front;
    for stop in &mut front.stops {
        (stop.color, stop.tint) = (color, 0.0);
    }
    (front.rim, front.bars, front.mottle) = (None, None, 0.05);
    feather
}

/// White paper below a lamp that stands low: the shadow of a feather on its arched vane falls beside it.
fn low_lamp(azimuth: f32, seed: u64) -> Setting {
    Setting {
        size: [560, 720],
        background: Background::White,
        ground: [0.93; 3],
        light: Light {
            azimuth,
            elevation: 0.2,
            ambient: 0.45,
            lift: 0.05,
            softness: 0.08,
            ..Setting::default().light
        },
        fill: 0.62,
        rotation: 0.15,
        seed,
        ..Setting::default()
    }
}

fn white() -> [f32; 3] {
    [0.80, 0.79, 0.76]
}

/// Writes what a test was about to fail on.
fn kept(picture: &RgbImage, name: &str) -> String {
    let path = plumage_tests::failure(name);
    let _ = picture.save(&path);
    path.display().to_string()
}

/// Pixels of one mask in another, over the first one's.
fn share(mask: &GrayImage, within: impl Fn(u32, u32) -> bool) -> f32 {
    let on = || mask.enumerate_pixels().filter(|(_, _, m)| m[0] > 0);
    on().filter(|(x, y, _)| within(*x, *y)).count() as f32 / on().count().max(1) as f32
}

#[test]
fn a_shadow_that_lies_apart_is_no_object() {
    let mut apart = 0;
    for (name, azimuth, seed) in [
        ("primary", -1.4, 1),
        ("eagle_primary", 1.5, 2),
        ("eagle_rectrix", -1.6, 3),
        ("macaw_primary", 1.2, 4),
        ("rectrix", 1.6, 5),
    ] {
        let photograph = Photograph::take(&painted(name, white()), &low_lamp(azimuth, seed));
        let file = kept(&photograph.image, &format!("shadow_{name}.png"));
        let found = match take(&photograph.image, ObjectChoice::Only) {
            Ok(found) => found,
            Err(error) => panic!("{file}: {error}"),
        };
        let score = dice(&photograph.truth.mask, &found.mask);
        // The same flat on the paper, in the same light.
        let mut flat = low_lamp(azimuth, seed);
        flat.light.lift = 0.001;
        let photograph = Photograph::take(&painted(name, white()), &flat);
        let plain = take(&photograph.image, ObjectChoice::Only).expect("a feather");
        let plain = dice(&photograph.truth.mask, &plain.mask);
        println!("{name}: Dice {score:.3}, without a shadow {plain:.3}");
        assert!(score > 0.92 && score > plain - 0.02, "{file}: Dice {score}");
        let doubts = &found.confidence.one_feather.doubts;
        apart += usize::from(doubts.contains(&Doubt::ShadowsApart(1)));
    }
    assert!(apart > 3, "{apart} shadows lay apart");
}

/// Photographs taken alike but for the feather's place, laid side by side, and the truth of each.
fn row(feathers: &[Feather], setting: &Setting) -> (RgbImage, Vec<GrayImage>) {
    let count = feathers.len() as u32;
    let [width, height] = setting.size;
    let mut picture = RgbImage::new(width * count, height);
    let mut masks = Vec::new();
    for (i, feather) in feathers.iter().enumerate() {
        let one = Photograph::take(feather, setting);
        let at = i64::from(width) * i as i64;
        image::imageops::replace(&mut picture, &one.image, at, 0);
        let mut mask = GrayImage::new(width * count, height);
        image::imageops::replace(&mut mask, &one.truth.mask, at, 0);
        masks.push(mask);
    }
    (picture, masks)
}

fn table() -> Setting {
    Setting {
        size: [260, 520],
        background: Background::Color,
        ground: [0.45, 0.62, 0.70],
        light: Light {
            vignette: 0.0,
            falloff: 0.0,
            ..Setting::default().light
        },
        rotation: 0.1,
        fill: 0.8,
        ..Setting::default()
    }
}

fn listed(error: ExtractError) -> Vec<PhotoObject> {
    match error {
        ExtractError::SeveralObjects { objects } => objects,
        error => panic!("{error}"),
    }
}

#[test]
fn several_feathers_are_listed_with_their_places_and_one_is_taken() {
    let feathers =
        ["macaw_primary", "eagle_secondary", "primary"].map(plumage_tests::shipped::feather);
    let (picture, masks) = row(&feathers, &table());
    let file = kept(&picture, "three_feathers.png");
    let error = take(&picture, ObjectChoice::Only).expect_err("three feathers");
    let message = error.to_string();
    let objects = listed(error);
    assert_eq!(objects.len(), 3, "{file}: {message}");
    assert!(message.contains("3 objects"), "{message}");
    for (i, (object, mask)) in objects.iter().zip(&masks).enumerate() {
        let place = format!(
            "{} at ({:.0}, {:.0})",
            i + 1,
            object.center.x,
            object.center.y
        );
        assert!(message.contains(&place), "{message}");
        let boxed = share(mask, |x, y| {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            p.cmpge(object.low - 4.0).all() && p.cmple(object.high + 4.0).all()
        });
        assert!(
            boxed > 0.97,
            "{file}: {object} holds {boxed} of feather {i}"
        );
        let number = i as u32 + 1;
        let shaft = 0.5 * (object.low + object.high);
        for choice in [
            ObjectChoice::Number(number),
            ObjectChoice::At(object.center.into()),
        ] {
            let found = take(&picture, choice).expect("the feather chosen");
            let score = dice(mask, &found.mask);
            println!("{choice:?}: Dice {score:.3}, around {shaft}");
            assert!(score > 0.97, "{file}: {choice:?} has a Dice of {score}");
        }
    }
    for choice in [
        ObjectChoice::Number(0),
        ObjectChoice::Number(4),
        ObjectChoice::At([2.0, 2.0]),
    ] {
        let error = take(&picture, choice).expect_err("nothing there");
        let ExtractError::NoSuchObject { objects, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!(objects.len(), 3);
        assert!(error.to_string().contains("there are 3"), "{error}");
    }
    let outside = take(&picture, ObjectChoice::At([-1.0, f32::NAN]));
    assert!(matches!(
        outside,
        Err(ExtractError::Setting {
            field: "object",
            ..
        })
    ));
}

/// A grey feather beside a white one is darker than white paper and has its hue, and is no shadow all the same.
#[test]
fn a_grey_feather_beside_a_white_one_is_no_shadow() {
    for name in ["primary", "secondary", "contour"] {
        let feathers = [painted(name, white()), painted(name, [0.62; 3])];
        let setting = Setting {
            background: Background::White,
            ground: [0.93; 3],
            ..table()
        };
        let (picture, masks) = row(&feathers, &setting);
        let file = kept(&picture, &format!("grey_{name}.png"));
        let error = take(&picture, ObjectChoice::Only).expect_err("two feathers");
        assert_eq!(listed(error).len(), 2, "{file}");
        for ((number, mask), feather) in (1..).zip(&masks).zip(&feathers) {
            let found = take(&picture, ObjectChoice::Number(number)).expect("a feather");
            let score = dice(mask, &found.mask);
            // White on white is found less well, beside another no less than alone.
            let one = Photograph::take(feather, &setting);
            let alone = take(&one.image, ObjectChoice::Only).expect("a feather");
            let alone = dice(&one.truth.mask, &alone.mask);
            println!("{name} {number}: Dice {score:.3}, alone {alone:.3}");
            assert!(score > 0.9 && score > alone - 0.02, "{file}: Dice {score}");
        }
    }
}
