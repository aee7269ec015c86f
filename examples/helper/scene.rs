//! Light, background, and the bird on its perch.

use super::{
    Args,
    backdrop::Hung,
    branch::branch,
    camera::Orbit,
    setting::{Lamp, Setting},
    sky,
    surroundings::grow,
};
use bevy::{
    core_pipeline::{prepass::DepthPrepass, tonemapping::Tonemapping},
    gltf::GltfAssetLabel,
    light::{CascadeShadowConfig, CascadeShadowConfigBuilder, EnvironmentMapLight, Skybox},
    prelude::*,
    render::view::ColorGrading,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::{DebugView, fit_cascades, prelude::*};
use std::f32::consts::FRAC_PI_2;

/// Sun, sky, and the animation of the birds.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, spawn_lights)
            .add_systems(PostUpdate, fit_shadows)
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
        let (specular, diffuse) = sky::maps(world.resource::<Setting>().radiance);
        let mut images = world.resource_mut::<Assets<Image>>();
        Self {
            specular: images.add(specular),
            diffuse: images.add(diffuse),
        }
    }
}

impl Sky {
    /// Components by which a camera sees the sky and what it lights, on the scene's film.
    pub fn bundle(&self, setting: &Setting) -> impl Bundle {
        let mut grading = ColorGrading::default();
        grading.global.post_saturation = setting.saturation;
        (
            setting.tone,
            grading,
            EnvironmentMapLight {
                diffuse_map: self.diffuse.clone(),
                specular_map: self.specular.clone(),
                intensity: setting.fill[0],
                ..default()
            },
            Skybox {
                image: Some(self.specular.clone()),
                brightness: setting.fill[1],
                ..default()
            },
        )
    }
}

/// Shadow maps that reach eight metres.
fn wide_shadows() -> CascadeShadowConfig {
    CascadeShadowConfigBuilder {
        num_cascades: 2,
        first_cascade_far_bound: 2.0,
        maximum_distance: 8.0,
        ..default()
    }
    .build()
}

/// Most and least that fitted shadow maps hold around the point looked at, metres: a bird with its branch, a head.
const REACH: [f32; 2] = [0.9, 0.15];

fn spawn_lights(mut commands: Commands, args: Res<Args>, setting: Res<Setting>) {
    for Lamp { toward, lux, color } in [Some(setting.key), setting.rim].into_iter().flatten() {
        let toward = Quat::from_rotation_y(args.sun.to_radians()) * toward;
        let [red, green, blue] = color;
        commands.spawn((
            DirectionalLight {
                illuminance: lux,
                color: Color::srgb(red, green, blue),
                shadow_maps_enabled: !args.lean,
                shadow_normal_bias: 0.6,
                ..default()
            },
            wide_shadows(),
            Transform::from_translation(toward).looking_at(Vec3::ZERO, Vec3::Y),
        ));
    }
}

/// Shadow maps around the subject, so that feathers throw shadows, too; again when the camera comes nearer or goes away.
fn fit_shadows(
    setting: Res<Setting>,
    cameras: Query<(&Transform, &Projection, &Orbit)>,
    mut lights: Query<&mut CascadeShadowConfig, With<DirectionalLight>>,
    mut fitted: Local<Vec2>,
) {
    let Some((camera, Projection::Perspective(lens), orbit)) = cameras.iter().next() else {
        return;
    };
    let distance = camera.translation.distance(orbit.target);
    // What the picture shows, and as much again on all sides.
    let [most, least] = REACH;
    let reach = (3.0 * distance * (0.5 * lens.fov).tan()).clamp(least, most);
    let wanted = Vec2::new(distance, reach);
    if !setting.fitted_shadows || wanted.distance(*fitted) < 0.02 * distance {
        return;
    }
    *fitted = wanted;
    for mut config in &mut lights {
        *config = fit_cascades(&(*camera).into(), orbit.target, reach);
    }
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

/// A branch to sit on, along x: radius, length, and the height of its upper side, in metres.
#[derive(Component, Clone, Copy)]
#[require(Transform, Visibility)]
pub struct Perch(pub f32, pub f32, pub f32);

/// What the parrot of `assets/birds` holds.
pub const PARROT_PERCH: Perch = Perch(0.022, 2.2, 0.024);
/// What the eagle holds.
pub const EAGLE_PERCH: Perch = Perch(0.035, 2.6, 0.060);
/// What the owl holds.
pub const OWL_PERCH: Perch = Perch(0.018, 1.6, 0.024);

/// A ball in a bird's breast that shows no other feathers from before and from the side: middle and radius, metres, space of the bird.
#[derive(Component, Clone, Copy)]
pub struct Breast(pub Vec3, pub f32);

/// Of the parrot of `assets/birds`.
pub const PARROT_BREAST: Breast = Breast(Vec3::new(0.0, 0.165, 0.035), 0.027);
/// Of the eagle.
pub const EAGLE_BREAST: Breast = Breast(Vec3::new(0.0, 0.34, 0.08), 0.036);
/// Of the owl.
pub const OWL_BREAST: Breast = Breast(Vec3::new(0.0, 0.14, 0.05), 0.03);

fn grow_perch(
    add: On<Add, Perch>,
    perches: Query<&Perch>,
    setting: Res<Setting>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    let Perch(radius, length, top) = *perches.get(add.entity)?;
    let place = Transform::from_translation(Vec3::Y * (top - radius));
    if setting.bark {
        commands.entity(add.entity).insert((
            Mesh3d(meshes.add(branch(radius, length))),
            MeshMaterial3d(materials.add(StandardMaterial {
                perceptual_roughness: 0.95,
                reflectance: 0.2,
                ..default()
            })),
            place,
        ));
        let around = grow(setting.surroundings, radius, length);
        let thin = StandardMaterial {
            perceptual_roughness: 0.55,
            reflectance: 0.35,
            diffuse_transmission: 0.4,
            double_sided: true,
            cull_mode: None,
            ..default()
        };
        let solid = StandardMaterial {
            perceptual_roughness: 0.9,
            reflectance: 0.25,
            double_sided: true,
            cull_mode: None,
            ..default()
        };
        for (mesh, material) in [(around.solid, solid), (around.thin, thin)] {
            let Some(mesh) = mesh else {
                continue;
            };
            commands.entity(add.entity).with_child((
                Mesh3d(meshes.add(mesh)),
                MeshMaterial3d(materials.add(material)),
            ));
        }
    } else {
        commands.entity(add.entity).insert((
            Mesh3d(meshes.add(Capsule3d::new(radius, length))),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: Color::srgb(0.33, 0.25, 0.17),
                perceptual_roughness: 0.9,
                ..default()
            })),
            place.with_rotation(Quat::from_rotation_z(FRAC_PI_2)),
        ));
    }
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
        match args.frozen() {
            Some(time) => active.seek_to(time + idle.1).pause(),
            None => active.seek_to(idle.1),
        };
    }
}

/// Blue of a mask where a thing is, linear.
const THING: f32 = 0.05;

/// Makes the scene a mask: feathers show a color for each card, bill, eyes, feet and bare skin are blue, what birds sit on and what may
/// hide them is dark blue, the rest is black. No light casts shadows, and no depth pass goes before: nothing shows what they decide.
pub fn mask(app: &mut App) {
    let world = app.world_mut();
    let mut suns = world.query::<&mut DirectionalLight>();
    for mut sun in suns.iter_mut(world) {
        sun.shadow_maps_enabled = false;
    }
    let mut qualities = world.query::<&mut FeatherQuality>();
    for mut quality in qualities.iter_mut(world) {
        quality.settings.debug_view = DebugView::Card;
    }
    let mut cameras = world.query_filtered::<Entity, With<Orbit>>();
    let cameras: Vec<Entity> = cameras.iter(world).collect();
    for camera in cameras {
        world.entity_mut(camera).remove::<(Skybox, DepthPrepass)>();
    }
    world.insert_resource(ClearColor(Color::BLACK));
    // No film: blue stays blue.
    let mut setting = world.resource_mut::<Setting>();
    (setting.tone, setting.saturation) = (Tonemapping::None, 1.0);
    let mut birds = world.query_filtered::<Entity, With<Idle>>();
    let mut children = world.query::<&Children>();
    let mut bodies = Vec::new();
    for bird in birds.iter(world) {
        bodies.extend(children.query(world).iter_descendants(bird));
    }
    let mut worn = world.query::<(Entity, &MeshMaterial3d<StandardMaterial>, Has<Hung>)>();
    let worn: Vec<_> = worn
        .iter(world)
        .map(|(entity, material, hung)| (entity, material.0.clone(), hung))
        .collect();
    for (entity, old, hung) in worn {
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let old = materials.get(&old).cloned().unwrap_or_default();
        let body = bodies.contains(&entity);
        // By what it emits: colors of vertices would darken what it reflects.
        let flat = materials.add(StandardMaterial {
            base_color: Color::BLACK,
            base_color_texture: hung.then(|| old.base_color_texture.clone()).flatten(),
            emissive: LinearRgba::rgb(0.0, 0.0, if body { 1.0 } else { THING }),
            reflectance: 0.0,
            unlit: hung,
            alpha_mode: old.alpha_mode,
            double_sided: old.double_sided,
            cull_mode: old.cull_mode,
            ..default()
        });
        world.entity_mut(entity).insert(MeshMaterial3d(flat));
    }
}
