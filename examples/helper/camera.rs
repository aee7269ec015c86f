//! The camera of the examples: named shots, and the mouse in a window.

use super::{Args, Shot, Transparency, scene::Sky};
use bevy::{
    camera::{Exposure, Hdr, RenderTarget},
    core_pipeline::oit::OrderIndependentTransparencySettings,
    input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll},
    prelude::*,
};
use bevy_egui::input::EguiWantsInput;

/// A shot: what it looks at and from where; the lens is the vertical field of view in degrees.
#[derive(Clone, Copy, Debug)]
pub struct Framing {
    /// Point looked at.
    pub target: Vec3,
    /// Eye.
    pub eye: Vec3,
    /// Vertical field of view, degrees.
    pub fov: f32,
}

/// The shots of one example.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Shots {
    /// Three-quarter front.
    pub hero: Framing,
    /// Barbs.
    pub closeup: Framing,
    /// Barbules.
    pub macro_: Framing,
    /// Everything, from the side.
    pub full: Framing,
    /// From behind.
    pub back: Framing,
    /// Far away.
    pub far: Framing,
}

impl Shots {
    /// Around a model of half a metre that stands at the origin.
    pub fn around_model() -> Self {
        let shot = |x, y, z, fov| Framing {
            target: Vec3::ZERO,
            eye: Vec3::new(x, y, z),
            fov,
        };
        Self {
            hero: shot(1.2, 0.45, 1.4, 14.0),
            closeup: shot(0.35, 0.15, 0.3, 24.0),
            macro_: shot(0.2, 0.08, 0.16, 18.0),
            full: shot(2.0, 0.2, 0.0, 18.0),
            back: shot(-1.0, 0.6, -1.5, 18.0),
            far: shot(3.0, 1.0, 4.0, 24.0),
        }
    }

    fn framing(&self, shot: Shot) -> Framing {
        match shot {
            Shot::Hero => self.hero,
            Shot::Closeup => self.closeup,
            Shot::Macro => self.macro_,
            Shot::Full | Shot::Orbit => self.full,
            Shot::Back => self.back,
            Shot::Far => self.far,
        }
    }
}

/// Image that the off-screen camera draws to.
#[derive(Resource, Clone)]
pub struct OffScreen(pub Handle<Image>);

/// Spawns and moves the camera.
pub struct CameraPlugin;

impl Plugin for CameraPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Sky>()
            .add_systems(Startup, spawn_camera)
            .add_systems(Update, (orbit, turn_by_mouse));
    }
}

#[derive(Component)]
struct Orbit {
    target: Vec3,
}

fn spawn_camera(
    mut commands: Commands,
    args: Res<Args>,
    shots: Res<Shots>,
    sky: Res<Sky>,
    off_screen: Option<Res<OffScreen>>,
) {
    let framing = shots.framing(args.camera);
    let away = Quat::from_rotation_y(args.turn.to_radians()) * (framing.eye - framing.target);
    let tilt = Vec3::Y
        .cross(away)
        .try_normalize()
        .map_or(Quat::IDENTITY, |side| {
            Quat::from_axis_angle(side, -args.tilt.to_radians())
        });
    let eye = framing.target + tilt * away * args.distance;
    let mut camera = commands.spawn((
        Camera3d::default(),
        Hdr,
        args.msaa(),
        Exposure { ev100: 11.4 },
        Projection::Perspective(PerspectiveProjection {
            fov: framing.fov.to_radians(),
            near: 0.002,
            ..default()
        }),
        Transform::from_translation(eye).looking_at(framing.target, Vec3::Y),
        Orbit {
            target: framing.target,
        },
        // Against the light it is evening: the rim is brighter than the sky.
        sky.bundle(if args.backlight { 0.1 } else { 1.0 }),
    ));
    if args.transparency == Some(Transparency::OrderIndependent) {
        camera.insert(OrderIndependentTransparencySettings::default());
    }
    if let Some(image) = off_screen {
        camera.insert(RenderTarget::Image(image.0.clone().into()));
    }
}

fn orbit(args: Res<Args>, time: Res<Time>, mut cameras: Query<(&mut Transform, &Orbit)>) {
    if args.camera != Shot::Orbit {
        return;
    }
    for (mut transform, orbit) in &mut cameras {
        transform.rotate_around(orbit.target, Quat::from_rotation_y(0.4 * time.delta_secs()));
    }
}

/// Left button turns (the right one too, also where a tool has the left), wheel goes nearer.
fn turn_by_mouse(
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    motion: Option<Res<AccumulatedMouseMotion>>,
    scroll: Option<Res<AccumulatedMouseScroll>>,
    panels: Option<Res<EguiWantsInput>>,
    #[cfg(feature = "inspector")] inspector: Option<Res<bevy_plumage::inspector::Inspector>>,
    mut cameras: Query<(&mut Transform, &Orbit)>,
) {
    if panels.is_some_and(|panels| panels.wants_any_pointer_input()) {
        return;
    }
    #[cfg(feature = "inspector")]
    let taken = inspector.is_some_and(|inspector| inspector.takes_drags());
    #[cfg(not(feature = "inspector"))]
    let taken = false;
    let (Some(buttons), Some(motion), Some(scroll)) = (buttons, motion, scroll) else {
        return;
    };
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
