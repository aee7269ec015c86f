//! Debug views: each shows what it says.

use bevy::prelude::*;
use bevy_plumage::groom::{Groom, PlumageCards, PlumageParts, Tint};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    view::{counts, frames, mean, mean_color, rms, showing, spawn_patch},
};
use std::collections::HashSet;

#[test]
fn debug_views_show_different_things() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn_patch(&mut stage, 100, Vec3::ZERO, FeatherQuality::default());
    // One sample a pixel: overdraw in whole steps.
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(Msaa::Off);
    stage.settle();
    let mut pictures: Vec<(DebugView, Vec<[f32; 3]>)> = Vec::new();
    for view in [
        DebugView::None,
        DebugView::Coverage,
        DebugView::Lod,
        DebugView::Card,
        DebugView::Layer,
        DebugView::Normal,
        DebugView::Barb,
        DebugView::Lobe,
        DebugView::Overdraw,
    ] {
        let quality = showing(view, FeatherTransparency::AlphaToCoverage);
        stage.app.world_mut().entity_mut(bird).insert(quality);
        frames(&mut stage, 3);
        let picture = stage.picture();
        for (other, before) in &pictures {
            let off = rms(before, &picture);
            assert!(off > 0.01, "{view:?} looks like {other:?}: {off}");
        }
        let [r, g, b] = mean_color(&picture);
        match view {
            // Numbers as colors: many of them.
            DebugView::Card | DebugView::Barb => {
                let lit = picture.iter().filter(|p| p.iter().sum::<f32>() > 0.05);
                let colors: HashSet<_> = lit.map(|p| p.map(|c| (c * 16.0) as u8)).collect();
                assert!(colors.len() > 20, "{view:?}: {} colors", colors.len());
            }
            // Facing the camera.
            DebugView::Normal => assert!(b > r && b > g, "normals {r} {g} {b}"),
            // Barbs and barbules together cover what is not open.
            DebugView::Coverage => assert!(r + g + b > 0.1, "coverage {r} {g} {b}"),
            DebugView::Overdraw => {
                // Grey, in steps of a sixteenth.
                assert!((r - g).abs() < 1e-4 && (r - b).abs() < 1e-4);
                let most = picture.iter().map(|p| p[0]).fold(0.0, f32::max);
                assert!(most > 0.12, "feathers lie over one another: {most}");
                let stepped = picture.iter().filter(|p| {
                    let steps = p[0] * 16.0;
                    (steps - steps.round()).abs() < 0.25
                });
                assert!(stepped.count() * 10 > picture.len() * 9, "not in steps");
            }
            // Black or white, grey: its values are checked card by card below.
            DebugView::Layer => assert!((r - g).abs() < 1e-4 && (r - b).abs() < 1e-4),
            _ => assert!(mean(&picture) > 0.005, "{view:?} is black"),
        }
        pictures.push((view, picture));
    }
}

/// Integer hash of the debug colors (PCG, O'Neill 2014).
fn hash_color(value: u32) -> [f32; 3] {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    let hash = (word >> 22) ^ word;
    [0, 8, 16].map(|shift| ((hash >> shift) & 255) as f32 / 255.0)
}

/// The same color, but for the rounding of a picture of 8 bits.
fn alike(a: &[f32; 3], b: &[f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01)
}

/// A patch with one sample a pixel, so that a pixel shows one card; the bird, and what `view` shows of it.
fn patch() -> Option<(Stage, Entity)> {
    let mut stage = Stage::new()?;
    let bird = spawn_patch(&mut stage, 100, Vec3::ZERO, FeatherQuality::default());
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(Msaa::Off);
    stage.settle();
    Some((stage, bird))
}

fn shown(stage: &mut Stage, bird: Entity, view: DebugView) -> Vec<[f32; 3]> {
    let quality = showing(view, FeatherTransparency::Hashed);
    stage.app.world_mut().entity_mut(bird).insert(quality);
    frames(stage, 3);
    stage.picture()
}

/// Every pixel shows the layer of the card that it shows.
#[test]
fn the_layer_view_shows_the_layer_of_each_card() {
    let Some((mut stage, bird)) = patch() else {
        return;
    };
    let cards = shown(&mut stage, bird, DebugView::Card);
    let layers = shown(&mut stage, bird, DebugView::Layer);
    let output = stage.app.world().get::<PlumageParts>(bird).unwrap()[0];
    let worn = stage.app.world().get::<PlumageCards>(output).unwrap();
    let all: Vec<f32> = worn.cards.iter().map(|card| card.layer).collect();
    let (low, high) = all.iter().fold((f32::MAX, f32::MIN), |(low, high), l| {
        (low.min(*l), high.max(*l))
    });
    assert!(high > low, "every card is on one layer");
    let (mut seen, mut lit, mut wrong) = (HashSet::new(), 0, 0);
    for (card, layer) in cards.iter().zip(&layers) {
        if *card == [0.0; 3] {
            continue;
        }
        lit += 1;
        let found = (0..all.len()).find(|i| alike(&hash_color(*i as u32), card));
        let Some(index) = found else {
            wrong += 1;
            continue;
        };
        seen.insert(index);
        let share = (all[index] - low) / (high - low);
        wrong += usize::from(!alike(&[share; 3], layer));
    }
    println!("{lit} pixels of {} cards, {wrong} wrong", seen.len());
    assert!(
        lit > 1000 && seen.len() > 30,
        "{lit} pixels, {} cards",
        seen.len()
    );
    assert!(wrong * 100 < lit, "{wrong} of {lit} pixels");
}

/// The colors are those of the classes, and of every class as the counters have it: from afar, near and nearer.
#[test]
fn the_lod_view_shows_the_classes_that_are_counted() {
    let Some((mut stage, bird)) = patch() else {
        return;
    };
    let camera = stage.camera;
    let near = PerspectiveProjection {
        near: 0.001,
        ..default()
    };
    let mut eye = stage.app.world_mut().entity_mut(camera);
    eye.insert(Projection::Perspective(near));
    // Near red, far green, mean blue, mixed white.
    const COLORS: [[f32; 3]; 4] = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    let mut met = [false; 4];
    for distance in [1.5, 0.5, 0.12, 0.05, 0.03, 0.01] {
        let place = Transform::from_xyz(0.0, 0.0, distance);
        stage.app.world_mut().entity_mut(camera).insert(place);
        let picture = shown(&mut stage, bird, DebugView::Lod);
        let [_, counted @ ..] = counts(&mut stage);
        let lit: Vec<_> = picture.iter().filter(|p| **p != [0.0; 3]).collect();
        let of = |color: &[f32; 3]| lit.iter().filter(|p| alike(p, color)).count();
        let pixels = COLORS.each_ref().map(of);
        println!(
            "{distance} m: cards {counted:?}, pixels {pixels:?} of {}",
            lit.len()
        );
        assert!(lit.len() > 20, "{distance} m: nothing to see");
        assert_eq!(
            pixels.iter().sum::<usize>(),
            lit.len(),
            "{distance} m: other colors"
        );
        for class in 0..4 {
            assert!(
                counted[class] > 0 || pixels[class] == 0,
                "{distance} m: class {class} shows, but is not counted"
            );
            // Of many cards some lie open.
            assert!(
                counted[class] < 20 || pixels[class] > 0,
                "{distance} m: class {class} is counted, but does not show"
            );
            met[class] |= pixels[class] > 0;
        }
    }
    assert!(
        met[1] && met[2] && (met[0] || met[3]),
        "classes met: {met:?}"
    );
}

/// The largest lobe is 1. Of black fibres the surface alone sends light back; of white ones most leaves the fibre, to the front and
/// to the back.
#[test]
fn the_lobe_view_shows_where_the_light_goes() {
    let Some((mut stage, bird)) = patch() else {
        return;
    };
    let mut lobes = |tint: [f32; 3]| {
        let groom = stage
            .app
            .world()
            .get::<Plumage>(bird)
            .unwrap()
            .groom
            .clone();
        let mut grooms = stage.app.world_mut().resource_mut::<Assets<Groom>>();
        grooms.get_mut(&groom).unwrap().regions[0].tint = Tint(tint, tint);
        stage.frame();
        stage.settle();
        let picture = shown(&mut stage, bird, DebugView::Lobe);
        let lit: Vec<_> = picture.into_iter().filter(|p| *p != [0.0; 3]).collect();
        assert!(lit.len() > 1000);
        for pixel in &lit {
            let most = pixel.iter().fold(0.0, |m: f32, c| m.max(*c));
            assert!((most - 1.0).abs() < 0.01, "{pixel:?}");
        }
        mean_color(&lit)
    };
    let (black, white) = (lobes([0.0; 3]), lobes([1.0; 3]));
    println!("surface, front, back: black {black:?}, white {white:?}");
    let off = |found: [f32; 3], wanted: [f32; 3]| rms(&[found], &[wanted]);
    assert!(off(black, [0.99, 0.04, 0.047]) < 0.03, "{black:?}");
    assert!(off(white, [0.233, 0.843, 1.0]) < 0.03, "{white:?}");
}
