//! Feathers on a mesh of your own: any glTF, skinned or not, with no groom file.
//!
//! `cargo run --example your_own_mesh -- --mesh path/to/model.glb --clip 1`: the mesh is groomed by what it offers
//! (`Groom::fallback`: tract numbers, vertex colors, joints, or nothing) in the colors of its materials and textures, its animation
//! number `--clip` plays if there is one, and the camera frames it whatever its scale. F1 lists the keys.

mod helper;

use bevy::{
    asset::LoadState,
    gltf::GltfAssetLabel,
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::{PlumageMasks, prelude::*};
use helper::{Args, camera::Shots, scene::Idle};

/// Moments of its animation at which the model is measured.
const MOMENTS: u32 = 8;
/// Frames until the skeleton stands where a moment wants it.
const SETTLE: u32 = 3;
/// What feathers add around the skin, over its diagonal.
const FEATHERS: f32 = 0.03;
/// Share of the picture that the model fills.
const FILLED: f32 = 0.88;

fn main() -> AppExit {
    helper::run("your_own_mesh", |app| {
        app.add_plugins(PlumagePlugins)
            .insert_resource(Shots::around_model())
            .add_systems(Startup, setup)
            .add_systems(Update, (dress, report))
            .add_observer(arrived);
    })
}

/// The model, until its scene is there and measured.
#[derive(Component, Default)]
struct Bare {
    ready: bool,
    frames: u32,
    /// Where its vertices come to in the course of the animation.
    points: Vec<Vec3>,
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    let path = args
        .mesh
        .clone()
        .unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/assets/birds/parrot.glb").into());
    let path = std::path::absolute(&path).unwrap_or(path);
    commands.spawn((
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(path.clone()))),
        Idle(
            assets.load(GltfAssetLabel::Animation(args.clip).from_asset(path)),
            0.0,
        ),
        Bare::default(),
        PlumageState::default(),
        Transform::default(),
        Visibility::default(),
    ));
}

fn arrived(ready: On<WorldInstanceReady>, mut bare: Query<&mut Bare>) {
    if let Ok(mut bare) = bare.get_mut(ready.entity) {
        bare.ready = true;
    }
}

/// A file that does not load never becomes a scene: its state says so.
fn report(
    assets: Res<AssetServer>,
    mut bare: Query<(&WorldAssetRoot, &mut PlumageState), With<Bare>>,
) {
    for (scene, mut state) in &mut bare {
        if state.error.is_none()
            && let LoadState::Failed(cause) = assets.load_state(scene.0.id())
        {
            error!("{cause}");
            state.error = Some(cause.to_string());
        }
    }
}

/// Once the scene is there: measures it all through its animation; then size and feathers.
fn dress(
    mut commands: Commands,
    mut bare: Query<(Entity, &mut Bare, &Idle, &mut Transform, &mut PlumageState)>,
    args: Res<Args>,
    shots: Res<Shots>,
    children: Query<&Children>,
    parts: Query<(&Mesh3d, Option<&SkinnedMesh>, &GlobalTransform)>,
    places: Query<&GlobalTransform>,
    mut players: Query<&mut AnimationPlayer>,
    clips: Res<Assets<AnimationClip>>,
    poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    meshes: Res<Assets<Mesh>>,
) {
    for (root, mut state, idle, mut transform, mut growth) in &mut bare {
        if !state.ready {
            continue;
        }
        let duration = clips.get(&idle.0).map_or(0.0, AnimationClip::duration);
        let moment = state.frames / SETTLE;
        state.frames += 1;
        let seek = if moment < MOMENTS {
            duration * moment as f32 / MOMENTS as f32
        } else {
            args.time.unwrap_or(0.0)
        };
        for entity in children.iter_descendants(root) {
            if let Ok(mut player) = players.get_mut(entity) {
                for (_, active) in player.playing_animations_mut() {
                    active.seek_to(seek);
                }
            }
            if state.frames.is_multiple_of(SETTLE)
                && let Ok((mesh, skin, place)) = parts.get(entity)
                && let Some(mesh) = meshes.get(&mesh.0)
            {
                let points = posed(mesh, skin, place, &places, &poses);
                state.points.extend(points);
            }
        }
        if moment < MOMENTS {
            continue;
        }
        let Some((center, scale)) = fit(&state.points, &shots, args.size) else {
            let found = "the file has no mesh with an extent: nothing to grow feathers on";
            growth.error = Some(found.into());
            commands.entity(root).remove::<Bare>();
            continue;
        };
        transform.scale = Vec3::splat(scale);
        transform.translation = -center * scale;
        commands.entity(root).remove::<Bare>().insert((
            // The default handle: no groom but what the mesh offers.
            Plumage::default()
                .with_seed(args.seed)
                .with_density(args.density.unwrap_or(1.0)),
            PlumageMasks(args.mask.clone()),
            args.quality(FeatherTransparency::default()),
        ));
    }
}

/// Middle of the points, and the scale at which the shots of the whole model hold them all.
fn fit(points: &[Vec3], shots: &Shots, (width, height): (u32, u32)) -> Option<(Vec3, f32)> {
    let low = points.iter().copied().reduce(Vec3::min)?;
    let high = points.iter().copied().reduce(Vec3::max)?;
    let center = 0.5 * (low + high);
    let margin = FEATHERS * low.distance(high);
    let mut scale = f32::INFINITY;
    for shot in [shots.hero, shots.full, shots.back] {
        let eye = Transform::from_translation(shot.eye).looking_at(shot.target, Vec3::Y);
        let up = shot.eye.distance(shot.target) * (0.5 * shot.fov.to_radians()).tan();
        let side = up * width as f32 / height as f32;
        let reach = |axis: Vec3| {
            let along = points.iter().map(|p| (*p - center).dot(axis).abs());
            along.fold(0.0, f32::max) + margin
        };
        scale = scale
            .min(up / reach(*eye.up()))
            .min(side / reach(*eye.right()));
    }
    (scale.is_finite() && scale > 0.0).then_some((center, FILLED * scale))
}

/// Vertices where the skeleton has put them.
fn posed(
    mesh: &Mesh,
    skin: Option<&SkinnedMesh>,
    place: &GlobalTransform,
    places: &Query<&GlobalTransform>,
    poses: &Assets<SkinnedMeshInverseBindposes>,
) -> Vec<Vec3> {
    let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return Vec::new();
    };
    let bind = skin.and_then(|skin| Some((skin, poses.get(&skin.inverse_bindposes)?)));
    let (
        Some((skin, bind)),
        Some(VertexAttributeValues::Uint16x4(joints)),
        Some(VertexAttributeValues::Float32x4(weights)),
    ) = (
        bind,
        mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX),
        mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT),
    )
    else {
        return positions
            .iter()
            .map(|p| place.transform_point(Vec3::from_array(*p)))
            .collect();
    };
    let matrices: Vec<Mat4> = skin
        .joints
        .iter()
        .zip(bind.iter())
        .map(|(joint, bind)| {
            let joint = places
                .get(*joint)
                .map_or(Mat4::IDENTITY, GlobalTransform::to_matrix);
            joint * *bind
        })
        .collect();
    let carried = |p: &[f32; 3], joints: &[u16; 4], weights: &[f32; 4]| {
        let parts = joints.iter().zip(weights).filter_map(|(joint, weight)| {
            let matrix = matrices.get(usize::from(*joint))?;
            Some(matrix.transform_point3(Vec3::from_array(*p)) * *weight)
        });
        parts.sum::<Vec3>()
    };
    positions
        .iter()
        .zip(joints)
        .zip(weights)
        .map(|((p, joints), weights)| carried(p, joints, weights))
        .collect()
}
