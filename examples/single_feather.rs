//! One feather on a card of its own: no bird, no groom.
//!
//! `cargo run --example single_feather -- --feather NAME` shows any file of `assets/feathers`; with `--features photo`,
//! `--photo FILE` makes a feather of a photograph and shows both. `--help` lists all options, F1 the keys.

mod helper;
#[cfg(feature = "photo")]
#[path = "helper/photo.rs"]
mod photo;

use bevy::{
    asset::RenderAssetUsages,
    light::NotShadowCaster,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_plumage::{Card, CardGeometry, PlumageCards, prelude::*};
use helper::{
    Args,
    camera::{Framing, Shots},
    cost,
};

fn main() -> AppExit {
    helper::run("single_feather", |app| {
        app.add_plugins(PlumagePlugins);
        #[cfg(feature = "photo")]
        if photo::setup(app) {
            app.add_systems(Update, spawn);
            return;
        }
        #[cfg(not(feature = "photo"))]
        if app.world().resource::<Args>().photo.is_some() {
            eprintln!("single_feather: --photo needs `--features photo`");
            std::process::exit(2);
        }
        // Half way up; the card leans back a little there.
        let middle = Vec3::new(0.006, 0.1542, -0.0135);
        app.insert_resource(Shots {
            hero: shot(middle, Vec3::new(0.12, -0.08, 0.80)),
            closeup: shot(middle, Vec3::new(0.008, -0.01, 0.06)),
            macro_: shot(middle, Vec3::new(0.0004, -0.0006, 0.005)),
            full: shot(middle, Vec3::new(0.0, 0.0, 0.85)),
            back: shot(middle, Vec3::new(-0.15, 0.05, -0.80)),
            head: None,
            far: shot(middle, Vec3::new(0.3, 0.2, 2.6)),
        })
        .add_systems(Startup, load)
        .add_systems(Update, spawn);
    })
}

fn shot(target: Vec3, offset: Vec3) -> Framing {
    Framing {
        target,
        eye: target + offset,
        fov: 24.0,
    }
}

/// The feather that is still loading.
#[derive(Component)]
struct Waiting(Handle<Feather>);

fn load(
    mut commands: Commands,
    assets: Res<AssetServer>,
    args: Res<Args>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    spawn_cloth(&mut commands, &mut meshes, &mut materials);
    let feather = assets.load(format!("feathers/{}.feather.ron", args.feather));
    commands.spawn(Waiting(feather));
}

/// A dark cloth around: what shows between the barbules should not outshine them.
fn spawn_cloth(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Sphere::new(3.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.30, 0.29, 0.28),
            unlit: true,
            cull_mode: None,
            ..default()
        })),
        NotShadowCaster,
    ));
}

/// Length of the card in metres: every feather is shown as long as a primary, so that the shots fit.
const LENGTH: f32 = 0.31;

/// Spawns the card once the feather's size is known.
fn spawn(
    mut commands: Commands,
    waiting: Query<(Entity, &Waiting)>,
    mut feathers: ResMut<Assets<Feather>>,
    args: Res<Args>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, Waiting(handle)) in &waiting {
        let Some(feather) = feathers.get(handle).cloned() else {
            continue;
        };
        let length = LENGTH;
        let width = length * feather.aspect;
        // One card needs no sorting: blend it, for every step of coverage that there is.
        let mut quality = args.quality(FeatherTransparency::Blend);
        quality.settings.shelter = 0.0;
        // The groom's tint: brown for an eagle, a macaw's blue for the rest.
        let tint = if args.feather.starts_with("eagle") {
            [0.12, 0.07, 0.035]
        } else {
            [0.03, 0.12, 0.55]
        };
        let mesh = meshes.add(card_mesh(length, width));
        let drawn = |feather: Handle<Feather>| {
            (
                Mesh3d(mesh.clone()),
                quality,
                args.condition(),
                PlumageCards::new(
                    [card(length, width, tint)],
                    [CardGeometry {
                        first_vertex: 0,
                        vertex_count: 75,
                    }],
                    vec![feather],
                ),
            )
        };
        let bare = args.layers_cost.map(|_| {
            let mut bare = feather;
            bare.iridescence = None;
            bare.iridescence_scale = None;
            feathers.add(bare)
        });
        for place in places(args.copies, length, width) {
            let mut copy = commands.spawn((drawn(handle.clone()), place, Visibility::default()));
            if let Some(bare) = &bare {
                copy.insert((cost::Timed(true), Visibility::Hidden));
                commands.spawn((
                    drawn(bare.clone()),
                    place,
                    cost::Timed(false),
                    Visibility::Hidden,
                ));
            }
        }
        commands.entity(entity).despawn();
    }
}

/// Where copies of the feather stand, so small that together they fill the place of one.
fn places(copies: u32, length: f32, width: f32) -> impl Iterator<Item = Transform> {
    let share = 1.0 / copies as f32;
    (0..copies * copies).map(move |i| {
        let (column, row) = ((i % copies) as f32, (i / copies) as f32);
        let x = width * (share * (column + 0.5) - 0.5);
        Transform::from_xyz(x, length * share * row, 0.0).with_scale(Vec3::splat(share))
    })
}

fn card(length: f32, width: f32, tint: [f32; 3]) -> Card {
    Card {
        root: Vec3::ZERO,
        along: Vec3::Y,
        normal: Vec3::Z,
        center: Vec3::Y * 0.5 * length,
        radius: 0.5 * length.hypot(width) * 1.1,
        length,
        width,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer: 0.0,
        tint,
        seed: 1,
        turn: 0.0,
        mirrored: false,
    }
}

/// A gently bent strip of 24 quads with the attributes that feather cards carry.
fn card_mesh(length: f32, width: f32) -> Mesh {
    const SEGMENTS: u32 = 24;
    let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
    let (mut uvs, mut ids, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=SEGMENTS {
        let v = i as f32 / SEGMENTS as f32;
        // A circular arc of 0.35 rad, leaning back towards the tip.
        let angle = 0.35 * v;
        let center = Vec3::new(0.0, angle.sin(), angle.cos() - 1.0) * length / 0.35;
        let normal = Vec3::new(0.0, angle.sin(), angle.cos());
        for u in [0.0, 0.5, 1.0] {
            positions.push(
                center + Vec3::X * (u - 0.5) * width - normal * (u - 0.5).abs() * 0.12 * width,
            );
            normals.push((normal + Vec3::X * (u - 0.5) * 0.5).normalize());
            tangents.push([0.0, angle.cos(), -angle.sin(), -1.0]);
            uvs.push([u, v]);
            ids.push([0.0, 0.0]);
        }
        if i < SEGMENTS {
            let k = 3 * i;
            for quad in [[k, k + 1, k + 4, k + 3], [k + 1, k + 2, k + 5, k + 4]] {
                indices.extend([quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]]);
            }
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, tangents)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, ids)
    .with_inserted_indices(Indices::U32(indices))
}
