//! One command line, one light and one headless loop for all examples.
#![allow(dead_code, reason = "every example uses its own part")]

pub mod camera;
pub mod compare;
pub mod headless;
pub mod scene;
pub mod sky;
pub mod stats;

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
use bevy_plumage::{prelude::*, render::CoverageMethod};
use clap::{Parser, ValueEnum};
use std::{path::PathBuf, time::Duration};

/// Where the camera stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Shot {
    /// Three-quarter front view of the whole subject.
    #[default]
    Hero,
    /// A hand's width away: barbs.
    Closeup,
    /// Closer still: barbules.
    Macro,
    /// From the side, everything in the picture.
    Full,
    /// From behind.
    Back,
    /// From far away.
    Far,
    /// Circles the subject.
    Orbit,
}

/// What is drawn instead of the shaded feathers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum View {
    /// Shaded.
    #[default]
    Shaded,
    /// Coverage of rachis and barbs, distal, proximal barbules.
    Coverage,
    /// LOD class.
    Lod,
    /// A colour per card.
    Card,
    /// Layer of the card.
    Layer,
    /// Normal of the card.
    Normal,
    /// A colour per barb.
    Barb,
    /// Where the light of the fibres goes: surface red, front green, back blue.
    Lobe,
    /// Number of fragments over one another.
    Overdraw,
}

/// How coverage is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Coverage {
    /// The cheapest evaluator within the budget.
    #[default]
    Chosen,
    /// The paper's hard switch.
    Published,
    /// Thousands of point queries per pixel.
    Supersampled,
}

impl From<Coverage> for CoverageMethod {
    fn from(coverage: Coverage) -> Self {
        match coverage {
            Coverage::Chosen => Self::Chosen,
            Coverage::Published => Self::Published,
            Coverage::Supersampled => Self::Supersampled,
        }
    }
}

impl From<View> for DebugView {
    fn from(view: View) -> Self {
        match view {
            View::Shaded => Self::None,
            View::Coverage => Self::Coverage,
            View::Lod => Self::Lod,
            View::Card => Self::Card,
            View::Layer => Self::Layer,
            View::Normal => Self::Normal,
            View::Barb => Self::Barb,
            View::Lobe => Self::Lobe,
            View::Overdraw => Self::Overdraw,
        }
    }
}

/// How what lies behind a feather shows through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Transparency {
    /// MSAA samples.
    AlphaToCoverage,
    /// A pattern fixed to the feather, without MSAA.
    Hashed,
    /// Bevy's order-independent transparency, without MSAA.
    OrderIndependent,
    /// Blended in the order of the mesh.
    Blend,
}

impl From<Transparency> for FeatherTransparency {
    fn from(transparency: Transparency) -> Self {
        match transparency {
            Transparency::AlphaToCoverage => Self::AlphaToCoverage,
            Transparency::Hashed => Self::Hashed,
            Transparency::OrderIndependent => Self::OrderIndependent,
            Transparency::Blend => Self::Blend,
        }
    }
}

/// How fur is drawn, as the figures of the hybrid fur paper compare it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FurMode {
    /// Single hairs only.
    Explicit,
    /// The marched volume only.
    Volume,
    /// Both.
    #[default]
    Hybrid,
    /// Shells with precomputed transfer.
    Shells,
}

/// What is drawn instead of shaded fur.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FurView {
    /// Shaded.
    #[default]
    Shaded,
    /// A colour per prism.
    Prism,
    /// Cells crossed by the ray.
    Cells,
    /// Height at which the ray is halfway absorbed.
    Height,
    /// Near red, mid green, far blue.
    Tier,
    /// Opacity to the eye.
    Opacity,
    /// Mean visibility of the sky.
    Sky,
    /// Bent vector.
    Bent,
    /// Normal of the shell.
    Normal,
    /// Place in the tile.
    Tile,
}

impl From<FurView> for UndercoatView {
    fn from(view: FurView) -> Self {
        match view {
            FurView::Shaded => Self::None,
            FurView::Prism => Self::Prism,
            FurView::Cells => Self::Cells,
            FurView::Height => Self::Height,
            FurView::Tier => Self::Tier,
            FurView::Opacity => Self::Opacity,
            FurView::Sky => Self::Sky,
            FurView::Bent => Self::Bent,
            FurView::Normal => Self::Normal,
            FurView::Tile => Self::Tile,
        }
    }
}

/// The command line of every example.
#[derive(Parser, Resource, Clone, Debug)]
pub struct Args {
    /// Render off screen even if there is a display.
    #[arg(long)]
    pub headless: bool,
    /// Size of the picture.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Where the camera stands.
    #[arg(long, value_enum, default_value_t)]
    pub camera: Shot,
    /// Freeze the animation at this time, seconds.
    #[arg(long)]
    pub time: Option<f32>,
    /// Frames to render once everything is loaded (headless).
    #[arg(long, default_value_t = 2)]
    pub frames: u32,
    /// Picture to write (headless).
    #[arg(long)]
    pub output: Option<PathBuf>,
    /// Statistics to write as JSON (headless).
    #[arg(long)]
    pub stats: Option<PathBuf>,
    /// Feathers relative to the groom's own number; the example's choice when absent.
    #[arg(long)]
    pub density: Option<f32>,
    /// Seed of the groom.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// What is drawn.
    #[arg(long, value_enum, default_value_t)]
    pub view: View,
    /// How what lies behind a feather shows through it; the example's choice when absent.
    #[arg(long, value_enum)]
    pub transparency: Option<Transparency>,
    /// Speed of the wind from the front, m/s; gusts add as much again.
    #[arg(long, default_value_t = 0.0)]
    pub wind: f32,
    /// How far the birds ruffle their feathers, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    pub ruffle: f32,
    /// How coverage is found.
    #[arg(long, value_enum, default_value_t)]
    pub coverage: Coverage,
    /// Render by every way to find coverage, and write what each costs and how wrong it is as JSON (headless).
    #[arg(long)]
    pub compare: Option<PathBuf>,
    /// Feather shown by `single_feather`.
    #[arg(long, default_value = "macaw_primary")]
    pub feather: String,
    /// Samples of the sky per pixel, 0 to 1024; 0 takes the prefiltered maps.
    #[arg(long, default_value_t = 0)]
    pub env_samples: u32,
    /// The sun stands behind the subject.
    #[arg(long)]
    pub backlight: bool,
    /// Mesh feathered by `your_own_mesh`, a glTF file.
    #[arg(long)]
    pub mesh: Option<PathBuf>,
    /// Animation of that mesh that plays.
    #[arg(long, default_value_t = 0)]
    pub clip: usize,
    /// Photograph that `single_feather` makes a feather of and shows beside it (feature `extract`).
    #[arg(long)]
    pub photo: Option<PathBuf>,
    /// Folder of the assets, with `birds`, `grooms` and `feathers` in it.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/assets"))]
    pub assets: PathBuf,
    /// For slow machines: without shadows; `inspector` also draws the bird in fewer pixels, and only when something has changed.
    #[arg(long)]
    pub lean: bool,
    /// Camera distance relative to the shot's own.
    #[arg(long, default_value_t = 1.0)]
    pub distance: f32,
    /// How `fur` is drawn.
    #[arg(long, value_enum, default_value_t)]
    pub mode: FurMode,
    /// What is drawn instead of shaded fur.
    #[arg(long, value_enum, default_value_t)]
    pub fur_view: FurView,
    /// Coat of `fur` and `chick`, a file in `assets/downs`; the example's choice when absent.
    #[arg(long)]
    pub down: Option<String>,
    /// Turns the sun around the subject, degrees.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub sun: f32,
    /// Print a line with adapter, milliseconds a frame and bytes of fur (headless; say how many `--frames`).
    #[arg(long)]
    pub bench: bool,
    /// Turns the camera around its subject, degrees.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub turn: f32,
    /// Raises the camera about its subject (below 0: lowers it), degrees.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub tilt: f32,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let (w, h) = text
        .split_once('x')
        .ok_or_else(|| format!("`{text}` is not WIDTHxHEIGHT"))?;
    let side = |s: &str| {
        s.parse::<u32>()
            .ok()
            .filter(|v| (16..=8192).contains(v))
            .ok_or_else(|| format!("`{s}`: a side is 16 to 8192 pixels"))
    };
    Ok((side(w)?, side(h)?))
}

impl Args {
    /// Whether there is no screen to show a window on, or none is wanted.
    pub fn off_screen(&self) -> bool {
        let no_display = cfg!(target_os = "linux")
            && std::env::var_os("DISPLAY").is_none()
            && std::env::var_os("WAYLAND_DISPLAY").is_none();
        self.headless || no_display
    }

    /// Quality that `--view` and `--transparency` ask for; `usual` is the example's own transparency.
    pub fn quality(&self, usual: FeatherTransparency) -> FeatherQuality {
        let mut quality = FeatherQuality {
            transparency: self.transparency.map_or(usual, FeatherTransparency::from),
            ..default()
        };
        quality.settings.debug_view = self.view.into();
        quality.settings.coverage_method = self.coverage.into();
        quality.settings.environment_samples = self.env_samples;
        quality
    }

    /// Samples of the camera: the ways of transparency that do without have none.
    pub fn msaa(&self) -> Msaa {
        match self.transparency {
            Some(Transparency::Hashed | Transparency::OrderIndependent) => Msaa::Off,
            _ => Msaa::Sample4,
        }
    }
}

/// Builds the app around `scene` and runs it, in a window or off screen. `name` names the window and the default picture.
pub fn run(name: &'static str, scene: fn(&mut App)) {
    let args = Args::parse();
    if !headless::adapter_exists() {
        eprintln!(
            "{name}: no graphics adapter found. Install a Vulkan driver (on Debian or Ubuntu: `apt-get install \
             mesa-vulkan-drivers libvulkan1`), then try again."
        );
        std::process::exit(1);
    }
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
                title: format!("bevy_plumage: {name}"),
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
        app.add_plugins(
            plugins
                .disable::<WinitPlugin>()
                .disable::<PipelinedRenderingPlugin>(),
        )
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
            1.0 / 30.0,
        )));
    } else {
        app.add_plugins(plugins);
    }
    app.insert_resource(args.clone())
        .insert_resource(Wind::new(Vec3::new(-0.35, 0.1, -1.0), args.wind))
        .insert_resource(DefaultOpaqueRendererMethod::forward())
        .insert_resource(ClearColor(Color::srgb(0.72, 0.76, 0.80)))
        .add_plugins((
            RenderDiagnosticsPlugin,
            PlumagePlugins,
            scene::ScenePlugin,
            camera::CameraPlugin,
        ));
    scene(&mut app);
    if off_screen {
        headless::run(app, name, &args);
    } else {
        app.run();
    }
}
