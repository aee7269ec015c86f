//! The cards of a bird for engines without this plugin: a skinned `.glb` with an atlas of its feathers, and curves and cards as text USD.
//!
//! `cargo run --example bake -- --mesh path/to/model.glb --output out/bird`: writes `out/bird.glb`, `out/bird.usda` and
//! `out/bird.png` (the atlas). Without `--mesh`: the parrot in its groom. Needs neither a window nor a GPU. Skeleton and pose are those
//! of the file; feathers of rows hang on the joint that carries them most, without the fan. Leaves with an error code when nothing was
//! written.

mod atlas;
mod gather;
mod glb;
mod progress;
mod usd;

use bevy::{
    app::PluginsState,
    asset::{LoadState, UnapprovedPathMode},
    gltf::GltfAssetLabel,
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
    world_serialization::WorldAssetRoot,
};
use bevy_plumage::{UndercoatPlugin, prelude::*};
use clap::Parser;
use progress::Progress;
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

/// Longest wait for the file and its feathers.
const PATIENCE: Duration = Duration::from_secs(600);

/// What to bake.
#[derive(Parser, Clone)]
struct Args {
    /// A glTF file; the parrot when absent.
    #[arg(long)]
    mesh: Option<PathBuf>,
    /// A groom; by what the mesh itself offers when absent (the parrot has its own).
    #[arg(long)]
    groom: Option<PathBuf>,
    /// Seed of the groom.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of feathers relative to the groom's own, 0.01 to 16.
    #[arg(long, default_value_t = 1.0)]
    density: f32,
    /// Width of one feather in the atlas, pixels, 8 to 512; it is four times as high.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(8..=512))]
    texels: u32,
    /// Files to write, without their endings.
    #[arg(long, default_value = "bake")]
    output: PathBuf,
}

fn main() -> ExitCode {
    match bake(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nbake: {error}");
            ExitCode::FAILURE
        }
    }
}

/// An app that grooms and draws nothing.
fn app() -> App {
    let mut app = App::new();
    let no_gpu = WgpuSettings {
        backends: None,
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .set(AssetPlugin {
                file_path: concat!(env!("CARGO_MANIFEST_DIR"), "/assets").into(),
                unapproved_path_mode: UnapprovedPathMode::Allow,
                ..default()
            })
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(no_gpu)),
                ..default()
            })
            .disable::<WinitPlugin>()
            .disable::<bevy::log::LogPlugin>(),
    )
    .add_plugins(
        PlumagePlugins
            .build()
            .disable::<FeatherRenderPlugin>()
            .disable::<UndercoatPlugin>(),
    );
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app
}

fn absolute(path: &Path) -> Result<PathBuf, String> {
    std::path::absolute(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn bake(args: &Args) -> Result<(), String> {
    let mut progress = Progress::default();
    progress.show(0.0, "starting");
    let mut app = app();
    let server = app.world().resource::<AssetServer>().clone();
    let (scene, groom) = match &args.mesh {
        Some(mesh) => (absolute(mesh)?, args.groom.as_deref()),
        None => {
            let own = Path::new("grooms/parrot.groom.ron");
            (
                PathBuf::from("birds/parrot.glb"),
                args.groom.as_deref().or(Some(own)),
            )
        }
    };
    let scene: Handle<_> = server.load(GltfAssetLabel::Scene(0).from_asset(scene));
    let groom: Handle<Groom> = match groom {
        Some(groom) if groom.exists() => server.load(absolute(groom)?),
        Some(groom) => server.load(groom.to_path_buf()),
        None => Handle::default(),
    };
    let plumage = Plumage::new(groom)
        .with_seed(args.seed)
        .with_density(args.density);
    let bird = app
        .world_mut()
        .spawn((
            WorldAssetRoot(scene.clone()),
            plumage,
            Transform::default(),
            Visibility::default(),
        ))
        .id();
    let begun = Instant::now();
    loop {
        app.update();
        let state = app.world().get::<PlumageState>(bird);
        let state = state.ok_or("the bird is gone")?;
        if let Some(error) = &state.error {
            return Err(error.clone());
        }
        if let LoadState::Failed(error) = server.load_state(&scene) {
            return Err(error.to_string());
        }
        if state.is_ready() {
            break;
        }
        let waited = begun.elapsed();
        if waited > PATIENCE {
            return Err(format!("no feathers after {} s", waited.as_secs()));
        }
        // Grooming says nothing of its end; the bar comes nearer and nearer.
        let share = 1.0 - (-waited.as_secs_f32() / 20.0).exp();
        progress.show(
            0.05 + 0.65 * share,
            &format!("grooming, {} s", waited.as_secs()),
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    // Transforms are propagated, rows follow, and the skin's colors are taken.
    (0..5).for_each(|_| app.update());
    let state = app.world().get::<PlumageState>(bird);
    for warning in state.iter().flat_map(|state| &state.warnings) {
        eprintln!("\nbake: {warning}");
    }
    let bird = gather::gather(app.world(), bird)?;
    let atlas = atlas::atlas(&bird, args.texels as usize, |share, name| {
        progress.show(0.7 + 0.2 * share, &format!("feather {name}"));
    })?;
    if let Some(folder) = args.output.parent() {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let write = |ending: &str, bytes: &[u8]| {
        let path = args.output.with_extension(ending);
        std::fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok::<_, String>(format!("{} ({} bytes)", path.display(), bytes.len()))
    };
    let mut written = vec![write("png", &atlas.png)?];
    progress.show(0.92, "glTF");
    written.push(write("glb", &glb::write(&bird, &atlas)?)?);
    progress.show(0.96, "USD");
    let picture = args.output.with_extension("png");
    let picture = picture.file_name().unwrap_or_default().to_string_lossy();
    let text = usd::write(&bird, &atlas, &picture);
    written.push(write("usda", text.as_bytes())?);
    progress.show(1.0, &format!("{} feathers", bird.cards.len()));
    println!();
    for file in written {
        println!("bake: wrote {file}");
    }
    Ok(())
}
