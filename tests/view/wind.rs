//! Wind and ruffle: off they change nothing, on they move feathers as far as they should, in every pass.

use bevy::{
    core_pipeline::prepass::MotionVectorPrepass, prelude::*, render::settings::WgpuSettings,
};
use bevy_plumage::maths::{vector, wind};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    gpu,
    view::{Shown, frames, hang_sheet, rms, showing, spawn_patch, with_sheets},
};

#[test]
fn still_air_changes_no_bit_and_wind_moves_feathers_and_their_motion_vectors() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), with_sheets) else {
        return;
    };
    let camera = stage.camera;
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert((Msaa::Off, MotionVectorPrepass));
    let bird = spawn_patch(
        &mut stage,
        60,
        Vec3::ZERO,
        showing(DebugView::Normal, FeatherTransparency::Hashed),
    );
    stage.settle();
    let still = stage.picture();
    stage.app.insert_resource(Wind {
        direction: Vec3::NEG_Y,
        ..default()
    });
    frames(&mut stage, 3);
    assert!(still == stage.picture(), "wind of no speed moves feathers");

    // Small eddies, so that much changes from frame to frame.
    stage.app.insert_resource(Wind {
        eddy: 0.05,
        ..Wind::new(Vec3::new(0.1, -1.0, 0.2), 4.0)
    });
    frames(&mut stage, 3);
    let first = stage.picture();
    assert!(
        rms(&still, &first) > 0.01,
        "wind moves nothing: {}",
        rms(&still, &first)
    );
    // Two moments of a gust may happen to be alike, and how many frames lie between two pictures is the machine's affair.
    let moved = (0..6).map(|_| rms(&first, &stage.picture()));
    let moved = moved.fold(0.0, f32::max);
    assert!(moved > 0.001, "gusts stand still: {moved}");
    let sheet = hang_sheet(&mut stage, Shown::Motion);
    frames(&mut stage, 3);
    let moving = motion(&stage.picture());
    // How long they must be: `wind_motion`.
    assert!(moving > 2e-7, "motion vectors in wind: {moving}");

    stage.app.insert_resource(Wind::default());
    frames(&mut stage, 4);
    let moving = motion(&stage.picture());
    assert!(moving < 1e-7, "motion vectors in still air: {moving}");
    stage.app.world_mut().entity_mut(sheet).despawn();
    frames(&mut stage, 3);
    assert!(still == stage.picture(), "the wind left something behind");

    let ruffle = Ruffle {
        regions: vec![("all".into(), 1.0)],
        ..default()
    };
    stage.app.world_mut().entity_mut(bird).insert(ruffle);
    frames(&mut stage, 3);
    let ruffled = stage.picture();
    assert!(rms(&still, &ruffled) > 0.01, "ruffle does nothing");
    stage.app.world_mut().entity_mut(bird).remove::<Ruffle>();
    frames(&mut stage, 3);
    assert!(still == stage.picture(), "the ruffle left something behind");
}

/// Mean length of the motion vectors, in pictures.
fn motion(picture: &[[f32; 3]]) -> f32 {
    // 0.5 is not a step of the 8-bit picture; what stands still says where it lies.
    let zero = [picture[0][0], picture[0][1]];
    let length = |p: &[f32; 3]| (p[0] - zero[0]).hypot(p[1] - zero[1]) / 500.0;
    picture.iter().map(length).sum::<f32>() / picture.len() as f32
}

#[test]
fn the_shader_blows_like_the_processor() {
    let text = "#import bevy_plumage::wind as w
        fn evaluate(i: u32) {
            let p = vec3(input[4u * i], input[4u * i + 1u], input[4u * i + 2u]);
            let t = input[4u * i + 3u];
            let breeze = w::Breeze(vec3(0.6, 0.0, 0.8), 1.2, 3.0, 0.4, 0.7);
            let v = w::wind_velocity(breeze, p, t);
            let along = normalize(vec3(p.y, -0.3, p.x));
            let normal = normalize(cross(along, vec3(0.2, 1.0, 0.1)));
            let lift = w::wind_lift(v, along, normal, 0.05, 0.06, 0.14);
            let turned = w::turned_by(p, normal * lift);
            let values = array<f32, 8>(v.x, v.y, v.z, w::value_noise(p * 3.7), lift, turned.x, turned.y, turned.z);
            for (var j = 0u; j < 8u; j++) { output[8u * i + j] = values[j]; }
        }";
    let mut input = Vec::new();
    for i in 0..600 {
        let x = i as f32 * 0.37;
        input.extend([
            x.sin() * 1.3,
            (x * 1.7).cos(),
            (x * 0.61).sin() * 0.4 + 0.01,
            x * 0.1,
        ]);
    }
    let count = input.len() / 4;
    let Some(result) = gpu::run(&["wind.wgsl"], text, &input, count, 8 * count) else {
        return;
    };
    let wind = Wind {
        direction: Vec3::new(0.6, 0.0, 0.8),
        speed: 1.2,
        gusts: 3.0,
        ..default()
    };
    for (from, found) in input.chunks(4).zip(result.chunks(8)) {
        let p = Vec3::new(from[0], from[1], from[2]);
        let breeze = wind.breeze();
        let v = wind::wind_velocity(&breeze, p.to_array(), from[3]);
        let along = Vec3::new(p.y, -0.3, p.x).normalize();
        let normal = along.cross(Vec3::new(0.2, 1.0, 0.1)).normalize();
        let [along, normal] = [along, normal].map(|v| v.to_array());
        let lift = wind::wind_lift(v, along, normal, 0.05, 0.06, 0.14);
        let turned = wind::turned_by(p.to_array(), vector::scale(normal, lift));
        let noise = wind::value_noise((p * 3.7).to_array());
        let wanted = [
            v[0], v[1], v[2], noise, lift, turned[0], turned[1], turned[2],
        ];
        for (a, b) in wanted.iter().zip(found) {
            assert!(
                (a - b).abs() < 2e-4,
                "at {from:?}: {wanted:?} against {found:?}"
            );
        }
    }
}
