//! Fur without feathers: a bent cylinder, or the skinned mesh of a glTF file.
//!
//! `cargo run --example fur -- --mode hybrid`: single hairs (`explicit`), the marched volume (`volume`), both (`hybrid`), or shells with
//! precomputed transfer (`shells`). `--mesh path/to/model.glb --clip 1` puts it on a model of your own, `--bench` measures. F1 lists
//! the keys.

mod helper;

use bevy::{
    asset::RenderAssetUsages,
    gltf::GltfAssetLabel,
    mesh::{
        Indices, PrimitiveTopology,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::prelude::*;
use helper::{Args, args::FurMode, camera::Shots, scene::Idle};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Largest side of the model in the picture, metres.
const SIZE: f32 = 0.6;

fn main() -> AppExit {
    helper::run("fur", |app| {
        app.add_plugins(PlumagePlugins)
            .insert_resource(Shots::around_model())
            .add_systems(Startup, setup)
            .add_systems(Update, frame)
            .add_observer(arrived);
    })
}

/// A model that has arrived and is not framed yet: frames waited.
#[derive(Component)]
struct Unframed(u32);

/// A model on its way.
#[derive(Component)]
struct Expected;

fn coat(assets: &AssetServer, args: &Args, scale: f32) -> Undercoat {
    let usual = if args.mesh.is_some() { "pelt" } else { "fur" };
    let name = args.down.as_deref().unwrap_or(usual);
    Undercoat {
        visible: args.mode != FurMode::Explicit,
        mode: if args.mode == FurMode::Shells {
            UndercoatMode::Shells
        } else {
            UndercoatMode::Volume
        },
        seed: args.seed,
        scale,
        // Models given by path may have few triangles.
        rounds: if args.mesh.is_some() { 2 } else { 0 },
        ..Undercoat::new(assets.load(format!("downs/{name}.down.ron")))
    }
}

/// The hairs are those of the coat: longer ones, and the lighter for it.
fn strands(args: &Args) -> Option<GuardStrands> {
    // Over a mesh they take its colors.
    let (color, tip_color) = if args.mesh.is_some() {
        ([0.66, 0.62, 0.58], [1.0, 0.98, 0.95])
    } else {
        ([0.52, 0.42, 0.34], [0.93, 0.88, 0.79])
    };
    let hairs = GuardStrands {
        bend: 0.8,
        gravity: 0.1,
        color,
        tip_color,
        ..default()
    };
    match args.mode {
        FurMode::Volume | FurMode::Shells => None,
        // As many hairs as the volume stands for would not end: the paper's equal-time case.
        FurMode::Explicit => Some(GuardStrands {
            density: 160.0,
            limit: 120_000,
            length_mm: 11.0,
            length_spread: 0.3,
            radius_um: 60.0,
            fade: 0.4,
            ..hairs
        }),
        FurMode::Hybrid => Some(GuardStrands {
            density: 40.0,
            length_mm: if args.mesh.is_some() { 22.0 } else { 16.0 },
            length_spread: 0.3,
            radius_um: 60.0,
            fade: 0.6,
            ..hairs
        }),
    }
}

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    args: Res<Args>,
    mut settings: ResMut<UndercoatSettings>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    settings.view = args.fur_view;
    let Some(path) = &args.mesh else {
        let mut cylinder = commands.spawn((
            Mesh3d(meshes.add(bent_cylinder(0.055, 0.16, 64, 48))),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: Color::srgb(0.45, 0.32, 0.28),
                perceptual_roughness: 0.9,
                ..default()
            })),
            Transform::from_xyz(0.0, -0.10, 0.0),
            coat(&assets, &args, 1.0),
        ));
        if let Some(strands) = strands(&args) {
            cylinder.insert(strands);
        }
        return;
    };
    let path = std::path::absolute(path).unwrap_or_else(|_| path.clone());
    commands.spawn((
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(path.clone()))),
        Idle(
            assets.load(GltfAssetLabel::Animation(args.clip).from_asset(path)),
            0.0,
        ),
        Expected,
        // Keeps the loop waiting until the coat is there.
        UndercoatState::default(),
        Transform::default(),
        Visibility::default(),
    ));
}

/// A tube of this radius along a quarter of a circle, its ends closed by half balls.
fn bent_cylinder(radius: f32, bend: f32, along: u32, around: u32) -> Mesh {
    let ends = 12;
    let rows = along + 2 * ends;
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    for row in 0..=rows {
        // Share of the arc, and the angle over the half ball at an end.
        let (share, cap) = if row < ends {
            (0.0, (row as f32 / ends as f32 - 1.0) * FRAC_PI_2)
        } else if row > ends + along {
            (1.0, (row - ends - along) as f32 / ends as f32 * FRAC_PI_2)
        } else {
            ((row - ends) as f32 / along as f32, 0.0)
        };
        let angle = (share - 0.5) * FRAC_PI_2 * 1.2;
        let out = Vec3::new(angle.sin(), angle.cos(), 0.0);
        let tangent = Vec3::new(angle.cos(), -angle.sin(), 0.0);
        let middle = out * bend * 1.4 - Vec3::Y * bend * 0.6;
        for step in 0..around {
            let turn = step as f32 / around as f32 * TAU;
            let ring = out * turn.cos() + Vec3::Z * turn.sin();
            // One point at the poles.
            let ring = if row == 0 || row == rows {
                Vec3::ZERO
            } else {
                ring
            };
            let normal = ring * cap.cos() + tangent * cap.sin();
            positions.push((middle + normal * radius).to_array());
            normals.push(normal.to_array());
        }
    }
    let mut indices = Vec::new();
    for row in 0..rows {
        for step in 0..around {
            let next = (step + 1) % around;
            let [a, b] = [row * around + step, row * around + next];
            indices.extend([a, a + around, b, b, a + around, b + around]);
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_indices(Indices::U32(indices))
}

fn arrived(
    ready: On<WorldInstanceReady>,
    expected: Query<(), With<Expected>>,
    mut commands: Commands,
) {
    if expected.contains(ready.entity) {
        commands
            .entity(ready.entity)
            .remove::<Expected>()
            .insert(Unframed(0));
    }
}

/// Once the model stands in its first pose: brings it to size, and grows the fur.
fn frame(
    mut commands: Commands,
    mut models: Query<(Entity, &mut Unframed, &mut Transform)>,
    assets: Res<AssetServer>,
    args: Res<Args>,
    children: Query<&Children>,
    parts: Query<(&Mesh3d, Option<&SkinnedMesh>, &GlobalTransform)>,
    places: Query<&GlobalTransform>,
    poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    meshes: Res<Assets<Mesh>>,
) {
    for (root, mut waited, mut transform) in &mut models {
        waited.0 += 1;
        if waited.0 < 3 {
            continue;
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for entity in children.iter_descendants(root) {
            let Ok((mesh, skin, place)) = parts.get(entity) else {
                continue;
            };
            let posed = skin.and_then(|skin| {
                let joint = places.get(*skin.joints.first()?).ok()?;
                Some(joint.to_matrix() * *poses.get(&skin.inverse_bindposes)?.first()?)
            });
            let matrix = posed.unwrap_or(place.to_matrix());
            let points = meshes
                .get(&mesh.0)
                .and_then(|mesh| mesh.attribute(Mesh::ATTRIBUTE_POSITION)?.as_float3());
            for point in points.into_iter().flatten() {
                let point = matrix.transform_point3(Vec3::from(*point));
                (low, high) = (low.min(point), high.max(point));
            }
        }
        let scale = SIZE / (high - low).max_element();
        if scale.is_finite() && scale > 0.0 {
            transform.scale = Vec3::splat(scale);
            transform.translation = -0.5 * (low + high) * scale;
        }
        let mut model = commands.entity(root);
        model.remove::<Unframed>().insert(coat(&assets, &args, 1.5));
        if let Some(strands) = strands(&args) {
            model.insert(strands);
        }
    }
}
