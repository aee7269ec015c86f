//! Apps without a GPU: what the plugins do to the world of the app, without a picture.

use crate::wait::until;
use bevy::{
    app::{PluginGroupBuilder, Plugins, PluginsState},
    asset::UnapprovedPathMode,
    mesh::MeshPlugin,
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_plumage::{
    anatomy::AnatomyPlugin, groom::GroomPlugin, prelude::*, skin_color::SkinColorPlugin,
    weathering::WeatheringPlugin,
};
use std::path::Path;

/// Bevy's plugins without a window, with this package's assets.
pub fn plugins(render: RenderPlugin) -> PluginGroupBuilder {
    DefaultPlugins
        .set(AssetPlugin {
            file_path: crate::asset("").display().to_string(),
            // A file named on a command line may lie anywhere.
            unapproved_path_mode: UnapprovedPathMode::Allow,
            ..default()
        })
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(render)
        .disable::<WinitPlugin>()
}

/// Adds what the app's plugins add late, a renderer among it.
pub fn finish(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}

/// The app, with feathers drawn in this way.
pub fn app(path: FeatherPath) -> App {
    let settings = WgpuSettings {
        backends: None,
        ..default()
    };
    let mut app = App::new();
    app.add_plugins(plugins(RenderPlugin {
        render_creation: RenderCreation::Automatic(Box::new(settings)),
        ..default()
    }))
    .add_plugins(PlumagePlugins.set(FeatherRenderPlugin { path }));
    finish(&mut app);
    app
}

/// No renderer: feathers grow, of assets in this folder; and what `more` does.
pub fn grooms<M>(assets: &Path, more: impl Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: assets.display().to_string(),
            ..default()
        },
        MeshPlugin,
        AnatomyPlugin,
        GroomPlugin,
    ))
    .add_plugins(more);
    finish(&mut app);
    app
}

/// No renderer, but materials and textures: feathers grow, and take over colors and weather.
pub fn grooms_and_paints() -> App {
    let mut app = grooms(&crate::asset(""), (SkinColorPlugin, WeatheringPlugin));
    app.init_asset::<Image>().init_asset::<StandardMaterial>();
    app
}

/// Frames until it is so.
pub fn wait(app: &mut App, what: &str, mut done: impl FnMut(&mut World) -> bool) {
    until(what, || {
        let done = done(app.world_mut());
        if !done {
            app.update();
        }
        done.then_some(())
    });
}
