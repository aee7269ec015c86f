//! Cards behind the bird's own skin are not drawn, and nobody sees it: a feathered ball before a wall that takes its shadow.

use bevy::{
    asset::RenderAssetUsages,
    camera::{RenderTarget, visibility::RenderLayers},
    core_pipeline::prepass::DepthPrepass,
    prelude::*,
    render::render_resource::{Face, TextureFormat},
};
use bevy_plumage::{CARD_COUNTERS, prelude::*};
use plumage_tests::{
    app::Stage,
    view::{counts, frames, mean, orthographic, patch_groom, rms},
};

const FEATHERS: u32 = 400;

struct Ball {
    stage: Stage,
    entity: Entity,
    skin: Handle<StandardMaterial>,
}

fn quality(cull_hidden: bool, transparency: FeatherTransparency) -> FeatherQuality {
    let mut quality = FeatherQuality {
        transparency,
        ..default()
    };
    quality.settings.cull_hidden = cull_hidden;
    quality
}

fn ball() -> Option<Ball> {
    let mut stage = Stage::new()?;
    let world = stage.app.world_mut();
    let mut groom = patch_groom(FEATHERS);
    groom.regions[0].length = bevy_plumage::groom::Span(12.0, 12.0);
    groom.regions[0].width = bevy_plumage::groom::Span(7.0, 7.0);
    let groom = world
        .resource_mut::<Assets<bevy_plumage::groom::Groom>>()
        .add(groom);
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let [round, wall] = [
        Sphere::new(0.06).mesh().uv(48, 24),
        Rectangle::new(1.0, 1.0).mesh().build(),
    ]
    .map(|mesh| meshes.add(mesh));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let [skin, white] = [Color::srgb(0.2, 0.1, 0.1), Color::WHITE].map(|c| materials.add(c));
    world.spawn((
        Mesh3d(wall),
        MeshMaterial3d(white),
        Transform::from_xyz(0.0, -0.1, -0.3),
    ));
    let entity = world
        .spawn((
            Mesh3d(round),
            MeshMaterial3d(skin.clone()),
            Plumage::new(groom),
            quality(true, FeatherTransparency::default()),
            Transform::IDENTITY,
        ))
        .id();
    stage.settle();
    Some(Ball {
        stage,
        entity,
        skin,
    })
}

impl Ball {
    fn set(&mut self, quality: FeatherQuality) {
        self.stage
            .app
            .world_mut()
            .entity_mut(self.entity)
            .insert(quality);
        frames(&mut self.stage, 3);
    }

    fn hidden(&mut self) -> u64 {
        let class = CARD_COUNTERS.iter().position(|name| *name == "hidden");
        counts(&mut self.stage)[class.expect("a class")]
    }

    fn look_from(&mut self, eye: Vec3) {
        let camera = self.stage.camera;
        let place = Transform::from_translation(eye).looking_at(Vec3::ZERO, Vec3::Y);
        self.stage.app.world_mut().entity_mut(camera).insert(place);
    }

    /// Fails unless the picture is the same, to the bit, as with all cards drawn; `least` of them are hidden.
    fn hides(&mut self, least: u64, what: &str) {
        let transparency = self
            .stage
            .app
            .world()
            .get::<FeatherQuality>(self.entity)
            .map_or_else(FeatherTransparency::default, |quality| quality.transparency);
        self.set(quality(true, transparency));
        let hidden = self.hidden();
        let some = self.stage.picture();
        self.set(quality(false, transparency));
        assert_eq!(self.hidden(), 0, "{what}: all are drawn");
        let all = self.stage.picture();
        println!("{what}: {hidden} of {FEATHERS} hidden");
        assert!(mean(&all) > 0.01, "{what}: nothing is seen");
        assert!(hidden >= least, "{what}: only {hidden} hidden");
        assert_eq!(rms(&some, &all), 0.0, "{what}: the picture differs");
        self.set(quality(true, transparency));
    }
}

/// How far the eye is from the middle.
const AWAY: f32 = 0.4;

/// From all around, and however coverage becomes pixels. Shadows lie on the wall in all pictures.
#[test]
fn pictures_are_those_of_all_cards() {
    let Some(mut ball) = ball() else {
        return;
    };
    for eye in [
        Vec3::Z,
        Vec3::new(1.0, 0.4, 0.5),
        Vec3::new(-0.3, -1.0, 0.4),
    ] {
        ball.look_from(AWAY * eye.normalize());
        ball.hides(40, &format!("from {eye}"));
    }
    ball.look_from(AWAY * Vec3::Z);
    let camera = ball.stage.camera;
    let insert = |ball: &mut Ball, bundle| {
        ball.stage.app.world_mut().entity_mut(camera).insert(bundle);
    };
    insert(&mut ball, (Msaa::Off, DepthPrepass));
    ball.hides(40, "one sample, depth first");
    ball.set(quality(true, FeatherTransparency::Blend));
    ball.hides(40, "blended");
    ball.set(quality(true, FeatherTransparency::Hashed));
    ball.stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(orthographic());
    ball.hides(40, "orthographic, hashed");
    // So near that the ball reaches out of the picture on all sides.
    ball.stage.app.world_mut().entity_mut(camera).insert((
        Projection::default(),
        Transform::from_xyz(0.0, 0.0, 0.09).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    ball.hides(0, "near");
}

/// A camera that jumps sees in the first frame what it sees later.
#[test]
fn nothing_is_remembered_from_the_frame_before() {
    let Some(mut ball) = ball() else {
        return;
    };
    for eye in [Vec3::X, -Vec3::Z, Vec3::Y, Vec3::new(-1.0, -1.0, 1.0)] {
        ball.look_from(AWAY * eye.normalize());
        let first = ball.stage.still();
        frames(&mut ball.stage, 3);
        let later = ball.stage.still();
        assert!(ball.hidden() > 40, "from {eye}");
        assert_eq!(first.data, later.data, "the first frame from {eye} differs");
    }
}

/// Two cameras on two sides: each sees what it sees alone.
#[test]
fn cameras_do_not_disturb_each_other() {
    let Some(mut ball) = ball() else {
        return;
    };
    ball.look_from(AWAY * Vec3::Z);
    frames(&mut ball.stage, 3);
    let alone = ball.stage.picture();
    let world = ball.stage.app.world_mut();
    let mut image = Image::new_target_texture(32, 32, TextureFormat::Rgba8UnormSrgb, None);
    image.asset_usage = RenderAssetUsages::default();
    let image = world.resource_mut::<Assets<Image>>().add(image);
    world.spawn((
        Camera3d::default(),
        Camera {
            order: 1,
            ..default()
        },
        RenderTarget::Image(image.into()),
        Transform::from_translation(-AWAY * Vec3::Z).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    frames(&mut ball.stage, 3);
    let together = ball.stage.picture();
    assert!(mean(&alone) > 0.01);
    assert_eq!(rms(&alone, &together), 0.0);
}

/// What the skin does not hide is drawn: a skin that is transparent, of glass, seen from within, or not for this camera, feathers that
/// move, a mirror.
#[test]
fn only_an_opaque_skin_that_is_drawn_hides() {
    let Some(mut ball) = ball() else {
        return;
    };
    ball.look_from(AWAY * Vec3::Z);
    frames(&mut ball.stage, 3);
    let usual = ball.hidden();
    assert!(usual > 40, "{usual}");
    let skin = ball.skin.clone();
    let paint = |ball: &mut Ball, change: fn(&mut StandardMaterial)| {
        let world = ball.stage.app.world_mut();
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        change(&mut materials.get_mut(&skin).unwrap());
        frames(&mut ball.stage, 3);
        ball.hidden()
    };
    let hidden = paint(&mut ball, |skin| skin.alpha_mode = AlphaMode::Blend);
    assert_eq!(hidden, 0, "a transparent skin hides");
    let hidden = paint(&mut ball, |skin| skin.alpha_mode = AlphaMode::Opaque);
    assert_eq!(hidden, usual);
    let hidden = paint(&mut ball, |skin| skin.cull_mode = Some(Face::Front));
    assert_eq!(hidden, 0, "a skin hides by faces that are not drawn");
    paint(&mut ball, |skin| skin.cull_mode = Some(Face::Back));
    let hidden = paint(&mut ball, |skin| skin.specular_transmission = 0.5);
    assert_eq!(hidden, 0, "a skin of glass hides");
    let hidden = paint(&mut ball, |skin| skin.specular_transmission = 0.0);
    assert_eq!(hidden, usual);
    let (entity, camera) = (ball.entity, ball.stage.camera);
    let change = |ball: &mut Ball, change: &dyn Fn(&mut World)| {
        change(ball.stage.app.world_mut());
        frames(&mut ball.stage, 3);
        ball.hidden()
    };
    let hidden = change(&mut ball, &|world| {
        world.entity_mut(entity).insert(RenderLayers::layer(3));
    });
    assert_eq!(hidden, 0, "a skin hides that this camera does not draw");
    change(&mut ball, &|world| {
        world.entity_mut(entity).remove::<RenderLayers>();
    });
    let hidden = change(&mut ball, &|world| {
        world.insert_resource(Wind::new(Vec3::X, 2.0));
    });
    assert_eq!(hidden, 0, "feathers in the wind are not followed");
    change(&mut ball, &|world| world.insert_resource(Wind::default()));
    let hidden = change(&mut ball, &|world| {
        world.get_mut::<Camera>(camera).unwrap().invert_culling = true;
    });
    assert_eq!(hidden, 0, "a mirror shows other faces");
    let hidden = change(&mut ball, &|world| {
        world.get_mut::<Camera>(camera).unwrap().invert_culling = false;
    });
    assert_eq!(hidden, usual);
}
