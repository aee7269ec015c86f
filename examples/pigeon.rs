//! Head and neck of a rock dove: green and purple films that trade places as it turns.
//!
//! `cargo run --example pigeon -- --turn 40`; `--help` lists all options, F1 the keys. The skin is made here, section by section along
//! the spine; no file but those of the feathers is read.

mod helper;

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_plumage::{Guide, NotSkin, Region, Select, Span, Tint, prelude::*};
use helper::{
    Args,
    camera::{Shots, shot},
};
use std::f32::consts::TAU;

const SHOTS: Shots = Shots {
    hero: shot([0.0, 0.098, 0.006], [0.30, 0.14, 0.62], 14.0),
    closeup: shot([0.018, 0.085, 0.014], [0.11, 0.10, 0.22], 14.0),
    macro_: shot([0.020, 0.085, 0.016], [0.05, 0.09, 0.07], 14.0),
    full: shot([0.0, 0.098, 0.006], [0.69, 0.12, 0.05], 14.0),
    back: shot([0.0, 0.098, 0.0], [-0.30, 0.16, -0.62], 14.0),
    head: None,
    far: shot([0.0, 0.098, 0.0], [1.2, 0.4, 2.4], 14.0),
};

/// Sections of the skin along the spine: height and place forward of the middle, half width and half depth, mm; from breast to bill.
const SPINE: [[f32; 4]; 15] = [
    [-20.0, -14.0, 54.0, 60.0],
    [10.0, -6.0, 50.0, 54.0],
    [34.0, 1.0, 42.0, 45.0],
    [55.0, 6.0, 32.0, 34.0],
    [73.0, 9.0, 24.5, 26.5],
    [90.0, 10.0, 19.5, 21.5],
    [105.0, 10.5, 16.5, 18.5],
    [117.0, 12.0, 14.8, 17.0],
    [127.0, 15.0, 14.0, 16.5],
    [134.5, 20.0, 13.2, 15.5],
    [138.5, 26.0, 12.0, 13.6],
    [139.5, 32.0, 10.2, 11.2],
    [138.5, 37.5, 7.6, 8.6],
    [136.5, 42.0, 4.8, 5.8],
    [135.5, 44.0, 3.2, 4.2],
];
/// Rings of the skin between two sections, and corners of a ring.
const RINGS: usize = 4;
const CORNERS: usize = 40;
/// Heights, mm, at which purple gives way to green, breast to purple; above the first lies the head.
const COLLAR: [f32; 3] = [112.0, 76.0, 46.0];

fn main() -> AppExit {
    helper::run("pigeon", |app| {
        app.add_plugins(PlumagePlugins)
            .insert_resource(SHOTS)
            .add_systems(Startup, setup)
            .add_systems(Update, dress);
    })
}

/// The feathers that are still loading: of head and breast, and of the neck.
#[derive(Component)]
struct Naked([Handle<Feather>; 2]);

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut plain = |color: Color, roughness: f32| {
        materials.add(StandardMaterial {
            base_color: color,
            perceptual_roughness: roughness,
            ..default()
        })
    };
    let skin = plain(Color::srgb(0.12, 0.12, 0.13), 0.9);
    let horn = plain(Color::srgb(0.10, 0.10, 0.11), 0.45);
    let cere = plain(Color::srgb(0.80, 0.79, 0.77), 0.8);
    let iris = plain(Color::srgb(0.85, 0.25, 0.03), 0.15);
    let pupil = plain(Color::srgb(0.01, 0.01, 0.01), 0.05);
    let lid = plain(Color::srgb(0.45, 0.44, 0.46), 0.8);
    let names = ["contour", "pigeon_neck"];
    let feathers = names.map(|name| assets.load(format!("feathers/{name}.feather.ron")));
    commands.spawn((
        Mesh3d(meshes.add(skin_mesh())),
        MeshMaterial3d(skin),
        Naked(feathers),
        PlumageState::default(),
    ));
    let mut part = |mesh: Mesh, material: &Handle<StandardMaterial>, place: Transform| {
        commands.spawn((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(material.clone()),
            place,
            NotSkin,
        ));
    };
    let ball = || Sphere::new(0.001).mesh().uv(24, 16);
    let at = |x: f32, y: f32, z: f32, half: [f32; 3]| {
        Transform::from_xyz(1e-3 * x, 1e-3 * y, 1e-3 * z).with_scale(Vec3::from_array(half))
    };
    // Both halves of the bill, a little bent down, and the swollen cere on the upper one.
    let down = Quat::from_rotation_x(0.22);
    let upper = at(0.0, 135.2, 45.0, [2.7, 2.3, 13.5]).with_rotation(down);
    let lower = at(0.0, 133.4, 43.5, [2.5, 1.6, 11.5]).with_rotation(down);
    part(ball(), &horn, upper);
    part(ball(), &horn, lower);
    for side in [-1.0, 1.0] {
        part(ball(), &cere, at(1.6 * side, 138.0, 44.5, [2.0, 1.8, 3.8]));
        part(ball(), &lid, at(8.7 * side, 138.2, 29.5, [2.6, 4.1, 4.4]));
        part(ball(), &iris, at(9.4 * side, 138.2, 29.8, [2.6, 3.1, 3.2]));
        part(
            ball(),
            &pupil,
            at(10.8 * side, 138.2, 30.1, [1.4, 1.6, 1.6]),
        );
    }
}

/// Dresses the skin once its feathers are there: the purple ones are the green ones with a thinner film.
fn dress(
    mut commands: Commands,
    naked: Query<(Entity, &Naked)>,
    args: Res<Args>,
    mut feathers: ResMut<Assets<Feather>>,
    mut grooms: ResMut<Assets<Groom>>,
) {
    for (entity, Naked([plain, green])) in &naked {
        let Some(mut purple) = feathers.get(green).cloned() else {
            continue;
        };
        if let Some(film) = &mut purple.iridescence {
            film.cortex_nm = 530.0;
        }
        let purple = feathers.add(purple);
        let mut groom = Groom::default();
        groom.feathers = [plain, green, &purple].map(|f| f.clone().into()).into();
        let [head, neck, breast] = COLLAR;
        groom.regions = vec![
            region("head", 0, 900, [head - 9.0, 200.0], [7.0, 11.0], 0x55606C),
            region(
                "neck",
                1,
                620,
                [neck - 9.0, head + 4.0],
                [14.0, 19.0],
                0x4A5058,
            ),
            region(
                "collar",
                2,
                560,
                [breast - 10.0, neck + 6.0],
                [17.0, 22.0],
                0x4A5058,
            ),
            region("breast", 0, 700, [-40.0, breast], [22.0, 28.0], 0x66646F),
        ];
        groom.guides = (0..16).map(guide).collect();
        commands.entity(entity).remove::<Naked>().insert((
            Plumage::new(grooms.add(groom))
                .with_seed(args.seed)
                .with_density(args.density.unwrap_or(1.0)),
            args.quality(FeatherTransparency::default()),
            args.condition(),
        ));
    }
}

/// Feathers between two heights, mm; lengths at its upper and lower end.
fn region(
    name: &str,
    feather: u16,
    count: u32,
    [low, high]: [f32; 2],
    length: [f32; 2],
    tint: u32,
) -> Region {
    let mut region = Region::new(name);
    region.feather = feather;
    region.count = count;
    region.select = Select::Within {
        low: [-200.0, low, -200.0],
        high: [200.0, high, 200.0],
    };
    region.length = Span(length[0], length[1]);
    region.width = Span(0.48 * length[0], 0.48 * length[1]);
    region.lift = Span(7.0, 7.0);
    region.curl = 10.0;
    region.layer = high;
    let color = [16, 8, 0].map(|shift| ((tint >> shift) & 255) as f32 / 255.0);
    region.tint = Tint(color, color);
    region
}

/// A point of the skin, mm: `along` counts sections from the breast, `around` runs from the front over the left side.
fn skin_point(along: f32, around: f32) -> Vec3 {
    let i = (along as usize).min(SPINE.len() - 2);
    let section = |k: isize| {
        let k = (i as isize + k).clamp(0, SPINE.len() as isize - 1) as usize;
        Vec4::from_array(SPINE[k])
    };
    // Catmull and Rom 1974.
    let (a, b, c, d) = (section(-1), section(0), section(1), section(2));
    let t = along - i as f32;
    let at = b + 0.5
        * t
        * ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)));
    let slope = (c - a).lerp(d - b, t);
    // Across the spine in the plane of symmetry.
    let up = Vec2::new(slope.x, slope.y).normalize_or(Vec2::X);
    let (sin, cos) = around.sin_cos();
    Vec3::new(
        at.z * sin,
        at.x - at.w * cos * up.y,
        at.y + at.w * cos * up.x,
    )
}

/// The skin: rings along the spine, closed at the bill.
fn skin_mesh() -> Mesh {
    let rings = (SPINE.len() - 1) * RINGS;
    let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for ring in 0..=rings {
        for corner in 0..=CORNERS {
            let around = corner as f32 / CORNERS as f32;
            let point = skin_point(ring as f32 / RINGS as f32, around * TAU);
            positions.push((point * 1e-3).to_array());
            uvs.push([around, ring as f32 / rings as f32]);
        }
    }
    let width = CORNERS as u32 + 1;
    for ring in 0..rings as u32 {
        for corner in 0..CORNERS as u32 {
            let k = ring * width + corner;
            indices.extend([k, k + 1, k + width, k + 1, k + width + 1, k + width]);
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices))
    .with_computed_smooth_normals()
}

/// The lay: strokes from the bill down to the breast, all around.
fn guide(number: usize) -> Guide {
    let around = (number as f32 + 0.5) / 16.0 * TAU;
    let last = (SPINE.len() - 1) as f32;
    let points = (0..=28).map(|i| skin_point(last * (1.0 - i as f32 / 28.0), around).to_array());
    Guide::new(points.collect::<Vec<_>>())
}
