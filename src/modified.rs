//! Which assets have been replaced or edited since the last look.

use bevy::prelude::*;

/// Ids of the assets that the messages not yet read call modified.
pub(crate) fn modified<A: Asset>(events: &mut MessageReader<AssetEvent<A>>) -> Vec<AssetId<A>> {
    events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        })
        .collect()
}
