//! Rendering off screen: waits for the coats, renders, writes the picture and the statistics.

use super::{
    Args,
    accumulate::{self, Sum},
    camera::{OffScreen, Orbit},
    growth::{FailedFiles, Growth},
    setting::Setting,
    sky::from_half,
    stats, tone,
};
use bevy::{
    app::PluginsState,
    core_pipeline::tonemapping::Tonemapping,
    ecs::entity::EntityHashSet,
    light::DirectionalLightShadowMap,
    prelude::*,
    render::{
        camera::TemporalJitter,
        render_resource::{Extent3d, PollType, TextureFormat, TextureUsages},
        renderer::{RenderAdapterInfo, RenderDevice},
        view::{
            ColorGrading,
            screenshot::{Screenshot, ScreenshotCaptured},
        },
    },
};
use bevy_plumage::prelude::*;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};
use wgpu_types::DeviceType;

/// Longest wait from one coat to the next.
const LOAD_TIMEOUT: Duration = Duration::from_secs(900);
/// Longest wait for a picture to come back from the GPU: a software renderer that counts what it runs takes minutes.
const CAPTURE_TIMEOUT: Duration = Duration::from_secs(600);
/// Shortest wait: a coat may bring another one (down below feathers).
const LOAD_AT_LEAST: Duration = Duration::from_millis(200);
/// Time between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(2);
/// Frames before the picture: shadow maps fill, buffers settle.
const WARM_UP: u32 = 1;
/// Frames before the first timed one: pipelines compile, counters come back from the GPU.
const WARM_UP_TIMED: u32 = 3;

/// Whether any driver offers an adapter.
pub fn adapter_exists() -> bool {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    !pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY)).is_empty()
}

/// Whether the processor draws.
pub fn in_software(adapter: &RenderAdapterInfo) -> bool {
    adapter.device_type == DeviceType::Cpu
}

/// Runs `app` to its picture.
pub fn run(mut app: App, name: &str, args: &Args) -> AppExit {
    let outcome = picture(&mut app, name, args);
    // Nothing is left to save: no need to tear the app down.
    std::mem::forget(app);
    match outcome {
        Ok(()) => AppExit::Success,
        Err(error) => {
            eprintln!("{name}: {error}");
            AppExit::error()
        }
    }
}

/// Gets an app ready for frames of its scene, which go into the returned image.
fn prepare(app: &mut App, name: &str, args: &Args) -> Result<Handle<Image>, String> {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    let format = match args.accumulate {
        Some(_) => TextureFormat::Rgba16Float,
        None => TextureFormat::Rgba8UnormSrgb,
    };
    let image = target(app, args.size, format);
    app.insert_resource(OffScreen(image.clone()));
    let adapter = app.world().resource::<RenderAdapterInfo>();
    println!("{name}: off screen, on {}", adapter.name);
    if in_software(adapter) {
        // Shadow maps are the most expensive part of a picture drawn in software.
        app.insert_resource(DirectionalLightShadowMap { size: 1024 });
    }
    app.add_systems(Last, close_cameras);
    app.init_resource::<Closed>();
    load(app, name)?;
    open_cameras(app);
    Ok(image)
}

/// Two apps that show the same scene, with feathers and with cards in a `StandardMaterial`, and what they draw to.
pub type Apps<'a> = [(&'a mut App, &'a Handle<Image>); 2];

/// Gets both apps ready for `measure`.
pub fn compare(
    [mut feathers, mut cards]: [App; 2],
    name: &str,
    measure: impl FnOnce(Apps) -> Result<(), String>,
) -> AppExit {
    let ready = |app: &mut App| {
        let args = app.world().resource::<Args>().clone();
        prepare(app, name, &args)
    };
    let outcome = ready(&mut feathers).and_then(|own| {
        let plain = ready(&mut cards)?;
        measure([(&mut feathers, &own), (&mut cards, &plain)])
    });
    std::mem::forget((feathers, cards));
    match outcome {
        Ok(()) => AppExit::Success,
        Err(error) => {
            eprintln!("{name}: {error}");
            AppExit::error()
        }
    }
}

/// Waits for coats that have been changed.
pub fn regrow(app: &mut App, name: &str) -> Result<(), String> {
    app.init_resource::<Closed>();
    load(app, name)?;
    open_cameras(app);
    Ok(())
}

/// Gives the picture another size.
pub fn resize(app: &mut App, image: &Handle<Image>, (width, height): (u32, u32)) {
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    if let Some(mut image) = images.get_mut(image) {
        image.resize(Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        });
    }
}

fn picture(app: &mut App, name: &str, args: &Args) -> Result<(), String> {
    let image = prepare(app, name, args)?;
    #[cfg(feature = "comparison")]
    if let Some(file) = &args.compare {
        return super::compare::run(app, &image, file);
    }
    if let Some(file) = &args.light_cost {
        return super::cost::light(app, &image, file);
    }
    if let Some(rounds) = args.layers_cost {
        super::cost::run(app, rounds.max(1), name);
        return Ok(());
    }
    if !args.shot.is_empty() {
        super::album::run(app, &image, name, args)?;
        return stopped(app);
    }
    let measured = args.stats.is_some() || args.bench;
    let frames = args.frames.unwrap_or(if measured { 2 } else { 0 });
    let warm_up = if frames > 0 { WARM_UP_TIMED } else { WARM_UP };
    let mut times = Vec::new();
    for number in 1..=warm_up + frames {
        let time = frame(app);
        println!(
            "{name}: frame {number} of {}, {:.1} s",
            warm_up + frames,
            time.as_secs_f32()
        );
        if number > warm_up {
            times.push(time);
        }
    }
    let default = PathBuf::from(format!("{name}.png"));
    let output = args.output.as_ref().unwrap_or(&default);
    let picture = develop(app, &image, name, args, args.accumulate)?;
    picture
        .save(output)
        .map_err(|error| format!("{}: {error}", shown(output)))?;
    println!("{name}: wrote {}", shown(output));
    if times.is_empty() {
        return stopped(app);
    }
    let stats = stats::collect(app, &mut times);
    println!("{name}: {stats:#}");
    if args.bench {
        println!(
            "{name}: {}x{}, 4x MSAA: {:.1} ms a frame (median of {frames}) on {}, {:.2} MB",
            args.size.0,
            args.size.1,
            stats["frame_ms"].as_f64().unwrap_or_default(),
            stats["adapter"].as_str().unwrap_or_default(),
            stats["undercoat"]["bytes"].as_f64().unwrap_or_default() / 1e6,
        );
    }
    if let Some(path) = &args.stats {
        std::fs::write(path, format!("{stats:#}\n"))
            .map_err(|error| format!("{}: {error}", shown(path)))?;
    }
    stopped(app)
}

/// The picture of what the camera sees: of the next frame, or the mean of `frames`.
pub fn develop(
    app: &mut App,
    image: &Handle<Image>,
    name: &str,
    args: &Args,
    frames: Option<u32>,
) -> Result<image::RgbImage, String> {
    match frames {
        Some(count) => average(app, image, name, args, count),
        None => Ok(capture(app, image.clone())?.to_rgb8()),
    }
}

/// An error if the renderer has given up.
fn stopped(app: &App) -> Result<(), String> {
    match app.should_exit() {
        Some(exit) => Err(format!("the renderer stopped: {exit:?}")),
        None => Ok(()),
    }
}

/// Cameras that draw nothing for now: on a machine without a GPU a frame takes longer than most of what one waits for.
#[derive(Resource, Default)]
struct Closed(EntityHashSet);

/// Closes cameras while there is a [`Closed`].
fn close_cameras(closed: Option<ResMut<Closed>>, mut cameras: Query<(Entity, &mut Camera)>) {
    let Some(mut closed) = closed else {
        return;
    };
    for (entity, mut camera) in &mut cameras {
        if camera.is_active {
            camera.is_active = false;
            closed.0.insert(entity);
        }
    }
}

/// Opens the cameras that were closed.
fn open_cameras(app: &mut App) {
    let Some(Closed(closed)) = app.world_mut().remove_resource() else {
        return;
    };
    for entity in closed {
        if let Some(mut camera) = app.world_mut().get_mut::<Camera>(entity) {
            camera.is_active = true;
        }
    }
}

fn shown(path: &Path) -> String {
    std::fs::canonicalize(path)
        .unwrap_or_else(|_| path.to_path_buf())
        .display()
        .to_string()
}

fn target(app: &mut App, (width, height): (u32, u32), format: TextureFormat) -> Handle<Image> {
    let mut image = Image::new_target_texture(width, height, format, None);
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

/// Updates until every coat has grown or failed, with progress. An error if there is nothing to look at then.
fn load(app: &mut App, name: &str) -> Result<(), String> {
    let start = Instant::now();
    let mut files = FailedFiles::default();
    let (mut shown, mut at) = (None, start);
    let mut grew = start;
    loop {
        app.update();
        let growth = Growth::of(app.world_mut());
        let given_up = files.given_up(app.world());
        let waited = start.elapsed();
        let grows = shown.as_ref() != Some(&growth);
        if grows || at.elapsed() > PROGRESS {
            println!(
                "{name}: {} of {} coats grown, {:.0} s",
                growth.grown,
                growth.wanted,
                waited.as_secs_f32()
            );
            at = Instant::now();
            if grows {
                (shown, grew) = (Some(growth.clone()), at);
            }
        }
        if let Some(exit) = app.should_exit() {
            return Err(format!("the renderer stopped: {exit:?}"));
        }
        let settled = growth.is_settled() && waited > LOAD_AT_LEAST;
        let timed_out = grew.elapsed() > LOAD_TIMEOUT;
        if settled || given_up || timed_out {
            for error in &growth.errors {
                eprintln!("{name}: {error}");
            }
            if growth.is_bare() {
                return Err("no coat has grown".into());
            }
            // A picture without a coat that is still growing would look like one of a bird without it.
            if timed_out && !settled {
                return Err(format!(
                    "{} of {} coats grown after {waited:.0?}, and none in the last {LOAD_TIMEOUT:.0?}",
                    growth.grown, growth.wanted
                ));
            }
            if !settled {
                eprintln!("{name}: not everything was loaded after {waited:.0?}");
            }
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(5));
    }
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
    let start = Instant::now();
    while start.elapsed() < CAPTURE_TIMEOUT {
        frame(app);
        let taken = got.lock().ok().and_then(|mut slot| slot.take());
        if let Some(image) = taken {
            open_cameras(app);
            return image.try_into_dynamic().map_err(|e| e.to_string());
        }
        app.init_resource::<Closed>();
        std::thread::sleep(Duration::from_millis(2));
    }
    Err("the picture did not come back from the GPU".into())
}

/// The mean of `count` frames, from where camera and lights stand, developed on the scene's film.
fn average(
    app: &mut App,
    image: &Handle<Image>,
    name: &str,
    args: &Args,
    count: u32,
) -> Result<image::RgbImage, String> {
    let setting = *app.world().resource::<Setting>();
    let mut cameras = app
        .world_mut()
        .query_filtered::<(Entity, &Transform, &Orbit), With<Camera3d>>();
    let Some((camera, place, target)) = cameras
        .iter(app.world())
        .map(|(camera, place, orbit)| (camera, *place, orbit.target))
        .next()
    else {
        return Err("no camera".into());
    };
    let mut lights = app
        .world_mut()
        .query_filtered::<(Entity, &Transform), With<DirectionalLight>>();
    let lights: Vec<(Entity, Transform)> = lights.iter(app.world()).map(|(e, t)| (e, *t)).collect();
    app.world_mut()
        .entity_mut(camera)
        .insert(Tonemapping::None)
        .remove::<ColorGrading>();
    let arrived: Arc<Mutex<BTreeMap<u32, Image>>> = Arc::default();
    let (mut sum, mut next, mut latest) = (Sum::default(), 0, Instant::now());
    // A frame comes back from the GPU while later ones are drawn; they are added in order, so that the sum is always the same.
    let mut index = 0;
    while next < count {
        if index < count {
            let at = accumulate::sample(args.seed, index);
            let world = app.world_mut();
            world.entity_mut(camera).insert((
                TemporalJitter { offset: at.pixel },
                accumulate::through_lens(place, target, setting.aperture * at.lens),
            ));
            for (light, place) in &lights {
                world
                    .entity_mut(*light)
                    .insert(accumulate::on_disc(*place, at.sun));
            }
            let keep = arrived.clone();
            world.spawn(Screenshot::image(image.clone())).observe(
                move |shot: On<ScreenshotCaptured>| {
                    if let Ok(mut images) = keep.lock() {
                        images.insert(index, shot.image.clone());
                    }
                },
            );
            set_pattern(world, index);
            println!("{name}: sample {} of {count}", index + 1);
        } else if latest.elapsed() > CAPTURE_TIMEOUT {
            return Err("the picture did not come back from the GPU".into());
        }
        index += 1;
        frame(app);
        while let Some(image) = arrived.lock().ok().and_then(|mut all| all.remove(&next)) {
            let colors: Vec<Vec3> = linear(&image).collect();
            sum.add(&colors);
            next += 1;
            latest = Instant::now();
        }
    }
    let world = app.world_mut();
    set_pattern(world, 0);
    world
        .entity_mut(camera)
        .insert(place)
        .remove::<TemporalJitter>();
    for (light, place) in lights {
        world.entity_mut(light).insert(place);
    }
    let bytes = sum.mean().flat_map(|color| {
        let shown = tone::develop(color, setting.tone, setting.saturation);
        let shown = Color::linear_rgb(shown.x, shown.y, shown.z).to_srgba();
        [shown.red, shown.green, shown.blue].map(|c| (c * 255.0).round() as u8)
    });
    let (width, height) = args.size;
    image::RgbImage::from_raw(width, height, bytes.collect())
        .ok_or_else(|| "the picture has another size".into())
}

/// Gives all feathers the pattern of that number.
fn set_pattern(world: &mut World, number: u32) {
    let mut qualities = world.query::<&mut FeatherQuality>();
    for mut quality in qualities.iter_mut(world) {
        quality.settings.pattern = number;
    }
}

/// Colors of an image of 16-bit floats.
fn linear(image: &Image) -> impl Iterator<Item = Vec3> + '_ {
    let bytes = image.data.as_deref().unwrap_or_default();
    bytes.chunks_exact(8).map(|pixel| {
        Vec3::from_array([0, 2, 4].map(|i| from_half(u16::from_le_bytes([pixel[i], pixel[i + 1]]))))
    })
}
