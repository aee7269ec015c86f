//! A parrot with every panel of the inspector: `make inspector`. Off screen, the panels are drawn into the picture. F1 lists the keys.

mod helper;

use bevy::{
    camera::{ClearColorConfig, RenderTarget, visibility::RenderLayers},
    core_pipeline::tonemapping::DebandDither,
    diagnostic::FrameCount,
    prelude::*,
    render::render_resource::TextureFormat,
    window::PrimaryWindow,
};
use bevy_egui::{
    EguiContext, EguiContexts, EguiGlobalSettings, EguiPrimaryContextPass, EguiTextureHandle,
    PrimaryEguiContext, egui,
};
use bevy_plumage::inspector::{Document, Inspector, InspectorSystems, PlumageInspectorPlugin};
use bevy_plumage::prelude::*;
use clap::Parser;
use helper::{
    Args,
    camera::{OffScreen, Shots, shot},
    help::Help,
    scene,
};

/// Height of the bird's picture with `--lean`.
const LEAN_HEIGHT: u32 = 300;
/// Frames that it is drawn after a change.
const AWAKE: u32 = 2;

const SHOTS: Shots = Shots {
    hero: shot([0.0; 3], [1.5, 0.4, 1.7], 22.0),
    closeup: shot([0.0; 3], [0.3, 0.2, 0.5], 22.0),
    macro_: shot([0.0; 3], [0.1, 0.1, 0.25], 22.0),
    full: shot([0.0; 3], [2.2, 0.3, 0.6], 22.0),
    back: shot([0.0; 3], [-0.9, 0.6, -2.0], 22.0),
    head: None,
    far: shot([0.0; 3], [3.9, 1.1, 5.2], 22.0),
};

/// Keys of the inspector itself.
const KEYS: [(&str, &str); 4] = [
    ("F12", "show or hide the panels"),
    ("Ctrl+Z", "undo; with Shift: redo"),
    ("Ctrl+S", "save"),
    ("C", "hold to compare with the file"),
];

fn main() -> AppExit {
    helper::run("inspector", |app| {
        let args = Args::parse();
        if args.lean && !args.off_screen() {
            look_seldom(app, args.size);
        }
        let mut help = app.world_mut().resource_mut::<Help>();
        help.lines.extend(KEYS);
        app.insert_resource(SHOTS)
            .add_plugins(PlumagePlugins)
            .add_plugins(PlumageInspectorPlugin {
                assets: args.assets,
            })
            .add_systems(Startup, setup)
            .add_systems(Update, name_window);
    })
}

/// Says in the title of the window what no file holds.
fn name_window(
    inspector: Res<Inspector>,
    args: Res<Args>,
    frame: Res<FrameCount>,
    birds: Query<(&PlumageState, Option<&FeatherQuality>)>,
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
) {
    let (Ok(mut window), Some((state, quality))) = (
        windows.single_mut(),
        inspector.bird.and_then(|bird| birds.get(bird).ok()),
    ) else {
        return;
    };
    let settings = quality.copied().unwrap_or_default().settings;
    let picked = inspector.picked.as_ref().map_or_else(
        || "nothing".to_owned(),
        |picked| format!("card {}", picked.card),
    );
    let (back, forth) = inspector
        .feather
        .and_then(|id| inspector.feathers.get(id))
        .map_or((0, 0), Document::depth);
    // Who waits for the picture of a slow machine wants to know how far it is.
    let frame = if args.lean { frame.0 } else { 0 };
    let title = format!(
        "bevy_plumage: inspector | {} feathers | error budget {:.5} | view {:?} | picked {picked} | {back} to undo, {forth} to redo | frame {frame}",
        state.cards, settings.error_budget, settings.debug_view,
    );
    if window.title != title {
        window.title = title;
    }
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    commands.spawn((
        Name::new("parrot"),
        scene::bird(&assets, "parrot", 0.0),
        Plumage::new(assets.load("grooms/parrot.groom.ron"))
            .with_seed(args.seed)
            .with_density(args.density.unwrap_or(1.0)),
        args.quality(FeatherTransparency::default()),
        args.condition(),
    ));
    commands.spawn(scene::PARROT_PERCH);
}

/// The camera that draws the bird into a picture, with `--lean`.
#[derive(Component)]
struct Seldom(u32);

/// The camera of the window, which shows that picture and the panels.
#[derive(Component)]
struct Front;

/// Draws the bird into a small picture, anew only when something has changed: a window then answers at once even where a frame
/// of feathers takes seconds.
fn look_seldom(app: &mut App, (width, height): (u32, u32)) {
    let size = UVec2::new(width * LEAN_HEIGHT / height.max(1), LEAN_HEIGHT).max(UVec2::ONE);
    let image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    app.insert_resource(OffScreen(image))
        .insert_resource(EguiGlobalSettings {
            auto_create_primary_context: false,
            ..default()
        })
        .add_systems(PostStartup, spawn_front)
        .add_systems(PostUpdate, look)
        .add_systems(EguiPrimaryContextPass, show.before(InspectorSystems));
}

fn spawn_front(
    mut commands: Commands,
    cameras: Query<(Entity, &Transform, &Projection, &RenderTarget), With<Camera3d>>,
) {
    for (entity, transform, projection, target) in &cameras {
        if !matches!(target, RenderTarget::Image(_)) {
            continue;
        }
        commands
            .entity(entity)
            .insert((Seldom(0), DebandDither::Disabled));
        commands.spawn((
            Front,
            Camera3d::default(),
            Camera {
                order: 1,
                clear_color: ClearColorConfig::Custom(Color::BLACK),
                ..default()
            },
            Msaa::Off,
            DebandDither::Disabled,
            *transform,
            projection.clone(),
            RenderLayers::none(),
            EguiContext::default(),
            PrimaryEguiContext,
        ));
    }
}

/// Wakes the bird's camera when something has changed, and keeps the window's camera where it is.
fn look(
    mut events: MessageReader<AssetEvent<Feather>>,
    mut cameras: Query<(Ref<Transform>, &mut Camera, &mut Seldom), Without<Front>>,
    mut front: Query<&mut Transform, With<Front>>,
    changes: Query<
        (),
        Or<(
            Changed<FeatherQuality>,
            Changed<PlumageState>,
            Added<Mesh3d>,
        )>,
    >,
) {
    let edited = events
        .read()
        .any(|event| !matches!(event, AssetEvent::Unused { .. }));
    for (transform, mut camera, mut seldom) in &mut cameras {
        if edited || !changes.is_empty() || transform.is_changed() {
            seldom.0 = AWAKE;
        }
        camera.is_active = seldom.0 > 0;
        seldom.0 = seldom.0.saturating_sub(1);
        for mut front in &mut front {
            front.set_if_neq(*transform);
        }
    }
}

fn show(mut contexts: EguiContexts, picture: Res<OffScreen>) -> Result {
    let texture = contexts
        .image_id(&picture.0)
        .unwrap_or_else(|| contexts.add_image(EguiTextureHandle::Strong(picture.0.clone())));
    let context = contexts.ctx_mut()?;
    let painter = context.layer_painter(egui::LayerId::background());
    let uv = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    painter.image(texture, context.content_rect(), uv, egui::Color32::WHITE);
    Ok(())
}
