//! What thin layers cost: the same feather with and without them, frames in turn, in one run.

use super::headless::frame;
use bevy::{diagnostic::DiagnosticsStore, prelude::*, render::renderer::RenderAdapterInfo};

/// A card that is timed; `true`: with its thin layers.
#[derive(Component)]
pub struct Timed(pub bool);

/// Frames until a timestamp has come back from the GPU.
const LAG: usize = 3;

fn show(app: &mut App, layers: Option<bool>) {
    let mut cards = app.world_mut().query::<(&Timed, &mut Visibility)>();
    for (timed, mut visibility) in cards.iter_mut(app.world_mut()) {
        *visibility = if layers == Some(timed.0) {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        };
    }
}

/// Cards of a class in the last count that has come back.
fn cards_of(app: &App, class: &str) -> f64 {
    let store = app.world().resource::<DiagnosticsStore>();
    let path = format!("render/feather_cards_{class}");
    let found = store.iter().find(|d| d.path().as_str() == path);
    found.and_then(|d| d.value()).unwrap_or(0.0)
}

/// Milliseconds that the GPU spent in the pass with the feathers, of the last frame that has come back.
fn pass_ms(app: &App) -> Option<f64> {
    let store = app.world().resource::<DiagnosticsStore>();
    let path = "render/main_opaque_pass_3d/elapsed_gpu";
    store.iter().find(|d| d.path().as_str() == path)?.value()
}

/// The least: what other programs take of a machine only adds.
fn least(list: &[f64]) -> f64 {
    list.iter().copied().fold(f64::NAN, f64::min)
}

/// Times `rounds` rounds of: no feather, without layers, with layers. Prints the least times of the pass that draws
/// feathers.
pub fn run(app: &mut App, rounds: u32, name: &str) {
    let states = [None, Some(false), Some(true)];
    let mut times: [Vec<f64>; 3] = Default::default();
    let mut classes = bevy_plumage::CARD_COUNTERS.map(|_| 0.0);
    for round in 0..=rounds {
        for (state, times) in states.iter().zip(&mut times) {
            show(app, *state);
            for _ in 0..=LAG {
                frame(app);
            }
            // The first round fills caches and makes pipelines.
            if round > 0 {
                times.extend(pass_ms(app));
            }
            if *state == Some(true) {
                classes = bevy_plumage::CARD_COUNTERS.map(|name| cards_of(app, name));
            }
        }
    }
    let cards: Vec<String> = bevy_plumage::CARD_COUNTERS
        .iter()
        .zip(&classes)
        .filter(|(_, count)| **count > 0.0)
        .map(|(name, count)| format!("{count} {name}"))
        .collect();
    let [none, without, with] = times.each_ref().map(|list| least(list));
    let adapter = &app.world().resource::<RenderAdapterInfo>().name;
    println!(
        "{name}: least of {rounds} passes each on {adapter}: nothing {none:.2} ms, feather {without:.2} ms, with thin layers \
         {with:.2} ms: {:+.1} % of the feather's own time; cards: {}",
        100.0 * (with - without) / (without - none),
        cards.join(", "),
    );
}
