//! Feathers on a mesh of your own: any glTF, skinned or not, with no groom file.
//!
//! `cargo run --example your_own_mesh -- --mesh path/to/model.glb --clip 1`: the mesh is groomed by what it offers
//! (`Groom::fallback`: tract numbers, vertex colours, joints, or nothing), its animation number `--clip` plays, and the camera frames
//! it whatever its scale. A base colour texture becomes vertex colours first, so that the feathers take its colours.

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
use bevy_plumage::prelude::*;
use helper::{Args, camera::Shots, scene::Idle};

/// Largest side of the model in the picture, metres.
const SIZE: f32 = 0.6;

fn main() {
    helper::run("your_own_mesh", |app| {
        app.insert_resource(Shots::around_model())
            .add_systems(Startup, setup)
            .add_systems(Update, (dress, report))
            .add_observer(arrived);
    });
}

/// The model, until its scene is there and painted.
#[derive(Component)]
struct Bare {
    ready: bool,
    frames: u32,
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
        Bare {
            ready: false,
            frames: 0,
        },
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

/// Once the scene stands in its first pose: colours, size, feathers.
fn dress(
    mut commands: Commands,
    mut bare: Query<(Entity, &mut Bare, &mut Transform)>,
    args: Res<Args>,
    children: Query<&Children>,
    parts: Query<(
        &Mesh3d,
        Option<&SkinnedMesh>,
        Option<&MeshMaterial3d<StandardMaterial>>,
        &GlobalTransform,
    )>,
    places: Query<&GlobalTransform>,
    poses: Res<Assets<SkinnedMeshInverseBindposes>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    images: Res<Assets<Image>>,
) {
    for (root, mut state, mut transform) in &mut bare {
        if !state.ready {
            continue;
        }
        state.frames += 1;
        if state.frames < 3 {
            continue;
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for entity in children.iter_descendants(root) {
            let Ok((mesh, skin, material, place)) = parts.get(entity) else {
                continue;
            };
            if let Some(mut mesh) = meshes.get_mut(&mesh.0) {
                if let Some(mut material) = material.and_then(|m| materials.get_mut(&m.0)) {
                    paint(&mut mesh, &mut material, &images);
                }
                for point in posed(&mesh, skin, place, &places, &poses) {
                    (low, high) = (low.min(point), high.max(point));
                }
            }
        }
        let scale = SIZE / (high - low).max_element();
        if scale.is_finite() && scale > 0.0 {
            transform.scale = Vec3::splat(scale);
            transform.translation = -0.5 * (low + high) * scale;
        }
        commands.entity(root).remove::<Bare>().insert((
            // The default handle: no groom but what the mesh offers.
            Plumage::default()
                .with_seed(args.seed)
                .with_density(args.density.unwrap_or(1.0)),
            FeatherQuality {
                settings: FeatherSettings {
                    debug_view: args.view.into(),
                    ..default()
                },
                ..default()
            },
        ));
    }
}

/// Turns a base colour texture into vertex colours.
fn paint(mesh: &mut Mesh, material: &mut StandardMaterial, images: &Assets<Image>) {
    let Some(image) = material
        .base_color_texture
        .as_ref()
        .and_then(|i| images.get(i))
    else {
        return;
    };
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
        return;
    };
    let size = image.size();
    let texel = |x: f32, n: u32| (x.rem_euclid(1.0) * n as f32).min(n as f32 - 1.0) as u32;
    let colors: Option<Vec<[f32; 4]>> = uvs
        .iter()
        .map(|uv| {
            let color = image.get_color_at(texel(uv[0], size.x), texel(uv[1], size.y));
            color.ok().map(|c| c.to_linear().to_f32_array())
        })
        .collect();
    if let Some(colors) = colors {
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
        material.base_color_texture = None;
    }
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
    let joints = mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    let bind = skin.and_then(|skin| Some((skin, poses.get(&skin.inverse_bindposes)?)));
    let (Some((skin, bind)), Some(VertexAttributeValues::Uint16x4(joints))) = (bind, joints) else {
        return positions
            .iter()
            .map(|p| place.transform_point(Vec3::from_array(*p)))
            .collect();
    };
    // The first joint, usually the strongest, is near enough to frame the model.
    positions
        .iter()
        .zip(joints)
        .filter_map(|(p, j)| {
            let joint = usize::from(j[0]);
            let matrix =
                places.get(*skin.joints.get(joint)?).ok()?.to_matrix() * *bind.get(joint)?;
            Some(matrix.transform_point3(Vec3::from_array(*p)))
        })
        .collect()
}
