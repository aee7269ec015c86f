//! Cameras of every kind, alone and together.

use bevy::{
    anti_alias::taa::TemporalAntiAliasing,
    camera::{
        Exposure, Hdr, RenderTarget, Viewport,
        visibility::{RenderLayers, VisibilityRange},
    },
    core_pipeline::tonemapping::Tonemapping,
    ecs::system::RunSystemOnce,
    picking::mesh_picking::ray_cast::{MeshRayCast, MeshRayCastSettings, RayCastVisibility},
    post_process::bloom::Bloom,
    prelude::*,
    render::view::ColorGrading,
};
use bevy_plumage::groom::PlumageParts;
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage},
    view::{counts, darken, frames, mean, orthographic, rms, spawn_patch},
};

fn stage() -> Option<(Stage, Entity)> {
    let mut stage = Stage::new()?;
    let bird = spawn_patch(&mut stage, 150, Vec3::ZERO, FeatherQuality::default());
    stage.settle();
    Some((stage, bird))
}

/// Mean of the left and of the right half.
fn halves(picture: &[[f32; 3]]) -> [f32; 2] {
    let mut sums = [0.0; 2];
    for (i, pixel) in picture.iter().enumerate() {
        let right = i as u32 % SIZE >= SIZE / 2;
        sums[usize::from(right)] += pixel.iter().sum::<f32>() / (1.5 * picture.len() as f32);
    }
    sums
}

#[test]
fn multisampling_range_bloom_and_temporal_filter() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let camera = stage.camera;
    let smooth = stage.picture();
    let bright = mean(&smooth);
    assert!(bright > 0.02, "{bright}");
    stage.app.world_mut().entity_mut(camera).insert(Msaa::Off);
    frames(&mut stage, 3);
    let single = stage.picture();
    let off = (mean(&single) - bright).abs() / bright;
    assert!(off < 0.03, "one sample is {off} brighter than four");
    // Without HDR the tone curve is in the feathers' own shader.
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Tonemapping::AcesFitted);
    frames(&mut stage, 3);
    let wide = stage.picture();
    stage.app.world_mut().entity_mut(camera).remove::<Hdr>();
    frames(&mut stage, 3);
    let narrow = stage.picture();
    assert!(
        rms(&wide, &narrow) < 0.02,
        "LDR and HDR differ by {}",
        rms(&wide, &narrow)
    );
    assert!(rms(&single, &narrow) > 0.005, "no tone curve");
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert((Hdr, Tonemapping::None));
    frames(&mut stage, 3);
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Bloom::NATURAL);
    frames(&mut stage, 3);
    let bloomed = stage.picture();
    let outside = |p: &[[f32; 3]]| {
        (0..SIZE as usize)
            .map(|x| p[x].iter().sum::<f32>())
            .sum::<f32>()
    };
    assert!(
        rms(&single, &bloomed) > 1e-4 && outside(&bloomed) > outside(&single),
        "no bloom"
    );
    stage.app.world_mut().entity_mut(camera).remove::<Bloom>();

    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(TemporalAntiAliasing::default());
    frames(&mut stage, 16);
    let filtered = stage.picture();
    let calm = stage.picture();
    let (before, after) = (rms(&single, &smooth), rms(&filtered, &smooth));
    assert!(
        after < before,
        "the temporal filter smooths nothing: {before} {after}"
    );
    assert!(
        rms(&filtered, &calm) < 0.02,
        "it shivers by {}",
        rms(&filtered, &calm)
    );
    // A moving camera leaves no trail: the picture after a jump is that of the new place.
    let place = Transform::from_xyz(0.08, 0.02, 0.45).looking_at(Vec3::ZERO, Vec3::Y);
    for step in 1..=16u32 {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(camera).unwrap();
        let start = Vec3::new(0.0, 0.0, 0.5);
        transform.translation = start.lerp(place.translation, step.min(8) as f32 / 8.0);
        transform.look_at(Vec3::ZERO, Vec3::Y);
        stage.frame();
    }
    let moved = stage.picture();
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .remove::<TemporalAntiAliasing>();
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Msaa::Sample4);
    frames(&mut stage, 4);
    let there = stage.picture();
    assert!(
        rms(&moved, &there) < 1.5 * after + 0.01,
        "trail: {} {after}",
        rms(&moved, &there)
    );
}

/// Thirty-two times the light on film that is five stops slower is the same picture, on the feathers and in the glow around
/// them: nothing is cut off before the tone curve.
#[test]
fn light_beyond_white_lasts_until_the_tone_curve() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let camera = stage.camera;
    darken(&mut stage);
    let place = Transform::from_xyz(0.2, 0.4, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
    let light = DirectionalLight::default();
    let sun = stage.app.world_mut().spawn((light, place)).id();
    let mut under = |illuminance: f32, stops: f32, bloom: bool, hdr: bool| {
        let world = stage.app.world_mut();
        let mut light = world.get_mut::<DirectionalLight>(sun).unwrap();
        light.illuminance = illuminance;
        let mut grading = ColorGrading::default();
        grading.global.exposure = stops;
        let mut eye = world.entity_mut(camera);
        eye.insert((Msaa::Off, Tonemapping::AcesFitted, grading))
            .remove::<(Hdr, Bloom)>();
        if hdr {
            eye.insert(Hdr);
        }
        if bloom {
            eye.insert(Bloom::NATURAL);
        }
        frames(&mut stage, 3);
        stage.picture()
    };
    let mut both = |bloom, hdr| {
        let plain = under(20_000.0, 0.0, bloom, hdr);
        (plain, under(20_000.0 * 32.0, -5.0, bloom, hdr))
    };
    let (plain, strong) = both(false, true);
    let (bloomed, dazzling) = both(true, true);
    let (narrow, blinding) = both(false, false);
    assert!(mean(&plain) > 0.05, "dark: {}", mean(&plain));
    let off = [rms(&plain, &strong), rms(&narrow, &blinding)];
    // Where there is nothing but glow.
    let glow = |picture: &[[f32; 3]]| {
        let empty = (0..plain.len()).filter(|i| plain[*i] == [0.0; 3]);
        empty.map(|i| picture[i][0]).sum::<f32>() / plain.len() as f32
    };
    let glow = [&plain, &bloomed, &dazzling].map(|p| glow(p));
    println!("apart: {off:?}, glow: {glow:?}");
    assert!(off.iter().all(|off| *off < 2.0 / 255.0), "{off:?}");
    // Bevy's first blur weighs bright pixels less.
    assert!(
        glow[0] == 0.0 && glow[1] > 1e-4 && glow[2] > 0.2 * glow[1],
        "glow: {glow:?}"
    );
}

/// An orthographic camera sees what a long lens sees from afar.
#[test]
fn orthographic_cameras_see_like_long_lenses() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let camera = stage.camera;
    let mut seen = |projection: Projection, distance: f32| {
        let place = Transform::from_xyz(0.0, 0.3 * distance, distance);
        let mut eye = stage.app.world_mut().entity_mut(camera);
        eye.insert((projection, place.looking_at(Vec3::ZERO, Vec3::Y)));
        let classes = counts(&mut stage);
        (stage.picture(), classes)
    };
    // So near that a lens would show barbs.
    let (flat, near) = seen(orthographic(), 0.1);
    let away = 40.0 * 1.09_f32.sqrt();
    let lens = PerspectiveProjection {
        fov: 2.0 * (0.06 / away).atan(),
        near: 10.0,
        ..default()
    };
    let (long, far) = seen(Projection::Perspective(lens), 40.0);
    let off = rms(&flat, &long) / mean(&long);
    println!("apart by {off} of {}, {near:?}, {far:?}", mean(&long));
    assert_eq!(near, far, "classes of cards");
    assert!(mean(&long) > 0.05 && off < 0.1, "{off}");
}

/// From behind feathers cover as much as from the front, and are lit.
#[test]
fn feathers_have_two_sides() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let camera = stage.camera;
    let mut seen = |z: f32| {
        let place = Transform::from_xyz(0.0, 0.0, z).looking_at(Vec3::ZERO, Vec3::Y);
        stage.app.world_mut().entity_mut(camera).insert(place);
        frames(&mut stage, 3);
        let picture = stage.picture();
        let lit = picture.iter().filter(|p| p[0] > 0.003).count();
        (lit as f32 / picture.len() as f32, mean(&picture))
    };
    let (front, back) = (seen(0.5), seen(-0.5));
    println!("front {front:?}, back {back:?}");
    assert!(front.0 > 0.2 && (back.0 / front.0 - 1.0).abs() < 0.05);
    assert!(back.1 > 0.2 * front.1, "{front:?} {back:?}");
}

#[test]
fn two_cameras_layers_ranges_and_the_mouse() {
    let Some((mut stage, bird)) = stage() else {
        return;
    };
    let camera = stage.camera;
    let cards = stage.app.world().get::<PlumageParts>(bird).unwrap()[0];
    let whole = stage.picture();
    // Split screen: near on the left, far on the right, one LOD buffer for both.
    let half = |x: u32| Viewport {
        physical_position: UVec2::new(x, 0),
        physical_size: UVec2::new(SIZE / 2, SIZE),
        ..default()
    };
    let target = stage.image.clone();
    let world = stage.app.world_mut();
    world.get_mut::<Camera>(camera).unwrap().viewport = Some(half(0));
    let second = world
        .spawn((
            Camera3d::default(),
            Camera {
                order: 1,
                viewport: Some(half(SIZE / 2)),
                clear_color: ClearColorConfig::Custom(Color::BLACK),
                ..default()
            },
            Hdr,
            Msaa::Sample4,
            Tonemapping::None,
            Exposure { ev100: 9.7 },
            RenderTarget::Image(target.into()),
            Transform::from_xyz(0.0, 0.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y),
        ))
        .id();
    frames(&mut stage, 4);
    let split = stage.picture();
    let [left, right] = halves(&split);
    assert!(
        left > 0.01 && right > 0.001 && right < left,
        "{left} {right}"
    );
    // Each camera culls for itself: where the first looks away, the second sees what it saw.
    let aside = |stage: &mut Stage, by: f32| {
        let mut eye = stage.app.world_mut().get_mut::<Transform>(camera).unwrap();
        eye.translation.x += by;
        frames(stage, 4);
        stage.picture()
    };
    let looked_away = aside(&mut stage, 5.0);
    let [left, alone] = halves(&looked_away);
    assert!(
        left < 1e-4 && (alone / right - 1.0).abs() < 0.01,
        "{left}, {alone} {right}"
    );
    assert!(aside(&mut stage, -5.0) == split, "looking back");
    // Layers: only the second camera sees them.
    stage
        .app
        .world_mut()
        .entity_mut(cards)
        .insert(RenderLayers::layer(3));
    stage
        .app
        .world_mut()
        .entity_mut(second)
        .insert(RenderLayers::layer(3));
    let mut suns = stage
        .app
        .world_mut()
        .query_filtered::<Entity, With<DirectionalLight>>();
    let suns: Vec<Entity> = suns.iter(stage.app.world()).collect();
    for sun in suns {
        stage
            .app
            .world_mut()
            .entity_mut(sun)
            .insert(RenderLayers::from_layers(&[0, 3]));
    }
    frames(&mut stage, 4);
    let [left, layered] = halves(&stage.picture());
    assert!(left < 1e-4 && layered > 0.001, "layers: {left} {layered}");
    stage.app.world_mut().entity_mut(second).despawn();
    stage
        .app
        .world_mut()
        .entity_mut(cards)
        .remove::<RenderLayers>();
    stage
        .app
        .world_mut()
        .get_mut::<Camera>(camera)
        .unwrap()
        .viewport = None;
    frames(&mut stage, 4);
    assert!(
        rms(&whole, &stage.picture()) < 0.01,
        "the old picture does not come back"
    );

    // Ranges: whole below 1 m, half dithered away between, gone beyond 2 m.
    let range = VisibilityRange {
        start_margin: 0.0..0.0,
        end_margin: 0.25..0.75,
        use_aabb: false,
    };
    stage.app.world_mut().entity_mut(cards).insert(range);
    // Bevy makes the pipeline anew when a mesh or material changes, not when it gets a range.
    let mut quality = FeatherQuality::default();
    quality.settings.dither = false;
    stage.app.world_mut().entity_mut(bird).insert(quality);
    frames(&mut stage, 4);
    let fading = mean(&stage.picture()) / mean(&whole);
    assert!((0.3..0.7).contains(&fading), "half way: {fading}");
    stage
        .app
        .world_mut()
        .get_mut::<Transform>(camera)
        .unwrap()
        .translation
        .z = 0.9;
    frames(&mut stage, 4);
    assert!(mean(&stage.picture()) < 1e-4, "out of range");
    stage
        .app
        .world_mut()
        .entity_mut(cards)
        .remove::<VisibilityRange>();

    // The mouse meets the cards.
    let hit = stage
        .app
        .world_mut()
        .run_system_once(move |mut cast: MeshRayCast| {
            let ray = Ray3d::new(Vec3::new(0.0, 0.0, 0.5), Dir3::NEG_Z);
            let filter = |entity: Entity| entity == cards;
            let settings = MeshRayCastSettings::default()
                .with_filter(&filter)
                .with_visibility(RayCastVisibility::Any);
            cast.cast_ray(ray, &settings)
                .first()
                .map(|(entity, hit)| (*entity, hit.distance))
        })
        .unwrap();
    let (entity, distance) = hit.expect("no card under the mouse");
    assert!(
        entity == cards && (0.4..0.55).contains(&distance),
        "{distance}"
    );
}
