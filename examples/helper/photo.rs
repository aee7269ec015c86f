//! `single_feather --photo FILE`: the photograph on the left, the feather made of it on the right.

use super::{
    LENGTH, Waiting,
    helper::{
        Args,
        camera::{Framing, Shots},
    },
    spawn_cloth,
};
use bevy::{asset::RenderAssetUsages, image::Image, light::NotShadowCaster, prelude::*};
use bevy_plumage::photo::{ExtractSettings, Extraction, extract, load_photograph};
use bevy_plumage::prelude::*;
use image::DynamicImage;
use std::path::Path;

/// A photograph and the feather found on it, until both are in the scene.
#[derive(Resource)]
struct Pair {
    photograph: DynamicImage,
    found: Extraction,
    /// Left edge, lower edge, width and height of the photograph in metres; the feather's base lies at the origin.
    place: [f32; 4],
}

/// Sets the scene up if the command line names a photograph.
pub fn setup(app: &mut App) -> bool {
    let Some(file) = app.world().resource::<Args>().photo.clone() else {
        return false;
    };
    let pair = match read(&file) {
        Ok(pair) => pair,
        Err(error) => {
            eprintln!("single_feather: {error}");
            std::process::exit(1);
        }
    };
    for (what, doubt) in pair.found.confidence.doubts() {
        println!("single_feather: {what}: {doubt}");
    }
    let [left, bottom, _, height] = pair.place;
    let right = 0.5 * LENGTH * pair.found.feather.aspect;
    let (low, high) = (bottom.min(0.0), (bottom + height).max(LENGTH));
    let target = Vec3::new(0.5 * (left + right), 0.5 * (low + high), 0.0);
    let (width, height) = app.world().resource::<Args>().size;
    let half = (0.5 * (high - low)).max(0.5 * (right - left) * height as f32 / width as f32);
    let distance = 1.06 * half / 12f32.to_radians().tan();
    let from = |direction: Vec3, share: f32| Framing {
        target,
        eye: target + direction.normalize() * distance * share,
        fov: 24.0,
    };
    app.insert_resource(Shots {
        hero: from(Vec3::Z, 1.0),
        closeup: from(Vec3::Z, 0.3),
        macro_: from(Vec3::Z, 0.05),
        full: from(Vec3::new(0.15, -0.1, 1.0), 1.05),
        back: from(Vec3::NEG_Z, 1.0),
        head: None,
        far: from(Vec3::Z, 3.0),
    })
    .insert_resource(pair)
    .add_systems(Startup, spawn);
    true
}

fn read(file: &Path) -> Result<Pair, bevy_plumage::photo::ExtractError> {
    let photograph = load_photograph(file)?;
    let found = extract(&photograph, &ExtractSettings::default(), &mut |_| ())?;
    let metres = LENGTH / found.frame.v.length().max(1.0);
    let (width, height) = (
        photograph.width() as f32 * metres,
        photograph.height() as f32 * metres,
    );
    let base = found.rachis.first().map_or(0.0, |point| point.y) * metres;
    let gap = 0.5 * LENGTH * found.feather.aspect + 0.02;
    let place = [-gap - width, base - height, width, height];
    Ok(Pair {
        photograph,
        found,
        place,
    })
}

fn picture(image: DynamicImage) -> Image {
    Image::from_dynamic(image, true, RenderAssetUsages::default())
}

fn spawn(
    mut commands: Commands,
    pair: Res<Pair>,
    mut feathers: ResMut<Assets<Feather>>,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    spawn_cloth(&mut commands, &mut meshes, &mut materials);
    let mut feather = pair.found.feather.clone();
    feather.image = Some(images.add(picture(pair.found.albedo.clone().into())));
    commands.spawn((
        Waiting(feathers.add(feather)),
        Transform::IDENTITY,
        Visibility::default(),
    ));
    // The lamp of a copying stand, so that both are seen in the same light.
    commands.spawn((
        DirectionalLight {
            illuminance: 12_000.0,
            shadow_maps_enabled: false,
            ..default()
        },
        Transform::from_xyz(-0.6, 0.8, 1.6).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let [left, bottom, width, height] = pair.place;
    commands.spawn((
        Mesh3d(meshes.add(Rectangle::new(width, height))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(images.add(picture(pair.photograph.to_rgba8().into()))),
            unlit: true,
            ..default()
        })),
        NotShadowCaster,
        Transform::from_xyz(left + 0.5 * width, bottom + 0.5 * height, 0.0),
    ));
}
