//! The extraction against the truth of synthetic photographs, and the measures against known displacements.

use bevy_plumage::photo::ExtractSettings;
use image::{GrayImage, Luma};
use plumage_reference::photograph::measure::{albedo, dice, line_distance};
use plumage_reference::photograph::{Background, Photograph, Setting};
use plumage_tests::photographs::{Case, Report, random_case, run, settings};
use rayon::prelude::*;

fn small() -> Setting {
    Setting {
        size: [240, 360],
        noise: 0.0,
        jpeg: None,
        ..Setting::default()
    }
}

fn take(name: &str, setting: &Setting) -> Photograph {
    Photograph::take(&plumage_tests::shipped::feather(name), setting)
}

#[test]
fn same_setting_same_picture() {
    let setting = Setting {
        size: [120, 180],
        background: Background::Wood,
        noise: 0.02,
        jpeg: Some(80),
        ..Setting::default()
    };
    let first = take("eagle_contour", &setting);
    let second = take("eagle_contour", &setting);
    assert_eq!(first.image, second.image);
    assert_eq!(first.file(), second.file());
    let other = Setting { seed: 2, ..setting };
    assert_ne!(first.image, take("eagle_contour", &other).image);
}

/// The file is what the picture was opened from.
#[test]
fn file_holds_the_picture() {
    for jpeg in [None, Some(70)] {
        let photograph = take("macaw_contour", &Setting { jpeg, ..small() });
        let opened = image::load_from_memory(&photograph.file()).expect("own file");
        assert_eq!(opened.to_rgb8(), photograph.image);
    }
}

/// The truth lies where the picture shows the feather: the mask follows the turned card, shaft points lie in it, and the
/// mask is nearly the polygon of the outline.
#[test]
fn truth_follows_the_pose() {
    for (turn, back, tilt) in [(0.0, false, 0.0), (1.1, false, 0.05), (3.6, true, -0.04)] {
        let setting = Setting {
            rotation: turn,
            back,
            tilt: [tilt, tilt],
            ..small()
        };
        let truth = take("macaw_greater", &setting).truth;
        let inside = truth
            .rachis
            .iter()
            .filter(|p| truth.mask.get_pixel(p[0] as u32, p[1] as u32).0[0] > 0)
            .count();
        assert!(inside > 245, "{inside} of 256 shaft points in the mask");
        let towards = [
            truth.rachis[255][0] - truth.rachis[0][0],
            truth.rachis[255][1] - truth.rachis[0][1],
        ];
        let direction = towards[0].atan2(-towards[1]);
        let off = (direction - turn).sin().abs();
        assert!(off < 0.15, "tip points to {direction}, not {turn}");
        let polygon = GrayImage::from_fn(240, 360, |x, y| {
            let p = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            Luma([if contains(&truth.contour, p) { 255 } else { 0 }])
        });
        let share = dice(&polygon, &truth.mask);
        assert!(share > 0.96, "outline and mask agree to {share}");
        for pixel in [[50.0, 60.0], [120.5, 180.5]] {
            let there = truth.pose.pixel(truth.pose.uv(pixel));
            assert!((there[0] - pixel[0]).hypot(there[1] - pixel[1]) < 1e-6);
        }
    }
}

fn contains(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a[1] > y) != (b[1] > y) {
            inside ^= x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        }
    }
    inside
}

/// Measures of a truth that was displaced by a known amount.
#[test]
fn measures_see_displacements() {
    let truth = take("eagle_secondary", &small()).truth;
    let shifted = GrayImage::from_fn(240, 360, |x, y| *truth.mask.get_pixel((x + 3).min(239), y));
    assert_eq!(dice(&truth.mask, &truth.mask), 1.0);
    let area = truth.mask.iter().filter(|&&v| v > 0).count() as f64;
    let rows = (0..360)
        .filter(|&y| (0..240).any(|x| truth.mask.get_pixel(x, y).0[0] > 0))
        .count() as f64;
    // Each row loses three pixels, and a little more at its splits.
    let expected = 1.0 - 3.0 * rows / area;
    let found = dice(&truth.mask, &shifted);
    assert!(
        (found - expected).abs() < 0.02,
        "{found} against {expected}"
    );

    let moved: Vec<_> = truth.rachis.iter().map(|p| [p[0] + 3.6, p[1]]).collect();
    let off = line_distance(&truth.rachis, &moved, 360.0);
    assert!((off - 0.01).abs() < 0.0005, "{off}");
    let short = line_distance(&truth.rachis, &truth.rachis[..200], 360.0);
    assert!(short > 0.004, "a missing tip went unseen: {short}");

    let own = albedo(&truth, |pixel| Some(truth.albedo(pixel)));
    assert!(own.rms.expect("plain places") < 1e-6);
    assert!(own.edges.expect("bars") < 0.05, "{own:?}");
    let grey = albedo(&truth, |pixel| Some(truth.albedo(pixel).map(|c| c + 0.04)));
    assert!((grey.rms.expect("plain places") - 0.04).abs() < 1e-4);
    let dragged = albedo(&truth, |[x, y]| Some(truth.albedo([x, y + 2.0])));
    let off = dragged.edges.expect("bars");
    assert!((1.2..2.3).contains(&off), "{off}");
    let flat = albedo(&truth, |_| Some([0.3; 3]));
    assert_eq!(flat.lost, 1.0);
}

/// A slice of the photographs that `photo_charts` reports on, every `step`th of 24: every fifth preset, small enough to take moments.
fn slice(step: u64) -> Vec<Case> {
    let feathers = plumage_tests::shipped::photographed();
    (0..24 / step)
        .into_par_iter()
        .map(|i| {
            let i = i * step;
            let feather = &feathers[(i as usize * 5) % feathers.len()];
            let mut setting = Setting::random(feather, 1000 + i);
            let longest = setting.size[0].max(setting.size[1]);
            setting.size = setting.size.map(|side| side * 480 / longest);
            let settings = ExtractSettings {
                resolution: 640,
                ..settings(feather, &setting)
            };
            run(i, feather, &setting, &settings)
        })
        .collect()
}

fn check_slice(step: u64) {
    let cases = slice(step);
    let report = Report::of(&cases);
    report.print();
    for case in &cases {
        println!(
            "{} {} {:?}: Dice {:.3}, rachis {:.4}",
            case.index,
            case.name,
            case.setting.background,
            case.dice(),
            case.rachis()
        );
    }
    assert!(
        report.dice.median >= 0.985,
        "Dice {:.4}",
        report.dice.median
    );
    assert!(
        report.rachis.mean <= 0.003,
        "rachis {:.4}",
        report.rachis.mean
    );
    assert!(report.angle.mean <= 4.0, "angle {:.2}", report.angle.mean);
    assert!(
        report.albedo.mean <= 0.03,
        "albedo {:.4}",
        report.albedo.mean
    );
    assert!(report.edges.mean <= 2.0, "edges {:.2}", report.edges.mean);
    assert_eq!(report.refused, 0);
}

#[test]
fn extraction_of_a_slice() {
    check_slice(3);
}

#[test]
#[ignore = "minutes: `make test-long`"]
fn extraction_of_a_whole_slice() {
    check_slice(1);
}

/// The targets for outline and shaft over the whole range, on photographs at their own size that no parameter was tuned on; as
/// `photo_charts --corpus FOLDER 500 200000`.
#[test]
#[ignore = "many minutes: `make test-long`"]
fn outline_over_the_whole_range() {
    let cases: Vec<Case> = (200_000..200_500)
        .into_par_iter()
        .map(|index| {
            let (feather, setting) = random_case(index);
            run(index, &feather, &setting, &settings(&feather, &setting))
        })
        .collect();
    let report = Report::of(&cases);
    report.print();
    assert!(report.dice.mean >= 0.985, "Dice {:.4}", report.dice.mean);
    assert!(report.dice.low >= 0.96, "Dice {:.4}", report.dice.low);
    assert!(
        report.rachis.mean <= 0.003,
        "rachis {:.4}",
        report.rachis.mean
    );
    assert!(
        report.rachis.high <= 0.008,
        "rachis {:.4}",
        report.rachis.high
    );
}
