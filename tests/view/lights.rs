//! Every kind of light that Bevy has, its shadows, and what stands between the light and the eye.

use bevy::{
    core_pipeline::prepass::DepthPrepass,
    light::{
        CascadeShadowConfigBuilder, EnvironmentMapLight, FogVolume, GlobalAmbientLight,
        IrradianceVolume, NotShadowReceiver, ShadowFilteringMethod, VolumetricFog, VolumetricLight,
    },
    pbr::{ContactShadows, DistanceFog, FogFalloff, ScreenSpaceAmbientOcclusion},
    prelude::*,
    render::render_resource::Extent3d,
};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::Stage,
    view::{
        counts, culled, darken, frames, mean, mean_color, orthographic, plain_image, spawn_patch,
    },
};

/// A dark stage with a patch of feathers.
fn stage() -> Option<(Stage, Entity)> {
    let mut stage = Stage::new()?;
    darken(&mut stage);
    let bird = spawn_patch(&mut stage, 150, Vec3::ZERO, FeatherQuality::default());
    stage.settle();
    assert!(mean(&stage.picture()) < 1e-4, "light from nowhere");
    Some((stage, bird))
}

/// Mean brightness with `bundle` in the scene, which is then taken out again.
fn with(stage: &mut Stage, bundle: impl Bundle) -> f32 {
    let entity = stage.app.world_mut().spawn(bundle).id();
    frames(stage, 3);
    let lit = mean(&stage.picture());
    stage.app.world_mut().entity_mut(entity).despawn();
    lit
}

fn from(x: f32, y: f32, z: f32) -> Transform {
    Transform::from_xyz(x, y, z).looking_at(Vec3::ZERO, Vec3::Y)
}

/// FAR and MEAN cards have other pipelines under lamps: feathers are there in the first frame with one, and in the first without.
#[test]
fn feathers_stay_when_a_lamp_comes_and_goes() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let sun = DirectionalLight {
        illuminance: 1000.0,
        ..default()
    };
    stage.app.world_mut().spawn((sun, from(0.2, 0.4, 1.0)));
    frames(&mut stage, 3);
    let brightness = |image: Image| {
        let bytes = image.data.unwrap();
        bytes.iter().map(|x| f64::from(*x)).sum::<f64>() / bytes.len() as f64
    };
    let classes = counts(&mut stage);
    let before = brightness(stage.still());
    let lamp = PointLight {
        intensity: 20_000.0,
        range: 50.0,
        ..default()
    };
    let lamp = stage
        .app
        .world_mut()
        .spawn((lamp, from(0.2, 0.4, 1.0)))
        .id();
    let coming = brightness(stage.still());
    frames(&mut stage, 3);
    let lit = brightness(stage.still());
    stage.app.world_mut().entity_mut(lamp).despawn();
    let going = brightness(stage.still());
    frames(&mut stage, 3);
    let after = brightness(stage.still());
    println!("{classes:?}: {before}, lamp {coming}, {lit}, none {going}, {after}");
    assert!(lit > before + 2.0, "the lamp shows nothing");
    // Bevy's clusters may know of it a frame later.
    assert!(coming > before - 0.5, "feathers are away as it comes");
    assert!(going > before - 0.5, "feathers are away as it goes");
    assert!((after - before).abs() < 0.01, "the lamp stays");
}

#[test]
fn every_light_lights_feathers_as_much_as_it_should() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let sun = |illuminance| DirectionalLight {
        illuminance,
        ..default()
    };
    let one = with(&mut stage, (sun(1000.0), from(0.2, 0.4, 1.0)));
    let two = with(&mut stage, (sun(2000.0), from(0.2, 0.4, 1.0)));
    assert!(one > 0.005 && (two / one - 2.0).abs() < 0.1, "{one} {two}");
    // 1 m away, the candelas of 4 pi lumens per candela: the same illuminance.
    let lamp = PointLight {
        intensity: 1000.0 * 4.0 * std::f32::consts::PI * 1.2,
        range: 50.0,
        ..default()
    };
    let point = with(&mut stage, (lamp, from(0.2, 0.4, 1.0)));
    // A hundred times as far away its rays are as good as parallel, and no feather is much nearer to it than another one.
    let lantern = PointLight {
        intensity: lamp.intensity * 1e4,
        range: 5000.0,
        ..lamp
    };
    let far = with(&mut stage, (lantern, from(20.0, 40.0, 100.0)));
    println!(
        "point light over sun: {}, from afar {}",
        point / one,
        far / one
    );
    assert!((far / one - 1.0).abs() < 0.005, "far point {far} {one}");
    assert!((point / one - 1.0).abs() < 0.05, "point {point} {one}");
    let spot = SpotLight {
        intensity: lamp.intensity,
        range: 50.0,
        inner_angle: 0.5,
        outer_angle: 0.8,
        ..default()
    };
    let spot = with(&mut stage, (spot, from(0.2, 0.4, 1.0)));
    assert!((spot / point - 1.0).abs() < 0.05, "spot {spot} {point}");
    // A small square of 1000 cd towards the feathers: luminance 1000 / area, lumens = luminance x area x pi.
    let square = |facing: Transform| {
        let light = RectLight {
            intensity: 1000.0 * 1.2 * std::f32::consts::PI,
            width: 0.1,
            height: 0.1,
            range: 50.0,
            ..default()
        };
        (light, facing)
    };
    let rect = with(&mut stage, square(from(0.2, 0.4, 1.0)));
    assert!((rect / point - 1.0).abs() < 0.1, "rectangle {rect} {point}");
    let away = Transform::from_xyz(0.2, 0.4, 1.0).looking_at(Vec3::new(0.4, 0.8, 2.0), Vec3::Y);
    let behind = with(&mut stage, square(away));
    assert!(
        behind < 0.01 * rect,
        "a rectangle shines backwards: {behind}"
    );

    stage.app.insert_resource(GlobalAmbientLight {
        brightness: 1000.0,
        ..default()
    });
    frames(&mut stage, 3);
    let ambient = mean(&stage.picture());
    assert!(ambient > 0.005, "ambient {ambient}");
    stage.app.insert_resource(GlobalAmbientLight {
        brightness: 0.0,
        ..default()
    });
    let map = EnvironmentMapLight {
        intensity: 1000.0,
        ..EnvironmentMapLight::solid_color(
            &mut stage.app.world_mut().resource_mut::<Assets<Image>>(),
            Color::WHITE,
        )
    };
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(map);
    frames(&mut stage, 3);
    let environment = mean(&stage.picture());
    assert!(
        (environment / ambient - 1.0).abs() < 0.1,
        "{environment} {ambient}"
    );
    // A volume of blue light instead of the white map.
    let voxels = plain_image(
        Color::linear_rgb(0.0, 0.0, 1.0),
        Extent3d {
            width: 2,
            height: 4,
            depth_or_array_layers: 6,
        },
    );
    let voxels = stage
        .app
        .world_mut()
        .resource_mut::<Assets<Image>>()
        .add(voxels);
    let before = mean_color(&stage.picture());
    let volume = stage
        .app
        .world_mut()
        .spawn((
            IrradianceVolume {
                voxels,
                intensity: 3000.0,
                ..default()
            },
            Transform::from_scale(Vec3::splat(2.0)),
        ))
        .id();
    frames(&mut stage, 3);
    let after = mean_color(&stage.picture());
    stage.app.world_mut().entity_mut(volume).despawn();
    // The volume has no red: what is left of it is the white map's reflection. The rest of the blue is three times as bright.
    let reflected = after[0];
    assert!(
        reflected < 0.2 * before[0]
            && ((after[2] - reflected) / (before[2] - reflected) - 3.0).abs() < 0.6,
        "irradiance volume: {before:?} {after:?}"
    );
}

/// A board of 5 cm over the right half of the feathers.
fn board(stage: &mut Stage, z: f32) -> Entity {
    let world = stage.app.world_mut();
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::new(0.3, 0.3, 0.005));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::BLACK);
    world
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(0.15, 0.0, z),
            bevy::camera::visibility::NoFrustumCulling,
        ))
        .id()
}

#[test]
fn shadows_of_every_light_and_filter_fall_on_feathers() {
    let Some((mut stage, bird)) = stage() else {
        return;
    };
    let camera = stage.camera;
    // The camera looks past the board, which is behind it.
    board(&mut stage, 0.6);
    let cascades = |count| {
        CascadeShadowConfigBuilder {
            num_cascades: count,
            first_cascade_far_bound: 0.3,
            maximum_distance: 2.0,
            ..default()
        }
        .build()
    };
    let sun = |shadow_maps_enabled| DirectionalLight {
        illuminance: 3000.0,
        shadow_maps_enabled,
        ..default()
    };
    let open = with(&mut stage, (sun(false), from(0.0, 0.0, 1.0)));
    for filter in [
        ShadowFilteringMethod::Hardware2x2,
        ShadowFilteringMethod::Gaussian,
        ShadowFilteringMethod::Temporal,
    ] {
        stage.app.world_mut().entity_mut(camera).insert(filter);
        for count in [1, 4] {
            let lit = with(
                &mut stage,
                (sun(true), cascades(count), from(0.0, 0.0, 1.0)),
            );
            // Half is under the board; feathers darken each other a little.
            assert!(
                (0.25..0.6).contains(&(lit / open)),
                "{filter:?}, {count} cascades: {}",
                lit / open
            );
        }
    }
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert(ShadowFilteringMethod::Gaussian);
    let lamp = |shadow_maps_enabled| PointLight {
        intensity: 60_000.0,
        shadow_maps_enabled,
        ..default()
    };
    let spot = |shadow_maps_enabled| SpotLight {
        intensity: 60_000.0,
        inner_angle: 0.5,
        outer_angle: 0.8,
        shadow_maps_enabled,
        ..default()
    };
    let open = with(&mut stage, (lamp(false), from(0.0, 0.0, 1.0)));
    let shaded = with(&mut stage, (lamp(true), from(0.0, 0.0, 1.0)));
    assert!(
        (0.25..0.6).contains(&(shaded / open)),
        "point {}",
        shaded / open
    );
    let shaded = with(&mut stage, (spot(true), from(0.0, 0.0, 1.0)));
    assert!(
        (0.25..0.6).contains(&(shaded / open)),
        "spot {}",
        shaded / open
    );
    // What receives no shadow has none.
    let output = stage
        .app
        .world()
        .get::<bevy_plumage::groom::PlumageParts>(bird);
    let cards = output.map(|parts| parts[0]).unwrap();
    stage
        .app
        .world_mut()
        .entity_mut(cards)
        .insert(NotShadowReceiver);
    let free = with(&mut stage, (lamp(true), from(0.0, 0.0, 1.0)));
    assert!((free / open - 1.0).abs() < 0.03, "{}", free / open);
}

/// Feathers that the camera does not see, and culls, still cast their shadow on a wall that it sees.
#[test]
fn feathers_outside_of_the_picture_cast_shadows() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let world = stage.app.world_mut();
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(2.0, 1.0));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::WHITE);
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Transform::from_xyz(0.0, 0.0, -0.3),
    ));
    // The light falls from the left past the feathers to the place that the camera looks at.
    let spot = Vec3::new(0.45, 0.0, -0.3);
    let eye = Transform::from_translation(spot.with_z(0.5)).looking_at(spot, Vec3::Y);
    let camera = stage.camera;
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert((eye, orthographic()));
    let light = from(-1.5, 0.0, 1.0);
    let sun = |shadow_maps_enabled| DirectionalLight {
        illuminance: 3000.0,
        shadow_maps_enabled,
        ..default()
    };
    let cascades = || {
        CascadeShadowConfigBuilder {
            num_cascades: 1,
            maximum_distance: 2.0,
            ..default()
        }
        .build()
    };
    let lamp = |shadow_maps_enabled| PointLight {
        intensity: 90_000.0,
        shadow_maps_enabled,
        ..default()
    };
    let beam = |shadow_maps_enabled| SpotLight {
        intensity: 90_000.0,
        inner_angle: 0.5,
        outer_angle: 0.8,
        shadow_maps_enabled,
        ..default()
    };
    let open = with(&mut stage, (sun(false), cascades(), light));
    assert_eq!(culled(&mut stage), 150);
    let shaded = with(&mut stage, (sun(true), cascades(), light));
    let mut shares = vec![shaded / open];
    let open = with(&mut stage, (lamp(false), light));
    shares.push(with(&mut stage, (lamp(true), light)) / open);
    let open = with(&mut stage, (beam(false), light));
    shares.push(with(&mut stage, (beam(true), light)) / open);
    println!("light left by sun, point, spot: {shares:?}");
    assert!(shares.iter().all(|share| *share < 0.6), "{shares:?}");
}

#[test]
fn screen_space_shadows_occlusion_and_fog_reach_feathers() {
    let Some((mut stage, _)) = stage() else {
        return;
    };
    let camera = stage.camera;
    let insert = |stage: &mut Stage, bundle: Box<dyn FnOnce(&mut EntityWorldMut)>| {
        bundle(&mut stage.app.world_mut().entity_mut(camera));
        frames(stage, 3);
    };
    let sun = DirectionalLight {
        illuminance: 3000.0,
        contact_shadows_enabled: true,
        ..default()
    };
    let low = stage
        .app
        .world_mut()
        .spawn((sun, from(1.0, 0.0, 0.35)))
        .id();
    insert(
        &mut stage,
        Box::new(|c| {
            c.insert((Msaa::Off, DepthPrepass));
        }),
    );
    let fin = board(&mut stage, 0.01);
    let mut place = stage.app.world_mut().get_mut::<Transform>(fin).unwrap();
    *place = Transform::from_xyz(0.03, 0.0, 0.03)
        .with_rotation(Quat::from_rotation_y(1.4))
        .with_scale(Vec3::new(0.2, 1.0, 1.0));
    frames(&mut stage, 3);
    let without = mean(&stage.picture());
    insert(
        &mut stage,
        Box::new(|c| {
            c.insert(ContactShadows::default());
        }),
    );
    let with_contact = mean(&stage.picture());
    assert!(
        with_contact < 0.95 * without,
        "contact shadows: {with_contact} {without}"
    );
    insert(
        &mut stage,
        Box::new(|c| {
            c.remove::<ContactShadows>();
        }),
    );
    stage.app.world_mut().entity_mut(fin).despawn();

    // Distance fog of a color that feathers do not have.
    frames(&mut stage, 2);
    let clear = mean_color(&stage.picture());
    let fog = DistanceFog {
        color: Color::linear_rgb(0.0, 0.6, 0.0),
        falloff: FogFalloff::Linear {
            start: 0.0,
            end: 1.0,
        },
        ..default()
    };
    insert(
        &mut stage,
        Box::new(|c| {
            c.insert(fog);
        }),
    );
    let fogged = mean_color(&stage.picture());
    assert!(
        fogged[1] > clear[1] + 0.05 && fogged[0] < 0.8 * clear[0],
        "fog: {clear:?} {fogged:?}"
    );
    insert(
        &mut stage,
        Box::new(|c| {
            c.remove::<DistanceFog>();
        }),
    );

    // Volumetric fog dims what is behind it.
    stage.app.world_mut().entity_mut(low).insert((
        VolumetricLight,
        DirectionalLight {
            illuminance: 3000.0,
            shadow_maps_enabled: true,
            ..default()
        },
    ));
    frames(&mut stage, 3);
    let clear = mean_color(&stage.picture());
    let smoke = FogVolume {
        density_factor: 2.0,
        absorption: 2.0,
        scattering: 0.0,
        ..default()
    };
    let volume = stage
        .app
        .world_mut()
        .spawn((
            smoke,
            Transform::from_xyz(0.0, 0.0, 0.2).with_scale(Vec3::splat(0.3)),
        ))
        .id();
    insert(
        &mut stage,
        Box::new(|c| {
            c.insert(VolumetricFog {
                ambient_intensity: 0.0,
                ..default()
            });
        }),
    );
    let dim = mean_color(&stage.picture());
    assert!(
        dim[0] < 0.95 * clear[0],
        "volumetric fog: {clear:?} {dim:?}"
    );
    stage.app.world_mut().entity_mut(volume).despawn();
    insert(
        &mut stage,
        Box::new(|c| {
            c.remove::<VolumetricFog>();
        }),
    );
    stage.app.world_mut().entity_mut(low).despawn();

    // Occlusion darkens what the surroundings light.
    stage.app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    frames(&mut stage, 3);
    let open = mean(&stage.picture());
    insert(
        &mut stage,
        Box::new(|c| {
            c.insert(ScreenSpaceAmbientOcclusion::default());
        }),
    );
    let occluded = mean(&stage.picture());
    assert!(
        occluded < 0.99 * open && occluded > 0.4 * open,
        "occlusion: {occluded} {open}"
    );
}
