//! What the examples share: the command line, a camera with its controls, light and sky, and rendering off screen.
//!
//! An example hands [`run`] a function that adds `PlumagePlugins` and its own scene; everything about feathers stands in the example.
#![allow(dead_code, reason = "every example uses its own part")]

pub mod accumulate;
pub mod album;
pub mod args;
pub mod backdrop;
pub mod branch;
pub mod camera;
#[cfg(feature = "comparison")]
pub mod compare;
pub mod controls;
pub mod cost;
pub mod cost_table;
pub mod foliage;
pub mod foreground;
pub mod gpu_clock;
pub mod growth;
pub mod headless;
pub mod help;
pub mod noise;
pub mod posture;
pub mod scene;
pub mod setting;
pub mod sky;
pub mod stats;
pub mod surroundings;
pub mod tone;

pub use args::{Args, Shot};

use bevy::{
    asset::UnapprovedPathMode,
    pbr::DefaultOpaqueRendererMethod,
    prelude::*,
    render::{
        RenderPlugin, diagnostic::RenderDiagnosticsPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_plumage::prelude::*;
use clap::Parser;
use std::time::Duration;

/// Builds an app around `scene` and runs it, in a window or off screen. `name` names the window and the picture.
pub fn run(name: &'static str, scene: fn(&mut App)) -> AppExit {
    let args = Args::parse();
    if !headless::adapter_exists() {
        eprintln!(
            "{name}: no graphics adapter found. Install a Vulkan driver (on Debian or Ubuntu: `apt-get install \
             mesa-vulkan-drivers libvulkan1`), then try again."
        );
        return AppExit::error();
    }
    if args.cards_cost.is_some() || args.cost_table.is_some() {
        let apps = [FeatherPath::Full, FeatherPath::Fallback].map(|path| {
            let args = Args {
                path,
                ..args.clone()
            };
            build(name, scene, &args)
        });
        return headless::compare(apps, name, |apps| {
            match (args.cards_cost, &args.cost_table) {
                (_, Some(file)) => cost_table::run(apps, name, args.size, file),
                (rounds, None) => cost::compare_cards(apps, rounds.unwrap_or(1), name),
            }
        });
    }
    let mut app = build(name, scene, &args);
    if args.off_screen() {
        headless::run(app, name, &args)
    } else {
        app.run()
    }
}

fn build(name: &'static str, scene: fn(&mut App), args: &Args) -> App {
    let off_screen = args.off_screen();
    let mut app = App::new();
    let plugins = DefaultPlugins
        .set(AssetPlugin {
            file_path: args.assets.to_string_lossy().into_owned(),
            // A mesh named on the command line may lie anywhere.
            unapproved_path_mode: UnapprovedPathMode::Allow,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation: off_screen || args.lean,
            ..default()
        })
        .set(WindowPlugin {
            primary_window: (!off_screen).then(|| Window {
                title: format!("bevy_plumage: {name} (F1: keys)"),
                resolution: args.size.into(),
                ..default()
            }),
            exit_condition: if off_screen {
                ExitCondition::DontExit
            } else {
                ExitCondition::OnAllClosed
            },
            ..default()
        });
    if off_screen {
        let frame = Duration::from_secs_f32(1.0 / 30.0);
        app.add_plugins(
            plugins
                .disable::<WinitPlugin>()
                .disable::<PipelinedRenderingPlugin>(),
        )
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    } else {
        app.add_plugins((plugins, growth::GrowthPlugin(name)));
    }
    app.insert_resource(args.clone())
        .insert_resource(setting::Setting::chosen(args, name))
        .insert_resource(Wind::new(Vec3::new(-0.35, 0.1, -1.0), args.wind))
        .insert_resource(DefaultOpaqueRendererMethod::forward())
        .insert_resource(ClearColor(Color::srgb(0.72, 0.76, 0.80)))
        .add_plugins((
            RenderDiagnosticsPlugin,
            gpu_clock::GpuClockPlugin,
            scene::ScenePlugin,
            posture::PosturePlugin,
            camera::CameraPlugin,
            controls::ControlsPlugin,
        ));
    scene(&mut app);
    app
}
