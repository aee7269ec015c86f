//! Apps with all of Bevy's plugins, but no GPU: what the plugin does to the world of the app, without a picture.

use crate::wait::until;
use bevy::{
    app::{PluginGroupBuilder, PluginsState},
    asset::UnapprovedPathMode,
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_plumage::prelude::*;

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
