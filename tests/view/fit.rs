//! A card as wide as its feather shows what the whole card does.

use bevy::prelude::*;
use bevy_plumage::{
    groom::{PlumageCards, fit_cards},
    prelude::*,
};
use plumage_tests::{
    app::Stage,
    feather_card::{save, spawn_segments},
    view::{frames, mean},
};

/// Places between pixels along each axis.
const PLACES: usize = 4;

/// RMS over the brightness of the feather, and relative difference of the means.
fn differ(a: &[[f32; 3]], b: &[[f32; 3]]) -> (f32, f32) {
    let square = |p: &[f32; 3]| p.iter().map(|x| x * x).sum::<f32>();
    let both = a.iter().zip(b);
    let off: f32 = both
        .map(|(a, b)| square(&std::array::from_fn(|k| a[k] - b[k])))
        .sum();
    let all: f32 = a.iter().map(square).sum();
    ((off / all).sqrt(), mean(b) / mean(a) - 1.0)
}

#[test]
fn fitted_cards_show_the_same() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let file = "feathers/macaw_contour.feather.ron";
    let owner = spawn_segments(&mut stage, file, (2, 4));
    let rest = *stage.app.world().get::<Transform>(owner).unwrap();
    // Shares of the size that fills the picture; turned about the shaft, radians.
    let looks = [
        (1.0, 0.0),
        (0.4, 0.9),
        (0.15, 0.0),
        (0.15, 1.2),
        (0.05, 0.5),
        (0.02, 0.0),
    ];
    let pixel = 2.0 * 0.5 * (std::f32::consts::PI / 8.0).tan() / stage.size.1 as f32;
    // Over all places between pixels: a small card meets few of their centres.
    let draw = |stage: &mut Stage| -> Vec<Vec<[f32; 3]>> {
        let pictures = looks.map(|(size, turn)| {
            let places =
                (0..PLACES * PLACES).map(|i| Vec2::new((i % PLACES) as f32, (i / PLACES) as f32));
            let mut sum: Vec<[f32; 3]> = Vec::new();
            for place in places {
                let place = (place + 0.3) / PLACES as f32 * pixel;
                let mut there = rest;
                there.scale = Vec3::splat(size);
                there.translation = size * rest.translation + place.extend(0.0);
                there.rotation *= Quat::from_rotation_y(turn);
                stage.app.world_mut().entity_mut(owner).insert(there);
                frames(stage, 2);
                let picture = stage.picture();
                sum.resize(picture.len(), [0.0; 3]);
                for (sum, own) in sum.iter_mut().zip(picture) {
                    *sum = std::array::from_fn(|k| sum[k] + own[k] / (PLACES * PLACES) as f32);
                }
            }
            sum
        });
        pictures.to_vec()
    };
    let whole = draw(&mut stage);
    let world = stage.app.world_mut();
    let cards = world.get::<PlumageCards>(owner).unwrap().clone();
    let mesh = world.get::<Mesh3d>(owner).unwrap().id();
    let feather = world.resource::<Assets<Feather>>();
    let feather = feather.get(&cards.feathers[0]).unwrap().clone();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(mesh).unwrap();
    fit_cards(&mut mesh, &cards.cards, &cards.geometry, &[Some(&feather)]);
    drop(mesh);
    let fitted = draw(&mut stage);
    for (i, (a, b)) in whole.iter().zip(&fitted).enumerate() {
        let (off, more) = differ(a, b);
        println!(
            "{:?}: RMS {off:.4} of the feather, mean {:+.4}",
            looks[i], more
        );
        // A card of one pixel has little left where it is narrow, and no more than all of that can be covered.
        let most = if looks[i].0 < 0.1 { 0.1 } else { 0.03 };
        let good = off < 0.1 && more.abs() < most;
        if !good {
            save(&format!("fit_{i}_whole"), stage.size, a);
            save(&format!("fit_{i}_fitted"), stage.size, b);
        }
        assert!(good, "{:?}: {off}, {more}", looks[i]);
    }
}
