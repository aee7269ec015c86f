//! Things against each other, frames in turn, in one run: a feather with and without thin layers, feathers and plain cards, light in
//! fragments and at vertices.

use super::{
    gpu_clock,
    headless::{Apps, capture, frame, in_software},
    stats,
};
use bevy::{diagnostic::DiagnosticsStore, prelude::*, render::renderer::RenderAdapterInfo};
use bevy_plumage::prelude::*;
use cpu_time::ProcessTime;
use std::{fmt::Write, fs, path::Path};

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
pub const SETTLE: usize = 2;

/// Which time [`seconds`] measures, and on what: where software draws, processor time with every thread that draws (wall time follows
/// what else the machine does), on a GPU its own.
pub fn clock(app: &App) -> String {
    let adapter = app.world().resource::<RenderAdapterInfo>();
    let time = if in_software(adapter) {
        "processor"
    } else {
        "GPU"
    };
    format!("{time} time on {}", adapter.name)
}

/// Seconds of one frame, by the [`clock`] of the adapter; not a number if a GPU has none.
pub fn seconds(app: &mut App) -> f64 {
    let start = ProcessTime::now();
    frame(app);
    if in_software(app.world().resource::<RenderAdapterInfo>()) {
        start.elapsed().as_secs_f64()
    } else {
        gpu_clock::seconds(app).unwrap_or(f64::NAN)
    }
}

/// Quartiles, linearly between the nearest two.
fn quartiles(mut list: Vec<f64>) -> [f64; 3] {
    list.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|share| {
        let at = share * list.len().saturating_sub(1) as f64;
        let value = |at: f64| list.get(at as usize).copied().unwrap_or(f64::NAN);
        value(at.floor()).lerp(value(at.ceil()), at.fract())
    })
}

/// The least: what other programs do to the caches only adds.
pub fn least(list: &[f64]) -> f64 {
    list.iter().copied().fold(f64::NAN, f64::min)
}

/// Time of whole frames over `rounds` rounds of: no feather, without layers, with layers (the last two change places every round).
/// Prints the least of each, and the difference.
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
    println!(
        "{name}: least of {rounds} frames each, {}: nothing {none:.2} ms, feather {without:.2} ms, with thin layers {with:.2} ms: \
         {:+.1} % of the feather's own time; cards: {}",
        clock(app),
        100.0 * (with - without) / (without - none),
        cards.join(", "),
    );
}

/// Frames of an app until nothing is compiled or loaded any more.
const WARM_UP: usize = 3;
/// Frames over which diagnostics average.
const GPU_WARM_UP: usize = 120;

/// Time of whole frames of two apps that show the same scene, with its feathers and with the same cards in a `StandardMaterial`, over
/// `rounds` rounds; of the feathers also with those drawn that the skin hides. Prints the least of each, quartiles of the ratios of
/// rounds (a machine's speed changes more from round to round than within one), and by how much hidden cards change the picture; on a GPU
/// also its passes.
pub fn compare_cards(
    [(feathers, image), (cards, _)]: Apps,
    rounds: u32,
    name: &str,
) -> Result<(), String> {
    for _ in 0..WARM_UP {
        frame(feathers);
        frame(cards);
    }
    let mut times: [Vec<f64>; 3] = Default::default();
    let mut pictures = Vec::new();
    let mut classes = String::new();
    for round in 0..rounds {
        for (all, times) in times.iter_mut().take(2).enumerate() {
            change_settings(feathers, |settings| settings.cull_hidden = all == 0);
            times.push(seconds(feathers));
            if round == 0 {
                pictures.push(capture(feathers, image.clone())?.to_rgb8().into_raw());
            }
        }
        times[2].push(seconds(cards));
        if round == 0 {
            change_settings(feathers, |settings| settings.cull_hidden = true);
            // Counters come back some frames late.
            for _ in 0..SETTLE {
                frame(feathers);
            }
            classes = bevy_plumage::CARD_COUNTERS
                .map(|class| format!("{} {class}", cards_of(feathers, class)))
                .join(", ");
        }
    }
    let [own, all, plain] = times.each_ref().map(|list| 1e3 * least(list));
    let [own_ratio, all_ratio] = [0, 1].map(|state| {
        let rounds = times[state].iter().zip(&times[2]);
        let [low, middle, high] = quartiles(rounds.map(|(own, plain)| own / plain).collect());
        format!("{middle:.2} ({low:.2} to {high:.2})")
    });
    let steps = pictures[0].iter().zip(&pictures[1]);
    let steps: Vec<u8> = steps.map(|(a, b)| a.abs_diff(*b)).collect();
    println!(
        "{name}: least of {rounds} frames each, {}: feathers {own:.2} ms, with hidden cards {all:.2} ms, cards in StandardMaterial \
         {plain:.2} ms; ratios of rounds {own_ratio} and {all_ratio}; cards: {classes}; hidden cards change {} of {} channels, by at \
         most {} of 255",
        clock(feathers),
        steps.iter().filter(|step| **step > 0).count(),
        steps.len(),
        steps.iter().max().unwrap_or(&0),
    );
    if !in_software(feathers.world().resource::<RenderAdapterInfo>()) {
        for _ in 0..GPU_WARM_UP {
            frame(feathers);
            frame(cards);
        }
        for (app, what) in [(feathers, "feathers"), (cards, "cards")] {
            let mut passes = stats::passes(app);
            passes.sort_by(|a, b| b.1.total_cmp(&a.1));
            let passes = passes
                .iter()
                .map(|(name, time)| format!("{name} {time:.3}"));
            let passes: Vec<String> = passes.collect();
            println!(
                "{name}: milliseconds of passes, {what}: {}",
                passes.join(", ")
            );
        }
    }
    Ok(())
}

/// Light budgets that are compared; 0 is the truth.
const LIGHT_BUDGETS: [f32; 5] = [0.0, 0.002, 0.005, 0.01, 0.02];
/// Timed rounds over them.
const LIGHT_ROUNDS: usize = 2;

fn change_settings(app: &mut App, change: impl Fn(&mut FeatherSettings)) {
    let mut qualities = app.world_mut().query::<&mut FeatherQuality>();
    for mut quality in qualities.iter_mut(app.world_mut()) {
        change(&mut quality.settings);
    }
    for _ in 0..SETTLE {
        frame(app);
    }
}

fn set_light_budget(app: &mut App, budget: f32) {
    change_settings(app, |settings| settings.light_budget = budget);
}

/// Differences of two pictures, steps of 255 of the worst channel, of pixels where `shown` differs from `bare`: root mean square, 99th
/// percentile, largest.
fn differences(shown: &[u8], truth: &[u8], bare: &[u8]) -> [f64; 3] {
    let pixels = shown.chunks(3).zip(truth.chunks(3)).zip(bare.chunks(3));
    let mut steps: Vec<u8> = pixels
        .filter(|((_, truth), bare)| truth != bare)
        .map(|((shown, truth), _)| {
            let channels = shown.iter().zip(truth).map(|(a, b)| a.abs_diff(*b));
            channels.max().unwrap_or(0)
        })
        .collect();
    steps.sort_unstable();
    let count = steps.len().max(1);
    let square: f64 = steps.iter().map(|step| f64::from(*step).powi(2)).sum();
    let at = |place: usize| steps.get(place).copied().map_or(0.0, f64::from);
    [
        (square / count as f64).sqrt(),
        at(count * 99 / 100),
        at(count - 1),
    ]
}

/// Draws the scene under several light budgets and writes a table: share of the cards that are lit at their vertices, what that does
/// to the pixels with feathers, time of a frame over that of one whose fragments are all lit. The picture is the same frame
/// in all but that; pictures go beside `file`, named after the budgets.
pub fn light(app: &mut App, image: &Handle<Image>, file: &Path) -> Result<(), String> {
    let mut pictures = Vec::new();
    let mut shares = Vec::new();
    for budget in LIGHT_BUDGETS {
        set_light_budget(app, budget);
        let picture = capture(app, image.clone())?.to_rgb8();
        let path = file.with_extension(format!("{budget}.png"));
        picture
            .save(&path)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        pictures.push(picture.into_raw());
        for _ in 0..SETTLE {
            frame(app);
        }
        let all: f64 = bevy_plumage::CARD_COUNTERS
            .map(|name| cards_of(app, name))
            .iter()
            .sum();
        shares.push(cards_of(app, "lit") / all.max(1.0));
    }
    let mut times = LIGHT_BUDGETS.map(|_| Vec::new());
    for _ in 0..LIGHT_ROUNDS {
        for (budget, times) in LIGHT_BUDGETS.into_iter().zip(&mut times) {
            set_light_budget(app, budget);
            times.push(seconds(app));
        }
    }
    let mut plumages = app
        .world_mut()
        .query_filtered::<&mut Visibility, With<Plumage>>();
    for mut visibility in plumages.iter_mut(app.world_mut()) {
        *visibility = Visibility::Hidden;
    }
    for _ in 0..SETTLE {
        frame(app);
    }
    let bare = capture(app, image.clone())?.to_rgb8().into_raw();
    let mut table =
        String::from("light budget,lit cards,rms of 255,99th percentile,largest,frame over 0\n");
    for (i, budget) in LIGHT_BUDGETS.into_iter().enumerate() {
        let [rms, most, largest] = differences(&pictures[i], &pictures[0], &bare);
        let time = least(&times[i]) / least(&times[0]);
        let _ = writeln!(
            table,
            "{budget},{:.3},{rms:.2},{most},{largest},{time:.2}",
            shares[i]
        );
    }
    print!("{}\n{table}", clock(app));
    fs::write(file, table).map_err(|error| format!("{}: {error}", file.display()))
}
