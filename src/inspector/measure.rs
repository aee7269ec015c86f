//! What the statistics panel shows, read from the app every frame.

use super::{panels::Sample, preview::PreviewCard, state::Inspector};
use crate::{
    groom::{PlumageCards, PlumageState},
    render::{CARD_COUNTERS, PlumageMemory},
};
use bevy::{diagnostic::DiagnosticsStore, prelude::*};

/// Collects what the statistics panel shows.
pub(super) fn measure(
    mut inspector: ResMut<Inspector>,
    store: Option<Res<DiagnosticsStore>>,
    memory: Option<Res<PlumageMemory>>,
    time: Res<Time<Real>>,
    states: Query<&PlumageState>,
    cards: Query<&PlumageCards, Without<PreviewCard>>,
) {
    let mut sample = Sample {
        frame_ms: time.delta_secs_f64() * 1e3,
        memory: memory.map_or_else(PlumageMemory::default, |memory| *memory),
        feathers: cards.iter().map(|worn| worn.cards.len() as u64).sum(),
        ..Sample::default()
    };
    for state in &states {
        sample.triangles += u64::from(state.triangles);
        sample.groom_ms = sample.groom_ms.max(state.groom_ms);
        sample.errors.extend(state.error.clone());
    }
    for diagnostic in store.iter().flat_map(|store| store.iter()) {
        let path = diagnostic.path().as_str();
        if let Some(name) = path.strip_prefix("render/feather_cards_") {
            if let Some(i) = CARD_COUNTERS.iter().position(|known| *known == name) {
                sample.cards[i] = diagnostic.value().unwrap_or(0.0) as u64;
            }
        } else if let Some(name) = path
            .strip_prefix("render/")
            .and_then(|path| path.strip_suffix("/elapsed_gpu"))
            && let Some(ms) = diagnostic.smoothed()
        {
            sample.passes.push((name.to_owned(), ms));
        }
    }
    inspector.statistics.push(sample);
}
