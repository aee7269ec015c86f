//! Touches of a brush on the skin: number and length of feathers.

use bevy::math::Vec3;
use bevy_plumage::groom::*;
use plumage_tests::skins::*;

#[test]
fn paint_changes_number_and_length_where_it_lies() {
    let bird = bird(true);
    let plain = groom_bird(&bird, &groom(), 3, 1.0).unwrap();
    let mut painted = groom();
    // On the upper side, full within the brush.
    let dab = |density, length| {
        let mut dab = Dab::new([0.0, 60.0, 0.0], 40.0);
        (dab.density, dab.length) = (density, length);
        dab
    };
    painted.paint = vec![dab(3.0, 1.0)];
    let dense = groom_bird(&bird, &painted, 3, 1.0).unwrap();
    assert!(
        dense.cards.len() > plain.cards.len(),
        "{} of {}",
        dense.cards.len(),
        plain.cards.len()
    );
    painted.paint = vec![dab(1.0, 2.0)];
    let long = groom_bird(&bird, &painted, 3, 1.0).unwrap();
    assert_eq!(long.cards.len(), plain.cards.len());
    let mean = |coat: &Coat| {
        coat.cards.iter().map(|card| card.length).sum::<f32>() / coat.cards.len() as f32
    };
    assert!(mean(&long) > mean(&plain) * 1.02);
    // Far from the brush nothing has changed.
    let far = |coat: &Coat| {
        coat.cards
            .iter()
            .filter(|card| card.root.distance(Vec3::new(0.0, 0.06, 0.0)) > 0.05)
            .map(|card| card.length)
            .sum::<f32>()
    };
    assert!((far(&long) - far(&plain)).abs() < 1e-3 * far(&plain));
}
