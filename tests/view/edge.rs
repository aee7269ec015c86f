//! A feather seen edge on is as thick as its barbs.

use bevy::prelude::*;
use bevy_plumage::groom::PlumageCards;
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    feather_card::{save, spawn_segments},
    view::frames,
};

/// Places between two rows of pixels: less apart than the barbs are thick.
const PLACES: usize = 24;

#[test]
fn seen_edge_on_a_vane_is_as_thick_as_its_barbs() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let owner = spawn_segments(&mut stage, "feathers/macaw_contour.feather.ron", (2, 4));
    let rest = *stage.app.world().get::<Transform>(owner).unwrap();
    let world = stage.app.world();
    let cards = world.get::<PlumageCards>(owner).unwrap();
    let card = &cards.cards[0];
    let feathers = world.resource::<Assets<Feather>>();
    let feather = feathers.get(&cards.feathers[0]).unwrap();
    let pixel = 2.0 * 0.5 * (std::f32::consts::PI / 8.0).tan() / stage.size.1 as f32;
    let thickness = 2e-3 * feather.left.barb_radius_um / feather.length_mm * card.length;
    let ends = [0.2, 0.8].map(|v| {
        let x = rest.translation.x + v * card.length;
        (x / pixel + 0.5 * stage.size.0 as f32) as usize
    });
    // How bright each column is: the shaft lies along the rows. The card is turned so far that `times` the thickness shows.
    let width = card.width;
    let mut columns = |times: f32| {
        let lean = (times * thickness / width).asin();
        let row = stage.size.0 as usize;
        let mut sum = vec![0.0; row];
        let mut last = Vec::new();
        for place in 0..PLACES {
            let mut there = rest;
            let aside = (place as f32 + 0.3) / PLACES as f32 * pixel;
            there.translation.y += aside;
            // The eye, half a metre away, stays in the plane of the card.
            there.rotation = Quat::from_rotation_x((aside / 0.5).atan())
                * there.rotation
                * Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 - lean);
            stage.app.world_mut().entity_mut(owner).insert(there);
            frames(&mut stage, 2);
            last = stage.picture();
            for (i, color) in last.iter().enumerate() {
                sum[i % row] += color[1] / PLACES as f32;
            }
        }
        (sum[ends[0]..ends[1]].to_vec(), last, stage.size)
    };
    let [(edge, picture, size), (wider, wider_picture, _)] = [0.0, 6.0].map(&mut columns);
    let mean = |sums: &[f32]| sums.iter().sum::<f32>() / sums.len() as f32;
    let [all, all_wider] = [mean(&edge), mean(&wider)];
    let least = edge.iter().copied().fold(f32::MAX, f32::min);
    println!(
        "{:.3} pixels thick: a column {all:.5}, at least {least:.5}; six times as wide {all_wider:.5}",
        thickness / pixel
    );
    let share = all / all_wider * 6.0;
    // Light along the card is not that across it.
    let good = least > 0.4 * all && (0.4..1.6).contains(&share);
    if !good {
        save("edge", size, &picture);
        save("edge_wider", size, &wider_picture);
    }
    assert!(good, "{share} of what the width tells, {edge:?}");
}
