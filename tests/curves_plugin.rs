//! The plugin's picture of a feather against the same feather with every fibre as a curve, in linear colour.

mod curves_common;

use bevy_plumage::{
    curves::{CurveOptions, Curves, Visibility},
    prelude::FeatherSettings,
};
use curves_common::{Difference, Studio, View, distances, feather, lights, references};

#[test]
fn the_plugin_shows_what_explicit_curves_show() {
    let size = 48;
    let feather = feather("macaw_lesser");
    let settings = FeatherSettings {
        multiple_scattering: 0.0,
        shelter: 0.0,
        ..FeatherSettings::default()
    };
    let Some(mut studio) = Studio::new(feather.clone(), size, settings) else {
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
            let d = Difference::of(&shown, &references(&feather, &curves, &view, rays, 4));
            let bias = if light == "low" { 0.13 } else { 0.06 };
            assert!(
                d.of_range() < 0.06 && d.bias.abs() < bias,
                "{distance}, {light}, traced shadows: {d:?}"
            );
            let truth = references(&feather, &curves, &view, CurveOptions::default(), 5);
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
