//! Debug views: each shows what it says.

mod common;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use common::{
    app::Stage,
    view::{frames, mean, mean_color, rms, showing, spawn_patch},
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
            // Numbers as colours: many of them.
            DebugView::Card | DebugView::Barb => {
                let lit = picture.iter().filter(|p| p.iter().sum::<f32>() > 0.05);
                let colours: HashSet<_> = lit.map(|p| p.map(|c| (c * 16.0) as u8)).collect();
                assert!(colours.len() > 20, "{view:?}: {} colours", colours.len());
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
            _ => assert!(mean(&picture) > 0.005, "{view:?} is black"),
        }
        pictures.push((view, picture));
    }
}
