//! What the tests of Bevy's view share: small patches of feathers, and a sheet that shows what the prepass wrote.

use super::app::{SIZE, Stage};
use bevy::{
    asset::RenderAssetUsages,
    camera::ScalingMode,
    diagnostic::DiagnosticsStore,
    light::{EnvironmentMapLight, GlobalAmbientLight},
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    pbr::{Material, MaterialPlugin},
    prelude::*,
    render::render_resource::AsBindGroup,
    shader::ShaderRef,
};
use bevy_plumage::groom::{Groom, Region, Span, Tint};
use bevy_plumage::prelude::*;

/// A groom that scatters `count` contour feathers of 40 mm over everything.
pub fn patch_groom(count: u32) -> Groom {
    let mut region = Region::new("all");
    region.count = count;
    region.length = Span(40.0, 40.0);
    region.width = Span(24.0, 24.0);
    region.lift = Span(5.0, 5.0);
    region.stiffness = 0.3;
    region.layer = 1.0;
    region.tint = Tint([0.8, 0.2, 0.1], [0.8, 0.2, 0.1]);
    let mut groom = Groom::default();
    groom.name = "patch".into();
    groom.feathers = vec!["feathers/contour.feather.ron".into()];
    groom.regions = vec![region];
    groom
}

/// A patch of feathers at `at`, drawn with `quality`.
pub fn spawn_patch(stage: &mut Stage, count: u32, at: Vec3, quality: FeatherQuality) -> Entity {
    let world = stage.app.world_mut();
    let groom = world
        .resource_mut::<Assets<Groom>>()
        .add(patch_groom(count));
    let skin = stage.spawn_skin();
    stage.app.world_mut().entity_mut(skin).insert((
        Plumage::new(groom).with_seed(3),
        Transform::from_translation(at),
        quality,
    ));
    skin
}

/// Gives the skin of a bird a second joint, "lower", that carries its lower half.
///
/// # Panics
/// If the bird is no skinned mesh.
pub fn part_skin(stage: &mut Stage, bird: Entity) -> Entity {
    let world = stage.app.world_mut();
    let first = world.get::<SkinnedMesh>(bird).unwrap().joints[0];
    let mesh = world.get::<Mesh3d>(bird).unwrap().0.clone();
    let second = world
        .spawn((Name::new("lower"), Transform::IDENTITY, ChildOf(bird)))
        .id();
    let mut poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]));
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(&mesh).unwrap();
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!("no places")
    };
    let joints = places.iter().map(|p| [u16::from(p[1] < 0.0), 0, 0, 0]);
    let joints = VertexAttributeValues::Uint16x4(joints.collect());
    let weights = vec![[1.0, 0.0, 0.0, 0.0]; places.len()];
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    drop(mesh);
    world.entity_mut(bird).insert(SkinnedMesh {
        inverse_bindposes,
        joints: vec![first, second],
    });
    second
}

/// Quality with a debug view.
pub fn showing(view: DebugView, transparency: FeatherTransparency) -> FeatherQuality {
    let mut quality = FeatherQuality {
        transparency,
        ..default()
    };
    quality.settings.debug_view = view;
    quality
}

/// Puts every light out.
pub fn darken(stage: &mut Stage) {
    let camera = stage.camera;
    let world = stage.app.world_mut();
    world.entity_mut(camera).remove::<EnvironmentMapLight>();
    world.insert_resource(GlobalAmbientLight {
        brightness: 0.0,
        ..default()
    });
    let mut suns = world.query_filtered::<Entity, With<DirectionalLight>>();
    let suns: Vec<Entity> = suns.iter(world).collect();
    for sun in suns {
        world.entity_mut(sun).despawn();
    }
}

/// An orthographic camera, 0.12 m high.
pub fn orthographic() -> Projection {
    Projection::Orthographic(OrthographicProjection {
        scaling_mode: ScalingMode::FixedVertical {
            viewport_height: 0.12,
        },
        near: 0.01,
        far: 2.0,
        ..OrthographicProjection::default_3d()
    })
}

/// Frames until what has changed is drawn.
pub fn frames(stage: &mut Stage, count: u32) {
    stage.frames(count);
}

/// Cards of each class that the last camera saw, in the order of [`bevy_plumage::CARD_COUNTERS`].
pub fn counts(stage: &mut Stage) -> [u64; bevy_plumage::CARD_COUNTERS.len()] {
    // The numbers come back a few frames late.
    frames(stage, 4);
    let store = stage.app.world().resource::<DiagnosticsStore>();
    bevy_plumage::CARD_COUNTERS.map(|class| {
        let path = format!("render/feather_cards_{class}");
        let found = store.iter().find(|d| d.path().as_str() == path);
        found.and_then(|d| d.value()).unwrap_or(0.0) as u64
    })
}

/// Cards that the last camera culled.
pub fn culled(stage: &mut Stage) -> u64 {
    counts(stage)[0]
}

/// Mean of all channels.
pub fn mean(picture: &[[f32; 3]]) -> f32 {
    picture.iter().flatten().sum::<f32>() / (3 * picture.len()) as f32
}

/// Mean of each channel.
pub fn mean_color(picture: &[[f32; 3]]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for pixel in picture {
        (0..3).for_each(|c| sum[c] += pixel[c] / picture.len() as f32);
    }
    sum
}

/// Root mean square of the difference.
pub fn rms(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let squares = a.iter().flatten().zip(b.iter().flatten());
    let sum: f32 = squares.map(|(a, b)| (a - b) * (a - b)).sum();
    (sum / (3 * a.len()) as f32).sqrt()
}

/// Share of the pixels of which one is above one half and the other not, after a mean over 5 x 5 pixels.
pub fn silhouettes_differ(a: &[f32], b: &[f32]) -> f32 {
    let (a, b) = (blurred(a), blurred(b));
    let differ = a
        .iter()
        .zip(&b)
        .filter(|(a, b)| (**a > 0.501) != (**b > 0.501));
    differ.count() as f32 / a.len() as f32
}

fn blurred(values: &[f32]) -> Vec<f32> {
    let side = SIZE as i32;
    let at = |x: i32, y: i32| values[(y.clamp(0, side - 1) * side + x.clamp(0, side - 1)) as usize];
    (0..side * side)
        .map(|i| {
            let (x, y) = (i % side, i / side);
            let mut sum = 0.0;
            for dy in -2..=2 {
                (-2..=2).for_each(|dx| sum += at(x + dx, y + dy));
            }
            sum / 25.0
        })
        .collect()
}

/// What the sheet shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// White where the depth prepass wrote, the mean of the samples.
    Depth = 0,
    /// The normal, halved and moved to 0..1.
    Normal = 1,
    /// Motion in pictures, 0.5 + 500 x, 0.5 + 500 y.
    Motion = 2,
}

/// A sheet before the camera that shows the prepass.
#[derive(Asset, TypePath, AsBindGroup, Clone)]
pub struct Sheet {
    #[uniform(0)]
    shown: u32,
}

const SHEET: &str = r"
#import bevy_pbr::{forward_io::VertexOutput, mesh_view_bindings as vb, prepass_utils}
@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> shown: u32;
@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    var sum = vec3(0.0);
#ifdef MULTISAMPLED
    let samples = 4u;
#else
    let samples = 1u;
#endif
    for (var i = 0u; i < samples; i++) {
        var value = vec3(0.0);
#ifdef DEPTH_PREPASS
        if (shown == 0u) { value = vec3(f32(prepass_utils::prepass_depth(in.position, i) > 0.0)); }
#endif
#ifdef NORMAL_PREPASS
        if (shown == 1u) { value = prepass_utils::prepass_normal(in.position, i) * 0.5 + 0.5; }
#endif
#ifdef MOTION_VECTOR_PREPASS
        if (shown == 2u) { value = vec3(0.5 + 500.0 * prepass_utils::prepass_motion_vector(in.position, i), 0.0); }
#endif
        sum += value;
    }
    return vec4(sum / f32(samples), 1.0);
}";

const SHEET_PATH: &str = "embedded://sheet.wgsl";

impl Material for Sheet {
    fn fragment_shader() -> ShaderRef {
        SHEET_PATH.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }
}

/// Makes sheets known to the app.
pub fn with_sheets(app: &mut App) {
    app.world()
        .resource::<bevy::asset::io::embedded::EmbeddedAssetRegistry>()
        .insert_asset("sheet.wgsl".into(), "sheet.wgsl".as_ref(), SHEET.as_bytes());
    app.add_plugins(MaterialPlugin::<Sheet>::default());
}

/// Hangs a sheet before the camera.
pub fn hang_sheet(stage: &mut Stage, shown: Shown) -> Entity {
    let camera = stage.camera;
    let world = stage.app.world_mut();
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(4.0, 4.0));
    let material = world.resource_mut::<Assets<Sheet>>().add(Sheet {
        shown: shown as u32,
    });
    world
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            bevy::light::NotShadowCaster,
            bevy::light::NotShadowReceiver,
            Transform::from_xyz(0.0, 0.0, -0.12),
            ChildOf(camera),
        ))
        .id()
}

/// A picture of one color as a cube map of one pixel a side, or a volume.
pub fn plain_image(color: Color, size: bevy::render::render_resource::Extent3d) -> Image {
    let [r, g, b, _] = color.to_linear().to_f32_array();
    let mut pixel = Vec::new();
    for value in [r, g, b, 1.0] {
        pixel.extend_from_slice(&value.to_le_bytes());
    }
    Image::new_fill(
        size,
        bevy::render::render_resource::TextureDimension::D3,
        &pixel,
        bevy::render::render_resource::TextureFormat::Rgba32Float,
        RenderAssetUsages::RENDER_WORLD,
    )
}

/// Writes a failing picture under `target/test_failures`.
pub fn keep(name: &str, values: &[f32]) {
    let bytes = values.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0) as u8);
    let image = image::GrayImage::from_vec(SIZE, SIZE, bytes.collect());
    if let Some(image) = image {
        let _ = image.save(crate::failure(&format!("{name}.png")));
    }
}
