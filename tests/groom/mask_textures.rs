//! Masks in textures: followed at the roots on triangles coarser than their texels, anew when they are painted over, and named when
//! they cannot serve.

use bevy::{
    asset::{LoadState, RenderAssetUsages},
    image::{CompressedImageFormats, ImageLoader},
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_plumage::asset::RonAsset;
use bevy_plumage::groom::*;
use plumage_tests::{headless, view::patch_groom, wait};
use std::path::Path;

/// Texels along each side of a mask.
const TEXELS: u32 = 16;
/// Side of the skin, metres.
const SIDE: f32 = 0.4;

/// How often a plumage has grown.
#[derive(Resource, Default)]
struct Grown(u32);

fn app(assets: &Path) -> App {
    let mut app = headless::grooms(assets, ImagePlugin::default());
    app.init_resource::<Grown>()
        .add_observer(|_: On<PlumageReady>, mut grown: ResMut<Grown>| grown.0 += 1);
    // Bevy's renderer does this, there is none here.
    app.register_asset_loader(ImageLoader::new(CompressedImageFormats::NONE));
    app
}

fn shipped() -> App {
    app(&plumage_tests::asset(""))
}

fn add<A: Asset>(app: &mut App, asset: A) -> Handle<A> {
    app.world_mut().resource_mut::<Assets<A>>().add(asset)
}

/// A texture of these texels, red and green.
fn texture(texel: impl Fn(u32, u32) -> [u8; 2]) -> Image {
    let rgba = |i: u32| {
        let [red, green] = texel(i % TEXELS, i / TEXELS);
        [red, green, 0, 255]
    };
    Image::new(
        Extent3d {
            width: TEXELS,
            height: TEXELS,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        (0..TEXELS * TEXELS).flat_map(rgba).collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::all(),
    )
}

/// Squares of four texels in turn: 255 and 0 in red, the other way round in green.
fn checker(x: u32, y: u32) -> [u8; 2] {
    if (x / 4 + y / 4).is_multiple_of(2) {
        [255, 0]
    } else {
        [0, 255]
    }
}

/// Distance of a root to the nearest border of a square, in squares, and which color it is on.
fn square(root: Vec3) -> (f32, u32) {
    let place = [0.5 + root.x / SIDE, 0.5 - root.y / SIDE].map(|uv| uv * (TEXELS / 4) as f32);
    let inside = place.map(|x| x.fract().min(1.0 - x.fract()));
    let parity = (place[0] as u32 + place[1] as u32) % 2;
    (inside[0].min(inside[1]), parity)
}

/// A skin of two triangles that looks to +z.
fn bird(app: &mut App, groom: Groom) -> Entity {
    let mesh = add(
        app,
        Plane3d::new(Vec3::Z, Vec2::splat(0.5 * SIDE))
            .mesh()
            .build(),
    );
    let groom = add(app, groom);
    let parts = (
        Mesh3d(mesh),
        Transform::default(),
        Plumage::new(groom).with_seed(5),
    );
    app.world_mut().spawn(parts).id()
}

fn grown(app: &mut App, bird: Entity, times: u32) -> (Vec<Card>, Vec<String>) {
    wait::until("the feathers", || {
        app.update();
        let state = app.world().get::<PlumageState>(bird)?;
        assert_eq!(state.error, None);
        let there = app.world().resource::<Grown>().0 >= times;
        (there && state.is_ready()).then_some(())
    });
    let state = app.world().get::<PlumageState>(bird).expect("a state");
    let warnings = state.warnings.clone();
    let parts = app.world().get::<PlumageParts>(bird).expect("feathers");
    let cards = app.world().get::<PlumageCards>(parts[0]).expect("cards");
    (cards.cards.to_vec(), warnings)
}

/// A groom whose feathers differ by masks only, and grow where they stand.
fn even(count: u32, masks: Vec<MaskTexture>) -> Groom {
    let mut groom = patch_groom(count);
    groom.regions[0].jitter = Jitter::NONE;
    groom.guides = vec![Guide::new([[0.0, 100.0, 0.0], [0.0, -100.0, 0.0]])];
    groom.masks = masks;
    groom
}

#[test]
fn a_texture_says_where_feathers_grow_and_a_new_one_is_followed() {
    let mut app = shipped();
    let plain = bird(&mut app, even(1200, Vec::new()));
    let all = grown(&mut app, plain, 1).0.len();
    let image = add(&mut app, texture(checker));
    let mask = MaskTexture::new(image.clone(), MaskValues::Density(0.0, 1.0));
    let masked = bird(&mut app, even(1200, vec![mask]));
    let mut check = |times: u32, wanted: u32| {
        let (cards, warnings) = grown(&mut app, masked, times);
        assert!(warnings.is_empty(), "{warnings:?}");
        let share = cards.len() as f32 / all as f32;
        assert!((0.46..0.54).contains(&share), "{share} of the feathers");
        let (mut right, mut wrong) = (0, 0);
        for card in &cards {
            // Between texels the mask runs from one to the other.
            let (inside, parity) = square(card.root);
            if inside > 0.13 {
                right += u32::from(parity == wanted);
                wrong += u32::from(parity != wanted);
            }
        }
        println!("{right} feathers where they are wanted, {wrong} elsewhere");
        assert_eq!(wrong, 0);
        assert!(
            right as usize > cards.len() / 3,
            "{right} of {}",
            cards.len()
        );
        // Every square has its share.
        let mut squares = [0; (TEXELS * TEXELS / 16) as usize];
        for card in &cards {
            let place = [0.5 + card.root.x / SIDE, 0.5 - card.root.y / SIDE];
            let [x, y] = place.map(|uv| ((uv * 4.0) as usize).min(3));
            squares[4 * y + x] += 1;
        }
        let mean = cards.len() / 8;
        let sparse = squares.iter().filter(|count| **count < mean / 2).count();
        assert_eq!(sparse, 8, "{squares:?}");
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        *images.get_mut(&image).expect("the texture") =
            texture(|x, y| checker(x, y).map(|texel| 255 - texel));
    };
    check(2, 0);
    check(3, 1);
}

#[test]
fn length_and_lift_follow_their_channels() {
    let mut app = shipped();
    // Red rises from left to right, green from top to bottom.
    let ramp = |x: u32| (x * 255 / (TEXELS - 1)) as u8;
    let mut picture = texture(|x, y| [ramp(x), ramp(y)]);
    picture.sampler = bevy::image::ImageSampler::linear();
    let image = add(&mut app, picture);
    let masks = vec![
        MaskTexture::new(image.clone(), MaskValues::Length(0.5, 1.5)),
        MaskTexture::new(image, MaskValues::Lift(0.0, 30.0)).with_channel(Channel::Green),
    ];
    // The same without masks, at three lifts.
    let lifted = [5.0, 20.0, 35.0].map(|lift| {
        let mut groom = even(400, Vec::new());
        groom.regions[0].lift = Span(lift, lift);
        let bird = bird(&mut app, groom);
        let times = app.world().resource::<Grown>().0 + 1;
        grown(&mut app, bird, times).0
    });
    let plain = &lifted[0];
    let masked = bird(&mut app, even(400, masks));
    let (masked, warnings) = grown(&mut app, masked, 4);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(masked.len(), plain.len());
    // Number of feathers in each quarter from top to bottom, how far they rise and how far they should.
    let mut quarters = [(0.0, 0.0, 0.0); 4];
    for card in &masked {
        // The coat's order follows length and lift: each is found by its root.
        let away = |other: &Card| other.root.truncate().distance(card.root.truncate());
        let nearest = |list: &[Card]| {
            let found = list.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            found.copied().expect("feathers")
        };
        let own = &nearest(plain);
        // The height over the skin goes with the width.
        let moved = away(own);
        assert!(moved < 1e-5, "a mask moved a root by {moved}");
        let (u, v) = (0.5 + card.root.x / SIDE, 0.5 - card.root.y / SIDE);
        let share = |at: f32| ((at * TEXELS as f32 - 0.5) / (TEXELS - 1) as f32).clamp(0.0, 1.0);
        let ratio = card.length / own.length;
        assert!((ratio - (0.5 + share(u))).abs() < 0.01, "{ratio} at u {u}");
        let rise = |card: &Card| card.along.z.asin().to_degrees();
        let place = 2.0 * share(v);
        let below = (place as usize).min(1);
        let [low, high] = [0, 1].map(|i| rise(&nearest(&lifted[below + i])));
        let wanted = low + (high - low) * (place - below as f32);
        let quarter = &mut quarters[((4.0 * v) as usize).min(3)];
        *quarter = (quarter.0 + 1.0, quarter.1 + rise(card), quarter.2 + wanted);
    }
    // Each feather gives way to its neighbors a little; together they rise as the mask says.
    for (i, (count, rises, wanted)) in quarters.into_iter().enumerate() {
        let (rises, wanted) = (rises / count, wanted / count);
        println!("quarter {i}: {count} feathers rise {rises:.1} degrees, wanted {wanted:.1}");
        assert!(count > 50.0 && (rises - wanted).abs() < 1.5);
    }
}

/// What is said of a bird with these masks besides those of its groom.
fn said(masks: impl FnOnce(&mut App) -> Vec<MaskTexture>, mesh: Mesh) -> (usize, Vec<String>) {
    let mut app = shipped();
    let masks = masks(&mut app);
    let mesh = add(&mut app, mesh);
    let parts = (Mesh3d(mesh), Transform::default(), Plumage::default());
    let bird = app.world_mut().spawn((parts, PlumageMasks(masks))).id();
    let (cards, warnings) = grown(&mut app, bird, 1);
    (cards.len(), warnings)
}

#[test]
fn what_cannot_serve_is_named_and_feathers_grow_all_the_same() {
    let plane = || {
        Plane3d::new(Vec3::Y, Vec2::splat(0.2))
            .mesh()
            .subdivisions(4)
            .build()
    };
    let nowhere = MaskValues::Density(0.0, 0.0);
    let check = |masks: Vec<MaskTexture>, mesh: Mesh, words: &[&str]| {
        let (count, warnings) = said(|_| masks, mesh);
        assert!(count > 0, "{words:?}: no feathers");
        let named = |text: &String| words.iter().all(|word| text.contains(word));
        assert!(warnings.iter().any(named), "{words:?} in {warnings:?}");
    };
    let missing = MaskTexture::new("no/such_mask.png", nowhere);
    check(
        vec![missing],
        plane(),
        &["no/such_mask.png", "did not load"],
    );

    let (count, warnings) = said(
        |app| {
            let gray = Image::new(
                Extent3d {
                    width: 2,
                    height: 1,
                    depth_or_array_layers: 1,
                },
                TextureDimension::D2,
                vec![0, 0],
                TextureFormat::R8Unorm,
                RenderAssetUsages::all(),
            );
            let gray = add(app, gray);
            vec![MaskTexture::new(gray, nowhere).with_channel(Channel::Green)]
        },
        plane(),
    );
    assert!(count > 0);
    assert!(warnings[0].contains("`channel` is Green") && warnings[0].contains("first 1"));

    let (count, warnings) = said(
        |app| {
            let image = add(app, texture(checker));
            let sets = MaskValues::Density(0.0, 1.0);
            vec![MaskTexture::new(image, sets).with_channel(Channel::Alpha)]
        },
        plane(),
    );
    assert!(count > 0);
    assert!(
        warnings[0].contains("channel Alpha is 1 everywhere"),
        "{warnings:?}"
    );

    let mut bare = plane();
    bare.remove_attribute(Mesh::ATTRIBUTE_UV_0);
    let (count, warnings) = said(
        |app| {
            let image = add(app, texture(checker));
            vec![MaskTexture::new(image, MaskValues::Density(0.0, 1.0))]
        },
        bare,
    );
    assert!(count > 0);
    assert!(
        warnings[0].contains("skin 0 has no texture coordinates"),
        "{warnings:?}"
    );
}

#[test]
fn a_groom_file_names_its_masks() {
    let folder = std::env::temp_dir().join(format!("bevy_plumage_masks_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let pixels = image::RgbImage::from_fn(TEXELS, TEXELS, |x, y| {
        let [red, green] = checker(x, y);
        image::Rgb([red, green, 0])
    });
    pixels.save(folder.join("mask.png")).expect("saved");
    plumage_tests::shipped::feather("contour")
        .write(&folder.join("contour.feather.ron"))
        .expect("written");
    let mut groom = even(600, Vec::new());
    groom.feathers = vec!["contour.feather.ron".into()];
    let sets = MaskValues::Density(0.0, 1.0);
    groom.masks = vec![MaskTexture::new("mask.png", sets).with_channel(Channel::Green)];
    groom
        .write(&folder.join("patch.groom.ron"))
        .expect("written");

    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();
    let handle: Handle<Groom> = server.load("patch.groom.ron");
    let mesh = add(
        &mut app,
        Plane3d::new(Vec3::Z, Vec2::splat(0.5 * SIDE))
            .mesh()
            .build(),
    );
    let parts = (
        Mesh3d(mesh),
        Transform::default(),
        Plumage::new(handle.clone()),
    );
    let bird = app.world_mut().spawn(parts).id();
    let (cards, warnings) = grown(&mut app, bird, 1);
    assert!(warnings.is_empty(), "{warnings:?}");
    let inner = cards.iter().map(|card| square(card.root));
    let (right, wrong): (Vec<_>, Vec<_>) = inner
        .filter(|(inside, _)| *inside > 0.13)
        .partition(|(_, parity)| *parity == 1);
    assert!(
        right.len() > 100 && wrong.is_empty(),
        "{} and {}",
        right.len(),
        wrong.len()
    );

    // Out of range, and a texture without a name.
    groom.masks[0].sets = MaskValues::Length(0.01, 1.0);
    let error = groom.validate("patch").expect_err("too short").to_string();
    assert!(
        error.contains("masks[0].sets.Length.0") && error.contains("0.05"),
        "{error}"
    );
    groom.masks[0] = MaskTexture::new("", sets);
    let error = groom.validate("patch").expect_err("no name").to_string();
    assert!(error.contains("masks[0].texture"), "{error}");
    let text = std::fs::read_to_string(folder.join("patch.groom.ron")).expect("read");
    std::fs::write(
        folder.join("other.groom.ron"),
        text.replace("Green", "Grene"),
    )
    .expect("written");
    let other: Handle<Groom> = server.load("other.groom.ron");
    let cause = wait::until("the error", || {
        app.update();
        match server.load_state(&other) {
            LoadState::Failed(cause) => Some(cause.to_string()),
            _ => None,
        }
    });
    assert!(cause.contains("Grene") && cause.contains("Blue"), "{cause}");
    std::fs::remove_dir_all(&folder).expect("removed");
}
