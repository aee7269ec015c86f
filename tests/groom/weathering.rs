//! Wet, dirty and old feathers: colors, masks, and the way back.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_plumage::{Feather, RonAsset, Weather, Weathering, groom::*};
use plumage_tests::{headless, shipped::feather, view::patch_groom, wait};
use std::sync::Arc;

const WET: Weather = Weather {
    wetness: 1.0,
    dirt: 0.0,
    age: 0.0,
};
/// Side of the skin, metres.
const SIDE: f32 = 0.4;

#[test]
fn weather_changes_colors_as_it_says() {
    let dry = Weather::default();
    let old = Weather { age: 1.0, ..dry };
    let dirty = Weather { dirt: 1.0, ..dry };
    for i in 0..=20 {
        let a = i as f32 / 20.0;
        assert_eq!(dry.color([a; 3]), [a; 3]);
        // What gets through the film is scattered, and mirrored back from inside, until nothing is left. A film mirrors 6.6 % of the
        // light that comes from outside from all around, and all that from inside whose angle is beyond the critical one, by 1/n^2.
        let outside = 0.066_f64;
        let inside = 1.0 - (1.0 - outside) / (1.33 * 1.33);
        let (mut light, mut left) = (1.0 - outside, 0.0);
        for _ in 0..200 {
            let scattered = light * f64::from(a);
            left += scattered * (1.0 - inside);
            light = scattered * inside;
        }
        let [wet, ..] = WET.color([a; 3]);
        assert!((f64::from(wet) - left).abs() < 2e-3, "{a}: {wet} {left}");
        assert!(wet <= a && old.color([a; 3])[0] >= a);
        let [r, _, b] = dirty.color([a; 3]);
        assert!(r > b && r <= 0.21, "{a}: {r} {b}");
    }
    // The darker half of gray becomes about half as bright: what is wet looks darker, least where it was white or black.
    let [middle, white] = [0.2, 1.0].map(|a| WET.color([a; 3])[0]);
    println!("wet, a gray of 0.2 is {middle:.3}, white {white:.3}");
    assert!((0.4..0.6).contains(&(middle / 0.2)), "{middle}");
    // Nothing that an app may write leaves 0..1.
    for x in [f32::NAN, f32::INFINITY, -7.0, 9.0] {
        let odd = feather("contour").weathered(Weather {
            wetness: x,
            dirt: x,
            age: x,
        });
        odd.validate("odd").expect("a sound feather");
    }
}

#[test]
fn weather_is_put_on_and_off_a_feather() {
    let dry = feather("contour");
    assert_eq!(dry.weathered(Weather::default()), dry);
    let wet = dry.weathered(WET);
    assert!(wet.clumps.count > 1 && wet.clumps.depth > 0.5);
    assert!(wet.optics.distal.longitudinal_roughness < dry.optics.distal.longitudinal_roughness);
    assert_eq!(wet.optics.sheen.strength, 0.0);
    let old = dry.weathered(Weather {
        wetness: 0.0,
        dirt: 0.0,
        age: 1.0,
    });
    assert!(old.gaps.count > dry.gaps.count && old.clumps == dry.clumps);
}

fn add<A: Asset>(app: &mut App, asset: A) -> Handle<A> {
    app.world_mut().resource_mut::<Assets<A>>().add(asset)
}

/// Black on the left, white on the right; the other way round if `turned`.
fn halves(turned: bool) -> Image {
    let texel = |i: u32| {
        let white = (i % 8 >= 4) != turned;
        [[0_u8, 255][usize::from(white)], 0, 0, 255]
    };
    Image::new(
        Extent3d {
            width: 8,
            height: 8,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        (0..64).flat_map(texel).collect(),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::all(),
    )
}

fn worn(app: &App, bird: Entity) -> &PlumageCards {
    let parts = app.world().get::<PlumageParts>(bird).expect("feathers");
    app.world().get::<PlumageCards>(parts[0]).expect("cards")
}

#[test]
fn a_mask_says_where_and_the_way_back_is_exact() {
    let mut app = headless::grooms_and_paints();
    let groom = add(&mut app, patch_groom(400));
    let mesh = add(
        &mut app,
        Plane3d::new(Vec3::Z, Vec2::splat(0.5 * SIDE))
            .mesh()
            .subdivisions(10)
            .build(),
    );
    let mask = add(&mut app, halves(false));
    let bird = app
        .world_mut()
        .spawn((
            Mesh3d(mesh),
            Transform::default(),
            Plumage::new(groom).with_seed(5),
        ))
        .id();
    wait::until("the feathers", || {
        app.update();
        let state = app.world().get::<PlumageState>(bird);
        state.is_some_and(PlumageState::is_ready).then_some(())
    });
    app.update();
    let clean = worn(&app, bird).clone();
    assert_eq!(clean.feathers.len(), 1);
    app.world_mut()
        .entity_mut(bird)
        .insert(Weathering::new(WET).with_mask(mask.clone()));
    app.update();
    let check = |app: &App, turned: bool| {
        let (mut wet, mut dry) = (0, 0);
        let now = worn(app, bird);
        assert_eq!((now.feathers.len(), now.weathered.len()), (1, 2));
        for (card, before) in now.cards.iter().zip(clean.cards.iter()) {
            // Not in the strip where the mask rises.
            if card.root.x.abs() < 0.1 * SIDE || card.root.x.abs() > 0.4 * SIDE {
                continue;
            }
            if (card.root.x > 0.0) != turned {
                wet += 1;
                assert_eq!(card.feather, 2, "{}", card.root);
                assert_eq!(now.feather_of(card), clean.feathers.first());
                assert_eq!(card.tint, WET.color(before.tint));
            } else {
                dry += 1;
                assert_eq!(card, before, "{}", card.root);
            }
        }
        assert!(wet > 50 && dry > 50, "{wet} {dry}");
    };
    check(&app, false);
    // Another mask, and the same cards while nothing changes.
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&mask).expect("the mask") = halves(true);
    app.update();
    app.update();
    check(&app, true);
    let cards = worn(&app, bird).cards.clone();
    app.update();
    assert!(Arc::ptr_eq(&cards, &worn(&app, bird).cards));
    // A feather that is edited is worn wet, in the place of the old one.
    let handles: Vec<_> = [
        &worn(&app, bird).feathers[..],
        &worn(&app, bird).weathered[..],
    ]
    .concat();
    let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
    feathers.get_mut(&handles[0]).expect("the feather").aspect *= 1.5;
    app.update();
    app.update();
    assert_eq!(worn(&app, bird).weathered, handles[1..]);
    let aspect = |i: usize| {
        app.world()
            .resource::<Assets<Feather>>()
            .get(&handles[i])
            .map(|feather| feather.aspect)
    };
    assert_eq!(aspect(0), aspect(2));
    // Half as wet, and all over.
    app.world_mut()
        .entity_mut(bird)
        .insert(Weathering::new(Weather {
            wetness: 0.5,
            ..WET
        }));
    app.update();
    let now = worn(&app, bird);
    assert_eq!(now.weathered.len(), 1);
    assert!(now.cards.iter().all(|card| card.feather == 1));
    app.world_mut().entity_mut(bird).remove::<Weathering>();
    app.update();
    let now = worn(&app, bird);
    assert!(now.weathered.is_empty() && now.feathers == clean.feathers);
    assert!(Arc::ptr_eq(&now.cards, &clean.cards));
}
