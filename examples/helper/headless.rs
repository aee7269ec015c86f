//! Off-screen rendering: loads, warms up, renders, writes the picture and the statistics.

use super::{Args, camera::OffScreen, compare, stats};
use bevy::{
    app::PluginsState,
    asset::UntypedAssetLoadFailedEvent,
    light::DirectionalLightShadowMap,
    prelude::*,
    render::{
        render_resource::{PollType, TextureFormat, TextureUsages},
        renderer::{RenderAdapterInfo, RenderDevice},
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
};
use bevy_plumage::prelude::*;
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};
use wgpu_types::DeviceType;

/// Longest wait for assets and grooms.
const LOAD_TIMEOUT: Duration = Duration::from_secs(120);
/// Wait for the rest after a file has failed to load.
const FAILURE_GRACE: Duration = Duration::from_secs(3);
/// Frames before the first measured one: pipelines compile, shadow maps fill, buffers settle.
const WARM_UP: u32 = 3;

/// Whether any driver offers an adapter.
pub fn adapter_exists() -> bool {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    !pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY)).is_empty()
}

/// Runs `app` to its picture and leaves the process.
pub fn run(mut app: App, name: &str, args: &Args) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    let image = target(&mut app, args.size);
    app.insert_resource(OffScreen(image.clone()));
    let device = app.world().resource::<RenderAdapterInfo>().device_type;
    if device == DeviceType::Cpu {
        // Shadow maps are the dearest part of a picture drawn by software.
        app.insert_resource(DirectionalLightShadowMap { size: 1024 });
    }
    load(&mut app, name);
    if let Some(file) = &args.compare {
        if let Err(error) = compare::run(&mut app, &image, file) {
            eprintln!("{name}: {error}");
            std::process::exit(1);
        }
        std::process::exit(0);
    }
    println!("{name}: rendering {} frames", args.frames.max(1));
    for _ in 0..WARM_UP {
        frame(&mut app);
    }
    let mut times = Vec::new();
    for _ in 0..args.frames.max(1) {
        times.push(frame(&mut app));
    }
    let output = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{name}.png")));
    let written = capture(&mut app, image)
        .and_then(|picture| picture.to_rgb8().save(&output).map_err(|e| e.to_string()));
    match written {
        Ok(()) => println!("{name}: wrote {}", shown(&output)),
        Err(error) => {
            eprintln!("{name}: {}: {error}", shown(&output));
            std::process::exit(1);
        }
    }
    let stats = stats::collect(&mut app, &mut times);
    println!("{name}: {stats:#}");
    if args.bench {
        println!(
            "{name}: {}x{}, 4x MSAA: {:.1} ms a frame (median of {}) on {}, {:.2} MB",
            args.size.0,
            args.size.1,
            stats["frame_ms"].as_f64().unwrap_or_default(),
            args.frames.max(1),
            stats["adapter"].as_str().unwrap_or_default(),
            stats["undercoat"]["bytes"].as_f64().unwrap_or_default() / 1e6,
        );
    }
    if let Some(path) = &args.stats
        && let Err(error) = std::fs::write(path, format!("{stats:#}\n"))
    {
        eprintln!("{name}: {}: {error}", shown(path));
        std::process::exit(1);
    }
    if let Some(exit) = app.should_exit() {
        eprintln!("{name}: the renderer stopped: {exit:?}");
        std::process::exit(1);
    }
    // Leaves without tearing the app down: nothing is left to save.
    std::process::exit(0);
}

fn shown(path: &Path) -> String {
    std::fs::canonicalize(path)
        .unwrap_or_else(|_| path.to_path_buf())
        .display()
        .to_string()
}

fn target(app: &mut App, (width, height): (u32, u32)) -> Handle<Image> {
    let mut image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// One frame and the time until the GPU is done with it.
pub fn frame(app: &mut App) -> Duration {
    let start = Instant::now();
    app.update();
    let _ = app
        .world()
        .resource::<RenderDevice>()
        .wgpu_device()
        .poll(PollType::Wait {
            submission_index: None,
            timeout: None,
        });
    start.elapsed()
}

/// Updates until every plumage is ready (or has failed), with progress.
fn load(app: &mut App, name: &str) {
    let start = Instant::now();
    let mut shown = String::new();
    let mut last_failure = None;
    while start.elapsed() < LOAD_TIMEOUT {
        app.update();
        let mut states = app.world_mut().query::<&PlumageState>();
        let (mut all, mut ready, mut failed) = (0, 0, 0);
        for state in states.iter(app.world()) {
            all += 1;
            ready += u32::from(state.is_ready());
            failed += u32::from(state.error.is_some());
        }
        let mut coats = app.world_mut().query::<&UndercoatState>();
        for coat in coats.iter(app.world()) {
            all += 1;
            ready += u32::from(coat.ready && coat.error.is_none());
            failed += u32::from(coat.error.is_some());
        }
        let failures = app
            .world()
            .resource::<Messages<UntypedAssetLoadFailedEvent>>()
            .len();
        if failures > 0 {
            // A bird whose own file is missing or damaged never gets as far as its plumage; the log has the reason.
            last_failure = Some(Instant::now());
        }
        let given_up = last_failure.is_some_and(|at| at.elapsed() > FAILURE_GRACE);
        let text = format!("{name}: {ready} of {all} coats grown");
        if text != shown {
            println!("{text}");
            shown = text;
        }
        let settled = all == ready + failed && start.elapsed().as_millis() > 200;
        if settled || given_up || app.should_exit().is_some() {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    eprintln!("{name}: not everything was loaded within {LOAD_TIMEOUT:?}");
}

/// The picture of the next frame.
pub fn capture(app: &mut App, image: Handle<Image>) -> Result<image::DynamicImage, String> {
    let got: Arc<Mutex<Option<Image>>> = Arc::default();
    let keep = got.clone();
    app.world_mut()
        .spawn(Screenshot::image(image))
        .observe(move |shot: On<ScreenshotCaptured>| {
            if let Ok(mut slot) = keep.lock() {
                *slot = Some(shot.image.clone());
            }
        });
    for _ in 0..100 {
        frame(app);
        let taken = got.lock().ok().and_then(|mut slot| slot.take());
        if let Some(image) = taken {
            return image.try_into_dynamic().map_err(|e| e.to_string());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Err("the picture did not come back from the GPU".into())
}
