//! Light, background, and the bird on its perch.

use super::{Args, sky};
use bevy::{
    core_pipeline::tonemapping::Tonemapping,
    gltf::GltfAssetLabel,
    light::{CascadeShadowConfigBuilder, EnvironmentMapLight, Skybox},
    prelude::*,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use std::f32::consts::FRAC_PI_2;

/// Sun, sky, and the animation of the birds.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, spawn_light)
            .add_observer(grow_perch)
            .add_observer(start_idle);
    }
}

/// The idle clip of a bird and the time at which it begins, seconds.
#[derive(Component, Clone)]
pub struct Idle(pub Handle<AnimationClip>, pub f32);

/// The sky, for the camera.
#[derive(Resource, Clone)]
pub struct Sky {
    /// Background and reflections.
    pub specular: Handle<Image>,
    /// Irradiance.
    pub diffuse: Handle<Image>,
}

impl FromWorld for Sky {
    fn from_world(world: &mut World) -> Self {
        let (specular, diffuse) = sky::maps();
        let mut images = world.resource_mut::<Assets<Image>>();
        Self {
            specular: images.add(specular),
            diffuse: images.add(diffuse),
        }
    }
}

impl Sky {
    /// Components by which a camera sees the sky and what it lights; `brightness` relative to a day's.
    pub fn bundle(&self, brightness: f32) -> impl Bundle {
        (
            Tonemapping::AcesFitted,
            EnvironmentMapLight {
                diffuse_map: self.diffuse.clone(),
                specular_map: self.specular.clone(),
                intensity: 2100.0 * brightness,
                ..default()
            },
            Skybox {
                image: Some(self.specular.clone()),
                brightness: 2600.0 * brightness,
                ..default()
            },
        )
    }
}

fn spawn_light(mut commands: Commands, args: Res<Args>) {
    let (sun, illuminance) = if args.backlight {
        (Vec3::new(1.0, 0.9, -2.2), 60_000.0)
    } else {
        (Vec3::new(0.7, 1.9, 1.9), 23_000.0)
    };
    let sun = Quat::from_rotation_y(args.sun.to_radians()) * sun;
    commands.spawn((
        DirectionalLight {
            illuminance,
            color: Color::srgb(1.0, 0.95, 0.87),
            shadow_maps_enabled: !args.lean,
            shadow_normal_bias: 0.6,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 2,
            first_cascade_far_bound: 2.0,
            maximum_distance: 8.0,
            ..default()
        }
        .build(),
        Transform::from_translation(sun).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// The model of a bird with its idle clip, begun at `phase` seconds: `assets/birds/NAME.glb`.
pub fn bird(assets: &AssetServer, name: &str, phase: f32) -> impl Bundle {
    let file = format!("birds/{name}.glb");
    (
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(file.clone()))),
        Idle(
            assets.load(GltfAssetLabel::Animation(0).from_asset(file)),
            phase,
        ),
    )
}

/// A branch to sit on: along x, its upper side through the feet's origin; radius and length in metres.
#[derive(Component, Clone, Copy)]
#[require(Transform, Visibility)]
pub struct Perch(pub f32, pub f32);

fn grow_perch(
    add: On<Add, Perch>,
    perches: Query<&Perch>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    let Perch(radius, length) = *perches.get(add.entity)?;
    commands.entity(add.entity).insert((
        Mesh3d(meshes.add(Capsule3d::new(radius, length))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.33, 0.25, 0.17),
            perceptual_roughness: 0.9,
            ..default()
        })),
        Transform::from_translation(Vec3::NEG_Y * radius)
            .with_rotation(Quat::from_rotation_z(FRAC_PI_2)),
    ));
    Ok(())
}

/// Plays the idle clip once the bird's scene is there; `--time` freezes it.
fn start_idle(
    ready: On<WorldInstanceReady>,
    args: Res<Args>,
    idles: Query<&Idle>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let root = ready.entity;
    let Ok(idle) = idles.get(root) else {
        return;
    };
    for entity in children.iter_descendants(root) {
        let Ok(mut player) = players.get_mut(entity) else {
            continue;
        };
        let (graph, node) = AnimationGraph::from_clip(idle.0.clone());
        commands
            .entity(entity)
            .insert(AnimationGraphHandle(graphs.add(graph)));
        let active = player.play(node).repeat();
        match args.time {
            Some(time) => active.seek_to(time + idle.1).pause(),
            None => active.seek_to(idle.1),
        };
    }
}
