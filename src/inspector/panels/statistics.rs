//! Feathers, cards per LOD, time per pass with a running plot, memory.

use crate::render::{CARD_COUNTERS, PlumageMemory};
use bevy_egui::egui;
use egui_plot::{Line, Plot, PlotPoints};
use std::collections::{BTreeMap, VecDeque};

/// Frames that the plot remembers.
const FRAMES: usize = 240;

/// What one frame measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Cards per class, in the order of [`CARD_COUNTERS`].
    pub cards: [u64; CARD_COUNTERS.len()],
    /// GPU time per pass, milliseconds.
    pub passes: Vec<(String, f64)>,
    /// Time between frames, milliseconds.
    pub frame_ms: f64,
    /// Feathers of all birds.
    pub feathers: u64,
    /// Triangles of all birds.
    pub triangles: u64,
    /// Time the last groom took, milliseconds.
    pub groom_ms: f32,
    /// Bytes on the GPU.
    pub memory: PlumageMemory,
    /// What the birds say is wrong.
    pub errors: Vec<String>,
}

/// The last frames.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    now: Sample,
    frame: VecDeque<f64>,
    passes: BTreeMap<String, VecDeque<f64>>,
}

impl Statistics {
    /// Takes one frame in.
    pub fn push(&mut self, sample: Sample) {
        fn keep(line: &mut VecDeque<f64>, value: f64) {
            line.push_back(if value.is_finite() { value } else { 0.0 });
            while line.len() > FRAMES {
                line.pop_front();
            }
        }
        keep(&mut self.frame, sample.frame_ms);
        for (name, value) in &sample.passes {
            keep(self.passes.entry(name.clone()).or_default(), *value);
        }
        // A frame in which no camera looked at a bird says nothing of its cards.
        let cards = match sample.cards.iter().all(|count| *count == 0) && sample.feathers > 0 {
            true => self.now.cards,
            false => sample.cards,
        };
        self.now = Sample { cards, ..sample };
    }

    /// The passes that took most time over the last frames, at most three.
    fn dearest(&self) -> impl Iterator<Item = (&String, &VecDeque<f64>)> {
        let mut passes: Vec<_> = self.passes.iter().collect();
        let sum = |line: &VecDeque<f64>| line.iter().sum::<f64>();
        passes.sort_by(|a, b| sum(b.1).total_cmp(&sum(a.1)));
        passes.into_iter().take(3)
    }

    /// The last frame.
    pub fn now(&self) -> &Sample {
        &self.now
    }
}

/// Draws the numbers and the plot.
pub fn statistics_panel(ui: &mut egui::Ui, statistics: &Statistics) {
    ui.label(format!("Milliseconds per frame, last {FRAMES} frames"));
    let colors = [
        egui::Color32::from_rgb(235, 235, 235),
        egui::Color32::from_rgb(240, 120, 90),
        egui::Color32::from_rgb(110, 200, 110),
        egui::Color32::from_rgb(110, 160, 250),
    ];
    let frame = "frame".to_owned();
    let lines: Vec<_> = std::iter::once((&frame, &statistics.frame))
        .chain(statistics.dearest())
        .zip(colors)
        .collect();
    Plot::new("times")
        .height(170.0)
        .include_y(0.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .show(ui, |plot| {
            for ((name, values), color) in &lines {
                let points: Vec<[f64; 2]> = values
                    .iter()
                    .enumerate()
                    .map(|(i, ms)| [i as f64, *ms])
                    .collect();
                plot.line(Line::new((*name).clone(), PlotPoints::from(points)).color(*color));
            }
        });
    ui.horizontal_wrapped(|ui| {
        for ((name, _), color) in &lines {
            ui.colored_label(
                *color,
                format!("\u{25a0}\u{a0}{}", name.replace('_', "\u{a0}")),
            );
        }
    });
    ui.separator();
    let now = statistics.now();
    egui::Grid::new("counters").num_columns(2).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.monospace(value);
            ui.end_row();
        };
        row("feathers", now.feathers.to_string());
        row("triangles", now.triangles.to_string());
        row("last groom", format!("{:.0} ms", now.groom_ms));
        for (name, count) in CARD_COUNTERS.iter().zip(now.cards) {
            row(&format!("cards {name}"), count.to_string());
        }
        row("frame", format!("{:.2} ms", now.frame_ms));
        for (name, ms) in &now.passes {
            row(&name.replace('_', " "), format!("{ms:.3} ms GPU"));
        }
        let memory = now.memory;
        for (name, bytes) in [
            ("feather tables", memory.feathers),
            ("textures", memory.textures),
            ("card records", memory.cards),
            ("card meshes", memory.meshes),
            ("GPU memory", memory.total()),
        ] {
            row(name, format!("{:.2} MB", bytes as f64 / 1e6));
        }
    });
    for error in &now.errors {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
}
