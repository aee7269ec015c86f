//! Files of version 1 are still read, and mean what they meant.

use bevy_plumage::anatomy::{Down, Feather};
use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::groom::*;
use plumage_tests::shipped;

fn read<A: RonAsset>(file: &str) -> A {
    A::from_ron(&bytes(file), file).unwrap_or_else(|error| panic!("{error}"))
}

fn bytes(file: &str) -> Vec<u8> {
    let path = plumage_tests::root().join("tests/assets").join(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A file of version 1.
fn old<A: RonAsset>(file: &str) -> A {
    read(&format!("v1/{file}"))
}

#[test]
fn feathers_of_version_1_are_those_of_version_2() {
    // The first has bars and a back, the second a rim.
    for name in ["eagle_primary", "eagle_contour"] {
        let feather: Feather = old(&format!("{name}.feather.ron"));
        assert_eq!(feather, read(&format!("v2/{name}.feather.ron")));
        assert_eq!(feather.version, Feather::VERSION);
    }
}

#[test]
fn downs_of_version_1_are_the_ones_shipped() {
    let down: Down = old("chick.down.ron");
    assert_eq!(down, shipped::read::<Down>("downs/chick.down.ron"));
    // What a file leaves out is as it was.
    let empty = Down::from_ron(b"(version: 1)", "empty").unwrap();
    assert_eq!(empty, Down::default());
}

#[test]
fn a_groom_of_version_1_keeps_every_value() {
    let mut back = Region::new("back");
    back.select = Select::Every(vec![
        Select::Any(vec![
            Select::Tract(1),
            Select::Color {
                color: [0.5, 0.25, 0.0],
                distance: 0.125,
            },
            Select::Nearest {
                color: [1.0, 0.0, 0.0],
                others: vec![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            },
        ]),
        Select::Within {
            low: [-1.0, -2.0, -3.0],
            high: [1.0, 2.0, 3.0],
        },
        Select::Not(vec![Select::Joints(vec!["wing_L".into()])]),
        Select::Not(vec![Select::Tract(2), Select::Tract(3)]),
    ]);
    back.feather = 1;
    back.count = 30;
    back.placement = Placement::Rows(5);
    back.length = Span(16.0, 26.0);
    back.width = Span(9.0, 14.0);
    back.lift = Span(9.0, 8.0);
    back.camber = 0.07;
    back.curl = 8.0;
    back.stiffness = 0.25;
    back.layer = 5.0;
    back.segments = Segments::new(6, 3);
    back.tint = Tint([0.7, 0.1, 0.1], [0.2, 0.3, 0.8]);
    back.down = Some("../c.down.ron".into());
    let mut guide = Guide::new([[0.0, 60.0, 40.0], [0.0, 60.0, -40.0]]);
    guide.mirror = true;
    guide.regions = vec!["back".into()];
    let up = [0.0, 1.0, 0.0];
    let mut first = Station::new(0.0, [50.0, 10.0, 10.0], [0.1, 0.0, -1.0], up);
    first.ride = vec![JointWeight::new("wing_L", 1.0)];
    first.follow = vec![
        JointWeight::new("root", 0.75),
        JointWeight::new("wing_L", 0.25),
    ];
    let last = Station::new(1.0, [110.0, 10.0, 30.0], [0.8, 0.0, -0.6], up);
    let mut row = Row::new("remiges", vec![60.0, 64.0], vec![first, last]);
    row.width = Span(18.0, 12.0);
    row.mirror = true;
    row.lift = Span(1.0, 2.0);
    row.camber = 0.06;
    row.curl = 6.0;
    row.layer = Span(3.0, 2.0);
    row.offset = 0.8;
    row.segments = Segments::new(5, 4);
    row.tint = Tint([0.1, 0.2, 0.6], [0.1, 0.2, 0.6]);
    row.jitter.yaw = 0.5;
    let mut dab = Dab::new([1.0, 2.0, 3.0], 4.0);
    (dab.density, dab.length) = (0.5, 2.0);
    let mut groom = Groom::default();
    groom.name = "small".into();
    groom.feathers = vec!["a.feather.ron".into(), "../b.feather.ron".into()];
    groom.regions = vec![back];
    groom.guides = vec![guide];
    groom.rows = vec![row];
    groom.paint = vec![dab];
    assert_eq!(old::<Groom>("small.groom.ron"), groom);
    let text = groom.to_ron().unwrap();
    assert!(text.starts_with("(\n    version: 2,"), "{text}");
    assert_eq!(Groom::from_ron(text.as_bytes(), "new").unwrap(), groom);
}

#[test]
fn damage_in_an_old_file_has_a_place_and_a_range() {
    let text = String::from_utf8(bytes("v1/small.groom.ron")).unwrap();
    let odd = text.replacen("unit:", "units:", 1);
    let error = Groom::from_ron(odd.as_bytes(), "x").unwrap_err();
    assert!(
        matches!(error, AssetError::Syntax { line: 4, .. }),
        "{error}"
    );
    let wide = text.replacen("(6, 3)", "(6, 33)", 1);
    let error = Groom::from_ron(wide.as_bytes(), "x")
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "x: `regions[0].segments.across` is 33, allowed is 1 to 16"
    );
}
