//! Thin layers in a feather's file.

use bevy_plumage::anatomy::Feather;
use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::maths::scattering::interference::{Iridescence, ScaleMap, Structure};
use plumage_tests::shipped;

fn shimmering() -> String {
    let mut feather = shipped::feather("contour");
    feather.iridescence = Some(Iridescence::default());
    feather.to_ron().expect("text")
}

/// Thickness over the card: what may stand there.
#[test]
fn a_map_of_thickness_is_read_back_and_checked() {
    let mut feather = shipped::feather("contour");
    feather.iridescence = Some(Iridescence::default());
    feather.iridescence_scale = Some(ScaleMap {
        columns: 2,
        factors: vec![0.8, 1.0, 1.2, 1.4],
    });
    let text = feather.to_ron().expect("text");
    let back = Feather::from_ron(text.as_bytes(), "x").expect("read back");
    assert_eq!(back, feather);
    let at = |from: &str| text.find(from).unwrap_or_else(|| panic!("{from}: {text}"));
    let map = &text[at("iridescence_scale")..];
    let cases = [
        (
            "0.8, 1.0",
            "0.5, 1.0",
            "iridescence_scale.factors[0]` is 0.5, allowed is 0.6 to 1.6",
        ),
        (
            "1.2, 1.4",
            "1.2, NaN",
            "iridescence_scale.factors[3]` is NaN, allowed is 0.6 to 1.6",
        ),
        (
            "columns: 2",
            "columns: 0",
            "iridescence_scale.columns` is 0, allowed is 1 to 64",
        ),
        (
            "columns: 2",
            "columns: 10000",
            "iridescence_scale.columns` is 10000, allowed is 1 to 64",
        ),
        (
            "columns: 2",
            "columns: 3",
            "iridescence_scale.factors` is 4 long, allowed is 1 to 64 rows of 3",
        ),
    ];
    for (good, bad, wanted) in cases {
        assert!(map.contains(good), "{good}: {map}");
        let damaged = text.replace(map, &map.replace(good, bad));
        let error = Feather::from_ron(damaged.as_bytes(), "x.feather.ron").expect_err(bad);
        assert!(matches!(error, AssetError::Value { .. }), "{error}");
        assert_eq!(error.to_string(), format!("x.feather.ron: `{wanted}"));
    }
}

#[test]
fn files_without_layers_stay_as_they_are() {
    let feather = shipped::feather("contour");
    assert_eq!(feather.iridescence, None);
    let text = feather.to_ron().expect("text");
    assert!(!text.contains("iridescence"), "{text}");
    // One that shimmers but says nothing of a map has none.
    let plain = Feather::from_ron(shimmering().as_bytes(), "x").expect("read");
    assert_eq!(plain.iridescence_scale, None);
}

#[test]
fn layers_are_written_and_read_back() {
    for (name, stack) in shipped::stacks() {
        let mut feather = shipped::feather("contour");
        feather.iridescence = Some(stack);
        let text = feather.to_ron().expect("text");
        let back = Feather::from_ron(text.as_bytes(), &name).expect("read back");
        assert_eq!(back, feather, "{name}");
    }
    // What is left out is as documented.
    let text = shipped::feather("contour").to_ron().expect("text");
    let end = text.trim_end().trim_end_matches(')');
    let short = format!("{end}    iridescence: Some((structure: Film, cortex_nm: 530.0)),\n)");
    let feather = Feather::from_ron(short.as_bytes(), "short");
    let wanted = Iridescence {
        structure: Structure::Film,
        cortex_nm: 530.0,
        ..Iridescence::default()
    };
    assert_eq!(feather.expect("read").iridescence, Some(wanted));
}

#[test]
fn bad_layers_are_named_with_their_range() {
    let text = shimmering();
    let cases = [
        (
            "cortex_nm: 120.0",
            "cortex_nm: -1.0",
            "cortex_nm` is -1, allowed is 0 to 2500",
        ),
        (
            "layers: 8",
            "layers: 10000",
            "layers` is 10000, allowed is 0 to 24",
        ),
        (
            "melanosome_nm: 120.0",
            "melanosome_nm: NaN",
            "melanosome_nm` is NaN, allowed is 20 to 400",
        ),
        (
            "gap_nm: 40.0",
            "gap_nm: -61.0",
            "gap_nm` is -61, allowed is -60 to 400",
        ),
        ("fill: 0.85", "fill: 0.0", "fill` is 0, allowed is 0.2 to 1"),
        (
            "flatness: 0.4",
            "flatness: inf",
            "flatness` is inf, allowed is 0.05 to 1",
        ),
        (
            "slope: 8.0",
            "slope: 90.0",
            "slope` is 90, allowed is 2 to 20",
        ),
        (
            "scale: 1.0",
            "scale: 0.0",
            "scale` is 0, allowed is 0.6 to 1.6",
        ),
    ];
    for (good, bad, wanted) in cases {
        assert!(text.contains(good), "{good}: {text}");
        let damaged = text.replace(good, bad);
        let error = Feather::from_ron(damaged.as_bytes(), "x.feather.ron").expect_err(bad);
        assert!(matches!(error, AssetError::Value { .. }), "{error}");
        let wanted = format!("x.feather.ron: `iridescence.{wanted}");
        assert_eq!(error.to_string(), wanted);
    }
    let odd = text.replace("structure: SolidRods", "structure: Rubber");
    let error = Feather::from_ron(odd.as_bytes(), "x.feather.ron").expect_err("a structure");
    assert!(
        matches!(error, AssetError::Syntax { line, .. } if line > 0),
        "{error}"
    );
}
