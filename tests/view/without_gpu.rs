//! What the plugin does to components, assets and cameras; no picture is drawn.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::{
        render_resource::{Extent3d, TextureDimension, TextureFormat},
        storage::ShaderBuffer,
    },
};
use bevy_plumage::groom::{PlumageCards, PlumageParts};
use bevy_plumage::prelude::*;
use plumage_tests::{
    headless::{app, wait},
    view::patch_groom,
};

/// A groomed square and its card mesh.
fn spawn(app: &mut App, quality: impl Bundle) -> (Entity, Entity) {
    let world = app.world_mut();
    let groom = world.resource_mut::<Assets<_>>().add(patch_groom(40));
    let mesh = Plane3d::new(Vec3::Z, Vec2::splat(0.1)).mesh().build();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let plumage = Plumage::new(groom).with_seed(3);
    let bird = world
        .spawn((Mesh3d(mesh), Transform::default(), plumage, quality))
        .id();
    let mut cards = None;
    wait(app, "the material", |world| {
        cards = world.get::<PlumageParts>(bird).map(|parts| parts[0]);
        cards.is_some_and(|cards| {
            let entity = world.entity(cards);
            entity.contains::<MeshMaterial3d<FeatherMaterial>>()
                || entity.contains::<MeshMaterial3d<StandardMaterial>>()
        })
    });
    app.update();
    (bird, cards.unwrap())
}

fn quality(app: &App, cards: Entity) -> FeatherQuality {
    let handle = app.world().get::<MeshMaterial3d<FeatherMaterial>>(cards);
    let materials = app.world().resource::<Assets<FeatherMaterial>>();
    let material = materials.get(&handle.unwrap().0).unwrap();
    FeatherQuality {
        settings: material.settings,
        transparency: material.transparency,
    }
}

fn rough() -> FeatherQuality {
    FeatherQuality {
        settings: FeatherSettings {
            error_budget: 0.02,
            ..default()
        },
        transparency: FeatherTransparency::Hashed,
    }
}

#[test]
fn without_a_quality_the_defaults_hold() {
    let mut app = app(FeatherPath::Full);
    let (bird, cards) = spawn(&mut app, rough());
    assert_eq!(quality(&app, cards), rough());
    app.world_mut().entity_mut(bird).remove::<FeatherQuality>();
    app.update();
    assert_eq!(quality(&app, cards), FeatherQuality::default());
    app.world_mut().entity_mut(bird).insert(rough());
    app.update();
    // Taken off and put on in one frame.
    let mut fine = rough();
    fine.settings.error_budget = 0.001;
    app.world_mut()
        .entity_mut(bird)
        .remove::<FeatherQuality>()
        .insert(fine);
    app.update();
    assert_eq!(quality(&app, cards), fine);
}

#[test]
fn a_bird_is_drawn_in_one_way() {
    for path in [FeatherPath::Full, FeatherPath::Fallback] {
        let mut app = app(path);
        assert_eq!(
            app.world()
                .resource::<bevy_plumage::ActiveFeatherPath>()
                .get(),
            path
        );
        let (_, cards) = spawn(&mut app, ());
        for _ in 0..3 {
            app.update();
        }
        let entity = app.world().entity(cards);
        let full = entity.contains::<MeshMaterial3d<FeatherMaterial>>();
        let plain = entity.contains::<MeshMaterial3d<StandardMaterial>>();
        assert_eq!(full, path == FeatherPath::Full);
        assert_eq!(plain, path == FeatherPath::Fallback);
    }
}

/// Mean color, sRGB bytes, of the opaque texels in the middle of the fallback's atlas.
fn atlas_color(world: &World, cards: Entity) -> [f32; 3] {
    let handle = world.get::<MeshMaterial3d<StandardMaterial>>(cards);
    let materials = world.resource::<Assets<StandardMaterial>>();
    let material = materials.get(&handle.unwrap().0).unwrap();
    let images = world.resource::<Assets<Image>>();
    let texture = material.base_color_texture.as_ref().unwrap();
    let data = images.get(texture).unwrap().data.as_ref().unwrap();
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for texel in data.chunks_exact(4).filter(|texel| texel[3] == 255) {
        (0..3).for_each(|c| sum[c] += f32::from(texel[c]));
        count += 1.0;
    }
    assert!(count > 500.0, "{count} opaque texels");
    sum.map(|sum| sum / count)
}

fn plain(rgb: [u8; 3]) -> Image {
    Image::new_fill(
        Extent3d {
            width: 8,
            height: 8,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        &[rgb[0], rgb[1], rgb[2], 255],
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::default(),
    )
}

#[test]
fn the_fallback_shows_photographs_and_follows_edits() {
    let mut app = app(FeatherPath::Fallback);
    let (_, cards) = spawn(&mut app, ());
    let painted = atlas_color(app.world(), cards);
    assert!(
        painted[0] > 1.5 * painted[1],
        "the groom's red: {painted:?}"
    );
    let uvs = |app: &App| {
        let mesh = app.world().get::<Mesh3d>(cards).unwrap();
        let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh.0).unwrap();
        let uvs = mesh.attribute(Mesh::ATTRIBUTE_UV_0).unwrap();
        format!("{uvs:?}")
    };
    let places = uvs(&app);
    let worn = app.world().get::<PlumageCards>(cards).unwrap();
    let feather = worn.feathers[0].clone();
    let edit = |app: &mut App, change: &dyn Fn(&mut Feather)| {
        let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
        change(&mut feathers.get_mut(&feather).unwrap());
        for _ in 0..3 {
            app.update();
        }
    };
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let photograph = images.add(plain([20, 200, 40]));
    edit(&mut app, &|feather| {
        feather.image = Some(photograph.clone())
    });
    let green = atlas_color(app.world(), cards);
    let far = |a: [f32; 3], b: [f32; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
    assert!(far(green, [20.0, 200.0, 40.0]) < 2.0, "{green:?}");
    // The photograph itself is replaced.
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&photograph).unwrap() = plain([10, 30, 220]);
    for _ in 0..3 {
        app.update();
    }
    let blue = atlas_color(app.world(), cards);
    assert!(far(blue, [10.0, 30.0, 220.0]) < 2.0, "{blue:?}");
    edit(&mut app, &|feather| feather.image = None);
    assert_eq!(atlas_color(app.world(), cards), painted);
    assert_eq!(uvs(&app), places, "the cards have left their tile");
}

/// What nothing has marked as changed is not looked at.
#[test]
fn an_idle_app_pays_nothing_for_its_birds() {
    let mut app = app(FeatherPath::Full);
    let (_, cards) = spawn(&mut app, ());
    for _ in 0..3 {
        app.update();
    }
    let motion = |app: &App| {
        let handle = app.world().get::<MeshMaterial3d<FeatherMaterial>>(cards);
        let materials = app.world().resource::<Assets<FeatherMaterial>>();
        let buffer = materials.get(&handle.unwrap().0).unwrap().motion.id();
        let buffers = app.world().resource::<Assets<ShaderBuffer>>();
        buffers.get(buffer).unwrap().data.as_ref().unwrap().len()
    };
    let meshes = |app: &mut App| {
        let mut repeats = app
            .world_mut()
            .query_filtered::<(&Mesh3d, &ChildOf), Without<PlumageCards>>();
        let all = repeats.iter(app.world());
        let own = all.filter(|(_, parent)| parent.0 == cards);
        own.map(|(mesh, _)| mesh.0.id()).collect::<Vec<_>>()
    };
    let (rows, before) = (motion(&app), meshes(&mut app));
    assert_eq!(before.len(), 5, "a mesh for LIT, two each for FAR and MEAN");
    let mut assets = app.world_mut().resource_mut::<Assets<Mesh>>();
    let other = assets.add(Plane3d::default().mesh().build());
    let mut worn = app.world_mut().get_mut::<PlumageCards>(cards).unwrap();
    let more = vec![worn.regions[0].clone(); 7];
    worn.bypass_change_detection().regions = more.into();
    let mut mesh = app.world_mut().get_mut::<Mesh3d>(cards).unwrap();
    mesh.bypass_change_detection().0 = other.clone();
    app.update();
    assert_eq!((motion(&app), meshes(&mut app)), (rows, before));
    let mut worn = app.world_mut().get_mut::<PlumageCards>(cards).unwrap();
    worn.set_changed();
    let mut mesh = app.world_mut().get_mut::<Mesh3d>(cards).unwrap();
    mesh.set_changed();
    app.update();
    assert!(motion(&app) > rows);
    assert_eq!(meshes(&mut app), [other.id(); 5]);
}
