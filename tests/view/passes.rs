//! Color, depth, normal, motion and shadow passes draw the same feathers.

use bevy::{
    camera::visibility::RenderLayers,
    core_pipeline::prepass::{DepthPrepass, MotionVectorPrepass, NormalPrepass},
    light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap, ShadowFilteringMethod},
    mesh::skinning::SkinnedMesh,
    prelude::*,
    render::settings::WgpuSettings,
};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    view::{
        Shown, counts, darken, frames, hang_sheet, keep, mean, mean_color, orthographic, rms,
        showing, silhouettes_differ, spawn_patch, with_sheets,
    },
};

/// Share of each pixel that feathers cover: they are black without light, on white.
fn covered(stage: &mut Stage) -> Vec<f32> {
    stage.app.insert_resource(ClearColor(Color::WHITE));
    frames(stage, 2);
    let picture = stage.picture();
    stage.app.insert_resource(ClearColor(Color::BLACK));
    picture.iter().map(|p| 1.0 - p[0]).collect()
}

fn shown(stage: &mut Stage, what: Shown) -> Vec<[f32; 3]> {
    let sheet = hang_sheet(stage, what);
    frames(stage, 3);
    let picture = stage.picture();
    stage.app.world_mut().entity_mut(sheet).despawn();
    picture
}

fn share(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

/// Where a wall behind the feathers is in their shadow, seen by a camera that does not see the feathers.
fn shadow(stage: &mut Stage) -> Vec<f32> {
    let camera = stage.camera;
    let world = stage.app.world_mut();
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(1.0, 1.0));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..default()
        });
    let wall = world
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(0.0, 0.0, -0.1),
            RenderLayers::layer(1),
        ))
        .id();
    let sun = world
        .spawn((
            DirectionalLight {
                illuminance: 2000.0,
                shadow_maps_enabled: true,
                shadow_depth_bias: 0.0,
                shadow_normal_bias: 0.0,
                ..default()
            },
            CascadeShadowConfigBuilder {
                num_cascades: 1,
                minimum_distance: 0.05,
                maximum_distance: 0.65,
                ..default()
            }
            .build(),
            Transform::from_xyz(0.0, 0.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y),
            RenderLayers::from_layers(&[0, 1]),
        ))
        .id();
    world
        .entity_mut(camera)
        .insert((RenderLayers::layer(1), ShadowFilteringMethod::Gaussian));
    frames(stage, 3);
    let picture = stage.picture();
    let world = stage.app.world_mut();
    world.entity_mut(wall).despawn();
    world.entity_mut(sun).despawn();
    world.entity_mut(camera).remove::<RenderLayers>();
    let lit = picture.iter().map(|p| p[0]).fold(0.0, f32::max);
    assert!(
        (0.05..0.95).contains(&lit),
        "the wall is dark or clipped: {lit}"
    );
    picture.iter().map(|p| 1.0 - p[0] / lit).collect()
}

#[test]
fn silhouettes_agree_in_color_depth_and_shadow() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), with_sheets) else {
        return;
    };
    darken(&mut stage);
    stage
        .app
        .insert_resource(DirectionalLightShadowMap { size: 4096 });
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert((
        orthographic(),
        DepthPrepass,
        NormalPrepass,
        MotionVectorPrepass,
    ));
    let bird = spawn_patch(
        &mut stage,
        24,
        Vec3::ZERO,
        showing(DebugView::None, FeatherTransparency::AlphaToCoverage),
    );
    stage.settle();
    let (mut worst, mut report) = (0.0f32, String::new());
    for (msaa, transparency) in [
        (Msaa::Sample4, FeatherTransparency::AlphaToCoverage),
        (Msaa::Off, FeatherTransparency::AlphaToCoverage),
        (Msaa::Off, FeatherTransparency::Hashed),
    ] {
        stage.app.world_mut().entity_mut(camera).insert(msaa);
        stage
            .app
            .world_mut()
            .entity_mut(bird)
            .insert(showing(DebugView::None, transparency));
        frames(&mut stage, 3);
        let color = covered(&mut stage);
        let depth: Vec<f32> = shown(&mut stage, Shown::Depth)
            .iter()
            .map(|p| p[0])
            .collect();
        let shadow = shadow(&mut stage);
        assert!((0.05..0.95).contains(&share(&color)), "{}", share(&color));
        // Holes of a hash in single pixels say nothing of the silhouette, so shadows meet the color of four samples; with one
        // sample their areas are compared.
        let against_shadow = if msaa == Msaa::Off {
            0.0
        } else {
            silhouettes_differ(&color, &shadow)
        };
        let off = [
            silhouettes_differ(&color, &depth),
            against_shadow,
            (share(&color) - share(&depth)).abs(),
            (share(&color) - share(&shadow)).abs(),
        ];
        if off.iter().any(|off| *off > 0.01) {
            keep("color", &color);
            keep("depth", &depth);
            keep("shadow", &shadow);
        }
        report += &format!(
            "{msaa:?} {transparency:?}: {off:?}, covered {} and {}\n",
            share(&color),
            share(&shadow)
        );
        worst = off.into_iter().fold(worst, f32::max);
        let normals = shown(&mut stage, Shown::Normal);
        let inside: Vec<[f32; 3]> = (0..normals.len())
            .filter(|i| depth[*i] > 0.99)
            .map(|i| normals[i])
            .collect();
        let [x, y, z] = mean_color(&inside);
        assert!(
            z > 0.9 && (x - 0.5).abs() < 0.2 && (y - 0.5).abs() < 0.3,
            "normals {x} {y} {z}"
        );
    }
    println!("{report}");
    assert!(worst < 0.01, "silhouettes differ:\n{report}");
}

/// A stage under a sun from the upper right.
fn lit_stage() -> Option<Stage> {
    let mut stage = Stage::new()?;
    stage.app.world_mut().spawn((
        DirectionalLight::default(),
        Transform::from_xyz(0.4, 0.5, 1.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    Some(stage)
}

/// Behind a depth prepass the color pass shades only what shows, by other pipelines: nothing else may change (with the window of the
/// order closed, which is there to change it). Cards of every
/// class are drawn by pipelines of their own, too: together they show what one pipeline for all of them shows.
#[test]
fn a_depth_prepass_changes_no_color() {
    let Some(mut stage) = lit_stage() else {
        return;
    };
    let camera = stage.camera;
    let bird = spawn_patch(
        &mut stage,
        40,
        Vec3::ZERO,
        showing(DebugView::None, FeatherTransparency::AlphaToCoverage),
    );
    stage.settle();
    let (samples, hashed) = (
        FeatherTransparency::AlphaToCoverage,
        FeatherTransparency::Hashed,
    );
    let near = PerspectiveProjection {
        near: 0.001,
        ..default()
    };
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(Projection::Perspective(near));
    let mut classes = [0; bevy_plumage::CARD_COUNTERS.len()];
    // Every class of cards draws its own prepass: from afar, from near, from nearer.
    for (msaa, transparency, distance) in [
        (Msaa::Sample4, samples, 0.5),
        (Msaa::Off, hashed, 0.5),
        (Msaa::Off, samples, 0.07),
        (Msaa::Off, samples, 0.03),
    ] {
        let mut draw = |transparency, prepass: bool, light_budget: f32| {
            let place = Transform::from_xyz(0.0, 0.0, distance);
            let world = stage.app.world_mut();
            let mut eye = world.entity_mut(camera);
            eye.insert((msaa, place)).remove::<DepthPrepass>();
            if prepass {
                eye.insert(DepthPrepass);
            }
            let mut quality = showing(DebugView::None, transparency);
            quality.settings.order_window = 0.0;
            quality.settings.light_budget = light_budget;
            world.entity_mut(bird).insert(quality);
            frames(&mut stage, 3);
            stage.picture()
        };
        let usual = FeatherSettings::default().light_budget;
        let without = draw(transparency, false, usual);
        let with = draw(transparency, true, usual);
        // No class has a pipeline of its own where feathers would go to a list that the camera does not have; there all light is found
        // in fragments.
        let together = draw(FeatherTransparency::OrderIndependent, false, usual);
        let apart = draw(transparency, false, 0.0);
        for (class, count) in classes.iter_mut().zip(counts(&mut stage)) {
            *class += count;
        }
        let off = [rms(&with, &without), rms(&together, &apart)];
        println!(
            "{msaa:?} {transparency:?} {distance}: {off:?} {classes:?} {}",
            mean(&without)
        );
        assert!(mean(&without) > 0.02, "nothing is lit at {distance}");
        assert!(
            off[0] < 1.0 / 255.0,
            "{msaa:?} {transparency:?} {distance}: {off:?}"
        );
        assert!(
            transparency == hashed || off[1] < 1.0 / 255.0,
            "{msaa:?} {transparency:?} {distance}: {off:?}"
        );
    }
    let [_, near, far, mean, mixed, lit, _] = classes;
    assert!(
        far > 20 && mean + lit > 20 && near + mixed > 20,
        "{classes:?}"
    );
}

/// Bevy draws many meshes at once where their material does not matter; that of feathers always does. A bird in the middle of the view is
/// drawn by its own classes in the depth prepass, not by those of one beside the view, whose cards are culled.
#[test]
fn a_depth_prepass_knows_every_bird() {
    let Some(mut stage) = lit_stage() else {
        return;
    };
    let camera = stage.camera;
    let place = Transform::from_xyz(0.0, 0.0, 0.25);
    stage.app.world_mut().entity_mut(camera).insert(place);
    let mut quality = showing(DebugView::None, FeatherTransparency::AlphaToCoverage);
    quality.settings.order_window = 0.0;
    let mut worst = 0.0_f32;
    for places in [[0.13, 0.0], [0.0, 0.13]] {
        let birds = places.map(|x| spawn_patch(&mut stage, 60, Vec3::new(x, 0.0, 0.0), quality));
        stage.settle();
        let mut eye = stage.app.world_mut().entity_mut(camera);
        eye.insert(Msaa::Sample4).remove::<DepthPrepass>();
        frames(&mut stage, 3);
        let without = stage.picture();
        stage
            .app
            .world_mut()
            .entity_mut(camera)
            .insert(DepthPrepass);
        frames(&mut stage, 3);
        let off = rms(&stage.picture(), &without);
        let counts = counts(&mut stage);
        println!("{places:?}: {off}, mean {}, {counts:?}", mean(&without));
        assert!(mean(&without) > 0.02, "nothing is lit");
        assert!(counts[0] > 10, "no card is culled: {counts:?}");
        worst = worst.max(off);
        for bird in birds {
            stage.app.world_mut().entity_mut(bird).despawn();
        }
        frames(&mut stage, 2);
    }
    assert!(worst < 1.0 / 255.0, "{worst}");
}

#[derive(Component)]
struct Drift(Vec3);

fn drift(mut drifting: Query<(&mut Transform, &Drift)>) {
    for (mut transform, drift) in &mut drifting {
        transform.translation += drift.0;
    }
}

/// Feathers on a moving joint and on a moving entity without joints: their motion vectors say how far.
#[test]
fn motion_vectors_follow_the_pose() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), |app| {
        with_sheets(app);
        app.add_systems(Update, drift);
    }) else {
        return;
    };
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert((
        orthographic(),
        Msaa::Off,
        MotionVectorPrepass,
    ));
    let solid = showing(DebugView::Normal, FeatherTransparency::Hashed);
    let skinned = spawn_patch(&mut stage, 60, Vec3::ZERO, solid);
    let joint = stage
        .app
        .world()
        .get::<SkinnedMesh>(skinned)
        .unwrap()
        .joints[0];
    let plain = spawn_patch(&mut stage, 60, Vec3::X, solid);
    stage
        .app
        .world_mut()
        .entity_mut(plain)
        .remove::<SkinnedMesh>();
    stage.settle();
    // The picture is 0.12 m wide; up is down in it.
    let step = Vec3::new(7e-5, -5e-5, 0.0);
    let wanted = [step.x / 0.12, -step.y / 0.12];
    hang_sheet(&mut stage, Shown::Motion);
    for (what, moved, at) in [("joint", joint, 0.0), ("entity", plain, 1.0)] {
        let mut eye = stage.app.world_mut().get_mut::<Transform>(camera).unwrap();
        eye.translation.x = at;
        frames(&mut stage, 4);
        let still = stage.picture();
        stage.app.world_mut().entity_mut(moved).insert(Drift(step));
        frames(&mut stage, 4);
        let moving = stage.picture();
        stage.app.world_mut().entity_mut(moved).remove::<Drift>();
        let apart: Vec<[f32; 2]> = (0..still.len())
            .map(|i| [0, 1].map(|c| (moving[i][c] - still[i][c]) / 500.0))
            .filter(|[x, y]| x.hypot(*y) > 1e-5)
            .collect();
        let covered = apart.len() as f32 / still.len() as f32;
        let found = [0, 1].map(|c| apart.iter().map(|p| p[c]).sum::<f32>() / apart.len() as f32);
        println!("{what}: {found:?}, wanted {wanted:?}, covered {covered}");
        assert!(covered > 0.3, "{what}: only {covered} move");
        assert!(
            (0..2).all(|c| (found[c] / wanted[c] - 1.0).abs() < 0.03),
            "{what}: {found:?}, wanted {wanted:?}"
        );
    }
}
