//! Polar plot of a fibre's lobes around its cross-section.

use crate::maths::scattering::{FIBRE_HARMONICS, Fibre, FibreTable, fibre_evaluate, fibre_shading};
use bevy_egui::egui;
use egui_plot::{Line, Plot, PlotPoints};
use std::f64::consts::{PI, TAU};

/// Steps around the fibre.
const STEPS: usize = 180;

/// Radiance scattered towards an eye at inclination `eye` (radians) over the azimuth of the light, RGB; the eye is above.
/// Points are (x, y) with the length K and the direction of the light.
pub fn lobe_points(fibre: &Fibre, albedo: [f32; 3], eye: f32) -> [Vec<[f64; 2]>; 3] {
    let table = FibreTable::build(fibre);
    let eye = f64::from(eye);
    let omega_o = [eye.sin(), 0.0, eye.cos()];
    let shading = fibre_shading(
        &table.fibre(),
        &table.row(eye.cos()),
        albedo.map(f64::from),
        omega_o,
        0.0,
        FIBRE_HARMONICS as u32,
    );
    let mut points: [Vec<[f64; 2]>; 3] = Default::default();
    for step in 0..=STEPS {
        let phi = TAU * step as f64 / STEPS as f64 - PI;
        let (sin, cos) = phi.sin_cos();
        let omega_i = [-omega_o[0], sin * eye.cos(), cos * eye.cos()];
        let value = fibre_evaluate(&shading, omega_i);
        for (channel, line) in points.iter_mut().enumerate() {
            line.push([value[channel] * sin, value[channel] * cos]);
        }
    }
    points
}

/// Draws the plot.
pub fn lobe_plot(ui: &mut egui::Ui, fibre: &Fibre, albedo: [f32; 3], eye: f32) {
    let colors = [
        egui::Color32::from_rgb(230, 90, 80),
        egui::Color32::from_rgb(90, 190, 90),
        egui::Color32::from_rgb(90, 140, 240),
    ];
    Plot::new("lobes")
        .height(150.0)
        .data_aspect(1.0)
        .show_axes(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .show(ui, |plot| {
            for ((points, color), name) in lobe_points(fibre, albedo, eye)
                .into_iter()
                .zip(colors)
                .zip(["red", "green", "blue"])
            {
                plot.line(Line::new(name, PlotPoints::from(points)).color(color));
            }
        })
        .response
        .on_hover_text(
            "Light scattered to the eye (above) by the direction of the light around the fibre",
        );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lobes_are_finite_and_closed() {
        for eye in [-1.4, 0.0, 0.7] {
            for line in lobe_points(&Fibre::default(), [0.2, 0.5, 0.8], eye) {
                assert!(line.iter().flatten().all(|x| x.is_finite()));
                let (first, last) = (line[0], line[STEPS]);
                assert!((first[0] - last[0]).hypot(first[1] - last[1]) < 1e-6);
                assert!(line.iter().any(|p| p[0].hypot(p[1]) > 1e-3));
            }
        }
    }
}
