//! What thin layers cost: the same feather with and without them, frames in turn, in one run.

use super::headless::frame;
use bevy::{diagnostic::DiagnosticsStore, prelude::*, render::renderer::RenderAdapterInfo};
use cpu_time::ProcessTime;

/// A card that is timed; `true`: with its thin layers.
#[derive(Component)]
pub struct Timed(pub bool);

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

/// Frames after a change of what is shown until every pass draws it.
const SETTLE: usize = 2;

/// Processor seconds of one frame, with every thread that draws it.
fn seconds(app: &mut App) -> f64 {
    let start = ProcessTime::now();
    frame(app);
    start.elapsed().as_secs_f64()
}

/// The least: what other programs do to the caches only adds.
fn least(list: &[f64]) -> f64 {
    list.iter().copied().fold(f64::NAN, f64::min)
}

/// Processor time of whole frames over `rounds` rounds of: no feather, without layers, with layers (the last two change places every
/// round). Prints the least of each, and the difference.
///
/// On a software renderer this is the cost of shading. Wall time is not: there it follows what else the machine does. On a GPU's adapter
/// this says nothing, and the printed line names the adapter.
pub fn run(app: &mut App, rounds: u32, name: &str) {
    let mut times: [Vec<f64>; 3] = Default::default();
    let mut classes = bevy_plumage::CARD_COUNTERS.map(|_| 0.0);
    for round in 0..=rounds {
        let order = if round % 2 == 0 { [0, 1, 2] } else { [0, 2, 1] };
        for state in order {
            show(app, [None, Some(false), Some(true)][state]);
            for _ in 0..SETTLE {
                frame(app);
            }
            // The first round fills caches and makes pipelines.
            let time = seconds(app);
            if round > 0 {
                times[state].push(time);
            }
            if state == 2 {
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
    let [none, without, with] = times.each_ref().map(|list| 1e3 * least(list));
    let adapter = &app.world().resource::<RenderAdapterInfo>().name;
    println!(
        "{name}: least of {rounds} frames each on {adapter}, processor time: nothing {none:.1} ms, feather {without:.1} ms, with thin \
         layers {with:.1} ms: {:+.1} % of the feather's own time; cards: {}",
        100.0 * (with - without) / (without - none),
        cards.join(", "),
    );
}
