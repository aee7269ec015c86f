//! Draws the cards of a groom flat, in their tints, without a GPU: a quick look at cover, lay and layers.
//!
//! `cargo run -p plumage_tools --bin groom_preview -- parrot --time 0 --output preview.png`: from the left, the front, the back and the right
//! front; skin that shows between the feathers is cyan. With `--crossings` it measures in bind pose and over the idle clip how many
//! pairs of neighbors poke through each other, and paints those of the last pose red.

use bevy::{
    app::PluginsState,
    gltf::GltfAssetLabel,
    mesh::{
        Indices, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
    world_serialization::{WorldAssetRoot, WorldInstanceReady},
};
use bevy_plumage::anatomy::AnatomyPlugin;
use bevy_plumage::groom::{Groom, GroomPlugin, Plumage, PlumageCards, PlumageState};
use clap::Parser;
use plumage_reference::crossing::{Overlap, Overlaps, overlaps};
use std::time::{Duration, Instant};

/// What to draw.
#[derive(Parser, Resource, Clone)]
struct Args {
    /// Name of the bird and its groom.
    bird: String,
    /// Second of the idle clip; bind pose without it.
    #[arg(long)]
    time: Option<f32>,
    /// Density of the plumage.
    #[arg(long, default_value_t = 1.0)]
    density: f32,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Side of each of the four pictures, pixels.
    #[arg(long, default_value_t = 600)]
    size: usize,
    /// Part shown: centre x, y, z and half side, metres (the whole bird without it).
    #[arg(long, num_args = 4, allow_negative_numbers = true)]
    zoom: Option<Vec<f32>>,
    /// Color by layer instead of tint.
    #[arg(long)]
    layers: bool,
    /// Measure how deep lower feathers poke through higher ones.
    #[arg(long)]
    crossings: bool,
    /// Where the picture goes.
    #[arg(long, default_value = "groom_preview.png")]
    output: String,
}

fn main() {
    let args = Args::parse();
    let mut app = App::new();
    let settings = WgpuSettings {
        backends: None,
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .build()
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(settings)),
                ..default()
            })
            .disable::<WinitPlugin>(),
    )
    .add_plugins((AnatomyPlugin, GroomPlugin))
    .insert_resource(args.clone())
    .add_observer(pose)
    .add_systems(Startup, spawn);
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    let begun = Instant::now();
    loop {
        app.update();
        std::thread::sleep(Duration::from_millis(5));
        let mut states = app.world_mut().query::<&PlumageState>();
        let state = states.single(app.world()).cloned().unwrap_or_default();
        if let Some(error) = state.error {
            eprintln!("{error}");
            std::process::exit(1);
        }
        if state.is_ready() {
            println!("{state:?}");
            break;
        }
        if begun.elapsed() > Duration::from_secs(180) {
            eprintln!("no plumage after three minutes");
            std::process::exit(1);
        }
    }
    for _ in 0..4 {
        app.update();
    }
    let depths = if args.crossings {
        crossings(&mut app)
    } else {
        Vec::new()
    };
    let triangles = collect(app.world_mut(), args.layers, &depths);
    draw(&triangles, &args);
}

/// Depth that counts, metres.
const DEEP: f32 = 3.0e-4;

/// Prints the crossings in bind pose and at times of the idle clip; returns the greatest depth at each card in the last pose.
fn crossings(app: &mut App) -> Vec<f32> {
    let print = |name: &str, found: &Overlaps| {
        println!(
            "{name}: {} pairs, {:.2} % deeper than 0.3 mm; 1 % deeper than {:.2} mm",
            found.list.len(),
            100.0 * found.share(DEEP),
            1.0e3 * found.quantile(0.01)
        );
    };
    let mut last = measure(app.world_mut());
    print("as posed", &last);
    by_kind(app.world_mut(), &last);
    let (mut pairs, mut deep) = (0, 0);
    for step in 0..10 {
        let time = 0.5 * step as f32;
        let mut players = app.world_mut().query::<&mut AnimationPlayer>();
        let mut posed = false;
        for mut player in players.iter_mut(app.world_mut()) {
            for (_, clip) in player.playing_animations_mut() {
                clip.seek_to(time);
                posed = true;
            }
        }
        if !posed {
            println!("no clip plays: give --time 0");
            break;
        }
        for _ in 0..3 {
            app.update();
        }
        last = measure(app.world_mut());
        print(&format!("{time:.1} s"), &last);
        pairs += last.list.len();
        deep += last.deeper(DEEP);
    }
    by_kind(app.world_mut(), &last);
    println!(
        "idle: {:.2} % of {pairs} pairs deeper than 0.3 mm",
        100.0 * deep as f32 / pairs.max(1) as f32
    );
    let count = last.list.iter().map(|pair| pair.upper.max(pair.lower));
    let mut depths = vec![0.0_f32; count.max().map_or(0, |most| most as usize + 1)];
    for pair in &last.list {
        for card in [pair.upper, pair.lower] {
            depths[card as usize] = depths[card as usize].max(pair.depth);
        }
    }
    depths
}

/// Prints which feathers cross: those of rows (wing, tail), those of regions, or one with the other.
fn by_kind(world: &mut World, found: &Overlaps) {
    let mut query = world.query::<&PlumageCards>();
    let Some(cards) = query.iter(world).next() else {
        return;
    };
    let grooms = world.resource::<Assets<Groom>>();
    let regions = grooms
        .get(&cards.groom)
        .map_or(0, |groom| groom.regions.len());
    let in_row = |card: u32| usize::from(cards.cards[card as usize].region) >= regions;
    for (kind, rows) in [("regions", 0), ("rows and regions", 1), ("rows", 2)] {
        let of_kind = |pair: &&Overlap| {
            usize::from(in_row(pair.upper)) + usize::from(in_row(pair.lower)) == rows
        };
        let pairs = found.list.iter().filter(of_kind).copied().collect();
        let pairs = Overlaps { list: pairs };
        println!(
            "  {kind}: {} pairs, {:.2} % deeper than 0.3 mm; 1 % deeper than {:.2} mm",
            pairs.list.len(),
            100.0 * pairs.share(DEEP),
            1.0e3 * pairs.quantile(0.01)
        );
    }
}

/// The pairs of neighbors as they stand: those rooted within a length and a width of each other.
fn measure(world: &mut World) -> Overlaps {
    let mut query = world.query::<(Entity, &Mesh3d, Option<&SkinnedMesh>, &PlumageCards)>();
    let Some((entity, mesh, skin, cards)) = query.iter(world).next() else {
        return Overlaps::default();
    };
    let Some(mesh) = world.resource::<Assets<Mesh>>().get(&mesh.0) else {
        return Overlaps::default();
    };
    let places = skinned(world, entity, mesh, skin);
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
        return Overlaps::default();
    };
    let mut found = overlaps(&cards.cards, &cards.geometry, &places, uvs);
    found.list.retain(|pair| {
        let [a, b] = [pair.upper, pair.lower].map(|i| &cards.cards[i as usize]);
        let reach = a.length.max(b.length) + a.width.max(b.width);
        a.root.distance(b.root) < reach && a.normal.dot(b.normal) > 0.0
    });
    found
}

/// Vertices where the skeleton has put them.
fn skinned(world: &World, entity: Entity, mesh: &Mesh, skin: Option<&SkinnedMesh>) -> Vec<Vec3> {
    let place = |e: Entity| {
        world
            .get::<GlobalTransform>(e)
            .map_or(Mat4::IDENTITY, |t| t.to_matrix())
    };
    let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return Vec::new();
    };
    let poses = world.resource::<Assets<SkinnedMeshInverseBindposes>>();
    let matrices: Vec<Mat4> = match skin {
        Some(skin) => {
            let bind = poses.get(&skin.inverse_bindposes).expect("loaded");
            skin.joints
                .iter()
                .zip(bind.iter())
                .map(|(joint, inverse)| place(*joint) * *inverse)
                .collect()
        }
        None => vec![place(entity)],
    };
    match (
        mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX),
        mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT),
    ) {
        (
            Some(VertexAttributeValues::Uint16x4(joints)),
            Some(VertexAttributeValues::Float32x4(weights)),
        ) => positions
            .iter()
            .zip(joints.iter().zip(weights))
            .map(|(p, (j, w))| {
                let point = |k: usize| {
                    matrices[usize::from(j[k])].transform_point3(Vec3::from_array(*p)) * w[k]
                };
                (0..4).map(point).sum()
            })
            .collect(),
        _ => positions
            .iter()
            .map(|p| matrices[0].transform_point3(Vec3::from_array(*p)))
            .collect(),
    }
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    let scene = GltfAssetLabel::Scene(0).from_asset(format!("birds/{}.glb", args.bird));
    let plumage =
        Plumage::new(assets.load(format!("grooms/{}.groom.ron", args.bird))).with_seed(args.seed);
    commands.spawn((
        WorldAssetRoot(assets.load(scene)),
        plumage.with_density(args.density),
    ));
}

fn pose(
    ready: On<WorldInstanceReady>,
    args: Res<Args>,
    assets: Res<AssetServer>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let Some(time) = args.time else { return };
    let clip =
        assets.load(GltfAssetLabel::Animation(0).from_asset(format!("birds/{}.glb", args.bird)));
    let (graph, node) = AnimationGraph::from_clip(clip);
    let graph = graphs.add(graph);
    for entity in children.iter_descendants(ready.entity) {
        if let Ok(mut player) = players.get_mut(entity) {
            commands
                .entity(entity)
                .insert(AnimationGraphHandle(graph.clone()));
            player.play(node).seek_to(time).pause();
        }
    }
}

/// A skinned triangle: corners, card uv (none: body), linear color of the front.
struct Triangle {
    corners: [Vec3; 3],
    uv: Option<[Vec2; 3]>,
    color: Vec3,
    tract: u32,
}

fn collect(world: &mut World, by_layer: bool, depths: &[f32]) -> Vec<Triangle> {
    let mut out = Vec::new();
    let mut query = world.query::<(Entity, &Mesh3d, Option<&SkinnedMesh>, Option<&PlumageCards>)>();
    let list: Vec<_> = query
        .iter(world)
        .map(|(e, m, s, c)| (e, m.0.clone(), s.cloned(), c.cloned()))
        .collect();
    let meshes = world.resource::<Assets<Mesh>>();
    for (entity, mesh, skin, cards) in list {
        let Some(mesh) = meshes.get(&mesh) else {
            continue;
        };
        let places = skinned(world, entity, mesh, skin.as_ref());
        let uvs = mesh.attribute(Mesh::ATTRIBUTE_UV_0).and_then(|v| {
            if let VertexAttributeValues::Float32x2(v) = v {
                Some(v)
            } else {
                None
            }
        });
        let ids = mesh.attribute(Mesh::ATTRIBUTE_UV_1).and_then(|v| {
            if let VertexAttributeValues::Float32x2(v) = v {
                Some(v)
            } else {
                None
            }
        });
        let indices: Vec<usize> = match mesh.indices() {
            Some(Indices::U32(list)) => list.iter().map(|i| *i as usize).collect(),
            Some(Indices::U16(list)) => list.iter().map(|i| usize::from(*i)).collect(),
            None => (0..places.len()).collect(),
        };
        for t in indices.chunks_exact(3) {
            let corners = [places[t[0]], places[t[1]], places[t[2]]];
            let (uv, color) = match (&cards, uvs, ids) {
                (Some(cards), Some(uvs), Some(ids)) => {
                    let tint = Vec3::from_array(cards.cards[ids[t[0]][0].round() as usize].tint);
                    let layer = Vec3::new(
                        ids[t[0]][1],
                        (ids[t[0]][1] * 7.0).fract(),
                        1.0 - ids[t[0]][1],
                    );
                    (
                        Some([0, 1, 2].map(|k| Vec2::from_array(uvs[t[k]]))),
                        match depths.get(ids[t[0]][0] as usize) {
                            Some(&depth) if depth > DEEP => Vec3::new(0.9, 0.1, 0.05),
                            Some(_) => Vec3::splat(0.5),
                            None if by_layer => layer,
                            None => tint,
                        },
                    )
                }
                // The skin proper in cyan; bill, eyes and feet in grey.
                _ => (
                    None,
                    if ids.is_some() {
                        Vec3::new(0.0, 1.0, 1.0)
                    } else {
                        Vec3::splat(0.35)
                    },
                ),
            };
            let tract = ids.map_or(0, |ids| ids[t[0]][0] as u32);
            out.push(Triangle {
                corners,
                uv,
                color,
                tract,
            });
        }
    }
    out
}

/// Whether the card covers this place: a rounded blade.
fn covers(uv: Vec2) -> bool {
    let across = (2.0 * uv.x - 1.0).abs();
    let end = ((uv.y - 0.62) / 0.38).max(0.0);
    across < (0.25 + 2.5 * uv.y).min(1.0) * (1.0 - end * end).max(0.0).sqrt()
}

fn draw(triangles: &[Triangle], args: &Args) {
    let size = args.size;
    let mut picture = image::RgbImage::new(2 * size as u32, 2 * size as u32);
    let all = triangles.iter().flat_map(|t| t.corners);
    let (low, high) = all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
        (a.min(p), b.max(p))
    });
    let (center, half) = match args.zoom.as_deref() {
        Some(&[x, y, z, half]) => (Vec3::new(x, y, z), half),
        _ => (0.5 * (low + high), 0.52 * (high - low).max_element()),
    };
    let views = [
        (Vec3::X, Vec3::NEG_Z),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_Z, Vec3::NEG_X),
        (
            Vec3::new(0.6, 0.15, 0.79).normalize(),
            Vec3::new(0.79, 0.0, -0.6).normalize(),
        ),
    ];
    for (number, (eye, right)) in views.into_iter().enumerate() {
        let up = eye.cross(right);
        let mut depth = vec![f32::NEG_INFINITY; size * size];
        let mut color = vec![Vec3::splat(0.8); size * size];
        let (mut body, mut bare, mut back) = (0, 0, 0);
        let mut kind = vec![0_u8; size * size];
        let mut tracts = vec![0_u32; size * size];
        for triangle in triangles {
            let project = |p: Vec3| {
                let d = p - center;
                let scale = 0.5 * size as f32 / half;
                Vec3::new(
                    0.5 * size as f32 + d.dot(right) * scale,
                    0.5 * size as f32 - d.dot(up) * scale,
                    d.dot(eye),
                )
            };
            let [a, b, c] = triangle.corners.map(project);
            let area = (b - a).truncate().perp_dot((c - a).truncate());
            if area.abs() < 1.0e-9 {
                continue;
            }
            let normal = (triangle.corners[1] - triangle.corners[0])
                .cross(triangle.corners[2] - triangle.corners[0])
                .normalize_or_zero();
            let facing = normal.dot(eye);
            let low = a.min(b).min(c).truncate().max(Vec2::ZERO);
            let high = a
                .max(b)
                .max(c)
                .truncate()
                .min(Vec2::splat(size as f32 - 1.0));
            for y in low.y.ceil() as i64..=high.y.floor() as i64 {
                for x in low.x.ceil() as i64..=high.x.floor() as i64 {
                    let p = Vec2::new(x as f32, y as f32);
                    let u = (b.truncate() - p).perp_dot(c.truncate() - p) / area;
                    let v = (c.truncate() - p).perp_dot(a.truncate() - p) / area;
                    let w = 1.0 - u - v;
                    if u < 0.0 || v < 0.0 || w < 0.0 {
                        continue;
                    }
                    let z = a.z * u + b.z * v + c.z * w;
                    let at = y as usize * size + x as usize;
                    if z <= depth[at] {
                        continue;
                    }
                    let mut shade =
                        0.35 + 0.65 * normal.dot(Vec3::new(0.3, 0.8, 0.4).normalize()).abs();
                    if let Some(uv) = triangle.uv {
                        let place = uv[0] * u + uv[1] * v + uv[2] * w;
                        if !covers(place) {
                            continue;
                        }
                        shade *= 0.55 + 0.45 * place.y;
                        if (place.x - 0.5).abs() < 0.03 {
                            shade *= 0.7;
                        }
                    }
                    depth[at] = z;
                    color[at] = triangle.color * shade;
                    tracts[at] = triangle.tract;
                    kind[at] = match triangle.uv {
                        None => 1 + u8::from(triangle.color.x == 0.0),
                        Some(_) => 3 + u8::from(facing < 0.0),
                    };
                }
            }
        }
        let mut bald = std::collections::BTreeMap::<u32, u32>::new();
        for (k, tract) in kind.iter().copied().zip(&tracts) {
            if k == 2 {
                *bald.entry(*tract).or_default() += 1;
            }
            body += u32::from(k > 0);
            bare += u32::from(k == 2);
            back += u32::from(k == 4);
        }
        println!(
            "view {number}: bare {:.2} %, seen from behind {:.2} %; bare pixels by tract {bald:?}",
            100.0 * bare as f32 / body as f32,
            100.0 * back as f32 / body as f32
        );
        let corner = (number % 2 * size, number / 2 * size);
        for (i, c) in color.iter().enumerate() {
            let pixel = c
                .to_array()
                .map(|x| (x.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
            picture.put_pixel(
                (corner.0 + i % size) as u32,
                (corner.1 + i / size) as u32,
                image::Rgb(pixel),
            );
        }
    }
    if let Err(error) = picture.save(&args.output) {
        eprintln!("{}: {error}", args.output);
        std::process::exit(1);
    }
    println!("wrote {}", args.output);
}
