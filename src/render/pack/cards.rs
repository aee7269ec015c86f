//! Card records as the shaders read them (`feather_data.wgsl`).

use crate::groom::Card;
use bevy::math::{Vec2, Vec3, Vec3Swizzles};

/// vec4s (of `u32`) of one card record.
pub const CARD_VEC4S: usize = 5;
/// Regions (and rows) that a card record can tell apart; further ones share the last.
pub const MAX_REGIONS: u32 = 128;

/// A direction as two signed 16-bit numbers of the octahedral map (Cigolle et al. 2014).
fn octahedral(direction: Vec3) -> u32 {
    let v = direction / direction.abs().element_sum().max(f32::MIN_POSITIVE);
    let folded = if v.z >= 0.0 {
        v.truncate()
    } else {
        (Vec2::ONE - v.yx().abs()) * Vec2::new(1f32.copysign(v.x), 1f32.copysign(v.y))
    };
    let [x, y] = folded
        .to_array()
        .map(|c| u32::from((c.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16));
    x | y << 16
}

/// Degrees that a card may turn between two vertices, for each class but the last.
const TURNS: [f32; 3] = [5.0, 10.0, 20.0];

/// Class of a card that turns by so many radians: two bits.
fn turn_class(turn: f32) -> u32 {
    let below = TURNS.iter().position(|limit| turn.to_degrees() <= *limit);
    below.unwrap_or(TURNS.len()) as u32
}

/// Card records; five `vec4<u32>` each.
pub fn pack_cards(cards: &[Card]) -> Vec<u8> {
    let layers = cards
        .iter()
        .map(|card| card.layer)
        .fold((f32::MAX, f32::MIN), |(lo, hi), l| (lo.min(l), hi.max(l)));
    let mut data = Vec::with_capacity(cards.len() * CARD_VEC4S * 16);
    for card in cards {
        let mut word = |value: u32| data.extend_from_slice(&value.to_le_bytes());
        for value in card.root.to_array() {
            word(value.to_bits());
        }
        word(card.length.to_bits());
        for value in card.center.to_array() {
            word(value.to_bits());
        }
        word(card.radius.to_bits());
        for value in card.along.to_array() {
            word(value.to_bits());
        }
        word(card.width.to_bits());
        let [a, b, c, d] = card.joints.map(u32::from);
        word(a | b << 16);
        word(c | d << 16);
        let [a, b, c, d] = card
            .weights
            .map(|w| (w.clamp(0.0, 1.0) * 65535.0).round() as u32);
        word(a | b << 16);
        word(c | d << 16);
        let layer = (card.layer - layers.0) / (layers.1 - layers.0).max(1e-6);
        word(
            u32::from(card.feather)
                | u32::from(card.mirrored) << 16
                | u32::from(card.region).min(MAX_REGIONS - 1) << 17
                | ((layer.clamp(0.0, 1.0) * 255.0) as u32) << 24,
        );
        let [r, g, b] = card
            .tint
            .map(|t| (t.clamp(0.0, 1.0).sqrt() * 1023.0).round() as u32);
        word(r | g << 10 | b << 20 | turn_class(card.turn) << 30);
        word(card.seed);
        word(octahedral(card.normal));
    }
    data
}
