//! The command line that all examples share.

use bevy::prelude::*;
use bevy_plumage::{Channel, CoverageMethod, MaskTexture, MaskValues, prelude::*};
use clap::{
    Parser, ValueEnum,
    builder::{PossibleValuesParser, TypedValueParser},
};
use std::path::PathBuf;

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
    /// Head and neck through a portrait lens; where an example has no such shot, the close-up.
    Head,
    /// From far away.
    Far,
    /// Circles the subject.
    Orbit,
}

/// Light and surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scene {
    /// One sun under an even sky.
    Studio,
    /// A branch at the edge of a wood.
    Forest,
    /// A dead branch above hills, in the morning.
    Cliff,
    /// An old branch at dusk.
    Dusk,
}

/// Whether depth is drawn first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DepthFirst {
    /// Where a GPU draws: it saves more than half of what feathers cost there. In software it costs a tenth.
    #[default]
    Gpu,
    /// Yes.
    On,
    /// No.
    Off,
}

/// What fur consists of; the alternatives that the hybrid fur paper compares.
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

/// Names of the debug views on the command line.
pub const VIEWS: &[(&str, DebugView)] = &[
    ("shaded", DebugView::None),
    ("coverage", DebugView::Coverage),
    ("lod", DebugView::Lod),
    ("card", DebugView::Card),
    ("layer", DebugView::Layer),
    ("normal", DebugView::Normal),
    ("barb", DebugView::Barb),
    ("lobe", DebugView::Lobe),
    ("overdraw", DebugView::Overdraw),
];

const FUR_VIEWS: &[(&str, UndercoatView)] = &[
    ("shaded", UndercoatView::None),
    ("prism", UndercoatView::Prism),
    ("cells", UndercoatView::Cells),
    ("height", UndercoatView::Height),
    ("tier", UndercoatView::Tier),
    ("opacity", UndercoatView::Opacity),
    ("sky", UndercoatView::Sky),
    ("bent", UndercoatView::Bent),
    ("normal", UndercoatView::Normal),
    ("tile", UndercoatView::Tile),
];

const COVERAGES: &[(&str, CoverageMethod)] = &[
    ("chosen", CoverageMethod::Chosen),
    #[cfg(feature = "comparison")]
    ("published", CoverageMethod::Published),
    #[cfg(feature = "comparison")]
    ("supersampled", CoverageMethod::Supersampled),
];

const TRANSPARENCIES: &[(&str, FeatherTransparency)] = &[
    ("alpha-to-coverage", FeatherTransparency::AlphaToCoverage),
    ("hashed", FeatherTransparency::Hashed),
    ("order-independent", FeatherTransparency::OrderIndependent),
    ("blend", FeatherTransparency::Blend),
];

const PATHS: &[(&str, FeatherPath)] = &[
    ("full", FeatherPath::Full),
    ("fallback", FeatherPath::Fallback),
];

/// Parses one of the names in a table.
fn one_of<T: Copy + Send + Sync + 'static>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(name, _)| *name)).try_map(move |given| {
        let entry = table.iter().find(|(name, _)| *name == given);
        entry.map(|(_, value)| *value).ok_or("no such name")
    })
}

/// Options of the examples. Each example ignores those that are not about it.
#[derive(Parser, Resource, Clone, Debug)]
pub struct Args {
    /// Render off screen even if there is a display.
    #[arg(long)]
    pub headless: bool,
    /// Size of the window or picture, pixels.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Folder of the assets, with `birds`, `grooms` and `feathers` in it.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/assets"))]
    pub assets: PathBuf,

    /// Where the camera stands.
    #[arg(long, value_enum, default_value_t, help_heading = "Camera")]
    pub camera: Shot,
    /// Camera distance relative to the shot's own.
    #[arg(long, default_value_t = 1.0, help_heading = "Camera")]
    pub distance: f32,
    /// Turns the camera around its subject, degrees.
    #[arg(
        long,
        default_value_t = 0.0,
        allow_hyphen_values = true,
        help_heading = "Camera"
    )]
    pub turn: f32,
    /// Raises the camera about its subject (below 0: lowers it), degrees.
    #[arg(
        long,
        default_value_t = 0.0,
        allow_hyphen_values = true,
        help_heading = "Camera"
    )]
    pub tilt: f32,

    /// Light and surroundings; the example's choice when absent. Measurements are made in the studio.
    #[arg(long, value_enum, help_heading = "Scene")]
    pub scene: Option<Scene>,
    /// Freeze the animation at this time, seconds.
    #[arg(long, help_heading = "Scene")]
    pub time: Option<f32>,
    /// Number of feathers relative to the groom's own; the example's choice when absent.
    #[arg(long, help_heading = "Scene")]
    pub density: Option<f32>,
    /// Seed of the groom.
    #[arg(long, default_value_t = 1, help_heading = "Scene")]
    pub seed: u64,
    /// Speed of the wind from the front, m/s; gusts add as much again.
    #[arg(long, default_value_t = 0.0, help_heading = "Scene")]
    pub wind: f32,
    /// How far the birds ruffle their feathers, 0 to 1.
    #[arg(long, default_value_t = 0.0, help_heading = "Scene")]
    pub ruffle: f32,
    /// How wet the feathers are, 0 to 1.
    #[arg(long, default_value_t = 0.0, help_heading = "Scene")]
    pub wetness: f32,
    /// How much soil lies on them, 0 to 1.
    #[arg(long, default_value_t = 0.0, help_heading = "Scene")]
    pub dirt: f32,
    /// How far they are from their molt, 0 to 1.
    #[arg(long, default_value_t = 0.0, help_heading = "Scene")]
    pub age: f32,
    /// Puts the sun behind the subject.
    #[arg(long, help_heading = "Scene")]
    pub backlight: bool,
    /// Turns the sun around the subject, degrees.
    #[arg(
        long,
        default_value_t = 0.0,
        allow_hyphen_values = true,
        help_heading = "Scene"
    )]
    pub sun: f32,

    /// What is drawn.
    #[arg(long, default_value = "shaded", value_parser = one_of(VIEWS), help_heading = "Rendering")]
    pub view: DebugView,
    /// What is drawn instead of shaded fur.
    #[arg(long, default_value = "shaded", value_parser = one_of(FUR_VIEWS), help_heading = "Rendering")]
    pub fur_view: UndercoatView,
    /// Transparency mode of the feathers; the example's choice when absent.
    #[arg(long, value_parser = one_of(TRANSPARENCIES), help_heading = "Rendering")]
    pub transparency: Option<FeatherTransparency>,
    /// How coverage is found (all but `chosen` need the feature `comparison`).
    #[arg(long, default_value = "chosen", value_parser = one_of(COVERAGES), help_heading = "Rendering")]
    pub coverage: CoverageMethod,
    /// Samples of the sky per pixel, 0 to 1024; 0 takes the prefiltered maps.
    #[arg(long, default_value_t = 0, help_heading = "Rendering")]
    pub env_samples: u32,
    /// Error of light up to which it is found at the vertices of distant cards, 0 to 0.1; 0: found in every fragment.
    #[arg(long, help_heading = "Rendering")]
    pub light_budget: Option<f32>,
    /// Depth first: only what shows is shaded, and the coat's order decides within its window. Not for blended feathers.
    #[arg(long, value_enum, default_value_t, num_args = 0..=1, require_equals = true, default_missing_value = "on", help_heading = "Rendering")]
    pub depth_prepass: DepthFirst,
    /// `parrot`, `eagle`, `owl`, `flock`: what feathers are drawn as: themselves, or (what a device gets whose limits are too low) textured cards with a
    /// `StandardMaterial`.
    #[arg(long, default_value = "full", value_parser = one_of(PATHS), help_heading = "Rendering")]
    pub path: FeatherPath,
    /// For slow machines: no shadows; `inspector` also draws the bird smaller, and only when something has changed.
    #[arg(long, help_heading = "Rendering")]
    pub lean: bool,

    /// Picture to write; NAME.png when absent.
    #[arg(long, help_heading = "Off screen")]
    pub output: Option<PathBuf>,
    /// Frames to time before the picture is taken; 2 with `--stats` or `--bench`, otherwise none.
    #[arg(long, help_heading = "Off screen")]
    pub frames: Option<u32>,
    /// Average this many frames, each from another place in the pixel, on the lens and on the sun: a picture without noise. The
    /// animation stands still.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=65536), help_heading = "Off screen")]
    pub accumulate: Option<u32>,
    /// Several pictures from one coat, in the place of `--camera` and `--output`: a camera and the file it fills, as
    /// `--shot back=parrot_back.png`.
    #[arg(long, value_name = "CAMERA=FILE", value_parser = parse_shot, help_heading = "Off screen")]
    pub shot: Vec<(Shot, PathBuf)>,
    /// Folder for a mask of each `--shot`, under its name: feathers in colors of their own, bill, eyes, feet and bare skin blue,
    /// everything else black; and a JSON that says what a pixel measures.
    #[arg(long, requires = "shot", help_heading = "Off screen")]
    pub masks: Option<PathBuf>,
    /// Statistics to write, as JSON; with `--shot` a folder for those of each picture.
    #[arg(long, help_heading = "Off screen")]
    pub stats: Option<PathBuf>,
    /// Print a line with the adapter, milliseconds a frame and bytes of fur; `--frames` says how many are timed.
    #[arg(long, help_heading = "Off screen")]
    pub bench: bool,
    /// `single_feather`: time the feather with and without its thin layers, this many frames each in turn, and print both.
    #[arg(long, help_heading = "Off screen")]
    pub layers_cost: Option<u32>,
    /// `parrot`, `eagle`, `owl`, `flock`: time the scene with its feathers and with the same cards in a `StandardMaterial`, this many frames
    /// each in turn, and print both.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Off screen")]
    pub cards_cost: Option<u32>,
    /// `parrot`: time the scene over the number of feathers, the size of the picture and the number of lights, beside the same cards in a
    /// `StandardMaterial`; write it as a table.
    #[arg(long, help_heading = "Off screen")]
    pub cost_table: Option<PathBuf>,
    /// Draw the scene under several light budgets; write what each costs and how wrong it is, as a table, and its pictures beside it.
    #[arg(long, help_heading = "Off screen")]
    pub light_cost: Option<PathBuf>,
    /// Render by every way to find coverage; write what each costs and how wrong it is, as JSON.
    #[cfg(feature = "comparison")]
    #[arg(long, help_heading = "Off screen")]
    pub compare: Option<PathBuf>,

    /// `single_feather`: a file of `assets/feathers`, without its ending.
    #[arg(long, default_value = "macaw_primary", help_heading = "Subject")]
    pub feather: String,
    /// `single_feather`: as many by as many copies, each that much smaller, in the place of one.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64), help_heading = "Subject")]
    pub copies: u32,
    /// `single_feather`: a photograph to make a feather of and to show beside it (feature `photo`).
    #[arg(long, help_heading = "Subject")]
    pub photo: Option<PathBuf>,
    /// `your_own_mesh`, `fur`: a glTF file.
    #[arg(long, help_heading = "Subject")]
    pub mesh: Option<PathBuf>,
    /// `your_own_mesh`: a mask painted into a texture, as `density=mask.png` or `lift:green:0:30=mask.png`: what it sets (density,
    /// length, lift), its channel, and the values at the channel's 0 and at its full value.
    #[arg(long, value_name = "WHAT=FILE", value_parser = parse_mask, help_heading = "Subject")]
    pub mask: Vec<MaskTexture>,
    /// Animation of that file that plays.
    #[arg(long, default_value_t = 0, help_heading = "Subject")]
    pub clip: usize,
    /// `fur`: how it is drawn.
    #[arg(long, value_enum, default_value_t, help_heading = "Subject")]
    pub mode: FurMode,
    /// `fur`, `chick`: a file of `assets/downs`, without its ending; the example's choice when absent.
    #[arg(long, help_heading = "Subject")]
    pub down: Option<String>,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let (width, height) = text
        .split_once('x')
        .ok_or_else(|| format!("`{text}` is not WIDTHxHEIGHT"))?;
    let side = |text: &str| {
        text.parse::<u32>()
            .ok()
            .filter(|side| (16..=8192).contains(side))
            .ok_or_else(|| format!("`{text}`: a side is 16 to 8192 pixels"))
    };
    Ok((side(width)?, side(height)?))
}

fn parse_shot(text: &str) -> Result<(Shot, PathBuf), String> {
    let (camera, file) = text
        .split_once('=')
        .ok_or_else(|| format!("`{text}` is not CAMERA=FILE"))?;
    Ok((Shot::from_str(camera, true)?, PathBuf::from(file)))
}

fn parse_mask(text: &str) -> Result<MaskTexture, String> {
    let (what, file) = text
        .split_once('=')
        .ok_or_else(|| format!("`{text}` is not WHAT=FILE"))?;
    let mut words = what.split(':');
    let kind = words.next().unwrap_or_default();
    let channel = match words.next().unwrap_or("red") {
        "red" => Channel::Red,
        "green" => Channel::Green,
        "blue" => Channel::Blue,
        "alpha" => Channel::Alpha,
        other => return Err(format!("`{other}` is not red, green, blue or alpha")),
    };
    let mut value = |usual: f32| match words.next() {
        None => Ok(usual),
        Some(text) => text
            .parse::<f32>()
            .map_err(|_| format!("`{text}` is no number")),
    };
    let sets = match kind {
        "density" => MaskValues::Density(value(0.0)?, value(1.0)?),
        "length" => MaskValues::Length(value(0.3)?, value(1.0)?),
        "lift" => MaskValues::Lift(value(0.0)?, value(30.0)?),
        other => return Err(format!("`{other}` is not density, length or lift")),
    };
    let path = std::path::absolute(file).map_err(|error| error.to_string())?;
    Ok(MaskTexture::new(path.to_string_lossy().into_owned(), sets).with_channel(channel))
}

impl Args {
    /// Whether there is no screen to show a window on, or none is wanted.
    pub fn off_screen(&self) -> bool {
        let no_display = cfg!(target_os = "linux")
            && std::env::var_os("DISPLAY").is_none()
            && std::env::var_os("WAYLAND_DISPLAY").is_none();
        self.headless || no_display
    }

    /// The quality that the command line asks for; `usual` is the example's own transparency mode.
    pub fn quality(&self, usual: FeatherTransparency) -> FeatherQuality {
        let mut quality = FeatherQuality {
            transparency: self.transparency.unwrap_or(usual),
            ..default()
        };
        quality.settings.debug_view = self.view;
        quality.settings.coverage_method = self.coverage;
        quality.settings.environment_samples = self.env_samples;
        if let Some(budget) = self.light_budget {
            quality.settings.light_budget = budget;
        }
        quality
    }

    /// The ruffle and the weather that the command line asks for.
    pub fn condition(&self) -> (Ruffle, Weathering) {
        let weather = Weather {
            wetness: self.wetness,
            dirt: self.dirt,
            age: self.age,
        };
        let ruffle = Ruffle {
            amount: self.ruffle,
            ..default()
        };
        (ruffle, Weathering::new(weather))
    }

    /// The time at which the animation stands still, seconds.
    pub fn frozen(&self) -> Option<f32> {
        self.time.or(self.accumulate.map(|_| 0.0))
    }

    /// Samples of the camera: none for the transparency modes that do without.
    pub fn msaa(&self) -> Msaa {
        match self.transparency {
            Some(FeatherTransparency::Hashed | FeatherTransparency::OrderIndependent) => Msaa::Off,
            _ => Msaa::Sample4,
        }
    }
}
