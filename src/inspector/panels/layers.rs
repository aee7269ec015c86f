//! The color of thin layers over the angle, as a strip that follows the fields.

use crate::maths::scattering::interference::{Iridescence, Stack, in_gamut, stack_colors};
use bevy::{
    color::{ColorToPacked, LinearRgba, Srgba},
    tasks::{AsyncComputeTaskPool, Task, block_on, poll_once},
};
use bevy_egui::egui;
use std::sync::{Arc, Mutex};

/// Angles of incidence that the strip shows, in degrees.
const LAST: f32 = 80.0;
/// Degrees between two colors.
const STEP: f32 = 2.0;
/// The brightest luminance up to this angle is shown as [`BRIGHTEST`].
const EXPOSED: f32 = 60.0;
/// Luminance of the brightest color shown.
const BRIGHTEST: f64 = 0.6;

type Colors = Vec<[f64; 3]>;

/// The strip, and the layers whose colors are on their way.
#[derive(Clone, Debug, Default)]
pub struct Swatch {
    shown: Option<(Iridescence, Colors)>,
    work: Arc<Mutex<Option<(Iridescence, Task<Colors>)>>>,
}

/// Colors from 0 degrees to 80: linear, in gamut, exposed alike whatever the layers reflect.
fn swatch_colors(layers: &Iridescence) -> Colors {
    let cosine = |i: usize| f64::from((i as f32 * STEP).to_radians().cos());
    let cosines: Vec<f64> = (0..=(LAST / STEP) as usize).map(cosine).collect();
    let colors: Colors = stack_colors(&Stack::new(layers), &cosines)
        .into_iter()
        .map(in_gamut)
        .collect();
    let luminance = |c: &[f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let seen = &colors[..=(EXPOSED / STEP) as usize];
    let brightest = seen.iter().map(luminance).fold(1e-6, f64::max);
    let exposed = |c: [f64; 3]| c.map(|x| x * BRIGHTEST / brightest);
    colors.into_iter().map(exposed).collect()
}

impl Swatch {
    /// Draws the strip of these layers, or of the last ones until their colors are there.
    pub fn draw(&mut self, ui: &mut egui::Ui, layers: &Iridescence) {
        if !self.follow(layers) {
            ui.ctx().request_repaint();
        }
        let size = egui::vec2(ui.available_width().min(280.0), 26.0);
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        let painter = ui.painter_at(rect);
        if let Some((_, colors)) = &self.shown {
            let width = rect.width() / colors.len() as f32;
            for (i, [r, g, b]) in colors.iter().enumerate() {
                let linear = LinearRgba::rgb(*r as f32, *g as f32, *b as f32);
                let [r, g, b] = Srgba::from(linear).to_u8_array_no_alpha();
                let left = rect.left() + i as f32 * width;
                let bar = egui::Rect::from_x_y_ranges(left..=left + width + 0.5, rect.y_range());
                painter.rect_filled(bar, 0.0, egui::Color32::from_rgb(r, g, b));
            }
        }
        let angle = |x: f32| ((x - rect.left()) / rect.width()).clamp(0.0, 1.0) * LAST;
        let hint = response.hover_pos().map_or(0.0, |at| angle(at.x));
        response.on_hover_text(format!(
            "Color of the layers from 0 to {LAST:.0}\u{b0} of incidence, each stack exposed alike; here {hint:.0}\u{b0}"
        ));
    }

    /// Starts or fetches what the layers look like; whether the strip shows these.
    fn follow(&mut self, layers: &Iridescence) -> bool {
        let Ok(mut work) = self.work.lock() else {
            return true;
        };
        if let Some((of, task)) = work.as_mut()
            && let Some(colors) = block_on(poll_once(task))
        {
            self.shown = Some((*of, colors));
            *work = None;
        }
        let done = matches!(&self.shown, Some((of, _)) if of.same_layers(layers));
        if !done
            && work.is_none()
            && let Some(pool) = AsyncComputeTaskPool::try_get()
        {
            let layers = *layers;
            *work = Some((layers, pool.spawn(async move { swatch_colors(&layers) })));
        }
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::scattering::interference::{Base, Structure};
    use bevy::tasks::TaskPool;
    use std::time::{Duration, Instant};

    #[test]
    fn the_strip_follows_the_layers() {
        AsyncComputeTaskPool::get_or_init(TaskPool::new);
        let mut film = Iridescence {
            structure: Structure::Film,
            cortex_nm: 595.0,
            base: Base::Air,
            disorder: 0.0,
            ..Iridescence::default()
        };
        let mut swatch = Swatch::default();
        for cortex in [595.0, 530.0] {
            film.cortex_nm = cortex;
            let start = Instant::now();
            while !swatch.follow(&film) && start.elapsed() < Duration::from_secs(60) {
                std::thread::sleep(Duration::from_millis(2));
            }
            let (of, colors) = swatch.shown.clone().expect("colors");
            assert!(of.same_layers(&film));
            assert_eq!(colors, swatch_colors(&film));
            assert_eq!(colors.len(), 41);
            assert!(colors.iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
            // A pigeon's green film is green from the front, its purple one is not.
            let [r, g, b] = colors[0];
            assert_eq!(g > r && g > b, cortex > 560.0, "{r} {g} {b}");
        }
    }
}
