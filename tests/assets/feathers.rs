//! The checked-in feathers, and what the reader makes of damaged bytes.

use bevy_plumage::anatomy::{Feather, Side};
use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::maths::query::{mask_vane, mean_coverage};
use proptest::prelude::*;
use std::fs;

fn assets() -> std::path::PathBuf {
    plumage_tests::asset("feathers")
}

#[test]
fn every_file_is_known_and_written_as_it_is_read() {
    for feather in plumage_tests::shipped::feathers() {
        let path = assets().join(format!("{}.feather.ron", feather.name));
        let text =
            fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(
            text.replace("\r\n", "\n"),
            feather.to_ron().expect("text"),
            "{} differs: run make feathers",
            path.display()
        );
    }
    let files = fs::read_dir(assets())
        .expect("the folder")
        .filter_map(Result::ok)
        .filter(|entry| {
            entry
                .file_name()
                .to_string_lossy()
                .ends_with(".feather.ron")
        })
        .count();
    assert_eq!(files, plumage_tests::shipped::FEATHERS.len());
}

/// Half open vanes of belly, flanks and legs, down, bristles, and feathers of a facial disc.
const OPEN: [&str; 16] = [
    "macaw_soft",
    "macaw_leg",
    "macaw_semiplume",
    "eagle_soft",
    "eagle_semiplume",
    "eagle_trouser",
    "eagle_tarsal",
    "semiplume",
    "down",
    "filoplume",
    "owl_disc",
    "owl_soft",
    "owl_semiplume",
    "owl_leg",
    "owl_tarsal",
    "peacock_eye",
];

/// Three families of fibres that know nothing of each other leave the product of their gaps open.
#[test]
fn vanes_close() {
    for feather in plumage_tests::shipped::feathers() {
        for side in [Side::Left, Side::Right] {
            let vane = feather.vane(side);
            let pitch =
                1e3 * feather.length_mm / vane.barb_count * vane.barb_angle.to_radians().sin();
            let period = vane.barbules.spacing_um * vane.barbules.angle.to_radians().sin();
            let gap = |radius: f32, period: f32| (1.0 - 2.0 * radius / period).max(0.0);
            let open = gap(vane.barb_radius_um, pitch)
                * gap(vane.barbules.distal_radius_um, period)
                * gap(vane.barbules.proximal_radius_um, period);
            let cell = mask_vane(&feather.query_vane::<f32>(side), [0.0, 0.0, 1.0]);
            let covered: f32 = mean_coverage(&cell).iter().sum();
            assert!(
                (covered - (1.0 - open)).abs() < 5e-3,
                "{}: {covered}, {open} open",
                feather.name
            );
            if !OPEN.contains(&feather.name.as_str()) {
                assert!(covered >= 0.95, "{}: covers {covered}", feather.name);
            }
        }
    }
}

#[test]
fn every_feather_that_a_shipped_groom_wears_is_there() {
    let grooms = plumage_tests::asset("grooms");
    for entry in fs::read_dir(&grooms).expect("the folder") {
        let entry = entry.expect("an entry");
        let text = fs::read_to_string(entry.path()).expect("text");
        for name in text
            .split('"')
            .filter(|part| part.ends_with(".feather.ron"))
        {
            assert!(
                grooms.join(name).exists(),
                "{}: {name}",
                entry.path().display()
            );
        }
    }
}

#[test]
fn a_written_file_is_whole_and_the_old_one_survives_a_failure() {
    let folder = std::env::temp_dir().join(format!("feather_{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("x.feather.ron");
    let mut feather = plumage_tests::shipped::feather("contour");
    feather.write(&path).expect("written");
    assert_eq!(
        Feather::from_ron(&fs::read(&path).expect("bytes"), "x").expect("read back"),
        feather
    );
    feather.length_mm = f32::NAN;
    let error = feather.write(&path).expect_err("not a number");
    assert!(
        error
            .to_string()
            .contains("x.feather.ron: `length_mm` is NaN"),
        "{error}"
    );
    assert!(Feather::from_ron(&fs::read(&path).expect("bytes"), "x").is_ok());
    assert_eq!(
        fs::read_dir(&folder).expect("the folder").count(),
        1,
        "a leftover"
    );
    let missing = plumage_tests::shipped::feather("contour").write(&folder.join("no/x.ron"));
    assert!(matches!(missing, Err(AssetError::Write { .. })));
    fs::remove_dir_all(&folder).expect("removed");
}

/// Whatever the reader accepts must be usable: finite tables of the right length, coverage weights in range.
fn accepted_is_sound(bytes: &[u8]) {
    if let Ok(feather) = Feather::from_ron(bytes, "fuzz") {
        feather.validate("fuzz").expect("valid after reading");
        let table = feather.shape_table();
        assert!(
            table
                .rachis
                .iter()
                .chain(&table.contour)
                .flatten()
                .all(|x| x.is_finite())
        );
        assert_eq!(feather.albedo.front.bake(4, 8, &feather).len(), 128);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_do_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        accepted_is_sound(&bytes);
    }

    #[test]
    fn random_brackets_do_not_panic(text in "[()\\[\\]{},:\"a-z0-9 .-]{0,600}") {
        accepted_is_sound(format!("({text})").as_bytes());
    }

    #[test]
    fn truncated_files_are_refused(cut in 0.0f64..1.0) {
        let text = plumage_tests::shipped::feather("macaw_head").to_ron().expect("text");
        let end = (text.len() as f64 * cut) as usize;
        // Only the last line break may be missing.
        let end = end.min(text.trim_end().len() - 1);
        prop_assert!(Feather::from_ron(&text.as_bytes()[..end], "cut").is_err());
    }

    #[test]
    fn mutated_files_do_not_panic(
        edits in proptest::collection::vec((0.0f64..1.0, any::<u8>()), 1..6),
        number in proptest::option::of((0.0f64..1.0, prop::sample::select(vec![
            "NaN", "inf", "-inf", "-0.0", "1e38", "-1e38", "1e-45", "4294967296", "-1", "0", "0.0", "1.0", "None", "[]", "()",
        ]))),
    ) {
        let text = plumage_tests::shipped::feather("eagle_contour").to_ron().expect("text");
        let mut bytes = text.clone().into_bytes();
        if let Some((place, number)) = number {
            // Replace one whole number by another.
            let starts: Vec<usize> = text.match_indices([' ', '(', '[']).map(|(i, _)| i + 1).collect();
            let start = starts[((starts.len() - 1) as f64 * place) as usize];
            let end = text[start..].find([',', ')', ']', '\n']).map_or(text.len(), |i| start + i);
            bytes.splice(start..end, number.bytes());
        } else {
            for (place, byte) in edits {
                let i = ((bytes.len() - 1) as f64 * place) as usize;
                bytes[i] = byte;
            }
        }
        accepted_is_sound(&bytes);
    }
}

#[test]
fn deep_nesting_is_an_error_not_a_stack_overflow() {
    for open in ["(", "[", "Some(", "{a:"] {
        let bytes = format!("(version: 1, name: {}", open.repeat(200_000));
        assert!(Feather::from_ron(bytes.as_bytes(), "deep").is_err());
    }
}
