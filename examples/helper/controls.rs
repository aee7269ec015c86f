//! Mouse and keys of the windows.

use super::{
    Args, Shot,
    args::VIEWS,
    camera::{Orbit, Shots, place},
    help::{Help, announce, keep_in_front, show_help, toggle_help},
};
use bevy::{
    input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll},
    prelude::*,
};
#[cfg(feature = "inspector")]
use bevy_egui::input::EguiWantsInput;
#[cfg(feature = "inspector")]
use bevy_plumage::inspector::Inspector;
use bevy_plumage::prelude::*;

/// Wind of the key W, m/s.
const BREEZE: f32 = 3.0;

/// Mouse, keys and their list.
pub struct ControlsPlugin;

impl Plugin for ControlsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Help>();
        if app.world().resource::<Args>().off_screen() {
            return;
        }
        app.add_systems(Startup, (keep_in_front, announce))
            .add_systems(
                Update,
                (
                    turn.run_if(mouse_is_free),
                    (press_keys, toggle_help).run_if(keys_are_free),
                    show_help,
                )
                    .chain(),
            );
    }
}

#[cfg(feature = "inspector")]
fn mouse_is_free(panels: Option<Res<EguiWantsInput>>) -> bool {
    !panels.is_some_and(|panels| panels.wants_any_pointer_input())
}

#[cfg(feature = "inspector")]
fn keys_are_free(panels: Option<Res<EguiWantsInput>>) -> bool {
    !panels.is_some_and(|panels| panels.wants_any_keyboard_input())
}

#[cfg(not(feature = "inspector"))]
fn mouse_is_free() -> bool {
    true
}

#[cfg(not(feature = "inspector"))]
fn keys_are_free() -> bool {
    true
}

/// The left button turns (the right one too, also while a tool has the left), the wheel moves closer.
fn turn(
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    #[cfg(feature = "inspector")] inspector: Option<Res<Inspector>>,
    mut cameras: Query<(&mut Transform, &Orbit)>,
) {
    #[cfg(feature = "inspector")]
    let taken = inspector.is_some_and(|inspector| inspector.takes_drags());
    #[cfg(not(feature = "inspector"))]
    let taken = false;
    for (mut transform, orbit) in &mut cameras {
        let left = buttons.pressed(MouseButton::Left) && !taken;
        if left || buttons.pressed(MouseButton::Right) {
            let right = transform.right();
            let turn = Quat::from_rotation_y(-motion.delta.x * 0.006)
                * Quat::from_axis_angle(*right, -motion.delta.y * 0.006);
            transform.rotate_around(orbit.target, turn);
            transform.look_at(orbit.target, Vec3::Y);
        }
        if scroll.delta.y != 0.0 {
            let offset = transform.translation - orbit.target;
            transform.translation = orbit.target + offset * 0.9f32.powf(scroll.delta.y);
        }
    }
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    args: Res<Args>,
    shots: Res<Shots>,
    mut cameras: Query<(&mut Transform, &mut Projection, &mut Orbit)>,
    mut players: Query<&mut AnimationPlayer>,
    mut qualities: Query<&mut FeatherQuality>,
    mut ruffles: Query<&mut Ruffle>,
    mut wind: ResMut<Wind>,
) {
    let command = [KeyCode::ControlLeft, KeyCode::ControlRight];
    if keys.any_pressed(command) {
        return;
    }
    let digits = [
        (KeyCode::Digit1, Shot::Far),
        (KeyCode::Digit2, Shot::Hero),
        (KeyCode::Digit3, Shot::Full),
        (KeyCode::Digit4, Shot::Back),
        (KeyCode::Digit5, Shot::Closeup),
        (KeyCode::Digit6, Shot::Macro),
        (KeyCode::Digit7, Shot::Head),
    ];
    for (_, shot) in digits.iter().filter(|(key, _)| keys.just_pressed(*key)) {
        let framing = shots.framing(*shot);
        for (mut transform, mut projection, mut orbit) in &mut cameras {
            (*transform, *projection) = place(framing, &args);
            orbit.target = framing.target;
        }
    }
    if keys.just_pressed(KeyCode::Space) {
        for mut player in &mut players {
            if player.all_paused() {
                player.resume_all();
            } else {
                player.pause_all();
            }
        }
    }
    if keys.just_pressed(KeyCode::KeyV) {
        for mut quality in &mut qualities {
            let view = &mut quality.settings.debug_view;
            let now = VIEWS.iter().position(|(_, of)| of == view).unwrap_or(0);
            *view = VIEWS[(now + 1) % VIEWS.len()].1;
        }
    }
    if keys.just_pressed(KeyCode::KeyW) {
        let speed = if wind.speed > 0.0 { 0.0 } else { BREEZE };
        *wind = Wind::new(wind.direction, speed);
    }
    if keys.just_pressed(KeyCode::KeyR) {
        for mut ruffle in &mut ruffles {
            ruffle.amount = if ruffle.amount > 0.0 { 0.0 } else { 1.0 };
        }
    }
}
