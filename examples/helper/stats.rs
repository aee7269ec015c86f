//! The statistics an example writes.

use bevy::{
    diagnostic::{Diagnostic, DiagnosticsStore},
    prelude::*,
    render::renderer::RenderAdapterInfo,
};
use bevy_plumage::{PlumageCards, prelude::*};
use serde_json::{Map, Value, json};
use std::time::Duration;

/// Mean GPU milliseconds of the passes that Bevy times, of the last frames.
pub fn passes(app: &App) -> Vec<(String, f64)> {
    let store = app.world().resource::<DiagnosticsStore>();
    let elapsed = |d: &Diagnostic| {
        let name = d.path().as_str().strip_prefix("render/")?;
        Some((name.strip_suffix("/elapsed_gpu")?.to_owned(), d.average()?))
    };
    store.iter().filter_map(elapsed).collect()
}

/// Collects everything the run has measured.
pub fn collect(app: &mut App, times: &mut [Duration]) -> Value {
    times.sort_unstable();
    let median = times.get(times.len() / 2).copied().unwrap_or_default();
    let mut cards = app.world_mut().query::<&PlumageCards>();
    let feathers: usize = cards.iter(app.world()).map(|worn| worn.cards.len()).sum();
    let mut groom_ms: f64 = 0.0;
    let mut errors = Vec::new();
    let mut states = app.world_mut().query::<&PlumageState>();
    for state in states.iter(app.world()) {
        groom_ms += f64::from(state.groom_ms);
        errors.extend(state.error.clone());
    }
    let mut coats = app.world_mut().query::<&UndercoatState>();
    let (mut coat_bytes, mut prisms, mut strands, mut drawn) = (0, 0, 0, 0);
    for coat in coats.iter(app.world()) {
        coat_bytes += coat.bytes;
        prisms += coat.prisms;
        strands += coat.strands;
        drawn += coat.drawn;
        errors.extend(coat.error.clone());
    }
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path: String| {
        store
            .iter()
            .find(|d| d.path().as_str() == path)
            .and_then(bevy::diagnostic::Diagnostic::value)
    };
    let cards: Map<String, Value> = bevy_plumage::CARD_COUNTERS
        .iter()
        .map(|name| {
            let count = value(format!("render/feather_cards_{name}")).unwrap_or(0.0);
            ((*name).into(), json!(count as u64))
        })
        .collect();
    let passes: Map<String, Value> = passes(app)
        .into_iter()
        .map(|(name, time)| (name, json!(time)))
        .collect();
    let adapter = app.world().resource::<RenderAdapterInfo>();
    json!({
        "feathers": feathers,
        "cards": cards,
        "gpu_bytes": app.world().resource::<PlumageMemory>().total(),
        "undercoat": {
            "bytes": coat_bytes,
            "prisms": prisms,
            "strands": strands,
            "tracts_drawn": drawn,
        },
        "groom_ms": groom_ms,
        "frame_ms": median.as_secs_f64() * 1e3,
        "passes": passes,
        "adapter": adapter.name,
        "backend": format!("{:?}", adapter.backend),
        "errors": errors,
    })
}
