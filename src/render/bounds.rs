//! Bounds of the cards in bind pose, for rays: Bevy makes none for meshes that are never culled, and picks nothing without.

use crate::groom::PlumageCards;
use bevy::{camera::primitives::Aabb, prelude::*};

pub(super) fn update_bounds(
    mut commands: Commands,
    unbounded: Query<(Entity, &PlumageCards), (With<Mesh3d>, Without<Aabb>)>,
) {
    for (entity, cards) in &unbounded {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for card in cards.cards.iter() {
            low = low.min(card.center - card.radius);
            high = high.max(card.center + card.radius);
        }
        if low.is_finite() && high.is_finite() {
            commands
                .entity(entity)
                .try_insert(Aabb::from_min_max(low, high));
        }
    }
}
