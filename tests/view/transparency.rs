//! The ways of transparency against exact sorted compositing, and what happens on cameras that cannot have them.

use FeatherTransparency::{AlphaToCoverage, Blend, Hashed, OrderIndependent};
use bevy::{
    core_pipeline::oit::OrderIndependentTransparencySettings, prelude::*,
    render::settings::WgpuSettings,
};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    gpu, stack,
    view::{darken, frames, mean, rms, showing, spawn_patch},
};

#[test]
fn every_way_comes_near_sorted_compositing() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let mut stack = stack::Stack::new(&mut stage, 8);
    let camera = stage.camera;
    let exact = stack.draw(&mut stage, Msaa::Off, Blend, true);
    let share = mean(&exact);
    assert!(share > 0.02, "nothing to see: {share}");
    let mut off = Vec::new();
    for (msaa, way, oit) in [
        (Msaa::Sample4, AlphaToCoverage, false),
        (Msaa::Off, Hashed, false),
        (Msaa::Off, OrderIndependent, true),
        (Msaa::Off, OrderIndependent, false),
    ] {
        let mut entity = stage.app.world_mut().entity_mut(camera);
        entity.insert(msaa);
        if oit {
            entity.insert(OrderIndependentTransparencySettings::default());
        }
        let picture = stack.draw(&mut stage, msaa, way, false);
        stage
            .app
            .world_mut()
            .entity_mut(camera)
            .remove::<OrderIndependentTransparencySettings>();
        off.push((
            rms(&picture, &exact),
            (mean(&picture) - share).abs() / share,
        ));
    }
    println!("RMS error and error of the mean: {off:?}");
    let [samples, hashed, list, fallback] = off[..] else {
        unreachable!()
    };
    assert!(list.0 < 0.01 && list.1 < 0.01, "{list:?}");
    assert!(samples.1 < 0.015 && samples.0 < 0.03, "{samples:?}");
    assert!(hashed.1 < 0.015 && hashed.0 < 0.08, "{hashed:?}");
    assert!(fallback.1 < 0.015 && fallback.0 < 0.08, "{fallback:?}");
    assert!(list.0 < samples.0 && samples.0 < hashed.0, "{off:?}");
}

/// Frames that are averaged take a pattern each: noise falls faster than that of independent ones would (a quarter), and what is left comes
/// nearer to sorted compositing.
#[test]
fn patterns_average_out() {
    const PATTERNS: u32 = 16;
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let mut stack = stack::Stack::new(&mut stage, 8);
    let camera = stage.camera;
    let exact = stack.draw(&mut stage, Msaa::Off, Blend, true);
    for (msaa, way) in [(Msaa::Sample4, AlphaToCoverage), (Msaa::Off, Hashed)] {
        stage.app.world_mut().entity_mut(camera).insert(msaa);
        let usual = stack.draw(&mut stage, msaa, way, false);
        let frames: Vec<Vec<[f32; 3]>> = (0..2 * PATTERNS)
            .map(|pattern| {
                let world = stage.app.world_mut();
                let mut qualities = world.query::<&mut FeatherQuality>();
                for mut quality in qualities.iter_mut(world) {
                    quality.settings.pattern = pattern;
                }
                stage.picture()
            })
            .collect();
        assert!(frames[0] == usual, "the first pattern is the usual one");
        let mean = |frames: &[Vec<[f32; 3]>]| -> Vec<[f32; 3]> {
            let share = 1.0 / frames.len() as f32;
            let sum = |i: usize| frames.iter().map(|f| Vec3::from_array(f[i])).sum::<Vec3>();
            (0..usual.len())
                .map(|i| (share * sum(i)).to_array())
                .collect()
        };
        let (first, second) = frames.split_at(PATTERNS as usize);
        let before = rms(&frames[0], &frames[1]);
        let after = rms(&mean(first), &mean(second));
        let error = [&frames[0], &mean(first)].map(|picture| rms(picture, &exact));
        println!("{way:?}: noise of one {before}, of {PATTERNS} {after}; RMS error {error:?}");
        assert!(after < 0.2 * before, "{way:?}: {before} {after}");
        assert!(error[1] < error[0], "{way:?}: {error:?}");
    }
}

/// Every aligned block of frames of a power of two fills thresholds and samples evenly, whatever the seed, and cards do not move together.
#[test]
fn frames_fill_their_range_evenly() {
    const FRAMES: usize = 64;
    let text = "#import bevy_plumage::feather_pattern as p
        fn evaluate(i: u32) {
            let point = p::frame_point(i % 64u, u32(input[i / 64u]));
            output[2u * i] = p::share_of(point.x);
            output[2u * i + 1u] = p::share_of(point.y);
        }";
    let seeds: Vec<f32> = (0..16).map(|i| (7919 * i) as f32).collect();
    let count = FRAMES * seeds.len();
    let Some(result) = gpu::run(&["feather_pattern.wgsl"], text, &seeds, count, 2 * count) else {
        return;
    };
    let points: Vec<[f32; 2]> = result.as_chunks().0.to_vec();
    for (seed, points) in points.chunks(FRAMES).enumerate() {
        assert_eq!(points[0], [0.0; 2], "{seed}: the usual pattern");
        for block in points.chunks(16) {
            let (mut fine, mut both) = ([0; 16], [[0; 4]; 4]);
            for [x, y] in block {
                fine[(16.0 * x) as usize] += 1;
                both[(4.0 * x) as usize][(4.0 * y) as usize] += 1;
            }
            assert_eq!(fine, [1; 16], "{seed}: {block:?}");
            assert_eq!(both, [[1; 4]; 4], "{seed}: {block:?}");
        }
    }
    let together = |a: usize, b: usize| {
        let pairs = points[a * FRAMES..].iter().zip(&points[b * FRAMES..]);
        let products = pairs.take(FRAMES).map(|(a, b)| (a[0] - 0.5) * (b[0] - 0.5));
        12.0 * products.sum::<f32>() / FRAMES as f32
    };
    let others = (0..16).flat_map(|a| (0..a).map(move |b| together(a, b)));
    let spread = (others.map(|r| r * r).sum::<f32>() / 120.0).sqrt();
    assert!(spread < 0.25, "cards move together: {spread}");
}

/// Down is open: most of it is there in fewer than half of the cells of a hash, or of the samples of a pixel.
#[test]
fn open_feathers_let_as_much_through_as_sorted_compositing() {
    let Some(mut stage) = Stage::sized(192, 192) else {
        return;
    };
    // A grey that 8 bits hold.
    let grey = Color::srgb_u8(124, 124, 124);
    stage.app.insert_resource(ClearColor(grey));
    let grey = grey.to_linear().red;
    let mut stack = stack::Stack::of(&mut stage, 8, "feathers/down.feather.ron");
    let (camera, mut open) = (stage.camera, Vec::new());
    darken(&mut stage);
    for (msaa, way) in [
        (Msaa::Off, Blend),
        (Msaa::Sample4, AlphaToCoverage),
        (Msaa::Off, Hashed),
    ] {
        stage.app.world_mut().entity_mut(camera).insert(msaa);
        let picture = stack.draw(&mut stage, msaa, way, way == Blend);
        // Without light feathers are black on grey.
        open.push(1.0 - mean(&picture) / grey);
    }
    println!("covered: {open:?}");
    let [exact, samples, hashed] = open[..] else {
        unreachable!()
    };
    assert!((0.01..0.5).contains(&exact), "{exact}");
    assert!((samples / exact - 1.0).abs() < 0.02, "{samples} {exact}");
    assert!((hashed / exact - 1.0).abs() < 0.04, "{hashed} {exact}");
}

#[test]
fn a_camera_that_bevy_refuses_is_a_warning_and_draws() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), |_| {}) else {
        return;
    };
    let camera = stage.camera;
    // Bevy's own check panics on this camera.
    stage.app.world_mut().entity_mut(camera).insert((
        Msaa::Sample4,
        OrderIndependentTransparencySettings::default(),
    ));
    spawn_patch(
        &mut stage,
        60,
        Vec3::ZERO,
        showing(DebugView::None, OrderIndependent),
    );
    stage.settle();
    let with_msaa = stage.picture();
    assert!(
        stage
            .app
            .world()
            .get::<OrderIndependentTransparencySettings>(camera)
            .is_none()
    );
    assert!(mean(&with_msaa) > 0.01);
    // Without MSAA the list works, and shows the same birds.
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Msaa::Off)
        .insert(OrderIndependentTransparencySettings::default());
    frames(&mut stage, 5);
    let listed = stage.picture();
    let off = (mean(&listed) - mean(&with_msaa)).abs() / mean(&with_msaa);
    assert!(off < 0.1, "{off}");
    // And MSAA again, with the list left on.
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Msaa::Sample4);
    frames(&mut stage, 4);
    assert!(mean(&stage.picture()) > 0.01);
}

#[test]
fn cameras_are_left_alone_unless_feathers_need_them() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let app = &mut stage.app;
    let settings = OrderIndependentTransparencySettings::default;
    // Bevy refuses this camera in `Update`, which does not run here: that is between the app and Bevy.
    let camera = app
        .world_mut()
        .spawn((Camera3d::default(), Msaa::Sample4, settings()))
        .id();
    app.world_mut().spawn(FeatherQuality::default());
    let sorts = |app: &App| {
        let entity = app.world().entity(camera);
        entity.contains::<OrderIndependentTransparencySettings>()
    };
    assert!(sorts(app), "a camera was changed without need");
    let asks = FeatherQuality {
        transparency: OrderIndependent,
        ..default()
    };
    let bird = app.world_mut().spawn(asks).id();
    assert!(!sorts(app), "Bevy will panic");
    app.world_mut().entity_mut(camera).insert(settings());
    assert!(!sorts(app), "Bevy will panic");
    app.world_mut().entity_mut(camera).insert(Msaa::Off);
    app.world_mut().entity_mut(camera).insert(settings());
    assert!(sorts(app));
    app.world_mut().entity_mut(camera).insert(Msaa::Sample4);
    assert!(!sorts(app), "Bevy will panic");
    app.world_mut().entity_mut(bird).despawn();
    app.world_mut().entity_mut(camera).insert(settings());
    assert!(sorts(app), "a camera was changed without need");
}

#[test]
fn patterns_have_the_mean_that_they_should() {
    let text = "#import bevy_plumage::feather_pattern as p
        fn evaluate(i: u32) {
            let alpha = input[i];
            var samples = 0.0;
            var hashed = 0.0;
            for (var k = 0u; k < 64u; k++) {
                for (var l = 0u; l < 64u; l++) {
                    let pixel = vec2(f32(k), f32(l));
                    let mask = p::sample_mask(alpha, p::pattern_threshold(pixel, i), k * 7u + l, 4u);
                    samples += f32(countOneBits(mask)) / 4.0;
                    let uv = pixel * 0.0123;
                    let wide = 0.0123 * exp2(f32(i % 8u) / 8.0);
                    hashed += f32(alpha >= p::hashed_threshold(uv, vec2(wide, 0.0), vec2(0.0, wide), i));
                }
            }
            output[2u * i] = samples / 4096.0;
            output[2u * i + 1u] = hashed / 4096.0;
        }";
    let input: Vec<f32> = (0..33).map(|i| i as f32 / 32.0).collect();
    let count = input.len();
    let Some(result) = gpu::run(&["feather_pattern.wgsl"], text, &input, count, 2 * count) else {
        return;
    };
    for (alpha, found) in input.iter().zip(result.chunks(2)) {
        assert!(
            (found[0] - alpha).abs() < 0.01,
            "samples at {alpha}: {}",
            found[0]
        );
        assert!(
            (found[1] - alpha).abs() < 0.03,
            "hash at {alpha}: {}",
            found[1]
        );
    }
}
