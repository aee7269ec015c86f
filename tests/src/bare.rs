//! How much skin shows through a coat: pictures from all around with the skin in magenta, the feathers black, the ground green.

use crate::{app::Stage, asset, view::darken, wait};
use bevy::{
    asset::{LoadState, RenderAssetUsages},
    camera::ScalingMode,
    gltf::GltfAssetLabel,
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    world_serialization::WorldAssetRoot,
};
use bevy_plumage::{
    groom::{PlumageCards, PlumageParts, SkinColors},
    prelude::*,
};
use std::path::{Path, PathBuf};

/// Corners of an icosahedron, none along an axis.
pub const DIRECTIONS: [Vec3; 12] = {
    const G: f32 = 1.618_034;
    [
        Vec3::new(0.0, 1.0, G),
        Vec3::new(0.0, 1.0, -G),
        Vec3::new(0.0, -1.0, G),
        Vec3::new(0.0, -1.0, -G),
        Vec3::new(1.0, G, 0.0),
        Vec3::new(1.0, -G, 0.0),
        Vec3::new(-1.0, G, 0.0),
        Vec3::new(-1.0, -G, 0.0),
        Vec3::new(G, 0.0, 1.0),
        Vec3::new(-G, 0.0, 1.0),
        Vec3::new(G, 0.0, -1.0),
        Vec3::new(-G, 0.0, -1.0),
    ]
};
/// Phases of the animation.
pub const PHASES: u32 = 3;
/// Phases of the clip of a bird of the repository.
pub const BIRD_PHASES: u32 = 6;
/// Least linear luminance of skin that nature leaves bare (a macaw's face): skin under feathers is darker.
const FACE: f32 = 0.5;

/// Counted pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bare {
    /// Those that show more skin than feathers.
    pub skin: usize,
    /// Those that show either.
    pub feathered: usize,
    /// Largest share of one picture, 0..1.
    pub worst: f32,
}

impl Bare {
    /// Bare pixels over all of them, 0..1.
    pub fn share(&self) -> f32 {
        self.skin as f32 / self.feathered.max(1) as f32
    }

    fn add(&mut self, picture: &[[f32; 3]]) -> f32 {
        let mut own = Self::default();
        for [red, green, _] in picture {
            own.skin += usize::from(*red > 0.5);
            own.feathered += usize::from(*green < 0.5);
        }
        self.skin += own.skin;
        self.feathered += own.feathered;
        self.worst = self.worst.max(own.share());
        own.share()
    }
}

/// A plumage to look at, and the clip that moves it.
pub struct Subject {
    /// The entity with the [`Plumage`].
    pub owner: Entity,
    clip: Option<(Handle<AnimationClip>, Entity, AnimationNodeIndex)>,
}

impl Subject {
    /// A plumage that no clip moves.
    pub fn still(owner: Entity) -> Self {
        Self { owner, clip: None }
    }

    /// A glTF file, feathered without a groom.
    ///
    /// # Errors
    /// Why it has not grown any feathers.
    pub fn open(stage: &mut Stage, path: &Path, clip: usize) -> Result<Self, String> {
        Self::spawn(stage, path, clip, Plumage::default())
    }

    /// A bird of the repository in its groom: `birds/NAME.glb`.
    ///
    /// # Errors
    /// Why it has not grown any feathers.
    pub fn bird(stage: &mut Stage, name: &str) -> Result<Self, String> {
        let server = stage.app.world().resource::<AssetServer>().clone();
        let groom = Plumage::new(server.load(format!("grooms/{name}.groom.ron")));
        Self::spawn(stage, &asset(&format!("birds/{name}.glb")), 0, groom)
    }

    fn spawn(
        stage: &mut Stage,
        path: &Path,
        clip: usize,
        plumage: Plumage,
    ) -> Result<Self, String> {
        let path = std::path::absolute(path).map_err(|error| error.to_string())?;
        let assets = stage.app.world().resource::<AssetServer>().clone();
        let scene = assets.load(GltfAssetLabel::Scene(0).from_asset(path.clone()));
        let moves: Handle<AnimationClip> =
            assets.load(GltfAssetLabel::Animation(clip).from_asset(path));
        let owner = stage
            .app
            .world_mut()
            .spawn((
                WorldAssetRoot(scene.clone()),
                plumage.with_seed(1),
                Transform::default(),
                Visibility::default(),
            ))
            .id();
        wait::until("the file", || {
            stage.frame();
            let there = assets.is_loaded_with_dependencies(&scene);
            (there || assets.load_state(&scene).is_failed()).then_some(())
        });
        if let LoadState::Failed(error) = assets.load_state(&scene) {
            return Err(error.to_string());
        }
        grown(stage, owner)?;
        wait::until("the clip", || {
            stage.frame();
            let state = assets.load_state(&moves);
            (state.is_loaded() || state.is_failed()).then_some(())
        });
        let world = stage.app.world_mut();
        let mut players = world.query_filtered::<Entity, With<AnimationPlayer>>();
        let player = players.iter(world).next();
        let player = player.filter(|_| assets.load_state(&moves).is_loaded());
        let clip = player.map(|player| {
            let (graph, node) = AnimationGraph::from_clip(moves.clone());
            let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
            world.entity_mut(player).insert(AnimationGraphHandle(graph));
            if let Some(mut player) = world.get_mut::<AnimationPlayer>(player) {
                player.play(node).pause();
            }
            (moves, player, node)
        });
        Ok(Self { owner, clip })
    }

    /// Moves it to a phase of its clip, 0..1.
    pub fn pose(&self, stage: &mut Stage, phase: f32) {
        let Some((clip, player, node)) = &self.clip else {
            return;
        };
        let world = stage.app.world_mut();
        let clips = world.resource::<Assets<AnimationClip>>();
        let duration = clips.get(clip).map_or(0.0, AnimationClip::duration);
        if let Some(mut player) = world.get_mut::<AnimationPlayer>(*player)
            && let Some(active) = player.animation_mut(*node)
        {
            active.seek_to(duration * phase);
        }
        stage.frames(3);
    }
}

/// Waits for the feathers.
///
/// # Errors
/// Why there are none.
pub fn grown(stage: &mut Stage, owner: Entity) -> Result<(), String> {
    wait::until("the coat", || {
        stage.frame();
        let state = stage.app.world().get::<PlumageState>(owner)?;
        match &state.error {
            Some(error) => Some(Err(error.clone())),
            None => state.is_ready().then_some(Ok(())),
        }
    })
}

/// Paints the skin magenta, everything else that is no feather like the ground, and puts the lights out.
pub fn paint(stage: &mut Stage, owner: Entity) {
    stage.frames(2);
    darken(stage);
    let world = stage.app.world_mut();
    world.insert_resource(ClearColor(Color::srgb(0.0, 1.0, 0.0)));
    let cards = world.get::<PlumageParts>(owner).map(|parts| parts[0]);
    let skin = cards.and_then(|cards| {
        let colors = world.entity_mut(cards).take::<SkinColors>();
        let parent = world.get::<ChildOf>(cards).map(ChildOf::parent);
        colors
            .map(|colors| colors.meshes)
            .or(parent.map(|parent| vec![parent]))
    });
    let skin = skin.unwrap_or_default();
    let mut parts = world
        .query_filtered::<(Entity, &MeshMaterial3d<StandardMaterial>), Without<PlumageCards>>();
    let parts: Vec<_> = parts
        .iter(world)
        .map(|(entity, material)| (entity, material.0.clone()))
        .collect();
    for (entity, material) in parts {
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let old = materials.get(&material).cloned().unwrap_or_default();
        let [red, green, blue] = if skin.contains(&entity) {
            [1.0, 0.0, 1.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let flat = StandardMaterial {
            base_color: Color::srgb(red, green, blue),
            unlit: true,
            double_sided: old.double_sided,
            cull_mode: old.cull_mode,
            ..default()
        };
        let flat = materials.add(flat);
        world.entity_mut(entity).insert(MeshMaterial3d(flat));
    }
    stage.frames(3);
}

/// The same for a bird of the repository. Skin that nature leaves bare is painted like the ground.
///
/// # Errors
/// Its skin has no colors to tell it by.
pub fn paint_bird(stage: &mut Stage, owner: Entity) -> Result<(), String> {
    paint(stage, owner);
    let world = stage.app.world_mut();
    let cards = world.get::<PlumageParts>(owner).map(|parts| parts[0]);
    let skin = cards
        .and_then(|cards| world.get::<ChildOf>(cards))
        .map(ChildOf::parent)
        .ok_or("no skin")?;
    let (mesh, joints) = world
        .query::<(&Mesh3d, &SkinnedMesh)>()
        .get(world, skin)
        .map(|(mesh, joints)| (mesh.0.clone(), joints.clone()))
        .map_err(|error| error.to_string())?;
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let mut painted = meshes.get(&mesh).cloned().ok_or("no mesh")?;
    painted.asset_usage = RenderAssetUsages::default();
    let Some(VertexAttributeValues::Float32x4(colors)) =
        painted.attribute_mut(Mesh::ATTRIBUTE_COLOR)
    else {
        return Err("no colors".into());
    };
    for color in colors {
        let [red, green, blue, _] = *color;
        *color = if LinearRgba::rgb(red, green, blue).luminance() > FACE {
            [0.0, 1.0, 0.0, 1.0]
        } else {
            [1.0, 0.0, 1.0, 1.0]
        };
    }
    let painted = Mesh3d(meshes.add(painted));
    let material = StandardMaterial {
        unlit: true,
        ..default()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    // Beside the skin, which keeps its mesh: the feathers would grow anew.
    world
        .entity_mut(skin)
        .remove::<MeshMaterial3d<StandardMaterial>>();
    world.spawn((
        painted,
        joints,
        MeshMaterial3d(material),
        bevy::camera::visibility::NoFrustumCulling,
    ));
    stage.frames(3);
    Ok(())
}

/// A sphere around the feathers in the pose they are in: middle and radius.
fn extent(stage: &Stage, owner: Entity) -> Option<(Vec3, f32)> {
    let world = stage.app.world();
    let mesh = *world.get::<PlumageParts>(owner)?.first()?;
    let cards = &world.get::<PlumageCards>(mesh)?.cards;
    let place = world.get::<GlobalTransform>(mesh)?.to_matrix();
    let joints: Option<Vec<Mat4>> = world.get::<SkinnedMesh>(mesh).and_then(|skin| {
        let poses = world.resource::<Assets<SkinnedMeshInverseBindposes>>();
        let bind = poses.get(&skin.inverse_bindposes)?;
        let joint = |(joint, bind): (&Entity, &Mat4)| {
            Some(world.get::<GlobalTransform>(*joint)?.to_matrix() * *bind)
        };
        skin.joints.iter().zip(bind.iter()).map(joint).collect()
    });
    let posed = |card: &bevy_plumage::groom::Card| match &joints {
        None => place.transform_point3(card.root),
        Some(joints) => (0..4)
            .map(|k| {
                let joint = joints[usize::from(card.joints[k])];
                joint.transform_point3(card.root) * card.weights[k]
            })
            .sum(),
    };
    let scale = joints.as_ref().map_or(place, |joints| joints[0]);
    let scale = scale.to_scale_rotation_translation().0.abs().max_element();
    let points: Vec<Vec3> = cards.iter().map(posed).collect();
    let low = points.iter().copied().reduce(Vec3::min)?;
    let high = points.iter().copied().reduce(Vec3::max)?;
    let middle = 0.5 * (low + high);
    let longest = cards.iter().map(|card| card.length).fold(0.0, f32::max);
    let radius = points
        .iter()
        .map(|p| p.distance(middle))
        .fold(0.0, f32::max);
    Some((middle, radius + scale * longest))
}

/// Counts in pictures from all [`DIRECTIONS`] of the pose it is in; the pictures go into a folder if one is named. Returns the share of
/// each.
pub fn count(
    stage: &mut Stage,
    subject: &Subject,
    save: Option<&PathBuf>,
    found: &mut Bare,
) -> Vec<f32> {
    let mut shares = Vec::new();
    let Some((middle, radius)) = extent(stage, subject.owner) else {
        return shares;
    };
    for (number, direction) in DIRECTIONS.iter().enumerate() {
        let eye = middle + direction.normalize() * 4.0 * radius;
        let camera = stage.camera;
        stage.app.world_mut().entity_mut(camera).insert((
            Transform::from_translation(eye).looking_at(middle, Vec3::Y),
            Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::FixedVertical {
                    viewport_height: 2.05 * radius,
                },
                near: radius,
                far: 8.0 * radius,
                ..OrthographicProjection::default_3d()
            }),
        ));
        let image = stage.still();
        let (width, height) = stage.size;
        let pixel = |i: u32| {
            let color = image.get_color_at(i % width, i / width);
            let color = color.map_or(LinearRgba::BLACK, |color| color.to_linear());
            [color.red, color.green, color.blue]
        };
        let picture: Vec<[f32; 3]> = (0..width * height).map(pixel).collect();
        shares.push(found.add(&picture));
        if let Some(folder) = save
            && let Ok(picture) = image.try_into_dynamic()
        {
            let _ = picture
                .to_rgb8()
                .save(folder.join(format!("{number:02}.png")));
        }
    }
    shares
}
