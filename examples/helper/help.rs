//! The list of keys that F1 shows in a window.

use super::camera::Orbit;
use bevy::prelude::*;

/// Height of a letter, pixels.
const LETTER: f32 = 11.0;
/// Anchor of a text at its upper left corner.
const TOP_LEFT: Vec2 = Vec2::new(-0.5, 0.5);

/// What F1 shows: keys and what they do. An example with keys of its own adds them.
#[derive(Resource)]
pub struct Help {
    /// One line per key.
    pub lines: Vec<(&'static str, &'static str)>,
    shown: bool,
}

impl Default for Help {
    fn default() -> Self {
        Self {
            lines: vec![
                ("F1", "show these keys"),
                ("drag", "turn"),
                ("wheel", "move closer or away"),
                (
                    "1 to 7",
                    "shots: far, whole, side, back, barbs, barbules, head",
                ),
                ("Space", "stop or resume the animation"),
                ("V", "next debug view"),
                ("W", "wind on or off"),
                ("R", "ruffle or smooth the feathers"),
            ],
            shown: false,
        }
    }
}

/// Writes the list to the log.
pub fn announce(help: Res<Help>) {
    let lines = help
        .lines
        .iter()
        .map(|(key, what)| format!("\n  {key:8} {what}"));
    info!("keys:{}", lines.collect::<String>());
}

/// Shows or hides the list.
pub fn toggle_help(keys: Res<ButtonInput<KeyCode>>, mut help: ResMut<Help>) {
    if keys.just_pressed(KeyCode::F1) {
        help.shown = !help.shown;
    }
}

/// Text is drawn by gizmos, which Bevy's 3D renderer has without its user interface: in front of everything.
pub fn keep_in_front(mut store: ResMut<GizmoConfigStore>) {
    store.config_mut::<DefaultGizmoConfigGroup>().0.depth_bias = -1.0;
}

/// Writes the keys into the upper left of the picture.
pub fn show_help(
    help: Res<Help>,
    cameras: Query<(&Transform, &Projection, &Camera), With<Orbit>>,
    mut gizmos: Gizmos,
) {
    if !help.shown {
        return;
    }
    let column = |of: fn(&(&'static str, &'static str)) -> &'static str| {
        help.lines.iter().map(of).collect::<Vec<_>>().join("\n")
    };
    let columns = [(0.0, column(|line| line.0)), (80.0, column(|line| line.1))];
    for (transform, projection, camera) in &cameras {
        let (Projection::Perspective(lens), Some(size)) =
            (projection, camera.logical_viewport_size())
        else {
            continue;
        };
        // A plane so close that nothing of the scene is in the way, and what a pixel measures there.
        let distance = 2.0 * lens.near;
        let pixel = 2.0 * distance * (0.5 * lens.fov).tan() / size.y;
        // White on a black shadow, legible on any background; what is drawn first stays in front.
        for (shift, color) in [(0.0, Color::WHITE), (1.0, Color::BLACK)] {
            for (x, text) in &columns {
                let corner =
                    Vec2::new(x + 20.0 + shift, -20.0 - shift) + Vec2::new(-0.5, 0.5) * size;
                let place = transform.transform_point((corner * pixel).extend(-distance));
                let isometry = Isometry3d::new(place, transform.rotation);
                gizmos.text(isometry, text, LETTER * pixel, TOP_LEFT, color);
            }
        }
    }
}
