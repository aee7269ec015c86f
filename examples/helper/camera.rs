//! The camera of the examples and its shots.

use super::{
    Args, Shot, args::DepthFirst, backdrop, foreground, headless::in_software, scene::Sky,
    setting::Setting,
};
use bevy::{
    camera::{Exposure, Hdr, RenderTarget},
    core_pipeline::{oit::OrderIndependentTransparencySettings, prepass::DepthPrepass},
    prelude::*,
    render::renderer::RenderAdapterInfo,
};
use bevy_plumage::prelude::*;

/// A shot: where the camera stands and what it looks at.
#[derive(Clone, Copy, Debug)]
pub struct Framing {
    /// Point looked at, metres.
    pub target: Vec3,
    /// Position of the camera, metres.
    pub eye: Vec3,
    /// Vertical field of view, degrees.
    pub fov: f32,
}

/// From `eye` to `target`, both in metres, with a vertical field of view in degrees.
pub const fn shot(target: [f32; 3], eye: [f32; 3], fov: f32) -> Framing {
    Framing {
        target: Vec3::from_array(target),
        eye: Vec3::from_array(eye),
        fov,
    }
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
    /// Portrait of a head; the close-up where there is none.
    pub head: Option<Framing>,
    /// Far away.
    pub far: Framing,
}

impl Shots {
    /// Around a model of half a metre that stands at the origin.
    pub fn around_model() -> Self {
        let shot = |x, y, z, fov| shot([0.0; 3], [x, y, z], fov);
        Self {
            hero: shot(1.2, 0.45, 1.4, 14.0),
            closeup: shot(0.35, 0.15, 0.3, 24.0),
            macro_: shot(0.2, 0.08, 0.16, 18.0),
            full: shot(2.0, 0.2, 0.0, 18.0),
            back: shot(-1.0, 0.6, -1.5, 18.0),
            head: None,
            far: shot(3.0, 1.0, 4.0, 24.0),
        }
    }

    /// The shot of that name.
    pub fn framing(&self, shot: Shot) -> Framing {
        match shot {
            Shot::Head => self.head.unwrap_or(self.closeup),
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

/// Spawns the camera.
pub struct CameraPlugin;

impl Plugin for CameraPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Sky>()
            .add_systems(
                Startup,
                (spawn_camera, (backdrop::hang, foreground::hang)).chain(),
            )
            .add_systems(Update, circle)
            .add_systems(PostUpdate, backdrop::fit);
    }
}

/// The point that a camera turns about.
#[derive(Component)]
pub struct Orbit {
    /// In metres.
    pub target: Vec3,
}

/// Where the camera stands for a shot, and the projection of its lens.
pub fn place(framing: Framing, args: &Args) -> (Transform, Projection) {
    let away = Quat::from_rotation_y(args.turn.to_radians()) * (framing.eye - framing.target);
    let tilt = Vec3::Y
        .cross(away)
        .try_normalize()
        .map_or(Quat::IDENTITY, |side| {
            Quat::from_axis_angle(side, -args.tilt.to_radians())
        });
    let eye = framing.target + tilt * away * args.distance;
    (
        Transform::from_translation(eye).looking_at(framing.target, Vec3::Y),
        Projection::Perspective(PerspectiveProjection {
            fov: framing.fov.to_radians(),
            near: 0.002,
            ..default()
        }),
    )
}

fn spawn_camera(
    mut commands: Commands,
    args: Res<Args>,
    shots: Res<Shots>,
    sky: Res<Sky>,
    setting: Res<Setting>,
    off_screen: Option<Res<OffScreen>>,
    adapter: Res<RenderAdapterInfo>,
) {
    let framing = shots.framing(args.camera);
    let mut camera = commands.spawn((
        Camera3d::default(),
        Hdr,
        args.msaa(),
        Exposure {
            ev100: setting.ev100,
        },
        place(framing, &args),
        Orbit {
            target: framing.target,
        },
        sky.bundle(&setting),
    ));
    if args.transparency == Some(FeatherTransparency::OrderIndependent) {
        camera.insert(OrderIndependentTransparencySettings::default());
    }
    let depth_first = match args.depth_prepass {
        DepthFirst::On => true,
        DepthFirst::Off => false,
        DepthFirst::Gpu => !in_software(&adapter),
    };
    if depth_first {
        camera.insert(DepthPrepass);
    }
    if let Some(image) = off_screen {
        camera.insert(RenderTarget::Image(image.0.clone().into()));
    }
}

fn circle(args: Res<Args>, time: Res<Time>, mut cameras: Query<(&mut Transform, &Orbit)>) {
    if args.camera != Shot::Orbit {
        return;
    }
    for (mut transform, orbit) in &mut cameras {
        transform.rotate_around(orbit.target, Quat::from_rotation_y(0.4 * time.delta_secs()));
    }
}
