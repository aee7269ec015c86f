//! Shapes: the lobes against traced rays, and reflectance plots after Chen et al. 2026, Fig. 11.

use super::{direction, shade, structural};
use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::TracedFibre;
use plumage_tools::plot::{Curve, Labels, Result, draw, polar};
use plumage_tools::presets;
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, path::Path};

/// The cosine series against rays through a fibre.
pub fn azimuth(folder: &Path) -> Result<()> {
    let mut random = Pcg64Mcg::new(1);
    let bins = 120;
    for core in [0.5, 0.8] {
        let traced = TracedFibre {
            inner: core,
            mirror: Some(1.0),
            normal_spread: 0.15,
            ..TracedFibre::clear(1.55)
        };
        let histogram = traced.histogram(0.0, 0.0, 400_000, bins, &mut random);
        let s = shade(&structural(core as f32), 0.0);
        let row = FibreTable::build(&structural(core as f32)).row(1.0);
        let place = |i: usize| -PI + 2.0 * PI * (i as f64 + 0.5) / bins as f64;
        let truth = (0..bins)
            .map(|i| (place(i), histogram.iter().map(|lobe| lobe[i]).sum()))
            .collect();
        let model = |phi: f64| {
            [(0, 0), (1, 1), (2, 3), (3, 4)]
                .iter()
                .map(|&(lobe, series)| row[0][lobe] * azimuthal(&s.series[series], phi.cos()))
                .sum::<f64>()
                / (2.0 * PI)
        };
        let curves = [
            ("traced rays".into(), truth),
            (
                "cosine series".into(),
                (0..bins).map(|i| (place(i), model(place(i)))).collect(),
            ),
        ];
        let file = folder.join(format!(
            "scattering_azimuth_{:02}.svg",
            (core * 10.0_f64).round()
        ));
        let title = format!("Light around a white structural fibre, core {core}, broadside");
        let labels = Labels {
            title: &title,
            x: "phi (radians)",
            y: "density per radian",
        };
        draw(&file, &labels, [false; 2], &curves)?;
    }
    Ok(())
}

/// K around a barb and a barbule, structural against pigment, seen from the front and from the back.
pub fn reflectance(folder: &Path) -> Result<()> {
    let optics = presets::by_name("macaw_blue")
        .map(|f| f.optics)
        .unwrap_or_default();
    let albedo = [0.04, 0.12, 0.45];
    let mirror = FibreKind::Structural { core_radius: 0.8 };
    let medulla = Fibre::default().kind;
    let mut panels = Vec::new();
    for (name, fibre) in [("barb", optics.barb), ("distal barbule", optics.distal)] {
        // Azimuth of the eye from the outward normal, and its inclination.
        for (side, eye) in [("front", 0.5), ("back", PI - 0.5)] {
            let mut curves: Vec<Curve> = Vec::new();
            for (kind_name, kind) in [("structural", mirror), ("pigment", medulla)] {
                let table = FibreTable::build(&Fibre { kind, ..fibre });
                let theta = 0.25_f64;
                let s = fibre_shading(
                    &table.fibre(),
                    &table.row(theta.cos()),
                    albedo,
                    direction(theta, eye),
                    1.0,
                    8,
                );
                for (channel, channel_name) in [(2, "blue"), (0, "red")] {
                    let points = (0..=180).map(|i| {
                        let phi = 2.0 * PI * f64::from(i) / 180.0;
                        // Up in the picture is out of the front of the vane.
                        (
                            0.5 * PI - phi,
                            fibre_evaluate(&s, direction(-theta, phi))[channel],
                        )
                    });
                    curves.push((format!("{kind_name}, {channel_name}"), points.collect()));
                }
            }
            let degrees = if side == "front" { 29 } else { 151 };
            panels.push((
                format!("{name}, eye on the {side} ({degrees} degrees from the normal)"),
                curves,
            ));
        }
    }
    let labels = Labels {
        title: "K around a blue fibre by the light's azimuth (up: out of the front)",
        x: "angle (radians)",
        y: "K per steradian",
    };
    polar(&folder.join("scattering_reflectance.svg"), &labels, &panels)
}
