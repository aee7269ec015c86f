//! Feathers in the colors of the skin: textures come back at the roots, edits are followed without a new groom, and primitives of one
//! body are one skin.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_plumage::groom::*;
use plumage_tests::{headless, view::patch_groom, wait};

/// Texels along each side of the checker.
const TEXELS: u32 = 8;
/// Side of the skin, metres.
const SIDE: f32 = 0.4;
/// Width of a feather, metres; its color is the mean over half of that.
const WIDTH: f32 = 0.006;

/// How often a plumage has grown.
#[derive(Resource, Default)]
struct Grown(u32);

fn app() -> App {
    let mut app = headless::grooms_and_paints();
    app.init_resource::<Grown>()
        .add_observer(|_: On<PlumageReady>, mut grown: ResMut<Grown>| grown.0 += 1);
    app
}

/// Squares of these two sRGB colors in turn.
fn checker(colors: [[u8; 3]; 2]) -> Image {
    let texel = |i: u32| {
        let [r, g, b] = colors[((i % TEXELS + i / TEXELS) % 2) as usize];
        [r, g, b, 255]
    };
    Image::new(
        Extent3d {
            width: TEXELS,
            height: TEXELS,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        (0..TEXELS * TEXELS).flat_map(texel).collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::all(),
    )
}

fn add<A: Asset>(app: &mut App, asset: A) -> Handle<A> {
    app.world_mut().resource_mut::<Assets<A>>().add(asset)
}

fn cards(app: &mut App, bird: Entity) -> Vec<Card> {
    wait::until("the feathers", || {
        app.update();
        let state = app.world().get::<PlumageState>(bird);
        state.is_some_and(PlumageState::is_ready).then_some(())
    });
    // One frame to spawn, one to color.
    app.update();
    app.update();
    let parts = app.world().get::<PlumageParts>(bird).expect("feathers");
    let cards = app.world().get::<PlumageCards>(parts[0]).expect("cards");
    cards.cards.to_vec()
}

fn srgb(color: [f32; 3]) -> [f32; 3] {
    let color = Srgba::from(LinearRgba::rgb(color[0], color[1], color[2]));
    [color.red, color.green, color.blue]
}

/// Texel that a root lies on, and whether its feather looks at no other.
fn texel(root: Vec3) -> (u32, bool) {
    let place = [0.5 + root.x / SIDE, 0.5 - root.y / SIDE].map(|uv| uv * TEXELS as f32);
    let margin = 0.5 * WIDTH / SIDE * TEXELS as f32;
    let inside = |x: f32| x.fract() > margin && x.fract() < 1.0 - margin;
    let parity = (place[0] as u32 + place[1] as u32) % 2;
    (parity, inside(place[0]) && inside(place[1]))
}

#[test]
fn a_checker_comes_back_and_a_new_one_without_a_new_groom() {
    let mut app = app();
    let mut groom = patch_groom(600);
    groom.regions[0].width = Span(1000.0 * WIDTH, 1000.0 * WIDTH);
    groom.regions[0].jitter = Jitter::NONE;
    groom.regions[0].skin_color = 1.0;
    let groom = add(&mut app, groom);
    let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.5 * SIDE)).mesh();
    let mesh = add(&mut app, plane.subdivisions(10).build());
    let first = [[230, 40, 20], [10, 90, 200]];
    let image = add(&mut app, checker(first));
    let material = add(&mut app, StandardMaterial::from(image.clone()));
    let bird = app
        .world_mut()
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material.clone()),
            Transform::default(),
            Plumage::new(groom).with_seed(5),
        ))
        .id();
    let check = |app: &mut App, colors: [[u8; 3]; 2], factor: f32| {
        let cards = cards(app, bird);
        let mut judged = 0;
        for card in &cards {
            let (parity, inside) = texel(card.root);
            if inside {
                judged += 1;
                let wanted = colors[parity as usize].map(|c| f32::from(c) / 255.0);
                for (got, wanted) in srgb(card.tint.map(|c| c / factor)).iter().zip(wanted) {
                    let error = (got - wanted).abs();
                    assert!(error < 1.0 / 255.0, "{:?} at {}", card.tint, card.root);
                }
            }
        }
        assert!(judged > cards.len() / 2, "{judged} of {}", cards.len());
    };
    check(&mut app, first, 1.0);

    let second = [[250, 250, 240], [20, 20, 25]];
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&image).expect("the texture") = checker(second);
    app.update();
    check(&mut app, second, 1.0);

    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    materials
        .get_mut(&material)
        .expect("the material")
        .base_color = Color::linear_rgb(0.5, 0.5, 0.5);
    app.update();
    check(&mut app, second, 0.5);
    assert_eq!(app.world().resource::<Grown>().0, 1, "groomed anew");
}

#[test]
fn primitives_of_one_body_are_one_skin() {
    let mut app = app();
    let node = app.world_mut().spawn(Transform::default()).id();
    let colors = [
        ("gull.white", Color::WHITE),
        ("gull.black", Color::linear_rgb(0.02, 0.02, 0.02)),
        ("gull.gray", Color::linear_rgb(0.3, 0.3, 0.35)),
        ("gull.LeftEyes", Color::linear_rgb(0.9, 0.5, 0.0)),
    ];
    for (i, (name, color)) in colors.into_iter().enumerate() {
        let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.1))
            .mesh()
            .subdivisions(4);
        let mesh = plane.build().translated_by(Vec3::X * 0.2 * i as f32);
        let mesh = add(&mut app, mesh);
        let material = add(&mut app, StandardMaterial::from(color));
        app.world_mut().spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Name::new(name),
            Transform::default(),
            ChildOf(node),
        ));
    }
    app.world_mut().entity_mut(node).insert(Plumage::default());
    let cards = cards(&mut app, node);
    let (mut seen, mut bare) = ([0; 3], 0);
    for card in &cards {
        let part = ((card.root.x + 0.1) / 0.2).floor() as usize;
        match seen.get_mut(part) {
            Some(count) => *count += 1,
            None => bare += 1,
        }
        // Not at the seams, where a feather may begin on its neighbor.
        let middle = 0.2 * part as f32;
        if (card.root.x - middle).abs() < 0.09 && part < 3 {
            let wanted = colors[part].1.to_linear().to_f32_array_no_alpha();
            for (got, wanted) in card.tint.iter().zip(wanted) {
                assert!(
                    (got - wanted).abs() < 1e-5,
                    "{:?} at {}",
                    card.tint,
                    card.root
                );
            }
        }
    }
    println!("feathers on white, black, gray: {seen:?}, on the eyes: {bare}");
    let mean = cards.len() / 3;
    assert!(seen.iter().all(|count| *count > mean / 2), "{seen:?}");
    assert_eq!(bare, 0, "feathers on eyes");
}

#[test]
fn a_mesh_without_a_material_keeps_the_tint() {
    let mut app = app();
    let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.1)).mesh().build();
    let mesh = add(&mut app, plane);
    let mut groom = patch_groom(20);
    groom.regions[0].skin_color = 1.0;
    groom.regions[0].jitter = Jitter::NONE;
    let own = Tint([0.8, 0.2, 0.1], [0.8, 0.2, 0.1]);
    assert_eq!(groom.regions[0].tint, own);
    let groom = add(&mut app, groom);
    let bird = app
        .world_mut()
        .spawn((Mesh3d(mesh), Transform::default(), Plumage::new(groom)))
        .id();
    for card in cards(&mut app, bird) {
        for (got, wanted) in srgb(card.tint).iter().zip(own.0) {
            assert!((got - wanted).abs() < 1e-3, "{:?}", card.tint);
        }
    }
}
