//! Devices with the least limits, and devices below them.

use bevy::{
    core_pipeline::{
        oit::OrderIndependentTransparencySettings,
        prepass::{DepthPrepass, MotionVectorPrepass, NormalPrepass},
    },
    prelude::*,
    render::{
        render_resource::{BufferDescriptor, BufferUsages},
        renderer::RenderDevice,
        settings::{WgpuLimits, WgpuSettings, WgpuSettingsPriority},
    },
};
use bevy_plumage::groom::PlumageParts;
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    view::{frames, mean, mean_color, showing, spawn_patch},
};

#[test]
fn the_limits_of_webgpu_are_enough() {
    let settings = WgpuSettings {
        priority: WgpuSettingsPriority::WebGPU,
        ..default()
    };
    let Some(mut stage) = Stage::with(settings, |_| {}) else {
        return;
    };
    let limits = stage.app.world().resource::<RenderDevice>().limits();
    assert_eq!(limits.max_storage_buffers_per_shader_stage, 8);
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert((
        Msaa::Off,
        DepthPrepass,
        NormalPrepass,
        MotionVectorPrepass,
        OrderIndependentTransparencySettings::default(),
    ));
    stage.app.world_mut().spawn((
        PointLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(0.1, 0.2, 0.5),
    ));
    spawn_patch(
        &mut stage,
        60,
        Vec3::ZERO,
        showing(DebugView::None, FeatherTransparency::OrderIndependent),
    );
    stage.settle();
    assert_eq!(
        stage
            .app
            .world()
            .resource::<bevy_plumage::ActiveFeatherPath>()
            .get(),
        FeatherPath::Full
    );
    assert!(mean(&stage.picture()) > 0.01, "nothing is drawn");
}

#[test]
fn a_device_below_the_limits_gets_the_fallback() {
    // Bevy itself can do with fewer layers than feathers want.
    let settings = WgpuSettings {
        constrained_limits: Some(WgpuLimits {
            max_texture_array_layers: 32,
            ..default()
        }),
        ..default()
    };
    let Some(mut stage) = Stage::with(settings, |_| {}) else {
        return;
    };
    assert_eq!(
        stage
            .app
            .world()
            .resource::<bevy_plumage::ActiveFeatherPath>()
            .get(),
        FeatherPath::Fallback
    );
    let bird = spawn_patch(&mut stage, 60, Vec3::ZERO, FeatherQuality::default());
    stage.settle();
    frames(&mut stage, 3);
    let world = stage.app.world();
    let cards = world.get::<PlumageParts>(bird).unwrap()[0];
    assert!(
        world
            .get::<MeshMaterial3d<StandardMaterial>>(cards)
            .is_some()
    );
    assert!(
        world
            .get::<MeshMaterial3d<FeatherMaterial>>(cards)
            .is_none()
    );
    let picture = stage.picture();
    let lit = picture
        .iter()
        .filter(|p| p.iter().sum::<f32>() > 0.02)
        .count();
    let share = lit as f32 / picture.len() as f32;
    assert!((0.1..0.6).contains(&share), "cut-out cards cover {share}");
    // Red like the groom's tint.
    let [r, g, b] = mean_color(&picture);
    assert!(r > 1.5 * g && r > 1.5 * b, "{r} {g} {b}");
}

/// What the other tests rely on: an error of the GPU's validation ends the app, and so the test.
#[test]
fn a_validation_error_fails_a_test() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    stage.frame();
    let device = stage.app.world().resource::<RenderDevice>();
    // Memory for nothing is against the rules.
    device.create_buffer(&BufferDescriptor {
        label: Some("wrong"),
        size: 16,
        usage: BufferUsages::empty(),
        mapped_at_creation: false,
    });
    let run = std::panic::AssertUnwindSafe(|| frames(&mut stage, 3));
    let failed = std::panic::catch_unwind(run).unwrap_err();
    let said = failed.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let said = said.or_else(|| failed.downcast_ref::<String>().cloned());
    assert!(said.unwrap().contains("the renderer stopped"));
}
